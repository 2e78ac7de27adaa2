//! Every section of MODEL.md that the code cites exists.

use std::fs;
use std::path::{Path, PathBuf};

/// What stands between the name of the page and its sections, in all spellings.
const CITED: &str = "MODEL.md";

#[test]
fn every_cited_section_of_the_model_exists() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let page = fs::read_to_string(root.join("MODEL.md")).unwrap();
    let is_there = |number: u32| page.contains(&format!("\n## {number}. "));
    let mut cited = 0;
    for path in sources(&root.join("..")) {
        let text = fs::read_to_string(&path).unwrap();
        for number in sections(&text) {
            assert!(is_there(number), "{}: section {number}", path.display());
            cited += 1;
        }
    }
    assert!(cited > 12, "{cited} citations found");
}

/// The numbers that follow each mention of the page: "section 5", "sections 3 and 6".
fn sections(text: &str) -> Vec<u32> {
    let mentions = text.split(CITED).skip(1);
    let numbers = mentions.flat_map(|after| {
        let after = after.trim_start_matches([',', ' ']);
        let (list, most) = match after.strip_prefix("section ") {
            Some(one) => (one, 1),
            None => (
                after.strip_prefix("sections ").unwrap_or_default(),
                usize::MAX,
            ),
        };
        let words = list.split(|c: char| !c.is_ascii_alphanumeric());
        let words = words.filter(|word| !["and", ""].contains(word));
        let numbers = words.map_while(|word| word.parse().ok());
        numbers.take(most).collect::<Vec<u32>>()
    });
    numbers.collect()
}

/// The sources and pages below `folder`.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        match path.extension().and_then(|e| e.to_str()) {
            None if path.is_dir() => found.extend(sources(&path)),
            Some("rs" | "md") => found.push(path),
            _ => {}
        }
    }
    found
}

#[test]
fn citations_are_read() {
    let text = "(MODEL.md, sections 3 and 6). MODEL.md section 5: 2.4e10. MODEL.md's law";
    assert_eq!(sections(text), [3, 6, 5]);
}
