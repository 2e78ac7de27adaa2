//! The motion that a machine settles on.

use crate::asked::Asked;
use crate::error::Error;
use crate::run::Run;
use crate::warm_start::WarmStart;

/// The motion that a machine settles on from where it begins, nothing being recorded; none where its transient does not end.
///
/// # Errors
/// As [`sensitivities`](crate::sensitivities()).
pub fn settle(asked: &Asked) -> Result<Option<WarmStart>, Error> {
    let mut run = Run::begin(asked, asked.machine.clone(), false);
    run.hurry();
    let (_, period) = run.leave_transient(asked.settings.transient)?;
    Ok(period.map(|_| WarmStart {
        machine: asked.machine.clone(),
        state: run.strobe(),
        mode: run.dynamics().mode().clone(),
    }))
}
