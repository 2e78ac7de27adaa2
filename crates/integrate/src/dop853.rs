//! One step of DOP853, its error estimate and its continuous extension (Hairer, Nørsett and
//! Wanner 1993, section II.10).
//!
//! Written over any scalar: time and step are scalars too, so that lanes may each have their own.

use crate::system::System;
use crate::tableau::{DENSE, ERROR_3, ERROR_5, EXTENDED, NODES, Row, STAGE, STAGES};
use scalar::{Lanes, Scalar, inlined};

/// Coefficients of the continuous extension, per component.
const PIECES: usize = 7;

/// A step from `start` over `length`, with everything needed to look inside it.
#[derive(Clone, Debug)]
pub struct Step<S> {
    /// Time at the beginning.
    pub start: S,
    /// Length of the step.
    pub length: S,
    /// State at the beginning.
    pub from: Vec<S>,
    /// State at the end.
    pub to: Vec<S>,
    /// Derivatives at the stages: stage `i` of component `j` is `stages[i * n + j]`. The first
    /// belongs to the beginning, number 12 to the end.
    stages: Vec<S>,
    pieces: Vec<S>,
    scratch: Vec<S>,
    /// Whether the pieces are those of this step.
    extended: bool,
    /// Whether its observer has seen enough.
    last: bool,
}

impl<S: Scalar> Step<S> {
    /// Room for steps of a system with `dimension` components.
    pub fn new(dimension: usize) -> Self {
        let zeros = |n: usize| vec![S::zero(); n];
        Self {
            start: S::zero(),
            length: S::zero(),
            from: zeros(dimension),
            to: zeros(dimension),
            stages: zeros(EXTENDED * dimension),
            pieces: zeros(PIECES * dimension),
            scratch: zeros(dimension),
            extended: false,
            last: false,
        }
    }

    /// Ends the integration behind this step: its observer has seen enough.
    pub fn stop(&mut self) {
        self.last = true;
    }

    /// Whether it was the last, once.
    pub(crate) fn take_last(&mut self) -> bool {
        std::mem::take(&mut self.last)
    }

    fn dimension(&self) -> usize {
        self.from.len()
    }

    /// Derivative at the beginning.
    pub fn derivative_from(&self) -> &[S] {
        &self.stages[..self.dimension()]
    }

    /// Evaluates the derivative at the beginning, `(self.start, self.from)`.
    pub fn begin(&mut self, system: &mut impl System<S>) {
        let n = self.dimension();
        derivative(system, self.start, &self.from, &mut self.stages[..n]);
    }

    /// Makes the end of this step the beginning of the next. The derivative there is kept.
    pub fn shift(&mut self) {
        let n = self.dimension();
        self.start += self.length;
        self.from.copy_from_slice(&self.to);
        self.stages.copy_within(12 * n..13 * n, 0);
    }

    /// Lets the beginning be later by a number of value 0, of which only the derivatives count: the state goes on
    /// by its own slope.
    pub fn delay(&mut self, later: S) {
        self.start += later;
        for (from, slope) in self.from.iter_mut().zip(&self.stages) {
            *from += *slope * later;
        }
    }

    /// Steps over `length` from the beginning, whose derivative must be there, to `self.to`. After
    /// each stage `look` is shown its number and the system.
    pub fn take<T: System<S>>(
        &mut self,
        system: &mut T,
        length: S,
        mut look: impl FnMut(usize, &mut T),
    ) {
        self.length = length;
        self.extended = false;
        S::vectorised(
            #[inline(always)]
            || {
                for stage in 1..STAGES {
                    let (t, y, slope) = self.stage(stage);
                    system.derivative(t, y, slope);
                    look(stage, system);
                }
                self.to.copy_from_slice(&self.scratch);
            },
        );
    }

    /// Time and state of stage number `stage`, from those before it, and where its derivative belongs.
    #[inline(always)]
    fn stage(&mut self, stage: usize) -> (S, &[S], &mut [S]) {
        let n = self.dimension();
        let length = self.length;
        combine(
            n,
            [STAGE[stage]],
            &self.stages,
            #[inline(always)]
            |first, slopes| {
                let to = self.scratch[first..][..slopes.len()].iter_mut();
                let from = &self.from[first..][..slopes.len()];
                for ((to, from), slope) in to.zip(from).zip(slopes) {
                    *to = slope.mul_add(length, *from);
                }
            },
        );
        let t = length.mul_add(S::constant(NODES[stage]), self.start);
        (t, &self.scratch, &mut self.stages[stage * n..][..n])
    }

    /// Squares of the estimated errors of order 5 and 3, summed over the components, each over its
    /// entry of `scale`. Components with an infinite scale do not count.
    pub fn squared_errors(&self, scale: impl Fn(usize) -> S) -> [S; 2] {
        let rows = [ERROR_5, ERROR_3];
        S::vectorised(
            #[inline(always)]
            || {
                let mut sums = [S::zero(); 2];
                combine(
                    self.dimension(),
                    rows,
                    &self.stages,
                    #[inline(always)]
                    |first, errors| {
                        let count = errors.len() / 2;
                        for j in 0..count {
                            let scale = S::one() / scale(first + j);
                            for (sum, error) in sums.iter_mut().zip([errors[j], errors[count + j]])
                            {
                                let error = error * scale;
                                *sum = error.mul_add(error, *sum);
                            }
                        }
                    },
                );
                sums
            },
        )
    }

    /// Computes the continuous extension, unless it is there: three more derivatives.
    pub fn extend(&mut self, system: &mut impl System<S>) {
        if std::mem::replace(&mut self.extended, true) {
            return;
        }
        let n = self.dimension();
        let h = self.length;
        S::vectorised(
            #[inline(always)]
            || {
                for stage in STAGES..EXTENDED {
                    let (t, y, slope) = self.stage(stage);
                    derivative(system, t, y, slope);
                }
                let [begin, end] = [0, 12].map(|i| &self.stages[i * n..][..n]);
                let (from, to) = (&self.from[..n], &self.to[..n]);
                let (zeroth, rest) = self.pieces.split_at_mut(n);
                let (first, rest) = rest.split_at_mut(n);
                let second = &mut rest[..n];
                for j in 0..n {
                    zeroth[j] = to[j] - from[j];
                    first[j] = h.mul_add(begin[j], -zeroth[j]);
                    second[j] = zeroth[j] - h.mul_add(end[j], first[j]);
                }
                for (i, row) in DENSE.iter().enumerate() {
                    let piece = &mut self.pieces[(3 + i) * n..][..n];
                    combine(
                        n,
                        [*row],
                        &self.stages,
                        #[inline(always)]
                        |first, sums| {
                            for (piece, sum) in piece[first..].iter_mut().zip(sums) {
                                *piece = h * *sum;
                            }
                        },
                    );
                }
            },
        );
    }

    /// Copies the beginning of a lane of `self` into the step of a plain number of the same dimension; if asked for, with its
    /// time, its end and its continuous extension.
    pub fn lane<const W: usize>(&self, lane: usize, whole: bool, other: &mut Step<f64>)
    where
        S: Lanes<W>,
    {
        let copy = |to: &mut [f64], from: &[S]| {
            for (to, from) in to.iter_mut().zip(from) {
                *to = from.get(lane);
            }
        };
        let n = self.dimension();
        copy(&mut other.from, &self.from);
        copy(&mut other.stages[..n], &self.stages);
        if whole {
            other.start = self.start.get(lane);
            other.length = self.length.get(lane);
            other.extended = self.extended;
            copy(&mut other.to, &self.to);
            copy(&mut other.stages[12 * n..13 * n], &self.stages[12 * n..]);
            copy(&mut other.pieces, &self.pieces);
        }
    }

    /// Takes beginning and derivative there of a lane from the step of a plain number.
    pub(crate) fn take_beginning<const W: usize>(&mut self, lane: usize, other: &Step<f64>)
    where
        S: Lanes<W>,
    {
        let n = self.dimension();
        for j in 0..n {
            self.from[j].set(lane, other.from[j]);
            self.stages[j].set(lane, other.stages[j]);
        }
    }

    /// In the lanes of the mask the end becomes the beginning.
    pub(crate) fn shift_where(&mut self, mask: S::Mask) {
        let n = self.dimension();
        let (first, rest) = self.stages.split_at_mut(n);
        let last = &rest[11 * n..12 * n];
        S::vectorised(
            #[inline(always)]
            || {
                for (first, last) in first.iter_mut().zip(last) {
                    *first = S::select(mask, *last, *first);
                }
                for (from, to) in self.from.iter_mut().zip(&self.to) {
                    *from = S::select(mask, *to, *from);
                }
            },
        );
    }

    /// The state at `share` of the step, 0 at its beginning and 1 at its end, after
    /// [`extend`](Self::extend).
    pub fn interpolate(&self, share: S, out: &mut [S]) {
        let n = self.dimension();
        S::vectorised(
            #[inline(always)]
            || {
                let rest = S::one() - share;
                let pieces: [&[S]; PIECES] = std::array::from_fn(|i| &self.pieces[i * n..][..n]);
                for (j, (out, from)) in out[..n].iter_mut().zip(&self.from[..n]).enumerate() {
                    *out = continued(*from, share, rest, |i| pieces[i][j]);
                }
            },
        );
    }
}

/// The derivative where it is seldom needed: what is inlined into the stages would take much room here.
#[inline(never)]
fn derivative<S: Scalar>(system: &mut impl System<S>, t: S, y: &[S], dy: &mut [S]) {
    S::vectorised(
        #[inline(always)]
        || system.derivative(t, y, dy),
    );
}

/// The continuous extension of one component at `share` of the step, of which `rest` is left, from the
/// component at the beginning and its pieces.
#[inline(always)]
fn continued<S: Scalar>(from: S, share: S, rest: S, piece: impl Fn(usize) -> S) -> S {
    let mut sum = piece(PIECES - 1);
    for i in (0..PIECES - 1).rev() {
        let factor = if i % 2 == 0 { rest } else { share };
        sum = sum.mul_add(factor, piece(i));
    }
    sum.mul_add(share, from)
}

/// Hands the sums of weight × derivative over the stages to `take`, some components at a time. `take` gets the number
/// of the first component, and the sums by each row after the other.
///
/// Small numbers are summed several components at a time: each weight is fetched once for all of them.
#[inline(always)]
fn combine<S: Scalar, const R: usize>(
    dimension: usize,
    rows: [Row; R],
    stages: &[S],
    mut take: impl FnMut(usize, &[S]),
) {
    const LARGEST: usize = 8 * size_of::<f64>();
    let mut done = 0;
    if size_of::<S>() <= LARGEST {
        done = combine_blocks::<S, R, 8>(done, dimension, rows, stages, &mut take);
        done = combine_blocks::<S, R, 4>(done, dimension, rows, stages, &mut take);
    }
    combine_blocks::<S, R, 1>(done, dimension, rows, stages, &mut take);
}

/// As [`combine`], from component `first` on as many whole blocks of `B` as there are; which component
/// is next.
#[inline(always)]
fn combine_blocks<S: Scalar, const R: usize, const B: usize>(
    mut first: usize,
    dimension: usize,
    rows: [Row; R],
    stages: &[S],
    take: &mut impl FnMut(usize, &[S]),
) -> usize {
    while first + B <= dimension {
        // A loop, as `map` of an array may be compiled without the instructions of lanes.
        let mut sums = [[S::zero(); B]; R];
        let mut i = 0;
        while i < R {
            sums[i] = weighted::<S, B>(rows[i], stages, dimension, first);
            i += 1;
        }
        take(first, sums.as_flattened());
        first += B;
    }
    first
}

/// The weighted sums of `B` components over the stages, from component `first` on.
#[inline(always)]
fn weighted<S: Scalar, const B: usize>(
    row: Row,
    stages: &[S],
    dimension: usize,
    first: usize,
) -> [S; B] {
    let mut sums = [S::zero(); B];
    for &(stage, weight) in row {
        let weight = S::constant(weight);
        let slopes = &stages[stage * dimension + first..][..B];
        for (sum, slope) in sums.iter_mut().zip(slopes) {
            *sum = slope.mul_add(weight, *sum);
        }
    }
    sums
}

impl Step<f64> {
    /// The states at several shares of the step, side by side, as [`interpolate`](Self::interpolate).
    pub fn interpolate_lanes<L: Scalar>(&self, share: L, out: &mut [L]) {
        let n = self.dimension();
        L::vectorised(
            #[inline(always)]
            || {
                let rest = L::one() - share;
                for (j, (out, from)) in out.iter_mut().zip(&self.from).enumerate() {
                    let piece = inlined(
                        #[inline(always)]
                        |i| L::constant(self.pieces[i * n + j]),
                    );
                    *out = continued(L::constant(*from), share, rest, piece);
                }
            },
        );
    }
}
