//! Samples that are alike, and samples that are not.

use crate::sample::{each_by_itself, uniform};
use classify::{Matrix, Sample, domain_gap};

fn names(columns: usize) -> Vec<String> {
    (0..columns).map(|i| format!("feature{i}")).collect()
}

fn sample(columns: Vec<Vec<f64>>) -> Sample {
    let rows = columns[0].len();
    Sample {
        values: Matrix::new(columns, rows),
        groups: each_by_itself(rows),
    }
}

#[test]
fn alike_samples_cannot_be_told_apart() {
    let (simulated, measured) = (sample(uniform(6, 500, 1)), sample(uniform(6, 200, 2)));
    let gap = domain_gap(&names(6), &simulated, &measured, 5, 0).unwrap();
    assert!((gap.auc - 0.5).abs() < 0.1, "{}", gap.auc);
    assert_eq!(
        (gap.simulated, gap.measured, gap.folds.len()),
        (500, 200, 5)
    );
}

#[test]
fn the_feature_that_is_off_stands_first_with_its_medians() {
    let simulated = sample(uniform(6, 500, 3));
    let mut columns = uniform(6, 200, 4);
    columns[4].iter_mut().for_each(|x| *x += 0.8);
    let gap = domain_gap(&names(6), &simulated, &sample(columns), 5, 0).unwrap();
    assert!(gap.auc > 0.95, "{}", gap.auc);
    let first = &gap.features[0];
    assert_eq!(first.feature, "feature4");
    assert!(
        first.loss > 0.3 && gap.features[1].loss < 0.05,
        "{:?}",
        &gap.features[..2]
    );
    // Of uniform numbers x and y + 0.8: P(x < y + 0.8) = 1 - 0.2² / 2.
    assert!((first.auc - 0.98).abs() < 0.01, "{}", first.auc);
    let median =
        |value: Option<f64>, expected: f64| assert!((value.unwrap() - expected).abs() < 0.1);
    median(first.simulated, 0.5);
    median(first.measured, 1.3);
}

#[test]
fn windows_of_one_recording_stay_together() {
    // Five windows of each recording are alike, and nothing else is: what is learnt by heart is of no use.
    let repeated = |recordings: usize, seed: u64| {
        let columns = uniform(4, recordings, seed);
        let repeat = |column: &Vec<f64>| column.iter().flat_map(|x| [*x; 5]).collect();
        let mut sample = sample(columns.iter().map(repeat).collect());
        sample.groups = (0..5 * recordings)
            .map(|row| (row / 5).to_string())
            .collect();
        sample
    };
    let gap = domain_gap(&names(4), &repeated(60, 5), &repeated(60, 6), 5, 0).unwrap();
    assert!(gap.auc < 0.65, "{}", gap.auc);
    let mut apart = [repeated(60, 5), repeated(60, 6)];
    apart
        .iter_mut()
        .for_each(|sample| sample.groups = each_by_itself(300));
    let [simulated, measured] = apart;
    let leaked = domain_gap(&names(4), &simulated, &measured, 5, 0).unwrap();
    assert!(leaked.auc > 0.8, "{}", leaked.auc);
}

#[test]
fn too_few_recordings_give_none() {
    let (many, few) = (sample(uniform(2, 50, 7)), sample(uniform(2, 4, 8)));
    assert_eq!(domain_gap(&names(2), &many, &few, 5, 0), None);
    assert_eq!(domain_gap(&names(2), &few, &many, 5, 0), None);
    assert!(domain_gap(&names(2), &many, &few, 4, 0).is_some());
}

#[test]
fn a_seed_gives_the_same_again() {
    let (simulated, measured) = (sample(uniform(3, 80, 9)), sample(uniform(3, 80, 10)));
    let gap = |seed| domain_gap(&names(3), &simulated, &measured, 5, seed).unwrap();
    assert_eq!(gap(1), gap(1));
    assert_ne!(gap(1).folds, gap(2).folds);
}
