//! Licences of datasets.

/// A licence, by its identifiers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Licence {
    /// Its SPDX identifier: `CC-BY-4.0`.
    pub spdx: &'static str,
    /// What Hugging Face calls it: `cc-by-4.0`.
    pub hub: &'static str,
}

impl Licence {
    /// No rights reserved.
    pub const CC0: Self = Self::new("CC0-1.0", "cc0-1.0");

    /// The licence of these identifiers.
    pub const fn new(spdx: &'static str, hub: &'static str) -> Self {
        Self { spdx, hub }
    }

    /// Where its text is.
    pub fn url(self) -> String {
        format!("https://spdx.org/licenses/{}", self.spdx)
    }
}
