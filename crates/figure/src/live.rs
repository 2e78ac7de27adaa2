//! What a figure on a page carries for its script: its axes, its series and their values.

use super::axis::Ruler;
use super::layout::Placed;
use super::palette;
use super::panel::{Axis, Field};
use super::series::{Layer, Mark, Series};
use base64::prelude::{BASE64_STANDARD, Engine};
use text::escape;

/// The panel's title and axes: kind, lowest and highest value, label, and names or the fundamental.
pub(super) fn axes(cell: &Placed<'_>) -> String {
    let axis = |axis: &Axis, ruler: &Ruler| {
        let (low, high) = ruler.range();
        let kind = match axis.names.is_empty() {
            true => ruler.kind(),
            false => "names",
        };
        let names = axis.names.iter().map(|name| format!("|{}", escape(name)));
        let further = match axis.fundamental {
            Some(fundamental) => format!("|{fundamental}"),
            None => names.collect(),
        };
        format!("{kind}|{low}|{high}|{}{further}", escape(&axis.label))
    };
    format!(
        " class=\"plot\" data-title=\"{}\" data-x=\"{}\" data-y=\"{}\"",
        escape(&cell.panel.title),
        axis(&cell.panel.x, &cell.x),
        axis(&cell.panel.y, &cell.y)
    )
}

/// The place of a field and what stands in it.
pub(super) fn field(field: &Field) -> String {
    let [x, y] = field.at;
    format!(
        " data-field=\"{x}|{y}|{}\"{}",
        escape(&field.letters),
        layer(field.layer)
    )
}

/// The layer of a part of a panel; what is of a step is hidden until that is chosen.
pub(super) fn layer(layer: Layer) -> String {
    match layer {
        Layer::Always => String::new(),
        Layer::Ends => " data-layer=\"ends\"".to_owned(),
        Layer::Step(step) => format!(" data-layer=\"{step}\" style=\"display:none\""),
    }
}

/// What tells a series from the others of a figure, and joins it to its entry in the legend.
pub(super) fn name(series: &Series) -> String {
    format!("{}|{}", palette::hex(series.colour), escape(&series.label))
}

/// Name, mark and the values at the drawn vertices: pairs of little-endian 32-bit numbers in base 64, with
/// a pair of NaN between stretches.
pub(super) fn values(series: &Series, stretches: &[Vec<[f64; 2]>], cell: &Placed<'_>) -> String {
    let (width, height) = (cell.frame.width, cell.frame.height);
    let mut bytes = Vec::new();
    for (i, stretch) in stretches.iter().enumerate() {
        let interruption = (i > 0).then_some([f64::NAN; 2]);
        let values = stretch
            .iter()
            .map(|[x, y]| [cell.x.value(x / width), cell.y.value(1.0 - y / height)]);
        for number in interruption.into_iter().chain(values).flatten() {
            bytes.extend((number as f32).to_le_bytes());
        }
    }
    let mark = match series.mark {
        Mark::Points | Mark::Rings | Mark::Discs => "points",
        Mark::Dots | Mark::WideDots => "dots",
        Mark::Band => "band",
        Mark::Area => "area",
        Mark::FaintLine | Mark::HairLine | Mark::Line | Mark::BoldLine => "line",
    };
    // A straight line without a name is there for the eye.
    let guide = series.label.is_empty() && mark == "line" && series.points.len() <= 2;
    format!(
        " class=\"series\" data-series=\"{}\" data-mark=\"{mark}\"{}{} data-values=\"{}\"",
        name(series),
        layer(series.layer),
        if guide { " data-guide=\"\"" } else { "" },
        BASE64_STANDARD.encode(&bytes)
    )
}
