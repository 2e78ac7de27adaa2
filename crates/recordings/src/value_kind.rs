//! What a column can hold.

use std::fmt;

/// What the values of a column are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A string.
    Text,
    /// A whole number (64 bits).
    Integer,
    /// A real number (float64).
    Real,
    /// True or false.
    Flag,
    /// A recording: a list of float32, of any length from row to row.
    Samples,
}

impl Kind {
    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Text => "text",
            Self::Integer => "integer",
            Self::Real => "real",
            Self::Flag => "flag",
            Self::Samples => "samples",
        }
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::Text => "text",
            Self::Integer => "a whole number",
            Self::Real => "a real number",
            Self::Flag => "a flag",
            Self::Samples => "a list of samples",
        })
    }
}
