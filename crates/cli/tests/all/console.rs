//! What every verb has: help that fits, completions, manual pages, colours, silence, threads, the next step.

use crate::one_run::{crosshead, machine, said};
use clap::Command;
use cli::program::{WIDEST_HELP, commands};
use std::fs;
use std::process::Output;

/// Calls `look` with each command and its name, verbs and their verbs included.
fn each(command: &mut Command, name: &str, look: &mut dyn FnMut(&mut Command, &str)) {
    look(command, name);
    let verbs: Vec<String> = command
        .get_subcommands()
        .map(|verb| verb.get_name().to_owned())
        .collect();
    for verb in verbs {
        let below = command.find_subcommand_mut(&verb).unwrap();
        each(below, &format!("{name} {verb}"), look);
    }
}

#[test]
fn every_help_fits() {
    let mut wide = Vec::new();
    let mut seen = 0;
    for mut command in commands() {
        command.build();
        let name = command.get_name().to_owned();
        each(&mut command, &name, &mut |command, name| {
            seen += 1;
            // What stands after the options is written as it is, with examples to be copied: wrapping
            // would break them.
            let after = command.get_after_help().map(ToString::to_string);
            let long = command.clone().term_width(WIDEST_HELP).render_long_help();
            let short = command.clone().term_width(WIDEST_HELP).render_help();
            let texts = [
                after.unwrap_or_default(),
                long.to_string(),
                short.to_string(),
            ];
            let lines = texts.iter().flat_map(|text| text.lines());
            let too_wide = lines.filter(|line| line.chars().count() > WIDEST_HELP);
            wide.extend(too_wide.map(|line| format!("{name}: {line}")));
        });
    }
    assert!(seen > 20, "{seen}");
    assert!(wide.is_empty(), "{}", wide.join("\n"));
}

#[test]
fn every_verb_has_its_help_and_an_example() {
    for mut command in commands() {
        command.build();
        let name = command.get_name().to_owned();
        each(&mut command, &name, &mut |command, name| {
            // `help` is clap's own, `crosshead` itself lists its verbs.
            if name.contains(" help") || name == "crosshead" {
                return;
            }
            let after = command.get_after_help().map(ToString::to_string);
            assert!(after.is_some_and(|text| text.contains("Example")), "{name}");
        });
    }
}

#[test]
fn completions_know_every_verb() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let output = crosshead(&["completions", shell]);
        assert!(output.status.success());
        let script = String::from_utf8(output.stdout).unwrap();
        for word in ["explain-gap", "gen-dataset", "--sample-rate", "--quiet"] {
            // Fish has options without their dashes.
            let bare = word.trim_start_matches('-');
            assert!(script.contains(bare), "{shell}: {word}");
        }
    }
    let other = crosshead(&["completions", "bash", "--program", "gen-dataset"]);
    let script = String::from_utf8(other.stdout).unwrap();
    assert!(script.contains("--retry-failed") && !script.contains("explain-gap"));
    assert_eq!(crosshead(&["completions", "csh"]).status.code(), Some(2));
}

#[test]
fn every_verb_has_its_page() {
    let folder = tempfile::tempdir().unwrap();
    let output = crosshead(&["man", "--out", folder.path().to_str().unwrap()]);
    assert!(output.status.success(), "{output:?}");
    for name in [
        "crosshead",
        "gen-dataset",
        "crosshead-simulate",
        "crosshead-sweep-plan",
    ] {
        let page = fs::read_to_string(folder.path().join(format!("{name}.1"))).unwrap();
        assert!(page.contains(".SH SYNOPSIS"), "{name}: {page}");
    }
    let page = fs::read_to_string(folder.path().join("crosshead-simulate.1")).unwrap();
    assert!(page.contains("Revolutions to record"), "{page}");
}

/// A short run, with these arguments beside.
fn simulated(folder: &std::path::Path, arguments: &[&str]) -> Output {
    let machine = machine();
    let mut all = vec!["simulate", machine.to_str().unwrap()];
    all.extend([
        "--revolutions",
        "2",
        "--transient",
        "1",
        "--overwrite",
        "--out",
    ]);
    all.push(folder.to_str().unwrap());
    all.extend(arguments);
    let output = crosshead(&all);
    assert!(output.status.success(), "{output:?}");
    output
}

#[test]
fn the_next_step_is_named_unless_all_is_to_be_quiet() {
    let folder = tempfile::tempdir().unwrap();
    let told = said(&simulated(folder.path(), &[]));
    assert_eq!(told.lines().count(), 1, "{told}");
    assert!(told.starts_with("next: crosshead features "), "{told}");
    let quiet = simulated(folder.path(), &["--quiet"]);
    assert_eq!(said(&quiet), "");
    assert!(!quiet.stdout.is_empty());
    // Before the verb as well.
    let before = crosshead(&["--quiet", "schema", "machine"]);
    assert!(before.status.success() && before.stderr.is_empty());
}

#[test]
fn messages_are_coloured_where_that_is_asked_for() {
    let wrong = |colour: &str| said(&crosshead(&["verify", "no-such-folder", "--color", colour]));
    assert!(wrong("always").starts_with("\u{1b}[1;31merror:\u{1b}[0m "));
    assert!(wrong("never").starts_with("error: "));
    // No terminal.
    assert!(wrong("auto").starts_with("error: "));
    // clap's own messages, which come before any argument is known.
    let unknown = |colour: &str| said(&crosshead(&["verify", "--nonsense", colour]));
    assert!(unknown("--color=always").contains('\u{1b}'));
    assert!(!unknown("--color=never").contains('\u{1b}'));
}

#[test]
fn threads_change_no_bytes_and_none_is_refused() {
    let [one, two] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    simulated(one.path(), &["--threads", "1"]);
    simulated(two.path(), &["--threads", "2"]);
    for file in fs::read_dir(one.path()).unwrap() {
        let name = file.unwrap().file_name();
        let [a, b] = [&one, &two].map(|folder| fs::read(folder.path().join(&name)).unwrap());
        assert!(a == b, "{name:?}");
    }
    let none = crosshead(&["simulate", "machine.yaml", "--threads", "0"]);
    assert_eq!(none.status.code(), Some(2));
}
