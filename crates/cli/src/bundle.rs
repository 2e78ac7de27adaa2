//! Options of verbs that read a bundle.

use clap::Args;

/// Whether a bundle may name recordings outside of its folder.
#[derive(Args, Clone, Copy, Debug, Default)]
pub struct AllowOutside {
    /// Read recordings outside of the bundle's folder, too, where its recordings.yaml names them
    #[arg(long)]
    pub allow_outside: bool,
}

/// What the runs of a bundle are used for.
#[derive(Args, Clone, Debug)]
pub struct Runs {
    /// Predict this run and do not fit to it; may be repeated
    #[arg(long, value_name = "RUN")]
    pub hold_out: Vec<String>,
    /// Do not use this run at all; may be repeated
    #[arg(long, value_name = "RUN")]
    pub leave_out: Vec<String>,
    #[command(flatten)]
    pub outside: AllowOutside,
}
