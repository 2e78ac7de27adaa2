//! Sample rates that a file states in words, beside a column of time or without one.

use super::{big_endian_variables, message, options, read};
use recordings::measured::{MeasuredFile, Options};
use std::fs;

fn rows(write: impl Fn(usize) -> String) -> String {
    (0..40).map(write).collect()
}

#[test]
fn a_heading_without_times_states_the_rate_or_says_why_not() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.csv");
    let values = rows(|i| format!("{i}.5;1\n"));
    for (heading, rate) in [
        ("Sample rate [kHz];25.6", Some(25_600.0)),
        ("Sampling rate: 25.6 kS/s", Some(25_600.0)),
        ("dt;0.0390625;ms", Some(25_600.0)),
        ("Sampling rate: 25,600 Hz", None),
        ("Max. sample rate: 102400 Hz", None),
    ] {
        fs::write(&path, format!("{heading}\nacc [g];b [g]\n{values}")).unwrap();
        let mut file = MeasuredFile::open(&path, &Options::default()).unwrap();
        let recording = file.next().unwrap().unwrap();
        assert_eq!(recording.sample_rate_hz(), rate, "{heading}");
        let unclear = recording.unclear_rate().unwrap_or_default();
        assert_eq!(unclear.contains(heading), rate.is_none(), "{unclear}");
        let (_, said) = read(&path, &options(&[], Some(500.0)));
        assert_eq!(said, Some(500.0));
    }
}

#[test]
fn a_column_of_time_counts_more_than_a_heading_and_must_not_contradict_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.csv");
    let table = format!(
        "t_s;acc [g]\n{}",
        rows(|i| format!("{:.3};1\n", i as f64 / 1000.0))
    );
    for heading in [
        "Sample rate: 1.005 kHz",
        "Sample rate: 1,024 Hz",
        "Original sample rate: 8 kHz",
    ] {
        fs::write(&path, format!("{heading}\n{table}")).unwrap();
        assert_eq!(
            read(&path, &Options::default()).1,
            Some(1000.0),
            "{heading}"
        );
    }
    fs::write(&path, format!("Device;A\nSample rate: 2000 Hz\n{table}")).unwrap();
    let error = message(&path, &Options::default());
    for part in [
        "column `t_s`",
        "those of 1000.000000 Hz",
        "line 2, `Sample rate: 2000 Hz`",
        "2000 Hz",
    ] {
        assert!(error.contains(part), "{error}");
    }
    assert_eq!(read(&path, &options(&[], Some(1000.0))).1, Some(1000.0));
}

#[test]
fn numbers_of_a_file_that_contradict_each_other_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mat");
    let samples: Vec<f64> = (0..20).map(f64::from).collect();
    let with = |other: f64| {
        let variables: [(&str, &[f64]); 3] =
            [("x", &samples), ("fs", &[1000.0]), ("samplerate", &[other])];
        big_endian_variables(&variables)
    };
    fs::write(&path, with(1000.0)).unwrap();
    assert_eq!(read(&path, &Options::default()).1, Some(1000.0));
    fs::write(&path, with(2000.0)).unwrap();
    let error = message(&path, &Options::default());
    assert!(
        error.contains("`fs` is 1000 Hz, `samplerate` is 2000 Hz"),
        "{error}"
    );
    let variables: [(&str, &[f64]); 2] = [("x", &samples), ("fs", &[25.6])];
    fs::write(&path, big_endian_variables(&variables)).unwrap();
    let recording = MeasuredFile::open(&path, &Options::default())
        .unwrap()
        .next()
        .unwrap()
        .unwrap();
    assert_eq!(recording.sample_rate_hz(), None);
    assert_eq!(
        recording.unclear_rate(),
        Some("`fs` is 25.6, which may be in Hz or in kHz")
    );
}
