//! The files that people write: quantities with units, machine.yaml, their errors and schemas.
