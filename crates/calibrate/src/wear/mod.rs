//! How worn each joint is: clearances estimated from recordings of a machine whose healthy state is known.
//!
//! ```text
//! machine file (healthy) ─> joints ─┐
//! recordings ─> task ───────────────┴─> models ─screen─> starts ─descents─> fits ─evidence─> joints' clearances
//! ```
//!
//! 1. All joints that are clear in the machine file have an unknown clearance. Their contact parameters follow it by powers, whose
//!    exponents are unknown around those of the file's relation ([`crate::prior`]).
//! 2. Descents from the clearances of the file compare energies of sectors and bands first ([`crate::energies`]), and waveforms last.
//! 3. Where they end above the noise, the clearances of each throw are screened on a common grid, by energies. The cells of the
//!    best points are searched without derivatives, all for a while and the better ones for longer. The best ends are descended from.
//! 4. From there the file's own relation and free contact parameters are fitted too. Schwarz's criterion (1978) decides.
//! 5. Where still more than noise is left, one joint that is ideal in the file becomes clear: that whose grid has the best cells by
//!    energies, or the best points by lines. Its grid is looked at from the best fit and from the healthy machine. What
//!    lowers the criterion is kept, until nothing does. Only then follow cells that are less likely, by all known relations, and free
//!    contact parameters from all ends.
//! 6. Intervals follow as those of a calibration, and include a tolerance of contact parameters that were not fitted. Where the
//!    model is wrong, the size of its discrepancy is estimated as an error of timing. What follows is a range that includes it.
//! 7. A motion that does not repeat itself has no derivatives, be it recorded or that of the best fit. The last fit and the
//!    intervals come from a statistical linearisation of lines and energies then (`crate::statistical_linearization`).

mod cell;
mod descent;
mod discrepancy;
mod effort;
mod estimation;
mod joint;
mod model;
mod parts;
mod results;
mod screen;
mod selection;
mod summary;
mod tolerance;
mod verdict;

pub use estimation::{Asked, Estimated, Prepared, estimate, prepare};
pub use results::{
    Contact, Interval, JointWear, Misfits, Results, RunMisfit, Together, Verdict, WEAR,
};
