//! The pages of a finished dataset, and its cases.

use crate::client::Served;
use crate::results::{FAILING, dataset, files};
use report::folder_kind::FolderKind;

#[test]
fn a_dataset_has_its_pages_and_figures() {
    let (folder, set) = dataset();
    let before = files(folder.path());
    let served = Served::start(folder.path());
    for page in ["report.html", "chaos.html", "features.html"] {
        let made = FolderKind::Dataset.render(&set, page).unwrap().unwrap();
        let path = format!("/set/{page}");
        let answer = served.get(&path);
        assert_eq!(
            (answer.status, answer.body == made.html),
            (200, true),
            "{path}"
        );
        // What is kept is the same.
        assert_eq!(served.body(&path), made.html, "{path}");
        for figure in &made.figures {
            let answer = served.get(&format!("/set/figures/{}", figure.name));
            assert_eq!(answer.header("content-type"), Some("image/svg+xml"));
            assert_eq!(answer.body, figure.svg, "{}", figure.name);
        }
        assert_eq!(made.figures.is_empty(), page == "features.html");
    }
    assert_eq!(served.get("/set/figures/dataset-99.svg").status, 404);
    assert_eq!(served.get("/set/figures/other.svg").status, 404);
    served.body("/");
    served.body("/set/progress.json");
    served.body("/set/cases/case-000000.html");
    assert_eq!(files(folder.path()), before);
}

/// The policy of a page lets its own scripts and styles run, so there must be none that it does not let run.
#[test]
fn a_page_has_nothing_that_its_policy_stops() {
    let (folder, _) = dataset();
    let served = Served::start(folder.path());
    for path in [
        "/",
        "/set/report.html",
        "/set/chaos.html",
        "/set/features.html",
        "/set/progress.html",
    ] {
        let answer = served.get(path);
        let policy = answer.header("content-security-policy").unwrap();
        let scripts = answer.body.matches("<script>").count();
        let styles = answer.body.matches("<style>").count();
        assert!(scripts > 0 && styles > 0, "{path}");
        assert_eq!(
            policy.matches("'sha256-").count(),
            scripts + styles,
            "{path}: {policy}"
        );
        assert!(!policy.contains("unsafe"), "{policy}");
        for stopped in [
            " style=\"",
            " onclick=",
            " onload=",
            "<script src",
            "<link ",
        ] {
            assert!(!answer.body.contains(stopped), "{path} has {stopped}");
        }
        assert_eq!(answer.header("x-content-type-options"), Some("nosniff"));
    }
}

#[test]
fn a_folder_leads_to_its_page() {
    let (folder, set) = dataset();
    for path in ["/set", "/set/"] {
        let answer = Served::start(folder.path()).get(path);
        assert_eq!(answer.status, 307);
        assert_eq!(answer.header("location"), Some("/set/report.html"));
    }
    // A dataset may be what is served.
    let served = Served::start(&set);
    assert!(served.body("/").contains("href=\"/report.html\""));
    assert_eq!(
        served.body("/report.html"),
        Served::start(folder.path()).body("/set/report.html")
    );
}

#[test]
fn a_case_is_simulated_again() {
    let (folder, set) = dataset();
    let served = Served::start(folder.path());
    let case = served.body("/set/cases/case-000007.html");
    let headings = case
        .split("<h3>")
        .skip(1)
        .filter_map(|rest| rest.split("</h3>").next());
    let expected = [
        "Pressure and acceleration",
        "Spectra of the acceleration",
        "p-V cards",
        "Rod load",
        "Motion in the joints",
    ];
    assert_eq!(headings.collect::<Vec<_>>(), expected);
    assert_eq!(case.matches("<figure>").count(), expected.len());
    // The script of the page finds its axes, and the orbits their clearance circles.
    assert!(case.matches("class=\"plot\"").count() > expected.len());
    assert_eq!(case.matches("<ellipse").count(), 2);
    let again = format!(
        "crosshead simulate {}/sweep.yaml --case case-000007",
        set.display()
    );
    for part in [
        "<td>fault</td><td>big end + small end</td>",
        "<td>clearance of small end</td><td>0.3\u{a0}mm</td>",
        "<td>speed</td><td>500\u{a0}rpm</td>",
        &again,
    ] {
        assert!(case.contains(part), "{part}");
    }
    assert!(!case.contains("<script"));
    assert_eq!(served.body("/set/cases/case-000007.html"), case);
    assert_ne!(served.body("/set/cases/case-000000.html"), case);
}

#[test]
fn a_case_that_is_none_or_has_failed_says_so() {
    let (folder, _) = dataset();
    let served = Served::start(folder.path());
    for other in ["case-000008", "case-1", "x"] {
        let answer = served.get(&format!("/set/cases/{other}.html"));
        assert_eq!(answer.status, 404);
        assert!(
            answer
                .body
                .contains("expected a case from case-000000 to case-000007"),
            "{answer:?}"
        );
    }
    let failed = served.get(&format!("/set/cases/{FAILING}.html"));
    assert_eq!(failed.status, 500);
    assert!(
        failed
            .body
            .contains("case-000001 failed: it fails at 0.5 s on <purpose>"),
        "{failed:?}"
    );
    assert_eq!(
        failed.header("content-type"),
        Some("text/plain; charset=utf-8")
    );
}
