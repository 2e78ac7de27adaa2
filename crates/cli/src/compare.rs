//! `crosshead compare`: two recordings, or two datasets, side by side.

use crate::output::{hint, refuse_existing, write_file};
use crate::progress::Progress;
use crate::reading::Reading;
use crate::result_format::ResultFormat;
use crate::{Failure, console};
use ::features::recorded::counted;
use ::report::{comparison_page, text, write_page};
use clap::Args;
use std::path::PathBuf;
use sweep::comparison::{ComparedFeature, Comparison, compare};

/// Features that are printed.
const PRINTED: usize = 10;

/// Arguments of `crosshead compare`.
#[derive(Args, Debug)]
#[command(after_help = "\
A and B are recordings as crosshead features reads them: files, bundles, datasets or folders of
crosshead simulate. Of each the features are averaged over its windows. comparison.json has them
side by side, with difference and ratio; comparison.html has them as a table, and the channels of
both over the crank angle and over frequency.

Examples:
  crosshead compare healthy-run worn-run --out compared
  crosshead compare january.csv june.csv --unit m/s^2 --speed '500 rpm' --out compared
  crosshead compare datasets/measured datasets/simulated --out compared

Exit status: 0 done; 1 the work failed; 2 the input or the arguments are wrong.")]
pub struct Arguments {
    /// The first
    a: PathBuf,
    /// The second
    b: PathBuf,
    #[command(flatten)]
    reading: Reading,
    /// Folder to write into: comparison.json, comparison.html
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Replace a comparison that is there
    #[arg(long)]
    overwrite: bool,
    #[command(flatten)]
    format: ResultFormat,
}

/// Compares the two and writes what differs.
///
/// # Errors
/// Wrong arguments, recordings that cannot be read, or files that cannot be written.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let out = &arguments.out;
    let [json, page] = ["comparison.json", "comparison.html"].map(|name| out.join(name));
    refuse_existing([&json], arguments.overwrite)?;
    let (said, length) = (arguments.reading.said()?, arguments.reading.window()?);
    let pool = console::pool()?;
    let progress = Progress::of_time("features of both");
    let paths = [arguments.a.as_path(), arguments.b.as_path()];
    let comparison = compare(paths, &said, length, &pool).map_err(Failure::input)?;
    drop(progress);
    std::fs::create_dir_all(out).map_err(|error| Failure::unwritten(out, error))?;
    let text = serde_json::to_string_pretty(&comparison).map_err(Failure::work)?;
    write_file(&json, text.as_bytes())?;
    let rendered = comparison_page::render(&comparison).map_err(Failure::work)?;
    write_page(&page, &rendered.html).map_err(Failure::work)?;
    arguments.format.print(&comparison, |comparison| {
        summary(comparison);
        println!("{}", json.display());
        println!("{}", page.display());
    })?;
    hint(format_args!("open {} in a browser", page.display()));
    Ok(())
}

fn summary(comparison: &Comparison) {
    for (name, side) in ["A", "B"].iter().zip(&comparison.sides) {
        println!("{name}: {}, {}", side.name, counted(side.windows, "window"));
    }
    for feature in comparison.most_different().into_iter().take(PRINTED) {
        println!("  {}", line(feature));
    }
}

fn line(feature: &ComparedFeature) -> String {
    let number = |value: Option<f64>| value.map_or("none".to_owned(), |v| text::number(v, 3));
    let unit = match feature.unit.as_str() {
        "1" => String::new(),
        unit => format!(" {}", text::unit(unit)),
    };
    format!(
        "{}: {} and {}{unit}, ratio {}",
        feature.name,
        number(feature.a),
        number(feature.b),
        number(feature.ratio)
    )
}
