//! The measured laser must come out as low-dimensional chaos.

use chaos::correlation_dimension::correlation_dimension;
use chaos::delay::times;
use chaos::exponent::exponent;
use chaos::neighbours::Delays;
use chaos::regime::{Regime, verdict};

#[test]
fn the_laser_is_low_dimensional_chaos() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../data/recordings/santafe-laser/santafe_laser.csv"
    );
    let text = std::fs::read_to_string(path).unwrap();
    let signal: Vec<f64> = text
        .lines()
        .skip(1)
        .take(4000)
        .map(|line| line.parse().unwrap())
        .collect();
    let times = times(&signal).unwrap();
    let found = verdict(&signal, &times).unwrap();
    assert_eq!(found.regime, Regime::Chaotic, "{found:?}");
    assert!(found.predictability.unwrap().significant, "{found:?}");
    // The map's tangents grow; a number is stated only where what else tells the exponent agrees on that.
    let exponent = exponent(&signal, &times).unwrap();
    assert_eq!(exponent.grows(), Some(true), "{exponent:?}");
    assert!(found.exponent.is_none_or(|e| e.low > 0.0), "{found:?}");
    let delays = Delays {
        signal: &signal,
        dimension: 6,
        delay: times.delay,
    };
    let dimension = correlation_dimension(&delays, times.theiler).unwrap();
    // The Lorenz-like attractor has a dimension slightly above 2; 8 bits blur it.
    assert!((1.5..3.5).contains(&dimension.value), "{dimension:?}");
}
