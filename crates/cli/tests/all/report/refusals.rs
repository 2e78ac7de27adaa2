//! Folders without a page: none that is a dataset, damaged ones, pages that cannot be written.

use super::{Dataset, GRID, RANDOM, refusal, report};
use std::fs;
use sweep::sweep_file::Format;

#[test]
fn what_is_no_dataset_is_refused() {
    let root = tempfile::tempdir().unwrap();
    let said = |folder: &str| refusal(root.path(), &report(&root.path().join(folder), &[]));
    assert_eq!(said("gone"), (2, "error: T/gone: no such folder".into()));
    fs::create_dir_all(root.path().join("half/_sweep")).unwrap();
    assert_eq!(
        said("half"),
        (
            2,
            "error: T/half: the dataset is not finished (no manifest.json): gen-dataset SWEEP.yaml --out T/half --resume \
             finishes it"
                .into()
        )
    );
    fs::create_dir(root.path().join("other")).unwrap();
    assert_eq!(
        said("other"),
        (2, "error: T/other: no dataset (no manifest.json)".into())
    );
    fs::write(root.path().join("other/manifest.json"), "{").unwrap();
    assert_eq!(
        said("other"),
        (
            2,
            "error: cannot read `T/other/manifest.json` as a manifest: EOF while parsing an object at line 1 column 1"
                .into()
        )
    );
}

#[test]
fn a_damaged_dataset_is_refused_and_the_last_page_left() {
    let dataset = Dataset::with_sweep(RANDOM, Format::Parquet);
    fs::write(dataset.path().join("report.html"), "the last").unwrap();
    let signals = dataset.path().join("signals/train-00000-of-00001.parquet");
    let features = dataset.path().join("features/train-00000-of-00001.parquet");
    let whole = fs::read(&features).unwrap();

    fs::write(&features, &whole[..whole.len() / 2]).unwrap();
    let (status, message) = dataset.refusal(&[]);
    assert_eq!(status, 2);
    assert_eq!(
        message,
        format!(
            "error: T/dataset/features/train-00000-of-00001.parquet has {} bytes instead of {}: `crosshead verify` names all such files",
            whole.len() / 2,
            whole.len()
        )
    );

    fs::write(&features, vec![0; whole.len()]).unwrap();
    let (status, message) = dataset.refusal(&[]);
    assert_eq!(status, 2);
    assert_eq!(
        message,
        "error: T/dataset/features/train-00000-of-00001.parquet has another checksum than when it was written: `crosshead verify` names all such files"
    );

    fs::remove_file(&features).unwrap();
    let (status, message) = dataset.refusal(&[]);
    assert_eq!(status, 2);
    assert_eq!(
        message,
        "error: T/dataset/features/train-00000-of-00001.parquet is missing: `crosshead verify` names all such files"
    );

    fs::write(&features, &whole).unwrap();
    fs::remove_file(&signals).unwrap();
    let (status, message) = dataset.refusal(&[]);
    assert_eq!(status, 2);
    assert!(
        message.contains("signals/train-00000-of-00001.parquet"),
        "{message}"
    );

    fs::remove_file(dataset.path().join("sweep.yaml")).unwrap();
    let (status, message) = dataset.refusal(&[]);
    assert_eq!(status, 2);
    assert!(message.contains("T/dataset/sweep.yaml"), "{message}");
    assert_eq!(dataset.html(), "the last");
}

/// The table of another sweep, with the manifest to match, lacks a column that this one has.
#[test]
fn a_missing_column_is_named() {
    let (random, grid) = (
        Dataset::with_sweep(RANDOM, Format::Parquet),
        Dataset::with_sweep(GRID, Format::Parquet),
    );
    for file in ["manifest.json", "features/train-00000-of-00001.parquet"] {
        fs::copy(grid.path().join(file), random.path().join(file)).unwrap();
    }
    assert_eq!(
        random.refusal(&[]),
        (
            2,
            "error: T/dataset/features/train-00000-of-00001.parquet: no column `crosshead.mass_kg`, which every dataset of \
             this sweep has"
                .into()
        )
    );
}

#[test]
fn a_page_that_cannot_be_written_is_failed_work() {
    let dataset = Dataset::with_sweep(RANDOM, Format::Parquet);
    let out = dataset.folder.path().join("gone/page.html");
    let (status, message) = dataset.refusal(&["--out", out.to_str().unwrap()]);
    assert_eq!(status, 1);
    assert!(message.starts_with("error: T/gone/figures: "), "{message}");
}
