//! Datasets that a disk or somebody changed: all of it is found, and only what is damaged is made again.

use crate::toy;

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::SeqCst};
use std::time::{Duration, SystemTime};
use sweep::dataset::{Damage, Fault, Output, export_delta, finalize_verified, status, verify};
use sweep::{Case, Error, Existing, Plan, Progress, finalize, generate};
use toy::{CASES, SWEEP, assert_same, each, files, options, plan, record, run};

/// A small dataset, and the folder that it is in.
fn made(plan: &Plan) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().join("set");
    run(plan, &root, Existing::Refuse, 2).unwrap();
    (folder, root)
}

/// Keeps the warnings.
#[derive(Default)]
struct Warned(Vec<String>);

impl Progress for Warned {
    fn warning(&mut self, text: &str) {
        self.0.push(text.to_owned());
    }
}

/// Goes on with a dataset: the cases that were run, and the warnings.
fn resume(plan: &Plan, root: &Path) -> Result<(u64, Vec<String>), Error> {
    let (cancel, runs) = (AtomicBool::new(false), AtomicU64::new(0));
    let counted = each(|case: &Case| {
        runs.fetch_add(1, SeqCst);
        record(case)
    });
    let options = options(Existing::Resume, 2, &cancel);
    let mut warned = Warned::default();
    generate(plan, root, &options, &counted, &mut warned)?;
    Ok((runs.load(SeqCst), warned.0))
}

fn faults(root: &Path) -> Vec<Fault> {
    verify(root, &mut |_, _| {}).unwrap().faults
}

/// Every file that readers see.
fn published(root: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut files = files(root);
    files.retain(|path, _| !path.starts_with("_sweep"));
    files
}

fn flip(path: &Path, bit: u64) {
    let mut content = fs::read(path).unwrap();
    content[(bit / 8) as usize] ^= 1 << (bit % 8);
    fs::write(path, content).unwrap();
}

/// Flips single bits, drawn at random from all files, and tells how many were of data that
/// `export-delta` reads.
fn flips(count: u64) -> u64 {
    let plan = plan(SWEEP);
    let (_folder, root) = made(&plan);
    let whole = published(&root);
    assert!(faults(&root).is_empty());
    let bits: u64 = whole.values().map(|content| 8 * content.len() as u64).sum();
    let (mut random, mut read) = (1_u64, 0);
    for turn in 0..count {
        random = random
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        // Every file gets one before chance decides.
        let mut bit = (random >> 11) % bits;
        let chosen = whole.iter().enumerate().find_map(|(i, (path, content))| {
            let size = 8 * content.len() as u64;
            if i as u64 == turn {
                return Some((path, bit % size));
            }
            if turn >= whole.len() as u64 && bit < size {
                return Some((path, bit));
            }
            bit = bit.saturating_sub(size);
            None
        });
        let (path, at) = chosen.unwrap();
        flip(&root.join(path), at);
        match verify(&root, &mut |_, _| {}) {
            // A manifest that is none any more is told at once.
            Err(error) => assert!(path.ends_with("manifest.json"), "{path:?}: {error}"),
            Ok(found) => assert!(!found.faults.is_empty(), "{path:?}, bit {at}"),
        }
        if path
            .extension()
            .is_some_and(|extension| extension == "parquet")
        {
            read += 1;
            let (output, plan) = Output::join(&root).unwrap();
            let error = export_delta(&output, &plan).unwrap_err();
            assert!(matches!(error, Error::Faults { .. }), "{path:?}: {error}");
        }
        fs::write(root.join(path), &whole[path]).unwrap();
    }
    assert!(faults(&root).is_empty());
    read
}

#[test]
fn flipped_bits_are_found() {
    assert!(flips(30) > 20);
}

/// `cargo test -p crosshead-sweep --test all damage -- --ignored`.
#[test]
#[ignore = "takes minutes"]
fn a_thousand_flipped_bits_are_found() {
    assert!(flips(1000) > 500);
}

#[test]
fn a_shard_with_a_flipped_bit_is_made_again_and_no_other() {
    let plan = plan(SWEEP);
    let (_folder, root) = made(&plan);
    let whole = files(&root);
    for name in [
        "signals/train-00002-of-00005.parquet",
        "_sweep/commits/2.json",
    ] {
        flip(&root.join(name), 8 * 150 + 1);
        let (runs, warnings) = resume(&plan, &root).unwrap();
        assert_eq!(runs, plan.shard(2).count() as u64, "{name}: {warnings:?}");
        assert_eq!(warnings.len(), 1, "{warnings:?}");
        assert!(
            warnings[0].contains("shard 2 counts as not made"),
            "{warnings:?}"
        );
        assert!(files(&root) == whole, "{name}");
    }
}

#[test]
fn a_record_that_cannot_be_read_counts_as_not_made() {
    let plan = plan(SWEEP);
    let (_folder, root) = made(&plan);
    let whole = files(&root);
    let place = root.join("_sweep/commits/1.json");
    let record = fs::read(&place).unwrap();
    let other = String::from_utf8(record.clone()).unwrap();
    let other = other.replace("\"shard\": 1", "\"shard\": 3");
    let latin = [&record[..40], &[0xff], &record[41..]].concat();
    for damaged in [&record[..30], b"", other.as_bytes(), &latin] {
        fs::write(&place, damaged).unwrap();
        let (output, found) = Output::open_read_only(&root).unwrap();
        let status = status(&output, &found, false).unwrap();
        assert_eq!((status.missing, status.complete), (vec![1], false));
        let (runs, warnings) = resume(&plan, &root).unwrap();
        assert_eq!(runs, plan.shard(1).count() as u64);
        assert!(warnings[0].contains("commits/1.json"), "{warnings:?}");
        assert!(files(&root) == whole);
    }
    // The plan's own record follows from the sweep.
    fs::write(root.join("_sweep/plan.json"), "{\"plan_id\": \"01").unwrap();
    let told = Output::open_read_only(&root).unwrap_err().to_string();
    assert!(
        told.contains("--resume") && !told.contains("--overwrite"),
        "{told}"
    );
    assert_eq!(resume(&plan, &root).unwrap().0, 0);
    assert!(files(&root) == whole);
}

#[test]
fn a_published_copy_is_resumed_with_its_own_sweep_only() {
    let own = plan(SWEEP);
    let other = plan(&SWEEP.replace("seed: 3", "seed: 4"));
    let (_folder, root) = made(&own);
    let whole = files(&root);
    let copied = published(&root);
    fs::remove_dir_all(root.join("_sweep")).unwrap();
    for existing in [Existing::Resume, Existing::Refuse] {
        let error = run(&other, &root, existing, 2).unwrap_err();
        assert!(error.is_input(), "{error}");
        assert!(files(&root) == copied, "{existing:?} left something");
    }
    assert!(matches!(
        Output::open(&root, &other, Existing::Resume).unwrap_err(),
        Error::OtherPlan { .. }
    ));
    // Nothing is run again, and the records are those of the machine that made it.
    assert_eq!(resume(&own, &root).unwrap().0, 0);
    assert!(files(&root) == whole);
    // But for the shard of a file that did not come through.
    fs::remove_dir_all(root.join("_sweep")).unwrap();
    flip(&root.join("features/test-00000-of-00005.parquet"), 1000);
    let (runs, warnings) = resume(&own, &root).unwrap();
    assert_eq!(runs, own.shard(0).count() as u64, "{warnings:?}");
    assert!(files(&root) == whole);
}

#[test]
fn everything_is_named_at_once() {
    let plan = plan(SWEEP);
    let (_folder, root) = made(&plan);
    fs::remove_dir_all(root.join("_sweep")).unwrap();
    fs::write(root.join("signals/copy.parquet"), "PAR1").unwrap();
    fs::remove_file(root.join("features/train-00001-of-00005.parquet")).unwrap();
    flip(&root.join("README.md"), 77);
    let cut = File::options()
        .write(true)
        .open(root.join("sweep.yaml"))
        .unwrap();
    cut.set_len(100).unwrap();
    let found = faults(&root);
    let names: Vec<&str> = found.iter().map(|fault| fault.path.as_str()).collect();
    let expected = [
        "README.md",
        "features/train-00001-of-00005.parquet",
        "signals/copy.parquet",
        "sweep.yaml",
    ];
    assert_eq!(names, expected);
    let damage = [&found[0], &found[1], &found[2]].map(|fault| fault.damage);
    assert_eq!(damage, [Damage::Content, Damage::Missing, Damage::Extra]);
    assert!(matches!(found[3].damage, Damage::Length { found: 100, .. }));
    let none = verify(&root.join("signals"), &mut |_, _| {}).unwrap_err();
    assert!(matches!(none, Error::NoManifest(_)) && none.is_input());
}

#[test]
fn a_manifest_is_compared_with_tables_and_stays_inside() {
    let plan = plan(SWEEP);
    let (_folder, root) = made(&plan);
    let place = root.join("manifest.json");
    let text = fs::read_to_string(&place).unwrap();
    let mut manifest = recordings::Manifest::from_json(&text, &place).unwrap();
    let table = manifest
        .files
        .iter_mut()
        .find(|file| file.rows.is_some())
        .unwrap();
    let (path, rows) = (table.path.clone(), table.rows.unwrap());
    table.rows = Some(rows + 1);
    let mut outside = manifest.files[0].clone();
    outside.path = "../../etc/passwd".into();
    manifest.files.push(outside);
    fs::write(&place, manifest.to_json().unwrap()).unwrap();
    let found = faults(&root);
    let has = |path: &str, damage| {
        found.contains(&Fault {
            path: path.into(),
            damage,
        })
    };
    assert!(
        has(
            &path,
            Damage::Rows {
                found: rows,
                expected: rows + 1
            }
        ),
        "{found:?}"
    );
    assert!(has("../../etc/passwd", Damage::Outside), "{found:?}");
    assert!(has("SHA256SUMS", Damage::Sums), "{found:?}");
    assert!(has("manifest.json", Damage::Counts), "{found:?}");
}

#[test]
fn verifying_rewrites_nothing_that_stands_there() {
    let plan = plan(SWEEP);
    let (_folder, root) = made(&plan);
    for name in ["README.md", "manifest.json", "SHA256SUMS"] {
        let whole = fs::read(root.join(name)).unwrap();
        flip(&root.join(name), 99);
        let damaged = fs::read(root.join(name)).unwrap();
        let (output, plan) = Output::join(&root).unwrap();
        let error = finalize_verified(&output, &plan).unwrap_err();
        assert!(error.to_string().contains(name), "{error}");
        assert!(fs::read(root.join(name)).unwrap() == damaged, "{name}");
        // Who does not ask for it gets it anew.
        finalize(&output, &plan).unwrap();
        assert!(fs::read(root.join(name)).unwrap() == whole, "{name}");
        fs::remove_file(root.join(name)).unwrap();
        finalize_verified(&output, &plan).unwrap();
        assert!(fs::read(root.join(name)).unwrap() == whole, "{name}");
    }
}

#[test]
fn complete_is_what_has_the_manifest_of_its_records() {
    let plan = plan(SWEEP);
    let (_folder, root) = made(&plan);
    let (output, plan) = Output::open_read_only(&root).unwrap();
    let complete = || status(&output, &plan, false).unwrap().complete;
    assert!(complete());
    let manifest = fs::read_to_string(root.join("manifest.json")).unwrap();
    for other in ["", "{}", &manifest.replace("\"seed\": 3", "\"seed\": 4")] {
        fs::write(root.join("manifest.json"), other).unwrap();
        assert!(!complete());
    }
    fs::write(root.join("manifest.json"), manifest).unwrap();
    fs::write(root.join("features/train-00007-of-00009.parquet"), "").unwrap();
    assert!(complete());
    let warnings = output.take_warnings();
    assert!(warnings[0].contains("train-00007-of-00009"), "{warnings:?}");
    // With --verify a flipped bit is seen.
    flip(&root.join("features/train-00001-of-00005.parquet"), 555);
    assert!(complete());
    assert_eq!(status(&output, &plan, true).unwrap().missing, [1]);
}

#[test]
fn files_of_the_user_outlive_an_overwriting() {
    let first = plan(SWEEP);
    let (_folder, root) = made(&first);
    let other = plan(&SWEEP.replace("shard_size: 7", "shard_size: 11"));
    let fresh = tempfile::tempdir().unwrap();
    let fresh = fresh.path().join("fresh");
    run(&other, &fresh, Existing::Refuse, 2).unwrap();
    let (output, found) = Output::join(&root).unwrap();
    export_delta(&output, &found).unwrap();
    drop(output);
    let own = ["signals/measured.parquet", "features/notes/today.txt"];
    fs::create_dir(root.join("features/notes")).unwrap();
    own.iter()
        .for_each(|name| fs::write(root.join(name), "mine").unwrap());
    // Killed between a file and its record: of that sweep all the same.
    fs::write(root.join("signals/train-00009-of-00010.parquet"), "").unwrap();
    let (cancel, mut warned) = (AtomicBool::new(false), Warned::default());
    let overwrite = options(Existing::Overwrite, 2, &cancel);
    generate(&other, &root, &overwrite, &each(record), &mut warned).unwrap();
    for name in own {
        assert_eq!(fs::read_to_string(root.join(name)).unwrap(), "mine");
    }
    let named = |name: &str| warned.0.iter().any(|text| text.contains(name));
    assert!(
        named("measured.parquet") && named("features/notes"),
        "{:?}",
        warned.0
    );
    fs::remove_file(root.join(own[0])).unwrap();
    fs::remove_dir_all(root.join("features/notes")).unwrap();
    assert_same(&root, &fresh);
}

#[test]
fn what_a_crash_left_stays_while_others_are_at_work() {
    let plan = plan(SWEEP);
    let (_folder, root) = made(&plan);
    let left = root.join("_sweep/tmp/signals-x.host-1-2.part");
    let part = File::create(&left).unwrap();
    let old = SystemTime::now() - Duration::from_secs(2 * 24 * 60 * 60);
    part.set_modified(old).unwrap();
    let (output, plan) = Output::join(&root).unwrap();
    let (other, _) = Output::join(&root).unwrap();
    finalize(&output, &plan).unwrap();
    assert!(left.exists());
    drop(other);
    finalize(&output, &plan).unwrap();
    assert!(!left.exists());
    // It is still one of those that may work together.
    let error = Output::open(&root, &plan, Existing::Resume).unwrap_err();
    assert!(matches!(error, Error::InUse { .. }), "{error}");
    assert_eq!(plan.cases(), CASES);
}
