//! The progress of long work: a bar on a terminal, nothing elsewhere.

use std::io::{self, IsTerminal};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

use gaiter_flow::words::duration;
use gaiter_language::Language;

/// How often the remaining time is updated.
const TICK: Duration = Duration::from_secs(1);

/// The bar, its count, the rate and the remaining time.
const BAR: &str = "{msg} [{bar:24}] {pos}/{len}  {rate}  {left}";

/// Work that consists of many equal parts.
#[derive(Debug)]
pub struct Progress {
    bar: ProgressBar,
}

impl Progress {
    /// Work of this many parts. The bar is shown if there is more than one part and standard error is a
    /// terminal that can show it.
    pub fn new(parts: usize, what: &'static str) -> Progress {
        let dumb = std::env::var_os("TERM").is_none_or(|term| term == "dumb" || term.is_empty());
        if parts < 2 || dumb || !io::stderr().is_terminal() {
            return Progress { bar: ProgressBar::hidden() };
        }
        let bar = ProgressBar::with_draw_target(Some(parts as u64), ProgressDrawTarget::stderr());
        // The template is a constant. If it were wrong, the bar would keep its default style.
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

    /// Counts one more part as done.
    pub fn advance(&self) {
        self.bar.inc(1);
    }

    /// Runs something that writes to the terminal, with the bar out of the way.
    pub fn aside<T>(&self, write: impl FnOnce() -> T) -> T {
        self.bar.suspend(write)
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// Parts per second, or per minute if they take long.
fn rate(per_second: f64) -> String {
    match per_second {
        rate if !rate.is_finite() || rate <= 0.0 => "-/s".to_owned(),
        rate if rate < 0.5 => format!("{:.1}/min", 60.0 * rate),
        rate => format!("{rate:.1}/s"),
    }
}

/// The remaining time, which is unknown before the first part is done.
fn left(done: u64, eta: Duration) -> String {
    if done == 0 { String::new() } else { format!("{} left", duration(eta, Language::En)) }
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
        // Tests run without a terminal.
        let progress = Progress::new(10, "scans");
        assert!(progress.bar.is_hidden() && Progress::new(1, "scans").bar.is_hidden());
    }
}
