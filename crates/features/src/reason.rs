//! Why a feature has no value.

/// Why a feature has no value in a window.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Reason {
    /// The feature describes the shape of a fluctuation, and the signal has no fluctuation.
    #[error("the signal is constant")]
    Constant,
    /// A frequency band begins where the recording ends.
    #[error("the band begins at {low_hz} Hz, but the recording ends at {nyquist_hz} Hz")]
    BandAboveNyquist {
        /// Lower edge of the band, Hz.
        low_hz: f64,
        /// Half the sample rate, Hz.
        nyquist_hz: f64,
    },
    /// The sample rate is too low, or the shaft too fast, for an order.
    #[error("order {order} is asked for, but the recording resolves only {highest}")]
    OrderTooHigh {
        /// The order.
        order: usize,
        /// The highest that the samples per revolution allow.
        highest: usize,
    },
    /// A feature per revolution, order or crank angle of a shaft whose turning is not known.
    #[error("neither speed nor crank angle is known")]
    NoSpeed,
    /// A feature of stated crank angles of a shaft whose zero is not known.
    #[error("where top dead centre is, is not known")]
    NoTopDeadCentre,
    /// A feature of a chamber, of a pressure whose chamber is not known.
    #[error("the chamber that the pressure is of is not known")]
    NoChamber,
    /// There is no channel but the crank angle.
    #[error("there is no channel to analyse")]
    NoChannel,
    /// The range of the sensor cut the signal off.
    #[error("the range of the sensor cut off {percent:.1} % of the samples")]
    CutOff {
        /// Share of the samples that stand in a row at an end of the range.
        percent: f64,
    },
    /// The motion is of a kind whose exponent a signal does not show.
    #[error("the motion is {regime}, not chaotic")]
    NotChaotic {
        /// Name of the regime.
        regime: &'static str,
    },
    /// The kind of motion is not known.
    #[error("the kind of motion is undecided")]
    Undecided,
    /// The motion is chaotic, but the estimates of its exponent differ by as much as their value.
    #[error(
        "the motion is chaotic, but the estimates of its exponent differ by as much as their value"
    )]
    ExponentsDiffer,
    /// No two stretches of the signal are alike.
    #[error("no stretches of the signal are alike")]
    NoMatches,
    /// The motion cannot be analysed.
    #[error(transparent)]
    Motion(#[from] chaos::Error),
    /// The signal cannot be analysed.
    #[error(transparent)]
    Signal(#[from] signal::Error),
}

/// What would give a feature its value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Remedy {
    /// The speed of the shaft, or its angle.
    Speed,
    /// Where top dead centre is.
    TopDeadCentre,
    /// The machine: bore, stroke and rod.
    Machine,
    /// A longer window.
    LongerWindow,
    /// A higher sample rate.
    HigherSampleRate,
}

impl Reason {
    /// What would give the feature its value; none where that is the signal's own matter.
    pub fn remedy(&self) -> Option<Remedy> {
        use signal::Error as Signal;
        match self {
            Self::NoSpeed => Some(Remedy::Speed),
            Self::NoChamber => Some(Remedy::Machine),
            Self::NoTopDeadCentre => Some(Remedy::TopDeadCentre),
            Self::Signal(Signal::TooFewRevolutions { .. } | Signal::TooFewSamples { .. })
            | Self::Motion(chaos::Error::TooShort { .. }) => Some(Remedy::LongerWindow),
            Self::BandAboveNyquist { .. } | Self::OrderTooHigh { .. } => {
                Some(Remedy::HigherSampleRate)
            }
            _ => None,
        }
    }
}
