//! The option of every verb that reads a bundle.

use clap::Args;
use input::bundle::Bundle;
use std::path::Path;

/// Whether a bundle may name recordings outside of its folder.
#[derive(Args, Clone, Copy, Debug, Default)]
pub struct AllowOutside {
    /// Read recordings outside of the bundle's folder, too, where its recordings.yaml names them
    #[arg(long)]
    pub allow_outside: bool,
}

impl AllowOutside {
    /// Reads the bundle at `path`.
    ///
    /// # Errors
    /// As [`Bundle::read`].
    pub fn read(self, path: &Path) -> Result<Bundle, input::Error> {
        let mut bundle = Bundle::read(path)?;
        bundle.allow_outside = self.allow_outside;
        Ok(bundle)
    }
}
