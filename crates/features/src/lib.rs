//! Signals summed up as one row of named numbers.
