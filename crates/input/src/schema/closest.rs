//! Which kind of file a tree is, by its keys.

use serde_json::Value;

/// The index of the schema that knows most of the keys at the top of `tree`; a key that fewer schemas know says more.
/// None where no schema knows any.
pub fn closest(tree: &Value, schemas: &[Value]) -> Option<usize> {
    let keys: Vec<&String> = tree.as_object()?.keys().collect();
    let knows = |schema: &Value, key: &str| schema["properties"].get(key).is_some();
    let known = |key: &str| schemas.iter().filter(|s| knows(s, key)).count() as f64;
    let score = |schema: &Value| {
        let known = keys
            .iter()
            .filter(|key| knows(schema, key))
            .map(|key| known(key));
        known.map(f64::recip).sum::<f64>()
    };
    let scores = schemas.iter().map(score).enumerate();
    let best = scores.reduce(|best, next| if next.1 > best.1 { next } else { best });
    best.filter(|(_, score)| *score > 0.0)
        .map(|(index, _)| index)
}
