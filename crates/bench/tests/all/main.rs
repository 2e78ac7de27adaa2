//! Tests of the bench.

mod schema;
