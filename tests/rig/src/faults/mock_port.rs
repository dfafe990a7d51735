//! A port that plays a script in the script's own time: what arrives on its line, when it is unplugged
//! and when it is plugged in again.
//!
//! ```text
//! +120ms bytes "PRESS\r\n"      +5ms closed        +50ms open
//! +1s    unplug                 +2s  plug          +0s  vanish | busy | denied
//! +10ms  report 01 00           +8ms down 48       +8ms up 48
//! +8ms   repeat 48              +8ms held 42 48    +8ms lost 42
//! ```
//!
//! Each time counts from the line before. A line with any other word is left to the player of the
//! script; `#` begins a comment.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use gaiter::config::port::escaped;
use gaiter::station::booth::trigger::port::{Port, PortOpener, fault};
use gaiter_flow::trigger::{Input, KeyAction, PortFault, PortFaultKind};

/// What a line of a script does.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Act {
    /// The port delivers this input.
    Gives(Input),
    /// It is unplugged, or cannot be opened any more for this reason.
    Gone(PortFaultKind),
    /// It is unplugged, but reading it does not fail and returns nothing.
    Vanishes,
    /// It is plugged in and can be opened.
    Plugged,
    /// For the player of the script.
    Other(String),
}

/// A script: what happens when.
pub type Script = VecDeque<(Duration, Act)>;

/// Reads a script.
///
/// # Errors
/// The line that cannot be read.
pub fn script(text: &str) -> Result<Script, String> {
    let mut at = Duration::ZERO;
    let lines = text.lines().map(str::trim);
    let lines = lines.filter(|line| !line.is_empty() && !line.starts_with('#'));
    lines
        .map(|line| {
            let wrong = || format!("cannot be read: {line}");
            let (after, what) = line.split_once(' ').ok_or_else(wrong)?;
            at += time(after).ok_or_else(wrong)?;
            Ok((at, act(what.trim()).ok_or_else(wrong)?))
        })
        .collect()
}

fn time(text: &str) -> Option<Duration> {
    let text = text.strip_prefix('+')?;
    let (number, unit) = text.split_at(text.find(|c: char| !c.is_ascii_digit())?);
    let number = number.parse().ok()?;
    match unit {
        "ms" => Some(Duration::from_millis(number)),
        "s" => Some(Duration::from_secs(number)),
        _ => None,
    }
}

fn act(what: &str) -> Option<Act> {
    let (word, rest) = what.split_once(' ').unwrap_or((what, ""));
    let key = |action| Some(Act::Gives(Input::Key { code: rest.parse().ok()?, action }));
    let keys = || {
        let codes = rest.split_whitespace().map(|code| code.parse::<u16>().ok());
        codes.collect::<Option<Vec<u16>>>()
    };
    match word {
        "bytes" => {
            let text = rest.strip_prefix('"')?.strip_suffix('"')?;
            Some(Act::Gives(Input::Bytes(escaped(text)?)))
        }
        "closed" => Some(Act::Gives(Input::Closed(true))),
        "open" => Some(Act::Gives(Input::Closed(false))),
        "report" => {
            let bytes = rest.split(' ').map(|byte| u8::from_str_radix(byte, 16).ok());
            Some(Act::Gives(Input::Report(bytes.collect::<Option<_>>()?)))
        }
        "down" => key(KeyAction::Down),
        "up" => key(KeyAction::Up),
        "repeat" => key(KeyAction::Repeat),
        "held" => Some(Act::Gives(Input::KeysHeld(keys()?))),
        "lost" => Some(Act::Gives(Input::KeysLost(keys()?))),
        "unplug" => Some(Act::Gone(PortFaultKind::Absent)),
        "busy" => Some(Act::Gone(PortFaultKind::Busy)),
        "denied" => Some(Act::Gone(PortFaultKind::Denied)),
        "vanish" => Some(Act::Vanishes),
        "plug" => Some(Act::Plugged),
        _ => Some(Act::Other(what.to_owned())),
    }
}

/// The state of the stage.
#[derive(Debug)]
struct Scene {
    script: Script,
    now: Duration,
    /// Why the port is not available; `None` while it is.
    gone: Option<PortFaultKind>,
    /// How often a port was plugged in; tells the current port from earlier ones.
    plugging: u32,
    silent: bool,
    closed: bool,
    given: VecDeque<Input>,
    written: Vec<Vec<u8>>,
    opened: u32,
}

/// Where a script is played. Its ports and its player share it.
#[derive(Debug, Clone)]
pub struct Stage {
    scene: Arc<Mutex<Scene>>,
    sampled: bool,
}

impl Stage {
    /// Creates a stage with a present port and a script to play; sampled if it has a contact.
    pub fn new(script: Script, sampled: bool) -> Stage {
        let scene = Scene {
            script,
            now: Duration::ZERO,
            gone: None,
            plugging: 0,
            silent: false,
            closed: false,
            given: VecDeque::new(),
            written: Vec::new(),
            opened: 0,
        };
        Stage { scene: Arc::new(Mutex::new(scene)), sampled }
    }

    /// The opener that finds the port.
    pub fn opener(&self) -> Box<dyn PortOpener> {
        Box::new(MockOpener(self.clone()))
    }

    /// The time of the script.
    pub fn now(&self) -> Duration {
        self.scene().now
    }

    /// How often the port was opened.
    pub fn opened(&self) -> u32 {
        self.scene().opened
    }

    /// The next bytes that were written to the port and not fetched yet.
    pub fn written(&self) -> Option<Vec<u8>> {
        let mut scene = self.scene();
        (!scene.written.is_empty()).then(|| scene.written.remove(0))
    }

    /// What the player has to do now.
    pub fn other(&self) -> Option<String> {
        let mut scene = self.scene();
        match scene.script.front() {
            Some((at, Act::Other(what))) if *at <= scene.now => {
                let what = what.clone();
                scene.script.pop_front();
                Some(what)
            }
            _ => None,
        }
    }

    /// Whether the script has ended.
    pub fn is_over(&self) -> bool {
        self.scene().script.is_empty()
    }

    /// Lets time pass without a listener, up to the next line for the player.
    pub fn pass(&self, time: Duration) {
        let mut scene = self.scene();
        let until = scene.now + time;
        while scene.step(until) {}
        // No one was listening.
        scene.given.clear();
    }

    fn scene(&self) -> MutexGuard<'_, Scene> {
        self.scene.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Scene {
    /// Advances to the next line of the script before `until`, or to `until`. Returns whether there was
    /// a line that is not for the player.
    fn step(&mut self, until: Duration) -> bool {
        match self.script.front() {
            Some((at, Act::Other(_))) if *at <= until => {
                self.now = self.now.max(*at);
                false
            }
            Some((at, _)) if *at <= until => {
                self.now = self.now.max(*at);
                let act = self.script.pop_front();
                act.into_iter().for_each(|(_, act)| self.play(act));
                true
            }
            _ => {
                self.now = until;
                false
            }
        }
    }

    fn play(&mut self, act: Act) {
        match act {
            Act::Gives(Input::Closed(closed)) => self.closed = closed,
            Act::Gives(input) if self.gone.is_none() => self.given.push_back(input),
            Act::Gives(_) | Act::Other(_) => {}
            Act::Gone(kind) => (self.gone, self.silent) = (Some(kind), false),
            Act::Vanishes => (self.gone, self.silent) = (Some(PortFaultKind::Absent), true),
            Act::Plugged => {
                (self.gone, self.silent) = (None, false);
                self.plugging += 1;
                self.given.clear();
            }
        }
    }
}

struct MockOpener(Stage);

impl PortOpener for MockOpener {
    fn open(&mut self) -> Result<Box<dyn Port>, PortFault> {
        let mut scene = self.0.scene();
        if let Some(kind) = scene.gone {
            return Err(fault(kind, "so says the script"));
        }
        scene.opened += 1;
        scene.given.clear();
        let plugging = scene.plugging;
        Ok(Box::new(MockPort { stage: self.0.clone(), plugging, sample_next: true }))
    }
}

struct MockPort {
    stage: Stage,
    plugging: u32,
    sample_next: bool,
}

impl MockPort {
    fn is_there(&self, scene: &Scene) -> bool {
        scene.gone.is_none() && scene.plugging == self.plugging
    }
}

impl Port for MockPort {
    fn read(&mut self, timeout: Duration) -> Result<Input, PortFault> {
        let mut scene = self.stage.scene();
        if self.stage.sampled && std::mem::take(&mut self.sample_next) && self.is_there(&scene) {
            return Ok(Input::Closed(scene.closed));
        }
        self.sample_next = true;
        let until = scene.now + timeout;
        loop {
            if !self.is_there(&scene) && !scene.silent {
                return Err(fault(PortFaultKind::Absent, "it was pulled out"));
            }
            if let Some(input) = scene.given.pop_front() {
                return Ok(input);
            }
            if !scene.step(until) {
                return Ok(Input::Nothing);
            }
        }
    }

    fn write(&mut self, bytes: &[u8]) -> Result<(), PortFault> {
        let mut scene = self.stage.scene();
        if !self.is_there(&scene) {
            return Err(fault(PortFaultKind::Absent, "it was pulled out"));
        }
        scene.written.push(bytes.to_vec());
        Ok(())
    }

    fn is_in_place(&mut self) -> Result<(), PortFault> {
        let scene = self.stage.scene();
        let there = self.is_there(&scene);
        if there { Ok(()) } else { Err(fault(PortFaultKind::Absent, "it was pulled out")) }
    }
}
