//! What a law says of itself: the words, units and ranges from which files, schemas, tables and
//! searches are made.

/// The declaration of a law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Declaration {
    /// Name of its type, and of its section in a schema.
    pub type_name: &'static str,
    /// What it is.
    pub about: &'static str,
    /// What shows it, in a sentence that a mechanic understands.
    pub sentence: &'static str,
    /// Its equation, in short.
    pub law: &'static str,
    /// Its source; empty for none.
    pub source: &'static str,
    /// On what part of the machine it acts.
    pub kind: Kind,
    /// How a program that looks for a missing effect proposes it.
    pub proposal: Proposal,
    /// Parameters of other effects that this one has as well: the effect's name and the key.
    pub includes: &'static [(&'static str, &'static str)],
    /// Its parameters, in the order of its section.
    pub parameters: &'static [Parameter],
    /// Keys that say where it acts.
    pub places: &'static [PlaceKey],
}

/// The part of the machine that an effect acts on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The gas of a cylinder, so that the pressure there shows it.
    Gas,
    /// A joint: its clearance, its shape, its oil.
    Joint,
    /// Crank, rod or crosshead.
    RunningGear,
    /// The frame.
    Frame,
    /// A sensor or the encoder: the machine itself is as it was.
    Sensor,
}

/// How a program that looks for a missing effect proposes it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Proposal {
    /// At each place that the machine has, with one set of values.
    PerPlace,
    /// The same, but where both ends of a cylinder have it, each end has values of its own: it is a
    /// fault of one valve.
    PerEnd,
    /// As `PerPlace`, from the fluctuation that an encoder shows, too.
    CrankSpeed,
    /// It is the zero of the crank angle: fitted from the start, and proposed where pressures are all that was
    /// recorded.
    CrankAngleZero,
    /// By a search for a frequency that is no order of the crank.
    Hum,
    /// By a sparse regression on its terms: a force law without a name.
    ForceLaw,
}

impl Proposal {
    /// Whether it is not tried at each place as others are.
    pub fn is_separate(self) -> bool {
        matches!(self, Self::Hum | Self::ForceLaw)
    }
}

/// A parameter of a law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Its key.
    pub key: &'static str,
    /// What it means.
    pub words: &'static str,
    /// What it is a value of.
    pub quantity: Quantity,
    /// Which values it may have.
    pub range: Range,
    /// Between which values it is plausible, SI.
    pub bounds: [f64; 2],
    /// A usual value where the law acts, SI.
    pub start: f64,
    /// The value at which the effect vanishes, if it is an amplitude, SI.
    pub absent: Option<f64>,
    /// True for an angle whose bounds are a period of its law apart, a turn or a part of one: it has no ends.
    pub cyclic: bool,
    /// True where it is a form of the law and no size: the laws that the literature has for the effect differ in it.
    pub shape: bool,
    /// The value of the form that is other than the usual one, where that is not the end of its bounds, SI.
    pub other: Option<f64>,
}

impl Parameter {
    /// The value where a file states none, SI.
    pub fn default(&self) -> f64 {
        self.absent.unwrap_or(self.start)
    }

    /// What it is a value of, and which values it may have.
    pub fn declared(&self) -> (Quantity, Range) {
        (self.quantity, self.range)
    }
}

/// What a parameter is a value of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// A plain number.
    Number,
    /// A share, written in %.
    Ratio,
    /// m.
    Length,
    /// m, radial: half of the diametral one, which a file may state as such.
    Clearance,
    /// rad.
    Angle,
    /// rad/s.
    Speed,
    /// Hz.
    Frequency,
    /// s.
    Duration,
    /// m/s.
    Velocity,
    /// m/s².
    Acceleration,
    /// N.
    Force,
    /// N s/m.
    Damping,
    /// m².
    Area,
    /// m/N.
    Compliance,
    /// Pa.
    Pressure,
    /// Pa s.
    Viscosity,
    /// N/m^1.5.
    StiffnessPerRoot,
    /// N/Pa.
    ForcePerPressure,
}

/// Which values a parameter may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Range {
    /// Every finite one.
    Any,
    /// Above 0.
    AboveZero,
    /// From 0.
    FromZero,
    /// From 0, below 1.
    ProperPart,
    /// Angles from 0 to 180 deg.
    OnTheStroke,
    /// From 1.
    FromOne,
    /// Above 0, up to 1.
    Rebound,
    /// Whole numbers between these two, both included.
    Whole(u32, u32),
}

/// A value that does not go together with the machine.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Clash {
    /// Key of the value.
    pub key: &'static str,
    /// What belongs there.
    pub expected: String,
}

/// A key that says where an effect acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlaceKey {
    /// A throw by its name.
    Throw,
    /// Main bearing, big end or small end. It must be there.
    Joint,
    /// Head end or crank end.
    End,
    /// What a sensor measures.
    Measure,
    /// Frame or crosshead.
    Body,
    /// Bearing or journal.
    Part,
}

/// Declares an effect. The module gets `DECLARATION` and a struct `Values` of plain numbers, SI; with
/// `as Law` also `law`, which makes the law from them where the names of its fields are the keys.
///
/// ```text
/// declaration! {
///     /// What it is.
///     Name at [keys of its place], Kind, Proposal includes effect.key: "What shows it."
///     law "its equation" after "its source" {
///         /// What the parameter means.
///         key: Quantity(Range), low to high, start value, absent value;      // an amplitude
///         key: Quantity(Range), low to high, start value;
///         key: Angle(Any), turn, start value;                                // a phase
///         @shape key: Quantity(Range), low to high, start value, other value; // a form of the law, and another one
///     }
/// }
/// ```
///
/// A form whose `other` is left out is otherwise at the end of its bounds.
/// A key that is left out has the value of `absent`, else of `start`; a proposal that is left out is
/// [`Proposal::PerPlace`]. `includes` is for an effect that has a parameter of another one as well.
#[macro_export]
macro_rules! declaration {
    (
        $(#[doc = $about:literal])+
        $name:ident at [$($place:ident),*], $kind:ident
            $(, $proposal:ident $(includes $effect:ident.$included:ident)?)?: $sentence:literal
        law $law:literal after $source:literal {
            $(
                $(#[doc = $words:literal])+
                $(@$shape:ident)? $key:ident: $quantity:ident($range:expr), $($cyclic:ident)? $($low:literal to $high:literal)?,
                    start $start:literal $(, absent $absent:literal)? $(, other $other:literal)?;
            )+
        } $(as $type:ident)?
    ) => {
        /// What files, schemas, tables and searches know of the effect.
        pub const DECLARATION: $crate::declaration::Declaration = {
            #[allow(unused_imports)]
            use $crate::declaration::{Declaration, Kind, Parameter, PlaceKey, Quantity, Range::*};
            Declaration {
                type_name: stringify!($name),
                about: concat!($($about),+).trim_ascii(),
                sentence: $sentence,
                law: $law,
                source: $source,
                kind: Kind::$kind,
                proposal: $crate::declaration!(@proposal $($proposal)?),
                includes: &[$($( (stringify!($effect), stringify!($included)) )?)?],
                parameters: &[$( Parameter {
                    key: stringify!($key),
                    words: concat!($($words),+).trim_ascii(),
                    quantity: Quantity::$quantity,
                    range: $range,
                    bounds: $crate::declaration!(@bounds $($cyclic)? $($low to $high)?),
                    start: $start,
                    absent: $crate::declaration!(@optional $($absent)?),
                    other: $crate::declaration!(@optional $($other)?),
                    cyclic: $crate::declaration!(@cyclic $($cyclic)?),
                    shape: $crate::declaration!(@shape $($shape)?),
                } ),+],
                places: &[$( PlaceKey::$place ),*],
            }
        };

        /// Values of the parameters, SI.
        #[derive(Clone, Copy, Debug)]
        pub struct Values {
            $( $(#[doc = $words])+ pub $key: f64, )+
        }

        impl Values {
            /// The values in the order of the declaration.
            pub fn new(values: &[f64]) -> Self {
                let mut values = values.iter().copied();
                Self { $( $key: values.next().unwrap_or($start), )+ }
            }
        }

        $crate::declaration! { @law [$($key)+] $($type)? }
    };

    (@law [$($key:ident)+]) => {};
    (@law [$($key:ident)+] $type:ident) => {
        /// The law with these values.
        pub fn law(values: &[f64], _: $crate::effects::Alternatives) -> $type {
            let Values { $($key),+ } = Values::new(values);
            $type { $($key),+ }
        }
    };
    (@proposal) => { $crate::declaration::Proposal::PerPlace };
    (@proposal $proposal:ident) => { $crate::declaration::Proposal::$proposal };
    (@bounds $low:literal to $high:literal) => { [$low, $high] };
    (@bounds turn) => { [0.0, std::f64::consts::TAU] };
    (@bounds half_turn) => { [0.0, std::f64::consts::PI] };
    (@bounds third_of_turn) => { [0.0, std::f64::consts::TAU / 3.0] };
    (@cyclic) => { false };
    (@cyclic $cyclic:ident) => { true };
    (@shape) => { false };
    (@shape $shape:ident) => { true };
    (@optional) => { None };
    (@optional $value:literal) => { Some($value) };
}
