//! What gaiter shows on a terminal, and what of it goes to pipes: nothing that only eyes can use.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs::{self, File};
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};

use rig::pty;
use rig::verb::{code, gaiter, program, stdout};
use rig::{Booth, Daemon};
use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;
use support::coarse_body;

/// To the other screen of the terminal, back, and to the upper left corner.
const ENTER: &str = "\x1b[?1049h";
const LEAVE: &str = "\x1b[?1049l";
const HOME: &str = "\x1b[H";

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

    fn signal(&self, signal: Signal) {
        kill_process(Pid::from_child(&self.child), signal).unwrap();
    }

    fn is_stopped(&self) -> bool {
        let stat = fs::read_to_string(format!("/proc/{}/stat", self.child.id())).unwrap();
        // The state comes after the name in brackets.
        stat.rsplit_once(") ").unwrap().1.starts_with('T')
    }

    fn interrupt(&mut self) -> ExitStatus {
        interrupt(&mut self.child)
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

/// As Ctrl-C does.
fn interrupt(child: &mut Child) -> ExitStatus {
    let pid = Pid::from_raw(child.id().try_into().unwrap()).unwrap();
    kill_process(pid, Signal::INT).unwrap();
    child.wait().unwrap()
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

fn watch(booth: &Booth) -> [String; 4] {
    let config = booth.path("station.toml").to_string_lossy().into_owned();
    ["status".to_owned(), "--watch".to_owned(), "--config".to_owned(), config]
}

#[test]
fn a_watch_is_renewed_in_place_and_leaves_the_terminal_as_it_was() {
    let (booth, daemon) = station();
    let args = watch(&booth);
    let args: Vec<&str> = args.iter().map(String::as_str).collect();
    let mut shown = Shown::on_terminal(&args, Stream::Output, &[]);
    let renewed = |seen: &str| seen.matches(HOME).count() >= 3;
    let seen = shown.until(&booth, "three screens", renewed);
    assert!(seen.starts_with(ENTER), "{seen:?}");
    let first = seen.split(HOME).nth(1).unwrap();
    assert!(first.lines().count() <= 24, "{first}");
    assert!(first.contains("ready\u{1b}[0m") && first.contains("delivered"), "{first:?}");
    // Ctrl-Z gives the shell its screen, and what goes on has its own again.
    shown.signal(Signal::TSTP);
    booth.wait_for("the stop", || shown.is_stopped());
    shown.until(&booth, "the shell's screen", |seen| seen.ends_with(LEAVE));
    shown.signal(Signal::CONT);
    let again = |seen: &str| seen.rsplit_once(ENTER).is_some_and(|(_, seen)| seen.contains(HOME));
    shown.until(&booth, "its screen again", |seen| seen.contains(LEAVE) && again(seen));
    // A station that is gone is told on the same screen.
    assert_eq!(daemon.stop().code(), Some(0));
    shown.until(&booth, "the missing station", |seen| seen.contains("no station runs"));
    assert_eq!(shown.interrupt().code(), Some(0));
    shown.until(&booth, "the old screen", |seen| seen.ends_with(LEAVE));
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
    // A watch without colours is still renewed in place; a terminal that cannot do that is a pipe.
    let args = watch(&booth);
    let args: Vec<&str> = args.iter().map(String::as_str).collect();
    let mut bare = Shown::on_terminal(&args, Stream::Output, &[("NO_COLOR", "1")]);
    let seen = bare.until(&booth, "two screens", |seen| seen.matches(HOME).count() >= 2);
    assert!(seen.starts_with(ENTER) && !seen.contains("\u{1b}[0m"), "{seen:?}");
    assert_eq!(bare.interrupt().code(), Some(0));
    let mut dumb = Shown::on_terminal(&args, Stream::Output, &[("TERM", "dumb")]);
    let seen = dumb.until(&booth, "two texts", |seen| seen.matches("disk").count() >= 2);
    assert!(!seen.contains('\u{1b}'), "{seen:?}");
    assert_eq!(dumb.interrupt().code(), Some(0));

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
fn on_a_pipe_a_watch_is_one_text_after_the_other_and_for_programs_a_line_each() {
    let (booth, daemon) = station();
    let piped = |more: &[&str]| {
        let mut command = Command::new(program());
        plain(&mut command).args(watch(&booth)).args(more).stdout(Stdio::piped());
        command.spawn().unwrap()
    };
    let mut text = piped(&[]);
    let lines = BufReader::new(text.stdout.take().unwrap()).lines().map(Result::unwrap);
    let mut firsts = 0;
    for line in lines {
        assert!(!line.contains('\u{1b}'), "{line:?}");
        firsts += usize::from(line == "ready");
        if firsts == 2 {
            break;
        }
    }
    assert_eq!(firsts, 2);
    // Nobody reads any more: that is its end, and no fault.
    assert_eq!(text.wait().unwrap().code(), Some(0));

    let mut program = piped(&["--json"]);
    let mut lines = BufReader::new(program.stdout.take().unwrap()).lines().map(Result::unwrap);
    for _ in 0..2 {
        let status: Value = serde_json::from_str(&lines.next().unwrap()).unwrap();
        assert_eq!(
            (&status["schema"], &status["ready"]),
            (&"gaiter.status/1".into(), &true.into())
        );
    }
    assert_eq!(daemon.stop().code(), Some(0));
    let fault = lines.map(|line| serde_json::from_str::<Value>(&line).unwrap());
    let fault = fault.into_iter().find(|line| line.get("fault").is_some()).unwrap();
    assert_eq!(fault["fault"]["code"], "no-station");
    assert_eq!(interrupt(&mut program).code(), Some(0));
}

#[test]
fn a_watch_without_a_configuration_ends_at_once() {
    let dir = tempfile::tempdir().unwrap();
    let config = dir.path().join("missing.toml");
    let output = gaiter(&["status", "--watch", "--config", config.to_str().unwrap()]);
    assert_eq!(code(&output), Some(66));
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
