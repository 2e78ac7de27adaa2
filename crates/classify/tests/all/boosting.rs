//! Boosting finds what trees can find.

use crate::sample::uniform;
use classify::{Boosting, Matrix, area_under_curve};

fn area(train: &(Matrix, Vec<bool>), test: &(Matrix, Vec<bool>)) -> f64 {
    let scores = Boosting::fit(&train.0, &train.1).scores(&test.0);
    area_under_curve(&scores, &test.1).unwrap()
}

/// Of the class where one of the first two numbers, and not both, is above a half: neither tells anything by itself.
fn one_of_two(rows: usize, seed: u64) -> (Matrix, Vec<bool>) {
    let columns = uniform(5, rows, seed);
    let pairs = columns[0].iter().zip(&columns[1]);
    let of_class = pairs.map(|(a, b)| (*a > 0.5) != (*b > 0.5)).collect();
    (Matrix::new(columns, rows), of_class)
}

#[test]
fn it_finds_what_only_two_features_together_tell() {
    let (train, test) = (one_of_two(600, 1), one_of_two(400, 2));
    let alone = area_under_curve(&test.0.columns()[0], &test.1).unwrap();
    assert!((alone - 0.5).abs() < 0.1, "{alone}");
    let area = area(&train, &test);
    assert!(area > 0.97, "{area}");
}

#[test]
fn a_missing_value_tells_too() {
    let with_gaps = |rows: usize, seed: u64| {
        let mut columns = uniform(2, rows, seed);
        let of_class: Vec<bool> = columns[1].iter().map(|x| *x > 0.5).collect();
        let missing = columns[0]
            .iter_mut()
            .zip(&of_class)
            .filter(|(_, inside)| **inside);
        missing.for_each(|(value, _)| *value = f64::NAN);
        columns.truncate(1);
        (Matrix::new(columns, rows), of_class)
    };
    let area = area(&with_gaps(200, 3), &with_gaps(100, 4));
    assert_eq!(area, 1.0);
}

#[test]
fn scores_are_logarithms_of_odds() {
    // Where nothing tells anything, the odds are those of the classes.
    let of_class: Vec<bool> = (0..400).map(|row| row % 4 == 0).collect();
    let nothing = Matrix::new(vec![vec![1.0; 400]], 400);
    for score in Boosting::fit(&nothing, &of_class).scores(&nothing) {
        assert!((score - (1.0_f64 / 3.0).ln()).abs() < 1e-12, "{score}");
    }
}

#[test]
fn scale_and_order_of_values_alone_count() {
    let (matrix, of_class) = one_of_two(300, 5);
    let stretched = matrix
        .columns()
        .iter()
        .map(|column| column.iter().map(|x| 1e6 * x.powi(3)).collect());
    let stretched = Matrix::new(stretched.collect(), matrix.rows());
    let scores = |matrix: &Matrix| Boosting::fit(matrix, &of_class).scores(matrix);
    assert_eq!(scores(&matrix), scores(&stretched));
}

#[test]
fn any_number_of_threads_gives_the_same() {
    let (matrix, of_class) = one_of_two(300, 6);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| Boosting::fit(&matrix, &of_class).scores(&matrix))
    };
    assert_eq!(with(1), with(4));
}

#[test]
fn a_class_that_is_all_or_nothing_is_no_error() {
    let matrix = Matrix::new(uniform(2, 30, 7), 30);
    assert_eq!(
        Boosting::fit(&matrix, &[true; 30]).scores(&matrix),
        vec![f64::INFINITY; 30]
    );
    assert_eq!(
        Boosting::fit(&matrix, &[false; 30]).scores(&matrix),
        vec![f64::NEG_INFINITY; 30]
    );
}
