//! What a calibration says of the recorder.

use super::example_run::*;
use std::fs;

/// The file has a column of time, and the bundle lists neither that nor a sample rate.
#[test]
fn times_that_the_bundle_does_not_list_give_the_sample_rate() {
    let columns = plain();
    let untimed = yaml(&columns[1..]).replace("  sample_rate_hz: 20000\n", "");
    assert!(!untimed.contains("column: t_s") && !untimed.contains("sample_rate"));
    let folder = write(&untimed, &csv(&columns));
    let arguments = [
        "bundle",
        "--out",
        "out",
        "--optimiser",
        "levenberg-marquardt",
    ];
    let (status, message) = calibrate(folder.path(), &arguments);
    assert_eq!(status, 0, "{message}");
    let out = folder.path().join("out");
    let machine = input::machine_file::read(&out.join("machine.yaml")).unwrap();
    let rate = machine.resolve().unwrap().sample_rate.unwrap();
    assert!((rate / 20_000.0 - 1.0).abs() < 1e-6, "{rate}");
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    let sensors = page.split("<section id=\"sensors\">").nth(1).unwrap();
    let sensors = sensors.split("</section>").next().unwrap();
    for said in [
        "crosshead_acceleration_m_s2",
        "20\u{202f}000\u{a0}Hz",
        "assumed ±",
    ] {
        assert!(sensors.contains(said), "{said} is not in {sensors}");
    }
}
