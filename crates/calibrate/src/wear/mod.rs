//! How worn each joint is: clearances estimated from recordings of a machine whose healthy state is known.
//!
//! ```text
//! machine file (healthy) ─> joints ─┐
//! recordings ─> task ───────────────┴─> sets ─draws, clouds─> ends ─descents─> fits ─evidence─> joints' clearances
//! ```
//!
//! 1. All joints that are clear in the machine file have an unknown clearance. Their contact parameters follow it by powers, whose
//!    exponents are unknown around those of the file's relation ([`crate::prior`]).
//! 2. Descents from the clearances of the file compare energies of sectors and bands first ([`crate::energies`]), and waveforms last.
//! 3. Where they end above the noise, all clearances are searched at once, by energies: from the best of many points that are drawn,
//!    through clouds of points that become narrower. The best ends are descended from.
//! 4. From there the file's own relation and free contact parameters are fitted too. Schwarz's criterion (1978) decides.
//! 5. Where still more than noise is left, the same is done for sets with more joints that are ideal in the file: those whose best
//!    drawn points are better than with one joint less. Only then follow free contact parameters from all ends.
//! 6. Intervals follow as those of a calibration, and include a tolerance of contact parameters that were not fitted. Where the
//!    model is wrong, the size of its discrepancy is estimated as an error of timing. What follows is a range that includes it.
//! 7. A motion that does not repeat itself has no derivatives, be it recorded or that of the best fit. The last fit and the
//!    intervals come from a statistical linearisation of lines and energies then (`crate::statistical_linearization`).

mod descent;
mod discrepancy;
mod draws;
mod effort;
mod estimation;
mod joint;
mod model;
mod parts;
mod results;
mod selection;
mod sets;
mod summary;
mod tolerance;
mod verdict;

pub use estimation::{Asked, Estimated, Prepared, estimate, prepare};
pub use results::{
    Contact, Interval, JointWear, Misfits, Results, RunMisfit, Together, Verdict, WEAR,
};
