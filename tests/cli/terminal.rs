//! What gaiter shows on a terminal, and what of it goes to pipes: nothing that only eyes can use.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs::{self, File};
use std::path::Path;
use std::process::{Child, Command, Stdio};

use rig::pty;
use rig::verb::{code, program, stdout};
use rig::{Booth, Daemon};
use support::coarse_body;

/// A verb of which some standard streams are a terminal.
struct Shown {
    child: Child,
    terminal: pty::Box,
    /// Held open: what a terminal was told last is lost when nobody has it open any more.
    _slave: File,
    /// What it has shown by now.
    seen: String,
}

impl Shown {
    /// Runs a verb whose standard output, or error, is a terminal of this kind.
    fn on_terminal(args: &[&str], stream: Stream, environment: &[(&str, &str)]) -> Shown {
        let terminal = pty::Box::new();
        let slave = || File::options().read(true).write(true).open(&terminal.port).unwrap();
        let mut command = Command::new(program());
        command.args(args).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        match stream {
            Stream::Output => command.stdout(slave()),
            Stream::Error => command.stderr(slave()).stdout(Stdio::null()),
        };
        plain(&mut command).env("TERM", "xterm").envs(environment.iter().copied());
        let child = command.spawn().unwrap();
        Shown { child, _slave: slave(), terminal, seen: String::new() }
    }

    /// Waits until what was shown is so, or the verb has ended; what was shown.
    fn until(&mut self, booth: &Booth, what: &str, holds: impl Fn(&str) -> bool) -> &str {
        booth.wait_for(what, || {
            let ended = self.child.try_wait().unwrap().is_some();
            // All that there is, for a verb that has ended says no more.
            loop {
                let told = self.terminal.was_told();
                if told.is_empty() {
                    break;
                }
                self.seen += &String::from_utf8_lossy(&told);
            }
            holds(&self.seen) || ended
        });
        assert!(holds(&self.seen), "{what}: {:?}", self.seen);
        &self.seen
    }
}

#[derive(Clone, Copy)]
enum Stream {
    Output,
    Error,
}

/// Without what the tests' own terminal wants, and without `CI`, for which even a dumb terminal is
/// given colours.
fn plain(command: &mut Command) -> &mut Command {
    ["NO_COLOR", "CLICOLOR", "CLICOLOR_FORCE", "CI"].iter().for_each(|name| {
        command.env_remove(name);
    });
    command
}

/// A running station that is ready, with one record.
fn station() -> (Booth, Daemon) {
    let booth = Booth::new();
    let daemon = booth.start();
    booth.export("4711_a.obj", &coarse_body(1));
    booth.wait_for_records(1);
    booth.wait_for("readiness", || code(&booth.gaiter(&["status"])) == Some(0));
    (booth, daemon)
}

#[test]
fn colours_are_for_whoever_can_see_them_and_wants_them() {
    let (booth, daemon) = station();
    let config = booth.path("station.toml");
    let args = ["status", "--config", config.to_str().unwrap()];
    for (environment, coloured) in
        [(vec![], true), (vec![("NO_COLOR", "1")], false), (vec![("TERM", "dumb")], false)]
    {
        let mut shown = Shown::on_terminal(&args, Stream::Output, &environment);
        let seen = shown.until(&booth, "the status", |seen| seen.contains("disk"));
        assert_eq!(seen.contains('\u{1b}'), coloured, "{environment:?}: {seen:?}");
        assert!(seen.contains("ready"), "{seen:?}");
    }

    let piped = |name: &str, value: &str| {
        let mut command = Command::new(program());
        plain(&mut command).args(["status", "--config"]).arg(&config).env(name, value);
        stdout(&command.output().unwrap())
    };
    assert!(!piped("TERM", "xterm").contains('\u{1b}'));
    assert!(piped("CLICOLOR_FORCE", "1").contains('\u{1b}'));
    assert_eq!(daemon.stop().code(), Some(0));
}

#[test]
fn long_work_shows_how_far_it_is_on_a_terminal_only() {
    let booth = Booth::new();
    let scans = booth.path("scans");
    fs::create_dir(&scans).unwrap();
    (0..3).for_each(|n| fs::write(scans.join(format!("{n}.obj")), coarse_body(n)).unwrap());
    let args = ["extract", scans.to_str().unwrap()];
    let mut shown = Shown::on_terminal(&args, Stream::Error, &[]);
    let seen = shown.until(&booth, "the end", |seen| seen.contains("3/3"));
    assert!(seen.contains("measuring") && seen.contains(" left"), "{seen:?}");
    assert_eq!(shown.child.wait().unwrap().code(), Some(0));
    for (scan, environment) in [(Path::new("."), ("TERM", "dumb")), (Path::new("0.obj"), ("A", ""))]
    {
        let scan = scans.join(scan);
        let args = ["extract", scan.to_str().unwrap()];
        let mut shown = Shown::on_terminal(&args, Stream::Error, &[environment]);
        booth.wait_for("the end", || shown.child.try_wait().unwrap().is_some());
        assert_eq!(shown.terminal.was_told(), b"", "{environment:?}");
    }
}
