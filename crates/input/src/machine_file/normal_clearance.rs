//! Up to which clearances a machine is healthy.

/// Clearances up to which joints count as healthy, m, where the file states them. Of a joint
/// without one, the clearance that it has in the machine file is normal.
#[derive(Clone, Debug, PartialEq)]
pub struct NormalClearance {
    /// Of the main bearing.
    pub main: Option<f64>,
    /// Of each throw's joints.
    pub throws: Vec<ThrowNormalClearance>,
}

/// Clearances up to which the joints of a throw count as healthy, m, where the file states them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThrowNormalClearance {
    /// Of the big end.
    pub big_end: Option<f64>,
    /// Of the small end.
    pub small_end: Option<f64>,
    /// Of the crosshead guide.
    pub guide: Option<f64>,
}
