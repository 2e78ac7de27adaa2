//! Results for the gas of a chamber whose pressure was recorded.

use super::ByName;
use crate::indicator::{self, Indicator};
use crate::pressure_gap::{self, PressureGap};
use serde::{Deserialize, Serialize};

/// The pressure of a chamber in a run: recorded, and simulated.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gas {
    /// Root mean square of simulated less recorded pressure over a revolution, Pa.
    pub rms_pa: Rms,
    /// The parts of the cycle; none where the recording shows no cycle.
    #[serde(rename = "where")]
    pub phases: Vec<Phase>,
    /// The indicator diagram of the recorded pressure; `None` where it shows no cycle.
    pub measured: Option<Diagram>,
    /// The same of the calibrated pressure, at the calibrated clearance.
    pub calibrated: Option<Diagram>,
}

/// Root mean squares of a difference of pressures, Pa.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rms {
    /// With the nominal parameters.
    pub nominal: f64,
    /// With the calibrated ones.
    pub calibrated: f64,
}

/// A part of the cycle, and how far the calibrated pressure is off in it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Phase {
    /// `expansion`, `suction`, `compression` or `discharge`.
    pub phase: String,
    /// Where it begins and ends, deg.
    pub crank_angle_deg: [f64; 2],
    /// Root mean square of calibrated less recorded pressure in it, Pa.
    pub rms_pa: f64,
    /// Its share of the squared differences of the revolution.
    pub share: f64,
}

/// An indicator diagram.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Diagram {
    /// Median pressure of the suction line, Pa.
    pub suction_pa: f64,
    /// Median pressure of the discharge line, Pa.
    pub discharge_pa: f64,
    /// Clearance over stroke.
    pub clearance_share: f64,
    /// Compression.
    pub compression: Polytrope,
    /// Expansion.
    pub expansion: Polytrope,
    /// The same curve read with two other clearances.
    pub alternatives: [Alternative; 2],
    /// When the valves open and close.
    pub valve_events: ValveEvents,
}

/// A straight piece of ln p over ln V.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Polytrope {
    /// Where it begins and ends, deg.
    pub crank_angle_deg: [f64; 2],
    /// The exponent n of p Vⁿ.
    pub exponent: f64,
    /// How much the exponent rises where the clearance grows by one stroke.
    pub exponent_per_clearance_share: f64,
    /// Root mean square of ln p about the line.
    pub scatter: f64,
}

/// A curve read with another clearance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Alternative {
    /// Clearance over stroke.
    pub clearance_share: f64,
    /// Exponent of the compression.
    pub compression_exponent: f64,
    /// Exponent of the expansion.
    pub expansion_exponent: f64,
    /// Root mean square of ln p about both lines.
    pub scatter: f64,
}

/// The effective events of a chamber's valves.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ValveEvents {
    /// The suction valve opens.
    pub suction_opens: Event,
    /// The suction valve closes.
    pub suction_closes: Event,
    /// The discharge valve opens.
    pub discharge_opens: Event,
    /// The discharge valve closes.
    pub discharge_closes: Event,
}

/// An effective event of a valve.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Event {
    /// Where the polytrope meets the median pressure of the line, deg.
    pub crank_angle_deg: f64,
    /// Where it meets the first quartile of the line, in the order of the revolution, deg.
    pub low: f64,
    /// Where it meets the other quartile, deg.
    pub high: f64,
}

/// Each gap by run and by column.
pub(super) fn by_run(gaps: &[PressureGap]) -> ByName<ByName<Gas>> {
    let runs = gaps.chunk_by(|a, b| a.run == b.run);
    let of = |gap: &PressureGap| (gap.column.clone(), Gas::from_gap(gap));
    runs.map(|run| (run[0].run.clone(), run.iter().map(of).collect()))
        .collect()
}

impl Gas {
    fn from_gap(gap: &PressureGap) -> Self {
        let [nominal, calibrated] = gap.rms();
        let phase = |phase: pressure_gap::Phase| Phase {
            phase: phase.name.to_owned(),
            crank_angle_deg: phase.angles.map(f64::to_degrees),
            rms_pa: phase.rms,
            share: phase.share,
        };
        Self {
            rms_pa: Rms {
                nominal,
                calibrated,
            },
            phases: gap.phases().into_iter().map(phase).collect(),
            measured: gap.indicator.as_ref().map(Diagram::from_indicator),
            calibrated: gap.fitted_indicator.as_ref().map(Diagram::from_indicator),
        }
    }
}

impl Diagram {
    fn from_indicator(indicator: &Indicator) -> Self {
        let stroke = indicator.chamber.stroke();
        let polytrope = |p: &indicator::Polytrope| Polytrope {
            crank_angle_deg: p.angles.map(f64::to_degrees),
            exponent: p.exponent,
            exponent_per_clearance_share: p.exponent_per_clearance * stroke,
            scatter: p.scatter,
        };
        Self {
            suction_pa: indicator.suction.pressure,
            discharge_pa: indicator.discharge.pressure,
            clearance_share: indicator.chamber.clearance / stroke,
            compression: polytrope(&indicator.compression),
            expansion: polytrope(&indicator.expansion),
            alternatives: indicator.alternatives.map(|other| Alternative {
                clearance_share: other.clearance / stroke,
                compression_exponent: other.exponents[0],
                expansion_exponent: other.exponents[1],
                scatter: other.scatter,
            }),
            valve_events: ValveEvents::from_events(&indicator.events),
        }
    }
}

impl ValveEvents {
    /// The events with their names, in the order of the cycle's suction and discharge.
    pub fn each(&self) -> [(&'static str, Event); 4] {
        [
            ("suction_opens", self.suction_opens),
            ("suction_closes", self.suction_closes),
            ("discharge_opens", self.discharge_opens),
            ("discharge_closes", self.discharge_closes),
        ]
    }

    fn from_events(events: &indicator::ValveEvents) -> Self {
        let of = |event: &indicator::Event| {
            let [low, high] = event.quartiles.map(f64::to_degrees);
            Event {
                crank_angle_deg: event.angle.to_degrees(),
                low,
                high,
            }
        };
        Self {
            suction_opens: of(&events.suction_opens),
            suction_closes: of(&events.suction_closes),
            discharge_opens: of(&events.discharge_opens),
            discharge_closes: of(&events.discharge_closes),
        }
    }
}
