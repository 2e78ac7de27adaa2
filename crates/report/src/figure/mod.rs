//! Line, point and area plots in a stack of rows, as one SVG image.
//!
//! A [`Figure`] holds rows of [`Panel`]s, a panel holds [`Series`] on two axes. Nothing here knows
//! what is plotted. The image is meant for a white page, on a screen or printed: the palette is safe for
//! colour-blind readers, text is text, and no line has more vertices than the pixels can show.
//! A figure carries no identifiers, styles or scripts, so many can stand in one HTML page.

mod axis;
mod decimate;
mod draw;
mod layout;
mod palette;

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

/// One pair of axes and what is drawn on them.
#[derive(Clone, Debug, Default)]
pub struct Panel {
    /// Heading of the panel; empty for none.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// What is drawn, the first at the back.
    pub series: Vec<Series>,
    /// One unit is as long on x as on y, and the plotting area is a square.
    pub equal_axes: bool,
    /// Circles drawn under the series, for instance the clearance circle of a bearing.
    pub circles: Vec<Circle>,
    /// Fields of a map, drawn under the series.
    pub fields: Vec<Field>,
    /// A remark in the middle of the panel, for a panel that has nothing to show.
    pub note: String,
}

/// What an axis measures.
#[derive(Clone, Debug, Default)]
pub struct Axis {
    /// Quantity with its unit in parentheses: `acceleration (m/s²)`.
    pub label: String,
    /// How values are placed.
    pub scale: Scale,
    /// Lowest and highest value shown; taken from the data where it is missing.
    pub range: Option<(f64, f64)>,
    /// What stands at 0, 1, 2, … in place of numbers; none on an axis of numbers.
    pub names: Vec<String>,
}

/// How values are placed along an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scale {
    /// In proportion.
    #[default]
    Linear,
    /// In proportion to the logarithm. What is zero or negative is drawn at the lower edge.
    Log,
    /// In proportion, in degrees, with ticks at fractions of a revolution.
    Degrees,
}

/// A sequence of points and how it is drawn.
#[derive(Clone, Debug)]
pub struct Series {
    /// Name in the legend; empty for none. Series of one name and colour have one entry.
    pub label: String,
    /// Its colour.
    pub colour: Colour,
    /// How it is drawn.
    pub mark: Mark,
    /// Points (x, y). One that is not finite interrupts a line.
    pub points: Vec<[f64; 2]>,
}

/// How a series is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// A light line, for one of many.
    FaintLine,
    /// A thin line, for many turns in a small panel.
    HairLine,
    /// A line.
    Line,
    /// A heavy line, for the one that counts.
    BoldLine,
    /// Separate points.
    Points,
    /// Separate open circles, for estimates beside [`Mark::Points`].
    Rings,
    /// Separate discs as wide as [`Mark::Rings`], for a few.
    Discs,
    /// Separate dots of two pixels, for thousands.
    Dots,
    /// Separate dots twice as wide and light, to show under [`Mark::Dots`].
    WideDots,
    /// The area that the line through all points encloses, for instance between two quartiles.
    Band,
    /// The area between the points and the lower edge of the panel.
    Area,
}

/// Where a colour comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Colour {
    /// One of a set of classes: equal numbers look alike in every figure.
    Class(usize),
    /// A place between the lowest (0) and the highest (1) of an ordered quantity.
    Ordered(f64),
    /// A fill from light grey (0) to dark (1) that also reads in grey.
    Tint(f64),
    /// Dark grey, for a reference.
    Ink,
}

/// A square of a map, one unit wide and high, with a few letters in it.
#[derive(Clone, Debug)]
pub struct Field {
    /// Its middle.
    pub at: [f64; 2],
    /// Its fill, a [`Colour::Tint`].
    pub fill: Colour,
    /// What stands in it.
    pub letters: String,
}

/// A circle in the units of the axes.
#[derive(Clone, Copy, Debug)]
pub struct Circle {
    /// Centre.
    pub centre: [f64; 2],
    /// Radius.
    pub radius: f64,
}

impl Mark {
    /// Whether the points stand by themselves, and are no line.
    fn is_separate(self) -> bool {
        matches!(
            self,
            Self::Points | Self::Rings | Self::Discs | Self::Dots | Self::WideDots
        )
    }
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

impl Figure {
    /// The image as an `<svg>` element that stands alone or inside an HTML page.
    pub fn svg(&self) -> String {
        draw::figure(self)
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

/// Gives all panels the range of x and y that shows the data of each, for figures that are drawn
/// apart and compared by eye.
pub fn share_ranges<'a>(panels: impl IntoIterator<Item = &'a mut Panel>) {
    let mut panels: Vec<&mut Panel> = panels.into_iter().collect();
    let all: Vec<&Panel> = panels.iter().map(|panel| &**panel).collect();
    let x = axis::range(&all, axis::Direction::X);
    let y = axis::range(&all, axis::Direction::Y);
    for panel in &mut panels {
        panel.x.range = x;
        panel.y.range = y;
    }
}

impl Axis {
    /// A linear axis over the range of the data.
    pub fn linear(label: impl Into<String>) -> Self {
        Self {
            label: label.into(),
            ..Self::default()
        }
    }

    /// A logarithmic axis over the range of the data.
    pub fn log(label: impl Into<String>) -> Self {
        Self {
            label: label.into(),
            scale: Scale::Log,
            ..Self::default()
        }
    }

    /// An axis of names, at 0, 1, 2, …
    pub fn named(label: impl Into<String>, names: Vec<String>) -> Self {
        Self {
            label: label.into(),
            range: Some((-0.5, names.len().max(1) as f64 - 0.5)),
            names,
            ..Self::default()
        }
    }

    /// The crank angle over one revolution, in degrees.
    pub fn crank_angle() -> Self {
        Self {
            label: "crank angle (°)".to_owned(),
            scale: Scale::Degrees,
            range: Some((0.0, 360.0)),
            ..Self::default()
        }
    }
}

impl Series {
    /// A series of points (x, y).
    pub fn new(
        label: impl Into<String>,
        colour: Colour,
        mark: Mark,
        points: impl IntoIterator<Item = [f64; 2]>,
    ) -> Self {
        Self {
            label: label.into(),
            colour,
            mark,
            points: points.into_iter().collect(),
        }
    }

    /// Upright bars from low to high at each place, for intervals: (x, low, high).
    pub fn intervals(colour: Colour, bars: impl IntoIterator<Item = [f64; 3]>) -> Self {
        let ends = bars
            .into_iter()
            .flat_map(|[x, low, high]| [[x, low], [x, high], [f64::NAN; 2]]);
        Self::new("", colour, Mark::Line, ends)
    }

    /// The outline of a histogram: `counts[i]` cases lie between `edges[i]` and `edges[i + 1]`.
    pub fn histogram(
        label: impl Into<String>,
        colour: Colour,
        edges: &[f64],
        counts: &[usize],
    ) -> Self {
        let steps = edges
            .windows(2)
            .zip(counts)
            .flat_map(|(edge, &n)| [[edge[0], n as f64], [edge[1], n as f64]]);
        Self::new(label, colour, Mark::Area, steps)
    }
}
