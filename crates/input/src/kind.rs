//! The kinds of quantities.

use crate::dimension::Dimension;

/// A kind of quantity: what a length, a mass, ... is called and measured in.
pub trait Kind {
    /// Its name.
    const NAME: &'static str;
    /// Its name with an article: `a length`.
    const WORDS: &'static str;
    /// Its SI unit.
    const UNIT: &'static str;
    /// Something that people write: `0.1 mm`.
    const EXAMPLE: &'static str;
    /// Its dimension.
    const DIMENSION: Dimension;
    /// How its text is read.
    const READING: Reading = Reading::Plain;
}

/// How the text of a kind of quantity is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reading {
    /// A number and a unit.
    Plain,
    /// `g` is the standard acceleration of gravity, not a gram.
    Gravities,
    /// The word `radial` or `diametral` may follow.
    Sided,
}

/// A row of the table of kinds.
pub(crate) struct KindRow {
    pub(crate) words: &'static str,
    pub(crate) unit: &'static str,
    pub(crate) dimension: Dimension,
}

macro_rules! kinds {
    ($( $name:ident, $words:literal, $unit:literal, $example:literal, $dimension:expr $(, $reading:ident)?; )*) => {
        $(
            #[doc = concat!("Marks ", $words, ", in SI units ", $unit, ".")]
            #[derive(Clone, Copy, Debug, PartialEq)]
            pub struct $name;

            impl Kind for $name {
                const NAME: &'static str = stringify!($name);
                const WORDS: &'static str = $words;
                const UNIT: &'static str = $unit;
                const EXAMPLE: &'static str = $example;
                const DIMENSION: Dimension = $dimension;
                $( const READING: Reading = Reading::$reading; )?
            }
        )*

        pub(crate) const KINDS: &[KindRow] = &[
            $( KindRow { words: $words, unit: $unit, dimension: $dimension } ),*
        ];
    };
}

kinds! {
    Length, "a length", "m", "0.1 mm", Dimension::new(1.0, 0.0, 0.0, 0.0);
    Clearance, "a length", "m", "0.1 mm", Dimension::new(1.0, 0.0, 0.0, 0.0), Sided;
    Mass, "a mass", "kg", "12 kg", Dimension::new(0.0, 1.0, 0.0, 0.0);
    Duration, "a duration", "s", "0.5 s", Dimension::new(0.0, 0.0, 1.0, 0.0);
    Angle, "an angle", "rad", "30 deg", Dimension::new(0.0, 0.0, 0.0, 1.0);
    Speed, "a rotational speed", "rad/s", "500 rpm", Dimension::new(0.0, 0.0, -1.0, 1.0);
    Frequency, "a frequency", "Hz", "10 kHz", Dimension::new(0.0, 0.0, -1.0, 0.0);
    Velocity, "a velocity", "m/s", "0.01 m/s", Dimension::new(1.0, 0.0, -1.0, 0.0);
    Acceleration, "an acceleration", "m/s^2", "9.81 m/s^2", Dimension::new(1.0, 0.0, -2.0, 0.0), Gravities;
    Force, "a force", "N", "200 N", Dimension::new(1.0, 1.0, -2.0, 0.0);
    Torque, "a torque", "N m", "60 N m", Dimension::new(2.0, 1.0, -2.0, 0.0);
    TorqueSlope, "a torque per speed", "N m s", "40 N m s", Dimension::new(2.0, 1.0, -1.0, 0.0);
    Pressure, "a pressure", "Pa", "0.393 MPa", Dimension::new(-1.0, 1.0, -2.0, 0.0);
    Inertia, "a moment of inertia", "kg m^2", "0.6 kg m^2", Dimension::new(2.0, 1.0, 0.0, 0.0);
    Damping, "a damping", "N s/m", "2e4 N s/m", Dimension::new(0.0, 1.0, -1.0, 0.0);
    Area, "an area", "m^2", "2 mm^2", Dimension::new(2.0, 0.0, 0.0, 0.0);
    Compliance, "a length per force", "m/N", "5 nm/N", Dimension::new(0.0, -1.0, 2.0, 0.0);
    Viscosity, "a viscosity", "Pa s", "0.05 Pa s", Dimension::new(-1.0, 1.0, -1.0, 0.0);
    StiffnessPerRoot, "a stiffness in N/m^1.5", "N/m^1.5", "20 GN/m^1.5", Dimension::stiffness(1.5);
    ForcePerPressure, "a force per pressure", "N/Pa", "1e-4 N/Pa", Dimension::new(2.0, 0.0, 0.0, 0.0);
    Ratio, "a percentage", "%", "5 %", Dimension::NONE;
}
