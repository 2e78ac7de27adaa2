//! Clearances that are spread evenly over what they may be.

use super::joint::Joint;
use super::model::Model;

/// The least clearance, as a share of that from which the search of a joint leads: a joint may have less than is stated.
const LEAST: f64 = 0.67;
/// Share of the points in which a joint that is clear in the machine file has the clearance of that: most joints are not worn.
const HEALTHY: f64 = 1.0 / 3.0;

/// So many points of a model. Clearances lie anywhere up to the greatest, on a logarithmic scale, and what is known before within a
/// standard deviation of that. What else is unknown stays as in `x`.
pub(super) fn draws(model: &Model, joints: &[Joint], x: &[f64], count: usize) -> Vec<Vec<f64>> {
    let steps = steps(model.clear.len() + model.priors.len());
    let point = |number: usize| {
        // Its place along each coordinate, between 0 and 1.
        let mut places = steps
            .iter()
            .map(|step| (0.5 + number as f64 * step).fract());
        let mut x = x.to_vec();
        let clear = model.problem.parameters.iter().zip(&model.clear);
        for ((parameter, joint), (x, place)) in clear.zip(x.iter_mut().zip(&mut places)) {
            let joint = &joints[*joint];
            let healthy = joint.stated.map_or(0.0, |_| HEALTHY);
            if place >= healthy {
                let least = (LEAST * joint.start()).max(joint.bounds[0]);
                let [low, high] = [least, joint.bounds[1]].map(|c| parameter.coordinate(c));
                *x = low + (high - low) * (place - healthy) / (1.0 - healthy);
            }
        }
        for (prior, place) in model.priors.iter().zip(places) {
            x[prior.place] = prior.spread * (2.0 * place - 1.0);
        }
        x
    };
    (1..=count).map(point).collect()
}

/// Steps from point to point along each coordinate: powers of the generalised golden ratio, so that the points are spread evenly in
/// any number of dimensions (Roberts 2018, "The unreasonable effectiveness of quasirandom sequences").
fn steps(dimensions: usize) -> Vec<f64> {
    // The root of x^(d+1) = x + 1.
    let mut ratio = 2.0_f64;
    for _ in 0..64 {
        ratio = (1.0 + ratio).powf(1.0 / (dimensions as f64 + 1.0));
    }
    let powers = (1..=dimensions as i32).map(|power| ratio.powi(-power));
    powers.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_powers_of_the_generalised_golden_ratio() {
        let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
        assert!((steps(1)[0] - 1.0 / golden).abs() < 1e-15);
        // The plastic number, the root of x^3 = x + 1.
        let plastic = 1.324_717_957_244_746;
        assert!((steps(2)[0] - 1.0 / plastic).abs() < 1e-15);
        assert!((steps(2)[1] - 1.0 / (plastic * plastic)).abs() < 1e-15);
    }

    #[test]
    fn points_fill_every_part_of_a_square() {
        let steps = steps(2);
        let mut filled = [[0; 4]; 4];
        for number in 1..=64 {
            let [i, j] = [0, 1].map(|k| 4.0 * (0.5 + f64::from(number) * steps[k]).fract());
            filled[i as usize][j as usize] += 1;
        }
        for count in filled.concat() {
            assert!((2..=6).contains(&count), "{filled:?}");
        }
    }
}
