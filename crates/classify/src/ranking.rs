//! How well single features tell classes apart.

use std::collections::BTreeMap;

/// Bins of a feature for its mutual information with the class.
const BINS: usize = 16;

/// What a feature says about the class by itself.
#[derive(Clone, Debug, PartialEq)]
pub struct RankedFeature {
    /// Its name.
    pub name: String,
    /// Variance between the classes over the variance within them: F of the one-way analysis of variance (R. A. Fisher,
    /// "Statistical Methods for Research Workers", 1925).
    pub anova_f: f64,
    /// H of the same for ranks, corrected for ties (W. H. Kruskal and W. A. Wallis, J. Am. Stat. Assoc. 47, 1952, eqs. 1.1 and
    /// 1.5): it asks for no distribution.
    pub kruskal_wallis_h: f64,
    /// Bits that the feature says about the class, at most the logarithm of the number of classes: of the feature in up to
    /// [`BINS`] bins of equal counts, less the bias of the counts (S. Panzeri and A. Treves, Network 7, 1996, eq. 3.9).
    pub mutual_information: f64,
}

/// The features, those that say most first. Rows without a value are left out of a feature; a feature with fewer than two
/// different values, or two classes, is not ranked.
///
/// `columns` are the values of each row, by feature; `classes` the class of each row.
pub fn ranking(names: &[String], columns: &[Vec<f64>], classes: &[String]) -> Vec<RankedFeature> {
    let mut ranked: Vec<RankedFeature> = names
        .iter()
        .zip(columns)
        .filter_map(|(name, values)| ranked(name, values, classes))
        .collect();
    ranked.sort_by(|a, b| b.mutual_information.total_cmp(&a.mutual_information));
    ranked
}

fn ranked(name: &str, values: &[f64], classes: &[String]) -> Option<RankedFeature> {
    let mut rows: Vec<(f64, &str)> = values
        .iter()
        .zip(classes)
        .filter(|(value, _)| value.is_finite())
        .map(|(value, class)| (*value, class.as_str()))
        .collect();
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    let count = rows.len() as f64;
    if rows.first()?.0 == rows.last()?.0 {
        return None;
    }
    let (ranks, ties) = ranks(&rows);
    let mut of_class: BTreeMap<&str, Vec<(f64, f64)>> = BTreeMap::new();
    for ((value, class), rank) in rows.iter().zip(ranks) {
        of_class.entry(class).or_default().push((*value, rank));
    }
    let groups = of_class.len() as f64;
    if groups < 2.0 || count <= groups {
        return None;
    }
    let mean = rows.iter().map(|(value, _)| value).sum::<f64>() / count;
    let (mut between, mut within, mut rank_squares) = (0.0, 0.0, 0.0);
    for members in of_class.values() {
        let size = members.len() as f64;
        let own = members.iter().map(|(value, _)| value).sum::<f64>() / size;
        between += size * (own - mean).powi(2);
        within += members
            .iter()
            .map(|(value, _)| (value - own).powi(2))
            .sum::<f64>();
        rank_squares += members.iter().map(|(_, rank)| rank).sum::<f64>().powi(2) / size;
    }
    let h = 12.0 / (count * (count + 1.0)) * rank_squares - 3.0 * (count + 1.0);
    Some(RankedFeature {
        name: name.to_owned(),
        anova_f: (between / (groups - 1.0)) / (within / (count - groups)),
        kruskal_wallis_h: h / (1.0 - ties / (count.powi(3) - count)),
        mutual_information: mutual_information(&rows),
    })
}

/// The rank of each of the sorted rows, the mean of those that are equal, and the sum of t³ − t over the ties.
fn ranks(rows: &[(f64, &str)]) -> (Vec<f64>, f64) {
    let (mut ranks, mut ties) = (Vec::with_capacity(rows.len()), 0.0);
    for equal in rows.chunk_by(|a, b| a.0 == b.0) {
        let size = equal.len() as f64;
        let rank = ranks.len() as f64 + (size + 1.0) / 2.0;
        ranks.extend(equal.iter().map(|_| rank));
        ties += size.powi(3) - size;
    }
    (ranks, ties)
}

/// Mutual information of the binned value and the class, bits; never below 0. Equal values share a bin.
fn mutual_information(rows: &[(f64, &str)]) -> f64 {
    let count = rows.len() as f64;
    let mut cells: BTreeMap<(usize, &str), f64> = BTreeMap::new();
    let (mut bins, mut classes) = (BTreeMap::new(), BTreeMap::new());
    let mut before = 0;
    for equal in rows.chunk_by(|a, b| a.0 == b.0) {
        let bin = before * BINS / rows.len();
        before += equal.len();
        for (_, class) in equal {
            *cells.entry((bin, class)).or_default() += 1.0;
            *bins.entry(bin).or_insert(0.0) += 1.0;
            *classes.entry(*class).or_insert(0.0) += 1.0;
        }
    }
    let bits: f64 = cells
        .iter()
        .map(|((bin, class), n)| n / count * (n * count / (bins[bin] * classes[class])).log2())
        .sum();
    let freedom = (bins.len() - 1) * (classes.len() - 1);
    (bits - freedom as f64 / (2.0 * count * std::f64::consts::LN_2)).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn single(values: &[f64], classes: &[&str]) -> RankedFeature {
        let classes: Vec<String> = classes.iter().map(|class| (*class).to_owned()).collect();
        ranking(&["x".to_owned()], &[values.to_vec()], &classes).remove(0)
    }

    #[test]
    fn anova_and_kruskal_are_those_of_scipy() {
        // scipy 1.17.1: f_oneway(a, b, c), kruskal(a, b, c), with ties.
        let a = [6.9, 5.4, 5.8, 4.6, 4.0];
        let b = [8.3, 6.8, 7.8, 9.2, 6.5];
        let c = [8.0, 10.5, 8.1, 6.9, 9.3, 9.3];
        let values = [&a[..], &b, &c].concat();
        let classes = [["a"; 5].as_slice(), &["b"; 5], &["c"; 6]].concat();
        let found = single(&values, &classes);
        assert!(
            (found.anova_f - 11.451_070_265_239_647).abs() < 1e-12,
            "{found:?}"
        );
        assert!(
            (found.kruskal_wallis_h - 9.319_690_265_486_729).abs() < 1e-12,
            "{found:?}"
        );
    }

    #[test]
    fn a_feature_that_is_the_class_says_all_and_noise_nothing() {
        let classes: Vec<&str> = (0..4000).map(|i| ["a", "b", "c", "d"][i % 4]).collect();
        let the_class: Vec<f64> = (0..4000).map(|i| (i % 4) as f64).collect();
        let found = single(&the_class, &classes);
        assert!((found.mutual_information - 2.0).abs() < 0.002, "{found:?}");
        // The golden ratio's multiples modulo 1 have nothing to do with the class.
        let noise: Vec<f64> = (0..4000)
            .map(|i| (f64::from(i) * 0.618_033_988_749_895).fract())
            .collect();
        assert!(single(&noise, &classes).mutual_information < 0.005);
    }

    #[test]
    fn what_says_nothing_or_is_missing_is_not_ranked() {
        let names = ["constant", "missing", "x"].map(str::to_owned);
        let columns = [vec![1.0; 4], vec![f64::NAN; 4], vec![1.0, 1.1, 2.0, 2.1]];
        let classes = ["a", "a", "b", "b"].map(str::to_owned);
        let found = ranking(&names, &columns, &classes);
        assert_eq!(found.len(), 1);
        assert!(ranking(&names, &columns, &["a", "a", "a", "a"].map(str::to_owned)).is_empty());
    }
}
