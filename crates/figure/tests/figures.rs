//! Every figure is well-formed, small and the same each time, whatever it is given.

use figure::{Axis, Circle, Colour, Figure, Mark, Panel, Series, Share, in_rows};
use roxmltree::Document;

const HOSTILE: &str = "</text><script>alert('&')</script>\u{0}\"";

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
fn equal_axes_give_a_circle_and_no_other_shape() {
    let circles = vec![Circle {
        centre: [3.0, -2.0],
        radius: 5.0,
    }];
    let flat = Series::new("", Colour::Ink, Mark::Line, [[-20.0, 0.0], [20.0, 1.0]]);
    let panel = Panel {
        circles,
        series: vec![flat],
        equal_axes: true,
        ..Panel::default()
    };
    let svg = Figure {
        rows: vec![vec![Panel::default(), panel]],
        ..Figure::default()
    }
    .svg();
    let document = Document::parse(&svg).unwrap();
    let circle = document
        .descendants()
        .find(|node| node.has_tag_name("ellipse"))
        .unwrap();
    assert_eq!(circle.attribute("rx"), circle.attribute("ry"));
}

#[test]
fn panels_that_share_their_axes_have_the_same_ticks_written_once() {
    let panel = |scale: f64| Panel {
        y: Axis::linear("y"),
        series: vec![Series::new(
            "",
            Colour::Class(0),
            Mark::Line,
            [[0.0, -scale], [1.0, scale]],
        )],
        ..Panel::default()
    };
    let figure = |share| Figure {
        rows: in_rows(vec![panel(1.0), panel(50.0), panel(3.0), panel(4.0)], 2),
        share_x: share,
        share_y: share,
        ..Figure::default()
    };
    let forties = |figure: Figure| {
        texts(&figure.svg())
            .iter()
            .filter(|text| *text == "40")
            .count()
    };
    // One label per row and axis column, and only for the panel that needs it if not shared.
    assert_eq!(forties(figure(Share::All)), 2);
    assert_eq!(forties(figure(Share::None)), 1);
    let grid = figure(Share::All).svg();
    assert_eq!(texts(&grid).iter().filter(|text| *text == "0.4").count(), 2);
}

#[test]
fn what_lies_outside_the_axes_or_is_not_a_number_does_no_harm() {
    let wild = [
        f64::NAN,
        f64::INFINITY,
        -f64::MAX,
        f64::MAX,
        0.0,
        -1.0,
        1e-320,
        3.0,
    ];
    let points: Vec<[f64; 2]> = wild.iter().flat_map(|&x| wild.map(|y| [x, y])).collect();
    let mut panels = Vec::new();
    for mark in [
        Mark::FaintLine,
        Mark::Line,
        Mark::BoldLine,
        Mark::Points,
        Mark::Area,
    ] {
        for range in [
            None,
            Some((1.0, 1.0)),
            Some((5.0, -5.0)),
            Some((f64::NAN, 1.0)),
            Some((0.0, 1e-310)),
        ] {
            for axis in [Axis::linear("(a) (b"), Axis::log("b"), Axis::crank_angle()] {
                let axis = Axis { range, ..axis };
                let series = vec![Series::new(
                    "s",
                    Colour::Ordered(f64::NAN),
                    mark,
                    points.clone(),
                )];
                let circles = vec![Circle {
                    centre: [f64::NAN, 0.0],
                    radius: f64::MAX,
                }];
                let equal_axes = mark == Mark::Line;
                panels.push(Panel {
                    x: axis.clone(),
                    y: axis,
                    series,
                    circles,
                    equal_axes,
                    ..Panel::default()
                });
            }
        }
    }
    for (width, row_height) in [(960.0, 200.0), (10.0, 1.0)] {
        for share in [Share::None, Share::Column, Share::All] {
            let rows = in_rows(panels.clone(), 7);
            let svg = Figure {
                rows,
                width,
                row_height,
                share_x: share,
                share_y: share,
                ..Figure::default()
            }
            .svg();
            Document::parse(&svg).unwrap();
            assert!(!svg.contains("NaN") && !svg.contains("inf"));
        }
    }
    Document::parse(&Figure::default().svg()).unwrap();
    Document::parse(
        &Figure {
            rows: vec![vec![], vec![Panel::default()]],
            ..Figure::default()
        }
        .svg(),
    )
    .unwrap();
}

#[test]
fn names_are_text_and_never_markup() {
    let series = vec![Series::new(
        HOSTILE,
        Colour::Class(9),
        Mark::Points,
        [[0.0, 1.0]],
    )];
    let axis = || Axis::linear(HOSTILE);
    let panel = Panel {
        title: HOSTILE.to_owned(),
        x: axis(),
        y: axis(),
        series,
        note: HOSTILE.to_owned(),
        ..Panel::default()
    };
    let svg = Figure {
        title: HOSTILE.to_owned(),
        rows: vec![vec![panel]],
        ..Figure::default()
    }
    .svg();
    let document = Document::parse(&svg).unwrap();
    assert!(
        !document
            .descendants()
            .any(|node| node.has_tag_name("script"))
    );
    assert!(
        texts(&svg)
            .iter()
            .filter(|text| text.contains("<script>"))
            .count()
            >= 5
    );
}
