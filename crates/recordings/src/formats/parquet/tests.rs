use super::*;
use crate::{Column, Data, Error, Kind, Role, Schema, Table, Value};
use arrow_array::{ArrayRef, RecordBatch};
use parquet::arrow::ArrowWriter;
use parquet::basic::{Compression, Encoding};
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{FileReader, SerializedFileReader};
use proptest::prelude::*;
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::sync::Arc;

fn schema() -> Schema {
    let metadata = BTreeMap::from([("sample_rate_hz".to_owned(), "10000".to_owned())]);
    Schema::new(vec![
        Column::new("case_id", Kind::Text, "name of the case"),
        Column::new("reason", Kind::Text, "why there is none").optional(),
        Column::new("window", Kind::Integer, "index of the window").optional(),
        Column::new("clearance_big_end_m", Kind::Real, "radial")
            .unit("m")
            .role(Role::Label),
        Column::new("lyapunov_per_s", Kind::Real, "largest exponent")
            .unit("1/s")
            .optional(),
        Column::new("healthy", Kind::Flag, "no joint is worn").optional(),
        Column::new(
            "throw1.acceleration_m_s2",
            Kind::Samples,
            "of the crosshead",
        )
        .unit("m/s^2"),
        Column::new("cylinder_pressure_pa", Kind::Samples, "absolute")
            .unit("Pa")
            .optional(),
    ])
    .unwrap()
    .with_metadata(metadata)
}

/// Any row of the schema, with missing values and lists of any length.
fn rows() -> impl Strategy<Value = Vec<Vec<Value>>> {
    let samples = || prop::collection::vec(any::<f32>(), 0..40);
    let row = (
        ".*",
        prop::option::of(".*"),
        any::<Option<i64>>(),
        any::<f64>(),
        any::<Option<f64>>(),
        any::<Option<bool>>(),
        samples(),
        prop::option::of(samples()),
    );
    let row = row.prop_map(|(a, b, c, d, e, f, g, h)| {
        vec![
            a.into(),
            b.into(),
            c.into(),
            d.into(),
            e.into(),
            f.into(),
            g.into(),
            h.into(),
        ]
    });
    prop::collection::vec(row, 0..30)
}

fn written(rows: &[Vec<Value>], rows_per_group: usize) -> Vec<u8> {
    let mut writer = TableWriter::new(Vec::new(), &schema(), rows_per_group).unwrap();
    for row in rows {
        writer.write(row.clone()).unwrap();
    }
    assert_eq!(writer.rows(), rows.len() as u64);
    writer.finish().unwrap()
}

fn table(rows: &[Vec<Value>]) -> Table {
    let mut table = Table::new(schema());
    for row in rows {
        table.push(row.clone()).unwrap();
    }
    table
}

fn on_disk(folder: &tempfile::TempDir, bytes: &[u8]) -> PathBuf {
    let path = folder.path().join("a.parquet");
    fs::write(&path, bytes).unwrap();
    path
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn rows_read_back_as_they_were(rows in rows(), rows_per_group in 1_usize..20) {
        let bytes = written(&rows, rows_per_group);
        prop_assert_eq!(&bytes, &written(&rows, rows_per_group));
        prop_assert_eq!(&bytes, &write_table(Vec::new(), &table(&rows), rows_per_group).unwrap());

        let folder = tempfile::tempdir().unwrap();
        let path = on_disk(&folder, &bytes);
        prop_assert_eq!(read_table(&path).unwrap(), table(&rows));

        let file = ParquetFile::open(&path).unwrap();
        let (from, to) = (rows.len() / 3, rows.len() - rows.len() / 4);
        let part = file.read(&["clearance_big_end_m", "case_id"], from..to).unwrap();
        let expected = table(&rows[from..to]);
        prop_assert_eq!(part.values::<String>("case_id").unwrap(), expected.values::<String>("case_id").unwrap());
        prop_assert_eq!(part.values::<f64>("clearance_big_end_m").unwrap(), expected.values::<f64>("clearance_big_end_m").unwrap());
        prop_assert_eq!(part.schema().columns()[0].name.as_str(), "clearance_big_end_m");
    }

    /// Whatever is damaged, the reader says so or reads something: it never panics.
    #[test]
    fn a_damaged_file_is_an_error_at_worst(at in any::<prop::sample::Index>(), bits in 1..=255_u8, cut: bool) {
        let row = |i: i64| vec![
            "case".into(), Value::Missing, i.into(), 1e-4.into(), 3.0.into(), true.into(),
            vec![i as f32; 50].into(), Value::Missing,
        ];
        let mut bytes = written(&[row(0), row(1), row(2)], 2);
        let at = at.index(bytes.len());
        if cut { bytes.truncate(at) } else { bytes[at] ^= bits }
        let folder = tempfile::tempdir().unwrap();
        let read = read_table(&on_disk(&folder, &bytes));
        let named = matches!(read, Err(Error::Damaged { .. }));
        prop_assert!(!cut || named);
    }
}

#[test]
fn row_groups_and_encodings_are_as_promised() {
    let row = |i: i64| {
        let samples = vec![0.25_f32; 300_000];
        vec![
            "case".into(),
            Value::Missing,
            i.into(),
            1e-4.into(),
            3.0.into(),
            true.into(),
            samples.into(),
            Value::Missing,
        ]
    };
    let rows: Vec<_> = (0..7).map(row).collect();
    let folder = tempfile::tempdir().unwrap();
    let path = on_disk(&folder, &written(&rows, 3));
    assert_eq!(read_table(&path).unwrap(), table(&rows));

    let reader = SerializedFileReader::new(File::open(&path).unwrap()).unwrap();
    let metadata = reader.metadata();
    let groups: Vec<_> = metadata
        .row_groups()
        .iter()
        .map(|group| group.num_rows())
        .collect();
    assert_eq!(groups, [3, 3, 1]);
    assert_eq!(metadata.file_metadata().created_by(), Some("crosshead"));
    for column in metadata.row_group(0).columns() {
        assert!(matches!(column.compression(), Compression::ZSTD(_)));
        let encodings: Vec<_> = column.encodings().collect();
        let split = encodings.contains(&Encoding::BYTE_STREAM_SPLIT);
        let dictionary = column.dictionary_page_offset().is_some();
        let expected = match column.column_path().parts()[0].as_str() {
            "case_id" | "reason" => (false, true),
            "window" | "healthy" => (false, false),
            _ => (true, false),
        };
        assert_eq!((split, dictionary), expected, "{}", column.column_path());
    }
}

#[test]
fn a_table_without_rows_is_a_file_with_its_columns() {
    let folder = tempfile::tempdir().unwrap();
    let path = on_disk(&folder, &written(&[], 10));
    let read = read_table(&path).unwrap();
    assert_eq!((read.rows(), read.schema()), (0, &schema()));
}

#[test]
fn a_row_group_has_rows() {
    assert!(matches!(
        TableWriter::new(Vec::new(), &schema(), 0),
        Err(Error::EmptyRowGroup)
    ));
}

/// A file as other programs write them, with Snappy.
fn foreign(folder: &tempfile::TempDir, columns: Vec<(&str, ArrayRef)>) -> PathBuf {
    let batch = RecordBatch::try_from_iter(columns).unwrap();
    let properties = WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        .build();
    let mut writer = ArrowWriter::try_new(Vec::new(), batch.schema(), Some(properties)).unwrap();
    writer.write(&batch).unwrap();
    on_disk(folder, &writer.into_inner().unwrap())
}

#[test]
fn files_of_other_programs_are_read_column_by_column() {
    use arrow_array::types::{Float32Type, Int32Type};
    use arrow_array::*;

    let lists = || vec![Some(vec![Some(1.5), Some(-2.0)]), None];
    let categories: DictionaryArray<Int32Type> = ["none", "big_end"].into_iter().collect();
    let folder = tempfile::tempdir().unwrap();
    let path = foreign(
        &folder,
        vec![
            (
                "t_s",
                Arc::new(Float32Array::from(vec![0.0, 0.1])) as ArrayRef,
            ),
            ("revolution", Arc::new(UInt8Array::from(vec![0, 255]))),
            (
                "note",
                Arc::new(LargeStringArray::from(vec![None, Some("b")])),
            ),
            ("fault", Arc::new(categories)),
            (
                "signal",
                Arc::new(LargeListArray::from_iter_primitive::<Float32Type, _, _>(
                    lists(),
                )),
            ),
            ("day", Arc::new(Date32Array::from(vec![0, 1]))),
            ("count", Arc::new(UInt64Array::from(vec![1, u64::MAX]))),
            (
                "gaps",
                Arc::new(ListArray::from_iter_primitive::<Float32Type, _, _>([
                    Some(vec![None]),
                    None,
                ])),
            ),
        ],
    );
    let file = ParquetFile::open(&path).unwrap();
    let read = |name: &str| {
        file.read(&[name], 0..2)
            .map(|table| table.columns()[0].clone())
    };
    assert_eq!(
        read("t_s").unwrap(),
        Data::Real(vec![Some(0.0), Some(f64::from(0.1_f32))])
    );
    assert_eq!(
        read("revolution").unwrap(),
        Data::Integer(vec![Some(0), Some(255)])
    );
    assert_eq!(
        read("note").unwrap(),
        Data::Text(vec![None, Some("b".into())])
    );
    assert_eq!(
        read("fault").unwrap(),
        Data::Text(vec![Some("none".into()), Some("big_end".into())])
    );
    assert_eq!(
        read("signal").unwrap(),
        Data::Samples(vec![Some(vec![1.5, -2.0]), None])
    );

    let message = |name: &str| read(name).unwrap_err().to_string();
    assert!(
        message("day").contains("column `day`") && message("day").contains("type Date32"),
        "{}",
        message("day")
    );
    assert!(
        message("count").contains("above 2^63 - 1"),
        "{}",
        message("count")
    );
    assert!(
        message("gaps").contains("missing sample"),
        "{}",
        message("gaps")
    );
    assert!(
        message("speed").contains("no column `speed`; there are: t_s, revolution"),
        "{}",
        message("speed")
    );
    let outside = file.read(&["t_s"], 1..3).unwrap_err().to_string();
    assert!(
        outside.starts_with("rows 1 to 3") && outside.ends_with("which has 2"),
        "{outside}"
    );
}

#[test]
fn points_in_time_decimals_and_dictionaries_of_numbers_are_read() {
    use crate::measured::{MeasuredFile, Options};
    use arrow_array::types::Int8Type;
    use arrow_array::*;

    const RATE: i64 = 25_000;
    let folder = tempfile::tempdir().unwrap();
    let count = 200_i64;
    let start = 1_773_482_400;
    let of = |per_second: i64| (0..count).map(move |i| start * per_second + i * per_second / RATE);
    let slow = || (0..count).map(move |i| start * 1000 + 5 * i);
    let with_zone = TimestampMicrosecondArray::from_iter_values(of(1_000_000)).with_timezone("+01:00");
    let decimals = Decimal128Array::from_iter_values((0..count).map(|i| i128::from(25 * i)));
    let decimals = decimals.with_precision_and_scale(10, 2).unwrap();
    let keys = Int8Array::from_iter_values((0..count).map(|i| (i % 2) as i8));
    let coded = DictionaryArray::<Int8Type>::new(keys, Arc::new(Float64Array::from(vec![0.5, -1.5])));
    for (stamps, rate) in [
        (Arc::new(TimestampMillisecondArray::from_iter_values(slow())) as ArrayRef, 200.0),
        (Arc::new(with_zone), RATE as f64),
        (Arc::new(TimestampNanosecondArray::from_iter_values(of(1_000_000_000))), RATE as f64),
    ] {
        let columns: Vec<(&str, ArrayRef)> = vec![
            ("p", Arc::new(decimals.clone())),
            ("when", stamps),
            ("u", Arc::new(coded.clone())),
        ];
        let path = foreign(&folder, columns);
        let mut file = MeasuredFile::open(&path, &Options::default()).unwrap();
        let names: Vec<_> = file.channels().iter().map(|c| c.column.clone()).collect();
        assert_eq!(names, ["p", "u"]);
        let mut recording = file.next().unwrap().unwrap();
        assert!((recording.sample_rate_hz().unwrap() / rate - 1.0).abs() < 1e-9, "{rate}");
        assert!((recording.start_s().unwrap() - start as f64).abs() < 1e-6);
        let mut samples = vec![Vec::new(); 2];
        while recording.read(1000, &mut samples).unwrap().samples > 0 {}
        assert_eq!(samples[0][3], 0.75);
        assert_eq!(samples[1][..3], [0.5, -1.5, 0.5]);
    }
    let day: ArrayRef = Arc::new(Date32Array::from(vec![0, 1]));
    let path = foreign(&folder, vec![("day", day), ("x", Arc::new(Float64Array::from(vec![0.0, 1.0])))]);
    let columns = vec!["day".to_owned()];
    let options = Options { columns, ..Options::default() };
    let error = MeasuredFile::open(&path, &options).err().unwrap().to_string();
    assert!(error.contains("column `day`") && error.contains("type Date32"), "{error}");
}

#[test]
fn a_codec_that_is_not_built_in_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let column: ArrayRef = Arc::new(arrow_array::Float64Array::from(vec![0.0, 1.0]));
    let path = foreign(&folder, vec![("x", column)]);
    let mut bytes = fs::read(&path).unwrap();
    // The codec in the footer is the field after the path of the column: 1 is SNAPPY, 4 BROTLI, as zigzag numbers.
    let length = bytes.len();
    let footer = length - 8 - u32::from_le_bytes(bytes[length - 8..length - 4].try_into().unwrap()) as usize;
    let field = bytes[footer..].windows(4).position(|w| w == [1, b'x', 0x15, 2]).unwrap() + footer;
    bytes[field + 3] = 8;
    fs::write(&path, bytes).unwrap();
    let error = ParquetFile::open(&path).err().unwrap().to_string();
    assert!(error.contains("column `x` is compressed with BROTLI"), "{error}");
}

#[test]
fn what_is_no_parquet_file_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let missing = read_table(Path::new("no/such.parquet"))
        .unwrap_err()
        .to_string();
    assert!(
        missing.starts_with("cannot open `no/such.parquet`: there is no such file"),
        "{missing}"
    );
    let path = on_disk(&folder, b"t_s,acceleration_m_s2\n0,1\n");
    let text = read_table(&path).unwrap_err();
    assert!(
        matches!(&text, Error::Damaged { path: named, .. } if *named == path),
        "{text}"
    );
    read_table(folder.path()).unwrap_err();
}

#[test]
fn units_stand_where_readers_look() {
    let folder = tempfile::tempdir().unwrap();
    let path = on_disk(&folder, &written(&[], 10));
    let reader = SerializedFileReader::new(File::open(&path).unwrap()).unwrap();
    let keys = reader
        .metadata()
        .file_metadata()
        .key_value_metadata()
        .unwrap();
    let value = |key: &str| {
        keys.iter()
            .find(|k| k.key == key)
            .and_then(|k| k.value.clone())
            .unwrap()
    };
    let units: BTreeMap<String, String> = serde_json::from_str(&value("units")).unwrap();
    assert_eq!(units["throw1.acceleration_m_s2"], "m/s^2");
    assert_eq!(units.len(), 4);
    let descriptions: BTreeMap<String, String> =
        serde_json::from_str(&value("descriptions")).unwrap();
    assert_eq!(descriptions["healthy"], "no joint is worn");
    assert_eq!(value("sample_rate_hz"), "10000");
}

/// A file of one column of numbers and one of recordings, from `first` on.
fn numbered(folder: &Path, name: &str, column: &str, first: usize, rows: usize) -> PathBuf {
    let schema = Schema::new(vec![
        Column::new(column, Kind::Real, "a number").unit("m"),
        Column::new("signal", Kind::Samples, "a recording"),
    ]);
    let mut table = Table::new(schema.unwrap());
    for i in first..first + rows {
        let row = vec![(i as f64).into(), vec![i as f32; 3].into()];
        table.push(row).unwrap();
    }
    let path = folder.join(name);
    write_table(File::create(&path).unwrap(), &table, 4).unwrap();
    path
}

/// The numbers of all batches, in order.
fn numbers(batches: Batches) -> Result<Vec<f64>, String> {
    let mut numbers = Vec::new();
    for batch in batches {
        let batch = batch.map_err(|error| error.to_string())?;
        let column = batch.column_by_name("x").unwrap();
        let column = column.as_any().downcast_ref::<arrow_array::Float64Array>();
        numbers.extend(column.unwrap().values());
    }
    Ok(numbers)
}

#[test]
fn several_files_are_one_stream_of_record_batches() {
    let folder = tempfile::tempdir().unwrap();
    let [a, b] = [("a", 0, 5), ("b", 5, 7)]
        .map(|(name, first, rows)| numbered(folder.path(), name, "x", first, rows));
    let both = Batches::new(vec![a.clone(), b.clone()], None).unwrap();
    let expected: Vec<f64> = (0..12).map(f64::from).collect();
    assert_eq!(numbers(both), Ok(expected));
    let some = Batches::new(vec![a.clone()], Some(vec!["x".into()])).unwrap();
    let schema = arrow_array::RecordBatchReader::schema(&some);
    assert_eq!(schema.fields().len(), 1);
    assert_eq!(schema.field(0).metadata().get("unit").unwrap(), "m");
    let rows = Batches::of_rows(&b, None, 2..4).unwrap();
    assert_eq!(numbers(rows), Ok(vec![7.0, 8.0]));
}

#[test]
fn a_stream_says_which_file_is_wrong() {
    let folder = tempfile::tempdir().unwrap();
    let a = numbered(folder.path(), "a", "x", 0, 5);
    let other = numbered(folder.path(), "other", "y", 0, 5);
    let mixed = Batches::new(vec![a.clone(), other], None).unwrap();
    let message = numbers(mixed).unwrap_err();
    assert!(message.contains("other` as Parquet: it has other columns"), "{message}");
    let missing = Batches::new(vec![a.clone(), folder.path().join("c")], None).unwrap();
    assert!(numbers(missing).unwrap_err().contains("cannot open"));
    let column = Batches::new(vec![a.clone()], Some(vec!["z".into()])).err();
    assert_eq!(column.unwrap().to_string(), "no column `z`; there are: x, signal");
    assert!(Batches::of_rows(&a, None, 4..6).is_err());
    assert!(matches!(Batches::new(Vec::new(), None), Err(Error::NoFiles)));
}

#[test]
fn tables_become_record_batches_with_units_and_roles() {
    let mut table = Table::new(schema());
    let samples = vec![1.0_f32, 2.0];
    table
        .push(vec![
            "a".into(),
            Value::Missing,
            3_i64.into(),
            1e-4.into(),
            Value::Missing,
            true.into(),
            samples.clone().into(),
            Value::Missing,
        ])
        .unwrap();
    let batch = crate::formats::record_batch::record_batch(&table).unwrap();
    assert_eq!((batch.num_rows(), batch.num_columns()), (1, 8));
    let schema = batch.schema();
    let field = schema.field_with_name("clearance_big_end_m").unwrap();
    assert_eq!(field.metadata().get("unit").unwrap(), "m");
    assert_eq!(field.metadata().get("role").unwrap(), "label");
    assert_eq!(schema.metadata()["sample_rate_hz"], "10000");
}
