//! Requests that are not answered as their senders want.

use crate::client::Served;
use crate::results::{dataset, plan};
use serve::{Error, Server};
use std::fs;
use std::net::{Ipv4Addr, SocketAddr};

#[test]
fn paths_stay_in_the_folder() {
    let (folder, _) = dataset();
    let inside = folder.path().join("inside");
    fs::create_dir(&inside).unwrap();
    // What lies beside the folder that is served.
    let served = Served::start(&inside);
    for path in [
        "/../set/report.html",
        "/%2e%2e/set/report.html",
        "/..%2fset/report.html",
        "/%2e%2e%2fset/report.html",
        "/x/../../set/report.html",
        "/..\\set/report.html",
        "//set/report.html",
        "/..;/set/report.html",
        "/set/report.html",
        "/%00/report.html",
        "/etc/passwd",
        "//etc/passwd",
        "/%ff",
    ] {
        assert_eq!(served.get(path).status, 404, "{path}");
    }
    let long = format!("/{}", "a/".repeat(2000));
    assert_eq!(served.get(&long).status, 404);
}

#[cfg(unix)]
#[test]
fn links_lead_nowhere_outside() {
    use std::os::unix::fs::symlink;
    let (folder, set) = dataset();
    let inside = folder.path().join("inside");
    fs::create_dir_all(inside.join("fake")).unwrap();
    symlink(&set, inside.join("link")).unwrap();
    fs::write(folder.path().join("secret"), "secret: 1").unwrap();
    symlink(folder.path().join("secret"), inside.join("fake/wear.json")).unwrap();
    let served = Served::start(&inside);
    assert_eq!(served.get("/link/report.html").status, 404);
    assert_eq!(served.get("/link").status, 404);
    let fake = served.get("/fake/report.html");
    assert_eq!(fake.status, 500);
    assert!(
        fake.body.contains("leads out of the folder") && !fake.body.contains("secret: 1"),
        "{fake:?}"
    );
    let index = served.json("/index.json");
    assert_eq!(index["entries"].as_array().unwrap().len(), 1, "{index}");
    assert!(
        index["entries"][0]["mistake"]
            .as_str()
            .unwrap()
            .contains("leads out of the folder")
    );
    // A link within the folder is a way as good as another.
    symlink(&set, folder.path().join("way")).unwrap();
    assert!(
        Served::start(folder.path())
            .body("/way/features.html")
            .contains("small")
    );
}

#[test]
fn files_that_are_no_pages_are_not_sent() {
    let (folder, set) = dataset();
    fs::write(set.join("report.html"), "written by somebody").unwrap();
    fs::write(set.join("notes.html"), "private").unwrap();
    let served = Served::start(folder.path());
    for path in [
        "/set/manifest.json",
        "/set/sweep.yaml",
        "/set/notes.html",
        "/set/signals/",
        "/set/_sweep/plan.json",
        "/set/figures/",
        "/favicon.ico",
        "/set/report.htm",
    ] {
        assert_eq!(served.get(path).status, 404, "{path}");
    }
    assert!(
        !served
            .body("/set/report.html")
            .contains("written by somebody")
    );
}

#[test]
fn other_names_of_the_server_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let served = Served::start(folder.path());
    let port = served.address.port();
    let ask = |headers: &str| {
        served
            .raw(&format!("GET / HTTP/1.1\r\n{headers}\r\n"))
            .status
    };
    assert_eq!(ask(&format!("Host: 127.0.0.1:{port}\r\n")), 200);
    assert_eq!(ask(&format!("Host: LOCALHOST:{port}\r\n")), 200);
    for host in [
        "evil.example".to_owned(),
        format!("evil.example:{port}"),
        format!("localhost.evil.example:{port}"),
        "127.0.0.1".to_owned(),
        format!("127.0.0.1:{}", port ^ 1),
        String::new(),
    ] {
        assert_eq!(ask(&format!("Host: {host}\r\n")), 403, "{host}");
    }
    assert_eq!(ask(""), 403);
    assert_eq!(
        ask(&format!("Host: localhost:{port}\r\nHost: evil.example\r\n")),
        403
    );
    let whole = format!("GET http://evil.example/ HTTP/1.1\r\nHost: localhost:{port}\r\n\r\n");
    assert_eq!(served.raw(&whole).status, 403);
}

#[test]
fn only_reading_is_allowed() {
    let folder = tempfile::tempdir().unwrap();
    plan(folder.path());
    let served = Served::start(folder.path());
    for method in ["POST", "PUT", "DELETE", "OPTIONS", "PATCH", "TRACE"] {
        let answer = served.ask(method, "/");
        assert_eq!(
            (answer.status, answer.header("allow")),
            (405, Some("GET, HEAD")),
            "{method}"
        );
    }
    let (get, head) = (served.get("/index.json"), served.ask("HEAD", "/index.json"));
    assert_eq!((head.status, head.body.as_str()), (200, ""));
    let length = get.body.len().to_string();
    for answer in [get, head] {
        assert_eq!(answer.header("content-length"), Some(length.as_str()));
    }
}

#[test]
fn requests_have_a_bound() {
    let folder = tempfile::tempdir().unwrap();
    let served = Served::start(folder.path());
    let host = served.address;
    let many: String = (0..100).map(|i| format!("X-{i}: 1\r\n")).collect();
    let long = "a".repeat(40_000);
    for (what, request) in [
        (
            "path",
            format!("GET /{long} HTTP/1.1\r\nHost: {host}\r\n\r\n"),
        ),
        (
            "header",
            format!("GET / HTTP/1.1\r\nHost: {host}\r\nX: {long}\r\n\r\n"),
        ),
        (
            "headers",
            format!("GET / HTTP/1.1\r\nHost: {host}\r\n{many}\r\n"),
        ),
    ] {
        let status = served.raw(&request).status;
        assert!([414, 431].contains(&status), "{what}: {status}");
    }
    assert_eq!(served.raw("nonsense\r\n\r\n").status, 400);
    served.body("/");
}

#[test]
fn an_address_is_free_and_of_this_machine() {
    let folder = tempfile::tempdir().unwrap();
    let served = Served::start(folder.path());
    let taken = Server::bind(folder.path(), served.address).unwrap_err();
    assert!(
        matches!(taken, Error::InUse(address) if address == served.address) && !taken.is_input()
    );
    assert!(
        taken.to_string().contains("is in use by another program"),
        "{taken}"
    );

    let everywhere = SocketAddr::from((Ipv4Addr::UNSPECIFIED, 0));
    let refused = Server::bind(folder.path(), everywhere).unwrap_err();
    assert!(matches!(refused, Error::NotLoopback(_)) && refused.is_input());

    let here = SocketAddr::from((Ipv4Addr::LOCALHOST, 0));
    fs::write(folder.path().join("file"), "").unwrap();
    for no_folder in ["file", "missing"] {
        let refused = Server::bind(&folder.path().join(no_folder), here).unwrap_err();
        assert!(
            matches!(refused, Error::NoFolder { .. }) && refused.is_input(),
            "{refused}"
        );
    }
}
