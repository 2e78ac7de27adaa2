//! Cases that end their process: found in processes of their own, and only then.
#![cfg(unix)]

mod toy;

use recordings::Manifest;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::process::Command;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::SeqCst};
use std::sync::{Mutex, MutexGuard, PoisonError};
use sweep::dataset::{Failure, Output, status};
use sweep::{Case, Error, Existing, Options, Recording, generate};
use toy::{CASES, SWEEP, assert_same, each, options, plan, record, run};

/// The case that its process ends with.
const DEADLY: u64 = 9;

fn deadly(case: &Case) -> Result<Recording, Failure> {
    assert_ne!(case.index, DEADLY, "the process ends");
    record(case)
}

/// One test at a time: a process that another test just started holds a copy of every lock until it
/// runs its own program.
fn alone() -> MutexGuard<'static, ()> {
    static ALONE: Mutex<()> = Mutex::new(());
    ALONE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A shell that does `script`.
fn shell(script: &str) -> Option<Command> {
    let mut command = Command::new("sh");
    command.args(["-c", script]);
    Some(command)
}

/// Makes the dataset, and tells how often its process ended with [`DEADLY`] meanwhile.
fn attempts(root: &Path, options: &Options) -> (Result<Manifest, Error>, u64) {
    let plan = plan(SWEEP);
    let attempt = || generate(&plan, root, options, &each(deadly), &mut ());
    for ended in 0..10 {
        if let Ok(made) = catch_unwind(AssertUnwindSafe(attempt)) {
            return (made, ended);
        }
    }
    panic!("it does not come to an end");
}

fn resume(cancel: &AtomicBool) -> Options<'_> {
    options(Existing::Resume, 2, cancel)
}

#[test]
fn a_case_fails_by_the_end_of_its_own_process() {
    let _alone = alone();
    for (end, reason) in [
        ("kill -ABRT $$", "its process ended by SIGABRT (signal 6)"),
        ("kill -SEGV $$", "its process ended by SIGSEGV (signal 11)"),
        ("exit 101", "its process panicked"),
        (
            "kill -KILL $$",
            "its process, which ran nothing else, was killed 3 times (SIGKILL, signal 9), as happens \
             where memory runs out",
        ),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path().join("set");
        let (cancel, tried) = (AtomicBool::new(false), AtomicU64::new(0));
        let trial = |of: &Path, case| {
            assert_eq!(of, root);
            tried.fetch_add(1, SeqCst);
            shell(if case == DEADLY { end } else { "exit 0" })
        };
        let options = Options {
            trial: Some(&trial),
            ..resume(&cancel)
        };
        let (manifest, ended) = attempts(&root, &options);
        let manifest = manifest.unwrap();
        assert_eq!(ended, 3);
        // The shards that were under way, of at most 7 cases.
        assert!((7..=21).contains(&tried.load(SeqCst)));
        let [failed] = &manifest.failed[..] else {
            panic!("{:?}", manifest.failed);
        };
        assert_eq!(
            (failed.case_id.as_str(), failed.died),
            ("case-000009", true)
        );
        assert_eq!(failed.reason, reason);
        let rows: u64 = manifest.counts.rows.values().flat_map(|f| f.values()).sum();
        assert_eq!(rows, 2 * (CASES - 1));
        let left = fs::read_dir(root.join("_sweep/attempts")).unwrap();
        assert_eq!(left.count(), 0);
    }
}

#[test]
fn a_signal_from_outside_fails_no_case() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let [whole, root] = ["whole", "set"].map(|name| folder.path().join(name));
    run(&plan(SWEEP), &whole, Existing::Refuse, 2).unwrap();
    let (cancel, healthy) = (AtomicBool::new(false), AtomicBool::new(false));
    let runner = each(|case: &Case| {
        assert!(healthy.load(SeqCst), "killed from outside");
        record(case)
    });
    let killed = AtomicU64::new(0);
    let trial = |_: &Path, _| {
        let killed = killed.fetch_add(1, SeqCst);
        let ends = ["kill -TERM $$", "kill -KILL $$", "exit 1", "kill -HUP $$"];
        shell(ends[killed as usize % 4])
    };
    let options = Options {
        trial: Some(&trial),
        ..resume(&cancel)
    };
    let plan = plan(SWEEP);
    for _ in 0..4 {
        let attempt = || generate(&plan, &root, &options, &runner, &mut ());
        assert!(catch_unwind(AssertUnwindSafe(attempt)).is_err());
    }
    healthy.store(true, SeqCst);
    let manifest = generate(&plan, &root, &options, &runner, &mut ()).unwrap();
    assert!(manifest.failed.is_empty(), "{:?}", manifest.failed);
    assert!(killed.load(SeqCst) > 4);
    assert_same(&whole, &root);
}

fn nothing_is_tried(_: &Path, _: u64) -> Option<Command> {
    panic!("a case is tried")
}

#[test]
fn processes_at_work_are_no_reason_to_try_a_case() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let [whole, root] = ["whole", "set"].map(|name| folder.path().join(name));
    let plan = plan(SWEEP);
    run(&plan, &whole, Existing::Refuse, 2).unwrap();
    drop(Output::open(&root, &plan, Existing::Refuse).unwrap());
    let cancel = AtomicBool::new(false);
    let trial = nothing_is_tried;
    let options = Options {
        trial: Some(&trial),
        ..resume(&cancel)
    };
    // Five at once at one shard, each of which begins while the ones before are at work.
    fn at_work(root: &Path, options: &Options, deep: &AtomicU64) {
        let (output, plan) = Output::join(root).unwrap();
        let runner = each(|case: &Case| {
            if case.index == 3 && deep.fetch_add(1, SeqCst) < 5 {
                let (seen, _) = Output::open_read_only(root).unwrap();
                let attended = status(&seen, &plan, false).unwrap().attempts[0].1;
                assert_eq!((attended.at_work, attended.ended), (deep.load(SeqCst), 0));
                // On a thread of its own, as another process would be.
                let (cancel, trial) = (AtomicBool::new(false), nothing_is_tried);
                let options = Options {
                    trial: Some(&trial),
                    ..resume(&cancel)
                };
                std::thread::scope(|scope| {
                    scope
                        .spawn(|| at_work(root, &options, deep))
                        .join()
                        .unwrap()
                });
            }
            record(case)
        });
        sweep::run_shards(&plan, &output, &[0], options, &runner, &mut ()).unwrap();
    }
    let deep = AtomicU64::new(0);
    at_work(&root, &options, &deep);
    assert_eq!(deep.load(SeqCst), 6);
    generate(&plan, &root, &options, &each(record), &mut ()).unwrap();
    let files = toy::files(&root);
    for (path, content) in toy::files(&whole) {
        assert!(files[&path] == content, "{path:?}");
    }
}

#[test]
fn a_case_with_rows_stands_against_one_that_died() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let [whole, root] = ["whole", "set"].map(|name| folder.path().join(name));
    let plan = plan(SWEEP);
    run(&plan, &whole, Existing::Refuse, 2).unwrap();
    let cancel = AtomicBool::new(false);
    let dies = |_: &Path, case| {
        shell(if case == DEADLY {
            "kill -ABRT $$"
        } else {
            "exit 0"
        })
    };
    let passes = |_: &Path, _| shell("exit 0");
    let with = |trial, retry_failed| Options {
        trial: Some(trial),
        retry_failed,
        ..resume(&cancel)
    };
    let (made, _) = attempts(&root, &with(&dies, false));
    assert_eq!(made.unwrap().failed.len(), 1);
    // Nobody asked to try again.
    let made = generate(&plan, &root, &with(&passes, false), &each(record), &mut ());
    assert_eq!(made.unwrap().failed.len(), 1);
    let again = |trial| generate(&plan, &root, &with(trial, true), &each(record), &mut ());
    assert_eq!(again(&dies).unwrap().failed.len(), 1);
    assert_eq!(again(&passes).unwrap().failed.len(), 0);
    assert_same(&whole, &root);

    // Who comes with the death is too late, and the rows stay.
    let commit = root.join("_sweep/commits/1.json");
    let rows = fs::read(&commit).unwrap();
    let (output, plan) = Output::join(&root).unwrap();
    for attempt in 0..3 {
        let shard = || {
            sweep::run_shards(
                &plan,
                &output,
                &[1],
                &with(&dies, false),
                &each(deadly),
                &mut (),
            )
        };
        assert!(catch_unwind(AssertUnwindSafe(shard)).is_err(), "{attempt}");
    }
    sweep::run_shards(
        &plan,
        &output,
        &[1],
        &with(&dies, false),
        &each(deadly),
        &mut (),
    )
    .unwrap();
    assert_eq!(fs::read(&commit).unwrap(), rows);
    drop(output);
    run(&plan, &root, Existing::Resume, 2).unwrap();
    fs::remove_file(root.join("_sweep/commit.lock")).unwrap();
    assert_same(&whole, &root);
}

#[test]
fn a_case_that_failed_is_tried_again_where_that_is_asked_for() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let [whole, root] = ["whole", "set"].map(|name| folder.path().join(name));
    let plan = plan(SWEEP);
    run(&plan, &whole, Existing::Refuse, 2).unwrap();
    let cancel = AtomicBool::new(false);
    let refuses = each(|case: &Case| match case.index {
        DEADLY => Err("no licence today".into()),
        _ => record(case),
    });
    let made = generate(&plan, &root, &resume(&cancel), &refuses, &mut ());
    assert_eq!(made.unwrap().failed.len(), 1);
    let retry = Options {
        retry_failed: true,
        ..resume(&cancel)
    };
    let runs = AtomicU64::new(0);
    let counted = each(|case: &Case| {
        runs.fetch_add(1, SeqCst);
        record(case)
    });
    generate(&plan, &root, &retry, &counted, &mut ()).unwrap();
    // The shard of the case, and no other.
    assert_eq!(runs.load(SeqCst), plan.shard_size);
    assert_same(&whole, &root);
}
