//! A run as measured: its channels over the crank angle, and what in them repeats.

use crate::crank_motion;
use crate::error::Error;
use crate::few_revolutions;
pub use crate::sectors::POINTS;
use crate::sectors::{bands, between_orders, count, knocks, noise, scatter};
use mechanism::drive::GivenSpeed;
use serde_json::Value;
use signal::angle_resampling::AngleGrid;
use signal::crank_angle::CrankAngle;
use signal::order_lines::{OrderLines, deviations, order_lines};
use simulate::WarmStart;
use simulate::sensor::Quantity;
use std::f64::consts::TAU;
use std::ops::Range;

/// A recording that stands at its greatest or least value for this many samples is clipped.
const CLIPPED: usize = 4;
/// Share of a recording's range from which what neighbouring samples do not have in common is noise.
const NOISE: f64 = 1e-5;
/// Relative difference between stated and recorded speed that is a contradiction.
pub(crate) const SPEED: f64 = 0.02;
/// Orders that always count; higher ones do where they stand out of the noise.
const LOW_ORDERS: usize = 20;
/// Power over noise from which one order stands out: in noise alone one of fifty does.
const STANDS_OUT: f64 = 4.0;
/// Orders of a band, and mean power over noise from which a band stands out. Noise alone has a mean
/// of 1 with a standard deviation of a third.
const BAND: usize = 10;
const BAND_STANDS_OUT: f64 = 2.5;

/// A run of the machine, as a bundle of recordings has it.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// Its name.
    pub id: String,
    /// Paths of the machine file and the values that they have in this run.
    pub settings: Vec<(String, Value)>,
    /// Mean speed, rpm.
    pub speed_rpm: f64,
    /// Samples per second.
    pub sample_rate: f64,
    /// Whether the recording has times or a sample rate; if not, `sample_rate` is that of a crank which
    /// turns evenly at the stated speed.
    pub is_timed: bool,
    /// Crank angle of every sample in [0, 2π), rad.
    pub crank_angle: Option<Vec<f64>>,
    /// What was measured.
    pub channels: Vec<Channel>,
}

impl Run {
    /// The crank angles of the samples of the first whole revolution, rad, or of all samples without one;
    /// `None` where the angle is not known.
    pub fn first_revolution(&self) -> Option<&[f64]> {
        let angles = self.crank_angle.as_ref()?;
        let first = *angles.first()?;
        // From the second half of the revolution on, the next sample past the first ends it.
        let turned = |a: &f64| (a - first).rem_euclid(TAU);
        let half = angles.iter().position(|a| turned(a) > 0.5 * TAU)?;
        let rest = angles[half..].iter().position(|a| turned(a) < 0.5 * TAU);
        Some(&angles[..rest.map_or(angles.len(), |rest| half + rest)])
    }
}

/// A measured channel.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Name of its column, which says what it is: `crosshead_acceleration_m_s2`.
    pub column: String,
    /// The samples, SI.
    pub samples: Vec<f64>,
}

impl Channel {
    /// What kind of quantity it is.
    pub fn quantity(&self) -> Quantity {
        Quantity::of_column(&self.column)
    }
}

impl Observed {
    /// What kind of quantity it is.
    pub fn quantity(&self) -> Quantity {
        Quantity::of_column(&self.column)
    }
}

/// What a run shows of what the model predicts.
#[derive(Clone, Debug)]
pub struct Observation {
    /// The run's name.
    pub id: String,
    /// Its settings.
    pub settings: Vec<(String, Value)>,
    /// How its crank turned.
    pub crank: GivenSpeed,
    /// The observed channels.
    pub channels: Vec<Observed>,
    /// The motion from which its simulations go on; they begin at rest without one.
    pub warm_start: Option<WarmStart>,
}

/// The lines of one channel.
#[derive(Clone, Debug)]
pub struct Observed {
    /// Name of its column.
    pub column: String,
    /// Amplitudes and their noise.
    pub lines: OrderLines,
    /// The orders that are compared.
    pub orders: Vec<usize>,
    /// The energies by band and sector that its revolutions have beside the mean of every other one. Empty where that is not known.
    pub scatter: Vec<f64>,
}

/// Most of a channel's power that may differ from revolution to revolution in a motion that repeats
/// itself: noise of 14 % of the signal.
const SCATTER: f64 = 0.02;
/// The same of what is no noise, as it stands where something knocks: 5 % of the signal.
const KNOCKS: f64 = 0.0025;
/// How many times the least scatter of its runs a channel may have where it repeats itself.
const REPEATS: f64 = 4.0;

impl Observed {
    /// The least order that is the machine's. The mean of an acceleration is its sensor's; that of a pressure is the gas's, and
    /// may be all that there is of it.
    fn first_order(&self) -> usize {
        usize::from(!self.quantity().is_pressure())
    }

    /// Whether it has a line above its noise.
    fn stands_out(&self) -> bool {
        let lines = &self.lines;
        (self.first_order()..=LOW_ORDERS.min(lines.amplitude.len() - 1))
            .any(|k| lines.amplitude[k].norm_sqr() > STANDS_OUT * lines.variance[k])
    }

    /// What its revolutions have in common, and how much they differ from that: mean squares.
    fn power_and_scatter(&self) -> [f64; 2] {
        let lines = &self.lines;
        let first = self.first_order();
        let power = lines.amplitude.iter().skip(first);
        let power = power.map(|c| c.norm_sqr()).sum();
        let variance: f64 = lines.variance.iter().skip(1).sum();
        [power, lines.revolutions as f64 * variance]
    }

    /// How much of its revolutions' differences is no noise: a mean square.
    fn knocks(&self) -> f64 {
        let mut scatter = &self.scatter[..];
        let of_band = |orders: Range<usize>| {
            let count = count(&orders);
            let (of_band, rest) = scatter.split_at(count.min(scatter.len()));
            scatter = rest;
            let noise = noise(of_band, between_orders(&self.lines, orders));
            knocks(of_band, noise)
                .then(|| of_band.iter().map(|of| of - noise).sum::<f64>() / count as f64)
        };
        bands(&self.orders).filter_map(of_band).sum()
    }
}

impl Observation {
    /// Whether its revolutions are the same but for noise.
    pub(crate) fn repeats(&self) -> bool {
        self.channels.iter().all(|channel| {
            let [power, scatter] = channel.power_and_scatter();
            scatter <= SCATTER * power && channel.knocks() <= KNOCKS * power
        })
    }

    /// Whether it repeats itself as well as others of the same noise do. That may be the sensor's own
    /// or a share of what it measures, so both have to be exceeded.
    pub fn repeats_like(&self, others: &[Self]) -> bool {
        let of_channel = |channel: &Observed| {
            let [power, scatter] = channel.power_and_scatter();
            let same = others.iter().flat_map(|run| &run.channels);
            let same = same.filter(|other| other.column == channel.column);
            let [mut share, mut least] = [scatter / power, scatter];
            for [power, scatter] in same.map(Observed::power_and_scatter) {
                share = share.min(scatter / power);
                least = least.min(scatter);
            }
            scatter <= REPEATS * least || scatter <= REPEATS * share * power
        };
        self.repeats() && self.channels.iter().all(of_channel)
    }

    /// Looks at a run's channels of the given columns.
    ///
    /// # Errors
    /// No such channel, a channel that is clipped or noise alone, an angle that contradicts the
    /// speed.
    pub fn from_run(run: &Run, columns: &[String]) -> Result<Self, Error> {
        let chosen: Vec<&Channel> = run
            .channels
            .iter()
            .filter(|channel| columns.contains(&channel.column))
            .collect();
        let Some(first) = chosen.first() else {
            let names: Vec<&str> = run.channels.iter().map(|c| c.column.as_str()).collect();
            return Err(Error::NoChannel {
                run: run.id.clone(),
                found: names.join(", "),
                known: columns.join(", "),
            });
        };
        let angle = angle(run, first)?;
        let short = few_revolutions::is_short(&angle);
        let grid = AngleGrid::new(&angle, POINTS);
        let of_channel = |samples: &[f64]| {
            if short && let Some(lines) = few_revolutions::lines(&angle, samples) {
                return Ok((lines, Vec::new()));
            }
            let grid = grid.as_ref().map_err(Clone::clone)?;
            let revolutions = grid.resample(samples)?;
            let lines = order_lines(&revolutions, highest(grid))?;
            Ok((lines, deviations(&revolutions, highest(grid))))
        };
        let channels = chosen
            .into_iter()
            .map(|channel| {
                not_dead(run, channel)?;
                not_clipped(run, channel)?;
                let (lines, deviations) = of_channel(&channel.samples)
                    .map_err(|source| signal_error(run, channel, source))?;
                let orders = orders(&lines);
                let observed = Observed {
                    column: channel.column.clone(),
                    lines,
                    scatter: scatter(&orders, &deviations),
                    orders,
                };
                if observed.orders.len() <= LOW_ORDERS && !observed.stands_out() {
                    return Err(Error::OnlyNoise {
                        run: run.id.clone(),
                        channel: channel.column.clone(),
                    });
                }
                Ok(observed)
            })
            .collect::<Result<_, _>>()?;
        Ok(Self {
            id: run.id.clone(),
            settings: run.settings.clone(),
            crank: crank_motion::recorded(&angle, run.sample_rate),
            channels,
            warm_start: None,
        })
    }
}

/// The lines of samples on a grid of crank angles.
pub(crate) fn lines(grid: &AngleGrid, samples: &[f64]) -> Result<OrderLines, signal::Error> {
    order_lines(&grid.resample(samples)?, highest(grid))
}

/// The highest order that samples on a grid of crank angles have.
pub(crate) fn highest(grid: &AngleGrid) -> usize {
    grid.highest_order().min(POINTS / 2 - 1)
}

fn signal_error(run: &Run, channel: &Channel, source: signal::Error) -> Error {
    Error::Signal {
        run: run.id.clone(),
        channel: channel.column.clone(),
        source,
    }
}

/// The crank angle of every sample of a run, recorded or from its speed.
pub(crate) fn angle(run: &Run, first: &Channel) -> Result<CrankAngle, Error> {
    let error = |source| Error::Signal {
        run: run.id.clone(),
        channel: "crank_angle_rad".into(),
        source,
    };
    let Some(recorded) = &run.crank_angle else {
        let samples = first.samples.len();
        return CrankAngle::from_speed(samples, run.sample_rate, run.speed_rpm).map_err(error);
    };
    let angle = CrankAngle::from_encoder(recorded).map_err(error)?;
    let turns = TAU / angle.samples_per_revolution() * run.sample_rate;
    let measured = turns * 60.0 / TAU;
    if (measured / run.speed_rpm - 1.0).abs() > SPEED {
        return Err(Error::Speed {
            run: run.id.clone(),
            stated: run.speed_rpm,
            measured,
        });
    }
    Ok(angle)
}

/// What a sensor records is never the same from the first sample to the last.
fn not_dead(run: &Run, channel: &Channel) -> Result<(), Error> {
    match &channel.samples[..] {
        [value, others @ ..] if others.iter().all(|other| other == value) => Err(Error::Dead {
            run: run.id.clone(),
            channel: channel.column.clone(),
            value: *value,
            count: channel.samples.len(),
        }),
        _ => Ok(()),
    }
}

/// A vibration never stays at its greatest value, nor does a pressure in whose recording there is noise: while a valve is open, it
/// may stay there only up to the noise.
fn not_clipped(run: &Run, channel: &Channel) -> Result<(), Error> {
    let samples = || channel.samples.iter().copied();
    if !channel.quantity().is_vibration() && !is_noisy(&channel.samples) {
        return Ok(());
    }
    let extremes = [samples().reduce(f64::max), samples().reduce(f64::min)];
    for (value, limit) in extremes.into_iter().zip(["greatest", "least"]) {
        let value = value.unwrap_or(0.0);
        let (mut longest, mut count) = (0, 0);
        for x in &channel.samples {
            count = if *x == value { count + 1 } else { 0 };
            longest = longest.max(count);
        }
        if longest >= CLIPPED {
            return Err(Error::Clipped {
                run: run.id.clone(),
                channel: channel.column.clone(),
                count: longest,
                limit,
                value,
            });
        }
    }
    Ok(())
}

/// Whether most samples have noise that their resolution does not hide: a fourth difference beyond what [`NOISE`] of the range and
/// two steps of the resolution give. A smooth pressure of 360 samples a revolution has 1e-7 of its range.
fn is_noisy(samples: &[f64]) -> bool {
    let steps = samples.windows(2).map(|w| (w[1] - w[0]).abs());
    let resolution = steps
        .filter(|step| *step > 0.0)
        .fold(f64::INFINITY, f64::min);
    let [least, greatest] = samples
        .iter()
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
            [low.min(*x), high.max(*x)]
        });
    let fourth = |w: &[f64]| (w[0] - 4.0 * w[1] + 6.0 * w[2] - 4.0 * w[3] + w[4]).abs();
    let mut noise: Vec<f64> = samples.windows(5).map(fourth).collect();
    if noise.is_empty() {
        return false;
    }
    let middle = noise.len() / 2;
    let (_, median, _) = noise.select_nth_unstable_by(middle, f64::total_cmp);
    // The sum of the squared coefficients is 70; a median of absolute values is 0.67 of a standard deviation.
    let deviation = *median / (70f64.sqrt() * 0.6745);
    deviation > 2.0 * resolution && deviation > NOISE * (greatest - least)
}

/// All orders up to the last [`BAND`] whose mean power stands out of the noise. Choosing them one by
/// one would choose those in which the noise happens to be great. The mean of an acceleration is its
/// sensor's, not the machine's; pressures have an order 0.
fn orders(lines: &OrderLines) -> Vec<usize> {
    let over_noise: Vec<f64> = lines
        .amplitude
        .iter()
        .zip(&lines.variance)
        .map(|(c, variance)| c.norm_sqr() / variance.max(f64::MIN_POSITIVE))
        .collect();
    let last = over_noise
        .windows(BAND)
        .rposition(|band| band.iter().sum::<f64>() > BAND_STANDS_OUT * BAND as f64)
        .map_or(0, |first| first + BAND - 1);
    (0..=last.max(LOW_ORDERS).min(lines.amplitude.len() - 1)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use signal::Complex64;

    fn run(amplitude: f64, scatter: f64) -> Observation {
        let lines = OrderLines {
            amplitude: vec![Complex64::ZERO, Complex64::from(amplitude)],
            variance: vec![0.0, scatter / 10.0],
            revolutions: 10,
        };
        Observation {
            id: String::new(),
            settings: Vec::new(),
            crank: GivenSpeed {
                speed: 50.0,
                fluctuation: Vec::new(),
            },
            channels: vec![Observed {
                scatter: Vec::new(),
                column: "crosshead_acceleration_m_s2".into(),
                lines,
                orders: vec![1],
            }],
            warm_start: None,
        }
    }

    #[test]
    fn a_run_repeats_unless_it_scatters_more_than_others_by_any_reading_of_their_noise() {
        let quiet = run(10.0, 0.02);
        // The noise of a stronger signal may be greater, that of a weaker one a greater share of it.
        let strong = run(40.0, 0.32);
        let weak = run(1.0, 0.02);
        let restless = run(10.0, 0.3);
        let all = [quiet, strong, weak, restless];
        let repeats = all.each_ref().map(|run| run.repeats_like(&all));
        assert_eq!(repeats, [true, true, true, false]);
    }

    #[test]
    fn a_run_of_period_two_repeats_and_one_that_knocks_now_and_then_does_not() {
        // A knock of order 9, which band and sectors of the lowest octave show.
        let orders: Vec<usize> = (0..=15).collect();
        let knock = |size: f64| -> Vec<Complex64> {
            let line =
                |k: &usize| Complex64::from_polar(if *k < 8 { 0.0 } else { size }, -(*k as f64));
            orders.iter().map(line).collect()
        };
        let repeats = |sizes: &[f64]| {
            let revolutions: Vec<Vec<Complex64>> = sizes.iter().map(|size| knock(*size)).collect();
            let mut run = run(10.0, 0.02);
            let channel = &mut run.channels[0];
            channel.orders = orders.clone();
            channel.scatter = scatter(&orders, &revolutions);
            run.repeats()
        };
        assert!(repeats(&[0.5, -0.5, 0.5, -0.5, 0.5, -0.5, 0.5, -0.5]));
        assert!(!repeats(&[0.5, -0.5, -0.5, 0.5, 0.5, -0.5, -0.5, 0.5]));
        assert!(repeats(&[
            0.05, -0.05, -0.05, 0.05, 0.05, -0.05, -0.05, 0.05
        ]));
    }

    #[test]
    fn the_limit_at_which_a_channel_is_clipped_is_named_and_a_dead_one_is_called_dead() {
        let run = Run {
            id: "a".into(),
            settings: Vec::new(),
            speed_rpm: 600.0,
            sample_rate: 1000.0,
            is_timed: true,
            crank_angle: None,
            channels: Vec::new(),
        };
        let limited = |limits: [f64; 2]| {
            let wave = (0..100).map(|i| (0.1 * f64::from(i)).sin().clamp(limits[0], limits[1]));
            Channel {
                column: "crosshead_acceleration_m_s2".into(),
                samples: wave.collect(),
            }
        };
        let dead = not_dead(&run, &limited([2.0, 2.0]))
            .unwrap_err()
            .to_string();
        assert!(
            dead.contains("the value 2 in each of its 100 samples"),
            "{dead}"
        );
        let clipped = |limits: [f64; 2]| {
            let channel = limited(limits);
            not_dead(&run, &channel).unwrap();
            not_clipped(&run, &channel).unwrap_err().to_string()
        };
        let least = clipped([-0.5, 1.0]);
        assert!(least.ends_with("stand at its least value -0.5"), "{least}");
        let greatest = clipped([-1.0, 0.5]);
        assert!(
            greatest.ends_with("stand at its greatest value 0.5"),
            "{greatest}"
        );
    }

    /// A pressure of an ideal valve, with a noise and a resolution, all in parts of its range.
    fn plateau(noise: f64, resolution: f64) -> Vec<f64> {
        let sample = |i: u32| {
            let wave = (f64::from(i) * TAU / 360.0).cos().min(0.5);
            // Digits of a multiple of an irrational number scatter evenly.
            let scatter = (f64::from(i) * 0.618_033_988_749_895).fract() - 0.5;
            ((wave + noise * scatter) / resolution).round() * resolution
        };
        (0..3600).map(sample).collect()
    }

    #[test]
    fn a_pressure_may_stay_at_its_greatest_value_where_there_is_no_noise_to_be_seen() {
        assert!(!is_noisy(&plateau(0.0, 1e-12)) && !is_noisy(&plateau(0.0, 1e-3)));
        assert!(!is_noisy(&plateau(1e-3, 1e-3)));
        assert!(is_noisy(&plateau(1e-2, 1e-3)) && is_noisy(&plateau(1e-3, 1e-12)));
    }
}
