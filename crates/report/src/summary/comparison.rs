//! Two recordings or datasets side by side.

use super::{NAMED, number};
use features::recorded::counted;
use sweep::comparison::{ComparedFeature, Comparison};

/// Both sides, and the features that differ most; a line each.
pub fn comparison(comparison: &Comparison) -> String {
    let sides = ["A", "B"].iter().zip(&comparison.sides);
    let sides = sides.map(|(name, side)| {
        let windows = counted(side.windows, "window");
        format!("{name}: {}, {windows}\n", side.name)
    });
    let features = comparison.most_different().into_iter().take(NAMED);
    sides.chain(features.map(line)).collect()
}

fn line(feature: &ComparedFeature) -> String {
    let unit = match feature.unit.as_str() {
        "1" => String::new(),
        unit => format!(" {}", text::unit(unit)),
    };
    let [a, b, ratio] = [feature.a, feature.b, feature.ratio].map(number);
    format!("  {}: {a} and {b}{unit}, ratio {ratio}\n", feature.name)
}
