//! Recordings of all formats, read back sample by sample.

mod csv_dialects;
mod damaged;
mod hdf5;
mod stated_rate;

use recordings::formats::{csv, mcap, parquet};
use recordings::measured::{Length, MeasuredFile, Options, Recording, Windows};
use recordings::{Column, Data, Kind, Schema, Table, Value};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

const RATE: f64 = 1000.0;

fn options(columns: &[&str], sample_rate_hz: Option<f64>) -> Options {
    Options {
        columns: columns.iter().map(|c| (*c).to_owned()).collect(),
        sample_rate_hz,
        skipped_lines: 0,
    }
}

fn samples(mut recording: Recording, channels: usize) -> Vec<Vec<f32>> {
    let mut all = vec![Vec::new(); channels];
    // Blocks of any length give the same samples.
    while recording.read(77, &mut all).unwrap().samples > 0 {}
    let single = |channel: Vec<f64>| channel.into_iter().map(|x| x as f32).collect();
    all.into_iter().map(single).collect()
}

/// The channels by name, and the rate, of a file with one recording.
fn read(path: &Path, options: &Options) -> (BTreeMap<String, Vec<f32>>, Option<f64>) {
    let mut file = MeasuredFile::open(path, options).unwrap();
    let names: Vec<String> = file.channels().iter().map(|c| c.column.clone()).collect();
    let recording = file.next().unwrap().unwrap();
    let rate = recording.sample_rate_hz();
    assert!(file.next().is_none());
    let channels = samples(recording, names.len());
    (names.into_iter().zip(channels).collect(), rate)
}

fn message(path: &Path, options: &Options) -> String {
    let read = || {
        for recording in MeasuredFile::open(path, options)? {
            let mut recording = recording?;
            let mut into = vec![Vec::new(); 64];
            while recording.read(1000, &mut into)?.samples > 0 {}
        }
        Ok(())
    };
    let result: Result<(), recordings::Error> = read();
    result.unwrap_err().to_string()
}

fn sine(n: usize) -> Vec<f32> {
    (0..n).map(|i| (i as f32 * 0.1).sin()).collect()
}

/// A WAV file; `size` is what it says about the length of its samples.
fn wav(code: u16, bits: u16, channels: u16, data: &[u8], size: u32) -> Vec<u8> {
    let mut file = b"RIFF\0\0\0\0WAVEJUNK\x03\0\0\0abc\0fmt ".to_vec();
    file.extend(16_u32.to_le_bytes());
    file.extend(code.to_le_bytes());
    file.extend(channels.to_le_bytes());
    file.extend((RATE as u32).to_le_bytes());
    let frame = channels * bits / 8;
    file.extend((RATE as u32 * u32::from(frame)).to_le_bytes());
    file.extend(frame.to_le_bytes());
    file.extend(bits.to_le_bytes());
    file.extend(b"data");
    file.extend(size.to_le_bytes());
    file.extend(data);
    file
}

fn wav_i16(samples: &[i16], channels: u16) -> Vec<u8> {
    let data: Vec<u8> = samples.iter().flat_map(|s| s.to_le_bytes()).collect();
    wav(1, 16, channels, &data, data.len() as u32)
}

#[test]
fn wav_of_every_encoding() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.wav");
    let half = 0.5_f64;
    for (code, bits, bytes) in [
        (1, 8, vec![128, 192, 0]),
        (
            1,
            16,
            [0_i16, 16_384, -32_768]
                .iter()
                .flat_map(|x| x.to_le_bytes())
                .collect(),
        ),
        (1, 24, vec![0, 0, 0, 0, 0, 0x40, 0, 0, 0x80]),
        (
            1,
            32,
            [0_i32, 1 << 30, i32::MIN]
                .iter()
                .flat_map(|x| x.to_le_bytes())
                .collect(),
        ),
        (
            3,
            32,
            [0.0_f32, 0.5, -1.0]
                .iter()
                .flat_map(|x| x.to_le_bytes())
                .collect(),
        ),
        (
            3,
            64,
            [0.0, half, -1.0]
                .iter()
                .flat_map(|x| x.to_le_bytes())
                .collect(),
        ),
    ] {
        // A recorder that was switched off says nothing about the length.
        for size in [bytes.len() as u32, u32::MAX] {
            fs::write(&path, wav(code, bits, 1, &bytes, size)).unwrap();
            let (channels, rate) = read(&path, &Options::default());
            assert_eq!(channels["channel_1"], [0.0, 0.5, -1.0], "{code} {bits}");
            assert_eq!(rate, Some(RATE));
        }
    }
    fs::write(&path, wav_i16(&[1, -2, 3, -4], 2)).unwrap();
    let (channels, _) = read(&path, &options(&["channel_2"], None));
    assert_eq!(channels.len(), 1);
    assert_eq!(channels["channel_2"], [-2.0 / 32_768.0, -4.0 / 32_768.0]);
}

#[test]
fn csv_of_many_dialects() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.csv");
    for text in [
        "t_s,acc [m/s^2],note,p\n0,1.5,x,2\n0.001,-2,y,\n0.002,3e1,,4\n",
        "# recorder 7\n\nt_s;acc [m/s^2];note;p\r\n0;1,5;x;2\r\n0,001;-2;y;\r\n0,002;3e1;;4\r\n",
        "\u{feff}\"t_s\"\t\"acc [m/s^2]\"\t\"note\"\tp\n0\t1.5\tx\t2\n0.001\t-2\ty\t\n0.002\t30\tz\t4",
    ] {
        fs::write(&path, text).unwrap();
        let (channels, rate) = read(&path, &Options::default());
        assert_eq!(channels.keys().collect::<Vec<_>>(), ["acc [m/s^2]", "p"]);
        assert_eq!(channels["acc [m/s^2]"], [1.5, -2.0, 30.0]);
        assert!(channels["p"][1].is_nan());
        assert_eq!(rate, Some(1000.0));
        // The name without its unit will do.
        let (channels, _) = read(&path, &options(&["acc"], None));
        assert_eq!(channels.len(), 1);
    }
    fs::write(&path, "1,2\n3,4\n").unwrap();
    let (channels, rate) = read(&path, &options(&[], Some(5.0)));
    assert_eq!(channels["column_2"], [2.0, 4.0]);
    assert_eq!(rate, Some(5.0));
}

/// As Windows programs write them: UTF-16 with its mark, or one byte a character.
#[test]
fn csv_in_the_characters_of_windows() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.csv");
    let text = "Zeit [s];Stößel [m/s²]\r\n0;1,5\r\n0,001;-2\r\n0,002;30\r\n";
    let mark = "\u{feff}";
    let units: Vec<u16> = format!("{mark}{text}").encode_utf16().collect();
    let little = units.iter().flat_map(|unit| unit.to_le_bytes()).collect();
    let big = units.iter().flat_map(|unit| unit.to_be_bytes()).collect();
    let one_byte = text
        .chars()
        .map(|c| u8::try_from(u32::from(c)).unwrap())
        .collect();
    for bytes in [text.as_bytes().to_vec(), little, big, one_byte] {
        fs::write(&path, bytes).unwrap();
        let (channels, rate) = read(&path, &Options::default());
        assert_eq!(channels["Stößel [m/s²]"], [1.5, -2.0, 30.0]);
        assert_eq!(rate, Some(1000.0));
    }
}

#[test]
fn csv_columns_that_cannot_be_what_they_are_called() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.csv");
    for found in ["off", "1,234.5"] {
        fs::write(
            &path,
            format!("t_s;acc [g];p [bar]\n0;{found};1\n0.001;2;1\n"),
        )
        .unwrap();
        let error = message(&path, &Options::default());
        let expected = format!("line 2, column `acc [g]`: found `{found}`, expected a number");
        assert!(error.contains(&expected), "{error}");
        // Nobody asked for it.
        let (channels, _) = read(&path, &options(&["p"], None));
        assert_eq!(channels.keys().collect::<Vec<_>>(), ["p [bar]"]);
    }
    fs::write(&path, "when,acc\n1,2,10:00:00,2026-01-01\n").unwrap();
    let error = message(&path, &options(&[], Some(1.0)));
    assert!(
        error.contains("line 2 has 4 cells where the first has 2"),
        "{error}"
    );
    // The row numbers of a data frame have no name.
    fs::write(&path, ",t_s,acc\n0,0,5\n1,0.001,6\n").unwrap();
    let (channels, _) = read(&path, &Options::default());
    assert_eq!(channels.keys().collect::<Vec<_>>(), ["acc"]);
}

#[test]
fn csv_numbers_with_two_decimal_signs_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.csv");
    fs::write(
        &path,
        "t_s;p [Pa]\n0;200000\n0.001;200,037\n0.002;200,040\n",
    )
    .unwrap();
    let error = message(&path, &Options::default());
    let expected = "line 3, column `p [Pa]`: found `200,037`, but `0.001` in line 3, column `t_s`";
    assert!(error.contains(expected), "{error}");
    // A date may have points.
    fs::write(
        &path,
        "when;p\n01.01.2026 00:00:00.0;1,5\n01.01.2026 00:00:00.1;2,5\n",
    )
    .unwrap();
    assert_eq!(read(&path, &Options::default()).0["p"], [1.5, 2.5]);
}

#[test]
fn csv_samples_that_are_missing_in_words() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.csv");
    for mark in [
        "Overload", "OVL", "--", "#N/A", "NaN", "n/a", "", "inf", "-inf", "1e99",
    ] {
        fs::write(&path, format!("t_s;acc [g]\n0;1\n0.001;{mark}\n0.002;3\n")).unwrap();
        let acc = read(&path, &Options::default()).0["acc [g]"].clone();
        assert!(acc[1].is_nan(), "{mark}: {acc:?}");
        assert_eq!([acc[0], acc[2]], [1.0, 3.0], "{mark}");
    }
}

#[test]
fn csv_lines_may_end_in_a_separator() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.csv");
    for (names, end) in [
        ("t_s;acc", ";"),
        ("t_s;acc;", ""),
        ("t_s;acc;", ";"),
        ("Device;A\nt_s;acc", ";"),
    ] {
        fs::write(
            &path,
            format!("{names}\n0;1{end}\n0.001;{end}\n0.002;3{end}\n"),
        )
        .unwrap();
        let (channels, rate) = read(&path, &Options::default());
        assert_eq!(
            channels.keys().collect::<Vec<_>>(),
            ["acc"],
            "{names} {end}"
        );
        assert_eq!((channels["acc"][2], rate), (3.0, Some(1000.0)));
    }
    fs::write(&path, "t_s;acc\n0;1;5\n").unwrap();
    assert!(message(&path, &Options::default()).contains("line 2 has 3 cells"));
}

#[test]
fn csv_times_that_do_not_run_forwards_are_named_by_their_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.csv");
    let rows = |times: &mut dyn Iterator<Item = i32>| -> String {
        times.map(|t| format!("{t};1\n")).collect()
    };
    for (text, expected) in [
        (
            rows(&mut (0..9).rev()),
            "the times run backwards: line 4 is at 0.007 s, the one before at 0.008 s",
        ),
        (
            rows(&mut (0..9000).chain([8999])),
            "line 9003 is at 8.999 s, the one before at 8.999 s",
        ),
        (
            rows(&mut (0..9000)).replace("\n7000;", "\n\n7000;") + "5;1\n",
            "line 9004 is at 0.005 s, the one before at 8.999 s",
        ),
    ] {
        fs::write(&path, format!("Device A\nTime [msec];acc\n{text}")).unwrap();
        let error = message(&path, &Options::default());
        assert!(error.contains(expected), "{error}");
    }
}

/// As data loggers write them: what they say of themselves first, units in a line of their own, dates for times.
#[test]
fn csv_as_loggers_write_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.csv");
    let rows = |write: &dyn Fn(usize) -> String| (0..40).map(write).collect::<String>();
    let german = rows(&|i| format!("0,{i:03};{},5\n", i + 1));
    let plain = rows(&|i| format!("{},{}.5\n", i as f64 / 1000.0, i + 1));
    // Past midnight.
    let dated = rows(&|i| {
        let (day, at) = if i < 20 {
            (1, "23:59:59.99")
        } else {
            (2, "00:00:00.00")
        };
        format!("2026-01-{day:02} {at}{:02},{}.5\n", i % 20 * 5, i + 1)
    });
    let clock = rows(&|i| format!("10:00:00.{i:03},{}.5\n", i + 1));
    for (text, name, rate) in [
        (format!("Zeit [s];Druck\n{german}"), "Druck", 1000.0),
        (format!("Elapsed (s);acc\n{german}"), "acc", 1000.0),
        (
            format!("Device: ABC\nChannels,2\nSample rate: 1 kHz\n\nTime,Accel\ns,g\n{plain}"),
            "Accel [g]",
            1000.0,
        ),
        (format!("when,acc\n{clock}"), "acc", 1000.0),
        (format!("when,acc\n{dated}"), "acc", 2000.0),
        (
            format!("Datum;Uhrzeit;acc\n{}", dated.replace([' ', ','], ";")),
            "acc",
            2000.0,
        ),
        (
            format!(
                "day;when;acc\n{}",
                dated.replace("2026", "2026-01-01;2026").replace(',', ";")
            ),
            "acc",
            2000.0,
        ),
    ] {
        fs::write(&path, &text).unwrap();
        let (channels, found) = read(&path, &Options::default());
        assert_eq!(channels.keys().collect::<Vec<_>>(), [name], "{text}");
        assert_eq!(channels[name][2], 3.5);
        assert_eq!(channels[name].len(), 40);
        assert!((found.unwrap() - rate).abs() < 1e-6 * rate, "{found:?}");
    }
    // Without times the stated rate counts.
    let values = rows(&|i| format!("{i},{i}.5\n"));
    fs::write(&path, format!("Sampling frequency,2 kHz\na,b\n{values}")).unwrap();
    let (channels, rate) = read(&path, &Options::default());
    assert_eq!(channels.keys().collect::<Vec<_>>(), ["a", "b"]);
    assert_eq!(rate, Some(2000.0));
    // What could be a table and is none is skipped on request.
    fs::write(&path, format!("x,y\n1,2\nt,acc\n{plain}")).unwrap();
    let skipping = Options {
        skipped_lines: 2,
        ..Options::default()
    };
    let (channels, _) = read(&path, &skipping);
    assert_eq!(channels["acc"].len(), 40);
    let error = message(&path, &Options::default());
    assert!(error.contains("line 3, column `x`: found `t`"), "{error}");
    fs::write(&path, format!("when,acc\n{clock}noon,1\n")).unwrap();
    let error = message(&path, &Options::default());
    assert!(error.contains("found `noon`, expected a time"), "{error}");
}

#[test]
fn mat_files_of_another_writer() {
    for name in ["matlab-v6.mat", "matlab-v7.mat", "matlab-v7.3.mat"] {
        let path = Path::new("../../data/recordings").join(name);
        let file = MeasuredFile::open(&path, &Options::default()).unwrap();
        assert_eq!(file.labels()[0].name, "speed_rpm");
        let (channels, rate) = read(&path, &Options::default());
        assert_eq!(
            channels.keys().collect::<Vec<_>>(),
            ["acc_m_s2", "raw_1", "raw_2"]
        );
        assert_eq!(rate, Some(1000.0));
        for (i, found) in channels["acc_m_s2"].iter().enumerate() {
            let expected = (std::f64::consts::TAU * 50.0 * i as f64 / 1000.0).sin();
            assert!((f64::from(*found) - expected).abs() < 1e-7);
        }
        let counted: Vec<f32> = (0..200).map(|i| i as f32).collect();
        assert_eq!(channels["raw_1"], counted);
        assert!(
            channels["raw_2"]
                .iter()
                .zip(&counted)
                .all(|(a, b)| *a == -b)
        );
        let mut file = MeasuredFile::open(&path, &Options::default()).unwrap();
        assert_eq!(
            file.next().unwrap().unwrap().labels(),
            [Value::Real(1796.0)]
        );
    }
}

/// A variable of float64 in a MAT file, big-endian, with a short name in its tag.
fn big_endian_mat(rows: u32, columns: u32, numbers: &[f64]) -> Vec<u8> {
    let mut body = Vec::new();
    let mut words = |words: &[u32]| body.extend(words.iter().flat_map(|w| w.to_be_bytes()));
    words(&[6, 8, 6, 0]);
    words(&[5, 8, rows, columns]);
    words(&[1 << 16 | 1, u32::from_be_bytes(*b"x\0\0\0")]);
    words(&[9, 8 * numbers.len() as u32]);
    body.extend(numbers.iter().flat_map(|x| x.to_be_bytes()));
    let mut file = vec![b' '; 124];
    file.extend(b"\x01\0MI");
    file.extend(14_u32.to_be_bytes());
    file.extend((body.len() as u32).to_be_bytes());
    file.extend(body);
    file
}

/// Variables of float64 in a MAT file, big-endian, each a column.
fn big_endian_variables(variables: &[(&str, &[f64])]) -> Vec<u8> {
    let mut file = vec![b' '; 124];
    file.extend(b"\x01\0MI");
    for (name, numbers) in variables {
        let mut body = Vec::new();
        let mut words = |words: &[u32]| body.extend(words.iter().flat_map(|w| w.to_be_bytes()));
        words(&[
            6,
            8,
            6,
            0,
            5,
            8,
            numbers.len() as u32,
            1,
            1,
            name.len() as u32,
        ]);
        body.extend(name.bytes());
        body.resize(body.len().next_multiple_of(8), 0);
        body.extend(
            [9, 8 * numbers.len() as u32]
                .iter()
                .flat_map(|w| w.to_be_bytes()),
        );
        body.extend(numbers.iter().flat_map(|x| x.to_be_bytes()));
        file.extend([14, body.len() as u32].iter().flat_map(|w| w.to_be_bytes()));
        file.extend(body);
    }
    file
}

#[test]
fn mat_of_the_other_byte_order_with_channels_as_rows() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mat");
    let numbers: Vec<f64> = (0..20).map(f64::from).collect();
    fs::write(&path, big_endian_mat(2, 10, &numbers)).unwrap();
    let (channels, rate) = read(&path, &options(&[], Some(9.0)));
    let even: Vec<f32> = (0..10).map(|i| 2.0 * i as f32).collect();
    assert_eq!(channels["x_1"], even);
    assert_eq!(channels["x_2"][9], 19.0);
    assert_eq!(rate, Some(9.0));
}

fn reals(columns: Vec<(&str, Option<&str>, Vec<f64>)>) -> Table {
    let (schema, data): (Vec<_>, Vec<_>) = columns
        .into_iter()
        .map(|(name, unit, values)| {
            let column = Column::new(name, Kind::Real, "");
            let column = unit.map_or(column.clone(), |unit| column.unit(unit));
            (column, Data::Real(values.into_iter().map(Some).collect()))
        })
        .unzip();
    Table::from_columns(Schema::new(schema).unwrap(), data).unwrap()
}

fn times(n: usize) -> Vec<f64> {
    (0..n).map(|i| i as f64 / RATE).collect()
}

#[test]
fn parquet_and_csv_of_this_program() {
    let folder = tempfile::tempdir().unwrap();
    let n = 20_000;
    let wave: Vec<f64> = sine(n).iter().map(|x| f64::from(*x)).collect();
    let table = reals(vec![
        ("t_s", Some("s"), times(n)),
        ("force", Some("N"), wave),
    ]);
    let plain = folder.path().join("a.parquet");
    fs::write(
        &plain,
        parquet::write_table(Vec::new(), &table, 3000).unwrap(),
    )
    .unwrap();
    let text = folder.path().join("a.csv");
    fs::write(&text, csv::write_table(Vec::new(), &table).unwrap()).unwrap();
    for path in [&plain, &text] {
        let (channels, rate) = read(path, &Options::default());
        assert_eq!(channels["force"], sine(n));
        assert_eq!(rate, Some(RATE));
    }
    let file = MeasuredFile::open(&plain, &Options::default()).unwrap();
    assert_eq!(file.channels()[0].unit.as_deref(), Some("N"));
}

fn dataset_rows() -> Table {
    let schema = Schema::new(vec![
        Column::new("case_id", Kind::Text, ""),
        Column::new("speed_rpm", Kind::Real, "").unit("rpm"),
        Column::new("acc_m_s2", Kind::Samples, "").unit("m/s^2"),
        Column::new("crank_angle_rad", Kind::Samples, "").unit("rad"),
        Column::new("sample_rate_hz", Kind::Real, "").unit("Hz"),
    ]);
    let mut table = Table::new(schema.unwrap());
    for (i, n) in [300_usize, 500].into_iter().enumerate() {
        let row: Vec<Value> = vec![
            format!("case-{i}").into(),
            (500.0 + i as f64).into(),
            sine(n).into(),
            sine(n).into(),
            (RATE * (i + 1) as f64).into(),
        ];
        table.push(row).unwrap();
    }
    table
}

#[test]
fn every_row_of_lists_is_a_recording() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.parquet");
    fs::write(
        &path,
        parquet::write_table(Vec::new(), &dataset_rows(), 1).unwrap(),
    )
    .unwrap();
    let mut file = MeasuredFile::open(&path, &options(&["acc_m_s2"], None)).unwrap();
    assert!(file.is_table());
    // The crank angle comes along.
    assert_eq!(file.channels().len(), 2);
    for (i, n) in [300, 500].into_iter().enumerate() {
        let recording = file.next().unwrap().unwrap();
        let labels = [format!("case-{i}").into(), (500.0 + i as f64).into()];
        assert_eq!(recording.labels(), labels);
        assert_eq!(recording.sample_rate_hz(), Some(RATE * (i + 1) as f64));
        assert_eq!(samples(recording, 2)[0], sine(n));
    }
    assert!(file.next().is_none());
}

#[test]
fn lists_over_the_crank_angle_have_the_rate_of_their_speed() {
    let schema = Schema::new(vec![
        Column::new("speed_rpm", Kind::Real, "").unit("rpm"),
        Column::new("acc_m_s2", Kind::Samples, "").unit("m/s^2"),
        Column::new("samples_per_revolution", Kind::Integer, ""),
    ]);
    let mut table = Table::new(schema.unwrap());
    for speed in [500.0, 350.0] {
        let row = [Value::from(speed), sine(2048).into(), 512_i64.into()];
        table.push(row.into()).unwrap();
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.parquet");
    fs::write(&path, parquet::write_table(Vec::new(), &table, 1).unwrap()).unwrap();
    let rates = |stated: Option<f64>| -> Result<Vec<Option<f64>>, recordings::Error> {
        let file = MeasuredFile::open(&path, &options(&[], stated))?;
        file.map(|recording| Ok(recording?.sample_rate_hz()))
            .collect()
    };
    let expected = [500.0, 350.0].map(|speed| Some(512.0 * speed / 60.0));
    assert_eq!(rates(None).unwrap(), expected);
    // One rate for all speeds is wrong.
    assert!(rates(Some(4266.6667)).is_err());
}

fn mcap_bytes(n: usize) -> Vec<u8> {
    let wave = sine(n);
    let channel = mcap::Channel {
        name: "throw1.acceleration_m_s2",
        unit: "m/s^2",
        samples: &wave,
    };
    let labels = [
        ("fault", "big_end"),
        ("clearance_main_m", "1e-4"),
        ("sample_rate_hz", "24000"),
    ];
    let labels = labels.map(|(a, b)| (a.to_owned(), b.to_owned())).into();
    let recording = mcap::Recording {
        sample_rate_hz: 24_000.0,
        channels: &[channel],
        labels: &labels,
        sweep_yaml: "seed: 7\n",
    };
    mcap::write(Vec::new(), &recording).unwrap()
}

#[test]
fn mcap_of_this_program() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    fs::write(&path, mcap_bytes(50_000)).unwrap();
    let (channels, rate) = read(&path, &Options::default());
    assert_eq!(channels["throw1_acceleration_m_s2"], sine(50_000));
    assert_eq!(rate, Some(24_000.0));
    let mut file = MeasuredFile::open(&path, &Options::default()).unwrap();
    assert_eq!(file.channels()[0].unit.as_deref(), Some("m/s^2"));
    let labels = file.next().unwrap().unwrap().labels().to_vec();
    assert_eq!(labels, [Value::Real(1e-4), "big_end".into()]);
}

/// Messages in JSON, as other programs log them.
fn json_mcap(n: u64) -> Vec<u8> {
    let mut out = ::mcap::Writer::new(std::io::Cursor::new(Vec::new())).unwrap();
    let schema = out.add_schema("Sample", "jsonschema", b"{}").unwrap();
    let channel = out
        .add_channel(schema, "/sensor", "json", &BTreeMap::new())
        .unwrap();
    for i in 0..n {
        let header = ::mcap::records::MessageHeader {
            channel_id: channel,
            sequence: i as u32,
            log_time: 5_000_000_000 + i * 1_000_000,
            publish_time: 0,
        };
        let text = format!(
            "{{\"name\": \"a\", \"acc_m_s2\": {}, \"on\": true}}",
            i as f64 / 2.0
        );
        out.write_to_known_channel(&header, text.as_bytes())
            .unwrap();
    }
    out.finish().unwrap();
    out.into_inner().into_inner()
}

#[test]
fn mcap_of_json_messages() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mcap");
    fs::write(&path, json_mcap(300)).unwrap();
    let (channels, rate) = read(&path, &Options::default());
    assert_eq!(channels["acc_m_s2"][299], 149.5);
    assert_eq!((channels.len(), rate), (1, Some(1000.0)));
}

fn windows(path: &Path, length: Length) -> (Vec<(f64, Option<f64>, usize)>, u64) {
    let mut file = MeasuredFile::open(path, &Options::default()).unwrap();
    let recording = file.next().unwrap().unwrap();
    let rate = recording.sample_rate_hz().unwrap();
    let mut windows = Windows::new(recording, file.channels().len(), rate, length);
    let all = windows.by_ref().map(|window| {
        let window = window.unwrap();
        (window.start_s, window.gap_s, window.channels[0].len())
    });
    (all.collect(), windows.left_out())
}

#[test]
fn windows_end_at_gaps_and_count_what_is_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.csv");
    // 250 samples, 0.75 s of nothing, 130 samples, at 1 kHz.
    let stamps = (0..250).chain(1000..1130).map(|i| f64::from(i) / 1000.0);
    let lines: String = stamps.map(|t| format!("{t:.3},1\n")).collect();
    fs::write(&path, format!("t,x\n{lines}")).unwrap();
    let round = |(all, left): (Vec<(f64, Option<f64>, usize)>, u64)| {
        let all = all.into_iter();
        let milli = |s: f64| (1000.0 * s).round() as i64;
        (
            all.map(|(s, g, n)| (milli(s), g.map(milli), n))
                .collect::<Vec<_>>(),
            left,
        )
    };
    assert_eq!(
        round(windows(&path, Length::Equal(100.5))),
        (
            vec![(0, None, 100), (101, None, 100), (1000, Some(750), 100)],
            49 + 29
        )
    );
    assert_eq!(
        round(windows(&path, Length::UpTo(100))),
        (
            vec![
                (0, None, 100),
                (100, None, 100),
                (200, None, 50),
                (1000, Some(750), 100)
            ],
            30
        )
    );
    assert_eq!(
        round(windows(&path, Length::UpTo(1000))).0,
        [(0, None, 250), (1000, Some(750), 130)]
    );
}
