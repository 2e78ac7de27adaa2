//! The programs at datasets that a disk or somebody changed.

use crate::small_sweep;

use small_sweep::{SWEEP, TINY, begin, bytes, crosshead, gen_dataset, run, text};
use std::path::Path;
use std::process::{Command, Output};

fn flip(path: &Path, at: usize) {
    let mut content = std::fs::read(path).unwrap();
    content[at] ^= 4;
    std::fs::write(path, content).unwrap();
}

fn verify(dataset: &Path) -> Output {
    crosshead(&["verify"]).arg(dataset).output().unwrap()
}

#[test]
fn a_published_copy_is_verified_without_being_touched() {
    let (folder, sweep) = begin(SWEEP);
    let out = folder.path().join("out");
    gen_dataset(&sweep, &out);
    std::fs::remove_dir_all(out.join("_sweep")).unwrap();
    let copied = bytes(&out);
    let whole = verify(&out);
    assert_eq!(whole.status.code(), Some(0), "{whole:?}");
    assert!(
        text(&whole.stdout).contains("all as they were written"),
        "{whole:?}"
    );
    // The names of files are those of the folder, for everybody's own tool.
    let sums = Command::new("sha256sum")
        .args(["--check", "--strict", "--quiet", "SHA256SUMS"])
        .current_dir(&out)
        .status();
    assert!(sums.unwrap().success());
    assert!(bytes(&out) == copied && !out.join("_sweep").exists());

    // Another sweep is not mixed into it.
    let other = folder.path().join("other.yaml");
    let text_of_other = std::fs::read_to_string(&sweep).unwrap();
    std::fs::write(&other, text_of_other.replace("seed: 7", "seed: 8")).unwrap();
    for command in [&["gen-dataset", "--resume"][..], &["sweep", "plan"]] {
        let refused = crosshead(command)
            .arg(&other)
            .arg("--out")
            .arg(&out)
            .output();
        let refused = refused.unwrap();
        assert_eq!(refused.status.code(), Some(2), "{refused:?}");
        assert!(
            text(&refused.stderr).contains("another sweep"),
            "{refused:?}"
        );
        assert!(bytes(&out) == copied && !out.join("_sweep").exists());
    }

    std::fs::remove_file(out.join("features/train-00001-of-00003.parquet")).unwrap();
    flip(&out.join("bifurcations/speed.parquet"), 200);
    std::fs::write(out.join("signals/extra.parquet"), "").unwrap();
    let damaged = verify(&out);
    assert_eq!(damaged.status.code(), Some(1));
    let lines: Vec<&str> = text(&damaged.stdout).lines().collect();
    let named = [
        "bifurcations/speed.parquet: has another checksum",
        "features/train-00001-of-00003.parquet: is missing",
        "signals/extra.parquet: is in no record",
    ];
    assert_eq!(lines.len(), named.len(), "{lines:?}");
    assert!(
        lines
            .iter()
            .zip(named)
            .all(|(line, start)| line.starts_with(start)),
        "{lines:?}"
    );

    let nothing = verify(folder.path());
    assert_eq!(nothing.status.code(), Some(2), "{nothing:?}");
}

#[test]
fn a_flipped_bit_is_seen_by_whoever_reads_the_file() {
    let (folder, sweep) = begin(TINY);
    let out = folder.path().join("out");
    gen_dataset(&sweep, &out);
    let whole = bytes(&out);
    for name in ["features", "signals"] {
        let path = out.join(name).join("train-00004-of-00030.parquet");
        let length = std::fs::metadata(&path).unwrap().len() as usize;
        flip(&path, length / 3);
        for verb in [&["verify"][..], &["report"], &["sweep", "export-delta"]] {
            let told = crosshead(verb).arg(&out).output().unwrap();
            // The report of so small a sweep shows other recordings.
            let reads = name == "features" || verb != ["report"];
            assert!(!told.status.success() || !reads, "{verb:?}: {told:?}");
            let said = format!("{}{}", text(&told.stdout), text(&told.stderr));
            assert!(
                said.contains("train-00004-of-00030") || !reads,
                "{verb:?}: {said}"
            );
        }
        let resumed = run(crosshead(&["gen-dataset", "--resume"])
            .arg(&sweep)
            .arg("--out")
            .arg(&out));
        assert!(
            text(&resumed.stderr).contains("shard 4 counts as not made"),
            "{resumed:?}"
        );
        for (path, content) in &whole {
            assert!(std::fs::read(out.join(path)).unwrap() == *content, "{path}");
        }
    }
}

#[test]
fn a_truncated_record_costs_its_own_shard() {
    let (folder, sweep) = begin(TINY);
    let out = folder.path().join("out");
    gen_dataset(&sweep, &out);
    let whole = bytes(&out);
    let record = out.join("_sweep/commits/7.json");
    let file = std::fs::File::options().write(true).open(&record).unwrap();
    file.set_len(25).unwrap();
    let status = run(crosshead(&["sweep", "status"]).arg(&out));
    assert!(text(&status.stdout).contains("missing: 7\n"), "{status:?}");
    assert!(
        text(&status.stderr).contains("commits/7.json"),
        "{status:?}"
    );
    let finalize = crosshead(&["sweep", "finalize"])
        .arg(&out)
        .output()
        .unwrap();
    assert_eq!(finalize.status.code(), Some(3), "{finalize:?}");
    run(crosshead(&["sweep", "shard", "--index", "7"]).arg(&out));
    run(crosshead(&["sweep", "finalize", "--verify"]).arg(&out));
    assert!(bytes(&out) == whole);
}
