//! Where the colours of a figure come from.

/// Where a colour comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Colour {
    /// One of a set of classes: equal numbers look alike in every figure.
    Class(usize),
    /// A place between the lowest (0) and the highest (1) of an ordered quantity.
    Ordered(f64),
    /// A fill from light grey (0) to dark (1) that also reads in grey.
    Tint(f64),
    /// Dark grey, for a reference.
    Ink,
}
