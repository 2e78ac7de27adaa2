//! Area under the receiver's operating characteristic.

/// Area under the curve: the probability that a row of the class has a higher score than one that is not of it, ties counted
/// half (Mann and Whitney 1947). 0.5 where the scores say nothing, 1 where they say everything. A score that is NaN counts
/// as below all others.
///
/// `None` where one of the classes has no row.
///
/// # Panics
/// If there are not as many scores as rows.
pub fn area_under_curve(scores: &[f64], of_class: &[bool]) -> Option<f64> {
    assert_eq!(scores.len(), of_class.len(), "a score for each row");
    let inside = of_class.iter().filter(|inside| **inside).count();
    let outside = of_class.len() - inside;
    if inside == 0 || outside == 0 {
        return None;
    }
    let key = |row: usize| {
        if scores[row].is_nan() {
            f64::NEG_INFINITY
        } else {
            scores[row]
        }
    };
    let mut order: Vec<usize> = (0..scores.len()).collect();
    order.sort_by(|a, b| key(*a).total_cmp(&key(*b)));
    // Twice the ranks of the class: those of equal scores are the mean of their places.
    let (mut ranks, mut place) = (0, 0);
    for equal in order.chunk_by(|a, b| key(*a) == key(*b)) {
        let twice_the_rank = 2 * place + equal.len() + 1;
        ranks += twice_the_rank * equal.iter().filter(|row| of_class[**row]).count();
        place += equal.len();
    }
    let above = ranks as f64 / 2.0 - (inside * (inside + 1)) as f64 / 2.0;
    Some(above / (inside as f64 * outside as f64))
}
