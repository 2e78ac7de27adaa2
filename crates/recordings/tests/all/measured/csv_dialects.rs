//! Text files as programs write them.

use super::{message, options, read};
use recordings::measured::Options;
use std::fs;

const SAMPLES: [f32; 3] = [1.5, -2.0, 30.0];

#[test]
fn a_comma_in_quotation_marks_is_the_decimal_sign() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.csv");
    for text in [
        "t_s,acc [g]\n\"0,0000\",\"1,5\"\n\"0,0010\",\"-2,0\"\n\"0,0020\",\"30\"\n",
        "\"t_s\";\"acc [g]\"\n\"0,0000\";\"1,5\"\n\"0,0010\";\"-2,0\"\n\"0,0020\";\"30\"\n",
    ] {
        fs::write(&path, text).unwrap();
        let (channels, rate) = read(&path, &Options::default());
        assert_eq!(channels["acc [g]"], SAMPLES, "{text}");
        assert_eq!(rate, Some(1000.0), "{text}");
    }
    for (text, expected) in [
        (
            "t_s,p [Pa]\n0,\"200,037\"\n0.001,\"200,038\"\n",
            "line 2, column `p [Pa]`: found `200,037`: its comma may be the decimal sign or set thousands apart",
        ),
        (
            "t_s,p [Pa]\n0.000,\"200,037\"\n0.001,\"200,038\"\n",
            "line 2, column `p [Pa]`: found `200,037`, but `0.000` in line 2, column `t_s`",
        ),
    ] {
        fs::write(&path, text).unwrap();
        let error = message(&path, &Options::default());
        assert!(error.contains(expected), "{error}");
    }
}

#[test]
fn lines_end_as_on_any_system() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.csv");
    for end in ["\n", "\r\n", "\r"] {
        for last in ["", end] {
            let lines = ["t_s,acc", "0,1.5", "0.001,-2", "0.002,30"];
            fs::write(&path, lines.join(end) + last).unwrap();
            let (channels, rate) = read(&path, &Options::default());
            assert_eq!(channels["acc"], SAMPLES, "{end:?} {last:?}");
            assert_eq!(rate, Some(1000.0));
        }
    }
}

/// A LabVIEW measurement file with these lines after its heading.
fn labview(step: &str, rows: &str) -> String {
    let heading = "LabVIEW Measurement\t\nWriter_Version\t2\nSeparator\tTab\nDecimal_Separator\t.\nX_Columns\tOne\n\
                   Date\t2024/05/06\nTime\t14:03:22.123\n***End_of_Header***\t\n\t\nChannels\t2\t\t\nSamples\t3\t3\t\n\
                   Date\t2024/05/06\t2024/05/06\t\nY_Unit_Label\tg\tbar\t\nX_Dimension\tTime\tTime\t\nX0\t0.0E+0\t0.0E+0\t\n";
    format!("{heading}Delta_X\t{step}\t\n***End_of_Header***\t\t\t\n{rows}").replace('\n', "\r\n")
}

#[test]
fn measurement_files_of_labview() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.lvm");
    let step = "1.0E-3\t1.0E-3";
    for rows in [
        "X_Value\tAcc 0\tP\tComment\n0.000\t1.5\t2\tstart\n0.001\t-2.0\t3\n0.002\t30\t4\n",
        "X_Value\tAcc 0\tP\tComment\n0,000\t1,5\t2\n0,001\t-2,0\t3\n0,002\t30\t4\n",
        "X_Value\tAcc 0\tP\tComment\n\t1.5\t2\n\t-2.0\t3\n\t30\t4\n",
    ] {
        fs::write(&path, labview(step, rows)).unwrap();
        let (channels, rate) = read(&path, &Options::default());
        assert_eq!(
            channels.keys().collect::<Vec<_>>(),
            ["Acc 0 [g]", "P [bar]"]
        );
        assert_eq!(channels["Acc 0 [g]"], SAMPLES);
        assert_eq!(rate, Some(1000.0), "{rows}");
    }
    let rows = "X_Value\tA\tX_Value\tB\tComment\n0.000\t1.5\t0.000\t2\n0.001\t-2\t0.001\t3\n0.002\t30\t0.002\t4\n";
    fs::write(&path, labview(step, rows)).unwrap();
    assert_eq!(read(&path, &options(&["A"], None)).0["A [g]"], SAMPLES);
}

#[test]
fn what_is_not_read_of_labview_says_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.lvm");
    let rows = "X_Value\tA\tB\tComment\n\t1\t2\n\t3\t4\n\t5\t6\n";
    let step = "1.0E-3\t1.0E-3";
    let twice = format!("{rows}\nChannels\t2\t\t\nSamples\t3\t3\t\n");
    for (text, expected) in [
        (
            labview("1.0E-3\t1.0E-4", rows),
            "line 16, `Delta_X`: found `1.0E-3` and `1.0E-4`, expected the same value for all channels",
        ),
        (
            labview(step, &twice),
            "a further measurement begins in line 23: save each to a file of its own",
        ),
        (
            labview(step, rows).replace("Time\tTime", "Frequency\tFrequency"),
            "line 14, `X_Dimension`: found `Frequency`, expected `Time`",
        ),
        (
            labview(step, ""),
            "no line of names that begins with `X_Value`",
        ),
    ] {
        fs::write(&path, text).unwrap();
        let error = message(&path, &Options::default());
        assert!(error.contains(expected), "{error}");
    }
}

#[test]
fn a_time_without_a_unit_is_in_the_unit_that_the_stated_rate_says() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.csv");
    for (step, rate) in [
        (0.04, Some(25_000.0)),
        (40.0, Some(25_000.0)),
        (0.04, Some(25.0)),
        (0.0005, None),
    ] {
        let rows: String = (0..40)
            .map(|i| format!("{},1\n", f64::from(i) * step))
            .collect();
        let rows = rows.as_str();
        let expected = rate.unwrap_or(2000.0);
        fs::write(&path, format!("Time,acc\n{rows}")).unwrap();
        let (_, found) = read(&path, &options(&[], rate));
        assert!(
            (found.unwrap() / expected - 1.0).abs() < 1e-9,
            "{step}: {found:?}"
        );
        if rate.is_some() {
            fs::write(
                &path,
                format!("Sample rate: {expected} Hz\nTime,acc\n{rows}"),
            )
            .unwrap();
            let (_, found) = read(&path, &Options::default());
            assert!(
                (found.unwrap() / expected - 1.0).abs() < 1e-9,
                "{step}: {found:?}"
            );
        }
    }
}
