//! The picture of a case, with and without orbits.

use crate::synthetic;
use report::case_picture::{CasePicture, ClearJoint};
use roxmltree::Document;

fn texts(svg: &str) -> Vec<String> {
    let document = Document::parse(svg).unwrap();
    let texts = document
        .descendants()
        .filter(|node| node.has_tag_name("text"));
    texts
        .map(|node| node.text().unwrap_or_default().to_owned())
        .collect()
}

#[test]
fn the_picture_of_a_case_has_an_orbit_for_every_joint() {
    let recording = synthetic::recording(&[("big_end", 3e-4), ("small_end", 2e-4)], 6, 3);
    let svg = recording.picture("Two joints");
    let texts = texts(&svg);
    for expected in [
        "Two joints",
        "Big end orbit, clearance 0.3\u{a0}mm",
        "Small end orbit, clearance 0.2\u{a0}mm",
    ] {
        assert!(
            texts.iter().any(|text| text == expected),
            "{expected} in {texts:?}"
        );
    }
    let document = Document::parse(&svg).unwrap();
    assert_eq!(
        document
            .descendants()
            .filter(|node| node.has_tag_name("ellipse"))
            .count(),
        2
    );
    assert!(svg.len() < 200_000, "{} bytes", svg.len());
    assert_eq!(svg, recording.picture("Two joints"));
}

#[test]
fn the_picture_of_an_ideal_machine_says_that_it_has_no_orbit() {
    let svg = synthetic::recording(&[], 3, 1).picture("Ideal");
    assert!(texts(&svg).contains(&"ideal joints: no orbit".to_owned()));
}

#[test]
fn a_case_without_a_sample_has_a_picture() {
    let empty = CasePicture {
        title: "",
        crank_angle_rad: &[],
        acceleration_m_s2: &[],
        velocity_m_s: &[],
        joints: vec![ClearJoint {
            name: "",
            clearance_m: f64::NAN,
            x_m: &[],
            y_m: &[],
            contact_force_n: &[],
        }],
    };
    Document::parse(&empty.svg()).unwrap();
}
