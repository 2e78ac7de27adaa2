//! `crosshead serve`: its address, its end, and what it refuses. What it answers is tested in its crate.
#![cfg(feature = "serve")]

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};

fn serve(folder: &Path, port: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_crosshead"));
    command.arg("serve").arg(folder).args(["--port", port]);
    command
}

/// The program, and the host and port of the address that it has printed.
fn begin(folder: &Path) -> (Child, String) {
    let mut command = serve(folder, "0");
    let mut program = command
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut line = String::new();
    let out = program.stdout.as_mut().unwrap();
    BufReader::new(out).read_line(&mut line).unwrap();
    let host = line
        .strip_prefix("http://")
        .and_then(|rest| rest.strip_suffix("/\n"));
    (
        program,
        host.unwrap_or_else(|| panic!("{line:?}")).to_owned(),
    )
}

fn refusal(command: &mut Command) -> (Option<i32>, String) {
    let Output { status, stderr, .. } = command.output().unwrap();
    (status.code(), String::from_utf8(stderr).unwrap())
}

#[test]
fn it_answers_until_a_signal_ends_it() {
    let folder = tempfile::tempdir().unwrap();
    for signal in ["-INT", "-TERM"] {
        let (program, host) = begin(folder.path());
        assert!(host.starts_with("127.0.0.1:"), "{host}");
        let mut stream = TcpStream::connect(&host).unwrap();
        write!(stream, "GET / HTTP/1.1\r\nHost: {host}\r\n\r\n").unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        assert!(answer.starts_with("HTTP/1.1 200 OK"), "{answer}");

        let sent = Command::new("kill")
            .args([signal, &program.id().to_string()])
            .status();
        assert!(sent.unwrap().success());
        let output = program.wait_with_output().unwrap();
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(130), "{signal}: {message}");
        let end = format!(
            "error: interrupted: {} is no longer served\n",
            folder.path().display()
        );
        assert!(message.ends_with(&end), "{message}");
        assert!(TcpStream::connect(&host).is_err());
    }
}

#[test]
fn no_folder_and_a_port_in_use_are_one_message() {
    let folder = tempfile::tempdir().unwrap();
    let (mut program, host) = begin(folder.path());
    let (_, port) = host.rsplit_once(':').unwrap();
    let (status, message) = refusal(&mut serve(folder.path(), port));
    program.kill().unwrap();
    program.wait().unwrap();
    assert_eq!(status, Some(1));
    let expected = format!(
        "error: {host} is in use by another program: choose another port, or 0 for any that is free\n"
    );
    assert_eq!(message, expected);

    let missing = folder.path().join("missing");
    let (status, message) = refusal(&mut serve(&missing, "0"));
    assert_eq!((status, message.lines().count()), (Some(2), 1), "{message}");
    assert!(
        message.contains("missing") && message.contains("expected a folder"),
        "{message}"
    );
}
