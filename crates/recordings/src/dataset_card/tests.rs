use super::*;
use crate::{Column, Kind, Role};

fn card() -> DatasetCard {
    let column = Column::new("clearance_m", Kind::Real, "of a | joint")
        .unit("m")
        .role(Role::Label)
        .optional();
    let fault = Column::new("fault", Kind::Text, "where it is").role(Role::Label);
    let faults = |rows: &[(&str, u64)]| rows.iter().map(|(f, n)| ((*f).to_owned(), *n)).collect();
    let rows = [
        ("test", faults(&[("none", 1)])),
        ("train", faults(&[("big_end", 2), ("none", 30)])),
        ("validation", faults(&[])),
    ];
    DatasetCard {
        title: "Yes: no".into(),
        summary: "All of it.".into(),
        licence: Some(Licence::CC0),
        uses: vec!["Training.".into()],
        limits: Vec::new(),
        tags: vec!["a".into()],
        machine: vec![("stroke".into(), "240 mm".into())],
        rows: rows
            .map(|(split, faults)| (split.to_owned(), faults))
            .into(),
        subsets: ["signals", "features"]
            .map(|name| Subset {
                name: name.into(),
                schema: Schema::new(vec![fault.clone(), column.clone()]).unwrap(),
            })
            .into(),
        unsplit: Vec::new(),
        mcap_example: None,
        command: "gen-dataset sweep.yaml".into(),
        version: "0.1.0".into(),
    }
}

#[test]
fn the_front_matter_names_the_splits_that_have_rows() {
    let text = card().to_string();
    let front_matter = text.split("---\n").nth(1).unwrap();
    let expected = r#"pretty_name: "Yes: no"
license: "cc0-1.0"
tags: ["a"]
size_categories: ["n<1K"]
configs:
- config_name: "signals"
  default: true
  data_files:
  - split: "train"
    path: "signals/train-*.parquet"
  - split: "test"
    path: "signals/test-*.parquet"
- config_name: "features"
  data_files:
  - split: "train"
    path: "features/train-*.parquet"
  - split: "test"
    path: "features/test-*.parquet"
dataset_info:
- config_name: "signals"
  features:
  - {name: "fault", dtype: {class_label: {names: {"0": "none", "1": "big_end"}}}}
  - {name: "clearance_m", dtype: float64}
- config_name: "features"
  features:
  - {name: "fault", dtype: {class_label: {names: {"0": "none", "1": "big_end"}}}}
  - {name: "clearance_m", dtype: float64}
"#;
    assert_eq!(front_matter, expected);

    let mut empty = card();
    empty.rows.clear();
    assert!(!empty.to_string().contains("config"));
}

#[test]
fn rows_are_counted_by_fault_and_split() {
    let text = card().to_string();
    let expected = "| fault | train | validation | test | all |
|---|---|---|---|---|
| `none` | 30 | 0 | 1 | 31 |
| `big_end` | 2 | 0 | 0 | 2 |
| all | 32 | 0 | 1 | 33 |
";
    assert!(text.contains(expected), "{text}");
    let column = r"| `clearance_m` | label | a real number, or nothing | m | of a \| joint |";
    // Once for both tables.
    assert_eq!(text.matches(column).count(), 1, "{text}");
}

/// Names come from files that others wrote; the card is published.
#[test]
fn names_are_no_markup() {
    let hostile = "<img src=x onerror=alert(1)> [a](b) `c` | d\n# e\u{85}---\n";
    let mut card = card();
    card.title = hostile.into();
    card.machine = vec![("machine".into(), hostile.into())];
    card.rows
        .insert("train".into(), [(hostile.to_owned(), 3)].into());
    card.subsets[0].schema = Schema::new(vec![Column::new(hostile, Kind::Real, hostile)]).unwrap();
    let text = card.to_string();
    let shown = r"\<img src=x onerror=alert(1)\> \[a\](b) \`c\` \| d # e ---";
    assert!(text.contains(&format!("\n# {shown}\n")), "{text}");
    assert!(text.contains(&format!("| machine | {shown} |\n")), "{text}");
    let code = r"`<img src=x onerror=alert(1)> [a](b) ?c? \| d?# e?---?`";
    assert_eq!(text.matches(code).count(), 2, "{text}");
    let name = r#"pretty_name: "<img src=x onerror=alert(1)> [a](b) `c` | d\n# e\u0085---\n""#;
    assert_eq!(text.lines().nth(1), Some(name));
    // Every heading is one of the card's own.
    let headings = text.lines().filter(|line| line.starts_with('#')).count();
    let mut plain = self::card();
    plain.title = "a".into();
    plain.subsets[0].schema = Schema::new(vec![Column::new("a", Kind::Real, "a")]).unwrap();
    assert_eq!(
        headings,
        plain
            .to_string()
            .lines()
            .filter(|line| line.starts_with('#'))
            .count()
    );
}

/// A table of features has hundreds of columns; the card has a row for each quantity.
#[test]
fn features_of_one_meaning_share_a_row() {
    let mut card = card();
    let features = (1..=40).map(|order| {
        let meaning = format!("Amplitude at order {order}");
        let column = Column::new(format!("pressure.order_{order:02}_pa"), Kind::Real, meaning);
        column.unit("Pa").role(Role::Feature)
    });
    let mut columns = card.subsets[1].schema.columns().to_vec();
    columns.extend(features);
    card.subsets[1].schema = Schema::new(columns).unwrap();
    let text = card.to_string();
    let row = "| `pressure.order_01_pa` | 40 | Pa | Amplitude at order 1 |\n";
    assert!(text.contains(row), "{text}");
    assert_eq!(text.matches("| `pressure.").count(), 1);
    // The types of all of them are in the front matter.
    assert_eq!(text.matches("pressure.order_").count(), 41);
}

#[test]
fn uses_limits_and_licence_are_said_where_there_are_any() {
    let mut card = card();
    let text = card.to_string();
    assert!(
        text.contains("\n## Intended use\n\n- Training.\n"),
        "{text}"
    );
    assert!(!text.contains("## Limits"), "{text}");
    assert!(text.contains("[CC0-1.0](https://spdx.org/licenses/CC0-1.0)"));
    card.licence = None;
    let text = card.to_string();
    assert!(text.contains("\nlicense: \"unknown\"\n"), "{text}");
}
