//! The tests of mechanism, in one program.

mod cited_sections;
mod clearance_relation;
mod common;
mod contact_laws;
mod derivative;
mod drop;
mod effects;
mod energy;
mod frame;
mod guide;
mod ideal;
mod joint_models;
mod materials;
mod momentum;
mod plain;
mod ravn;
mod reversals;
mod scalars;
mod slap;
mod statistics;
mod stiffness;
mod symmetry;
mod trajectories;
