//! The page that documents the features.

use report::Column;
use report::features_page::{FeatureEntry, FeatureGroup, FeaturesPage};

#[test]
fn every_entry_has_its_definition_formula_unit_and_source() {
    let page = FeaturesPage {
        name: "small".to_owned(),
        version: "0.1.0".to_owned(),
        groups: vec![FeatureGroup {
            heading: "Statistics".to_owned(),
            features: vec![FeatureEntry {
                name: "rms".to_owned(),
                columns: vec!["a.rms_m_s2".to_owned(), "p.rms_pa".to_owned()],
                units: vec!["m/s²".to_owned(), "Pa".to_owned(), String::new()],
                definition: "Root mean square, with the <mean>".to_owned(),
                formula: "√(Σx²/n)".to_owned(),
                source: "Lei & He 2008".to_owned(),
            }],
        }],
        columns: vec![Column {
            table: "features".to_owned(),
            name: "fault".to_owned(),
            kind: "string".to_owned(),
            unit: String::new(),
            meaning: "the joints".to_owned(),
        }],
    };
    let html = page.render().unwrap().html;
    for said in [
        "<h3><code>rms</code></h3>",
        "Root mean square, with the &#60;mean&#62;.",
        "√(Σx²/n)",
        "m/s², Pa, 1",
        "Lei &#38; He 2008",
        "<code>a.rms_m_s2</code>, <code>p.rms_pa</code>",
        "<td><code>fault</code></td><td>string</td>",
    ] {
        assert!(html.contains(said), "{said}");
    }
}
