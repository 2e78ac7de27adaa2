//! Line, point and area plots in a stack of rows, as one SVG image.
//!
//! A [`Figure`] holds rows of [`Panel`]s, a panel holds [`Series`] on two axes. Nothing here knows
//! what is plotted. The image is for a white page, on a screen or printed. The palette is safe for
//! colour-blind readers, text is text, and no line has more vertices than the pixels can show. A
//! figure carries no identifiers, styles or scripts, so many can stand in one HTML page. On a page it
//! carries its values, too, and the scripts in `report/templates/script` make it one to work with.

mod axis;
mod colour;
mod decimate;
mod draw;
mod layout;
mod live;
mod palette;
mod panel;
mod rows;
mod series;

pub use axis::share_ranges;
pub use colour::Colour;
pub use panel::{Axis, Circle, Field, Panel, Scale};
pub use rows::{Figure, Share, in_rows};
pub use series::{Layer, Mark, Series};
