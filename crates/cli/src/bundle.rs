//! The option of every verb that reads a bundle.

use clap::Args;

/// Whether a bundle may name recordings outside of its folder.
#[derive(Args, Clone, Copy, Debug, Default)]
pub struct AllowOutside {
    /// Read recordings outside of the bundle's folder, too, where its recordings.yaml names them
    #[arg(long)]
    pub allow_outside: bool,
}
