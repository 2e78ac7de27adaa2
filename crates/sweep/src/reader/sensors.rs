//! Which accelerometer a fault is judged by.

use crate::Plan;
use simulate::sensor::Measured;

/// The accelerometers that judge the faults of a dataset. A joint is judged by the first of these
/// that exists: the one on the crosshead of its own throw, the first on the housing of its guide, the first on the frame,
/// that of another crosshead. What belongs to no throw, as the main bearing does, is judged by all of them.
pub struct Sensors {
    channels: Vec<String>,
    /// The name of each throw and the place of its sensor among the channels.
    throws: Vec<(String, usize)>,
}

impl Sensors {
    pub(super) fn new(plan: &Plan) -> Self {
        let names: Vec<&str> = plan.throws().iter().map(String::as_str).collect();
        let measured: Vec<Measured> = plan.base.sensors.iter().map(|s| s.measured).collect();
        let first = |wanted: &dyn Fn(&Measured) -> bool| measured.iter().copied().find(wanted);
        let own = |throw: usize| first(&|m| *m == Measured::CrossheadAcceleration { throw });
        let guide = |own: usize| {
            first(&|m| matches!(m, Measured::HousingAcceleration { throw, .. } if *throw == own))
        };
        let frame = first(&|m| matches!(m, Measured::FrameAcceleration { .. }));
        let other = first(&|m| matches!(m, Measured::CrossheadAcceleration { .. }));
        let mut sensors = Self {
            channels: Vec::new(),
            throws: Vec::new(),
        };
        for (throw, name) in names.iter().enumerate() {
            let Some(sensor) = own(throw).or_else(|| guide(throw)).or(frame).or(other) else {
                continue;
            };
            let column = sensor.column(&names);
            let channel = column.strip_suffix("_m_s2").unwrap_or(&column);
            let known = sensors.channels.iter().position(|known| known == channel);
            let place = known.unwrap_or(sensors.channels.len());
            if known.is_none() {
                sensors.channels.push(channel.to_owned());
            }
            sensors.throws.push(((*name).to_owned(), place));
        }
        sensors
    }

    /// Whether the dataset has no accelerometer.
    pub fn is_empty(&self) -> bool {
        self.channels.is_empty()
    }

    /// The sensors as features are named after them: `throw1.crosshead_acceleration`.
    pub fn channels(&self) -> &[String] {
        &self.channels
    }

    /// The indices of the sensors that judge the fault: those of its throws, in their order. For a
    /// machine without a fault and for joints of no throw, all sensors.
    pub fn of_fault(&self, fault: &str) -> Vec<usize> {
        let places = |joint: &str| -> Vec<usize> {
            let own = joint.split_once('.').map_or("", |(throw, _)| throw);
            let of_throw = self
                .throws
                .iter()
                .filter(|(name, _)| name == own && !["none", "main"].contains(&joint));
            of_throw.map(|(_, place)| *place).collect()
        };
        let mut judging: Vec<usize> = fault.split('+').flat_map(places).collect();
        judging.sort_unstable();
        judging.dedup();
        if judging.is_empty() {
            judging = (0..self.channels.len()).collect();
        }
        judging
    }

    /// The first sensor that judges the fault.
    pub fn first_of_fault(&self, fault: &str) -> Option<usize> {
        self.of_fault(fault).first().copied()
    }

    /// The name of each throw and the channel that its faults are judged by.
    pub fn throws(&self) -> impl Iterator<Item = (&str, &str)> {
        let throws = self.throws.iter();
        throws.map(|(throw, place)| (throw.as_str(), self.channels[*place].as_str()))
    }
}
