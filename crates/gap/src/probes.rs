//! Values at which a candidate is tried before it is fitted.

use crate::candidate::Candidate;
use crate::recorded_values::recorded_values;
use calibrate::Problem;

/// Amplitudes at which an effect is tried, over its usual one.
const AMPLITUDES: [f64; 3] = [0.2, 1.0, 5.0];
/// Steps from the first to the last of them for a clearance. A clearance that is a quarter off leaves more than
/// one that is absent.
const STEPS: usize = 12;
/// Values at which a parameter is tried that is no amplitude and may lie anywhere in wide bounds.
const VALUES: usize = 5;
/// Bounds this far apart are wide.
const WIDE: f64 = 15.0;
/// Phases at which an effect is tried.
const PHASES: usize = 4;

impl Candidate {
    /// Values at which it is tried: amplitudes, phases, what else may lie anywhere, and what the
    /// recordings show by themselves.
    pub fn probes(&self, problem: &Problem) -> Vec<Vec<f64>> {
        let items = self.sets();
        let mut probes = self.item_probes();
        probes.extend(recorded_values(self.entry, problem));
        let probes = probes.into_iter();
        probes.map(|probe| probe.repeat(items)).collect()
    }

    /// Whether what it changes is how much play there is, all around.
    fn is_clearance(&self) -> bool {
        let parameters = self.entry.parameters;
        let mut amplitudes = parameters.iter().filter(|p| p.absent.is_some());
        amplitudes.next().is_some_and(|p| p.unit == "m")
            && amplitudes.next().is_none()
            && !parameters.iter().any(|p| p.cyclic)
    }

    /// The usual effect with each part of the form of its law at its other end, and with all of them.
    fn other_forms(&self, usual: &[f64]) -> Vec<Vec<f64>> {
        let parameters = self.entry.parameters;
        let shapes: Vec<usize> = (0..parameters.len())
            .filter(|i| parameters[*i].shape && !parameters[*i].cyclic)
            .collect();
        let with = |changed: &[usize]| {
            let mut probe = usual.to_vec();
            for i in changed {
                let [low, high] = parameters[*i].bounds;
                probe[*i] = if parameters[*i].start == low {
                    high
                } else {
                    low
                };
            }
            probe
        };
        let mut forms: Vec<Vec<f64>> = shapes.iter().map(|i| with(&[*i])).collect();
        if shapes.len() > 1 {
            forms.push(with(&shapes));
        }
        forms
    }

    fn item_probes(&self) -> Vec<Vec<f64>> {
        let parameters = self.entry.parameters;
        let usual: Vec<f64> = parameters.iter().map(|p| p.start).collect();
        let clamp = |i: usize, x: f64| x.clamp(parameters[i].bounds[0], parameters[i].bounds[1]);
        let mut probes = vec![usual.clone()];
        if parameters.iter().any(|p| p.absent.is_some()) {
            let amplitude = |share: f64| {
                let scaled = |(i, p): (usize, &f64)| match parameters[i].absent {
                    Some(absent) => clamp(i, absent + share * (p - absent)),
                    None => *p,
                };
                usual.iter().enumerate().map(scaled).collect::<Vec<f64>>()
            };
            let signed = parameters
                .iter()
                .any(|p| p.absent.is_some_and(|a| a > p.bounds[0]));
            let shares = match self.is_clearance() {
                true => {
                    let [first, .., last] = AMPLITUDES;
                    let step = |k: usize| first * (last / first).powf(k as f64 / STEPS as f64);
                    (0..=STEPS).map(step).collect()
                }
                false => AMPLITUDES.to_vec(),
            };
            probes = shares.iter().map(|share| amplitude(*share)).collect();
            if signed {
                probes.extend(shares.iter().map(|share| amplitude(-share)));
            }
        }
        probes.extend(self.other_forms(&usual));
        // What may lie anywhere is varied by itself.
        for (i, parameter) in parameters.iter().enumerate() {
            let [low, high] = parameter.bounds;
            let other = parameter.absent.is_some() || parameter.cyclic || parameter.whole;
            if !other && low > 0.0 && high / low > WIDE {
                probes.extend((0..VALUES).map(|k| {
                    let share = (k as f64 + 0.5) / VALUES as f64;
                    let mut probe = usual.clone();
                    probe[i] = low * (high / low).powf(share);
                    probe
                }));
            }
        }
        // The phases of the gas turn together; what they are to each other is left to the fit.
        let cyclic: Vec<usize> = (0..parameters.len())
            .filter(|i| parameters[*i].cyclic)
            .collect();
        if !cyclic.is_empty() {
            let together = self.is_of_gas();
            let turned = |probe: &Vec<f64>, k: usize| {
                let mut probe = probe.clone();
                let mut k = k;
                for i in &cyclic {
                    let [low, high] = parameters[*i].bounds;
                    probe[*i] = low + (high - low) * (k % PHASES) as f64 / PHASES as f64;
                    k /= if together { 1 } else { PHASES };
                }
                probe
            };
            let free = if together { 1 } else { cyclic.len() as u32 };
            let each = probes
                .iter()
                .flat_map(|p| (0..PHASES.pow(free)).map(move |k| turned(p, k)));
            probes = each.collect();
        }
        probes
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::problem;
    use input::effects::CATALOGUE;

    #[test]
    fn clearances_are_tried_in_small_steps() {
        let all = Candidate::all(&problem());
        let clearances: Vec<&str> = CATALOGUE
            .iter()
            .filter(|entry| all.iter().any(|c| c.entry == *entry && c.is_clearance()))
            .map(|entry| entry.name)
            .collect();
        let expected = ["guide_clearance", "extra_clearance", "thermal_clearance"];
        assert_eq!(clearances, expected);
        let extra = all.iter().find(|c| c.entry.name == "extra_clearance");
        let mut probes = extra.unwrap().probes(&problem());
        probes.sort_by(|a, b| a[0].total_cmp(&b[0]));
        for pair in probes.windows(2) {
            assert!(pair[1][0] / pair[0][0] < 1.35, "{pair:?}");
        }
        assert!(probes[0][0] < 1.1e-5 && probes.last().unwrap()[0] > 2.4e-4);
    }
}
