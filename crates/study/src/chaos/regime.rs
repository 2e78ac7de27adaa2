//! The regimes that a motion can be in.

/// What kind of motion it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Regime {
    /// Repeats itself after this many revolutions; 0 where the number is not known.
    Periodic(u32),
    /// Has two or more frequencies that have no common multiple.
    QuasiPeriodic,
    /// Deterministic, and neighbouring motions part.
    Chaotic,
    /// Not distinguishable from noise.
    Stochastic,
    /// The data do not decide.
    Undecided,
}

impl Regime {
    /// The regime of a label of the data, with its period in revolutions where that is known.
    /// None for any other text.
    pub fn from_label(label: &str, period: Option<u32>) -> Option<Self> {
        Some(match label {
            "periodic" => Self::Periodic(period.unwrap_or(0)),
            "quasi-periodic" => Self::QuasiPeriodic,
            "chaotic" => Self::Chaotic,
            "stochastic" => Self::Stochastic,
            "undecided" => Self::Undecided,
            _ => return None,
        })
    }

    /// The kinds, in the order of tables.
    pub const KINDS: [Self; 5] = [
        Self::Periodic(0),
        Self::QuasiPeriodic,
        Self::Chaotic,
        Self::Stochastic,
        Self::Undecided,
    ];

    /// Which of [`Regime::KINDS`] it is.
    pub fn kind(self) -> usize {
        match self {
            Self::Periodic(_) => 0,
            Self::QuasiPeriodic => 1,
            Self::Chaotic => 2,
            Self::Stochastic => 3,
            Self::Undecided => 4,
        }
    }

    /// Its label, without the period.
    pub fn label(self) -> &'static str {
        [
            "periodic",
            "quasi-periodic",
            "chaotic",
            "stochastic",
            "undecided",
        ][self.kind()]
    }

    /// Its letter on a map, with the period where it is more than one revolution.
    pub fn letters(self) -> String {
        match self {
            Self::Periodic(period @ 2..) => format!("P{period}"),
            other => ["P", "Q", "C", "S", "?"][other.kind()].to_owned(),
        }
    }

    /// How dark it is on a map, from 0 to 1.
    pub fn tint(self) -> f64 {
        [0.3, 0.5, 1.0, 0.75, 0.0][self.kind()]
    }
}
