//! Ranges and tick marks.

use super::panel::{Axis, Panel, Scale};
use super::series::Mark;

/// Room between the data and the frame, as a share of the range.
const MARGIN: f64 = 0.05;
/// A logarithmic axis shows at most this many decades below its highest value.
const DECADES: f64 = 8.0;
/// What is lower than this share of the lowest value of a logarithmic axis is drawn there.
const BELOW: f64 = 1e-3;
/// Values beyond this are not drawn: their differences would overflow.
const LARGEST: f64 = 1e300;
/// Ranges up to this are drawn as zero: their parts would underflow.
const SMALLEST: f64 = 1e-280;

/// One of the two axes of a panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Direction {
    X,
    Y,
}

impl Direction {
    fn coordinate(self, point: [f64; 2]) -> f64 {
        point[self as usize]
    }

    pub(super) fn axis(self, panel: &Panel) -> &Axis {
        match self {
            Self::X => &panel.x,
            Self::Y => &panel.y,
        }
    }
}

/// True for a value that can be drawn.
pub(super) fn drawable(value: f64) -> bool {
    value.abs() <= LARGEST
}

/// Gives all panels the range of x and y that shows the data of each, for figures that are drawn
/// apart and compared by eye.
pub fn share_ranges<'a>(panels: impl IntoIterator<Item = &'a mut Panel>) {
    let mut panels: Vec<&mut Panel> = panels.into_iter().collect();
    let all: Vec<&Panel> = panels.iter().map(|panel| &**panel).collect();
    let x = range(&all, Direction::X);
    let y = range(&all, Direction::Y);
    for panel in &mut panels {
        panel.x.range = x;
        panel.y.range = y;
    }
}

/// The range that shows all data of the panels. It is the given range of the first panel that has
/// one, otherwise that of the values, with a margin unless lines run straight across. None where
/// there is nothing to show.
pub(super) fn range(panels: &[&Panel], direction: Direction) -> Option<(f64, f64)> {
    let scale = direction.axis(panels.first()?).scale;
    if let Some(given) = panels.iter().find_map(|panel| direction.axis(panel).range) {
        return Some(usable(given, scale));
    }
    let values = panels.iter().flat_map(|panel| values(panel, direction));
    let (low, high) = values
        .filter(|&v| drawable(v) && (scale != Scale::Log || v > 0.0))
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
            (low.min(v), high.max(v))
        });
    if low > high {
        return None;
    }
    let (low, high) = usable((low, high), scale);
    if scale == Scale::Log {
        let room = (high / low).powf(MARGIN);
        return Some((low / room, high * room));
    }
    let series = || panels.iter().flat_map(|panel| &panel.series);
    let from_zero =
        direction == Direction::Y && low >= 0.0 && series().any(|s| s.mark == Mark::Area);
    let across = direction == Direction::X
        && series().all(|s| !s.mark.is_separate() && s.points.is_sorted_by(|a, b| a[0] <= b[0]));
    let room = if across { 0.0 } else { (high - low) * MARGIN };
    Some((if from_zero { 0.0 } else { low - room }, high + room))
}

/// Everything that the panel shows in this direction.
fn values(panel: &Panel, direction: Direction) -> impl Iterator<Item = f64> {
    let circles = panel.circles.iter().flat_map(move |circle| {
        let centre = direction.coordinate(circle.centre);
        [centre - circle.radius, centre + circle.radius]
    });
    let fields = panel.fields.iter().flat_map(move |field| {
        let middle = direction.coordinate(field.at);
        [middle - 0.5, middle + 0.5]
    });
    let shown = panel
        .series
        .iter()
        .filter(|series| !series.layer.is_of_step());
    let points = shown.flat_map(|series| &series.points);
    let points = points.map(move |&point| direction.coordinate(point));
    points.chain(circles).chain(fields)
}

/// The range, widened where it is a single value, upside down or not a number, and on a logarithmic
/// axis cut to what is positive.
fn usable((low, high): (f64, f64), scale: Scale) -> (f64, f64) {
    if !drawable(low) || !drawable(high) {
        return if scale == Scale::Log {
            (0.1, 1.0)
        } else {
            (0.0, 1.0)
        };
    }
    if scale == Scale::Log {
        let high = high.max(SMALLEST);
        let low = low.max(high * 10_f64.powf(-DECADES));
        return if high > low * 1.01 {
            (low, high)
        } else {
            (high / 2.0, high * 2.0)
        };
    }
    let size = low.abs().max(high.abs());
    if high - low > size * 1e-9 && size > SMALLEST {
        return (low, high);
    }
    let half = if size > SMALLEST { size * 0.05 } else { 0.5 };
    (low - half, low + half)
}

/// An axis with a range and a length: places values and has tick marks.
#[derive(Clone, Debug)]
pub(super) struct Ruler {
    scale: Scale,
    low: f64,
    high: f64,
    /// Label of the axis, with the power of ten of its tick labels.
    pub(super) label: String,
    /// Places from 0 (low) to 1 (high) of the tick marks, with what stands beside them.
    pub(super) ticks: Vec<(f64, String)>,
}

impl Ruler {
    /// A ruler over the range with a tick about every `spacing` of its `length` pixels; without
    /// ticks where there is no range.
    pub(super) fn new(axis: &Axis, range: Option<(f64, f64)>, length: f64, spacing: f64) -> Self {
        // Panels that share a range need not have the same scale.
        let (low, high) = usable(range.unwrap_or((f64::NAN, f64::NAN)), axis.scale);
        let label = axis.label.clone();
        let mut ruler = Self {
            scale: axis.scale,
            low,
            high,
            label,
            ticks: Vec::new(),
        };
        let count = (length / spacing).max(1.0);
        if !axis.names.is_empty() {
            ruler.ticks = axis
                .names
                .iter()
                .enumerate()
                .map(|(i, name)| (ruler.place(i as f64), name.clone()))
                .collect();
        } else if range.is_some() {
            ruler.set_ticks(count);
            // A panel too narrow for its spacing still has two numbers to read it by.
            if ruler.ticks.len() < 2 {
                ruler.set_ticks(2.0 * count);
            }
        }
        ruler
    }

    /// Where the value stands between the ends of the axis: 0 to 1, or beyond.
    pub(super) fn place(&self, value: f64) -> f64 {
        if self.scale == Scale::Log {
            let decades = |v: f64| (v / self.low).log10();
            return decades(value.max(self.low * BELOW)) / decades(self.high);
        }
        (value - self.low) / (self.high - self.low)
    }

    /// The value that stands at this place: the inverse of [`Ruler::place`].
    pub(super) fn value(&self, place: f64) -> f64 {
        match self.scale {
            Scale::Log => self.low * (self.high / self.low).powf(place),
            Scale::Linear | Scale::Degrees => self.low + place * (self.high - self.low),
        }
    }

    /// Lowest and highest value shown.
    pub(super) fn range(&self) -> (f64, f64) {
        (self.low, self.high)
    }

    /// How values are placed, as the script of a page calls it.
    pub(super) fn kind(&self) -> &'static str {
        match self.scale {
            Scale::Linear => "linear",
            Scale::Log => "log",
            Scale::Degrees => "degrees",
        }
    }

    /// About `count` ticks.
    fn set_ticks(&mut self, count: f64) {
        let (low, high) = (self.low, self.high);
        match self.scale {
            Scale::Degrees => self.steps(degree_step((high - low) / count)),
            Scale::Log if high >= 5.0 * low => self.powers(count),
            Scale::Linear | Scale::Log => self.steps(linear_step(high - low, count)),
        }
    }

    fn steps(&mut self, step: f64) {
        let slack = step * 1e-6;
        let first = ((self.low - slack) / step).ceil();
        let values: Vec<f64> = (0..200)
            .map(|i| (first + f64::from(i)) * step)
            .take_while(|&v| v <= self.high + slack)
            .collect();
        let largest = values
            .iter()
            .fold(0.0_f64, |largest, v| largest.max(v.abs()));
        let exponent = if largest >= 1e5 || (largest > 0.0 && largest < 1e-2) {
            3 * (largest.log10() / 3.0 + 1e-9).floor() as i32
        } else {
            0
        };
        let unit = 10_f64.powi(exponent);
        if exponent != 0 {
            self.label = scaled_label(&self.label, exponent);
        }
        let decimals = (0..12).find(|&d| {
            let shifted = step / unit * 10_f64.powi(d);
            (shifted - shifted.round()).abs() < 1e-6 * shifted.max(1.0)
        });
        let decimals = decimals.unwrap_or(3) as usize;
        self.ticks = values
            .iter()
            .map(|&v| (self.place(v), text::decimal(v / unit, decimals)))
            .collect();
    }

    /// Ticks at powers of ten, and at twice and five times these where there is room; as plain numbers
    /// if all are short ones.
    fn powers(&mut self, count: f64) {
        let (first, last) = (
            self.low.log10().floor() as i32,
            self.high.log10().ceil() as i32,
        );
        let stride = (f64::from(last - first) / count).ceil().max(1.0) as i32;
        let between: &[f64] = if 3.0 * (self.high / self.low).log10() <= count.max(6.0) {
            &[1.0, 2.0, 5.0]
        } else {
            &[1.0]
        };
        let plain = first >= -2 && last <= 4;
        let label = |factor: f64, exponent: i32| match plain || between.len() > 1 {
            true => text::number(factor * 10_f64.powi(exponent), 1),
            false => format!("10{}", text::superscript(exponent)),
        };
        let powers = (first..=last).filter(|exponent| exponent % stride == 0);
        let ticks =
            powers.flat_map(|exponent| between.iter().map(move |&factor| (factor, exponent)));
        let placed = ticks.map(|(factor, exponent)| {
            (
                self.place(factor * 10_f64.powi(exponent)),
                label(factor, exponent),
            )
        });
        self.ticks = placed
            .filter(|(at, _)| (-1e-9..=1.0 + 1e-9).contains(at))
            .collect();
    }
}

/// A round step that cuts the range into at most `count` parts, or a few more if that is too
/// coarse. It is then 250 instead of 500, but not 2.5 instead of 5, which is odd for counts.
fn linear_step(range: f64, count: f64) -> f64 {
    let step = round_step(range / count);
    let is_five = round_step(0.4 * step) < 0.5 * step;
    if is_five && step > 10.0 && range < 3.0 * step {
        return 0.5 * step;
    }
    step
}

/// The least of 1, 2, 5 times a power of ten that is at least `least`.
fn round_step(least: f64) -> f64 {
    let power = 10_f64.powf(least.log10().floor());
    [1.0, 2.0, 5.0]
        .into_iter()
        .map(|m| m * power)
        .find(|step| *step >= least * (1.0 - 1e-9))
        .unwrap_or(10.0 * power)
}

/// The least even part or multiple of a revolution that is at least `least` degrees.
fn degree_step(least: f64) -> f64 {
    [1.0, 5.0, 10.0, 15.0, 30.0, 45.0, 60.0, 90.0, 180.0]
        .into_iter()
        .find(|step| *step >= least)
        .unwrap_or_else(|| 360.0 * (least / 360.0).ceil())
}

/// The label with the power of ten in front of its unit: «force (10³ N)».
fn scaled_label(label: &str, exponent: i32) -> String {
    let power = format!("10{}", text::superscript(exponent));
    match label.rsplit_once('(') {
        Some((quantity, unit)) => format!("{quantity}({power} {unit}"),
        None => format!("{label} ({power})"),
    }
}

#[cfg(test)]
mod tests {
    use super::super::colour::Colour;
    use super::super::series::Series;
    use super::*;

    fn labels(axis: &Axis, range: (f64, f64), length: f64, spacing: f64) -> Vec<String> {
        Ruler::new(axis, Some(range), length, spacing)
            .ticks
            .into_iter()
            .map(|(_, label)| label)
            .collect()
    }

    #[test]
    fn ticks_stand_at_round_numbers() {
        let axis = Axis::linear("x");
        assert_eq!(
            labels(&axis, (-1.3, 2.2), 300.0, 60.0),
            ["−1", "0", "1", "2"]
        );
        assert_eq!(
            labels(&axis, (0.0, 0.09), 300.0, 60.0),
            ["0.00", "0.02", "0.04", "0.06", "0.08"]
        );
        assert_eq!(
            labels(&Axis::crank_angle(), (0.0, 360.0), 400.0, 45.0),
            ["0", "45", "90", "135", "180", "225", "270", "315", "360"]
        );
        assert_eq!(
            labels(&Axis::log("y"), (2e-4, 2e3), 200.0, 25.0),
            ["10⁻³", "10⁻²", "10⁻¹", "10⁰", "10¹", "10²", "10³"]
        );
    }

    #[test]
    fn steps_of_five_are_halved_where_few_fit() {
        assert_eq!(linear_step(1200.0, 4.0), 250.0);
        assert_eq!(linear_step(1600.0, 4.0), 500.0);
        assert_eq!(linear_step(700.0, 4.0), 200.0);
        assert_eq!(linear_step(9.0, 4.0), 5.0);
        assert_eq!(linear_step(120.0, 7.0), 20.0);
    }

    #[test]
    fn large_numbers_move_their_power_of_ten_to_the_label() {
        let ruler = Ruler::new(&Axis::linear("force (N)"), Some((0.0, 4.1e5)), 200.0, 50.0);
        assert_eq!(ruler.label, "force (10³ N)");
        assert_eq!(ruler.ticks[1].1, "200");
    }

    #[test]
    fn ranges_survive_what_cannot_be_drawn() {
        let panel = |points: Vec<[f64; 2]>| Panel {
            y: Axis::log("y"),
            series: vec![Series::new("", Colour::Ink, Mark::Line, points)],
            ..Panel::default()
        };
        let y = |points| range(&[&panel(points)], Direction::Y);
        assert_eq!(y(vec![]), None);
        assert_eq!(y(vec![[0.0, -1.0]]), None);
        let mixed = vec![
            [0.0, 0.0],
            [1.0, -3.0],
            [2.0, 1e-40],
            [3.0, f64::NAN],
            [4.0, 10.0],
        ];
        let (low, high) = y(mixed).unwrap();
        assert!(
            low > 1e-9 && low < 1e-7 && high > 10.0 && high < 100.0,
            "{low} to {high}"
        );
        let x = |points| range(&[&panel(points)], Direction::X);
        assert_eq!(
            x(vec![[5.0, 1.0], [5.0, f64::INFINITY]]),
            Some((4.75, 5.25))
        );
        assert_eq!(x(vec![[f64::MAX, 1.0], [-f64::MAX, 1.0]]), None);
    }
}
