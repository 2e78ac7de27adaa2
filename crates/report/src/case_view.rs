//! One case of a sweep, simulated again for a page: its figures, its labels, and the command that makes it again.

use crate::Error;
use crate::case_picture::CasePicture;
use crate::plate::Plate;
use crate::run_figures::{self, RunFigures};
use askama::Template;
use figure::{Axis, Colour, Figure, Mark, Panel, Series, in_rows};
use recordings::{FailedCase, Value};
use signal::channel::Channel;
use simulate::{Record, Trace, measure};
use std::f64::consts::{PI, TAU};
use std::ops::ControlFlow;
use std::path::Path;
use study::classes;
use study::recording::Recording;
use study::words;
use sweep::reader::SignalRow;
use sweep::run_analysis::RunAnalysis;
use sweep::{Case, Plan};

/// Most samples a channel of a case that is shown: one of 20 revolutions at 500 rpm and 10 kHz has 24 000.
const LONGEST_CASE: f64 = 1e6;
/// Panels of spectra and of joints side by side.
const COLUMNS: usize = 3;

/// A case of a sweep that was simulated again.
#[derive(Clone, Debug)]
pub struct CaseView {
    case: Case,
    record: Record,
    channels: Vec<Channel>,
    /// Names of the throws; one empty name in a machine of one.
    throws: Vec<String>,
    labels: Vec<[String; 2]>,
    again: String,
}

#[derive(Template)]
#[template(path = "case_view.html")]
struct View<'a> {
    plates: Vec<Plate>,
    labels: &'a [[String; 2]],
    again: &'a str,
}

impl CaseView {
    /// Simulates case `index` of `plan`, which stands in the file `sweep`. `watch` receives the share of the run that
    /// is done, and a break ends the run.
    ///
    /// # Errors
    /// [`study::Error::Motion`] for a case that is too long for a page, or whose simulation fails or is ended;
    /// [`Error::Machine`] for one that is no machine.
    pub fn simulate(
        plan: &Plan,
        sweep: &Path,
        index: u64,
        watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
    ) -> Result<Self, Error> {
        let case = plan.case(index)?;
        let again = FailedCase::command_of(sweep, &case.id);
        let failed = |reason: String| {
            let case_id = case.id.clone();
            Error::Study(study::Error::Motion { case_id, reason })
        };
        let (machine, sensors) = (&case.resolved.machine, &case.resolved.sensors);
        let recorded = case.settings.check(case.resolved.speed);
        recorded.map_err(|error| failed(error.to_string()))?;
        let revolutions = f64::from(case.settings.revolutions);
        let samples = revolutions * case.settings.sample_rate * TAU / case.resolved.speed.abs();
        if samples > LONGEST_CASE {
            return Err(failed(format!(
                "it has {} samples a channel, and a page shows at most {}: {again}",
                text::number(samples, 3),
                text::number(LONGEST_CASE, 3),
            )));
        }
        let record = simulate::simulate_watched(machine, sensors, &case.settings, watch);
        let record = record.map_err(|error| failed(error.to_string()))?;
        Ok(Self {
            channels: measure(&record, sensors, &machine.throw_names(), &mut case.noise()),
            throws: plan.throws().to_vec(),
            labels: labels(plan, &case),
            case,
            record,
            again,
        })
    }

    /// The view as a fragment of HTML: `<figure>` elements with the markup that the script of the pages makes
    /// interactive, a table of the labels, and the command.
    ///
    /// # Errors
    /// [`Error::Template`] if the template cannot be filled in.
    pub fn render(&self) -> Result<String, Error> {
        let view = View {
            plates: self.plates(),
            labels: &self.labels,
            again: &self.again,
        };
        Ok(view.render()?)
    }

    fn plates(&self) -> Vec<Plate> {
        let Some(trace) = &self.record.trace else {
            return Vec::new();
        };
        let mut plates = Vec::new();
        let machine = &self.case.resolved.machine;
        // A record of less than a revolution has neither cards nor loads.
        let analysis = RunAnalysis::new(machine, &self.record, &self.channels).ok();
        let crank_angle_rad = self.crank_angles(trace);
        let figures = analysis.as_ref().map(|analysis| {
            let run = RunFigures {
                title: "",
                analysis,
                crank_angle_rad: &crank_angle_rad,
                channels: &self.channels,
            };
            run.figures()
        });
        let [cards, loads, waveforms] = figures.map_or_else(Default::default, |all| all.map(Some));
        let mut add = |heading: &str, caption: &str, figure: Option<Figure>| {
            plates.extend(figure.map(|figure| Plate {
                heading: heading.to_owned(),
                caption: caption.to_owned(),
                figure,
                ..Plate::default()
            }));
        };
        add(
            "Pressure and acceleration",
            "As the sensors record them, with their noise: the last revolutions and their mean.",
            waveforms,
        );
        add(
            "Spectra of the acceleration",
            "Amplitude spectrum (rms over stretches of two revolutions), order spectrum (rms over the revolutions), and \
             spectrum of the envelope in the most impulsive band.",
            of_panels(self.spectra(&crank_angle_rad)),
        );
        add(
            "p-V cards",
            "Pressure in each chamber over its volume, in the mean revolution.",
            cards,
        );
        add(
            "Rod load",
            "Gas, inertia and combined load at the crosshead pin, in the mean revolution.",
            loads,
        );
        add(
            "Motion in the joints",
            "Acceleration of the crosshead over its velocity, and the orbit of each journal in its clearance circle, as the \
             equations give them, without sensors.",
            of_panels(self.motion(trace)),
        );
        plates
    }

    /// The crank angle at each sample of the channels, rad.
    fn crank_angles(&self, trace: &Trace) -> Vec<f64> {
        let angles = trace.crank_angle.iter().step_by(trace.stride.max(1));
        angles.copied().collect()
    }

    /// The spectra of each acceleration; of one that has none nothing.
    fn spectra(&self, crank_angle_rad: &[f64]) -> Vec<Panel> {
        let accelerations = self.channels.iter().filter(|c| c.unit == "m/s^2");
        let of = |channel: &Channel| {
            let recording = Recording::analyse(SignalRow {
                file: String::new(),
                place: String::new(),
                case_id: self.case.id.clone(),
                speed_rpm: self.record.mean_speed.abs() * 30.0 / PI,
                sample_rate_hz: self.record.sample_rate,
                channels: vec![channel.samples.iter().map(|x| f64::from(*x)).collect()],
                crank_angle: Some(crank_angle_rad.to_vec()),
            });
            let recording = recording.ok()?;
            let name = text::capitalised(&run_figures::name(channel));
            let spectrum = recording.spectrum().ok()?;
            let frequency = Axis {
                fundamental: Some(spectrum.fundamental),
                ..Axis::linear("frequency (Hz)")
            };
            let orders = recording.order_spectrum().ok()?;
            let envelope = recording.envelope_spectrum();
            let note = match envelope {
                Some(_) => "",
                None => "no impulsive band found",
            };
            let (at, envelope) = envelope.unwrap_or_default();
            Some([
                panel(name, frequency, &spectrum.at, &spectrum.amplitude_m_s2),
                panel("Orders", Axis::orders(), &orders.at, &orders.amplitude_m_s2),
                Panel {
                    note: note.to_owned(),
                    ..panel("Envelope", Axis::orders(), &at, &envelope)
                },
            ])
        };
        accelerations.filter_map(of).flatten().collect()
    }

    /// The portrait and the orbits of each throw.
    fn motion(&self, trace: &Trace) -> Vec<Panel> {
        let of = |(i, throw): (usize, &String)| {
            let picture = CasePicture::of_throw("", trace, i)?;
            let name = before(throw);
            let named = picture.motion().into_iter().map(move |panel| Panel {
                title: format!("{name}{}", panel.title),
                ..panel
            });
            Some(named)
        };
        let throws = self.throws.iter().enumerate();
        throws.filter_map(of).flatten().collect()
    }
}

/// The name of a throw before what is said of it; empty in a machine of one.
fn before(throw: &str) -> String {
    match throw {
        "" => String::new(),
        name => format!("{}: ", text::words(name)),
    }
}

/// A figure of panels side by side; none without panels.
fn of_panels(panels: Vec<Panel>) -> Option<Figure> {
    (!panels.is_empty()).then(|| Figure {
        rows: in_rows(panels, COLUMNS),
        width: 1000.0,
        ..Figure::default()
    })
}

/// Amplitudes over what `x` says.
fn panel(title: impl Into<String>, x: Axis, at: &[f64], amplitude_m_s2: &[f64]) -> Panel {
    let points = at.iter().zip(amplitude_m_s2).map(|(&x, &y)| [x, y]);
    Panel {
        title: title.into(),
        x,
        y: Axis::log("amplitude (m/s²)"),
        series: vec![Series::new("", Colour::Class(0), Mark::Line, points)],
        ..Panel::default()
    }
}

/// What sets the case apart, each with its value.
fn labels(plan: &Plan, case: &Case) -> Vec<[String; 2]> {
    let mut labels = vec![
        ["fault".to_owned(), classes::name(&case.labels.fault)],
        ["split".to_owned(), case.split.name().to_owned()],
        [
            "speed".to_owned(),
            text::quantity(case.operating_point.speed_rpm, "rpm"),
        ],
    ];
    let throws = plan.throws().iter().zip(&case.operating_point.pressures_pa);
    for (throw, pressures) in throws {
        let of_throw = before(throw);
        for (side, pressure) in ["suction", "discharge"].iter().zip(pressures) {
            labels.push([
                format!("{of_throw}{side} pressure"),
                readable(*pressure, "Pa"),
            ]);
        }
    }
    let joints = plan.joints.iter().zip(&case.labels.clearances_m);
    labels.extend(joints.map(|(joint, clearance)| {
        let value = match *clearance {
            0.0 => "none".to_owned(),
            clearance => text::clearance(clearance),
        };
        [format!("clearance of {}", text::words(&joint.name)), value]
    }));
    labels.extend(plan.parameters.iter().filter_map(|parameter| {
        let unit = parameter.unit.as_deref().unwrap_or_default();
        let value = match parameter.value(&case.tree) {
            Value::Real(value) => readable(value, &text::unit(unit)),
            Value::Integer(value) => value.to_string(),
            Value::Flag(value) => value.to_string(),
            Value::Text(value) => value,
            Value::Samples(_) | Value::Missing => return None,
        };
        Some([words::of_path(&parameter.path), value])
    }));
    labels
}

/// A value in the unit that suits it.
fn readable(value: f64, unit: &str) -> String {
    let (factor, unit) = text::readable_unit(value, unit);
    text::quantity(value * factor, unit)
}
