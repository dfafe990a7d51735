//! Queries a running station over its control socket and maps the answer to an exit code.

use std::error::Error;
use std::fmt::{self, Display};
use std::io::{self, BufRead, IsTerminal, Read, Write};
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::time::Duration;

use gaiter_flow::cause::Cause;
use gaiter_language::Language;
use serde::Serialize;
use serde_json::json;

use super::args::AskArgs;
use super::{Exit, complain, exit_of_printing, explain_config, print, print_json, terminal_safe};
use crate::config::{self, ConfigError, control_path};
use crate::station::operator::control::protocol::{
    ControlAnswer, ControlFault, ControlFaultKind, Request,
};

/// The longest wait for an answer. The station's own time limits are shorter.
const PATIENCE: Duration = Duration::from_secs(60);

/// The longest answer that is read, bytes. The longest list of scans is far shorter.
const ANSWER_MOST: u64 = 16 * 1024 * 1024;

/// The longest patient id that is read, bytes.
const ID_MOST: u64 = 1024;

/// Why there is no answer. Displayed in English.
#[derive(Debug)]
pub enum AskFault {
    /// No configuration names the state folder.
    Config(ConfigError),
    NoStation {
        /// Its state folder.
        state_dir: PathBuf,
        /// The configuration that names it.
        config: PathBuf,
    },
    /// The user has no permission to query the station.
    Denied,
    /// The connection failed.
    Io(io::Error),
    /// The answer cannot be parsed.
    Answer(serde_json::Error),
    /// The station refused the request.
    Refused(ControlFault),
}

impl AskFault {
    /// The fault for an answer of an unexpected kind.
    pub fn another_answer() -> AskFault {
        let message = "the station answered a different request";
        AskFault::Answer(serde::de::Error::custom(message))
    }

    fn code(&self) -> &str {
        match self {
            AskFault::Config(_) => "no-configuration",
            AskFault::NoStation { .. } => "no-station",
            AskFault::Denied => "denied",
            AskFault::Io(_) => "control-io",
            AskFault::Answer(_) => "answer-malformed",
            AskFault::Refused(fault) => &fault.code,
        }
    }

    /// The fault in a sentence.
    pub fn in_words(&self, language: Language) -> String {
        let because = |key, why: &dyn Display| language.filled(key, &[("why", why)]);
        match self {
            AskFault::Config(error) => error.to_string(),
            AskFault::NoStation { state_dir, .. } => {
                let place = state_dir.display();
                language.filled("terminal.fault.no_station", &[("place", &place)])
            }
            AskFault::Denied => language.text("terminal.fault.denied").to_owned(),
            AskFault::Io(error) => {
                because("terminal.fault.io", &Cause::of_system(error).in_words(language))
            }
            AskFault::Answer(error) => because("terminal.fault.answer", error),
            AskFault::Refused(fault) => match (language, &fault.local) {
                (Language::En, _) | (_, None) => fault.message.clone(),
                (_, Some(local)) => local.clone(),
            },
        }
    }

    /// The fault as JSON, for programs.
    pub fn json(&self) -> serde_json::Value {
        json!({
            "fault": {
                "code": self.code(),
                "message": self.to_string(),
                "hint": self.hint(Language::En),
                "exit": Exit::from(self).code(),
            }
        })
    }

    /// What the operator can do, if anything.
    pub fn hint(&self, language: Language) -> Option<String> {
        match self {
            AskFault::NoStation { config, .. } => {
                let config = terminal_safe(config.display());
                Some(language.filled("terminal.fault.start", &[("config", &config)]))
            }
            AskFault::Denied => Some(language.text("terminal.fault.sudo").to_owned()),
            AskFault::Answer(_) => Some(language.text("terminal.fault.restart").to_owned()),
            AskFault::Config(_) | AskFault::Io(_) | AskFault::Refused(_) => None,
        }
    }
}

impl From<&AskFault> for Exit {
    fn from(fault: &AskFault) -> Exit {
        match fault {
            AskFault::Config(error) => Exit::from(error),
            AskFault::NoStation { .. } | AskFault::Denied | AskFault::Io(_) => Exit::Io,
            AskFault::Answer(_) => Exit::Internal,
            AskFault::Refused(fault) => match fault.kind {
                ControlFaultKind::Request => Exit::Usage,
                ControlFaultKind::Unknown => Exit::NoFile,
                ControlFaultKind::Failed => Exit::Io,
            },
        }
    }
}

impl Display for AskFault {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(&self.in_words(Language::En))
    }
}

impl Error for AskFault {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            AskFault::Config(error) => error.source(),
            AskFault::Io(error) => Some(error),
            AskFault::Answer(error) => Some(error),
            AskFault::NoStation { .. } | AskFault::Denied | AskFault::Refused(_) => None,
        }
    }
}

/// Sends a request to the station of this configuration and returns its answer.
///
/// # Errors
/// See [`AskFault`].
pub fn ask(config: &Path, request: &Request) -> Result<ControlAnswer, AskFault> {
    let state_dir = state_dir(config).map_err(AskFault::Config)?;
    let connected = UnixStream::connect(control_path(&state_dir));
    let stream = connected.map_err(|error| match error.kind() {
        io::ErrorKind::PermissionDenied => AskFault::Denied,
        io::ErrorKind::NotFound | io::ErrorKind::ConnectionRefused => {
            AskFault::NoStation { state_dir, config: config.to_owned() }
        }
        _ => AskFault::Io(error),
    })?;
    let body = serde_json::to_vec(request).map_err(AskFault::Answer)?;
    let body = exchange(stream, &body).map_err(AskFault::Io)?;
    match serde_json::from_slice(&body).map_err(AskFault::Answer)? {
        ControlAnswer::Fault(fault) => Err(AskFault::Refused(fault)),
        answer => Ok(answer),
    }
}

/// Sends a request over HTTP, and reads the body of its answer. The station closes the connection after
/// each.
fn exchange(mut stream: UnixStream, body: &[u8]) -> io::Result<Vec<u8>> {
    stream.set_read_timeout(Some(PATIENCE))?;
    stream.set_write_timeout(Some(PATIENCE))?;
    let length = body.len();
    let head = format!("POST /ask HTTP/1.1\r\nHost: station\r\nContent-Length: {length}\r\n\r\n");
    stream.write_all(&[head.as_bytes(), body].concat())?;
    let mut answer = Vec::new();
    stream.take(ANSWER_MOST).read_to_end(&mut answer)?;
    let end = answer.windows(4).position(|bytes| bytes == b"\r\n\r\n");
    let body = answer.split_off(end.ok_or(io::ErrorKind::UnexpectedEof)? + 4);
    if answer.starts_with(b"HTTP/1.1 200 ") {
        return Ok(body);
    }
    let status = String::from_utf8_lossy(&answer);
    Err(io::Error::other(status.lines().next().unwrap_or_default().to_owned()))
}

/// The state folder. A configuration with faults elsewhere may still name it.
fn state_dir(config: &Path) -> Result<PathBuf, ConfigError> {
    match config::read(config) {
        Ok(config) => Ok(config.station.state_dir),
        Err(error) => {
            let text = std::fs::read_to_string(config).unwrap_or_default();
            config::state_dir(&text).ok_or(error)
        }
    }
}

/// The language of the station of this configuration. English if the configuration has faults.
pub fn language(config: &Path) -> Language {
    config::read(config).map_or(Language::En, |config| config.language)
}

/// Sends a request, prints the answer, and returns the exit that `exit` derives from it. `taken`
/// extracts the value from the answer, which `--json` prints, and `table` renders it for people in the
/// station's language.
pub fn answered<T: Serialize>(
    args: &AskArgs,
    request: &Request,
    taken: impl FnOnce(ControlAnswer) -> Option<T>,
    table: impl FnOnce(&T, Language) -> String,
    exit: impl FnOnce(&T) -> Exit,
) -> Exit {
    let answered = ask(&args.config, request);
    let taken = |answer| taken(answer).ok_or_else(AskFault::another_answer);
    let answer = match answered.and_then(taken) {
        Ok(answer) => answer,
        Err(fault) => return refused(args, &fault),
    };
    let printed = match args.json {
        true => print_json(&answer),
        false => print(table(&answer, language(&args.config))),
    };
    exit_of_printing("the answer", printed).max(exit(&answer))
}

/// Sends a request and prints the sentence in the answer.
pub fn sentence(args: &AskArgs, request: &Request) -> Exit {
    let taken = |answer| match answer {
        ControlAnswer::Sentence(sentence) => Some(json!({ "sentence": sentence })),
        _ => None,
    };
    let table = |answer: &serde_json::Value, _| {
        format!("{}\n", terminal_safe(answer["sentence"].as_str().unwrap_or_default()))
    };
    answered(args, request, taken, table, |_| Exit::Done)
}

/// Prints why there is no answer, with `--json` as an object.
pub fn refused(args: &AskArgs, fault: &AskFault) -> Exit {
    let exit = Exit::from(fault);
    if args.json {
        // If printing fails, the exit code still informs the caller.
        let _ = print_json(&fault.json());
        return exit;
    }
    if let AskFault::Config(error) = fault {
        return explain_config(error);
    }
    let language = language(&args.config);
    complain(format_args!("gaiter: {}", terminal_safe(fault.in_words(language))));
    if let Some(hint) = fault.hint(language) {
        complain(format_args!("  {}: {hint}", language.text("terminal.hint")));
    }
    exit
}

/// Reads the patient's id as a line of standard input, with a prompt if it is a terminal.
///
/// # Errors
/// If it cannot be read.
pub fn read_patient() -> io::Result<String> {
    let stdin = io::stdin();
    if stdin.is_terminal() {
        let mut screen = io::stderr().lock();
        screen.write_all(b"patient's id: ")?;
        screen.flush()?;
    }
    let mut line = String::new();
    stdin.lock().take(ID_MOST).read_line(&mut line)?;
    Ok(line.trim().to_owned())
}
