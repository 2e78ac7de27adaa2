//! Inner samples of what sensors see of a run, with the derivatives that its numbers carry.
//!
//! Where many instants lie within a step, the motion is evaluated at a few others, and a polynomial through these values gives
//! what the sensors see, each derivative judged like the value itself. Where a contact has just begun, the force's slope is
//! steep, and the motion is evaluated at each instant.

use crate::instants::Instants;
use crate::polynomial::{NODES, Nodes, Polynomial};
use crate::sensor::Sensor;
use integrate::{Real, Step};
use mechanism::{Dynamics, Evaluation};
use std::ops::Range;

/// Inner samples under way.
pub(crate) struct InnerSamples<'a, S> {
    sensors: &'a [Sensor],
    /// Those of each sensor.
    of_sensors: Vec<Vec<S>>,
    /// The largest magnitude of each part of the numbers that each sensor has seen.
    largest: Vec<Vec<f64>>,
    /// Of the integration.
    tolerance: f64,
    nodes: Nodes,
    /// Scratch.
    state: Vec<S>,
}

impl<'a, S: Real> InnerSamples<'a, S> {
    /// None yet, of a run that is integrated with this tolerance.
    pub fn new(sensors: &'a [Sensor], tolerance: f64) -> Self {
        Self {
            sensors,
            of_sensors: vec![Vec::new(); sensors.len()],
            largest: vec![vec![0.0; S::PARTS]; sensors.len()],
            tolerance,
            nodes: Nodes::new(),
            state: Vec::new(),
        }
    }

    /// Those of each sensor.
    pub fn end(self) -> Vec<Vec<S>> {
        self.of_sensors
    }

    /// Takes what the sensors see of an evaluation.
    pub fn push(&mut self, at: &Evaluation<S>) {
        for i in 0..self.sensors.len() {
            self.take(i, self.sensors[i].measured.unwrapped(at));
        }
    }

    /// Takes those at the instants of these numbers, which lie within a step that has its continuous extension.
    pub fn within(
        &mut self,
        dynamics: &mut Dynamics<S>,
        step: &Step<S>,
        instants: Instants,
        numbers: Range<usize>,
    ) {
        let at = |i: usize| S::constant(instants.at(i));
        if NODES < numbers.len()
            && let Some(polynomials) = self.polynomials(dynamics, step)
        {
            for i in numbers {
                let share = (at(i) - step.start) / step.length;
                for (sensor, polynomial) in polynomials.iter().enumerate() {
                    self.take(sensor, polynomial.at(share));
                }
            }
            return;
        }
        for i in numbers {
            let mut state = std::mem::take(&mut self.state);
            state.resize(step.from.len(), S::zero());
            step.interpolate((at(i) - step.start) / step.length, &mut state);
            self.push(dynamics.evaluate_sensed(at(i), &state));
            self.state = state;
        }
    }

    /// What each sensor sees within a step; none where a polynomial leaves out too much.
    fn polynomials(
        &mut self,
        dynamics: &mut Dynamics<S>,
        step: &Step<S>,
    ) -> Option<Vec<Polynomial<S>>> {
        let mut values = vec![[S::zero(); NODES]; self.sensors.len()];
        self.state.resize(step.from.len(), S::zero());
        for (node, share) in self.nodes.shares.into_iter().enumerate() {
            step.interpolate(S::constant(share), &mut self.state);
            let at = dynamics.evaluate_sensed(step.start + step.length * share, &self.state);
            for (values, sensor) in values.iter_mut().zip(self.sensors) {
                values[node] = sensor.measured.unwrapped(at);
            }
        }
        let all = values.iter().zip(&self.largest);
        let through =
            all.map(|(values, largest)| self.nodes.through(values, largest, self.tolerance));
        through.collect()
    }

    fn take(&mut self, sensor: usize, seen: S) {
        for (part, largest) in self.largest[sensor].iter_mut().enumerate() {
            *largest = largest.max(seen.part(part).abs());
        }
        self.of_sensors[sensor].push(self.sensors[sensor].measured.wrapped(seen));
    }
}
