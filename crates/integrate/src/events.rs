//! Finding the first guard that crosses zero inside a step.

use crate::dop853::Step;
use crate::system::{Real, System};

/// Shares of the step at which the guards are looked at, beside its beginning and end.
const LOOKS: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// Share of the step over which a guard's slope is taken.
const NEARBY: f64 = 1e-3;

/// Looks at ever smaller shares before a guard counts as overdue: the last is at 4^−13.
const EARLY_LOOKS: usize = 12;

/// Halvings of the interval between two looks for the first guess of a root.
const BISECTIONS: usize = 10;

/// Share of the step to which a crossing is found, over the tolerance of the step; its bounds; and looks
/// that this may take.
const RESOLUTION: f64 = 1e-3;
const RESOLUTIONS: [f64; 2] = [1e-13, 1e-6];
const MOST_TRIES: usize = 100;

/// A guard that crossed zero, and where in the step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing {
    pub guard: usize,
    /// Share of the step, 0 to 1.
    pub share: f64,
}

/// Two shares between which a guard crosses zero, its values there, and where it may do so.
struct Bracket {
    shares: [f64; 2],
    values: [f64; 2],
    guess: f64,
}

impl Bracket {
    /// With the secant's crossing as the guess.
    fn new(shares: [f64; 2], values: [f64; 2]) -> Self {
        let [near, far] = shares;
        let guess = far + (near - far) * values[1] / (values[1] - values[0]);
        Self {
            shares,
            values,
            guess,
        }
    }
}

/// Scratch for looking into steps.
#[derive(Clone, Debug)]
pub(crate) struct Finder<S> {
    /// Share of the step to which a crossing is found.
    resolution: f64,
    state: Vec<S>,
    guards: Vec<S>,
    /// Guards at each of `LOOKS`.
    looks: Vec<Vec<f64>>,
}

impl<S: Real> Finder<S> {
    /// Room for looking into steps of this tolerance.
    pub fn new(dimension: usize, guards: usize, tolerance: f64) -> Self {
        let [least, most] = RESOLUTIONS;
        Self {
            resolution: (RESOLUTION * tolerance).clamp(least, most),
            state: vec![S::zero(); dimension],
            guards: vec![S::zero(); guards],
            looks: vec![vec![0.0; guards]; LOOKS.len()],
        }
    }

    /// The earliest crossing in `step`, whose continuous extension must be there. `ends` are the guards
    /// at its beginning and end, where they are known. Guards in `ignored` are left out.
    pub fn first(
        &mut self,
        system: &mut impl System<S>,
        step: &Step<S>,
        ends: Option<[&[f64]; 2]>,
        ignored: Option<usize>,
    ) -> Option<Crossing> {
        if self.guards.is_empty() {
            return None;
        }
        for (i, share) in LOOKS.into_iter().enumerate() {
            let known = match (share, ends) {
                (0.0, Some([beginning, _])) => Some(beginning),
                (1.0, Some([_, end])) => Some(end),
                _ => None,
            };
            if let Some(known) = known {
                self.looks[i].copy_from_slice(known);
                continue;
            }
            self.guards_at(system, step, share);
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
                let bracket = Bracket {
                    guess: first_guess(&seen, i),
                    ..Bracket::new([LOOKS[i], LOOKS[i + 1]], [a, b])
                };
                return Some(self.root(system, step, guard, bracket));
            }
            if a <= 0.0 || i == 0 {
                continue;
            }
            // A dip between looks: the parabola through three of them decides whether to look there.
            if let Some((share, depth)) = dip(i, seen[i - 1], a, b)
                && depth < 0.1 * a
            {
                let value = self.guards_at(system, step, share)[guard].value();
                if value <= 0.0 {
                    let (low, high) = if share < LOOKS[i] {
                        (LOOKS[i - 1], seen[i - 1])
                    } else {
                        (LOOKS[i], a)
                    };
                    let bracket = Bracket::new([low, share], [high, value]);
                    return Some(self.root(system, step, guard, bracket));
                }
            }
        }
        None
    }

    /// Where a guard crosses that is not positive at the first two looks. Either it came back
    /// between them (a short flight after the switch that began the step), or it never was
    /// positive. Then the switch is overdue, and the crossing at the very beginning.
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
            let value = self.guards_at(system, step, share)[guard].value();
            if value > 0.0 {
                let bracket = Bracket::new([share, later], [value, beyond]);
                return self.root(system, step, guard, bracket);
            }
            (later, beyond) = (share, value);
        }
        0.0
    }

    /// How the time of the crossing at the step's end varies with what dual numbers vary: as the
    /// guard stays zero there, by −δg/ġ. A number of value 0.
    pub fn delay(&mut self, system: &mut impl System<S>, step: &Step<S>, guard: usize) -> S {
        if !S::DERIVATIVES {
            return S::zero();
        }
        let at = self.guards_at(system, step, 1.0)[guard];
        if !at.varies() {
            return S::zero();
        }
        let [before, after] = [1.0 - NEARBY, 1.0 + NEARBY]
            .map(|share| self.guards_at(system, step, share)[guard].value());
        let slope = (after - before) / (2.0 * NEARBY * step.length.value());
        // A guard that only grazes zero has no such derivative.
        if slope == 0.0 {
            return S::zero();
        }
        (S::constant(at.value()) - at) / slope
    }

    /// The guards at `share` of the step.
    fn guards_at(&mut self, system: &mut impl System<S>, step: &Step<S>, share: f64) -> &[S] {
        step.interpolate(S::constant(share), &mut self.state);
        let t = step.start + step.length * share;
        system.guards(t, &self.state, &mut self.guards);
        &self.guards
    }

    /// The root of `guard` in a bracket, by inverse quadratic interpolation where that is safe and bisection
    /// elsewhere (Chandrupatla 1997); never on the near side.
    fn root(
        &mut self,
        system: &mut impl System<S>,
        step: &Step<S>,
        guard: usize,
        bracket: Bracket,
    ) -> f64 {
        let Bracket {
            shares: [near, far],
            values,
            guess,
        } = bracket;
        // The newest share, the one on the other side of the root, and the one before.
        let ([mut x1, mut x2], [mut f1, mut f2]) = ([far, near], [values[1], values[0]]);
        let mut way = (guess - far) / (near - far);
        for _ in 0..MOST_TRIES {
            let width = (x2 - x1).abs();
            if width <= self.resolution || f1 == 0.0 {
                break;
            }
            let least = (0.5 * self.resolution / width).min(0.5);
            let x = x1 + way.clamp(least, 1.0 - least) * (x2 - x1);
            let f = self.guards_at(system, step, x)[guard].value();
            let (x3, f3);
            if (f > 0.0) == (f1 > 0.0) {
                (x3, f3) = (x1, f1);
            } else {
                (x3, f3) = (x2, f2);
                (x2, f2) = (x1, f1);
            }
            (x1, f1) = (x, f);
            let (place, level) = ((x1 - x2) / (x3 - x2), (f1 - f2) / (f3 - f2));
            let safe = level * level < place && (1.0 - level) * (1.0 - level) < 1.0 - place;
            way = match safe {
                true => {
                    f1 / (f2 - f1) * f3 / (f2 - f3)
                        + (x3 - x1) / (x2 - x1) * f1 / (f3 - f1) * f2 / (f3 - f2)
                }
                false => 0.5,
            };
        }
        if f1 > 0.0 { x2 } else { x1 }
    }
}

/// Where the polynomial through all looks crosses zero between looks `i` and `i + 1`, to some thousandth.
fn first_guess(seen: &[f64; LOOKS.len()], i: usize) -> f64 {
    // Newton's divided differences, the looks being equally far apart.
    let mut differences = *seen;
    for order in 1..LOOKS.len() {
        for j in (order..LOOKS.len()).rev() {
            differences[j] = (differences[j] - differences[j - 1]) / order as f64;
        }
    }
    let value = |share: f64| {
        let place = share * (LOOKS.len() - 1) as f64;
        let terms = differences.iter().enumerate().rev();
        terms.fold(0.0, |sum, (j, difference)| {
            sum * (place - j as f64) + difference
        })
    };
    let [mut near, mut far] = [LOOKS[i], LOOKS[i + 1]];
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (near + far);
        if value(middle) > 0.0 {
            near = middle;
        } else {
            far = middle;
        }
    }
    0.5 * (near + far)
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
