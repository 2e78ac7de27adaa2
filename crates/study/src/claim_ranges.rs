//! The claims of the clearance study over several settings of what it leaves open.

use crate::claims::{Claim, Verdict, claims};
use crate::grid::{ClearanceGrid, ClearanceGrids};
use crate::levels::table;

/// How often a claim holds over the grids, and the figures of each.
pub struct Range {
    /// What is claimed.
    pub claim: &'static str,
    /// In how many of so many grids it holds.
    pub holds: [usize; 2],
    /// In how many it holds in part, and not at all.
    pub others: [usize; 2],
}

impl Range {
    /// «holds in 3 of 16, in part in 9, not in 4».
    pub fn words(&self) -> String {
        let ([holds, all], [part, not]) = (self.holds, self.others);
        if all == 0 {
            return Verdict::NotTested.words().to_owned();
        }
        format!("holds in {holds} of {all}, in part in {part}, not in {not}")
    }
}

/// The verdicts on the claims in one grid.
pub struct Row {
    /// What sets the grid apart.
    pub settings: Vec<String>,
    /// Verdict and figures of each claim.
    pub claims: Vec<String>,
    /// How many cases are chaotic, of how many.
    pub chaotic: String,
}

impl ClearanceGrids {
    /// The claims as Markdown tables; none where the sweep does not repeat the study.
    pub(crate) fn claim_tables(&self) -> Vec<String> {
        let tested = self.tested();
        match tested.as_slice() {
            [] => Vec::new(),
            [grid] => {
                let heads = ["claim", "verdict", "evidence"].map(str::to_owned);
                let rows = claims(grid).into_iter().map(|claim| {
                    let verdict = claim.verdict.words().to_owned();
                    vec![claim.claim.to_owned(), verdict, claim.evidence]
                });
                vec![table(&heads, 3, rows.collect())]
            }
            _ => {
                let heads = ["claim", "over the settings"].map(str::to_owned);
                let ranges = self.ranges().into_iter();
                let ranges = ranges.map(|range| vec![range.claim.to_owned(), range.words()]);
                let rows = self.rows().into_iter().map(|row| {
                    let mut cells = row.settings;
                    cells.extend(row.claims);
                    cells.push(row.chaotic);
                    cells
                });
                vec![
                    table(&heads, 2, ranges.collect()),
                    table(&self.row_heads(), self.row_heads().len(), rows.collect()),
                ]
            }
        }
    }

    /// The grids that the claims are held against.
    pub fn tested(&self) -> Vec<&ClearanceGrid> {
        let with_levels = self.grids.iter().filter(|grid| !grid.levels.is_empty());
        with_levels.filter(|_| self.claims).collect()
    }

    /// Each claim over all grids.
    pub fn ranges(&self) -> Vec<Range> {
        let each: Vec<Vec<Claim>> = self.tested().into_iter().map(claims).collect();
        let range = |(at, first): (usize, &Claim)| {
            let count = |wanted: Verdict| {
                let verdicts = each.iter().map(|claims| claims[at].verdict);
                verdicts.filter(|verdict| *verdict == wanted).count()
            };
            let [holds, part, not] =
                [Verdict::Holds, Verdict::HoldsInPart, Verdict::DoesNotHold].map(count);
            Range {
                claim: first.claim,
                holds: [holds, holds + part + not],
                others: [part, not],
            }
        };
        let first = each.first().map_or(&[][..], Vec::as_slice);
        first.iter().enumerate().map(range).collect()
    }

    /// Heads of the columns of [`ClearanceGrids::rows`].
    pub fn row_heads(&self) -> Vec<String> {
        let tested = self.tested();
        let Some(grid) = tested.first() else {
            return Vec::new();
        };
        let settings = grid.settings.iter().map(|(name, _)| name.clone());
        let sensor = (!grid.sensor.is_empty()).then(|| "sensor".to_owned());
        let claims = claims(grid).into_iter().map(|claim| claim.claim.to_owned());
        let chaotic = std::iter::once("Chaotic cases".to_owned());
        settings
            .chain(sensor)
            .chain(claims)
            .chain(chaotic)
            .collect()
    }

    /// The verdicts on the claims in each grid.
    pub fn rows(&self) -> Vec<Row> {
        let row = |grid: &ClearanceGrid| {
            let settings = grid.settings.iter().map(|(_, value)| value.clone());
            let sensor = (!grid.sensor.is_empty()).then(|| grid.sensor.clone());
            let claims = claims(grid).into_iter();
            let known = grid.levels.iter().filter(|level| level.joints != "none");
            let known: Vec<bool> = known.filter_map(|level| level.chaotic).collect();
            Row {
                settings: settings.chain(sensor).collect(),
                claims: claims
                    .map(|claim| match claim.verdict {
                        Verdict::NotTested => claim.verdict.words().to_owned(),
                        verdict => format!("{} ({})", verdict.words(), claim.figures),
                    })
                    .collect(),
                chaotic: match known.len() {
                    0 => "–".to_owned(),
                    all => {
                        let chaotic = known.iter().filter(|chaotic| **chaotic).count();
                        format!("{chaotic} of {}", text::count(all))
                    }
                },
            }
        };
        self.tested().into_iter().map(row).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::CaseLevel;
    use crate::level::Level;

    fn grid(damping: &str, peaks: [f64; 2], chaotic: [bool; 2]) -> ClearanceGrid {
        let certain = |value| Level { value, spread: 0.0 };
        let level = |i: usize| CaseLevel {
            joints: "a".to_owned(),
            clearance_m: [1e-4, 2e-4][i],
            rms: certain(1.0),
            peak: certain(peaks[i]),
            high_rms: certain(1.0),
            high_share: 0.1,
            chaotic: Some(chaotic[i]),
        };
        ClearanceGrid {
            settings: vec![("damping".to_owned(), damping.to_owned())],
            high_from_hz: 160.0,
            levels: vec![level(0), level(1)],
            ..ClearanceGrid::default()
        }
    }

    #[test]
    fn claims_have_their_range_over_the_settings() {
        let grids = ClearanceGrids {
            grids: vec![
                grid("2 kN s/m", [1.0, 2.0], [false, true]),
                grid("20 kN s/m", [2.0, 1.0], [false, false]),
            ],
            left_out: 0,
            claims: true,
        };
        let ranges = grids.ranges();
        assert_eq!(ranges[0].words(), "holds in 1 of 2, in part in 0, not in 1");
        assert_eq!(ranges[2].words(), "not tested");
        let rows = grids.rows();
        assert_eq!(rows[0].claims[0], "holds (1 of 1)");
        assert_eq!(
            (rows[0].chaotic.as_str(), rows[1].chaotic.as_str()),
            ("1 of 2", "0 of 2")
        );
        assert_eq!(grids.row_heads().len(), 1 + 7 + 1);
        let markdown = grids.markdown();
        assert!(
            markdown.contains("| 20 kN s/m | does not hold (0 of 1) |"),
            "{markdown}"
        );
    }
}
