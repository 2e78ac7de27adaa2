//! The tests of simulate, in one program.

mod bifurcation;
#[path = "../../../mechanism/tests/all/common/mod.rs"]
mod common;
mod effects;
mod ensemble;
mod first_look;
mod housing;
mod joint_models;
mod known_flows;
mod lyapunov;
mod measure;
mod poincare;
mod record;
mod sampling;
mod sensitivity;
mod switches;
mod verdicts;
