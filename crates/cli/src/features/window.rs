//! How long windows are.

use crate::Failure;
use ::features::FEWEST_SAMPLES;
use input::quantity::{AboveZero, Duration, Quantity};
use recordings::measured::Length;

/// The window of long files where none is asked for, s, or in samples where those last longer.
const DEFAULT_S: f64 = 10.0;
const DEFAULT_SAMPLES: f64 = 1e5;

/// The longest window, in samples: its analysis takes about 100 bytes for each.
const MOST_SAMPLES: f64 = (1 << 24) as f64;

/// What `--window` asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Asked {
    Nothing,
    Seconds(f64),
    Revolutions(f64),
}

impl Asked {
    pub(super) fn parse(text: Option<&str>) -> Result<Self, Failure> {
        let Some(text) = text else {
            return Ok(Self::Nothing);
        };
        if let Some((number, "revolution" | "revolutions" | "rev")) = text.trim().rsplit_once(' ')
            && let Some(count) = number
                .trim()
                .parse()
                .ok()
                .filter(|c: &f64| c.is_finite() && *c > 0.0)
        {
            return Ok(Self::Revolutions(count));
        }
        match Quantity::<Duration, AboveZero>::parse(text) {
            Ok(seconds) => Ok(Self::Seconds(seconds.si())),
            Err(found) => Err(Failure::input(format!(
                "--window: found {found}, expected a duration, e.g. '2 s', or '10 revolutions'"
            ))),
        }
    }

    /// The length in samples; `whole` where a recording is a window by itself.
    pub(super) fn length(
        self,
        sample_rate_hz: f64,
        speed_rpm: Option<f64>,
        whole: bool,
    ) -> Result<Length, String> {
        let samples = match (self, speed_rpm) {
            (Self::Nothing, _) if whole => return Ok(Length::UpTo(MOST_SAMPLES as usize)),
            (Self::Nothing, _) => {
                let most = (DEFAULT_S * sample_rate_hz).clamp(DEFAULT_SAMPLES, MOST_SAMPLES);
                return Ok(Length::UpTo(most as usize));
            }
            (Self::Seconds(seconds), _) => seconds * sample_rate_hz,
            (Self::Revolutions(count), Some(speed)) => count * 60.0 / speed * sample_rate_hz,
            (Self::Revolutions(_), None) => {
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
        let parse = |text| Asked::parse(Some(text));
        assert_eq!(parse("2 s").unwrap(), Asked::Seconds(2.0));
        assert_eq!(parse("10 revolutions").unwrap(), Asked::Revolutions(10.0));
        for wrong in ["2", "-2 s", "0 revolutions", "x revolutions", "2 m", ""] {
            assert!(parse(wrong).is_err(), "{wrong}");
        }
        let length = |asked: Asked, speed| asked.length(1000.0, speed, false);
        assert_eq!(
            length(Asked::Revolutions(10.0), Some(600.0)),
            Ok(Length::Equal(1000.0))
        );
        assert_eq!(length(Asked::Nothing, None), Ok(Length::UpTo(100_000)));
        assert!(length(Asked::Revolutions(10.0), None).is_err());
        assert!(length(Asked::Seconds(0.05), None).is_err());
        assert!(length(Asked::Seconds(1e6), None).is_err());
    }
}
