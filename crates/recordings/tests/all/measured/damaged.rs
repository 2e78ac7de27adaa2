//! Mistakes in recordings are named, and damaged files are refused.

use super::{
    big_endian_mat, dataset_rows, json_mcap, mcap_bytes, message, options, reals, times, wav_i16,
};
use proptest::prelude::*;
use recordings::formats::{csv, parquet};
use recordings::measured::{MeasuredFile, Options};
use std::fs;
use std::path::{Path, PathBuf};

#[test]
fn one_clear_message_for_each_mistake() {
    let folder = tempfile::tempdir().unwrap();
    let case = |name: &str, content: &[u8]| -> PathBuf {
        let path = folder.path().join(name);
        fs::write(&path, content).unwrap();
        path
    };
    let parquet = parquet::write_table(Vec::new(), &dataset_rows(), 1).unwrap();
    let whole = wav_i16(&[1; 100], 1);
    let netcdf = fs::read("../../data/recordings/netcdf-4.nc").unwrap();
    let mut no_rate = whole.clone();
    let at = whole.windows(4).position(|w| w == b"fmt ").unwrap() + 12;
    no_rate[at..at + 4].fill(0);
    for (name, content, expected) in [
        ("empty.wav", &b""[..], "it is empty"),
        ("a.wav", &parquet, "as WAV: it looks like a Parquet file"),
        ("a.csv", &whole, "as CSV: it looks like a WAV file"),
        ("b.parquet", &whole[..20], "as Parquet: it looks like a WAV file"),
        ("a.dat", b"PK\x03\x04\0\0", "it looks like a ZIP archive"),
        ("a.tdms", b"TDSm\x0e\0\0\0", "a TDMS file: save it as CSV, WAV, MAT, HDF5, Parquet or MCAP"),
        ("b.dat", b"\0\x01\x02", "it is none of CSV, WAV, MAT, HDF5, Parquet and MCAP"),
        ("v73.mat", b"MATLAB 7.3 MAT-file\0", "as HDF5: invalid HDF5 magic bytes"),
        ("cut.h5", &netcdf[..netcdf.len() - 200], "cannot read"),
        ("a.wav.nc", &whole, "as HDF5: it looks like a WAV file"),
        ("nc.csv", &netcdf, "as CSV: it looks like an HDF5 file"),
        ("cut.wav", &whole[..whole.len() - 50], "announces 200 bytes of samples and has 150"),
        ("head.wav", &whole[..30], "ends before its samples begin"),
        ("rate.wav", &no_rate, "its sample rate is 0 Hz"),
        ("cut.parquet", &parquet[..parquet.len() / 2], "cannot read"),
        ("cut.mcap", &mcap_bytes(1000)[..3000], "as MCAP: "),
        ("cut.mat", &big_endian_mat(1, 50, &[0.0; 50])[..300], "it is cut off"),
        ("names.csv", b"a,b\n", "names of columns and no rows"),
        ("text.csv", b"a,b\nx,y\n", "no column of numbers"),
        ("time.csv", b"Time,b\n0,2\n0.039,2\n0.078,1\n", "column `Time`: its heading has no unit: the sample rate would be 25.641 Hz if it is s, 25641.026 Hz if it is ms"),
        ("word.csv", b"a,b\n1,2\n1,two\n", "line 3, column `b`: found `two`"),
        ("short.csv", b"a,b\n1,2\n1", "line 3 has 1 cells where the first has 2"),
        ("back.csv", b"t_s,b\n0,2\n0.1,2\n0.2,1\n0.3,1\n0.15,1\n0.4,1\n0.5,1\n0.6,1\n0.7,1\n0.8,1\n0.9,1\n1.0,1\n1.1,1\n1.2,1\n1.3,1\n1.4,1\n1.5,1\n1.6,1\n1.7,1\n1.8,1\n1.9,1\n2.0,1\n2.1,1\n", "column `t_s`: line 6 is at 0.15 s"),
    ] {
        let message = message(&case(name, content), &Options::default());
        assert!(message.contains(expected), "{name}: {message}");
        assert!(message.contains(name), "{message}");
    }
    let wave = case("a.wav", &whole);
    assert!(message(&wave, &options(&["chanel_1"], None)).contains("there are: channel_1"));
    assert!(message(&wave, &options(&[], Some(2000.0))).contains("at 1000 Hz, but"));
    for rate in [0.0, -1.0, f64::NAN] {
        assert!(message(&wave, &options(&[], Some(rate))).contains("must be positive"));
    }
    let timed = case("t.csv", b"t,b\n0,1\n0.1,1\n0.2,1\n");
    assert!(message(&timed, &options(&[], Some(20.0))).contains("those of 10.0"));
    assert!(
        message(&folder.path().join("none.csv"), &Options::default())
            .contains("there is no such file")
    );
}

/// A small file of every format.
fn seeds() -> Vec<(&'static str, Vec<u8>)> {
    let text = reals(vec![
        ("t_s", Some("s"), times(60)),
        ("x", None, vec![0.5; 60]),
    ]);
    let shipped = |name: &str| fs::read(Path::new("../../data/recordings").join(name)).unwrap();
    vec![
        ("wav", wav_i16(&[5; 60], 2)),
        ("csv", csv::write_table(Vec::new(), &text).unwrap()),
        (
            "parquet",
            parquet::write_table(Vec::new(), &text, 20).unwrap(),
        ),
        (
            "parquet",
            parquet::write_table(Vec::new(), &dataset_rows(), 1).unwrap(),
        ),
        ("mat", shipped("matlab-v6.mat")),
        ("mat", shipped("matlab-v7.mat")),
        ("mat", shipped("matlab-v7.3.mat")),
        ("nc", shipped("netcdf-4.nc")),
        ("mat", big_endian_mat(2, 10, &[1.0; 20])),
        ("mcap", mcap_bytes(60)),
        ("mcap", json_mcap(20)),
    ]
}

/// Reads whatever stands there to the end, or to its first error. Panics fail the test; more
/// samples than a small file can hold are refused here.
fn survive(path: &Path) {
    let Ok(file) = MeasuredFile::open(path, &options(&[], None)) else {
        return;
    };
    let channels = file.channels().len();
    let mut left = 1 << 22;
    for recording in file.take(100) {
        let Ok(mut recording) = recording else { return };
        let mut into = vec![Vec::new(); channels];
        while let Ok(block) = recording.read(1 << 12, &mut into) {
            assert!(block.samples <= 1 << 12);
            left -= block.samples as i64;
            if block.samples == 0 || left < 0 {
                break;
            }
            into.iter_mut().for_each(Vec::clear);
        }
    }
}

/// Runs this many changed files of every format: 40 in an ordinary test, more by hand.
fn fuzz_cases() -> u32 {
    let asked = std::env::var("CROSSHEAD_FUZZ_CASES").ok();
    asked.and_then(|n| n.parse().ok()).unwrap_or(40)
}

#[test]
fn damaged_files_never_panic() {
    let folder = tempfile::tempdir().unwrap();
    for (number, (ending, seed)) in seeds().into_iter().enumerate() {
        let path = folder.path().join(format!("{number}.{ending}"));
        fs::write(&path, &seed).unwrap();
        let readable = MeasuredFile::open(&path, &options(&[], None));
        assert!(
            readable.is_ok() || seed.len() < 500,
            "{ending}: {:?}",
            readable.err()
        );
        let flips = proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..6);
        let strategy = (
            flips,
            proptest::option::of(any::<prop::sample::Index>()),
            any::<bool>(),
        );
        let config = ProptestConfig {
            cases: fuzz_cases(),
            failure_persistence: None,
            max_shrink_iters: 0,
            ..ProptestConfig::default()
        };
        let mut runner = proptest::test_runner::TestRunner::new(config);
        let outcome = runner.run(&strategy, |(flips, cut, random)| {
            let mut bytes = seed.clone();
            for (index, byte) in &flips {
                let at = index.index(bytes.len());
                bytes[at] = *byte;
            }
            if let Some(cut) = cut {
                bytes.truncate(cut.index(seed.len()));
            }
            if random {
                // Random bytes behind a true beginning.
                let keep = bytes.len().min(140);
                let noise = (0..400_u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8);
                let salt = flips.first().map_or(0, |(_, byte)| *byte);
                bytes.truncate(keep);
                bytes.extend(noise.map(|b| b.wrapping_mul(salt | 1)));
            }
            fs::write(&path, &bytes).unwrap();
            survive(&path);
            Ok(())
        });
        outcome.unwrap();
    }
}
