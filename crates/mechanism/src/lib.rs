//! The machine: geometry, joints, gas, drive and the equations of motion, written once over the number trait.
