//! A pin in a bearing: ideal, or with radial clearance.

use super::contact::ContactLaw;
use super::friction::FrictionLaw;
use crate::lift::{Lift, parameters};

/// A revolute joint.
#[derive(Clone, Debug, PartialEq)]
pub enum Revolute<S = f64> {
    /// Journal and bearing centres coincide.
    Ideal,
    /// The journal moves inside the bearing.
    Clear(Clearance<S>),
}

parameters! {
    /// A journal of radius R_j inside a bearing of radius R_j + c.
    pub struct Clearance<S> {
        /// Radial clearance c, m.
        pub clearance: S,
        /// Journal radius R_j, m.
        pub journal_radius: S,
        /// Normal force between the surfaces.
        pub contact: ContactLaw<S>,
        /// Tangential force between the surfaces.
        pub friction: FrictionLaw<S>,
        fixed {
            /// Which motions of the journal the joint tells apart.
            pub model: JointModel,
        }
    }
}

/// Which motions of the journal inside its bearing a joint tells apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum JointModel {
    /// Free flight, impact and following: all three come out of the one contact law (Miedema and
    /// Mansour 1976 name the modes; Ravn 1998 lets a continuous force produce them).
    #[default]
    ThreeMode,
    /// Free flight and following, no impact: at touch the approach velocity is lost without
    /// rebound, the journal then follows the rigid surface until the force would pull.
    TwoMode,
    /// Following only: a massless link of constant length c joins the centres (Earles and Wu
    /// 1973). It has no friction and can pull.
    MasslessLink,
}

impl<S> Lift<S> for Revolute<f64> {
    type Lifted = Revolute<S>;
    fn lift(machines: &[&Self], pack: &mut dyn FnMut(&[f64]) -> S) -> Revolute<S> {
        let parts: Vec<&Clearance> = machines.iter().filter_map(|r| r.clear()).collect();
        assert!(
            parts.is_empty() || parts.len() == machines.len(),
            "machines of different build"
        );
        if parts.is_empty() {
            Revolute::Ideal
        } else {
            Revolute::Clear(Clearance::lift(&parts, pack))
        }
    }
}

impl<S> Revolute<S> {
    /// The clearance, where there is one.
    pub fn clear(&self) -> Option<&Clearance<S>> {
        match self {
            Revolute::Ideal => None,
            Revolute::Clear(clearance) => Some(clearance),
        }
    }
}
