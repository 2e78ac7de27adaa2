//! Labelled recordings of reciprocating compressors with worn bearings, as a library.
//!
//! The programs `gen-dataset` and `crosshead` are glue over the crates that stand here under one name. SI units
//! everywhere; the files that people write carry units.
//!
//! # A guided tour
//!
//! ## A machine becomes a recording
//!
//! [`input`] reads `machine.yaml`, [`simulate`](mod@simulate) integrates the equations of [`mechanism`] and samples the
//! sensors; [`simulate::measure`] adds what the recorder adds.
//!
//! ```
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let machine_yaml = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/machines/single-stage.yaml");
//! use crosshead::input::{MachineFile, machine_file, paths};
//! use crosshead::scalar::random::{Purpose, stream};
//! use crosshead::simulate::{self, Settings, Transient};
//!
//! let mut tree = machine_file::read(machine_yaml.as_ref())?.to_tree().clone();
//! paths::set(&mut tree, "joints.big_end.clearance", "0.2 mm".into())?;
//! let machine = MachineFile::from_tree(&tree)?.resolve()?;
//!
//! let settings = Settings {
//!     transient: Transient::Revolutions(1),
//!     revolutions: 2,
//!     sample_rate: 10e3,
//!     tolerance: 1e-6,
//!     ..Settings::default()
//! };
//! let record = simulate::simulate(&machine.machine, &machine.sensors, &settings, false)?;
//! let mut noise = stream(1, 0, Purpose::Noise);
//! let throws = machine.machine.throw_names();
//! let channels = simulate::measure(&record, &machine.sensors, &throws, &mut noise);
//! assert_eq!(channels.len(), machine.sensors.len());
//!
//! // The recording becomes one row of named numbers; those of measured recordings are the same.
//! use crosshead::features::{Cell, Window, columns, row};
//! let names = columns(channels.iter().map(|c| (c.name.as_str(), c.unit.as_str())), false);
//! let window = Window {
//!     sample_rate: record.sample_rate,
//!     speed_rpm: Some(record.mean_speed.to_degrees() / 6.0),
//!     crank_angle: None,
//!     channels: &channels,
//!     chambers: &simulate::Chamber::of_machine(&machine.machine),
//! };
//! let values = row(&window, false);
//! let kurtosis = names.iter().position(|(name, _)| name.name == "crosshead_acceleration.kurtosis");
//! assert!(matches!(values[kurtosis.unwrap()], Some(Cell::Number(kurtosis)) if kurtosis > 1.0));
//! # Ok(())
//! # }
//! ```
//!
//! ## A sweep becomes a dataset
//!
//! [`sweep::Plan`] reads `sweep.yaml`: which cases there are, in which shard each stands, and how each machine differs.
//! [`sweep::generate`] runs them, [`sweep::finalize`] commits the dataset.
//!
//! ```
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let sweep_yaml = concat!(env!("CARGO_MANIFEST_DIR"), "/../../pipelines/paper2.yaml");
//! let plan = crosshead::sweep::Plan::read(sweep_yaml.as_ref())?;
//! assert_eq!(plan.cases(), 10);
//! let case = plan.case(0)?;
//! println!("{} at {} Hz", plan.case_id(0), case.settings.sample_rate);
//! # Ok(())
//! # }
//! ```
//!
//! ## Recordings of a machine calibrate its model
//!
//! [`recordings`] reads CSV, WAV, MAT, HDF5, MCAP and Parquet. [`calibrate`] fits the parameters of a bundle of them and says
//! which are identifiable, and [`gap`] names the effect that the calibrated model lacks.
//!
//! ## What a signal says
//!
//! [`signal`] holds spectra, envelopes, order tracking and phase portraits; [`chaos`] Lyapunov exponents with
//! intervals, and the kind of a motion. [`study`] computes what a dataset shows, [`figure`] plots it, and [`report`] draws pages of all of it.

pub use calibrate;
pub use chaos;
pub use features;
pub use figure;
pub use gap;
pub use input;
pub use integrate;
pub use mechanism;
pub use recordings;
pub use report;
pub use scalar;
pub use signal;
pub use simulate;
pub use study;
pub use sweep;
pub use text;
