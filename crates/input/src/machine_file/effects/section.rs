//! What the section of every effect is made of: its parameters, its place, and what it does.

use super::catalogue::{Choice, Parameter};
use crate::choice::Count;
use crate::error::Error;
use crate::machine_file::Sections;
use crate::quantity::{Bound, Kind, Number, Quantity};
use crate::unit::Dimension;
use mechanism::effects::{self, Law};
use mechanism::{Machine, Throw};
use schemars::JsonSchema;
use serde::Deserialize;
use simulate::{Measured, Sensor};

/// A joint that an effect can act at.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(in crate::machine_file) enum Joint {
    /// Crankshaft in frame.
    Main,
    /// Crank pin in rod.
    BigEnd,
    /// Crosshead pin in rod.
    SmallEnd,
}

/// A chamber of a cylinder.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(in crate::machine_file) enum End {
    /// Between piston and head.
    Head,
    /// Between piston and crank-end cover.
    Crank,
}

/// A kind of sensor.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(in crate::machine_file) enum Measure {
    /// Acceleration of the crosshead along the cylinder.
    CrossheadAcceleration,
    /// Acceleration of the frame.
    FrameAcceleration,
    /// Gas pressure.
    CylinderPressure,
}

/// What is shaken.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(in crate::machine_file) enum Body {
    /// The frame with everything on it.
    Frame,
    /// The crosshead along its guide.
    Crosshead,
}

/// A part of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(in crate::machine_file) enum Part {
    /// What the journal lies in.
    Bearing,
    /// The pin.
    Journal,
}

/// Where a section says that its effect acts.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in crate::machine_file) struct Place {
    pub throw: Option<String>,
    pub joint: Option<Joint>,
    pub end: Option<End>,
    pub measure: Option<Measure>,
    pub body: Option<Body>,
    pub part: Option<Part>,
}

impl Place {
    /// The place in a machine with these throws.
    pub fn resolve(&self, throws: &[Throw]) -> Result<effects::Place, Error> {
        Ok(effects::Place {
            throw: self.throw(throws.iter().map(|t| t.name.as_str()))?,
            joint: self.joint.map(|joint| match joint {
                Joint::Main => effects::Joint::Main,
                Joint::BigEnd => effects::Joint::BigEnd,
                Joint::SmallEnd => effects::Joint::SmallEnd,
            }),
            end: self.end.map(|end| match end {
                End::Head => effects::End::Head,
                End::Crank => effects::End::Crank,
            }),
        })
    }

    /// The index of the throw among those with these names; none for every throw.
    pub fn throw<'a>(&self, names: impl Iterator<Item = &'a str>) -> Result<Option<usize>, Error> {
        let Some(wanted) = &self.throw else {
            return Ok(None);
        };
        let names: Vec<&str> = names.filter(|name| !name.is_empty()).collect();
        match names.iter().position(|name| name == wanted) {
            Some(index) => Ok(Some(index)),
            None => Err(Error::unknown_name("throw", wanted, &names)),
        }
    }

    /// Whether a sensor that sees `measured` is meant.
    pub fn means(&self, measured: &Measured, throws: &[&str]) -> bool {
        let kind = match self.measure.unwrap_or(Measure::CrossheadAcceleration) {
            Measure::CrossheadAcceleration => {
                matches!(measured, Measured::CrossheadAcceleration { .. })
            }
            Measure::FrameAcceleration => matches!(measured, Measured::FrameAcceleration { .. }),
            Measure::CylinderPressure => matches!(measured, Measured::CylinderPressure { .. }),
        };
        let named = measured
            .throw()
            .and_then(|throw| throws.get(throw))
            .copied();
        kind && self
            .throw
            .as_deref()
            .is_none_or(|wanted| named == Some(wanted))
    }
}

/// What the section of an effect tells about itself. [`effect!`] writes it.
pub(super) trait Described {
    /// A sentence that a mechanic understands.
    const SENTENCE: &'static str;
    /// On what part of the machine it acts.
    const KIND: super::Kind;
    /// How it is proposed.
    const PROPOSAL: super::Proposal;
    /// The parameters.
    const PARAMETERS: &'static [Parameter];
    /// The keys of its place.
    const PLACES: &'static [Choice];
}

/// What the section of an effect says. [`effect!`] writes it.
pub(super) trait Section {
    /// The parameters.
    fn parameters(&self) -> &'static [Parameter];

    /// Where it acts.
    fn place(&self) -> Place;

    /// The values of the parameters, SI, in their order; what is left out has its default.
    fn values(&self) -> Vec<f64>;

    /// Which of them the section states.
    fn stated(&self) -> Vec<bool>;
}

/// What an effect does. It has the methods that it needs.
pub(super) trait Act: Section {
    /// The law by which it acts in the equations of motion.
    fn law(&self) -> Option<Law> {
        None
    }

    /// Changes what the file says, before the machine is made of it.
    fn prepare(&self, _file: &mut Sections) -> Result<(), Error> {
        Ok(())
    }

    /// Changes the machine at `_place`.
    fn act(&self, _machine: &mut Machine, _place: &effects::Place) -> Result<(), Error> {
        Ok(())
    }

    /// Changes a sensor of a machine whose throws have the names `_throws`.
    fn sense(&self, _sensor: &mut Sensor, _throws: &[&str]) {}

    /// What tells it apart from the same effect at the same place.
    fn order(&self) -> Option<u32> {
        None
    }
}

/// A value of a file, as the catalogue tells it.
pub(super) trait Valued {
    /// Its dimension; none for a plain number.
    const DIMENSION: Option<Dimension>;
    /// Its SI unit.
    const UNIT: &'static str;
    /// Whether it is whole.
    const WHOLE: bool = false;
    /// The value, SI.
    fn valued(&self) -> f64;
}

impl<K: Kind, B: Bound> Valued for Quantity<K, B> {
    const DIMENSION: Option<Dimension> = Some(K::DIMENSION);
    const UNIT: &'static str = K::UNIT;
    fn valued(&self) -> f64 {
        self.si()
    }
}

impl<B: Bound> Valued for Number<B> {
    const DIMENSION: Option<Dimension> = None;
    const UNIT: &'static str = "";
    fn valued(&self) -> f64 {
        self.get()
    }
}

impl<const LOW: u32, const HIGH: u32> Valued for Count<LOW, HIGH> {
    const DIMENSION: Option<Dimension> = None;
    const UNIT: &'static str = "";
    const WHOLE: bool = true;
    fn valued(&self) -> f64 {
        f64::from(self.get())
    }
}

/// The first of some values that is there.
pub(super) const fn or(value: Option<f64>, other: f64) -> f64 {
    match value {
        Some(value) => value,
        None => other,
    }
}

/// Declares the section of an effect, with what the catalogue says of it:
///
/// ```text
/// effect! {
///     /// What it is.
///     Name at [keys of its place], Kind, Proposal: "A sentence for a mechanic." {
///         /// What the parameter means.
///         key: Type, low to high, start value, absent value;      // an amplitude
///         key: Type, low to high, start value;
///         key: Type, cyclic, start value;                         // a phase
///     }
/// }
/// ```
///
/// A key that is left out has the value of `absent`, else of `start`; a proposal that is left out is
/// [`super::Proposal::PerPlace`].
macro_rules! effect {
    (
        $(#[doc = $about:literal])+
        $name:ident at [$($place:ident),*], $kind:ident $(, $proposal:ident)?: $sentence:literal {
            $(
                $(#[doc = $words:literal])+
                $key:ident: $type:ty, $($cyclic:ident)? $($low:literal to $high:literal)?,
                    start $start:literal $(, absent $absent:literal)?;
            )+
        }
    ) => {
        effect! {
            @section [$(#[doc = $about])+ $name]
            [$( $(#[doc = $words])+ #[serde(default)] $key: Option<$type>, )+]
            $($place)*
        }

        impl $name {
            $(
                $(#[doc = $words])+
                #[allow(dead_code)]
                fn $key(&self) -> f64 {
                    use super::section::{Valued, or};
                    let absent: Option<f64> = None $(.or(Some($absent)))?;
                    self.$key.map_or(or(absent, $start), |value| value.valued())
                }
            )+
        }

        impl super::section::Described for $name {
            const SENTENCE: &'static str = $sentence;
            const KIND: super::Kind = super::Kind::$kind;
            const PROPOSAL: super::Proposal = effect!(@proposal $($proposal)?);
            const PARAMETERS: &'static [super::Parameter] = &[$(
                super::Parameter {
                    key: stringify!($key),
                    words: concat!($($words),+).trim_ascii(),
                    dimension: <$type as super::section::Valued>::DIMENSION,
                    unit: <$type as super::section::Valued>::UNIT,
                    bounds: effect!(@bounds $($cyclic)? $($low to $high)?),
                    start: $start,
                    absent: effect!(@absent $($absent)?),
                    whole: <$type as super::section::Valued>::WHOLE,
                    cyclic: effect!(@cyclic $($cyclic)?),
                },
            )+];
            const PLACES: &'static [super::Choice] = &[$( effect!(@choice $place) ),*];
        }

        impl super::section::Section for $name {
            fn parameters(&self) -> &'static [super::Parameter] {
                <Self as super::section::Described>::PARAMETERS
            }

            fn place(&self) -> super::section::Place {
                #[allow(clippy::needless_update)]
                super::section::Place {
                    $( $place: self.$place.clone().into(), )*
                    ..Default::default()
                }
            }

            fn values(&self) -> Vec<f64> {
                vec![$( self.$key() ),+]
            }

            fn stated(&self) -> Vec<bool> {
                vec![$( self.$key.is_some() ),+]
            }
        }
    };

    (@section $head:tt [$($fields:tt)*] throw $($rest:ident)*) => {
        effect! { @section $head [$($fields)*
            /// Name of the throw; every one where it is left out.
            #[serde(default)]
            throw: Option<String>,
        ] $($rest)* }
    };
    (@section $head:tt [$($fields:tt)*] joint $($rest:ident)*) => {
        effect! { @section $head [$($fields)*
            /// The joint.
            joint: super::section::Joint,
        ] $($rest)* }
    };
    (@section $head:tt [$($fields:tt)*] end $($rest:ident)*) => {
        effect! { @section $head [$($fields)*
            /// The chamber; both where it is left out.
            #[serde(default)]
            end: Option<super::section::End>,
        ] $($rest)* }
    };
    (@section $head:tt [$($fields:tt)*] measure $($rest:ident)*) => {
        effect! { @section $head [$($fields)*
            /// What the sensor measures; crosshead_acceleration where it is left out.
            #[serde(default)]
            measure: Option<super::section::Measure>,
        ] $($rest)* }
    };
    (@section $head:tt [$($fields:tt)*] body $($rest:ident)*) => {
        effect! { @section $head [$($fields)*
            /// What is shaken; frame where it is left out.
            #[serde(default)]
            body: Option<super::section::Body>,
        ] $($rest)* }
    };
    (@section $head:tt [$($fields:tt)*] part $($rest:ident)*) => {
        effect! { @section $head [$($fields)*
            /// Which of the two; bearing where it is left out.
            #[serde(default)]
            part: Option<super::section::Part>,
        ] $($rest)* }
    };
    (@section [$(#[$meta:meta])+ $name:ident] [$($fields:tt)*]) => {
        $(#[$meta])+
        #[derive(Clone, Debug, PartialEq, serde::Deserialize, schemars::JsonSchema)]
        #[serde(deny_unknown_fields)]
        pub(in crate::machine_file) struct $name {
            $($fields)*
        }
    };

    (@proposal) => { super::Proposal::PerPlace };
    (@proposal $proposal:ident) => { super::Proposal::$proposal };
    (@bounds $low:literal to $high:literal) => { [$low, $high] };
    (@bounds turn) => { [0.0, std::f64::consts::TAU] };
    (@bounds half_turn) => { [0.0, std::f64::consts::PI] };
    (@cyclic) => { false };
    (@cyclic $cyclic:ident) => { true };
    (@absent) => { None };
    (@absent $absent:literal) => { Some($absent) };

    (@choice throw) => { effect!(@choice "throw", [], false) };
    (@choice joint) => {
        effect!(@choice "joint", ["main", "big_end", "small_end"], true)
    };
    (@choice end) => {
        effect!(@choice "end", ["head", "crank"], false)
    };
    (@choice measure) => {
        effect!(
            @choice "measure", ["crosshead_acceleration", "frame_acceleration", "cylinder_pressure"], false)
    };
    (@choice body) => {
        effect!(@choice "body", ["frame", "crosshead"], false)
    };
    (@choice part) => {
        effect!(@choice "part", ["bearing", "journal"], false)
    };
    (@choice $key:literal, $words:expr, $required:literal) => {
        super::Choice { key: $key, words: &$words, required: $required }
    };
}

pub(in crate::machine_file::effects) use effect;
