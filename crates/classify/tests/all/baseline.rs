//! Classes that can be told apart, and classes that cannot.

use crate::sample::{each_by_itself, uniform};
use classify::{Matrix, Sample, baseline};

/// Three classes by thirds of the first number; where `mixed`, the last two have one name each at random.
fn thirds(rows: usize, seed: u64, mixed: bool) -> (Sample, Vec<String>) {
    let columns = uniform(3, rows, seed);
    let class = |row: usize| match (columns[0][row] * 3.0) as usize {
        0 => "none",
        1 if !mixed => "big_end",
        2 if !mixed => "small_end",
        _ if columns[2][row] < 0.5 => "big_end",
        _ => "small_end",
    };
    let classes = (0..rows).map(|row| class(row).to_owned()).collect();
    let columns = columns[..2].to_vec();
    let groups = each_by_itself(rows);
    (
        Sample {
            values: Matrix::new(columns, rows),
            groups,
        },
        classes,
    )
}

#[test]
fn classes_that_differ_are_found() {
    let ((train, of), (test, truth)) = (thirds(600, 1, false), thirds(300, 2, false));
    let found = baseline((&train, &of), (&test, &truth)).unwrap();
    assert!(found.accuracy > 0.97, "{found:?}");
    assert_eq!((found.trained_on, found.tested_on), (600, 300));
    let names: Vec<&str> = found
        .classes
        .iter()
        .map(|class| class.class.as_str())
        .collect();
    assert_eq!(names, ["big_end", "none", "small_end"]);
    assert_eq!(
        found.classes.iter().map(|class| class.rows).sum::<usize>(),
        300
    );
}

#[test]
fn classes_that_do_not_are_confused_with_each_other() {
    let ((train, of), (test, truth)) = (thirds(600, 3, true), thirds(300, 4, true));
    let found = baseline((&train, &of), (&test, &truth)).unwrap();
    let class = |name: &str| {
        found
            .classes
            .iter()
            .find(|class| class.class == name)
            .unwrap()
    };
    assert!(class("none").recall > 0.95, "{found:?}");
    assert!((class("big_end").recall - 0.5).abs() < 0.2, "{found:?}");
    assert_eq!(class("big_end").confused_with(), Some("small_end"));
    // Balanced: the mean of the recalls.
    let mean = found.classes.iter().map(|class| class.recall).sum::<f64>() / 3.0;
    assert!((found.balanced_accuracy - mean).abs() < 1e-12);
}

#[test]
fn one_class_or_no_test_gives_none() {
    let (sample, classes) = thirds(60, 5, false);
    let one = vec!["none".to_owned(); 60];
    assert_eq!(baseline((&sample, &one), (&sample, &one)), None);
    let nothing = Sample {
        values: Matrix::new(vec![vec![]; 2], 0),
        groups: vec![],
    };
    assert_eq!(baseline((&sample, &classes), (&nothing, &[])), None);
}
