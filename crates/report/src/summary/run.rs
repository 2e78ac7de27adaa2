//! One run of a machine.

use features::OVERALL_HZ;
use signal::channel::Channel;
use simulate::{Motion, Penetration, Record, Regime};
use std::f64::consts::PI;
use sweep::run::Run;
use sweep::run_analysis::{ChamberSummary, RodLoadSummary, RunSummary, VibrationSummary};

/// The machine, how the run went, and its channels; a line each.
pub fn run(run: &Run) -> String {
    let (machine, record) = (&run.machine, &run.record);
    let energy = record.energy_residual.map_or(String::new(), |missing| {
        let share = missing.abs();
        format!(", energy ledger closes to within {share:.1e} of the energy turned over")
    });
    let (steps, switches) = (record.work.accepted, record.work.switches);
    let head = [
        format!("{}, {}\n", machine.name, rpm(machine.speed)),
        format!("  {steps} steps, {switches} contact and gas switches{energy}\n"),
    ];
    let speed = run.free_speed();
    let speed = speed.map(|speed| format!("  mean speed {}\n", rpm(speed)));
    let doubts = simulate::doubts(record, &machine.sensors, &run.channels);
    let warnings = doubts.iter().map(|doubt| format!("  warning: {doubt}\n"));
    let lines = head.into_iter().chain(run.channels.iter().map(channel));
    lines.chain(speed).chain(warnings).collect()
}

/// The joints whose surfaces penetrate each other too deeply.
pub(crate) fn too_deep(record: &Record) -> impl Iterator<Item = &Penetration> {
    let joints = record.penetrations.iter();
    joints.filter(|joint| joint.is_too_deep())
}

fn channel(channel: &Channel) -> String {
    let samples = channel.samples.iter().map(|x| f64::from(*x));
    let count = channel.samples.len().max(1) as f64;
    let rms = (samples.clone().map(|x| x * x).sum::<f64>() / count).sqrt();
    let peak = samples.map(f64::abs).fold(0.0, f64::max);
    let [rms, peak] = [rms, peak].map(|value| with_unit(value, &channel.unit));
    format!("  {}: rms {rms}, peak {peak}\n", channel.name)
}

/// A value of a channel; units that take prefixes have one.
fn with_unit(value: f64, unit: &str) -> String {
    match unit {
        "Pa" | "N" | "W" | "m" => text::prefixed(value, unit),
        "" => text::number(value, 3),
        unit => format!("{} {}", text::number(value, 3), text::unit(unit)),
    }
}

/// What a user of the machine looks at first; a line each.
pub fn analysis(summary: &RunSummary) -> String {
    let chambers = summary.chambers.iter().map(chamber);
    let loads = summary.rod_load.iter().map(rod_load);
    let vibrations = summary.vibration.iter().map(vibration);
    chambers.chain(loads).chain(vibrations).collect()
}

fn chamber(chamber: &ChamberSummary) -> String {
    format!(
        "  {}{} end: indicated power {}, indicated mean pressure {}\n",
        of_throw(&chamber.throw),
        chamber.end,
        text::prefixed(chamber.indicated_power_w, "W"),
        text::prefixed(chamber.indicated_mean_pressure_pa, "Pa")
    )
}

fn rod_load(load: &RodLoadSummary) -> String {
    let verdict = match load.reverses {
        true => "as API 618 asks for",
        false => "less than API 618 asks for",
    };
    let side = |newtons: f64, angle_deg: f64| {
        format!(
            "up to {} over {angle_deg:.1}°",
            text::prefixed(newtons.max(0.0), "N")
        )
    };
    format!(
        "  {}rod load: tension {}, compression {}\n    the shorter lasts {:.1}° of crank angle, the smaller is {:.1} % of the \
         larger: {verdict} ({:.0}°, {:.0} %)\n",
        of_throw(&load.throw),
        side(load.max_n, load.tension_angle_deg),
        side(-load.min_n, load.compression_angle_deg),
        load.reversal_angle_deg,
        100.0 * load.reversed_share,
        load.least_reversal_angle_deg,
        100.0 * load.least_reversed_share
    )
}

fn vibration(vibration: &VibrationSummary) -> String {
    let [low, high] = OVERALL_HZ;
    format!(
        "  {}, {low} to {high} Hz: velocity {} mm/s rms, displacement {} rms\n",
        vibration.channel,
        text::number(1e3 * vibration.velocity_rms_m_s, 3),
        text::prefixed(vibration.displacement_rms_m, "m")
    )
}

/// `throw1 ` where there are several throws.
fn of_throw(throw: &str) -> String {
    match throw {
        "" => String::new(),
        throw => format!("{throw} "),
    }
}

/// What kind of motion it is, and the numbers that say so, over so many revolutions; a line each.
pub fn motion(motion: Option<&Motion>, revolutions: u32) -> String {
    let Some(motion) = motion else {
        return "motion: periodic, 1 revolution; nothing moves freely\n".to_owned();
    };
    let period = match motion.regime {
        Regime::Periodic { revolutions } => format!(", {revolutions} rev"),
        _ => String::new(),
    };
    let mut lines = format!(
        "motion: {}{period}\n  Lyapunov exponents, 1/s, with standard errors, over {revolutions} revolutions:\n",
        motion.regime.name()
    );
    for exponent in &motion.exponents {
        let (value, error) = (exponent.per_second, exponent.standard_error);
        lines += &format!("    {value:.4} +- {error:.1e}\n");
    }
    if let Some(orbit) = &motion.orbit {
        lines += &format!("  Floquet multipliers, over {:.6} s:\n", orbit.period);
        // Below, they are rounding.
        for multiplier in orbit.multipliers.iter().filter(|m| m.norm() > 1e-9) {
            lines += &match multiplier.im {
                0.0 => format!("    {:.3e}\n", multiplier.re),
                im => format!("    {:.3e} {im:+.3e}i\n", multiplier.re),
            };
        }
    }
    lines
}

/// A speed in rad/s as people say it.
pub(crate) fn rpm(speed: f64) -> String {
    format!("{:.4} rpm", speed * 30.0 / PI).replace(".0000", "")
}
