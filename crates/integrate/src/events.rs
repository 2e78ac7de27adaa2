//! Finding the first guard that crosses zero inside a step.

use crate::dop853::Step;
use crate::system::{Real, System};

/// Shares of the step at which the guards are looked at, beside its beginning and end.
const LOOKS: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// Share of the step over which a guard's slope is taken.
const NEARBY: f64 = 1e-3;

/// Looks at ever smaller shares before a guard counts as overdue: the last is at 4^−13.
const EARLY_LOOKS: usize = 12;

/// A guard that crossed zero, and where in the step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing {
    pub guard: usize,
    /// Share of the step, 0 to 1.
    pub share: f64,
}

/// Scratch for looking into steps.
#[derive(Clone, Debug)]
pub(crate) struct Finder<S> {
    state: Vec<S>,
    guards: Vec<S>,
    /// Guards at each of `LOOKS`.
    looks: Vec<Vec<f64>>,
}

impl<S: Real> Finder<S> {
    pub fn new(dimension: usize, guards: usize) -> Self {
        Self {
            state: vec![S::zero(); dimension],
            guards: vec![S::zero(); guards],
            looks: vec![vec![0.0; guards]; LOOKS.len()],
        }
    }

    /// The earliest crossing in `step`, whose continuous extension must be there. Guards in
    /// `ignored` are left out.
    pub fn first(
        &mut self,
        system: &mut impl System<S>,
        step: &Step<S>,
        ignored: Option<usize>,
    ) -> Option<Crossing> {
        if self.guards.is_empty() {
            return None;
        }
        for (i, share) in LOOKS.into_iter().enumerate() {
            self.look(system, step, share);
            for (seen, guard) in self.looks[i].iter_mut().zip(&self.guards) {
                *seen = guard.value();
            }
        }
        let mut first: Option<Crossing> = None;
        for guard in (0..self.guards.len()).filter(|g| Some(*g) != ignored) {
            let crossing = self.crossing(system, step, guard);
            if let Some(share) = crossing
                && first.is_none_or(|f| share < f.share)
            {
                first = Some(Crossing { guard, share });
            }
        }
        first
    }

    /// Where `guard` first goes from positive to not positive.
    fn crossing(
        &mut self,
        system: &mut impl System<S>,
        step: &Step<S>,
        guard: usize,
    ) -> Option<f64> {
        let seen: [f64; LOOKS.len()] = std::array::from_fn(|i| self.looks[i][guard]);
        if seen[0] <= 0.0 && seen[1] <= 0.0 {
            return Some(self.early(system, step, guard, seen[1]));
        }
        for i in 0..LOOKS.len() - 1 {
            let (a, b) = (seen[i], seen[i + 1]);
            if a > 0.0 && b <= 0.0 {
                return Some(self.root(system, step, guard, [LOOKS[i], LOOKS[i + 1]], [a, b]));
            }
            if a <= 0.0 || i == 0 {
                continue;
            }
            // A dip between looks: the parabola through three of them tells whether to look there.
            if let Some((share, depth)) = dip(i, seen[i - 1], a, b)
                && depth < 0.1 * a
            {
                let value = self.look(system, step, share)[guard].value();
                if value <= 0.0 {
                    let (low, high) = if share < LOOKS[i] {
                        (LOOKS[i - 1], seen[i - 1])
                    } else {
                        (LOOKS[i], a)
                    };
                    return Some(self.root(system, step, guard, [low, share], [high, value]));
                }
            }
        }
        None
    }

    /// Where a guard crosses that is not positive at the first two looks. Either it came back
    /// between them (a short flight after the switch that began the step), or it never was
    /// positive: then the switch is overdue, and the crossing at the very beginning.
    fn early(
        &mut self,
        system: &mut impl System<S>,
        step: &Step<S>,
        guard: usize,
        seen: f64,
    ) -> f64 {
        let (mut later, mut beyond) = (LOOKS[1], seen);
        for _ in 0..EARLY_LOOKS {
            let share = later / 4.0;
            let value = self.look(system, step, share)[guard].value();
            if value > 0.0 {
                return self.root(system, step, guard, [share, later], [value, beyond]);
            }
            (later, beyond) = (share, value);
        }
        0.0
    }

    /// How the time of the crossing at the step's end varies with what dual numbers vary: as the
    /// guard stays zero there, by −δg/ġ. A number of value 0.
    pub fn delay(&mut self, system: &mut impl System<S>, step: &Step<S>, guard: usize) -> S {
        let at = self.look(system, step, 1.0)[guard];
        if !at.varies() {
            return S::zero();
        }
        let [before, after] =
            [1.0 - NEARBY, 1.0 + NEARBY].map(|share| self.look(system, step, share)[guard].value());
        let slope = (after - before) / (2.0 * NEARBY * step.length.value());
        // A guard that only grazes zero has no such derivative.
        if slope == 0.0 {
            return S::zero();
        }
        (S::constant(at.value()) - at) / slope
    }

    /// The guards at `share` of the step.
    fn look(&mut self, system: &mut impl System<S>, step: &Step<S>, share: f64) -> &[S] {
        step.interpolate(S::constant(share), &mut self.state);
        let t = step.start + step.length * share;
        system.guards(t, &self.state, &mut self.guards);
        &self.guards
    }

    /// The root of `guard` between two shares of opposite sign, by the Illinois method (Dowell and
    /// Jarratt 1971), to the last few bits; never on the near side.
    fn root(
        &mut self,
        system: &mut impl System<S>,
        step: &Step<S>,
        guard: usize,
        [mut a, mut b]: [f64; 2],
        [mut fa, mut fb]: [f64; 2],
    ) -> f64 {
        let mut last_side = 0;
        for _ in 0..60 {
            if b - a <= 4.0 * f64::EPSILON || fb == 0.0 {
                break;
            }
            let mut middle = b - fb * (b - a) / (fb - fa);
            if !(middle > a && middle < b) {
                middle = 0.5 * (a + b);
            }
            let value = self.look(system, step, middle)[guard].value();
            let side = if value > 0.0 { 1 } else { -1 };
            if side > 0 {
                (a, fa) = (middle, value);
                fb *= if last_side > 0 { 0.5 } else { 1.0 };
            } else {
                (b, fb) = (middle, value);
                fa *= if last_side < 0 { 0.5 } else { 1.0 };
            }
            last_side = side;
        }
        b
    }
}

/// Place and value of the lowest point of the parabola through looks `i - 1`, `i` and `i + 1`,
/// where it lies between them.
fn dip(i: usize, before: f64, at: f64, after: f64) -> Option<(f64, f64)> {
    let spacing = LOOKS[i + 1] - LOOKS[i];
    let curvature = before - 2.0 * at + after;
    let slope = 0.5 * (after - before);
    let offset = -slope / curvature;
    let inside = curvature > 0.0 && offset.abs() < 1.0;
    inside.then(|| {
        let depth = at + slope * offset + 0.5 * curvature * offset * offset;
        (LOOKS[i] + offset * spacing, depth)
    })
}
