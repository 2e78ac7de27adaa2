//! Points and how they are drawn.

use super::colour::Colour;

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
    /// When it is shown.
    pub layer: Layer,
}

/// When a part of a panel is shown on a page that steps through models.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Layer {
    /// At all times.
    #[default]
    Always,
    /// While no step is chosen, and in files.
    Ends,
    /// At the step of this number alone; never in files.
    Step(usize),
}

impl Layer {
    /// Whether it is shown at a step alone.
    pub(super) fn is_of_step(self) -> bool {
        matches!(self, Self::Step(_))
    }
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

impl Mark {
    /// Whether the points stand by themselves, and are no line.
    pub(super) fn is_separate(self) -> bool {
        matches!(
            self,
            Self::Points | Self::Rings | Self::Discs | Self::Dots | Self::WideDots
        )
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
            layer: Layer::Always,
        }
    }

    /// The same series in a layer.
    pub fn in_layer(self, layer: Layer) -> Self {
        Self { layer, ..self }
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
