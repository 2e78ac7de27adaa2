//! Folders that grow while they are served.

use crate::client::Served;
use crate::results::{FAILING, begin, finish, make, plan};
use serde_json::json;
use std::fs;
use std::time::Duration;

#[test]
fn what_appears_is_in_the_index() {
    let folder = tempfile::tempdir().unwrap();
    let served = Served::start(folder.path());
    assert_eq!(served.json("/index.json")["entries"], json!([]));
    assert!(served.body("/").contains("There is nothing here yet"));

    let calibrated = folder.path().join("machines/no 7");
    fs::create_dir_all(&calibrated).unwrap();
    fs::write(calibrated.join("calibration.json"), "{}").unwrap();
    // Hidden folders, those of data, and those that are too deep are passed by.
    for other in [".hidden", "signals", "a/b/c/d/e"] {
        let other = folder.path().join(other);
        fs::create_dir_all(&other).unwrap();
        fs::write(other.join("wear.json"), "{}").unwrap();
    }
    let index = served.json("/index.json");
    let entries = index["entries"].as_array().unwrap();
    assert_eq!(entries.len(), 1, "{index}");
    assert_eq!(entries[0]["path"], "machines/no 7");
    assert_eq!(entries[0]["kind"], "calibration");
    assert_eq!(entries[0]["href"], "/machines/no%207/report.html");
    assert_eq!(entries[0]["cases"], json!(null));
    let written = entries[0]["modified"].as_str().unwrap();
    assert!(
        written.starts_with("20") && written.ends_with('Z'),
        "{written}"
    );
    assert_eq!(index["shown"]["rows"][0]["texts"]["kind"], "Calibration");
    assert!(
        served
            .body("/")
            .contains("<a href=\"/machines/no%207/report.html\"")
    );
    // It is no whole calibration: its page says so, and the server goes on.
    let broken = served.get("/machines/no%207/report.html");
    assert_eq!(broken.status, 500);
    assert!(broken.body.contains("calibration.json"), "{broken:?}");
    served.body("/");
}

#[test]
fn a_sweep_under_way_becomes_a_dataset() {
    let folder = tempfile::tempdir().unwrap();
    let (plan, set) = (plan(folder.path()), folder.path().join("set"));
    let served = Served::start(folder.path());
    begin(&plan, &set);
    make(&set, 0..2, &|| {});
    // Shards of two cases that were finished four seconds apart.
    let record = |shard: u64| {
        let path = set.join(format!("_sweep/commits/{shard}.json"));
        fs::File::options().write(true).open(path).unwrap()
    };
    let second = record(1).metadata().unwrap().modified().unwrap();
    record(0)
        .set_modified(second - Duration::from_secs(4))
        .unwrap();

    let entry = &served.json("/index.json")["entries"][0];
    assert_eq!(entry["kind"], "under_way");
    assert_eq!(entry["href"], "/set/progress.html");
    let cases = ["cases", "cases_done", "cases_failed"].map(|key| entry[key].as_u64());
    assert_eq!(cases, [Some(8), Some(4), Some(1)]);

    let progress = served.json("/set/progress.json");
    for (key, expected) in [
        ("name", json!("small")),
        ("cases", json!(8)),
        ("cases_done", json!(4)),
        ("cases_failed", json!(1)),
        ("shards", json!(4)),
        ("shards_done", json!(2)),
        ("at_work", json!(0)),
        ("seconds_left", json!(null)),
        ("is_complete", json!(false)),
    ] {
        assert_eq!(progress[key], expected, "{key}: {progress}");
    }
    assert_eq!(progress["cases_per_second"], 0.5);
    assert_eq!(progress["failed"][0]["case_id"], FAILING);
    assert_eq!(
        progress["failed"][0]["reason"],
        "it fails at 0.5 s on <purpose>"
    );
    let again = format!(
        "crosshead simulate {}/sweep.yaml --case {FAILING}",
        set.display()
    );
    assert_eq!(progress["failed"][0]["again"], again);
    assert_eq!(progress["shown"]["texts"]["cases"], "4 of 8");
    assert_eq!(
        progress["shown"]["texts"]["state"],
        "No process is at work."
    );
    let next = progress["next"].as_str().unwrap();
    assert!(next.ends_with("--resume"), "{next}");

    let page = served.body("/set/progress.html");
    for part in [
        "4 of 8",
        "it fails at 0.5 s on &#60;purpose&#62;",
        &again,
        "<progress max=\"8\" value=\"4\"",
    ] {
        assert!(page.contains(part), "{part}");
    }
    // The page of the dataset is not there yet; a case is.
    assert_eq!(
        served.get("/set/report.html").header("location"),
        Some("/set/progress.html")
    );
    assert!(
        served
            .body("/set/cases/case-000007.html")
            .contains("<figure>")
    );
    assert_eq!(
        served.get(&format!("/set/cases/{FAILING}.html")).status,
        500
    );

    // While a shard is made, a process is at work.
    make(&set, 2..4, &|| {
        let progress = served.json("/set/progress.json");
        assert_eq!(progress["at_work"], 1, "{progress}");
        assert_eq!(progress["shown"]["texts"]["state"], "Under way.");
        assert_eq!(progress["next"], "");
        let rate = progress["cases_per_second"].as_f64().unwrap();
        let left = 8.0 - progress["cases_done"].as_f64().unwrap();
        assert_eq!(progress["seconds_left"].as_f64().unwrap(), left / rate);
    });
    let all = served.json("/set/progress.json");
    assert_eq!(
        all["next"],
        format!("crosshead sweep finalize {}", set.display())
    );
    finish(&set);
    let entry = &served.json("/index.json")["entries"][0];
    assert_eq!(
        (&entry["kind"], &entry["href"]),
        (&json!("dataset"), &json!("/set/report.html"))
    );
    let progress = served.json("/set/progress.json");
    assert_eq!(progress["is_complete"], true);
    assert_eq!(progress["cases_done"], 8);
    assert!(
        served
            .body("/set/progress.html")
            .contains("The dataset is complete: its page")
    );
    assert!(served.body("/set/report.html").contains("small"));
}
