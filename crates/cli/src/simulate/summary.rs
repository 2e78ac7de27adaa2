//! What is printed of a run.

use ::features::OVERALL_HZ;
use ::report::text;
use input::Resolved;
use mechanism::drive::Drive;
use signal::channel::Channel;
use simulate::{Motion, Penetration, Record, Regime};
use sweep::run_analysis::{RodLoadSummary, RunSummary};

/// The joints whose surfaces penetrate each other too deeply.
pub(super) fn too_deep(record: &Record) -> impl Iterator<Item = &Penetration> {
    record
        .penetrations
        .iter()
        .filter(|joint| joint.is_too_deep())
}

/// The machine, how the run went, and its channels.
pub(super) fn print(machine: &Resolved, record: &Record, channels: &[Channel]) {
    println!("{}, {}", machine.name, rpm(machine.speed));
    let energy = record.energy_residual.map_or(String::new(), |missing| {
        format!(
            ", energy ledger closes to within {:.1e} of the energy turned over",
            missing.abs()
        )
    });
    println!(
        "  {} steps, {} contact and gas switches{energy}",
        record.work.accepted, record.work.switches
    );
    for channel in channels {
        let samples = channel.samples.iter().map(|x| f64::from(*x));
        let count = channel.samples.len().max(1) as f64;
        let rms = (samples.clone().map(|x| x * x).sum::<f64>() / count).sqrt();
        let peak = samples.map(f64::abs).fold(0.0, f64::max);
        let [rms, peak] = [rms, peak].map(|value| with_unit(value, &channel.unit));
        println!("  {}: rms {rms}, peak {peak}", channel.name);
    }
    if let Drive::Free(_) = machine.machine.drive {
        println!("  mean speed {}", rpm(record.mean_speed));
    }
    for joint in too_deep(record) {
        println!("  warning: {joint}");
    }
}

/// A value of a channel; units that take prefixes have one.
fn with_unit(value: f64, unit: &str) -> String {
    match unit {
        "Pa" | "N" | "W" | "m" => text::prefixed(value, unit),
        "" => text::number(value, 3),
        unit => format!("{} {}", text::number(value, 3), text::unit(unit)),
    }
}

/// What a user of the machine looks at first.
pub(super) fn print_analysis(summary: &RunSummary) {
    for chamber in &summary.chambers {
        println!(
            "  {}{} end: indicated power {}, indicated mean pressure {}",
            of_throw(&chamber.throw),
            chamber.end,
            text::prefixed(chamber.indicated_power_w, "W"),
            text::prefixed(chamber.indicated_mean_pressure_pa, "Pa")
        );
    }
    for load in &summary.rod_load {
        print_rod_load(load);
    }
    let [low, high] = OVERALL_HZ;
    for vibration in &summary.vibration {
        println!(
            "  {}, {low} to {high} Hz: velocity {} mm/s rms, displacement {} rms",
            vibration.channel,
            text::number(1e3 * vibration.velocity_rms_m_s, 3),
            text::prefixed(vibration.displacement_rms_m, "m")
        );
    }
}

fn print_rod_load(load: &RodLoadSummary) {
    let force = |newtons: f64| match newtons > 0.0 {
        true => format!("{} in tension", text::prefixed(newtons, "N")),
        false => format!("{} in compression", text::prefixed(-newtons, "N")),
    };
    println!(
        "  {}rod load: from {} to {}",
        of_throw(&load.throw),
        force(load.min_n),
        force(load.max_n)
    );
    let verdict = match load.reverses {
        true => "as API 618 asks for",
        false => "less than API 618 asks for",
    };
    println!(
        "    reversed for {:.1}° of crank angle, peak {:.1} % of the other: {verdict} ({:.0}°, {:.0} %)",
        load.reversal_angle_deg,
        100.0 * load.reversed_share,
        load.least_reversal_angle_deg,
        100.0 * load.least_reversed_share
    );
}

/// `throw1 ` where there are several throws.
fn of_throw(throw: &str) -> String {
    match throw {
        "" => String::new(),
        throw => format!("{throw} "),
    }
}

/// What kind of motion it is, and the numbers that say so.
pub(super) fn print_motion(motion: Option<&Motion>, revolutions: u32) {
    let Some(motion) = motion else {
        println!("motion: periodic, 1 revolution; nothing moves freely");
        return;
    };
    let period = match motion.regime {
        Regime::Periodic { revolutions } => format!(", {revolutions} rev"),
        _ => String::new(),
    };
    println!("motion: {}{period}", motion.regime.name());
    println!("  Lyapunov exponents, 1/s, with standard errors, over {revolutions} revolutions:");
    for exponent in &motion.exponents {
        let (value, error) = (exponent.per_second, exponent.standard_error);
        println!("    {value:.4} +- {error:.1e}");
    }
    if let Some(orbit) = &motion.orbit {
        println!("  Floquet multipliers, over {:.6} s:", orbit.period);
        // Below, they are rounding.
        for multiplier in orbit.multipliers.iter().filter(|m| m.norm() > 1e-9) {
            match multiplier.im {
                0.0 => println!("    {:.3e}", multiplier.re),
                im => println!("    {:.3e} {im:+.3e}i", multiplier.re),
            }
        }
    }
}

/// A speed in rad/s as people say it.
pub(super) fn rpm(speed: f64) -> String {
    format!("{:.4} rpm", speed * 30.0 / std::f64::consts::PI).replace(".0000", "")
}
