//! How fast a sweep is, by the times at which its shards were finished.

use std::time::SystemTime;

use super::layout::COMMITS;
use super::output::Output;
use crate::{Error, Plan};

/// The last shards that count.
const LAST_SHARDS: usize = 10;
/// A pause is so many times as long as the median time from one shard to the next.
const PAUSE: f64 = 10.0;

/// Cases a second over the last shards, those that failed included: 1/s. Pauses, in which no process was at work, do not
/// count. None before a second shard is finished.
///
/// # Errors
/// Storage that cannot be read.
pub fn cases_per_second(output: &Output, plan: &Plan) -> Result<Option<f64>, Error> {
    let mut finished: Vec<(SystemTime, u64)> = Vec::new();
    for name in output.store.names(COMMITS)? {
        let shard = name
            .strip_suffix(".json")
            .and_then(|name| name.parse().ok());
        let Some(shard) = shard.filter(|shard| *shard < plan.shards()) else {
            continue;
        };
        let time = output.store.modified(&format!("{COMMITS}/{name}"))?;
        let cases = plan.shard(shard);
        finished.extend(time.map(|time| (time, cases.end - cases.start)));
    }
    finished.sort_unstable();
    let last = finished.len().saturating_sub(LAST_SHARDS + 1);
    Ok(rate(&finished[last..]))
}

/// The rate by the time at which each shard was finished and its cases, in the order of the times.
fn rate(finished: &[(SystemTime, u64)]) -> Option<f64> {
    let steps = finished.windows(2).map(|pair| {
        let time = pair[1].0.duration_since(pair[0].0);
        (time.map_or(0.0, |time| time.as_secs_f64()), pair[1].1)
    });
    let steps: Vec<(f64, u64)> = steps.collect();
    let mut times: Vec<f64> = steps.iter().map(|(time, _)| *time).collect();
    times.sort_by(f64::total_cmp);
    let median = *times.get(times.len() / 2)?;
    let worked = steps.iter().filter(|(time, _)| *time <= PAUSE * median);
    let (time, cases) = worked.fold((0.0, 0), |sum, step| (sum.0 + step.0, sum.1 + step.1));
    (time > 0.0).then(|| cases as f64 / time)
}

#[cfg(test)]
mod tests {
    use super::rate;
    use std::time::{Duration, UNIX_EPOCH};

    #[test]
    fn pauses_do_not_count() {
        let at = |seconds: u64, cases| (UNIX_EPOCH + Duration::from_secs(seconds), cases);
        assert_eq!(rate(&[]), None);
        assert_eq!(rate(&[at(5, 8)]), None);
        assert_eq!(rate(&[at(5, 8), at(9, 8)]), Some(2.0));
        // The last shard is smaller, and a night lies between two.
        let night = [at(0, 8), at(4, 8), at(8, 8), at(40_000, 8), at(40_002, 4)];
        assert_eq!(rate(&night), Some(2.0));
        // Shards of processes side by side end together.
        assert_eq!(rate(&[at(7, 8), at(7, 8)]), None);
    }
}
