//! The signal's word against that of the equations.

use crate::chaos::cases::{CaseChaos, WindowChaos};
use crate::chaos::regime::Regime;
use crate::statistics::rank_correlation;
use std::collections::BTreeMap;

/// How the exponents from the signals go with those from the equations.
#[derive(Clone, Debug, PartialEq)]
pub struct Agreement {
    /// Windows with both exponents.
    pub compared: usize,
    /// Windows of cases with a true exponent whose signal gave none.
    pub abstained: usize,
    /// Reasons of these, with how often each was given, most frequent first.
    pub reasons: Vec<(String, usize)>,
    /// Spearman's rank correlation over the windows compared.
    pub rank_correlation: Option<f64>,
    /// How many intervals hold the true exponent.
    pub covered: usize,
    /// How many of the true exponents are positive.
    pub positive: usize,
    /// How many intervals hold these.
    pub positive_covered: usize,
}

/// Every window whose case has a true exponent.
fn windows(cases: &[CaseChaos]) -> impl Iterator<Item = ([f64; 2], &WindowChaos)> {
    cases.iter().flat_map(|case| {
        let truth = case.exponent;
        let windows = case.windows.iter();
        windows.filter_map(move |window| Some((truth?, window)))
    })
}

/// True exponent with its standard error, and that of the signal with its interval.
pub fn pairs(cases: &[CaseChaos]) -> Vec<([f64; 2], [f64; 3])> {
    windows(cases)
        .filter_map(|(truth, window)| Some((truth, window.exponent?)))
        .collect()
}

impl Agreement {
    /// None where nothing can be compared: no true exponent, or no signal was ever asked.
    pub fn new(cases: &[CaseChaos]) -> Option<Self> {
        let pairs = pairs(cases);
        let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
        for (_, window) in windows(cases) {
            if window.exponent.is_none() && !window.reason.is_empty() {
                *counts.entry(&window.reason).or_default() += 1;
            }
        }
        let abstained = counts.values().sum();
        if pairs.is_empty() && abstained == 0 {
            return None;
        }
        let mut reasons: Vec<(String, usize)> = counts
            .into_iter()
            .map(|(reason, n)| (reason.to_owned(), n))
            .collect();
        reasons.sort_by_key(|(_, n)| std::cmp::Reverse(*n));
        let covers =
            |(truth, [_, low, high]): &&([f64; 2], [f64; 3])| (*low..=*high).contains(&truth[0]);
        let positive = || pairs.iter().filter(|(truth, _)| truth[0] > 0.0);
        let points: Vec<[f64; 2]> = pairs
            .iter()
            .map(|(truth, signal)| [truth[0], signal[0]])
            .collect();
        Some(Self {
            compared: pairs.len(),
            abstained,
            reasons,
            rank_correlation: rank_correlation(&points),
            covered: pairs.iter().filter(covers).count(),
            positive: positive().count(),
            positive_covered: positive().filter(covers).count(),
        })
    }
}

/// Windows by regime from the equations (rows) and from the signal (columns), in the order of
/// [`Regime::KINDS`]; none where no window has both.
pub fn regimes(cases: &[CaseChaos]) -> Option<[[usize; 5]; 5]> {
    let mut counts = [[0; 5]; 5];
    for case in cases {
        let signals = case.windows.iter().filter_map(|window| window.regime);
        for signal in signals {
            if let Some(truth) = case.regime {
                counts[truth.kind()][signal.kind()] += 1;
            }
        }
    }
    counts.iter().flatten().any(|n| *n > 0).then_some(counts)
}

/// The most frequent regime, the first of equals; and whether there are others.
pub fn most_frequent(regimes: impl Iterator<Item = Regime>) -> Option<(Regime, bool)> {
    let mut counts: BTreeMap<Regime, usize> = BTreeMap::new();
    for regime in regimes {
        *counts.entry(regime).or_default() += 1;
    }
    let most = counts.values().max().copied()?;
    let (first, _) = counts.iter().find(|(_, n)| **n == most)?;
    Some((*first, counts.len() > 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn case(truth: f64, windows: &[Option<[f64; 3]>]) -> CaseChaos {
        let window = |exponent: &Option<[f64; 3]>| WindowChaos {
            exponent: *exponent,
            reason: if exponent.is_none() {
                "no scaling region".to_owned()
            } else {
                String::new()
            },
            ..WindowChaos::default()
        };
        CaseChaos {
            exponent: Some([truth, 0.1]),
            windows: windows.iter().map(window).collect(),
            ..CaseChaos::default()
        }
    }

    #[test]
    fn windows_are_counted_one_by_one() {
        let cases = [
            case(1.0, &[Some([1.1, 0.9, 1.3]), Some([1.4, 1.2, 1.6])]),
            case(3.0, &[Some([2.0, 1.0, 3.0]), None]),
            case(-2.0, &[Some([0.1, -0.1, 0.3])]),
            CaseChaos::default(),
        ];
        let agreement = Agreement::new(&cases).unwrap();
        assert_eq!((agreement.compared, agreement.abstained), (4, 1));
        assert_eq!(
            (
                agreement.covered,
                agreement.positive,
                agreement.positive_covered
            ),
            (2, 3, 2)
        );
        assert_eq!(agreement.reasons, [("no scaling region".to_owned(), 1)]);
        assert!(Agreement::new(&[CaseChaos::default()]).is_none());
    }

    #[test]
    fn the_most_frequent_regime_stands_for_all() {
        let some = [Regime::Chaotic, Regime::Periodic(2), Regime::Chaotic];
        assert_eq!(
            most_frequent(some.into_iter()),
            Some((Regime::Chaotic, true))
        );
        assert_eq!(
            most_frequent([Regime::Chaotic].into_iter()),
            Some((Regime::Chaotic, false))
        );
        assert_eq!(most_frequent(std::iter::empty()), None);
    }
}
