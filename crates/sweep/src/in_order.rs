//! Work in parallel, results in order, memory bounded by the look-ahead.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::mpsc;

use crate::Error;

/// Applies `work` to `inputs` on the threads of `pool`, and hands the results to `sink`, on this
/// thread (which must not be one of the pool's), in the order of the inputs.
///
/// At most `look_ahead` inputs are under way or wait for their turn at any time, so one slow input
/// holds up the others only when that many have overtaken it.
///
/// # Errors
/// The first error of `sink`. What is under way is then finished and thrown away.
pub fn in_order<I: Send, T: Send, E>(
    pool: &rayon::ThreadPool,
    look_ahead: usize,
    mut inputs: impl Iterator<Item = I>,
    work: impl Fn(&I) -> T + Sync,
    mut sink: impl FnMut(I, T) -> Result<(), E>,
) -> Result<(), E> {
    let work = &work;
    pool.in_place_scope(|scope| {
        let (sender, results) = mpsc::channel();
        let mut waiting = BTreeMap::new();
        let (mut started, mut done) = (0, 0);
        loop {
            while started - done < look_ahead.max(1)
                && let Some(input) = inputs.next()
            {
                let (turn, sender) = (started, sender.clone());
                started += 1;
                scope.spawn(move |_| {
                    let result = catch_unwind(AssertUnwindSafe(|| work(&input)));
                    // Nobody listens once the sink has failed.
                    let _ = sender.send((turn, input, result));
                });
            }
            if done == started {
                return Ok(());
            }
            if let Ok((turn, input, result)) = results.recv() {
                waiting.insert(turn, (input, result));
            }
            while let Some((input, result)) = waiting.remove(&done) {
                done += 1;
                sink(input, result.unwrap_or_else(|panic| resume_unwind(panic)))?;
            }
        }
    })
}

/// So many threads, at least one, for [`in_order`].
pub(crate) fn pool(threads: usize) -> Result<rayon::ThreadPool, Error> {
    let threads = threads.max(1);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map_err(|e| Error::Threads {
        threads,
        reason: e.to_string(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering::SeqCst};
    use std::time::Duration;

    #[test]
    fn results_come_in_order_and_never_more_than_the_look_ahead_at_once() {
        for (threads, look_ahead) in [(1, 1), (2, 4), (3, 5)] {
            let (alive, most) = (AtomicUsize::new(0), AtomicUsize::new(0));
            let mut seen = Vec::new();
            let inputs = (0..60).inspect(|_| {
                let now = alive.fetch_add(1, SeqCst) + 1;
                most.fetch_max(now, SeqCst);
            });
            in_order(
                &pool(threads).unwrap(),
                look_ahead,
                inputs,
                |&i: &u64| {
                    // Some inputs are overtaken by many.
                    let pause = if i % 7 == 0 { 2_000 } else { 10 };
                    std::thread::sleep(Duration::from_micros(pause));
                    i * i
                },
                |i, square| {
                    alive.fetch_sub(1, SeqCst);
                    seen.push((i, square));
                    Ok::<(), ()>(())
                },
            )
            .unwrap();
            assert_eq!(seen, (0..60).map(|i| (i, i * i)).collect::<Vec<_>>());
            assert!(most.into_inner() <= look_ahead);
        }
    }

    #[test]
    fn the_first_error_of_the_sink_ends_it() {
        let worked = AtomicUsize::new(0);
        let result = in_order(
            &pool(2).unwrap(),
            3,
            0..1_000_000,
            |_| worked.fetch_add(1, SeqCst),
            |i, _| if i == 5 { Err(i) } else { Ok(()) },
        );
        assert_eq!(result, Err(5));
        assert!(worked.into_inner() <= 8);
    }

    #[test]
    fn a_panic_of_the_work_is_passed_on() {
        let pool = pool(2).unwrap();
        let result = catch_unwind(AssertUnwindSafe(|| {
            in_order(
                &pool,
                2,
                0..10,
                |&i| assert_ne!(i, 4),
                |_, ()| Ok::<(), ()>(()),
            )
        }));
        assert!(result.is_err());
    }
}
