//! Clients and files that are not as they should be.

use crate::client::{Served, read};
use crate::results::dataset;
use std::fs;
use std::io::Write;
use std::net::TcpStream;

#[test]
fn a_slow_client_does_not_hold_up_others() {
    let folder = tempfile::tempdir().unwrap();
    let served = Served::start(folder.path());
    let mut slow: Vec<TcpStream> = (0..20).map(|_| served.connect()).collect();
    for stream in &mut slow {
        stream.write_all(b"GET / HTTP/1.1\r\nHost: ").unwrap();
    }
    // Some ask and go away.
    for _ in 0..20 {
        let mut gone = served.connect();
        write!(gone, "GET / HTTP/1.1\r\nHost: {}\r\n\r\n", served.address).unwrap();
    }
    served.body("/");
    // The slow ones come to their answer, too.
    for mut stream in slow {
        write!(stream, "{}\r\n\r\n", served.address).unwrap();
        assert_eq!(read(stream).status, 200);
    }
}

#[test]
fn pages_asked_for_at_once_are_the_same() {
    let (folder, _) = dataset();
    let served = Served::start(folder.path());
    let pages: Vec<String> = std::thread::scope(|scope| {
        let asking: Vec<_> = (0..6)
            .map(|_| scope.spawn(|| served.body("/set/report.html")))
            .collect();
        asking.into_iter().map(|one| one.join().unwrap()).collect()
    });
    assert!(pages.iter().all(|page| *page == pages[0]));
}

#[test]
fn damage_is_said_and_mended() {
    let (folder, set) = dataset();
    let served = Served::start(folder.path());
    let whole = served.body("/set/report.html");
    let manifest = fs::read(set.join("manifest.json")).unwrap();
    fs::write(set.join("manifest.json"), "{").unwrap();
    let damaged = served.get("/set/report.html");
    assert_eq!(damaged.status, 500);
    assert!(damaged.body.contains("manifest.json"), "{damaged:?}");
    let index = served.json("/index.json");
    assert!(
        index["entries"][0]["mistake"]
            .as_str()
            .unwrap()
            .contains("manifest.json"),
        "{index}"
    );
    fs::write(set.join("manifest.json"), manifest).unwrap();
    assert_eq!(served.body("/set/report.html"), whole);
    assert_eq!(
        served.json("/index.json")["entries"][0]["mistake"],
        serde_json::json!(null)
    );
}
