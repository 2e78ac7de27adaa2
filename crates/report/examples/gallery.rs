//! Writes every kind of figure and page, with made-up signals, to `target/gallery/`.

#[path = "../tests/report/synthetic/mod.rs"]
mod synthetic;

use figure::{Axis, Colour, Figure, Mark, Panel, Series};
use std::path::Path;
use std::{fs, io};
use synthetic::Recording;

fn main() -> io::Result<()> {
    let out = Path::new("target/gallery");
    fs::create_dir_all(out)?;
    fs::write(
        out.join("case-ideal.svg"),
        synthetic::recording(&[], 8, 1).picture("Ideal machine, 500 rpm"),
    )?;
    let one = synthetic::recording(&[("big_end", 1e-4)], 8, 2);
    fs::write(
        out.join("case-big-end.svg"),
        one.picture("Single-stage compressor, 500 rpm, big end 0.1 mm"),
    )?;
    let two = synthetic::recording(&[("big_end", 3e-4), ("small_end", 2e-4)], 12, 3);
    fs::write(
        out.join("case-two-joints.svg"),
        two.picture("Single-stage compressor, 500 rpm, two joints"),
    )?;
    fs::write(out.join("spectrum.svg"), spectrum(&two))?;
    for (name, page) in [
        ("grid.html", synthetic::datasets::grid().render()),
        ("random.html", synthetic::datasets::random().render()),
        ("calibration.html", synthetic::calibration::page().render()),
        ("chaos.html", synthetic::chaos::page().render()),
    ] {
        fs::write(out.join(name), page.map_err(io::Error::other)?.html)?;
    }
    Ok(())
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
