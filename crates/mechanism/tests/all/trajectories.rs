//! Every trajectory of the independent reference, row by row, to 1e-6 of each channel's peak over
//! its reliable horizon.

use crate::common;

use common::{Run, reference, reference_file, reference_machine};
use mechanism::Direction;
use std::collections::BTreeMap;

/// Largest difference of each channel over its peak, up to the case's horizon.
fn differences(file: &str, case: &str, throw: usize) -> BTreeMap<String, f64> {
    let reference = reference();
    let horizon = reference[case]["horizon"]["horizon_s"]
        .as_f64()
        .unwrap_or(f64::INFINITY);
    let text = reference_file(file);
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let rows: Vec<Vec<f64>> = lines
        .map(|line| line.split(',').map(|v| v.parse().unwrap()).collect())
        .collect();

    let mut run = Run::start(
        reference_machine(&reference[case]["parameters"]),
        1e-12,
        false,
    );
    let mut largest = BTreeMap::new();
    for row in rows.iter().filter(|row| row[0] <= horizon) {
        run.advance(row[0]);
        let at = run.now().clone();
        let (part, joints) = (&at.throws[throw], &at.throws[throw].joints);
        // At a dead centre the gas may be on either side of its change.
        let dead_centre = (row[1] / std::f64::consts::PI)
            .fract()
            .min(1.0 - (row[1] / std::f64::consts::PI).fract())
            < 1e-6;
        // The reference mirrors an opposed throw in x, we turn it: y and the sense of rotation
        // change sign.
        let mirrored = run.dynamics.machine().throws[throw].direction == Direction::Opposed;
        let hand = if mirrored { -1.0 } else { 1.0 };
        for (name, expected) in names.iter().zip(row) {
            let ours = match *name {
                "xs" => part.motion.crosshead,
                "vs" => part.motion.crosshead_rate,
                "e_big_x" => joints.big_end.offset.x,
                "e_big_y" => hand * joints.big_end.offset.y,
                "e_small_x" => joints.small_end.offset.x,
                "e_small_y" => hand * joints.small_end.offset.y,
                "fn_big" => joints.big_end.normal_force,
                "fn_small" => joints.small_end.normal_force,
                "ft_big" => hand * joints.big_end.friction_force,
                "ft_small" => hand * joints.small_end.friction_force,
                "theta" => at.angle,
                "dtheta" => at.speed,
                _ if dead_centre => continue,
                "as" => part.accelerations.crosshead,
                "ddtheta" => at.shaft.angular,
                "p" => part.gas.head_end.pressure,
                "p_crank_end" => part.gas.crank_end.pressure,
                _ => continue,
            };
            let difference: &mut f64 = largest.entry((*name).to_owned()).or_insert(0.0);
            *difference = difference.max((ours - expected).abs());
        }
    }
    for (column, name) in names.iter().enumerate() {
        if let Some(difference) = largest.get_mut(*name) {
            let peak = rows.iter().map(|row| row[column].abs()).fold(0.0, f64::max);
            *difference /= if peak > 0.0 { peak } else { 1.0 };
        }
    }
    largest
}

fn check(file: &str, case: &str, throw: usize) {
    let differences = differences(file, case, throw);
    eprintln!("{file}:");
    for (name, difference) in &differences {
        eprintln!("  {name:12} {difference:.1e}");
    }
    for (name, difference) in &differences {
        assert!(*difference < 1e-6, "{file} {name}: {difference:e}");
    }
}

macro_rules! cases {
    ($($name:ident: $file:literal, $case:literal, $throw:literal;)*) => {
        $( #[test] fn $name() { check($file, $case, $throw); } )*
    };
}

cases! {
    big_01mm: "big_01mm.csv", "big_01mm", 0;
    big_02mm: "big_02mm.csv", "big_02mm", 0;
    big_03mm: "big_03mm.csv", "big_03mm", 0;
    small_01mm: "small_01mm.csv", "small_01mm", 0;
    small_02mm: "small_02mm.csv", "small_02mm", 0;
    small_03mm: "small_03mm.csv", "small_03mm", 0;
    both_01mm: "both_01mm.csv", "both_01mm", 0;
    both_02mm: "both_02mm.csv", "both_02mm", 0;
    both_03mm: "both_03mm.csv", "both_03mm", 0;
    light_small_03mm: "light_small_03mm.csv", "light_small_03mm", 0;
    light_both_01mm: "light_both_01mm.csv", "light_both_01mm", 0;
    light_both_03mm: "light_both_03mm.csv", "light_both_03mm", 0;
    free_both_02mm: "free_both_02mm.csv", "free_both_02mm", 0;
    two_stage_throw1: "two_stage_throw1.csv", "two_stage", 0;
    two_stage_throw2: "two_stage_throw2.csv", "two_stage", 1;
}
