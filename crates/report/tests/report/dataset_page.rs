//! The page of a dataset stands alone, is bounded and takes nothing from the data for markup.

use crate::markup::markup;
use crate::synthetic::{self, datasets};
use recordings::FailedCase;
use report::dataset_page::{DatasetPage, Design};
use study::grid::JointSet;
use study::recording::{Response, Spectrum};

/// The largest page there may be.
const LARGEST: usize = 5_000_000;

/// The attributes and functions through which a page loads something.
fn loads_nothing(html: &str) {
    let places = markup(html).replace("xmlns=\"http://www.w3.org/2000/svg\"", "");
    for forbidden in [
        "http:", "https:", "src=", "url(", "@import", "<link", "<img", "<iframe",
    ] {
        assert!(!places.contains(forbidden), "{forbidden}");
    }
    for (at, _) in places.match_indices("href=\"") {
        let beside = ["#", "figures/dataset-", "chaos.html\"", "features.html\""];
        let target = &places[at + "href=\"".len()..];
        assert!(
            beside.iter().any(|to| target.starts_with(to)),
            "{}",
            &target[..40]
        );
    }
}

/// Every entry of the contents leads somewhere, and no identifier is there twice.
fn links_lead_somewhere(html: &str) {
    let after = |pattern: &str| -> Vec<String> {
        let parts = html.split(pattern).skip(1);
        parts
            .filter_map(|rest| rest.split('"').next())
            .map(str::to_owned)
            .collect()
    };
    let mut ids = after(" id=\"");
    for target in after("href=\"#") {
        assert!(ids.contains(&target), "#{target}");
    }
    let all = ids.len();
    ids.sort();
    ids.dedup();
    assert_eq!(ids.len(), all);
}

#[test]
fn both_kinds_of_page_stand_alone() {
    for page in [datasets::grid(), datasets::random()] {
        let html = page.render().unwrap().html;
        loads_nothing(&html);
        links_lead_somewhere(&html);
        assert!(html.len() < 2_200_000, "{} bytes", html.len());
        assert_eq!(html, page.render().unwrap().html);
        let figures = page.render().unwrap().figures;
        assert_eq!(figures.len(), html.matches("<figcaption>").count());
        for figure in figures {
            assert!(html.contains(&format!("figures/{}\"", figure.name)));
            roxmltree::Document::parse(&figure.svg).unwrap();
        }
    }
}

#[test]
fn a_grid_has_the_figures_of_the_study_and_says_what_they_show() {
    let html = datasets::grid().render().unwrap().html;
    for heading in [
        "Clearance in big end",
        "Clearance in small end",
        "Clearance in big end + small end",
        "Sets of joints at 0.3\u{a0}mm",
        "Portraits by clearance",
        "Portraits at 0.3\u{a0}mm",
    ] {
        assert!(html.contains(&format!("<h3>{heading}</h3>")), "{heading}");
    }
    assert!(html.contains("case-1, case-2, case-3 in signals/train-00000-of-00001.parquet"));
    // Four examples, three sets, three of all sets, and what the baseline confuses.
    assert_eq!(html.matches("<figcaption>").count(), 4 + 3 + 3 + 1);
}

#[test]
fn a_peak_that_falls_is_not_said_to_rise() {
    let mut page = datasets::grid();
    let Design::Grid(grids) = &mut page.design else {
        panic!("a grid")
    };
    let grid = &mut grids.grids[0];
    let levels = [(1e-4, 900.0), (3e-4, 500.0), (2e-4, 700.0)];
    grid.joint_sets = vec![JointSet {
        joints: "main".to_owned(),
        responses: levels
            .map(|(clearance, peak)| {
                let acceleration_m_s2 = vec![0.0, peak, 0.0];
                (
                    clearance,
                    Response {
                        acceleration_m_s2,
                        crank_angle_rad: vec![0.1, 0.2, 0.3],
                        ..Response::default()
                    },
                )
            })
            .into(),
    }];
    let html = page.render().unwrap().html;
    assert!(html.contains("the peak falls at every step from 900\u{a0}m/s² to 500\u{a0}m/s²"));
}

/// 82.3 to 82.3 is no rise, whatever the digits behind.
#[test]
fn a_peak_that_stays_is_not_said_to_rise() {
    let mut page = datasets::grid();
    let Design::Grid(grids) = &mut page.design else {
        panic!("a grid")
    };
    let levels = [(1e-4, 82.31), (2e-4, 82.33), (3e-4, 82.34)];
    let response = |peak: f64| Response {
        acceleration_m_s2: vec![0.0, peak, 0.0],
        crank_angle_rad: vec![0.1, 0.2, 0.3],
        ..Response::default()
    };
    grids.grids[0].joint_sets = vec![JointSet {
        joints: "main".to_owned(),
        responses: levels.map(|(c, peak)| (c, response(peak))).into(),
    }];
    let html = page.render().unwrap().html;
    assert!(!html.contains("rises at every step"));
    assert!(html.contains("the peak stays the same within its spread, 82.3\u{a0}m/s²"));
}

/// Every operating point has its figures and its levels, and what it is stands above them.
#[test]
fn all_operating_points_are_on_the_page() {
    let mut page = datasets::grid();
    let Design::Grid(grids) = &mut page.design else {
        panic!("a grid")
    };
    let mut other = grids.grids[0].clone();
    other.operating_point = "650 rpm".to_owned();
    grids.grids[0].settings = vec![("speed".to_owned(), "500 rpm".to_owned())];
    other.settings = vec![("speed".to_owned(), "650 rpm".to_owned())];
    grids.grids.push(other);
    let html = page.render().unwrap().html;
    links_lead_somewhere(&html);
    for said in [
        "<h2>Responses: 500 rpm</h2>",
        "<h2>Responses: 650 rpm</h2>",
        "<summary>650 rpm</summary>",
        "holds in 2 of 2, in part in 0, not in 0",
        "<td>650 rpm</td><td>holds (6 of 6)</td>",
    ] {
        assert!(html.contains(said), "{said}");
    }
}

/// A dataset that repeats no study is not held against one.
#[test]
fn claims_stand_on_the_page_of_the_study_alone() {
    let mut page = datasets::grid();
    assert!(page.render().unwrap().html.contains("id=\"claims\""));
    let Design::Grid(grids) = &mut page.design else {
        panic!("a grid")
    };
    grids.claims = false;
    let html = page.render().unwrap().html;
    assert!(!html.contains("study") || !html.contains("id=\"claims\""));
    assert!(html.contains("id=\"levels\""));
}

#[test]
fn random_cases_have_distributions_and_the_failed_one_its_reason() {
    let html = datasets::random().render().unwrap().html;
    assert!(html.contains("clearance of the big end (mm)"));
    assert!(html.contains("<h3>Rms of the acceleration against largest clearance</h3>"));
    assert!(
        html.contains("the step fell below 1e-14 s at t = 0.4321 s in the big end&#39;s contact")
    );
    assert!(!html.contains("Portraits by clearance"));
}

#[test]
fn levels_and_spectra_stand_over_the_speed_where_it_varies() {
    let html = datasets::random().render().unwrap().html;
    assert!(html.contains("<h3>Rms against speed</h3>"));
    assert!(html.contains("<h3>Waterfall over the speed, healthy</h3>"));
    // The greatest is order 1, 100 m/s², and four decades are two and a half distances of 50 rpm.
    let said = "rises by 125 rpm for amplitudes from 0.01 m/s² to 100 m/s², the greatest";
    assert!(html.replace('\u{a0}', " ").contains(said));
    assert!(
        !datasets::grid()
            .render()
            .unwrap()
            .html
            .contains("Waterfall")
    );
}

#[test]
fn a_baseline_stands_on_the_page_where_there_is_one() {
    let page = datasets::grid();
    let html = page.render().unwrap().html;
    assert!(html.contains("trained on 1200 windows") && html.contains("tested on 400"));
    assert!(html.contains("the right fault in 92.0\u{a0}% of these windows"));
    assert!(html.contains("<td class=\"n\">84.0\u{a0}%</td><td>small end</td>"));
    let without = DatasetPage {
        baseline: None,
        ..page
    };
    assert!(!without.render().unwrap().html.contains("baseline"));
}

#[test]
fn text_from_the_data_is_never_markup() {
    let hostile = "<script src='http://x'>&\"</script>".to_owned();
    let mut page = datasets::random();
    page.name.clone_from(&hostile);
    page.about.clone_from(&hostile);
    page.splits[0].clone_from(&hostile);
    page.channels[0].clone_from(&hostile);
    page.faults[1].fault.clone_from(&hostile);
    page.failed[0].reason.clone_from(&hostile);
    page.examples[1].fault.clone_from(&hostile);
    page.examples[1].response.file.clone_from(&hostile);
    page.columns[0].meaning.clone_from(&hostile);
    page.features[0].name.clone_from(&hostile);
    let html = page.render().unwrap().html;
    markup(&html);
}

#[test]
fn a_page_without_data_is_a_page() {
    let empty = DatasetPage {
        faults: Vec::new(),
        splits: Vec::new(),
        channels: Vec::new(),
        examples: Vec::new(),
        ranges: Vec::new(),
        features: Vec::new(),
        feature_rows: Vec::new(),
        columns: Vec::new(),
        sample_rate_hz: 0.0,
        samples_per_revolution: None,
        ..datasets::grid()
    };
    let mut none = empty.clone();
    if let Design::Grid(grids) = &mut none.design {
        let grid = &mut grids.grids[0];
        grid.ideal = None;
        grid.joint_sets = vec![JointSet {
            joints: String::new(),
            responses: vec![(f64::NAN, Response::default())],
        }];
    }
    for page in [empty, none] {
        links_lead_somewhere(&page.render().unwrap().html);
    }
}

#[test]
fn the_largest_dataset_has_a_page_of_bounded_size() {
    // Noise is the worst there is: no point of a line can be left out.
    let mut uniform = synthetic::Uniform(3);
    let mut noise = |n: usize| {
        (0..n)
            .map(|_| 1e3 * (uniform.next() - 0.5))
            .collect::<Vec<f64>>()
    };
    let samples = 24_000;
    let mut response = || Response {
        crank_angle_rad: (0..samples).map(|i| f64::from(i) * 5e-3).collect(),
        acceleration_m_s2: noise(samples as usize),
        velocity_m_s: noise(samples as usize),
        ..Response::default()
    };
    let mut page = datasets::grid();
    let mut example = page.examples[0].clone();
    example.response = response();
    let amplitude_m_s2: Vec<f64> = example
        .response
        .velocity_m_s
        .iter()
        .map(|v| v.abs())
        .collect();
    example.spectrum = Spectrum {
        at: (0..samples).map(f64::from).collect(),
        amplitude_m_s2,
        fundamental: 1.0,
    };
    example.order_spectrum = example.spectrum.clone();
    page.examples = vec![example; 64];
    page.failed = vec![
        FailedCase {
            case_id: "1".to_owned(),
            reason: "r".repeat(200),
            command: "c".repeat(100),
            died: false
        };
        100_000
    ];
    if let Design::Grid(grids) = &mut page.design {
        let grid = &mut grids.grids[0];
        grid.ideal = Some(response());
        let set = JointSet {
            joints: "main".to_owned(),
            responses: (1..=20)
                .map(|i| (f64::from(i) * 1e-5, response()))
                .collect(),
        };
        grid.joint_sets = vec![set; 15];
        grids.grids = vec![grids.grids[0].clone(); 2];
        grids.left_out = 1000;
    }
    let html = page.render().unwrap().html;
    assert!(html.len() < LARGEST, "{} bytes", html.len());
}
