//! HDF5 files of other writers (`data/recordings/make.py`): groups, links, chunks, both byte orders, NetCDF-4.

use super::{message, options, read};
use recordings::Value;
use recordings::measured::{MeasuredFile, Options};
use std::path::{Path, PathBuf};

fn shipped(name: &str) -> PathBuf {
    Path::new("../../data/recordings").join(name)
}

#[test]
fn channels_of_a_group_have_its_time_rate_and_speed() {
    let path = shipped("groups.h5");
    let asked = options(&["run1/acc", "run1/raw_2"], None);
    let mut file = MeasuredFile::open(&path, &asked).unwrap();
    let shown: Vec<_> = file
        .channels()
        .iter()
        .map(|c| (c.column.as_str(), c.unit.as_deref()))
        .collect();
    assert_eq!(shown, [("run1/acc", Some("m/s^2")), ("run1/raw_2", None)]);
    assert_eq!(file.labels()[0].name, "speed_rpm");
    assert_eq!(
        file.next().unwrap().unwrap().labels(),
        [Value::Real(1796.0)]
    );

    let (channels, rate) = read(&path, &asked);
    assert_eq!(rate, Some(1000.0));
    for (i, found) in channels["run1/acc"].iter().enumerate() {
        let expected = (std::f64::consts::TAU * 50.0 * i as f64 / 1000.0).sin();
        assert!((f64::from(*found) - expected).abs() < 1e-7);
    }
    let counted: Vec<f32> = (0..200).map(|i| -i as f32).collect();
    assert_eq!(channels["run1/raw_2"], counted);
}

#[test]
fn what_the_file_states_counts_for_its_own_group() {
    let path = shipped("groups.h5");
    let (channels, rate) = read(&path, &options(&["run2/p"], None));
    let counted: Vec<f32> = (0..80).map(|i| i as f32).collect();
    assert_eq!(channels["run2/p [bar]"], counted);
    assert_eq!(rate, Some(500.0));

    let all = message(&path, &Options::default());
    assert!(
        all.contains(
            "its channels differ in length, so that they cannot be read together: run1/acc (200)"
        ),
        "{all}"
    );
    assert!(all.contains("run2/p [bar] (80)"), "{all}");
    let wrong = message(&path, &options(&["run2/q"], None));
    assert!(wrong.contains("run2/p [bar]"), "{wrong}");
    let rate = message(&path, &options(&["run2/p"], Some(510.0)));
    assert!(
        rate.contains("at 500 Hz, but the sample rate is said to be 510 Hz"),
        "{rate}"
    );
}

#[test]
fn netcdf_4_has_units_and_a_time_since_a_date() {
    let path = shipped("netcdf-4.nc");
    let file = MeasuredFile::open(&path, &Options::default()).unwrap();
    assert_eq!(file.channels().len(), 1);
    assert_eq!(file.channels()[0].name, "pressure");
    assert_eq!(file.channels()[0].unit.as_deref(), Some("kPa"));
    let (channels, rate) = read(&path, &Options::default());
    let counted: Vec<f32> = (0..200).map(|i| i as f32).collect();
    assert_eq!(channels["pressure"], counted);
    assert_eq!(rate, Some(1000.0));
}

#[test]
fn packed_numbers_become_values_and_fill_values_are_missing() {
    let path = shipped("packed.h5");
    let (channels, rate) = read(&path, &options(&["acc"], None));
    assert_eq!(rate, Some(1000.0));
    for (i, found) in channels["acc"].iter().enumerate() {
        match i {
            7 | 50 => assert!(found.is_nan(), "{i}"),
            _ => assert_eq!(*found, 0.5 * i as f32 + 10.0),
        }
    }
    let error = message(&path, &options(&["odd"], None));
    assert!(
        error.contains("`odd`: the attribute `scale_factor` is not one number"),
        "{error}"
    );
}
