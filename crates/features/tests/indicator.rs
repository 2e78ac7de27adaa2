//! Indicated power and overall vibration of a window, against their closed forms.

use features::{CrankAngles, Reason, Window, definitions, features};
use signal::channel::Channel;
use simulate::Chamber;
use std::collections::BTreeMap;
use std::f64::consts::{SQRT_2, TAU};
use std::path::Path;

const SAMPLE_RATE: f64 = 20_000.0;
/// 480 rpm.
const PER_REVOLUTION: usize = 2500;
const SUCTION: f64 = 1e5;
const DISCHARGE: f64 = 5e5;
const EXPONENT: f64 = 1.3;

/// The head end of the shipped machine.
fn chamber() -> Chamber {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../data/machines/single-stage.yaml"
    );
    let file = input::machine_file::read(Path::new(path)).unwrap();
    let machine = file.resolve().unwrap().machine;
    Chamber::of_machine(&machine).remove(0)
}

/// Ideal cycle: p Vⁿ is constant while both valves are shut.
fn pressure(chamber: &Chamber, angle: f64) -> f64 {
    let full = chamber.clearance_volume + chamber.swept_volume();
    let volume = chamber.volume(angle);
    match angle.sin() > 0.0 {
        true => (DISCHARGE * (chamber.clearance_volume / volume).powf(EXPONENT)).max(SUCTION),
        false => (SUCTION * (full / volume).powf(EXPONENT)).min(DISCHARGE),
    }
}

/// Work of a revolution on the gas of an ideal cycle, J.
fn work(chamber: &Chamber) -> f64 {
    let ratio: f64 = DISCHARGE / SUCTION;
    let share = (EXPONENT - 1.0) / EXPONENT;
    let expanded = chamber.clearance_volume * ratio.powf(1.0 / EXPONENT);
    let drawn_in = chamber.clearance_volume + chamber.swept_volume() - expanded;
    SUCTION * drawn_in / share * (ratio.powf(share) - 1.0)
}

fn angles() -> Vec<f64> {
    let angle = |i: usize| TAU * (i % PER_REVOLUTION) as f64 / PER_REVOLUTION as f64;
    (0..4 * PER_REVOLUTION + 700).map(angle).collect()
}

fn channel(name: &str, unit: &str, samples: impl Iterator<Item = f64>) -> Channel {
    Channel {
        name: name.to_owned(),
        unit: unit.to_owned(),
        samples: samples.map(|x| x as f32).collect(),
    }
}

/// The features of a window by name.
fn row(
    channels: &[Channel],
    chambers: &[Chamber],
    from_top_dead_centre: bool,
) -> BTreeMap<String, Result<f64, Reason>> {
    let angles: Vec<f32> = angles().into_iter().map(|a| a as f32).collect();
    let window = Window {
        sample_rate: SAMPLE_RATE,
        speed_rpm: None,
        crank_angle: Some(CrankAngles {
            angles: &angles,
            from_top_dead_centre,
        }),
        channels,
        chambers,
    };
    let named = channels.iter().map(|c| (c.name.as_str(), c.unit.as_str()));
    let names = definitions(named).into_iter().map(|d| d.name);
    names.zip(features(&window)).collect()
}

#[test]
fn an_ideal_cycle_has_the_power_of_its_closed_form() {
    let chamber = chamber();
    let samples = angles().into_iter().map(|angle| pressure(&chamber, angle));
    let channels = [channel("cylinder_pressure_pa", "Pa", samples)];
    let known = row(&channels, std::slice::from_ref(&chamber), true);
    let found = |name: &str| {
        *known[&format!("cylinder_pressure.{name}")]
            .as_ref()
            .unwrap()
    };
    let power = work(&chamber) * 8.0;
    let error = found("indicated_power_w") / power - 1.0;
    assert!(error.abs() < 1e-3, "{error:.1e}");
    let mean = work(&chamber) / chamber.swept_volume();
    let error = found("indicated_mean_pressure_pa") / mean - 1.0;
    assert!(error.abs() < 1e-3, "{error:.1e}");
}

#[test]
fn power_needs_its_chamber_and_top_dead_centre() {
    let chamber = chamber();
    let samples = angles().into_iter().map(|angle| pressure(&chamber, angle));
    let channels = [channel("p_he_pa", "Pa", samples)];
    let power = |chambers: &[Chamber], from_top| {
        row(&channels, chambers, from_top)["p_he.indicated_power_w"].clone()
    };
    let named = [chamber.named("p_he_pa")];
    assert!(power(&named, true).is_ok());
    assert_eq!(power(&named, false), Err(Reason::NoTopDeadCentre));
    assert_eq!(power(&[], true), Err(Reason::NoChamber));
    // That of another channel.
    assert_eq!(power(&[chamber], true), Err(Reason::NoChamber));
}

#[test]
fn velocity_and_displacement_of_sines_have_their_closed_forms() {
    // Orders 1 and 12, and order 140 (1120 Hz), which is above the band.
    let speed = TAU * SAMPLE_RATE / PER_REVOLUTION as f64;
    let parts = [(40.0, 1.0), (90.0, 12.0), (500.0, 140.0)];
    let sample = |angle: f64| {
        parts
            .iter()
            .map(|(a, order)| a * (order * angle + 0.4).cos())
            .sum()
    };
    let channels = [channel(
        "frame_m_s2",
        "m/s^2",
        angles().into_iter().map(sample),
    )];
    let row = row(&channels, &[], true);
    for (name, power) in [
        ("acceleration_rms_m_s2", 0),
        ("velocity_rms_m_s", 1),
        ("displacement_rms_m", 2),
    ] {
        let squares = parts[..2]
            .iter()
            .map(|(a, order)| (a / (order * speed).powi(power)).powi(2));
        let expected = squares.sum::<f64>().sqrt() / SQRT_2;
        let found = *row[&format!("frame.{name}")].as_ref().unwrap();
        assert!(
            (found / expected - 1.0).abs() < 1e-4,
            "{name}: {found}, {expected}"
        );
    }
}
