//! Taking plain parameters over into another scalar: one machine into dual numbers, or several
//! machines of the same build into lanes.

use scalar::{Dual, Lanes, Scalar};

/// A set of parameters written over plain numbers that can be packed into scalars of type `S`.
pub trait Lift<S> {
    /// The same parameters over `S`.
    type Lifted;

    /// Packs corresponding numbers of `machines` with `pack`.
    ///
    /// Panics where the machines differ in build (another law, another number of throws): that
    /// is a mistake of the caller, who groups cases by build.
    fn lift(machines: &[&Self], pack: &mut dyn FnMut(&[f64]) -> S) -> Self::Lifted;
}

impl<S> Lift<S> for f64 {
    type Lifted = S;
    fn lift(machines: &[&Self], pack: &mut dyn FnMut(&[f64]) -> S) -> S {
        let values: Vec<f64> = machines.iter().map(|x| **x).collect();
        pack(&values)
    }
}

impl<S, T: Lift<S>> Lift<S> for Option<T> {
    type Lifted = Option<T::Lifted>;
    fn lift(machines: &[&Self], pack: &mut dyn FnMut(&[f64]) -> S) -> Self::Lifted {
        let parts: Vec<&T> = machines.iter().filter_map(|m| m.as_ref()).collect();
        assert!(
            parts.is_empty() || parts.len() == machines.len(),
            "machines of different build"
        );
        (!parts.is_empty()).then(|| T::lift(&parts, pack))
    }
}

impl<S, T: Lift<S>> Lift<S> for Vec<T> {
    type Lifted = Vec<T::Lifted>;
    fn lift(machines: &[&Self], pack: &mut dyn FnMut(&[f64]) -> S) -> Self::Lifted {
        let length = machines[0].len();
        assert!(
            machines.iter().all(|m| m.len() == length),
            "machines of different build"
        );
        (0..length)
            .map(|i| {
                let parts: Vec<&T> = machines.iter().map(|m| &m[i]).collect();
                T::lift(&parts, pack)
            })
            .collect()
    }
}

impl<S, T: Lift<S>, const N: usize> Lift<S> for [T; N] {
    type Lifted = [T::Lifted; N];
    fn lift(machines: &[&Self], pack: &mut dyn FnMut(&[f64]) -> S) -> Self::Lifted {
        std::array::from_fn(|i| {
            let parts: Vec<&T> = machines.iter().map(|m| &m[i]).collect();
            T::lift(&parts, pack)
        })
    }
}

/// `plain` with every number a constant of the scalar `S`.
pub fn constants<S: Scalar, T: Lift<S>>(plain: &T) -> T::Lifted {
    T::lift(&[plain], &mut |x| S::constant(x[0]))
}

/// What of `plain` must be the same in lanes: everything but its numbers.
pub fn build<T: Lift<()>>(plain: &T) -> T::Lifted {
    T::lift(&[plain], &mut |_| ())
}

/// `W` machines of the same build, side by side.
pub fn lanes<L: Lanes<W>, const W: usize, T: Lift<L>>(machines: [&T; W]) -> T::Lifted {
    T::lift(&machines, &mut |x| {
        L::from_array(std::array::from_fn(|lane| x[lane]))
    })
}

/// `plain` with its derivative along the line to `moved`: the tangent of every number is how much
/// it differs between the two.
pub fn directional<T: Lift<Dual<f64, 1>>>(plain: &T, moved: &T) -> T::Lifted {
    gradient(plain, [moved])
}

/// `plain` with its derivatives along the lines to each of `moved`.
pub fn gradient<const N: usize, T: Lift<Dual<f64, N>>>(plain: &T, moved: [&T; N]) -> T::Lifted {
    let all: Vec<&T> = std::iter::once(plain).chain(moved).collect();
    T::lift(&all, &mut |x| Dual {
        value: x[0],
        tangent: std::array::from_fn(|i| x[i + 1] - x[0]),
    })
}

/// Declares a struct of parameters over a scalar, and how it is lifted field by field.
macro_rules! parameters {
    (
        $(#[$meta:meta])*
        pub struct $name:ident<S> {
            $( $(#[$field_meta:meta])* pub $field:ident : $kind:ty, )*
            $( fixed { $( $(#[$fixed_meta:meta])* pub $fixed:ident : $fixed_kind:ty, )* } )?
        }
    ) => {
        $(#[$meta])*
        #[derive(Clone, Debug, PartialEq)]
        pub struct $name<S = f64> {
            $( $(#[$field_meta])* pub $field: $kind, )*
            $( $( $(#[$fixed_meta])* pub $fixed: $fixed_kind, )* )?
        }

        impl<S> $crate::lift::Lift<S> for $name<f64> {
            type Lifted = $name<S>;
            fn lift(machines: &[&Self], pack: &mut dyn FnMut(&[f64]) -> S) -> $name<S> {
                $name {
                    $( $field: {
                        let parts: Vec<_> = machines.iter().map(|m| &m.$field).collect();
                        $crate::lift::Lift::lift(&parts, pack)
                    }, )*
                    $( $( $fixed: {
                        let first = &machines[0].$fixed;
                        assert!(
                            machines.iter().all(|m| m.$fixed == *first),
                            "machines of different build"
                        );
                        first.clone()
                    }, )* )?
                }
            }
        }
    };
}

/// Declares an enum of alternatives, each holding one struct of parameters.
macro_rules! alternatives {
    (
        $(#[$meta:meta])*
        pub enum $name:ident<S> { $( $(#[$variant_meta:meta])* $variant:ident($kind:ident), )* }
    ) => {
        $(#[$meta])*
        #[derive(Clone, Debug, PartialEq)]
        pub enum $name<S = f64> { $( $(#[$variant_meta])* $variant($kind<S>), )* }

        impl<S> $crate::lift::Lift<S> for $name<f64> {
            type Lifted = $name<S>;
            fn lift(machines: &[&Self], pack: &mut dyn FnMut(&[f64]) -> S) -> $name<S> {
                match machines[0] {
                    $( $name::$variant(_) => {
                        let parts: Vec<_> = machines
                            .iter()
                            .map(|m| match m {
                                $name::$variant(inner) => inner,
                                #[allow(unreachable_patterns)]
                                _ => panic!("machines of different build"),
                            })
                            .collect();
                        $name::$variant($crate::lift::Lift::lift(&parts, pack))
                    } )*
                }
            }
        }
    };
}

pub(crate) use {alternatives, parameters};
