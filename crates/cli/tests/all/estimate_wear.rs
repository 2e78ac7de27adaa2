//! `crosshead estimate-wear` on a bundle that is simulated here, with its sensors' noise.

use crate::one_run;

use ::calibrate::wear::{Interval, Results, Verdict};
use one_run::{bundle, crosshead, machine, said};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// The machine of the bundle with a big end of 0.03 mm and no other joint that may be worn.
fn healthy(folder: &Path) -> PathBuf {
    let file = input::machine_file::read(&machine()).unwrap();
    let mut tree = file.to_tree().clone();
    for joint in ["main", "small_end", "guide"] {
        tree["joints"][joint] = "ideal".into();
    }
    tree["joints"]["big_end"]["clearance"] = "0.03 mm".into();
    written(folder, &tree)
}

fn written(folder: &Path, tree: &serde_json::Value) -> PathBuf {
    let path = folder.join("healthy.yaml");
    let file = input::MachineFile::from_tree(tree).unwrap();
    fs::write(&path, file.to_yaml().unwrap()).unwrap();
    path
}

fn estimate(bundle: &Path, machine: &Path, more: &[&str]) -> Output {
    let out = bundle.join("wear");
    let mut all = vec!["estimate-wear", bundle.to_str().unwrap()];
    all.extend(["--machine", machine.to_str().unwrap()]);
    all.extend(["--out", out.to_str().unwrap()]);
    all.extend(more);
    crosshead(&all)
}

#[test]
fn a_worn_big_end_is_found_with_its_clearance() {
    let folder = tempfile::tempdir().unwrap();
    bundle(folder.path());
    let machine = healthy(folder.path());
    let done = estimate(folder.path(), &machine, &[]);
    assert!(done.status.success(), "{done:?}");
    let out = folder.path().join("wear");
    let results = Results::read(&out.join("wear.json")).unwrap();
    assert_eq!(results.worn(), ["joints.big_end"]);
    let joint = results.joints.get("joints.big_end").unwrap();
    assert_eq!(joint.healthy_m, Some(3e-5));
    assert_eq!(
        (joint.verdict, results.interval),
        (Verdict::Worn, Interval::Noise)
    );
    let (low, high) = (joint.low_m.unwrap(), joint.high_m.unwrap());
    // The file's contact holds at any clearance, the relation of Eq. (5) moves the stiffness a little.
    assert!(
        (joint.clearance_m.unwrap() / 1e-4 - 1.0).abs() < 2e-3,
        "{joint:?}"
    );
    assert!(low < high && high - low < 1e-6, "{joint:?}");
    let found = input::machine_file::read(&out.join("machine.yaml")).unwrap();
    let text = found.to_tree()["joints"]["big_end"]["clearance"]
        .as_str()
        .unwrap();
    let clearance = input::unit::parse(text).unwrap().si;
    assert!((clearance - joint.clearance_m.unwrap()).abs() < 1e-12);
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.contains("Worn: big end.") && page.contains("Diametral"));
    let said_of = String::from_utf8(done.stdout).unwrap();
    assert!(
        said_of.contains("joints.big_end: worn, radial clearance 0."),
        "{said_of}"
    );

    let again = estimate(folder.path(), &machine, &[]);
    assert_eq!(again.status.code(), Some(2));
    assert!(said(&again).contains("--overwrite"), "{again:?}");
    let other = estimate(folder.path(), &machine, &["--resume", "--worn-from", "3"]);
    assert_eq!(other.status.code(), Some(2));
    assert!(said(&other).contains("other settings"), "{other:?}");

    one_that_was_stopped_goes_on_to_the_same_results(folder.path(), &machine);
}

fn one_that_was_stopped_goes_on_to_the_same_results(folder: &Path, machine: &Path) {
    let stopped = folder.join("stopped");
    let command = |more: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_crosshead"));
        command.arg("estimate-wear").arg(folder);
        command.arg("--machine").arg(machine);
        command.arg("--out").arg(&stopped).args(more);
        command
    };
    let silent = || Stdio::null();
    let mut child = command(&[])
        .stdout(silent())
        .stderr(silent())
        .spawn()
        .unwrap();
    let evaluated = || fs::metadata(stopped.join("checkpoint.bin")).map_or(0, |m| m.len());
    while evaluated() < 50_000 && child.try_wait().unwrap().is_none() {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let kill = Command::new("kill").arg(child.id().to_string()).status();
    assert!(kill.unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    let so_far = Results::read(&stopped.join("wear.json")).unwrap();
    assert!(!so_far.complete);

    let resumed = command(&["--resume"]).output().unwrap();
    assert!(resumed.status.success(), "{resumed:?}");
    assert!(!stopped.join("checkpoint.bin").exists());
    for file in ["wear.json", "machine.yaml", "report.html"] {
        let of = |folder: &Path| fs::read(folder.join(file)).unwrap();
        assert!(of(&stopped) == of(&folder.join("wear")), "{file}");
    }
    let again = command(&["--resume"]).output().unwrap();
    let words = String::from_utf8(again.stdout).unwrap();
    assert!(words.starts_with("nothing has changed"), "{words}");
}

#[test]
fn what_cannot_be_estimated_says_why() {
    let folder = tempfile::tempdir().unwrap();
    bundle(folder.path());
    let machine = healthy(folder.path());
    let refused = |machine: &Path, more: &[&str], word: &str| {
        let output = estimate(folder.path(), machine, more);
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        assert!(said(&output).contains(word), "{output:?}");
        assert!(!folder.path().join("wear").exists());
    };
    refused(&machine, &["--worn-from", "1"], "above 1");
    refused(&machine, &["--leave-out", "run1"], "run01");
    refused(&folder.path().join("none.yaml"), &[], "none.yaml");

    let mut tree = input::machine_file::read(&machine)
        .unwrap()
        .to_tree()
        .clone();
    let big_end = tree["joints"]["big_end"].take();
    tree["joints"]["big_end"] = "ideal".into();
    refused(
        &written(folder.path(), &tree),
        &[],
        "no joint that may be worn",
    );
    // Another stroke than that of the recordings.
    tree["joints"]["big_end"] = big_end;
    tree["crank"]["radius"] = "60 mm".into();
    refused(&written(folder.path(), &tree), &[], "first order");

    let list = folder.path().join("recordings.yaml");
    let text = fs::read_to_string(&list).unwrap();
    let lines = text
        .lines()
        .filter(|line| !line.contains("name: acceleration"));
    fs::write(&list, lines.collect::<Vec<_>>().join("\n")).unwrap();
    let machine = healthy(folder.path());
    refused(&machine, &[], "no channel shows clearances");
}

#[test]
fn runs_of_two_states_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    bundle(folder.path());
    let list = folder.path().join("recordings.yaml");
    let text = fs::read_to_string(&list).unwrap();
    let (_, run) = text.split_once("runs:\n").unwrap();
    let other = run.replace("run01", "run02").replace("0.0001", "0.0002");
    fs::write(&list, format!("{text}{other}")).unwrap();
    let output = estimate(folder.path(), &healthy(folder.path()), &[]);
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    assert!(said(&output).contains("--leave-out run02"), "{output:?}");
}
