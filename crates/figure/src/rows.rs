//! Panels in rows.

use super::panel::Panel;

/// Panels in rows, one image.
#[derive(Clone, Debug)]
pub struct Figure {
    /// Heading above all panels; empty for none.
    pub title: String,
    /// The panels, top to bottom and left to right.
    pub rows: Vec<Vec<Panel>>,
    /// Heading of each row, above the panels' own; none where there are fewer than rows.
    pub row_headings: Vec<String>,
    /// Width of the whole image in pixels.
    pub width: f64,
    /// Height of the plotting area of one row in pixels.
    pub row_height: f64,
    /// Which panels have the same x range.
    pub share_x: Share,
    /// Which panels have the same y range.
    pub share_y: Share,
}

/// Which panels have an axis in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Share {
    /// Each panel has its own range.
    None,
    /// The panels of a column have one range.
    Column,
    /// All panels have one range.
    All,
}

impl Default for Figure {
    fn default() -> Self {
        Self {
            title: String::new(),
            rows: Vec::new(),
            row_headings: Vec::new(),
            width: 960.0,
            row_height: 220.0,
            share_x: Share::None,
            share_y: Share::None,
        }
    }
}

/// The panels in rows of `columns`; the last row may be shorter.
pub fn in_rows(panels: Vec<Panel>, columns: usize) -> Vec<Vec<Panel>> {
    let columns = columns.max(1);
    let mut rows: Vec<Vec<Panel>> = Vec::new();
    for panel in panels {
        match rows.last_mut() {
            Some(row) if row.len() < columns => row.push(panel),
            _ => rows.push(vec![panel]),
        }
    }
    rows
}
