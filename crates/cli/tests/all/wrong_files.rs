//! Files as people get them wrong: all mistakes of a file are reported in one run.
//!
//! `tests/wrong` has the files. Where a line is wrong, its comment `#! KEY | WORDS` names the key of each message about
//! it, and words that the message has.

use crate::check::MACHINE;
use crate::small_sweep::{crosshead, text};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Begins what is expected of a line.
const EXPECTED: &str = "#! ";

/// A message: line, key, and all that it says.
type Message = (u64, String, String);

/// The messages about `file` on standard error.
fn messages(stderr: &[u8], file: &Path) -> Vec<Message> {
    let prefix = format!("error: {}:", file.display());
    let lines = text(stderr).lines();
    let lines = lines.filter_map(|line| line.strip_prefix(&prefix));
    let message = |line: &str| {
        let mut parts = line.splitn(3, ':');
        let number = parts.next().unwrap().parse().unwrap();
        let rest = parts.nth(1).unwrap().trim();
        let key = rest.split_once(": ").map_or("", |(key, _)| key);
        (number, key.to_owned(), rest.to_owned())
    };
    lines.map(message).collect()
}

/// What the comments of a file expect: line, key and words of each message.
fn expected(content: &str) -> Vec<Message> {
    let lines = content.lines().zip(1..);
    let each = lines.flat_map(|(line, number)| {
        let comments = line.split(EXPECTED).skip(1);
        comments.map(move |comment| {
            let (key, words) = comment.split_once(" | ").unwrap();
            (number, key.trim().to_owned(), words.trim().to_owned())
        })
    });
    each.collect()
}

#[test]
fn all_mistakes_of_sixty_files_are_reported_in_one_run_each() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/wrong");
    let mut files: Vec<PathBuf> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    files.sort();
    assert!(files.len() >= 60, "{}", files.len());
    let place = tempfile::tempdir().unwrap();
    fs::write(place.path().join("machine.yaml"), MACHINE).unwrap();
    let mut wrong = Vec::new();
    for file in &files {
        let content = fs::read_to_string(file).unwrap();
        let expected = expected(&content);
        assert!(expected.len() >= 2, "{}", file.display());
        let copy = place.path().join(file.file_name().unwrap());
        fs::write(&copy, &content).unwrap();
        let output = crosshead(&["check"]).arg(&copy).output().unwrap();
        let found = messages(&output.stderr, &copy);
        let is_one = |(found, expected): (&Message, &Message)| {
            found.0 == expected.0 && found.1 == expected.1 && found.2.contains(&expected.2)
        };
        let fits = found.len() == expected.len() && found.iter().zip(&expected).all(is_one);
        if !fits || output.status.code() != Some(1) {
            let said = text(&output.stderr);
            wrong.push(format!(
                "{}\nexpected {expected:#?}\n{said}",
                file.display()
            ));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

/// Numbers that follow from a seed (SplitMix64).
struct Draws(u64);

impl Draws {
    fn below(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % end as u64) as usize
    }
}

/// A way to get a line wrong.
#[derive(Clone, Copy, Debug)]
enum Mutation {
    UnitDropped,
    KeyMisspelt,
    ListForValue,
}

const MUTATIONS: [Mutation; 3] = [
    Mutation::UnitDropped,
    Mutation::KeyMisspelt,
    Mutation::ListForValue,
];

/// Keys whose value may be a list, or anything.
const TAKE_LISTS: [&str; 1] = ["bundle"];

impl Mutation {
    /// The line, wrong; none where it cannot be got wrong in this way.
    fn apply(self, line: &str) -> Option<String> {
        let (code, comment) = line.split_once(" #").unwrap_or((line, ""));
        if code.trim_start().starts_with('#') || comment.contains('"') {
            return None;
        }
        let (head, value) = code.split_once(": ")?;
        let indent = head.len() - head.trim_start_matches([' ', '-']).len();
        let (indent, key) = head.split_at(indent);
        let value = value.trim();
        let is_name = |c: char| c.is_ascii_lowercase() || c == '_';
        let is_flow = value.contains(['{', '[', '&', '*', '|', '>']);
        if !key.chars().all(is_name) || key.len() < 5 || value.is_empty() || is_flow {
            return None;
        }
        match self {
            Self::UnitDropped => {
                let (number, unit) = value.split_once(' ')?;
                number.parse::<f64>().ok()?;
                (!unit.is_empty()).then(|| format!("{indent}{key}: {number}"))
            }
            Self::KeyMisspelt => {
                let (first, rest) = key.split_at(2);
                let twice = first.chars().last()?;
                Some(format!("{indent}{first}{twice}{rest}: {value}"))
            }
            Self::ListForValue => {
                let takes = TAKE_LISTS.contains(&key);
                (!takes).then(|| format!("{indent}{key}: [{value}, {value}, {value}]"))
            }
        }
    }
}

/// `content` with two or three of its lines wrong, and these lines.
fn mutated(content: &str, draws: &mut Draws) -> (String, BTreeMap<u64, (Mutation, String)>) {
    let mut lines: Vec<String> = content.lines().map(str::to_owned).collect();
    let wanted = 2 + draws.below(2);
    let mut wrong = BTreeMap::new();
    for _ in 0..1000 {
        let at = draws.below(lines.len());
        let mutation = MUTATIONS[draws.below(MUTATIONS.len())];
        if wrong.len() < wanted
            && !wrong.contains_key(&(at as u64 + 1))
            && let Some(line) = mutation.apply(&lines[at])
        {
            lines[at].clone_from(&line);
            wrong.insert(at as u64 + 1, (mutation, line));
        }
    }
    (lines.join("\n") + "\n", wrong)
}

/// A path from the top of the project.
fn repository(path: &str) -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    root.canonicalize().unwrap().join(path)
}

/// The valid files that come with the project.
fn shipped() -> Vec<PathBuf> {
    let mut files = Vec::new();
    for folder in ["data/machines", "pipelines", "data/recordings/*"] {
        let folder = repository(folder.trim_end_matches("/*"));
        for entry in fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            let bundle = path.join("recordings.yaml");
            if bundle.is_file() {
                files.push(bundle);
            } else if path.extension().is_some_and(|ending| ending == "yaml") {
                files.push(path);
            }
        }
    }
    files.sort();
    files
}

#[test]
fn every_line_that_is_got_wrong_at_random_is_reported() {
    let place = tempfile::tempdir().unwrap();
    let root = repository("");
    let mut all = Vec::new();
    for file in shipped() {
        let own = file.strip_prefix(&root).unwrap();
        let copy = place.path().join(own);
        fs::create_dir_all(copy.parent().unwrap()).unwrap();
        let content = fs::read_to_string(&file).unwrap();
        fs::write(&copy, &content).unwrap();
        all.push((copy, content));
    }
    let mut missed = Vec::new();
    let mut changed = 0;
    for seed in 0..6 {
        let mut draws = Draws(seed);
        let mut cases = Vec::new();
        for (copy, content) in &all {
            let (content, wrong) = mutated(content, &mut draws);
            // Beside the file itself, so that what it names is found.
            let name = copy.file_name().unwrap().to_string_lossy();
            let case = match name.as_ref() {
                "recordings.yaml" => {
                    let folder = copy.parent().unwrap();
                    let folder = folder.with_extension(format!("case{seed}"));
                    fs::create_dir_all(&folder).unwrap();
                    folder.join("recordings.yaml")
                }
                name => copy.with_file_name(format!("case{seed}-{name}")),
            };
            fs::write(&case, &content).unwrap();
            changed += wrong.len();
            cases.push((case, wrong));
        }
        let paths = cases.iter().map(|(case, _)| case);
        let output = crosshead(&["check"]).args(paths).output().unwrap();
        for (case, wrong) in &cases {
            let found = messages(&output.stderr, case);
            let lines: BTreeSet<u64> = found.iter().map(|message| message.0).collect();
            let unseen = wrong.iter().filter(|(line, _)| !lines.contains(line));
            for (line, (mutation, content)) in unseen {
                missed.push(format!(
                    "{}:{line}: {mutation:?}: {content}\n  of {wrong:?}\n  found {found:?}",
                    case.display()
                ));
            }
        }
    }
    assert!(changed > 200, "{changed}");
    assert!(
        missed.is_empty(),
        "{} of {changed}:\n{}",
        missed.len(),
        missed.join("\n")
    );
}
