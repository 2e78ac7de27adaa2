//! The committed JSON Schema is the one that the program gives.

use serde_json::Value;
use std::path::Path;

#[test]
fn the_committed_schema_is_current() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let committed = std::fs::read_to_string(root.join("data/schema/hidden-effects.schema.json"));
    let committed: Value = serde_json::from_str(&committed.unwrap_or_default()).unwrap_or_default();
    assert!(
        committed == bench::settings::schema(),
        "data/schema/hidden-effects.schema.json is stale; refresh it with\n    \
         cargo run --bin crosshead -- schema hidden-effects > data/schema/hidden-effects.schema.json"
    );
}
