//! A column of time: the sample rate that follows from it, and where samples are missing.

use super::names::TimeUnit;
use super::stated::{CLEAR_FROM_HZ, StatedRate, agree};
use crate::Error;
use std::path::Path;

/// Share of the first steps that must be alike to determine a rate.
const REGULAR: f64 = 0.9;

/// A column of time in a file.
#[derive(Clone, Debug)]
pub(crate) struct TimeColumn {
    pub(crate) name: String,
    pub(crate) unit: TimeUnit,
    /// Whether the file has it in single precision: its steps then grow uneven with time.
    pub(crate) single_precision: bool,
}

/// Follows the times of a recording sample by sample.
#[derive(Debug)]
pub(crate) struct Clock {
    column: TimeColumn,
    seconds_per_unit: f64,
    step_s: f64,
    /// To what the times are rounded where that is more than a step, s; 0 elsewhere.
    rounding_s: f64,
    last_s: Option<f64>,
    sample: u64,
}

impl Clock {
    /// From the first times of a recording, in the unit of the column, and the rate stated
    /// elsewhere, if it is. `place` says where a sample stands in the file.
    pub(crate) fn new(
        path: &Path,
        column: TimeColumn,
        times: &[f64],
        stated: Option<&StatedRate>,
        place: &dyn Fn(u64) -> String,
    ) -> Result<Self, Error> {
        let stated_hz = stated.map(|stated| stated.hz);
        let refuse = |reason: String| Err(Error::time(path, &column.name, reason));
        if let Some(sample) = times.iter().position(|t| !t.is_finite()) {
            return refuse(format!("{} has no time", place(sample as u64)));
        }
        let steps: Vec<f64> = times.windows(2).map(|t| t[1] - t[0]).collect();
        let scale = match seconds_per_unit(&column, median(&steps), stated_hz) {
            Ok(scale) => scale,
            Err(reason) => return refuse(reason),
        };
        let steps: Vec<f64> = steps.iter().map(|step| step * scale).collect();
        let of_step = |column, step_s, rounding_s| Self {
            column,
            seconds_per_unit: scale,
            step_s,
            rounding_s,
            last_s: None,
            sample: 0,
        };
        let found = match (median(&steps), stated_hz) {
            (None, Some(stated)) => 1.0 / stated,
            (None, None) => return refuse("one sample determines no rate".into()),
            (Some(median), _) => {
                let slack = resolution(&column, times[times.len() - 1] * scale);
                let alike = |step: &&f64| (*step - median).abs() <= 0.5 * median + slack;
                let alike: Vec<f64> = steps.iter().filter(alike).copied().collect();
                if median <= 0.0 || (alike.len() as f64) < REGULAR * steps.len() as f64 {
                    let rounding_s = rounding(&steps);
                    if rounding_s.is_some_and(|rounding| are_even(&steps, stated_hz, rounding)) {
                        let Some(stated) = stated_hz else {
                            return refuse(format!(
                                "the times are rounded to {:.3e} s, too coarsely to determine the sample rate: state it",
                                rounding_s.unwrap_or_default()
                            ));
                        };
                        return Ok(of_step(
                            column,
                            1.0 / stated,
                            rounding_s.unwrap_or_default(),
                        ));
                    }
                    if let Some(at) = steps.iter().position(|step| *step <= 0.0) {
                        let of_pair = (times[at] * scale, times[at + 1] * scale);
                        let back = not_ahead(&place(at as u64 + 1), of_pair);
                        let backwards = median < 0.0;
                        return refuse(match backwards {
                            true => format!("the times run backwards: {back}"),
                            false => format!("the times are not evenly spaced: {back}{DOUBT}"),
                        });
                    }
                    let least = steps.iter().copied().fold(f64::INFINITY, f64::min);
                    let most = steps.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                    return refuse(format!(
                        "the times are not evenly spaced: steps from {least:.3e} to {most:.3e} s"
                    ));
                }
                alike.iter().sum::<f64>() / alike.len() as f64
            }
        };
        let found_hz = whole(1.0 / found);
        if !(found_hz.is_finite() && found_hz > 0.0) {
            return refuse(format!("the times are steps of {found:e} s"));
        }
        let Some(stated) = stated else {
            return Ok(of_step(column, 1.0 / found_hz, 0.0));
        };
        if !agree(stated.hz, found_hz) {
            let says = match &stated.heading {
                None => format!("the sample rate is said to be {} Hz", stated.hz),
                Some(place) => format!(
                    "{place}, says {} Hz: state the sample rate that is right",
                    stated.hz
                ),
            };
            return refuse(format!(
                "the times are those of {found_hz:.6} Hz, but {says}"
            ));
        }
        let hz = match stated.heading {
            None => stated.hz,
            Some(_) => found_hz,
        };
        Ok(of_step(column, 1.0 / hz, 0.0))
    }

    pub(crate) fn sample_rate_hz(&self) -> f64 {
        1.0 / self.step_s
    }

    /// A time of the column in seconds.
    pub(crate) fn seconds(&self, time: f64) -> f64 {
        time * self.seconds_per_unit
    }

    /// Goes on to the next sample: the time that is missing before it, if samples are.
    pub(crate) fn tick(
        &mut self,
        path: &Path,
        time: f64,
        place: &dyn Fn(u64) -> String,
    ) -> Result<Option<f64>, Error> {
        let time_s = self.seconds(time);
        let sample = self.sample;
        if !time_s.is_finite() {
            let reason = format!("{} has no time", place(sample));
            return Err(Error::time(path, &self.column.name, reason));
        }
        self.sample += 1;
        let Some(last_s) = self.last_s.replace(time_s) else {
            return Ok(None);
        };
        let slack = 0.5 * self.step_s + self.rounding_s + resolution(&self.column, time_s);
        let excess = time_s - last_s - self.step_s;
        if excess < -slack {
            return Err(Error::time(
                path,
                &self.column.name,
                not_ahead(&place(sample), (last_s, time_s)) + DOUBT,
            ));
        }
        Ok((excess > slack).then_some(excess))
    }
}

/// Units that a column of time may have where its heading states none, with their seconds.
const UNITS: [(&str, f64); 3] = [("s", 1.0), ("ms", 1e-3), ("us", 1e-6)];

/// The seconds of a column's unit. Where the heading states none, it is the one with which the times have about the stated rate.
/// Without a stated rate it is the second, if times in it have a rate of at least [`CLEAR_FROM_HZ`].
fn seconds_per_unit(
    column: &TimeColumn,
    step: Option<f64>,
    stated_hz: Option<f64>,
) -> Result<f64, String> {
    let step = match (column.unit, step) {
        (TimeUnit::Seconds(seconds), _) => return Ok(seconds),
        (TimeUnit::Unstated, Some(step)) if step > 0.0 => step,
        (TimeUnit::Unstated, _) => return Ok(1.0),
    };
    let rate_hz = |seconds: f64| 1.0 / (step * seconds);
    if let Some(stated_hz) = stated_hz {
        let is_near = |seconds: &f64| (0.7..1.4).contains(&(rate_hz(*seconds) / stated_hz));
        let mut units = UNITS.into_iter().map(|(_, seconds)| seconds);
        return Ok(units.find(is_near).unwrap_or(1.0));
    }
    let in_seconds_hz = rate_hz(1.0);
    if in_seconds_hz >= CLEAR_FROM_HZ || agree(in_seconds_hz, CLEAR_FROM_HZ) {
        return Ok(1.0);
    }
    let shown = |hz: f64| (hz * 1e3).round() / 1e3;
    let rates =
        UNITS.map(|(unit, seconds)| format!("{} Hz if it is {unit}", shown(rate_hz(seconds))));
    Err(format!(
        "its heading has no unit: the sample rate would be {}; write the unit into the heading, such as `{} [ms]`, or state the \
         sample rate",
        rates.join(", "),
        column.name
    ))
}

/// What a time that is not ahead of the one before says of its file.
const DOUBT: &str = ": a time is wrong, or the file is damaged";

/// That the later of two times, s, is not ahead of the earlier one.
fn not_ahead(place: &str, (before_s, time_s): (f64, f64)) -> String {
    format!("{place} is at {time_s} s, the one before at {before_s} s")
}

/// To what times with these steps may be rounded, s: the least of them that is one.
fn rounding(steps: &[f64]) -> Option<f64> {
    let least = steps
        .iter()
        .copied()
        .filter(|step| *step > 0.0)
        .min_by(f64::total_cmp)?;
    steps.iter().all(|step| *step >= 0.0).then_some(least)
}

/// Whether these are the steps of even times of this rate, or of any, that were rounded.
fn are_even(steps: &[f64], rate_hz: Option<f64>, rounding_s: f64) -> bool {
    let mean = steps.iter().sum::<f64>() / steps.len() as f64;
    let step_s = rate_hz.map_or(mean, |rate| 1.0 / rate);
    let mut off = 0.0_f64;
    // Each of two times is off by up to half of the rounding, or by all of it where times are cut.
    steps.iter().all(|step| {
        off += step - step_s;
        off.abs() <= rounding_s * (1.0 + 1e-6)
    })
}

/// The rounding of a time that was stored in single precision, s.
fn resolution(column: &TimeColumn, time_s: f64) -> f64 {
    if column.single_precision {
        f64::from(f32::EPSILON) * time_s.abs()
    } else {
        0.0
    }
}

/// Times are rounded; a rate within 1e-5 of a whole number of Hz is that.
fn whole(rate_hz: f64) -> f64 {
    let rounded = rate_hz.round();
    if (rate_hz - rounded).abs() <= 1e-5 * rate_hz {
        rounded
    } else {
        rate_hz
    }
}

fn median(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(number: u64) -> String {
        format!("sample {number}")
    }

    fn clock(times: &[f64], stated: Option<f64>) -> Result<Clock, Error> {
        let column = TimeColumn {
            name: "t".into(),
            unit: TimeUnit::Seconds(1.0),
            single_precision: false,
        };
        let stated = stated.map(StatedRate::number);
        Clock::new(Path::new("a.csv"), column, times, stated.as_ref(), &sample)
    }

    fn times(rate: f64, count: usize) -> Vec<f64> {
        (0..count).map(|i| i as f64 / rate).collect()
    }

    #[test]
    fn the_rate_follows_from_times_rounded_to_six_digits() {
        let rounded: Vec<f64> = times(44_100.0, 4096)
            .iter()
            .map(|t| (t * 1e6).round() / 1e6)
            .collect();
        let rate = clock(&rounded, None).unwrap().sample_rate_hz();
        assert!((rate / 44_100.0 - 1.0).abs() < 1e-9, "{rate}");
    }

    #[test]
    fn times_in_single_precision_are_even_enough() {
        let single: Vec<f64> = times(20_000.0, 4_000_000)
            .iter()
            .map(|t| f64::from(*t as f32))
            .collect();
        let column = TimeColumn {
            name: "t".into(),
            unit: TimeUnit::Seconds(1.0),
            single_precision: true,
        };
        let mut clock = Clock::new(Path::new("a"), column, &single[..4096], None, &sample).unwrap();
        assert_eq!(clock.sample_rate_hz(), 20_000.0);
        for time in single {
            assert_eq!(clock.tick(Path::new("a"), time, &sample).unwrap(), None);
        }
    }

    #[test]
    fn gaps_are_measured_and_backward_steps_refused() {
        let even = times(1000.0, 100);
        let mut clock = clock(&even, None).unwrap();
        let path = Path::new("a");
        assert_eq!(clock.tick(path, 0.0, &sample).unwrap(), None);
        assert_eq!(clock.tick(path, 0.0012, &sample).unwrap(), None);
        let gap = clock.tick(path, 0.5022, &sample).unwrap().unwrap();
        assert!((gap - 0.5).abs() < 1e-12);
        let message = clock.tick(path, 0.4, &sample).unwrap_err().to_string();
        assert_eq!(
            message,
            "`a`, column `t`: sample 3 is at 0.4 s, the one before at 0.5022 s: a time is wrong, or the file is damaged"
        );
        assert!(clock.tick(path, f64::NAN, &sample).is_err());
    }

    #[test]
    fn times_that_are_rounded_to_more_than_a_step_need_the_rate() {
        let rounded: Vec<f64> = times(4000.0, 400)
            .iter()
            .map(|t| (t * 1e3).round() / 1e3)
            .collect();
        let message = clock(&rounded, None).unwrap_err().to_string();
        assert!(message.contains("rounded to 1.000e-3 s"), "{message}");
        let mut clock = clock(&rounded, Some(4000.0)).unwrap();
        assert_eq!(clock.sample_rate_hz(), 4000.0);
        let path = Path::new("a");
        for time in &rounded {
            assert_eq!(clock.tick(path, *time, &sample).unwrap(), None);
        }
        assert!(clock.tick(path, 0.2, &sample).unwrap().unwrap() > 0.09);
        assert!(clock.tick(path, 0.1, &sample).is_err());
    }

    #[test]
    fn contradictions_are_refused() {
        let message = |times: &[f64], stated| clock(times, stated).unwrap_err().to_string();
        assert!(message(&times(1000.0, 50), Some(2000.0)).contains("those of 1000"));
        assert!(message(&[0.0; 50], None).contains("not evenly spaced: sample 1 is at 0 s"));
        assert!(
            message(&[3.0, 2.0, 1.0], None)
                .contains("run backwards: sample 1 is at 2 s, the one before at 3 s")
        );
        assert!(message(&[0.0, 1.0, 5.0, 5.5, 9.0, 20.0], None).contains("not evenly spaced"));
        assert!(message(&[0.0, f64::NAN], None).contains("sample 1 has no time"));
        assert!(message(&[0.0], None).contains("one sample"));
        assert_eq!(clock(&[0.0], Some(5.0)).unwrap().sample_rate_hz(), 5.0);
    }
}
