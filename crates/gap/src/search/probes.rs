//! Values at which a candidate is tried before it is fitted.

use crate::amendment::candidate::Candidate;
use crate::search::recorded_values::recorded_values;
use calibrate::Problem;
use std::f64::consts::TAU;

/// Amplitudes at which an effect is tried, over its usual one.
const AMPLITUDES: [f64; 3] = [0.2, 1.0, 5.0];
/// Steps from the first to the last of them for a clearance. A clearance that is a quarter off leaves more than
/// one that is absent.
const STEPS: usize = 12;
/// Values at which a parameter is tried that is no amplitude and may lie anywhere in wide bounds.
const VALUES: usize = 5;
/// Bounds this far apart are wide.
const WIDE: f64 = 15.0;

impl Candidate {
    /// Values at which it is tried: amplitudes, what else may lie anywhere, and what the recordings show by themselves.
    /// Waves are tried by their [`quadratures`](Self::quadratures).
    pub fn probes(&self, problem: &Problem) -> Vec<Vec<f64>> {
        let mut probes = match self.waves().is_empty() {
            true => self.item_probes(),
            false => Vec::new(),
        };
        probes.extend(recorded_values(self.entry, problem));
        let probes = probes.into_iter();
        probes.map(|probe| probe.repeat(self.sets())).collect()
    }

    /// The terms of its law that are waves, a cos(kα + φ): the indices of amplitude and phase among its values.
    fn waves(&self) -> Vec<[usize; 2]> {
        let count = self.entry.parameters.len();
        let of_item: Vec<[usize; 2]> = self
            .entry
            .waves()
            .filter(|[_, i]| self.is_free(*i))
            .collect();
        let of_set = |set: usize| {
            let waves = of_item.iter();
            waves.map(move |wave| wave.map(|index| index + set * count))
        };
        (0..self.sets()).flat_map(of_set).collect()
    }

    /// Each wave by itself at its usual size, at two phases a quarter of a period apart. What small waves change is a sum of
    /// what these do.
    pub fn quadratures(&self) -> Vec<Vec<f64>> {
        let count = 2 * self.waves().len();
        let alone = |only: usize| {
            let mut shares = vec![0.0; count];
            shares[only] = 1.0;
            self.combined(&shares)
        };
        (0..count).map(alone).collect()
    }

    /// The waves that have these shares of the [`quadratures`](Self::quadratures).
    pub fn combined(&self, shares: &[f64]) -> Vec<f64> {
        let mut values = self.usual();
        let parameter = |i: usize| &self.entry.parameters[i % self.entry.parameters.len()];
        for (wave, shares) in self.waves().iter().zip(shares.chunks_exact(2)) {
            let [amplitude, phase] = *wave;
            let [low, high] = parameter(amplitude).bounds;
            let usual = self
                .entry
                .usual_wave(amplitude % self.entry.parameters.len());
            let size = usual * shares[0].hypot(shares[1]);
            values[amplitude] = size.clamp(low, high);
            let [from, to] = parameter(phase).bounds;
            let turn = shares[1].atan2(shares[0]).rem_euclid(TAU) / TAU;
            values[phase] = from + (to - from) * turn;
        }
        values
    }

    /// Indices of the parameters that are the form of its law, but for its waves.
    fn shapes(&self) -> Vec<usize> {
        let waves = self.waves().concat();
        self.free()
            .filter(|i| self.entry.parameters[*i].shape && !waves.contains(i))
            .collect()
    }

    /// The form of its law at these values.
    pub fn form_at(&self, values: &[f64]) -> Vec<f64> {
        self.shapes().into_iter().map(|i| values[i]).collect()
    }

    /// These values with each part of the form of its law that is no wave in its other form, and with all of them.
    pub fn other_forms_of(&self, values: &[f64]) -> Vec<Vec<f64>> {
        let count = self.entry.parameters.len();
        let shapes = self.shapes();
        let with = |changed: &[usize]| {
            let mut probe = values.to_vec();
            for (i, value) in probe.iter_mut().enumerate() {
                if changed.contains(&(i % count)) {
                    *value = self.entry.parameters[i % count].other;
                }
            }
            probe
        };
        let mut forms: Vec<Vec<f64>> = shapes.iter().map(|i| with(&[*i])).collect();
        if shapes.len() > 1 {
            forms.push(with(&shapes));
        }
        forms
    }

    /// Whether what it changes is how much play there is, all around.
    fn is_clearance(&self) -> bool {
        let parameters = self.entry.parameters;
        let mut amplitudes = parameters.iter().filter(|p| p.absent.is_some());
        amplitudes.next().is_some_and(|p| p.unit == "m")
            && amplitudes.next().is_none()
            && !parameters.iter().any(|p| p.cyclic)
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
        // What one form does at its usual size takes many times that in another.
        let others = probes.iter().flat_map(|probe| self.other_forms_of(probe));
        let others: Vec<Vec<f64>> = others.collect();
        probes.extend(others);
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

    #[test]
    fn every_form_of_a_law_is_tried_at_every_amplitude() {
        let all = Candidate::all(&problem());
        let friction = all
            .iter()
            .find(|c| c.entry.name == "ring_friction")
            .unwrap();
        let probes = friction.probes(&problem());
        let usual = friction.form_at(&friction.usual());
        let sizes_of = |form: &[f64]| -> Vec<f64> {
            let of_form = probes
                .iter()
                .filter(|probe| friction.form_at(probe) == form);
            let shares = of_form.map(|probe| probe[0] / friction.usual()[0]);
            let mut sizes: Vec<f64> = shares.collect();
            sizes.sort_by(f64::total_cmp);
            sizes
        };
        let sizes = sizes_of(&usual);
        assert!(
            AMPLITUDES.iter().all(|size| sizes.contains(size)),
            "{sizes:?}"
        );
        let forms = friction.other_forms_of(&friction.usual());
        assert!(!forms.is_empty());
        for form in forms {
            assert_eq!(sizes_of(&friction.form_at(&form)), sizes, "{form:?}");
        }
    }
}
