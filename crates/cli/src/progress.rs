//! How far long work has come, on standard error: a line that is redrawn on a terminal, a new line now and
//! then elsewhere (a file, a scheduler's log). Nothing with `--quiet`.

use crate::console;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{self, IsTerminal};
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// How often the clock is redrawn on a terminal.
const TICK: Duration = Duration::from_millis(500);

/// Time between two lines elsewhere: work that is shorter says nothing.
const PAUSE: Duration = Duration::from_secs(10);

/// Progress of one piece of work. It ends where it is dropped.
pub(crate) struct Progress {
    /// How far it has come.
    pub(crate) bar: ProgressBar,
    lines: Option<Lines>,
}

impl Progress {
    /// Of `total` things (none where their number is not known), called `what`. `template` is the line on
    /// a terminal, as indicatif has it.
    pub(crate) fn new(what: &str, total: Option<u64>, template: &str) -> Self {
        let on_terminal = io::stderr().is_terminal() && !console::is_quiet();
        let target = match on_terminal {
            true => ProgressDrawTarget::stderr(),
            false => ProgressDrawTarget::hidden(),
        };
        let bar = ProgressBar::with_draw_target(total, target);
        if on_terminal {
            if let Ok(style) = ProgressStyle::with_template(template) {
                bar.set_style(style);
            }
            bar.enable_steady_tick(TICK);
        }
        let lines = (!on_terminal && !console::is_quiet()).then(|| {
            let (bar, what) = (bar.clone(), what.to_owned());
            Lines::start(PAUSE, move || eprintln!("{}", line(&bar, &what)))
        });
        Self { bar, lines }
    }

    /// Of windows, whose number is not known.
    pub(crate) fn of_windows() -> Self {
        let template = "{spinner} {pos} windows  {per_sec}  {elapsed}";
        Self::new("windows", None, template)
    }

    /// Shows the time alone while the `work` called `what` is done.
    pub(crate) fn during<T>(what: &str, work: impl FnOnce() -> T) -> T {
        let _shown = Self::new(what, None, &format!("{{spinner}} {what}  {{elapsed}}"));
        work()
    }

    /// Nothing.
    pub(crate) fn hidden() -> Self {
        Self {
            bar: ProgressBar::hidden(),
            lines: None,
        }
    }

    /// What is to be said beside the count.
    pub(crate) fn say(&self, message: &str) {
        self.bar.set_message(crate::output::harmless(message));
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.lines = None;
        self.bar.finish_and_clear();
    }
}

/// The line where nothing can be redrawn.
fn line(bar: &ProgressBar, what: &str) -> String {
    let count = match (bar.length(), bar.position()) {
        (Some(total), done) => format!("{done} of {total} {what}"),
        (None, 0) => what.to_owned(),
        (None, done) => format!("{done} {what}"),
    };
    let message = bar.message();
    let message = match message.is_empty() {
        true => String::new(),
        false => format!(", {message}"),
    };
    format!("{count}{message}, after {} s", bar.elapsed().as_secs())
}

/// Lines that are written now and then until this is dropped.
struct Lines(Option<(Sender<()>, JoinHandle<()>)>);

impl Lines {
    fn start(pause: Duration, write: impl Fn() + Send + 'static) -> Self {
        let (end, ended) = mpsc::channel::<()>();
        let thread = thread::spawn(move || {
            while ended.recv_timeout(pause) == Err(RecvTimeoutError::Timeout) {
                write();
            }
        });
        Self(Some((end, thread)))
    }
}

impl Drop for Lines {
    fn drop(&mut self) {
        if let Some((end, thread)) = self.0.take() {
            drop(end);
            // A thread that could not write has said all that it will.
            let _ = thread.join();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::{Arc, Mutex};

    #[test]
    fn lines_come_again_and_again_until_the_work_ends() {
        let said = Arc::new(Mutex::new(0));
        let counter = Arc::clone(&said);
        let lines = Lines::start(Duration::from_millis(5), move || {
            *counter.lock().unwrap() += 1;
        });
        while *said.lock().unwrap() < 3 {
            thread::sleep(Duration::from_millis(1));
        }
        drop(lines);
        let last = *said.lock().unwrap();
        thread::sleep(Duration::from_millis(50));
        assert_eq!(*said.lock().unwrap(), last);
    }

    #[test]
    fn a_line_says_how_many_of_how_many_and_what() {
        let bar = ProgressBar::hidden();
        assert!(line(&bar, "replaying").starts_with("replaying, after 0 s"));
        bar.set_position(3);
        bar.set_message("misfit 2.1");
        assert_eq!(line(&bar, "cases"), "3 cases, misfit 2.1, after 0 s");
        bar.set_length(10);
        assert_eq!(line(&bar, "cases"), "3 of 10 cases, misfit 2.1, after 0 s");
    }
}
