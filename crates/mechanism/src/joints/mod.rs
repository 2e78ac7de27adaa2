//! The four places where clearance can be: main bearing, big end, small end, crosshead guide.

pub mod clearance_relation;
pub mod contact;
pub(crate) mod contact_guards;
pub mod friction;
pub mod guide;
pub mod materials;
pub mod revolute;
pub mod stiffness;
