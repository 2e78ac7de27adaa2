//! The area against counting all pairs.

use crate::sample::uniform;
use classify::area_under_curve;

/// The share of pairs in which the row of the class has the higher score; ties count half.
fn by_pairs(scores: &[f64], of_class: &[bool]) -> f64 {
    let (mut wins, mut pairs) = (0.0, 0.0);
    for (a, _) in scores.iter().zip(of_class).filter(|(_, inside)| **inside) {
        for (b, _) in scores.iter().zip(of_class).filter(|(_, inside)| !**inside) {
            pairs += 1.0;
            wins += if a > b {
                1.0
            } else if a == b {
                0.5
            } else {
                0.0
            };
        }
    }
    wins / pairs
}

#[test]
fn it_is_the_share_of_pairs() {
    let numbers = uniform(2, 60, 1);
    // Tenths, so that there are ties.
    let scores: Vec<f64> = numbers[0].iter().map(|x| (x * 10.0).floor()).collect();
    let of_class: Vec<bool> = numbers[1].iter().map(|x| *x > 0.7).collect();
    let area = area_under_curve(&scores, &of_class).unwrap();
    assert!(
        (area - by_pairs(&scores, &of_class)).abs() < 1e-12,
        "{area}"
    );
}

#[test]
fn it_is_1_where_the_class_is_above_and_half_where_all_are_equal() {
    let of_class = [false, true, false, true];
    assert_eq!(
        area_under_curve(&[1.0, 3.0, 2.0, 4.0], &of_class),
        Some(1.0)
    );
    assert_eq!(area_under_curve(&[5.0; 4], &of_class), Some(0.5));
    assert_eq!(
        area_under_curve(&[3.0, f64::NAN, 3.0, f64::NAN], &of_class),
        Some(0.0)
    );
}

#[test]
fn there_is_none_without_both_classes() {
    assert_eq!(area_under_curve(&[1.0, 2.0], &[true, true]), None);
    assert_eq!(area_under_curve(&[], &[]), None);
}
