//! What tells simulated windows from measured ones.

use super::{NAMED, number};
use classify::DomainGap;

/// How well a classifier tells them apart, and by which features; a line each.
pub fn domain_gap(gap: &DomainGap) -> String {
    let (auc, simulated, measured) = (gap.auc, gap.simulated, gap.measured);
    let head = format!(
        "area under the curve {auc:.3}: {simulated} simulated and {measured} measured windows\n"
    );
    let features = gap.features.iter().take(NAMED).map(|telling| {
        let (feature, loss, auc) = (&telling.feature, telling.loss, telling.auc);
        let [simulated, measured] = [telling.simulated, telling.measured].map(number);
        format!(
            "  {feature}: loss {loss:.3}, alone {auc:.3}, simulated {simulated}, measured {measured}\n"
        )
    });
    head + &features.collect::<String>()
}
