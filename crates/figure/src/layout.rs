//! Where each panel stands in the image.

use super::axis::{self, Direction, Ruler};
use super::panel::Panel;
use super::rows::{Figure, Share};

/// Font sizes in pixels.
pub(super) const TITLE_SIZE: f64 = 15.0;
/// Size of the headings of rows.
pub(super) const HEADING_SIZE: f64 = 13.0;
/// Size of panel headings, axis labels and legend.
pub(super) const LABEL_SIZE: f64 = 12.0;
/// Size of tick labels.
pub(super) const TICK_SIZE: f64 = 11.0;

/// Room at the outer edges of the image.
const EDGE: f64 = 14.0;
/// Room between the tick labels of a panel and its neighbour.
const GAP: f64 = 26.0;
/// Height of a line of text.
const LINE: f64 = 18.0;
/// Distances in pixels between ticks that are aimed at.
const X_TICKS: f64 = 52.0;
const Y_TICKS: f64 = 34.0;

/// A rectangle in pixels from the upper left corner of the image.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) width: f64,
    pub(super) height: f64,
}

/// A panel with its plotting area and axes.
#[derive(Clone, Debug)]
pub(super) struct Placed<'a> {
    pub(super) panel: &'a Panel,
    pub(super) frame: Frame,
    ranges: [Option<(f64, f64)>; 2],
    pub(super) x: Ruler,
    pub(super) y: Ruler,
    /// Whether ticks and label of the axis are written, or shown by a neighbour.
    pub(super) x_shown: bool,
    pub(super) y_shown: bool,
    /// Room that the tick labels of y take.
    pub(super) y_room: f64,
}

impl Placed<'_> {
    /// Makes the axes as long as the frame.
    fn set_rulers(&mut self) {
        let (width, height) = (self.frame.width, self.frame.height);
        self.x = Ruler::new(&self.panel.x, self.ranges[0], width, X_TICKS);
        self.y = Ruler::new(&self.panel.y, self.ranges[1], height, Y_TICKS);
    }
}

/// Everything in its place.
pub(super) struct Layout<'a> {
    pub(super) cells: Vec<Placed<'a>>,
    /// Headings of rows, with their base lines.
    pub(super) headings: Vec<(f64, &'a str)>,
    /// Height of the image.
    pub(super) height: f64,
}

/// All panels in place below `top`.
pub(super) fn place(figure: &Figure, top: f64) -> Layout<'_> {
    let mut rows: Vec<Vec<Placed<'_>>> = figure
        .rows
        .iter()
        .enumerate()
        .map(|(at, row)| {
            let lower = figure.rows.get(at + 1..).unwrap_or_default();
            let lowest = |column: usize| lower.iter().all(|row| row.len() <= column);
            let shown = |column: usize| figure.share_x == Share::None || lowest(column);
            row.iter()
                .enumerate()
                .map(|(i, panel)| cell(figure, panel, i, shown(i)))
                .collect()
        })
        .collect();
    align_columns(&mut rows);
    let mut top = top;
    let mut headings = Vec::new();
    for at in 0..rows.len() {
        if let Some(heading) = figure.row_headings.get(at) {
            top += LINE;
            headings.push((top - 2.0, heading.as_str()));
        }
        let (before, rest) = rows.split_at_mut(at);
        let row = &mut rest[0];
        let titled = row.iter().any(|cell| !cell.panel.title.is_empty());
        top += if titled { LINE + 4.0 } else { 4.0 };
        top += match before.first() {
            Some(first) if at + 1 == figure.rows.len() && row.len() < first.len() => {
                stand_below(row, first, top, figure)
            }
            _ => spread(row, top, figure),
        };
        top += if row.iter().any(|cell| cell.x_shown) {
            2.0 * LINE + 8.0
        } else {
            8.0
        };
    }
    Layout {
        cells: rows.into_iter().flatten().collect(),
        headings,
        height: top + EDGE - 8.0,
    }
}

/// A panel with its axes; where it stands and how wide it is is not known yet.
fn cell<'a>(figure: &'a Figure, panel: &'a Panel, column: usize, x_shown: bool) -> Placed<'a> {
    let height = figure.row_height;
    let mut ranges = [Direction::X, Direction::Y]
        .map(|direction| shared_range(figure, panel, column, direction));
    if panel.equal_axes {
        let half = |range: &(f64, f64)| (range.1 - range.0) / 2.0;
        let half = ranges.iter().flatten().map(half).fold(0.0, f64::max);
        let around = |middle: f64| (middle - half, middle + half);
        ranges = ranges.map(|range| range.map(|(low, high)| around(f64::midpoint(low, high))));
    }
    let y = Ruler::new(&panel.y, ranges[1], height, Y_TICKS);
    let widest = y
        .ticks
        .iter()
        .map(|(_, label)| text_width(label, TICK_SIZE))
        .fold(0.0, f64::max);
    let y_shown = figure.share_y != Share::All || column == 0;
    Placed {
        panel,
        frame: Frame {
            left: 0.0,
            top: 0.0,
            width: 0.0,
            height,
        },
        x: Ruler::new(&panel.x, ranges[0], height, X_TICKS),
        ranges,
        y,
        x_shown,
        y_shown,
        y_room: if y_shown { widest + LINE + 8.0 } else { 0.0 },
    }
}

/// Gives the panels of a column the same room for their tick labels, where the rows are alike.
fn align_columns(rows: &mut [Vec<Placed<'_>>]) {
    let columns = rows.first().map_or(0, Vec::len);
    if rows.iter().any(|row| row.len() > columns) {
        return;
    }
    for column in 0..columns {
        let widest = rows
            .iter()
            .filter_map(|row| row.get(column))
            .map(|cell| cell.y_room)
            .fold(0.0, f64::max);
        for cell in rows.iter_mut().filter_map(|row| row.get_mut(column)) {
            cell.y_room = widest;
        }
    }
}

/// Gives the cells of a last, shorter row the columns of the first row; returns the height of the
/// row.
fn stand_below(row: &mut [Placed<'_>], first: &[Placed<'_>], top: f64, figure: &Figure) -> f64 {
    for (cell, above) in row.iter_mut().zip(first) {
        cell.frame = Frame { top, ..above.frame };
        cell.set_rulers();
    }
    first
        .first()
        .map_or(figure.row_height, |cell| cell.frame.height)
}

/// Spreads the cells of a row across the image; returns the height of the row.
///
/// Panels with equal axes are squares. The others divide what is left.
fn spread(row: &mut [Placed<'_>], top: f64, figure: &Figure) -> f64 {
    let columns = row.len() as f64;
    let squares = row.iter().filter(|cell| cell.panel.equal_axes).count() as f64;
    let rooms: f64 = row.iter().map(|cell| cell.y_room).sum();
    let free = (figure.width - 2.0 * EDGE - rooms - GAP * (columns - 1.0)).max(40.0 * columns);
    let height = if squares > 0.0 {
        figure.row_height.min(free / columns)
    } else {
        figure.row_height
    };
    let width = (free - height * squares) / (columns - squares).max(1.0);
    let mut left = EDGE;
    for cell in row {
        left += cell.y_room;
        let width = if cell.panel.equal_axes { height } else { width };
        cell.frame = Frame {
            left,
            top,
            width,
            height,
        };
        cell.set_rulers();
        left += width + GAP;
    }
    height
}

/// The range of the axis, from all panels that share it.
fn shared_range(
    figure: &Figure,
    panel: &Panel,
    column: usize,
    direction: Direction,
) -> Option<(f64, f64)> {
    let share = match direction {
        Direction::X => figure.share_x,
        Direction::Y => figure.share_y,
    };
    let panels: Vec<&Panel> = match share {
        Share::None => vec![panel],
        Share::Column => figure
            .rows
            .iter()
            .filter_map(|row| row.get(column))
            .collect(),
        Share::All => figure.rows.iter().flatten().collect(),
    };
    axis::range(&panels, direction)
}

/// About how wide the text is in a plain sans-serif face, rather too much than too little.
pub(super) fn text_width(text: &str, size: f64) -> f64 {
    let ems: f64 = text
        .chars()
        .map(|character| match character {
            'i' | 'j' | 'l' | '.' | ',' | ':' | '|' | '\'' | '\u{202f}' => 0.3,
            ' ' | '\u{a0}' | 't' | 'f' | 'r' | '(' | ')' | '⁻' | '¹' | '²' | '³' => 0.4,
            'm' | 'w' | 'M' | 'W' | '%' => 0.92,
            'A'..='Z' => 0.72,
            _ => 0.6,
        })
        .sum();
    ems * size
}
