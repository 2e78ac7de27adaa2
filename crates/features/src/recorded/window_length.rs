//! How long windows are.

use crate::FEWEST_SAMPLES;
use input::quantity::{AboveZero, Duration, Quantity};
use recordings::measured::Length;

/// The window of long files where none is asked for, s, or in samples where those last longer.
const DEFAULT_S: f64 = 10.0;
const DEFAULT_SAMPLES: f64 = 1e5;

/// The longest window, in samples: its analysis takes about 100 bytes for each.
const MOST_SAMPLES: f64 = (1 << 24) as f64;

/// How long the windows are to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WindowLength {
    /// The whole of a short recording, stretches of a set length of a longer one.
    Default,
    /// So many seconds.
    Seconds(f64),
    /// So many revolutions of the crank.
    Revolutions(f64),
    /// The same; rows of a table are one window each, as they are.
    RevolutionsOrRows(f64),
}

impl WindowLength {
    /// A duration (`2 s`) or revolutions (`10 revolutions`).
    ///
    /// # Errors
    /// What was found instead.
    pub fn parse(text: &str) -> Result<Self, String> {
        if let Some((number, "revolution" | "revolutions" | "rev")) = text.trim().rsplit_once(' ')
            && let Some(count) = number
                .trim()
                .parse()
                .ok()
                .filter(|c: &f64| c.is_finite() && *c > 0.0)
        {
            return Ok(Self::Revolutions(count));
        }
        Quantity::<Duration, AboveZero>::parse(text).map(|seconds| Self::Seconds(seconds.si()))
    }

    /// The length in samples; `whole` where a recording is a window by itself.
    pub(super) fn in_samples(
        self,
        sample_rate_hz: f64,
        speed_rpm: Option<f64>,
        whole: bool,
    ) -> Result<Length, String> {
        let samples = match (self, speed_rpm) {
            (Self::Default | Self::RevolutionsOrRows(_), _) if whole => {
                return Ok(Length::UpTo(MOST_SAMPLES as usize));
            }
            (Self::Default, _) => {
                let most = (DEFAULT_S * sample_rate_hz).clamp(DEFAULT_SAMPLES, MOST_SAMPLES);
                return Ok(Length::UpTo(most as usize));
            }
            (Self::Seconds(seconds), _) => seconds * sample_rate_hz,
            (Self::Revolutions(count) | Self::RevolutionsOrRows(count), Some(speed)) => {
                count * 60.0 / speed * sample_rate_hz
            }
            (Self::Revolutions(_) | Self::RevolutionsOrRows(_), None) => {
                return Err(
                    "a window in revolutions needs the speed: give --speed, --tacho or --crank-angle, or --window in seconds"
                        .into(),
                );
            }
        };
        if samples < FEWEST_SAMPLES as f64 {
            return Err(format!(
                "a window has {samples:.1} samples, but at least {FEWEST_SAMPLES} are needed"
            ));
        }
        if samples > MOST_SAMPLES {
            return Err(format!(
                "a window has {samples:.0} samples, but at most {MOST_SAMPLES} are possible"
            ));
        }
        Ok(Length::Equal(samples))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_are_seconds_or_revolutions() {
        let parse = WindowLength::parse;
        assert_eq!(parse("2 s").unwrap(), WindowLength::Seconds(2.0));
        assert_eq!(
            parse("10 revolutions").unwrap(),
            WindowLength::Revolutions(10.0)
        );
        for wrong in ["2", "-2 s", "0 revolutions", "x revolutions", "2 m", ""] {
            assert!(parse(wrong).is_err(), "{wrong}");
        }
        let length = |asked: WindowLength, speed| asked.in_samples(1000.0, speed, false);
        assert_eq!(
            length(WindowLength::Revolutions(10.0), Some(600.0)),
            Ok(Length::Equal(1000.0))
        );
        assert_eq!(
            length(WindowLength::Default, None),
            Ok(Length::UpTo(100_000))
        );
        assert!(length(WindowLength::Revolutions(10.0), None).is_err());
        assert!(length(WindowLength::Seconds(0.05), None).is_err());
        assert!(length(WindowLength::Seconds(1e6), None).is_err());
    }
}
