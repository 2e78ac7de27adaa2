//! The page of a calibration: every section, its numbers, and what it says where data are missing.

use crate::markup::markup;
use crate::synthetic::calibration;
use calibrate::results::{Estimate, Results};
use report::calibration_page::{CalibrationPage, Channel, Misfit, Run};

#[test]
fn every_section_is_there_and_every_figure_is_well_formed() {
    let page = calibration::page().render().unwrap();
    // Misfits, intervals, correlations, two sets of clearances, a chamber, five runs.
    assert_eq!(page.figures.len(), 3 + 2 + 1 + 5);
    for file in &page.figures {
        roxmltree::Document::parse(&file.svg).unwrap();
    }
    assert_eq!(
        page.html.matches("class=\"image\"").count(),
        page.figures.len()
    );
    assert!(page.html.len() < 1_500_000, "{} bytes", page.html.len());
    for id in [
        "parameters",
        "unidentifiable",
        "correlations",
        "clearances",
        "sensors",
        "gas",
        "runs",
        "reading",
    ] {
        assert!(
            page.html.contains(&format!("<section id=\"{id}\">")),
            "{id}"
        );
        assert!(page.html.contains(&format!("href=\"#{id}\"")), "{id}");
    }
    assert!(!markup(&page.html).contains("class=\"missing\""));
}

#[test]
fn the_numbers_are_those_of_the_calibration() {
    let html = calibration::page().render().unwrap().html;
    for said in [
        "the misfit is 1.04 times the noise (before: 14)",
        "Big end contact stiffness: 21\u{a0}% below its nominal value, known to ±3\u{a0}%.",
        "Big end friction coefficient keeps its nominal value 0.05:",
        "big end contact stiffness and small end contact stiffness trade off (−0.94)",
        "<td class=\"n\">1.896 × 10¹⁰</td>",
        "<dd>5 of 6</dd>",
        "<td class=\"n\">24</td>",
        "run04 (held out)",
        "4.78\u{a0}m/s², 2\u{a0}% of the signal",
        "range not identifiable, assumed ±",
        "<td class=\"n\">465\u{a0}m/s²</td><td class=\"n\">615\u{a0}m/s²</td>",
        "62\u{a0}% of the squared difference is in the compression (250° to 290°), where the difference is 340\u{a0}kPa.",
        "A clearance of 10.0\u{a0}% of the stroke goes with exponents of 1.20 and 1.00",
        "<td>suction closes</td><td class=\"n\">250.0°</td><td class=\"n\">248.0° to 253.0°</td><td class=\"n\">180.0°</td><td class=\"n\">−70.0°</td>",
    ] {
        assert!(html.contains(said), "{said}");
    }
    let row = html.split("class=\"unidentifiable\"").nth(1).unwrap();
    assert!(row[..300].contains("not identifiable"));
}

/// Whatever the names and the numbers, the page is a page.
#[test]
fn empty_hostile_and_infinite_content_is_borne() {
    let empty = CalibrationPage::default().render().unwrap();
    assert!(
        empty
            .html
            .contains("No parameter is identifiable from the recordings.")
    );
    let estimate = Estimate {
        value: f64::NAN,
        low: Some(f64::NEG_INFINITY),
        high: Some(0.0),
        nominal: -1.0,
        identifiable: true,
        at_bound: false,
        bounds: [0.0; 2],
        logarithmic: false,
    };
    let hostile = CalibrationPage {
        name: "<b>&".into(),
        results: Results {
            parameters: [("a.<i>".to_owned(), estimate)].into_iter().collect(),
            ..Results::default()
        },
        runs: vec![Run {
            id: "<script>".into(),
            misfit: Misfit {
                before: f64::INFINITY,
                after: 0.0,
            },
            channels: vec![Channel::default()],
            ..Run::default()
        }],
        ..CalibrationPage::default()
    };
    let page = hostile.render().unwrap();
    assert!(!markup(&page.html).contains("<i>"));
    for file in &page.figures {
        roxmltree::Document::parse(&file.svg).unwrap();
    }
}
