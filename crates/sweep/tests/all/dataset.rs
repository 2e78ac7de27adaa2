//! Plans become datasets, with a cheap runner in place of the simulation.

use crate::toy;

use recordings::Manifest;
use std::fs;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::SeqCst};
use sweep::dataset::Output;
use sweep::{Case, Error, Existing, Plan, Progress, generate};
use toy::{CASES, SWEEP, assert_same, each, files, options, plan, record, run};

#[test]
fn threads_and_repetition_change_no_byte() {
    let folder = tempfile::tempdir().unwrap();
    let plan = plan(SWEEP);
    let roots = ["one", "two", "again"].map(|name| folder.path().join(name));
    for (root, threads) in roots.iter().zip([1, 2, 2]) {
        let manifest = run(&plan, root, Existing::Refuse, threads).unwrap();
        assert_eq!((manifest.counts.cases, manifest.counts.failed), (CASES, 0));
        let rows: u64 = manifest.counts.rows.values().flat_map(|f| f.values()).sum();
        assert_eq!(rows, 2 * CASES);
    }
    assert_same(&roots[0], &roots[1]);
    assert_same(&roots[1], &roots[2]);

    let names: Vec<PathBuf> = files(&roots[0]).into_keys().collect();
    let expected = [
        "README.md",
        "manifest.json",
        "sweep.yaml",
        "signals/train-00000-of-00005.parquet",
        "signals/test-00004-of-00005.parquet",
        "features/train-00002-of-00005.parquet",
    ];
    for name in expected {
        assert!(names.contains(&PathBuf::from(name)), "{name} of {names:?}");
    }
    assert!(
        !names
            .iter()
            .any(|n| n.to_string_lossy().contains("validation"))
    );
}

#[test]
fn the_resolved_sweep_gives_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let [first, second] = ["first", "second"].map(|name| folder.path().join(name));
    run(&plan(SWEEP), &first, Existing::Refuse, 2).unwrap();
    let again = Plan::read(&first.join("sweep.yaml")).unwrap();
    assert_eq!(again.id, plan(SWEEP).id);
    run(&again, &second, Existing::Refuse, 2).unwrap();
    assert_same(&first, &second);
}

/// Sets a flag when so many cases are done.
struct StopAfter<'a>(u64, &'a AtomicBool);

impl Progress for StopAfter<'_> {
    fn case_done(&mut self, _: u64, _: bool) {
        self.0 = self.0.saturating_sub(1);
        self.1.store(self.0 == 0, SeqCst);
    }
}

#[test]
fn an_interrupted_sweep_goes_on_and_gives_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let [whole, broken] = ["whole", "broken"].map(|name| folder.path().join(name));
    let plan = plan(SWEEP);
    run(&plan, &whole, Existing::Refuse, 2).unwrap();

    let cancel = AtomicBool::new(false);
    let refuse = options(Existing::Refuse, 2, &cancel);
    let stopped = generate(
        &plan,
        &broken,
        &refuse,
        &each(record),
        &mut StopAfter(16, &cancel),
    );
    let Err(error @ Error::Cancelled { done: 2, shards: 5 }) = stopped else {
        panic!("{stopped:?}");
    };
    assert!(!error.is_input());
    assert!(!broken.join("manifest.json").exists());
    // What a killed process leaves: a half-written file, a finished one without its commit, ...
    fs::write(broken.join("_sweep/tmp/signals-x.parquet.1.part"), "half").unwrap();
    fs::remove_file(broken.join("_sweep/commits/1.json")).unwrap();
    // ... and, with a disk that lost its cache, a file cut short.
    let cut = broken.join("signals/train-00000-of-00005.parquet");
    fs::OpenOptions::new()
        .write(true)
        .open(&cut)
        .unwrap()
        .set_len(10)
        .unwrap();

    let refused = run(&plan, &broken, Existing::Refuse, 2).unwrap_err();
    assert!(matches!(refused, Error::Exists(_)) && refused.is_input());
    run(&plan, &broken, Existing::Resume, 1).unwrap();
    assert_same(&whole, &broken);
}

#[test]
fn a_complete_dataset_is_not_simulated_again() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().join("set");
    let plan = plan(SWEEP);
    // Resuming what has not begun begins it.
    run(&plan, &root, Existing::Resume, 2).unwrap();
    let before = files(&root);
    let runs = AtomicU64::new(0);
    let counted = |case: &Case| {
        runs.fetch_add(1, SeqCst);
        record(case)
    };
    let cancel = AtomicBool::new(false);
    let resume = options(Existing::Resume, 2, &cancel);
    generate(&plan, &root, &resume, &each(counted), &mut ()).unwrap();
    assert_eq!(runs.load(SeqCst), 0);
    assert_eq!(files(&root), before);
}

#[test]
fn only_datasets_of_ours_are_replaced_and_only_the_same_plan_is_resumed() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().join("set");
    let first = plan(SWEEP);
    let other = plan(&SWEEP.replace("seed: 3", "seed: 4"));
    run(&first, &root, Existing::Refuse, 2).unwrap();
    let before = files(&root);
    let error = run(&other, &root, Existing::Resume, 2).unwrap_err();
    assert!(matches!(error, Error::OtherPlan { .. }) && error.is_input());
    assert_eq!(files(&root), before);

    fs::write(root.join("notes.txt"), "mine").unwrap();
    run(&other, &root, Existing::Overwrite, 2).unwrap();
    assert_eq!(fs::read_to_string(root.join("notes.txt")).unwrap(), "mine");
    fs::remove_file(root.join("notes.txt")).unwrap();
    let fresh = folder.path().join("fresh");
    run(&other, &fresh, Existing::Refuse, 2).unwrap();
    assert_same(&root, &fresh);

    let foreign = folder.path().join("foreign");
    fs::create_dir(&foreign).unwrap();
    fs::write(foreign.join("thesis.tex"), "dear").unwrap();
    for existing in [Existing::Overwrite, Existing::Resume] {
        let error = run(&first, &foreign, existing, 2).unwrap_err();
        assert!(matches!(error, Error::NotOurs(_)) && error.is_input());
    }
    assert_eq!(files(&foreign).len(), 1);
}

#[test]
fn two_processes_do_not_share_a_folder() {
    let folder = tempfile::tempdir().unwrap();
    let plan = plan(SWEEP);
    let first = Output::open(folder.path(), &plan, Existing::Refuse).unwrap();
    let second = Output::open(folder.path(), &plan, Existing::Resume).unwrap_err();
    let text = second.to_string();
    assert!(
        text.contains(&format!("process {}", std::process::id())),
        "{text}"
    );
    assert!(second.is_input());
    drop(first);
    // A lock file that a dead process left does not hinder.
    fs::write(folder.path().join("_sweep/lock"), "process 1").unwrap();
    Output::open(folder.path(), &plan, Existing::Resume).unwrap();
    // Those that make a shard each do share it, and keep out one that makes them all.
    let (_first, found) = Output::join(folder.path()).unwrap();
    let _second = Output::join(folder.path()).unwrap();
    assert_eq!(found.id, plan.id);
    let third = Output::open(folder.path(), &plan, Existing::Resume).unwrap_err();
    assert!(third.to_string().contains("makes a shard"), "{third}");
}

#[test]
fn shards_are_of_equal_size_and_part_of_the_plan() {
    let given = plan(SWEEP);
    let five = plan(SWEEP).with_shards(5).unwrap();
    assert_eq!((five.shard_size, five.shards()), (6, 5));
    assert_ne!(five.id, given.id);
    // The size that the file has anyway.
    assert_eq!(
        plan(&SWEEP.replace("shard_size: 7", "shard_size: 6")).id,
        five.id
    );
    let large = plan(&SWEEP.replace("repeats: 2", "repeats: 1000000")).with_shards(3);
    let message = large.unwrap_err().to_string();
    assert!(
        message.contains("5000000 a shard, and 1000000"),
        "{message}"
    );
}

#[test]
fn a_failed_case_is_recorded_and_the_others_go_on() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().join("set");
    let flawed = |case: &Case| match case.index {
        9 => Err("step size underflow at t = 0.31 s".into()),
        12 => record(case).map(|mut recording| {
            recording.channels.pop();
            recording
        }),
        20 => record(case).map(|mut recording| {
            recording.channels[0].samples[5] = f32::NAN;
            recording
        }),
        21 => record(case).map(|mut recording| {
            recording
                .channels
                .iter_mut()
                .for_each(|c| c.samples.truncate(100));
            recording
        }),
        _ => record(case),
    };
    let cancel = AtomicBool::new(false);
    let refuse = options(Existing::Refuse, 2, &cancel);
    let manifest = generate(&plan(SWEEP), &root, &refuse, &each(flawed), &mut ()).unwrap();
    let failed: Vec<&str> = manifest.failed.iter().map(|f| f.case_id.as_str()).collect();
    assert_eq!(
        failed,
        ["case-000009", "case-000012", "case-000020", "case-000021"]
    );
    assert_eq!(
        manifest.failed[0].reason,
        "step size underflow at t = 0.31 s"
    );
    assert_eq!(
        manifest.failed[0].command,
        "crosshead simulate sweep.yaml --case case-000009"
    );
    assert!(manifest.failed[1].reason.contains("channels"));
    assert!(
        manifest.failed[2]
            .reason
            .contains("crosshead_acceleration_m_s2 is not finite")
    );
    assert!(manifest.failed[3].reason.contains("100 samples"));
    assert_eq!(manifest.counts.failed, 4);
    let rows: u64 = manifest.counts.rows.values().flat_map(|f| f.values()).sum();
    assert_eq!(rows, 2 * (CASES - 4));
    assert_eq!(
        Manifest::read(&root.join("manifest.json")).unwrap(),
        manifest
    );
}

#[test]
fn mcap_gives_one_file_per_case() {
    let folder = tempfile::tempdir().unwrap();
    let [one, two] = ["one", "two"].map(|name| folder.path().join(name));
    let plan = plan(&format!("{SWEEP}format: mcap\n"));
    run(&plan, &one, Existing::Refuse, 1).unwrap();
    run(&plan, &two, Existing::Refuse, 2).unwrap();
    assert_same(&one, &two);
    let names = files(&one);
    let count = |folder| names.keys().filter(|name| name.starts_with(folder)).count();
    assert_eq!(count("mcap"), CASES as usize);
    assert_eq!(count("signals"), 0);
    assert_eq!(count("features"), 2 * 5);
}

#[test]
fn rows_say_what_the_case_was() {
    use recordings::formats::parquet;
    let folder = tempfile::tempdir().unwrap();
    let plan = plan(SWEEP);
    run(&plan, folder.path(), Existing::Refuse, 2).unwrap();
    let mut seen = 0;
    for split in ["train", "test"] {
        for shard in 0..5 {
            let name = format!("{split}-{shard:05}-of-00005.parquet");
            let read = |table| parquet::read_table(&folder.path().join(table).join(&name)).unwrap();
            let (signals, features) = (read("signals"), read("features"));
            let texts = |column| signals.values::<String>(column).unwrap();
            for row in 0..signals.rows() {
                let index: u64 = texts("case_id")[row].as_deref().unwrap()[5..]
                    .parse()
                    .unwrap();
                let case = plan.case(index).unwrap();
                let window = signals.values::<i64>("window").unwrap()[row].unwrap();
                assert_eq!(texts("split")[row].as_deref(), Some(split));
                assert_eq!(case.split.name(), split);
                assert_eq!(texts("fault")[row].as_deref(), Some(&*case.labels.fault));
                assert_eq!(
                    signals.values::<f64>("clearance_big_end_m").unwrap()[row],
                    Some(case.labels.clearances_m[1])
                );
                assert_eq!(
                    features.values::<String>("case_id").unwrap()[row],
                    texts("case_id")[row]
                );
                let damping = "joints.big_end.contact.damping_n_s_m";
                let found = features.values::<f64>(damping).unwrap()[row].unwrap();
                assert!((5e3..8e4).contains(&found), "{found}");

                let whole = record(&case).unwrap();
                let samples = signals
                    .values::<Vec<f32>>("crosshead_acceleration_m_s2")
                    .unwrap();
                let samples = samples[row].as_ref().unwrap();
                let length = 2.0 * std::f64::consts::TAU / case.resolved.speed * 1000.0;
                assert_eq!(samples.len(), length as usize);
                let start = (window as f64 * length).round() as usize;
                assert_eq!(
                    samples[..],
                    whole.channels[0].samples[start..start + samples.len()]
                );
                seen += 1;
            }
        }
    }
    assert_eq!(seen, 2 * CASES);
}
