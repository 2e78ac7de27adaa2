//! A line of the table of features.

use crate::definition::Group;
use crate::envelope::Envelope;
use crate::reason::Reason;
use crate::statistics::Statistics;
use signal::overall_vibration::OverallVibration;
use signal::phase_portrait::PhasePortrait;
use signal::spectral_shape::SpectralShape;
use signal::synchronous_average::SynchronousAverage;
use simulate::IndicatorCard;

/// Source of the synchronous mean, for more than one part of the table.
pub(super) const MCFADDEN: &str = "McFadden 1987, Mechanical Systems and Signal Processing 1, 83";

/// A feature, of every channel that has it.
pub(crate) struct Line {
    /// Name without channel and unit: `order_03`.
    pub(crate) name: String,
    pub(crate) unit: Unit,
    pub(crate) description: String,
    pub(crate) formula: &'static str,
    pub(crate) source: &'static str,
    pub(crate) value: Value,
}

/// The unit of a feature.
#[derive(Clone, Copy)]
pub(crate) enum Unit {
    /// That of the channel.
    OfChannel,
    /// The square of it.
    SquareOfChannel,
    /// None: a pure number.
    Pure,
    /// This one.
    Of(&'static str),
}

/// Where the value of a feature comes from.
pub(crate) enum Value {
    Statistic(fn(&Statistics) -> Result<f64, Reason>),
    /// Mean square in the frequency band of this index.
    Band(usize),
    /// Amplitude of this order in the synchronous mean.
    Order(usize),
    /// RMS over the revolutions of the amplitude of this order.
    OrderRms(usize),
    Portrait(fn(&PhasePortrait) -> Result<f64, signal::Error>),
    Shape(fn(&SpectralShape) -> f64),
    Envelope(fn(&Envelope) -> f64),
    /// Amplitude of this order in the synchronous mean of the envelope.
    EnvelopeOrder(usize),
    Synchronous(fn(&SynchronousAverage) -> Result<f64, signal::Error>),
    /// RMS in the crank-angle sector of this index.
    Sector(usize),
    Cepstrum,
    Overall(fn(&OverallVibration) -> f64),
    Indicated(fn(&IndicatorCard) -> f64),
}

impl Value {
    pub(crate) fn group(&self) -> Group {
        match self {
            Self::Statistic(_) => Group::Statistics,
            Self::Band(_) | Self::Shape(_) | Self::Overall(_) => Group::Spectrum,
            Self::Order(_) | Self::OrderRms(_) | Self::Cepstrum => Group::Orders,
            Self::Portrait(_) => Group::Portrait,
            Self::Envelope(_) | Self::EnvelopeOrder(_) => Group::Envelope,
            Self::Synchronous(_) | Self::Sector(_) => Group::Revolutions,
            Self::Indicated(_) => Group::Indicator,
        }
    }
}
