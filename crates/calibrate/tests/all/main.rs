//! The tests of calibrate, in one program.

mod clearances;
mod cost;
mod data_sheet;
mod few_revolutions;
mod free_crank;
mod interrupted;
mod own_recordings;
mod real_pressure;
mod replay;
mod search;
mod slow_chain;
mod unloaded;
mod wear;
