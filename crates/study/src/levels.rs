//! The levels of the cases of a grid as a table.

use crate::classes;
use crate::grid::{CaseLevel, ClearanceGrid, ClearanceGrids};
use std::fmt::Write;

impl ClearanceGrids {
    /// The levels of a single grid, and the verdicts on the claims, as Markdown tables; empty where
    /// there is nothing of the kind.
    pub fn markdown(&self) -> String {
        let mut tables = Vec::new();
        if let [grid] = self.grids.as_slice()
            && !grid.levels.is_empty()
        {
            let cells = grid.levels.iter().map(|level| level_cells(level).to_vec());
            tables.push(table(&grid.level_heads(), 1, cells.collect()));
        }
        tables.extend(self.claim_tables());
        let separate = tables.iter().map(|table| format!("\n{table}"));
        separate.collect::<String>().replace('\u{a0}', " ")
    }
}

/// A Markdown table whose first `left` columns are words.
pub(crate) fn table(heads: &[String], left: usize, rows: Vec<Vec<String>>) -> String {
    let rule = (0..heads.len()).map(|i| if i < left { "---" } else { "--:" }.to_owned());
    let mut out = String::new();
    for row in [heads.to_vec(), rule.collect()].into_iter().chain(rows) {
        let _ = writeln!(out, "| {} |", row.join(" | "));
    }
    out
}

impl ClearanceGrid {
    /// Heads of the columns of the levels.
    pub fn level_heads(&self) -> [String; 6] {
        let above = text::quantity(self.high_from_hz, "Hz");
        [
            "joints with clearance".to_owned(),
            "clearance".to_owned(),
            "peak (m/s²)".to_owned(),
            "rms (m/s²)".to_owned(),
            format!("rms above {above} (m/s²)"),
            format!("energy above {above}"),
        ]
    }

    /// What it is of: «500 rpm, throw1.crosshead acceleration».
    pub fn title(&self) -> String {
        let parts = [&self.operating_point, &self.sensor].into_iter();
        let parts: Vec<&str> = parts
            .map(String::as_str)
            .filter(|p| !p.is_empty())
            .collect();
        parts.join(", ")
    }
}

/// The cells of a case in the table of levels.
pub fn level_cells(level: &CaseLevel) -> [String; 6] {
    let ideal = level.joints == "none";
    [
        classes::name(&level.joints),
        if ideal {
            "–".to_owned()
        } else {
            text::clearance(level.clearance_m)
        },
        text::decimal(level.peak.value, 1),
        text::decimal(level.rms.value, 1),
        text::decimal(level.high_rms.value, 1),
        format!("{}\u{a0}%", text::decimal(100.0 * level.high_share, 2)),
    ]
}
