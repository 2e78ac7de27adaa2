//! The page about chaos: every section, what it says where data are missing, and its numbers.

use crate::markup::markup;
use crate::synthetic::chaos;
use report::chaos_page::ChaosPage;
use study::chaos::cases::{CaseChaos, WindowChaos};
use study::chaos::regime::Regime;

/// The figures of an HTML page, as they stand in it.
fn embedded(html: &str) -> Vec<String> {
    let parts = html.split("<div class=\"image\"><svg").skip(1);
    let svg = parts.filter_map(|rest| rest.split("</div>").next());
    svg.map(|svg| format!("<svg{svg}")).collect()
}

#[test]
fn every_section_is_there_and_the_files_are_the_figures_of_the_page() {
    let page = chaos::page().render().unwrap();
    let embedded = embedded(&page.html);
    // Portraits, two sections, a diagram, exponents, scatter, two maps, two spectra, orbits.
    assert_eq!(embedded.len(), 1 + 2 + 1 + 2 + 2 + 2 + 1);
    assert_eq!(page.figures.len(), embedded.len());
    for (file, svg) in page.figures.iter().zip(&embedded) {
        // The page's own has values besides.
        assert!(
            svg.contains("class=\"plot\"") && !file.svg.contains("data-"),
            "{}",
            file.name
        );
        assert!(
            page.html
                .contains(&format!("href=\"figures/{}\"", file.name))
        );
        let document = roxmltree::Document::parse(&file.svg).unwrap();
        let root = document.root_element();
        assert!(root.attribute("width").is_some() && root.attribute("font-family").is_some());
    }
    assert!(!markup(&page.html).contains("class=\"missing\""));
    assert!(page.html.len() < 1_500_000, "{} bytes", page.html.len());
    let names: std::collections::BTreeSet<&str> =
        page.figures.iter().map(|file| file.name.as_str()).collect();
    assert_eq!(names.len(), page.figures.len());
}

#[test]
fn a_page_without_data_says_what_to_add() {
    let html = ChaosPage::default().render().unwrap().html;
    assert_eq!(html.matches("class=\"missing\"").count(), 7);
    assert!(html.contains("lyapunov: {revolutions: 200}"));
    assert!(html.contains("bifurcations"));
    assert_eq!(html.matches("<figcaption>").count(), 0);
}

/// Two windows: one interval holds the truth, the other signal abstains.
#[test]
fn the_numbers_of_the_table_and_of_the_scatter_are_those_of_the_cases() {
    let window = |exponent, reason: &str, regime| WindowChaos {
        exponent,
        reason: reason.to_owned(),
        regime: Some(regime),
    };
    let case = CaseChaos {
        operating_point: 0,
        case_id: "case-000007".to_owned(),
        joints: "big_end".to_owned(),
        clearance_m: 2e-4,
        speed_rpm: 500.0,
        exponent: Some([12.5, 0.25]),
        regime: Some(Regime::Chaotic),
        windows: vec![
            window(Some([11.0, 9.5, 13.0]), "", Regime::Chaotic),
            window(None, "no scaling region", Regime::Undecided),
        ],
    };
    let page = ChaosPage {
        cases: vec![case],
        ..ChaosPage::default()
    };
    let html = page.render().unwrap().html;
    for said in [
        "<td>case-000007</td><td>big end</td>",
        "12.50 ± 0.25",
        // Times 0.12 s.
        "1.500 ± 0.030",
        "11\u{a0}[9.5,\u{a0}13]; no scaling region",
        "chaotic; undecided",
        "Intervals that hold the exponent from the equations: 1 of 1 (100\u{a0}%)",
        "The signal gives no exponent for 1 of 2\u{a0}windows (no scaling region: 1)",
        "Chaotic by the equations are 1 of 1 with clearance in 1\u{a0}joint.",
    ] {
        assert!(html.contains(said), "{said}");
    }
}

#[test]
fn text_from_the_data_is_never_markup() {
    let hostile = "<script src='http://x'>&\"</script>".to_owned();
    let mut page = chaos::page();
    page.name.clone_from(&hostile);
    page.shown.clone_from(&hostile);
    page.motions[0].heading.clone_from(&hostile);
    page.bifurcations[0].name.clone_from(&hostile);
    page.bifurcations[0].reasons.push(hostile.clone());
    page.cases[0].joints.clone_from(&hostile);
    page.cases[0].windows[0].exponent = None;
    page.cases[0].windows[0].reason.clone_from(&hostile);
    page.spectra[0].class = hostile;
    let page = page.render().unwrap();
    markup(&page.html);
    assert!(page.figures.iter().all(|file| !file.name.contains('<')));
}

/// Thousands of cases and points, and values that cannot be drawn.
#[test]
fn the_largest_sweep_has_a_page_of_bounded_size() {
    let mut page = chaos::page();
    let case = CaseChaos {
        clearance_m: 1e-4,
        speed_rpm: f64::NAN,
        exponent: Some([f64::NAN, f64::INFINITY]),
        ..page.cases[0].clone()
    };
    let spread = |i: usize| CaseChaos {
        joints: format!("joint_{}", i % 40),
        clearance_m: 1e-4 + 1e-8 * i as f64,
        exponent: Some([(i as f64).sin(), 0.1]),
        speed_rpm: 300.0 + 0.01 * i as f64,
        ..page.cases[1].clone()
    };
    let cases = (0..6_000).map(spread).chain([case]).collect();
    page.cases = cases;
    let diagram = page.bifurcations[0].clone();
    page.bifurcations = vec![diagram; 3];
    for quantity in page
        .bifurcations
        .iter_mut()
        .flat_map(|diagram| &mut diagram.quantities)
    {
        let cloud = (0..60_000).map(|i| [f64::from(i % 500) * 1e-6, (f64::from(i) * 1.7).sin()]);
        quantity.up = cloud.collect();
        quantity.down.push([1e-4, f64::NAN]);
    }
    let html = page.render().unwrap().html;
    assert!(html.len() < 5_000_000, "{} bytes", html.len());
    assert!(html.contains("Shown are the first 200 of 6001"));
}
