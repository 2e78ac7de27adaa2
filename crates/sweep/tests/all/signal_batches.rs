//! The recordings of a sweep without a folder: the rows that a dataset has, bounded memory, an early end.

use crate::toy;

use recordings::Table;
use recordings::formats::parquet::read_table;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering::SeqCst};
use std::time::Duration;
use sweep::dataset::{SignalBatch, SignalBatches, Waited};
use sweep::{Case, Existing};
use toy::{CASES, SWEEP, each, plan, record, run};

/// Twenty batches of 27 cases.
fn long() -> String {
    let fast = SWEEP.replace("sample_rate: 1 kHz", "sample_rate: 20 kHz");
    fast.replace("count: 5\n", "count: 255\n")
}

fn batches(sweep: &str, threads: usize) -> Vec<SignalBatch> {
    let batches = SignalBatches::new(plan(sweep), threads, each(record)).unwrap();
    batches.map(Result::unwrap).collect()
}

/// The values of each row, with the names of case and window first, in their order.
fn rows<'a>(tables: impl IntoIterator<Item = &'a Table>) -> Vec<(String, i64, String)> {
    let mut all = Vec::new();
    for table in tables {
        let names = table.values::<String>("case_id").unwrap();
        let windows = table.values::<i64>("window").unwrap();
        for row in 0..table.rows() {
            let columns = table.columns().iter();
            let values = columns.map(|column| column.debug_of(row)).collect();
            all.push((names[row].clone().unwrap(), windows[row].unwrap(), values));
        }
    }
    all.sort();
    all
}

trait DebugOf {
    fn debug_of(&self, row: usize) -> String;
}

impl DebugOf for recordings::Data {
    fn debug_of(&self, row: usize) -> String {
        use recordings::Data;
        match self {
            Data::Text(values) => format!("{:?};", values[row]),
            Data::Integer(values) => format!("{:?};", values[row]),
            Data::Real(values) => format!("{:?};", values[row]),
            Data::Flag(values) => format!("{:?};", values[row]),
            Data::Samples(values) => format!("{:?};", values[row]),
        }
    }
}

#[test]
fn the_rows_are_those_of_the_dataset() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().join("set");
    run(&plan(SWEEP), &root, Existing::Refuse, 2).unwrap();
    let files = std::fs::read_dir(root.join("signals")).unwrap();
    let written: Vec<Table> = files
        .map(|file| read_table(&file.unwrap().path()).unwrap())
        .collect();
    let expected = rows(&written);
    assert_eq!(expected.len() as u64, 2 * CASES);
    for (sweep, threads) in [
        (SWEEP.to_owned(), 1),
        (SWEEP.to_owned(), 2),
        // What a dataset keeps in MCAP files is rows here.
        (format!("{SWEEP}format: mcap\n"), 2),
    ] {
        let given = batches(&sweep, threads);
        assert_eq!(rows(given.iter().map(|batch| &batch.table)), expected);
        let columns = given[0].table.schema().columns();
        assert_eq!(columns, written[0].schema().columns());
    }
}

#[test]
fn batches_are_in_order_and_do_not_depend_on_the_threads() {
    let one = batches(&long(), 1);
    assert_eq!(one, batches(&long(), 2));
    assert_eq!(one.len(), 20);
    assert_eq!(one.last().unwrap().cases, 530);
    let names = one.iter().flat_map(|batch| {
        let names = batch.table.values::<String>("case_id").unwrap();
        names.iter().flatten().cloned().collect::<Vec<_>>()
    });
    assert!(names.is_sorted());
}

#[test]
fn a_failed_case_is_named_and_has_no_rows() {
    let failing = |case: &Case| match case.index {
        3 => Err("it broke".into()),
        _ => record(case),
    };
    let batches = SignalBatches::new(plan(SWEEP), 2, each(failing)).unwrap();
    let batches: Vec<SignalBatch> = batches.map(Result::unwrap).collect();
    let failed: Vec<_> = batches.iter().flat_map(|batch| &batch.failed).collect();
    assert_eq!(failed.len(), 1);
    assert_eq!(failed[0].case_id, "case-000003");
    assert_eq!(failed[0].reason, "it broke");
    let rows: usize = batches.iter().map(|batch| batch.table.rows()).sum();
    assert_eq!(rows as u64, 2 * (CASES - 1));

    let none = SignalBatches::new(plan(SWEEP), 2, each(|_: &Case| Err("no".into()))).unwrap();
    let failed: Vec<usize> = none.map(|batch| batch.unwrap().failed.len()).collect();
    assert_eq!(failed, [CASES as usize]);
}

/// A runner that counts the cases that it has begun.
fn counted(
    begun: &Arc<AtomicUsize>,
) -> impl Fn(&[Case]) -> Vec<Result<sweep::Recording, sweep::dataset::Failure>> + Send + Sync + use<>
{
    let begun = begun.clone();
    each(move |case: &Case| {
        begun.fetch_add(1, SeqCst);
        record(case)
    })
}

/// The count once it rests.
fn at_rest(begun: &AtomicUsize) -> usize {
    let mut before = begun.load(SeqCst);
    loop {
        std::thread::sleep(Duration::from_millis(500));
        let now = begun.load(SeqCst);
        if now == before && now > 0 {
            return now;
        }
        before = now;
    }
}

#[test]
fn who_does_not_take_batches_holds_up_the_work() {
    let begun = Arc::new(AtomicUsize::new(0));
    let mut batches = SignalBatches::new(plan(&long()), 2, counted(&begun)).unwrap();
    // One batch waits, one is at the door, one is collected; 128 cases are under way.
    assert!(at_rest(&begun) <= 3 * 27 + 128);
    let rest = batches.by_ref().count();
    assert_eq!((rest, begun.load(SeqCst)), (20, 530));
    assert!(matches!(batches.wait(Duration::MAX), Waited::End));
}

#[test]
fn who_goes_away_ends_the_work() {
    let begun = Arc::new(AtomicUsize::new(0));
    let mut batches = SignalBatches::new(plan(&long()), 2, counted(&begun)).unwrap();
    batches.next().unwrap().unwrap();
    drop(batches);
    // It has waited for the cases under way.
    let ended = begun.load(SeqCst);
    assert!(ended < 300);
    std::thread::sleep(Duration::from_millis(100));
    assert_eq!(begun.load(SeqCst), ended);
}

#[test]
fn a_panic_of_the_runner_is_passed_on() {
    let broken = each(|case: &Case| match case.index {
        20 => panic!("a mistake of the program"),
        _ => record(case),
    });
    let mut batches = SignalBatches::new(plan(SWEEP), 2, broken).unwrap();
    assert!(catch_unwind(AssertUnwindSafe(|| batches.next())).is_err());
}
