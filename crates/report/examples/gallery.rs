//! Writes every kind of figure and page, with made-up signals, to `target/gallery/`.

#[path = "../tests/report/synthetic/mod.rs"]
mod synthetic;

use report::case_picture::{CasePicture, ClearJoint};
use report::figure::{Axis, Colour, Figure, Mark, Panel, Series};
use std::{fs, io, path::Path};
use synthetic::Recording;

fn main() -> io::Result<()> {
    let out = Path::new("target/gallery");
    fs::create_dir_all(out)?;
    fs::write(
        out.join("case-ideal.svg"),
        case("Ideal machine, 500 rpm", &synthetic::recording(&[], 8, 1)),
    )?;
    let one = synthetic::recording(&[("big_end", 1e-4)], 8, 2);
    fs::write(
        out.join("case-big-end.svg"),
        case("Single-stage compressor, 500 rpm, big end 0.1 mm", &one),
    )?;
    let two = synthetic::recording(&[("big_end", 3e-4), ("small_end", 2e-4)], 12, 3);
    fs::write(
        out.join("case-two-joints.svg"),
        case("Single-stage compressor, 500 rpm, two joints", &two),
    )?;
    fs::write(out.join("spectrum.svg"), spectrum(&two))?;
    for (name, page) in [
        ("grid.html", synthetic::datasets::grid()),
        ("random.html", synthetic::datasets::random()),
    ] {
        fs::write(out.join(name), page.html().map_err(io::Error::other)?)?;
    }
    Ok(())
}

fn case(title: &str, recording: &Recording) -> String {
    CasePicture {
        title,
        crank_angle_rad: &recording.crank_angle_rad,
        acceleration_m_s2: &recording.acceleration_m_s2,
        velocity_m_s: &recording.velocity_m_s,
        joints: recording
            .joints
            .iter()
            .map(|joint| ClearJoint {
                name: joint.name,
                clearance_m: joint.clearance_m,
                x_m: &joint.x_m,
                y_m: &joint.y_m,
                contact_force_n: &joint.contact_force_n,
            })
            .collect(),
    }
    .svg()
}

fn spectrum(recording: &Recording) -> String {
    let (frequency, amplitude) = synthetic::spectrum(&recording.acceleration_m_s2);
    let points = frequency.into_iter().zip(amplitude).map(|(f, a)| [f, a]);
    let panel = Panel {
        x: Axis::linear("frequency (Hz)"),
        y: Axis::log("amplitude (m/s²)"),
        series: vec![Series::new("", Colour::Class(0), Mark::Line, points)],
        ..Panel::default()
    };
    Figure {
        title: "Spectrum of the crosshead acceleration".to_owned(),
        rows: vec![vec![panel]],
        ..Figure::default()
    }
    .svg()
}
