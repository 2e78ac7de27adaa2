//! What strangers hand in: names, paths and files made to run, reveal, overwrite or hang something.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

const CROSSHEAD: &str = env!("CARGO_BIN_EXE_crosshead");

/// A sweep of one case.
const SWEEP: &str = "
name: one
machine: MACHINE
run: {revolutions: 1, transient: 1, sample_rate: 1 kHz, chaos: false}
cases: [{grid: {speed: [500 rpm]}}]
splits: {train: 100 %}
";

fn machine() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/machines/single-stage.yaml");
    path.display().to_string()
}

fn crosshead(arguments: &[&str], folder: &Path) -> Command {
    let mut command = Command::new(CROSSHEAD);
    command.args(arguments).current_dir(folder);
    command
}

/// What a command says that must end in its time.
fn ended(command: &mut Command) -> (Option<i32>, String) {
    let piped = command
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    let mut child = piped.spawn().unwrap();
    let begun = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if begun.elapsed() > Duration::from_secs(600) {
            child.kill().unwrap();
            panic!("{command:?} hangs");
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    let output = child.wait_with_output().unwrap();
    (output.status.code(), text(&output))
}

fn text(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr)
}

/// A pipe without a writer, and a device without an end, in the place of every kind of input.
#[test]
fn what_is_no_regular_file_is_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    fs::create_dir_all(root.join("dataset")).unwrap();
    let bundle = "runs:\n  - {id: a, file: a.csv, channels: [{column: p, unit: Pa}]}\n";
    for (name, recordings) in [("bundle", None), ("recorded", Some(bundle))] {
        fs::create_dir_all(root.join(name)).unwrap();
        if let Some(text) = recordings {
            fs::write(root.join(name).join("recordings.yaml"), text).unwrap();
        }
    }
    for name in [
        "a.yaml",
        "a.csv",
        "a.wav",
        "a.mat",
        "a.parquet",
        "a.mcap",
        "a",
        "bundle/recordings.yaml",
        "recorded/a.csv",
        "dataset/manifest.json",
    ] {
        let made = Command::new("mkfifo").arg(root.join(name)).status();
        assert!(made.unwrap().success());
    }
    let out = ["--out", "out.parquet"];
    for arguments in [
        vec!["simulate", "a.yaml"],
        vec!["gen-dataset", "a.yaml"],
        vec!["calibrate", "a.yaml", "--out", "out"],
        vec!["calibrate", "bundle", "--out", "out"],
        vec![
            "replay",
            "recorded",
            "--machine",
            &machine(),
            "--out",
            "out",
        ],
        vec!["report", "dataset"],
        [&["features", "a.csv"], &out[..]].concat(),
        [&["features", "a.wav"], &out[..]].concat(),
        [&["features", "a.mat"], &out[..]].concat(),
        [&["features", "a.parquet"], &out[..]].concat(),
        [&["features", "a.mcap"], &out[..]].concat(),
        [&["features", "a"], &out[..]].concat(),
        [&["features", "/dev/zero"], &out[..]].concat(),
        vec!["simulate", "/dev/zero"],
    ] {
        let (status, said) = ended(&mut crosshead(&arguments, root));
        assert_eq!(status, Some(2), "{arguments:?}: {said}");
        let other = ["calibrate", "report"].contains(&arguments[0]);
        assert!(
            said.contains("regular file") || other,
            "{arguments:?}: {said}"
        );
    }
}

/// A message names keys and what stands at them; the text of a file that is none of ours stays where it is.
#[test]
fn the_content_of_other_files_is_not_told() {
    let folder = tempfile::tempdir().unwrap();
    for content in [
        "root:$6$secret:19000:0\nbin:*:1:0\n",
        "- secret\n",
        "secret",
        "'secret",
        "&secret *secret",
        "a: *secret",
    ] {
        fs::write(folder.path().join("shadow"), content).unwrap();
        fs::write(
            folder.path().join("sweep.yaml"),
            SWEEP.replace("MACHINE", "shadow"),
        )
        .unwrap();
        for arguments in [["gen-dataset", "sweep.yaml"], ["simulate", "shadow"]] {
            let (status, said) = ended(&mut crosshead(&arguments, folder.path()));
            assert_eq!(status, Some(2), "{said}");
            assert!(said.starts_with("error: shadow:1:"), "{said}");
            assert!(!said.contains("secret"), "{said}");
        }
    }
}

/// A folder with a bundle of one recording outside of it.
fn bundle(file: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let inside = folder.path().join("bundle");
    fs::create_dir(&inside).unwrap();
    fs::write(folder.path().join("outside.csv"), "p [Pa]\nsecret\n").unwrap();
    fs::write(inside.join("inside.csv"), "p [Pa]\n1\n2\n").unwrap();
    std::os::unix::fs::symlink("../outside.csv", inside.join("link.csv")).unwrap();
    std::os::unix::fs::symlink("inside.csv", inside.join("near.csv")).unwrap();
    let file = file.replace("FOLDER", &folder.path().display().to_string());
    let text = format!(
        "runs:\n  - id: a\n    file: {file}\n    speed_rpm: 500\n    sample_rate_hz: 100\n    channels: [{{column: p, unit: Pa}}]\n"
    );
    fs::write(inside.join("recordings.yaml"), text).unwrap();
    folder
}

#[test]
fn a_bundle_reads_recordings_of_its_own_folder() {
    let machine = machine();
    let features = ["features", "bundle", "--out", "f.csv"];
    let replay = ["replay", "bundle", "--machine", &machine, "--out", "out"];
    for file in [
        "../outside.csv",
        "FOLDER/outside.csv",
        "link.csv",
        "./../bundle/../outside.csv",
    ] {
        let folder = bundle(file);
        for arguments in [&features[..], &replay[..]] {
            let (status, said) = ended(&mut crosshead(arguments, folder.path()));
            assert_eq!(status, Some(2), "{said}");
            assert!(
                said.contains("recordings.yaml:3:11: runs.0.file: found"),
                "{said}"
            );
            assert!(
                said.contains("a file in the folder of the bundle; --allow-outside"),
                "{said}"
            );
            assert!(!said.contains("secret"), "{said}");
            let (_, said) = ended(crosshead(arguments, folder.path()).arg("--allow-outside"));
            assert!(
                said.contains("`secret`, expected a number")
                    || said.contains("no column of numbers"),
                "{said}"
            );
        }
    }
    for file in ["inside.csv", "near.csv", "./inside.csv"] {
        let folder = bundle(file);
        let (_, said) = ended(&mut crosshead(&features, folder.path()));
        assert!(!said.contains("folder of the bundle"), "{file}: {said}");
    }
}

#[test]
fn a_password_is_not_told() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("sweep.yaml"),
        SWEEP.replace("MACHINE", &machine()),
    )
    .unwrap();
    let url = "s3://me:secret@bucket/faults";
    for arguments in [
        vec!["gen-dataset", "sweep.yaml", "--out", url],
        vec!["sweep", "plan", "sweep.yaml", "--out", url],
        vec!["sweep", "status", url],
        vec!["sweep", "shard", url, "--index", "0"],
        vec![
            "sweep",
            "submit",
            url,
            "--engine",
            "slurm",
            "--scripts",
            "jobs",
        ],
        vec!["sweep", "submit", url, "--engine", "slurm"],
        vec!["report", url],
        vec!["features", url, "--out", "f.parquet"],
    ] {
        let (status, said) = ended(&mut crosshead(&arguments, folder.path()));
        assert_eq!(status, Some(2), "{arguments:?}: {said}");
        assert!(!said.contains("secret"), "{arguments:?}: {said}");
    }
}

/// A clear screen in the name of a run.
#[test]
fn names_do_not_speak_to_the_terminal() {
    let folder = bundle("inside.csv");
    let path = folder.path().join("bundle/recordings.yaml");
    let recordings = fs::read_to_string(&path).unwrap();
    fs::write(&path, recordings.replace("id: a", r#"id: "\e[2J\u202eb""#)).unwrap();
    let machine = machine();
    let replay = ["replay", "bundle", "--machine", &machine, "--out", "out"];
    let (_, said) = ended(&mut crosshead(&replay, folder.path()));
    assert!(said.contains("\\u001b[2J\\u202eb"), "{said}");
    assert!(!said.contains(['\u{1b}', '\u{202e}']), "{said}");
}

/// Programs that write down what they were asked.
fn slurm(folder: &Path) -> PathBuf {
    use std::os::unix::fs::PermissionsExt;
    let programs = folder.join("programs");
    fs::create_dir(&programs).unwrap();
    for (name, answer) in [("sbatch", "echo 17"), ("squeue", ""), ("scancel", "")] {
        let path = programs.join(name);
        let record = folder.join(name).display().to_string();
        fs::write(
            &path,
            format!("#!/bin/sh\nprintf '[%s]' \"$@\" >> '{record}'\n{answer}\n"),
        )
        .unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
    }
    programs
}

/// A folder whose name would end the header, begin a command, and close a word.
#[test]
fn a_path_is_one_word_in_the_scripts_of_slurm() {
    let folder = tempfile::tempdir().unwrap();
    let programs = slurm(folder.path());
    let hostile = "a\" b\ntouch injected; $(touch injected) `touch injected` 'c' %j";
    fs::create_dir(folder.path().join(hostile)).unwrap();
    fs::write(
        folder.path().join("sweep.yaml"),
        SWEEP.replace("MACHINE", &machine()),
    )
    .unwrap();
    let out = folder.path().join(hostile).join("out");
    let path = std::env::join_paths([programs.as_path(), Path::new("/usr/bin"), Path::new("/bin")])
        .unwrap();
    let step = |arguments: &[&str]| {
        let mut command = crosshead(&["sweep"], folder.path());
        ended(command.args(arguments).env("PATH", &path))
    };
    let out_text = out.to_str().unwrap();
    let (status, said) = step(&["plan", "sweep.yaml", "--out", out_text]);
    assert_eq!(status, Some(0), "{said}");
    let (status, said) = step(&["submit", out_text, "--engine", "slurm"]);
    assert_eq!(status, Some(0), "{said}");
    let asked = fs::read_to_string(folder.path().join("sbatch")).unwrap();
    let logs = out
        .join("_sweep/slurm/")
        .display()
        .to_string()
        .replace('%', "%%");
    assert!(
        asked.contains(&format!("[--output={logs}/%A_%a.log]"))
            || asked.contains(&format!("[--output={logs}%A_%a.log]")),
        "{asked}"
    );

    for (name, argument) in [("shard.sh", "0"), ("finalize.sh", "")] {
        let script = out.join("_sweep/slurm").join(name);
        let content = fs::read_to_string(&script).unwrap();
        let header: Vec<&str> = content
            .lines()
            .take_while(|line| line.starts_with('#'))
            .collect();
        assert!(
            header.iter().all(|line| !line.contains("touch")),
            "{content}"
        );
        let mut shell = Command::new("sh");
        shell
            .arg(&script)
            .arg(argument)
            .env("SLURM_ARRAY_TASK_ID", "0")
            .env("PATH", &path);
        let (status, said) = ended(shell.current_dir(folder.path()));
        assert_eq!(status, Some(0), "{said}");
    }
    assert!(out.join("manifest.json").exists());
    assert!(!folder.path().join("injected").exists());

    // What anybody who may write there has put in the place of the numbers of jobs.
    let record = out.join("_sweep/slurm/submitted.json");
    let submitted = fs::read_to_string(&record).unwrap();
    for job in ["--user=root", "-u", "17 18", "1,2", "", "１７", "1_[2-3]"] {
        fs::write(
            &record,
            submitted.replacen("\"17\"", &format!("\"{job}\""), 1),
        )
        .unwrap();
        let (status, said) = step(&["cancel", out_text]);
        assert_eq!(status, Some(2), "{job}: {said}");
        assert!(said.contains("expected the number of a job"), "{said}");
    }
    assert!(!folder.path().join("scancel").exists());
    fs::write(&record, submitted.replacen("\"17\"", "\"16_3\"", 1)).unwrap();
    let (status, said) = step(&["cancel", out_text]);
    assert_eq!(status, Some(0), "{said}");
    assert_eq!(
        fs::read_to_string(folder.path().join("scancel")).unwrap(),
        "[--][17][16_3]"
    );
}

/// Standard error that is closed, full, or a pipe without a reader: the same exit status, of every verb of both programs.
#[test]
#[cfg(target_os = "linux")]
fn messages_that_nobody_can_read_change_no_exit_status() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("sweep.yaml"),
        SWEEP.replace("MACHINE", &machine()),
    )
    .unwrap();
    let gen_dataset = env!("CARGO_BIN_EXE_gen-dataset");
    let program = |verb: &str| format!("'{CROSSHEAD}' {verb}");
    for (command, expected) in [
        (format!("'{gen_dataset}' --help"), 0),
        (format!("'{gen_dataset}' sweep.yaml --out a --overwrite"), 0),
        (format!("'{gen_dataset}' none.yaml"), 2),
        (format!("'{gen_dataset}'"), 2),
        (program(""), 2),
        (program("--help"), 0),
        (program("schema machine"), 0),
        (program("gen-dataset none.yaml"), 2),
        (program("sweep status a"), 0),
        (program("sweep plan sweep.yaml --out a"), 0),
        (program("sweep finalize none"), 2),
        (
            program(&format!(
                "simulate '{}' --revolutions 1 --out s --overwrite",
                machine()
            )),
            0,
        ),
        (program("features none.csv --out f.csv"), 2),
        (program("report none"), 2),
        (program("calibrate none --out c"), 2),
        (program("explain-gap none --out e"), 2),
        (program("hidden-effects none.yaml --out h"), 2),
        (program("replay none --out r"), 2),
    ] {
        for closed in ["0<&- 2>&-", "2>/dev/full"] {
            let line = format!("{command} >/dev/null {closed}");
            let (status, said) = ended(
                Command::new("sh")
                    .args(["-c", &line])
                    .current_dir(folder.path()),
            );
            assert_eq!(status, Some(expected), "{line}: {said}");
        }
        // A pipe whose reader has gone.
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let mut shell = Command::new("sh");
        let shell = shell
            .args(["-c", &format!("exec {command}")])
            .stdout(Stdio::null());
        let status = shell.stderr(writer).current_dir(folder.path()).status();
        assert_eq!(status.unwrap().code(), Some(expected), "{command}");
    }
}

/// A file of 598 bytes with one list of 6e8 zeros (pyarrow, compressed by zstd), in 2 GB of memory.
#[test]
#[cfg(target_os = "linux")]
fn a_file_is_refused_before_it_exhausts_memory() {
    let folder = tempfile::tempdir().unwrap();
    let zeros = "../../tests/fuzz/corpus/parquet/broken-zeros.parquet";
    let zeros = Path::new(env!("CARGO_MANIFEST_DIR")).join(zeros);
    let line = format!(
        "ulimit -v 2000000; '{CROSSHEAD}' features '{}' --out f.parquet --sample-rate 1000",
        zeros.display()
    );
    let (status, said) = ended(
        Command::new("sh")
            .args(["-c", &line])
            .current_dir(folder.path()),
    );
    assert_eq!(status, Some(2), "{said}");
    assert!(
        said.contains("decodes to more than 536870912 bytes"),
        "{said}"
    );
}

/// Standard output whose reader has gone ends the program without a word.
#[test]
#[cfg(unix)]
fn a_summary_that_nobody_reads_ends_quietly() {
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let mut schema = Command::new(CROSSHEAD);
    let output = schema
        .args(["schema", "machine"])
        .stdout(writer)
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(141));
    assert!(output.stderr.is_empty(), "{}", text(&output));
}
