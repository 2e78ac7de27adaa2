//! How worn each joint is: clearances estimated from recordings of a machine whose healthy state is known.
//!
//! ```text
//! machine file (healthy) ─> joints ─┐
//! recordings ─> task ───────────────┴─> models ─screen─> starts ─descents─> fits ─evidence─> joints' clearances
//! ```
//!
//! 1. All joints that are clear in the machine file have an unknown clearance. Their contact parameters follow it by the
//!    relation of the machine file.
//! 2. Clearances are screened on a grid, joint by joint, by the energies of sectors and bands ([`crate::energies`]). The
//!    best points start descents that compare energies first, and waveforms last.
//! 3. Where more than noise is left, one joint that is ideal in the file becomes clear, or the contact parameters are
//!    fitted too. What lowers Schwarz's criterion (1978) most is kept, until nothing does.
//! 4. Intervals follow as those of a calibration, and include a tolerance of contact parameters that were not fitted. Where the model is wrong, the size of its discrepancy is estimated as
//!    an error of timing, and what follows is a range that includes it.

mod descent;
mod discrepancy;
mod effort;
mod estimation;
mod joint;
mod model;
mod results;
mod screen;
mod selection;
mod tolerance;
mod verdict;

pub use estimation::{Asked, Estimated, Prepared, estimate, prepare};
pub use results::{
    Contact, Interval, JointWear, Misfits, Results, RunMisfit, Together, Verdict, WEAR,
};
