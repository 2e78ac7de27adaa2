//! What the simulation of a case gives, and the function that simulates.

use signal::channel::Channel;
use simulate::Motion;

use crate::Case;

/// The channel of the crank angle.
pub(crate) const CRANK_ANGLE: &str = "crank_angle_rad";

/// What a simulated case gives: the channels of the machine's sensors, in their order.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// The channels, named as [`crate::Plan::channels`] has them, from the first recorded revolution on.
    pub channels: Vec<Channel>,
    /// The motion as judged from the equations, where the case asks for that and can be disturbed.
    pub motion: Option<Motion>,
    /// What is doubtful about it; its texts go into the manifest.
    pub warnings: Vec<String>,
}

/// Why a case failed; its text goes into the manifest.
pub type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Simulates cases, one result for each. Called on several threads at once; a result must depend on
/// its case alone.
pub type Runner<'a> = dyn Fn(&[Case]) -> Vec<Result<Recording, Failure>> + Sync + 'a;
