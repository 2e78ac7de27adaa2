//! A machine at an operating point becomes a run: transient, sensors, energy ledger.
