//! How far long work is: a bar on a terminal, and nothing elsewhere.

use std::io::{self, IsTerminal};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

use crate::flow::health::words;

/// How often the time that is left is told anew.
const TICK: Duration = Duration::from_secs(1);

/// The bar, its count, the rate and the time that is left.
const BAR: &str = "{msg} [{bar:24}] {pos}/{len}  {rate}  {left}";

/// Work of many equal parts.
#[derive(Debug)]
pub struct Progress {
    bar: ProgressBar,
}

impl Progress {
    /// Work of so many parts. It is shown where standard error is a terminal that can show it and
    /// there is more than one part.
    pub fn of(parts: usize, what: &'static str) -> Progress {
        let dumb = std::env::var_os("TERM").is_none_or(|term| term == "dumb" || term.is_empty());
        if parts < 2 || dumb || !io::stderr().is_terminal() {
            return Progress { bar: ProgressBar::hidden() };
        }
        let bar = ProgressBar::with_draw_target(Some(parts as u64), ProgressDrawTarget::stderr());
        // The template is a constant: one that were wrong would leave the bar as it is.
        if let Ok(style) = ProgressStyle::with_template(BAR) {
            let rate = |state: &ProgressState, to: &mut dyn std::fmt::Write| {
                let _ = to.write_str(&rate(state.per_sec()));
            };
            let left = |state: &ProgressState, to: &mut dyn std::fmt::Write| {
                let _ = to.write_str(&left(state.pos(), state.eta()));
            };
            bar.set_style(
                style.progress_chars("##-").with_key("rate", rate).with_key("left", left),
            );
        }
        bar.set_message(what);
        bar.enable_steady_tick(TICK);
        Progress { bar }
    }

    /// One part more is done.
    pub fn advance(&self) {
        self.bar.inc(1);
    }

    /// Does what writes to the terminal, without the bar in its way.
    pub fn aside<T>(&self, write: impl FnOnce() -> T) -> T {
        self.bar.suspend(write)
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// Parts in a second, or in a minute where they take long.
fn rate(per_second: f64) -> String {
    match per_second {
        rate if !rate.is_finite() || rate <= 0.0 => "-/s".to_owned(),
        rate if rate < 0.5 => format!("{:.1}/min", 60.0 * rate),
        rate => format!("{rate:.1}/s"),
    }
}

/// The time that is left; before the first part is done nobody can say.
fn left(done: u64, eta: Duration) -> String {
    if done == 0 { String::new() } else { format!("{} left", words(eta)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rate_is_told_in_the_unit_that_shows_it() {
        let told = [(2.04, "2.0/s"), (0.5, "0.5/s"), (0.25, "15.0/min"), (0.0, "-/s")];
        told.into_iter().for_each(|(per_second, text)| assert_eq!(rate(per_second), text));
        assert_eq!(rate(f64::INFINITY), "-/s");
    }

    #[test]
    fn the_time_left_is_told_once_there_is_something_to_tell_it_by() {
        assert_eq!(left(0, Duration::from_secs(9)), "");
        assert_eq!(left(1, Duration::from_secs(200)), "3 minutes left");
    }

    #[test]
    fn the_bar_says_nothing_where_nobody_looks() {
        // Tests have no terminal.
        let progress = Progress::of(10, "scans");
        assert!(progress.bar.is_hidden() && Progress::of(1, "scans").bar.is_hidden());
    }
}
