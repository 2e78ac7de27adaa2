//! Tables to CSV.

use crate::{Data, Error, Kind, Table};
use std::io::{self, Write};

/// Writes a table without recordings: one line of names, one line per row, and hands the writer
/// back. Missing values are empty. Numbers have the digits that give the same float64 back.
///
/// # Errors
/// When a column holds recordings, which have no place in a cell, or the writer fails.
pub fn write_table<W: Write>(mut out: W, table: &Table) -> Result<W, Error> {
    for (column, data) in table.schema().columns().iter().zip(table.columns()) {
        if data.kind() == Kind::Samples {
            return Err(Error::NotPlain(column.name.clone()));
        }
    }
    write_lines(&mut out, table).map_err(Error::Write)?;
    Ok(out)
}

fn write_lines(out: &mut impl Write, table: &Table) -> io::Result<()> {
    let names = table
        .schema()
        .columns()
        .iter()
        .map(|column| quoted(&column.name));
    writeln!(out, "{}", names.collect::<Vec<_>>().join(","))?;
    for row in 0..table.rows() {
        for (i, data) in table.columns().iter().enumerate() {
            if i > 0 {
                out.write_all(b",")?;
            }
            out.write_all(cell(data, row).as_bytes())?;
        }
        out.write_all(b"\n")?;
    }
    out.flush()
}

fn cell(data: &Data, row: usize) -> String {
    let cell = match data {
        Data::Text(values) => values[row].as_deref().map(quoted),
        Data::Integer(values) => values[row].map(|integer| integer.to_string()),
        Data::Real(values) => values[row].map(number),
        Data::Flag(values) => values[row].map(|flag| flag.to_string()),
        Data::Samples(_) => None,
    };
    cell.unwrap_or_default()
}

/// The shortest digits that give the same number back; with an exponent where zeros would pile up.
fn number(x: f64) -> String {
    if x == 0.0 || (1e-5..1e15).contains(&x.abs()) {
        x.to_string()
    } else if x.is_finite() {
        format!("{x:e}")
    } else {
        x.to_string()
    }
}

fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Column, Schema};

    #[test]
    fn cells_read_back_as_what_they_were() {
        let columns = vec![
            Column::new("run, \"first\"", Kind::Text, "").optional(),
            Column::new("samples", Kind::Integer, ""),
            Column::new("clearance_m", Kind::Real, "")
                .unit("m")
                .optional(),
            Column::new("healthy", Kind::Flag, ""),
        ];
        let mut table = Table::new(Schema::new(columns).unwrap());
        table
            .push(vec!["a\nb".into(), 3.into(), 0.1.into(), true.into()])
            .unwrap();
        table
            .push(vec![
                None::<String>.into(),
                (-4).into(),
                None::<f64>.into(),
                false.into(),
            ])
            .unwrap();
        table
            .push(vec!["c".into(), 0.into(), (-2.5e-300).into(), false.into()])
            .unwrap();
        let written = write_table(Vec::new(), &table).unwrap();
        let expected = concat!(
            "\"run, \"\"first\"\"\",samples,clearance_m,healthy\n",
            "\"a\nb\",3,0.1,true\n",
            ",-4,,false\n",
            "c,0,-2.5e-300,false\n",
        );
        assert_eq!(String::from_utf8(written).unwrap(), expected);
    }

    #[test]
    fn recordings_are_refused() {
        let column = Column::new("signal", Kind::Samples, "");
        let table = Table::new(Schema::new(vec![column]).unwrap());
        let refused = write_table(Vec::new(), &table).unwrap_err().to_string();
        assert_eq!(
            refused,
            "column `signal` holds recordings, which have no place in CSV: write Parquet"
        );
    }

    proptest::proptest! {
        #[test]
        fn no_digit_of_a_number_is_lost(bits: u64) {
            let x = f64::from_bits(bits);
            let back: f64 = number(x).parse().unwrap();
            proptest::prop_assert!(back.to_bits() == x.to_bits() || (x.is_nan() && back.is_nan()));
        }
    }
}
