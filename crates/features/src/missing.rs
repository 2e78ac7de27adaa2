//! Why features of a row have no value, in one line of text.

use crate::{Definition, Reason};

/// `column: reason` for every feature without a value, joined by `; `; none where all have one.
///
/// A channel all of whose features are missing for one reason is named once, without a feature:
/// `crosshead_acceleration: sample 17 is not a finite number`. `values` are in the order of
/// `definitions`.
pub fn missing(definitions: &[Definition], values: &[Result<f64, Reason>]) -> Option<String> {
    let row: Vec<_> = definitions.iter().zip(values).collect();
    let channels = row.chunk_by(|(a, _), (b, _)| channel(a) == channel(b));
    let parts: Vec<String> = channels.flat_map(of_channel).collect();
    (!parts.is_empty()).then(|| parts.join("; "))
}

fn of_channel(features: &[(&Definition, &Result<f64, Reason>)]) -> Vec<String> {
    let (first, value) = features[0];
    if let Err(reason) = value
        && features.iter().all(|(_, other)| *other == value)
    {
        return vec![format!("{}: {reason}", channel(first))];
    }
    let reasons = features.iter().filter_map(|(definition, value)| {
        let reason = value.as_ref().err()?;
        Some(format!("{}: {reason}", definition.name))
    });
    reasons.collect()
}

/// `throw1.crosshead_acceleration` of `throw1.crosshead_acceleration.rms_m_s2`.
fn channel(definition: &Definition) -> &str {
    let name = &definition.name;
    name.rsplit_once('.').map_or(name, |(channel, _)| channel)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::definitions;

    #[test]
    fn channels_and_features_say_why() {
        let definitions = definitions([("torque_n_m", "N m"), ("level", "")]);
        let mut values = vec![Ok(1.0); 20];
        assert_eq!(missing(&definitions, &values), None);
        values[4] = Err(Reason::Constant);
        values[10..].fill(Err(Reason::NoSpeed));
        assert_eq!(
            missing(&definitions, &values).unwrap(),
            "torque.crest_factor: the signal is constant; \
             level: neither speed nor crank angle is known"
        );
    }
}
