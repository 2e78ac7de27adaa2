//! The figures of one run that its user looks at first.

use crate::over_crank_angle::over_crank_angle;
use crate::plate::FigureFile;
use figure::{Axis, Colour, Figure, Mark, Panel, Series, Share, in_rows};
use signal::channel::Channel;
use simulate::rod_load::Side;
use simulate::{IndicatorCard, RodLoad};
use sweep::run_analysis::{RunAnalysis, end_name};

/// Names of the figures, in the order of [`RunFigures::files`].
pub const FIGURES: [&str; 3] = ["pv-card.svg", "rod-load.svg", "waveform.svg"];

/// Cards and loads of two throws stand side by side.
const COLUMNS: usize = 2;

/// A run as its figures show it.
#[derive(Clone, Copy, Debug)]
pub struct RunFigures<'a> {
    /// Heading: the machine, its operating point.
    pub title: &'a str,
    /// What was found in it.
    pub analysis: &'a RunAnalysis,
    /// Crank angle of each sample of the channels, rad.
    pub crank_angle_rad: &'a [f64],
    /// The recorded channels.
    pub channels: &'a [Channel],
}

impl RunFigures<'_> {
    /// The p-V card of each chamber, the rod load of each throw over the crank angle, and pressures and
    /// accelerations together over the crank angle.
    pub fn files(&self) -> Vec<FigureFile> {
        let named = FIGURES.iter().zip(self.figures());
        named
            .map(|(name, figure)| FigureFile {
                name: (*name).to_owned(),
                svg: figure.svg(),
            })
            .collect()
    }

    /// The figures in the order of [`FIGURES`].
    pub(crate) fn figures(&self) -> [Figure; FIGURES.len()] {
        let analysis = self.analysis;
        let cards = analysis.cards.iter().map(|card| self.card(card)).collect();
        let loads = analysis.rod_loads.iter().enumerate();
        let loads = loads.map(|(i, load)| self.rod_load(i, load)).collect();
        let waveform = Figure {
            share_x: Share::All,
            row_height: 180.0,
            ..self.figure(self.waveforms(), 1)
        };
        [
            self.figure(cards, COLUMNS),
            self.figure(loads, COLUMNS),
            waveform,
        ]
    }

    fn figure(&self, panels: Vec<Panel>, columns: usize) -> Figure {
        Figure {
            title: self.title.to_owned(),
            rows: in_rows(panels, columns),
            width: 1000.0,
            row_height: 320.0,
            ..Figure::default()
        }
    }

    /// `throw1, ` where there are several throws.
    fn of_throw(&self, index: usize) -> String {
        match self.analysis.throws.get(index).map(String::as_str) {
            None | Some("") => String::new(),
            Some(name) => format!("{name}, "),
        }
    }

    fn card(&self, card: &IndicatorCard) -> Panel {
        const CUBIC_DECIMETRES: f64 = 1e3;
        let largest = card.pressure.iter().copied().fold(0.0, f64::max);
        let (scale, unit) = text::readable_unit(largest, "Pa");
        let points = card.volume.iter().zip(&card.pressure);
        let closed = points.clone().chain(points.take(1));
        let closed = closed.map(|(v, p)| [v * CUBIC_DECIMETRES, p * scale]);
        Panel {
            title: text::capitalised(&format!(
                "{}{} end: {}, mean pressure {}",
                self.of_throw(card.chamber.throw),
                end_name(card.chamber.end),
                text::prefixed(card.power, "W"),
                text::prefixed(card.mean_pressure, "Pa"),
            )),
            x: Axis::linear("volume (dm³)"),
            y: Axis::linear(text::with_unit("pressure", unit)),
            series: vec![Series::new("", Colour::Class(0), Mark::Line, closed)],
            ..Panel::default()
        }
    }

    fn rod_load(&self, throw: usize, load: &RodLoad) -> Panel {
        let reversal = load.reversal();
        let side = |name: &str, side: Side| {
            let angle = text::number(side.angle.to_degrees(), 3);
            format!("{name} {}, {angle}°", text::prefixed(side.peak, "N"))
        };
        let verdict = match reversal.is_sufficient() {
            true => "",
            false => "; below API 618",
        };
        let title = format!(
            "{}{}; {}{verdict}",
            self.of_throw(throw),
            side("tension", reversal.tension),
            side("compression", reversal.compression),
        );
        let curve = |name: &str, colour, mark, values: &[f64]| {
            Series::new(name, Colour::Class(colour), mark, over_revolution(values))
        };
        let band = |name: &str, colour, of: fn(f64, f64) -> f64| {
            let outline = in_direction(load, of);
            Series::new(name, Colour::Class(colour), Mark::Band, outline)
        };
        let zeros = load.zeros().into_iter();
        let zeros = zeros.map(|angle| [angle.to_degrees(), 0.0]);
        Panel {
            title: text::capitalised(&title),
            x: Axis::crank_angle(),
            y: Axis::linear("load, tension positive (kN)"),
            series: vec![
                band("tension", 3, f64::max),
                band("compression", 4, f64::min),
                curve("gas", 1, Mark::Line, &load.gas),
                curve("inertia", 2, Mark::Line, &load.inertia),
                curve("combined", 0, Mark::BoldLine, &load.combined),
                Series::new("", Colour::Ink, Mark::Line, [[0.0, 0.0], [360.0, 0.0]]),
                Series::new("change of direction", Colour::Ink, Mark::Rings, zeros),
            ],
            ..Panel::default()
        }
    }

    /// A panel for all pressures, one for each acceleration.
    fn waveforms(&self) -> Vec<Panel> {
        let of_unit = |unit: &'static str| self.channels.iter().filter(move |c| c.unit == unit);
        let pressures: Vec<&Channel> = of_unit("Pa").collect();
        let largest = pressures.iter().flat_map(|channel| &channel.samples);
        let largest = largest.fold(0.0_f64, |most, x| most.max(f64::from(*x)));
        let (scale, unit) = text::readable_unit(largest, "Pa");
        let mut panels = Vec::new();
        if !pressures.is_empty() {
            let series = pressures.iter().enumerate().flat_map(|(i, channel)| {
                self.waveform(channel, scale, Colour::Class(i + 1), &name(channel))
            });
            panels.push(Panel {
                title: "Pressure: each revolution, and the mean".to_owned(),
                x: Axis::crank_angle(),
                y: Axis::linear(text::with_unit("pressure", unit)),
                series: series.collect(),
                ..Panel::default()
            });
        }
        panels.extend(of_unit("m/s^2").map(|channel| Panel {
            title: text::capitalised(&name(channel)),
            x: Axis::crank_angle(),
            y: Axis::linear("acceleration (m/s²)"),
            series: self.waveform(channel, 1.0, Colour::Class(0), ""),
            ..Panel::default()
        }));
        if panels.is_empty() {
            panels.push(Panel {
                x: Axis::crank_angle(),
                note: "the machine has no sensor of pressure or acceleration".to_owned(),
                ..Panel::default()
            });
        }
        panels
    }

    fn waveform(&self, channel: &Channel, scale: f64, colour: Colour, name: &str) -> Vec<Series> {
        let values: Vec<f64> = channel
            .samples
            .iter()
            .map(|x| f64::from(*x) * scale)
            .collect();
        over_crank_angle(self.crank_angle_rad, &values, colour, name)
    }
}

/// The name of a channel in words, without its unit.
pub(crate) fn name(channel: &Channel) -> String {
    text::words(features::stem(&channel.name, &channel.unit))
}

/// Values at equal crank angles over a revolution, in kN, closed at 360°.
fn over_revolution(values: &[f64]) -> Vec<[f64; 2]> {
    let count = values.len().max(1) as f64;
    let closed = values.iter().chain(values.first()).enumerate();
    closed
        .map(|(j, value)| [360.0 * j as f64 / count, 1e-3 * value])
        .collect()
}

/// The outline of the load in one direction, along the curve and back along zero; `of` takes the load in this direction, or 0.
fn in_direction(load: &RodLoad, of: fn(f64, f64) -> f64) -> Vec<[f64; 2]> {
    let side = load.combined.iter().map(|load| of(*load, 0.0));
    let mut outline = over_revolution(&side.collect::<Vec<f64>>());
    outline.extend([[360.0, 0.0], [0.0, 0.0]]);
    outline
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_area_of_a_direction_has_the_other_left_out() {
        // 90° in tension, the rest in compression.
        let gas = (0..360).map(|j| if j < 90 { 2000.0 } else { -1000.0 });
        let load = RodLoad::new(gas.collect(), vec![0.0; 360]);
        let outline = in_direction(&load, f64::max);
        assert!(outline.iter().all(|[_, y]| (0.0..=2.0).contains(y)));
        let shaded = outline.iter().filter(|[_, y]| *y == 2.0).count();
        // The point at 360° repeats that at 0°.
        assert_eq!(shaded, 91);
    }
}
