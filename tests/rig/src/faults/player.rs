//! Plays the scripts of `fixtures/trigger`: a configuration, `---`, and what happens at the port,
//! with what is expected of it in between.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::collections::VecDeque;
use std::time::Duration;

use gaiter::config;
use gaiter::config::port::escaped;
use gaiter::station::booth::trigger::{Attendant, of_config};
use gaiter_flow::booth::{PortEvent, Press, Signal};

use super::mock_port::{Script, Stage, script};

/// Turns that a port may take in a second of its script; more would be spinning.
const TURNS_A_SECOND: u32 = 250;

const STATION: &str = r#"
[station]
id = "booth-1"
state_dir = "/s"
[scanner]
export_dirs = ["/e"]
[store.folder]
path = "/r"
"#;

/// A port under the time of its script.
pub struct Player {
    pub stage: Stage,
    pub attendant: Attendant,
    pub heard: VecDeque<PortEvent>,
    pub lines: usize,
    signal: Signal,
    turns: u32,
}

impl Player {
    /// The port of this configuration, with a script.
    pub fn new(toml: &str, script: Script) -> Player {
        let config = config::load(&format!("{STATION}{toml}")).unwrap_or_else(|faults| {
            panic!("{}", faults.iter().map(|fault| format!("{fault:#}\n")).collect::<String>())
        });
        let mut ports = of_config(&config.trigger);
        assert_eq!(ports.len(), 1, "a script is about one port");
        let port = ports.remove(0);
        let stage = Stage::new(script, port.manner.sampled);
        let attendant = Attendant::new(stage.opener(), port.decoder, port.manner, Duration::ZERO);
        let (heard, signal) = (VecDeque::new(), Signal::Ready);
        Player { stage, attendant, heard, lines: 0, signal, turns: 0 }
    }

    /// One turn of the port's thread, and the pause after it.
    pub fn turn(&mut self) {
        let (stage, mut heard) = (self.stage.clone(), Vec::new());
        let pause = self.attendant.turn(&|| stage.now(), self.signal, &mut heard);
        self.heard.extend(heard);
        let told = self.attendant.lifecycle().state_to_log(self.stage.now());
        self.lines += usize::from(told.is_some());
        if !pause.is_zero() {
            self.stage.pass(pause);
        }
        self.turns += 1;
    }

    /// Plays the script to its end; says what was not as it should be.
    pub fn play(&mut self) -> Vec<String> {
        let mut wrong = Vec::new();
        while !self.stage.is_over() {
            while let Some(line) = self.stage.other() {
                if let Err(fault) = self.part(&line) {
                    wrong.push(format!("{:?}: {line}: {fault}", self.stage.now()));
                }
            }
            if !self.stage.is_over() {
                self.turn();
            }
        }
        wrong.extend(self.heard.drain(..).map(|heard| format!("also heard {heard:?}")));
        let written = std::iter::from_fn(|| self.stage.written());
        wrong.extend(written.map(|bytes| format!("also said {}", bytes.escape_ascii())));
        let seconds = u32::try_from(self.stage.now().as_secs()).unwrap() + 1;
        if self.turns > seconds * TURNS_A_SECOND {
            wrong.push(format!("{} turns in {seconds} s", self.turns));
        }
        wrong
    }

    /// A line of the script that is not the port's.
    fn part(&mut self, line: &str) -> Result<(), String> {
        let mut words = line.splitn(3, ' ');
        let mut word = || words.next().unwrap_or_default();
        let (verb, what, rest) = (word(), word(), word());
        if verb == "signal" {
            let signal = Signal::ALL.into_iter().find(|signal| signal.word() == what);
            self.signal = signal.ok_or("no such signal")?;
            return Ok(());
        }
        let (found, expected) = match (verb, what) {
            ("expect", "nothing") => (format!("{:?}", self.heard.front()), "None".to_owned()),
            ("expect", "short" | "long" | "id" | "unread") => {
                (self.next_heard(), line[7..].to_owned())
            }
            ("expect", "state") => (self.attendant.state().word().to_owned(), rest.to_owned()),
            ("expect", "garbage") => (self.attendant.garbage().to_string(), rest.to_owned()),
            ("expect", "opened") => (self.stage.opened().to_string(), rest.to_owned()),
            ("expect", "write") => {
                let text = escaped(rest.trim_matches('"')).ok_or("no text")?;
                let expected = text.escape_ascii().to_string();
                let found = self.stage.written().map(|bytes| bytes.escape_ascii().to_string());
                (found.unwrap_or_default(), expected)
            }
            _ => return Err("no such line".into()),
        };
        if found == expected { Ok(()) } else { Err(format!("found {found}")) }
    }

    fn next_heard(&mut self) -> String {
        match self.heard.pop_front() {
            None => "nothing".into(),
            Some(PortEvent::Press(Press::Short)) => "short".into(),
            Some(PortEvent::Press(Press::Long)) => "long".into(),
            Some(PortEvent::Named { id, .. }) => format!("id {id}"),
            Some(PortEvent::Unread | PortEvent::UnreadOrder { .. }) => "unread".into(),
            Some(PortEvent::Ordered { .. }) => "ordered".into(),
        }
    }
}

/// Reads a file of a configuration and a script.
pub fn parted(text: &str) -> (&str, Script) {
    let (toml, lines) = text.split_once("\n---\n").unwrap();
    (toml, script(lines).unwrap())
}
