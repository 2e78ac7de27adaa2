//! How the cases of a sweep are run, cut and divided, from its file.

use input::Error;
use input::choice::Or;
use simulate::settings::TOLERANCES;
use simulate::{ExponentSettings, Extent, Settings, Transient};

use super::Judgement;
use crate::sweep_file::{Run, SweepFile};

/// How each case is run; `sample_rate` is the machine file's, Hz.
pub(super) fn settings(run: &Run, sample_rate: Option<f64>) -> Result<Settings, Error> {
    let default = Settings::default();
    let tolerance = run.tolerance.map_or(default.tolerance, |t| t.get());
    let [least, most] = TOLERANCES;
    if !(least..=most).contains(&tolerance) {
        let expected = format_args!("a number from {least:e} to {most:e}, e.g. 1e-9");
        return Err(Error::clash("run.tolerance", expected));
    }
    Ok(Settings {
        revolutions: run.revolutions.get(),
        transient: match &run.transient {
            None => default.transient,
            Some(Or::Scalar(revolutions)) => Transient::Revolutions(revolutions.get()),
            Some(Or::Section(settled)) => Transient::Settled {
                change: settled.until_settled.get(),
                at_most: settled.at_most.get(),
            },
        },
        sample_rate: run
            .sample_rate
            .map(|rate| rate.si())
            .or(sample_rate)
            .unwrap_or(default.sample_rate),
        tolerance,
        ..default
    })
}

/// How the motion of each case is judged, where that is asked for.
pub(super) fn judgement(run: &Run) -> Result<Option<Judgement>, Error> {
    let Some(asked) = run.lyapunov else {
        return Ok(None);
    };
    let default = ExponentSettings::default();
    Ok(Some(Judgement {
        settings: ExponentSettings {
            transient: asked.transient.map_or(default.transient, |n| n.get()),
            revolutions: asked.revolutions.get(),
            tolerance: settings(run, None)?.tolerance,
        },
        extent: if asked.spectrum {
            Extent::Spectrum
        } else {
            Extent::Largest
        },
        convergence: asked.convergence,
    }))
}

/// The shares of the splits, which must add up.
pub(super) fn shares(file: &SweepFile) -> Result<[f64; 3], Error> {
    let shares = file.splits.shares();
    let total: f64 = shares.iter().sum();
    if (total - 1.0).abs() > 1e-9 {
        let found = format_args!("{} % together", (total * 1e9).round() / 1e7);
        let error = Error::unexpected("splits", found, "shares that add up to 100 %");
        return Err(error.against("/splits.*"));
    }
    Ok(shares)
}

/// Checks that the windows fit into the recording.
pub(super) fn check_windows(file: &SweepFile) -> Result<(), Error> {
    let Some(windows) = file.windows else {
        return Ok(());
    };
    let (count, each) = (windows.count.get(), windows.revolutions.get());
    let recorded = file.run.revolutions.get();
    if u64::from(count) * u64::from(each) <= recorded.into() {
        return Ok(());
    }
    let found = format_args!("{count} windows of {each} revolutions");
    let expected = format_args!("no more than run.revolutions, {recorded}");
    let error = Error::unexpected("windows", found, expected);
    Err(error.against("/windows.*").against("/run.revolutions"))
}
