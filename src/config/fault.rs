//! A fault of the configuration: where it is, what is wrong, and what to write instead.

use std::fmt;
use std::ops::Range;

use gaiter_leg::phantom::PhantomTextFault;

use super::words::HEIGHTS_CM;

/// One fault in a configuration file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ConfigFault {
    /// The file name as given; `station.toml` for bare text.
    pub file: String,
    /// 1-based line.
    pub line: usize,
    /// 1-based column in characters.
    pub column: usize,
    /// The key with its sections, such as `scanner.quiet`; empty for a syntax fault.
    pub key: String,
    /// The line of the file that holds the fault.
    pub source_line: String,
    /// How many characters are marked, starting at `column`; at least 1.
    pub width: usize,
    /// What is wrong.
    pub what: What,
}

/// What is wrong with a configuration. The message follows the key: `station.id: must be set`.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum What {
    /// The text is not valid TOML.
    #[error("{said}")]
    Notation {
        /// What the TOML parser reports.
        said: String,
        /// What to do, if known.
        hint: Option<String>,
    },
    /// The file holds bytes that are not UTF-8.
    #[error("this is not UTF-8 text")]
    NotUtf8,
    /// The key does not exist, or is in the wrong section.
    #[error("unknown key")]
    Unknown {
        /// The key that was probably meant.
        similar: Option<String>,
        /// The keys that are valid here.
        known: Vec<String>,
    },
    /// A key that earlier versions had.
    #[error("is no longer a key")]
    Removed {
        /// What to do.
        instead: &'static str,
    },
    /// A key without a default is missing.
    #[error("must be set")]
    Missing {
        /// The lines that set it.
        example: String,
    },
    /// A value where a section is required.
    #[error("must be a section, not {found}")]
    NotASection {
        /// The kind of value found.
        found: &'static str,
        /// The section's name.
        name: String,
    },
    /// A value of the wrong kind.
    #[error("must be {expected}, not {found}")]
    Kind {
        /// The required kind.
        expected: &'static str,
        /// The kind that was found.
        found: &'static str,
        /// A correct line.
        example: String,
    },
    /// Not a duration at all.
    #[error("\"{0}\" is not a duration")]
    NotADuration(String),
    /// Not a size at all.
    #[error("\"{0}\" is not a size")]
    NotASize(String),
    /// Not a length at all.
    #[error("\"{0}\" is not a length")]
    NotALength(String),
    /// Not a distance at all.
    #[error("\"{0}\" is not a distance")]
    NotADistance(String),
    /// Nothing where a text is needed.
    #[error("must not be empty")]
    EmptyText,
    /// Not a limit in the unit of what it limits.
    #[error("\"{text}\" is not a limit in {unit}")]
    NotALimit {
        /// As written.
        text: String,
        /// The unit.
        unit: &'static str,
    },
    /// A duration, size, length or distance outside the allowed range.
    #[error("\"{text}\" is out of range")]
    OutOfRange {
        /// As written.
        text: String,
        /// The smallest allowed value, as written in the file.
        least: &'static str,
        /// The largest allowed value, as written in the file.
        most: &'static str,
    },
    /// Not a height on a leg.
    #[error("{0} is not a height on a leg")]
    NotAHeight(String),
    /// Not one of the words of a choice.
    #[error("\"{text}\" is not one of {}", quoted(words))]
    NotAWord {
        /// As written.
        text: String,
        /// The words of the choice.
        words: Vec<&'static str>,
        /// The word that was probably meant.
        similar: Option<&'static str>,
    },
    /// Not the name of a garment.
    #[error("\"{text}\" is not one of {}", quoted(&known.iter().map(String::as_str).collect::<Vec<_>>()))]
    NotAGarment {
        /// As written.
        text: String,
        /// The garments that are known.
        known: Vec<String>,
        /// The one that was probably meant.
        similar: Option<String>,
    },
    /// A file that the configuration names cannot be read, or has a fault.
    #[error("{0}")]
    NamedFile(String),
    /// Not valid as a station's name.
    #[error("\"{0}\" cannot be the name of a station")]
    NotAStationId(String),
    /// A path that does not begin at the root.
    #[error("\"{0}\" is not a full path")]
    RelativePath(String),
    /// A path with `..`, whose target is not obvious.
    #[error("\"{0}\" contains \"..\"")]
    ClimbingPath(String),
    /// A path with a control character, usually a `\r` or `\t` that was meant as part of a folder's
    /// name.
    #[error("\"{0}\" contains a control character")]
    ControlInPath(String),
    /// A state folder whose path is too long for the control socket in it.
    #[error("has {length} bytes; the station's control socket in it allows {most}")]
    LongPath {
        /// Its length, bytes.
        length: usize,
        /// The longest allowed path, bytes.
        most: usize,
    },
    /// Not an address with a port.
    #[error("\"{0}\" is not an address and port")]
    NotAnAddress(String),
    /// An address that other machines may reach.
    #[error("\"{0}\" can be reached from other machines")]
    NotLoopback(String),
    /// Not an address with a port for other machines.
    #[error("\"{0}\" is not an address and port")]
    NotANetworkAddress(String),
    /// An address that no other machine can reach.
    #[error("\"{0}\" cannot be reached from other machines")]
    OnlyLoopback(String),
    /// A list that needs an entry.
    #[error("is an empty list")]
    EmptyList,
    /// The same folder or word twice in a list.
    #[error("\"{0}\" is listed twice")]
    Twice(String),
    /// Two folders that must be separate are nested.
    #[error("\"{inner}\" {} {other_key} \"{outer}\"", if inner == outer { "is also" } else { "lies inside" })]
    Overlap {
        /// The folder the fault is reported for.
        inner: String,
        /// The folder that holds it.
        outer: String,
        /// The key of that folder.
        other_key: String,
    },
    /// Not a regular expression.
    #[error("is not a regular expression: {0}")]
    NotARegex(String),
    /// The expression does not mark the part that is the patient's id.
    #[error("has no group named \"patient\"")]
    NoPatientGroup,
    /// The expression accepts ids that are unsafe as folder names.
    #[error("would accept {0:?} as a patient's id")]
    LoosePattern(&'static str),
    /// Not a valid pattern for the names of done files.
    #[error("\"{0}\" is not a valid name for done files")]
    NotADoneFile(String),
    /// Not a file name.
    #[error("\"{0}\" is not the name of a file")]
    NotAMarker(String),
    /// A wrongly written port, port setting or text for a port.
    #[error("\"{text}\" is not a valid {thing}")]
    Misspelt {
        /// As written.
        text: String,
        /// What it should be.
        thing: &'static str,
        /// An example of how to write it.
        example: &'static str,
    },
    /// A port on which neither a line nor a contact counts as a press.
    #[error("has neither tokens nor a contact: no press could be detected")]
    NothingToHear,
    /// The button and the id reader use the same port.
    #[error("is also the port of patient.reader")]
    SamePort,
    /// Not a value that a format or protocol allows here.
    #[error("\"{text}\" is not a valid {what}")]
    Invalid {
        /// As written.
        text: String,
        /// What it should be.
        what: &'static str,
        /// What to write.
        hint: &'static str,
    },
    /// A key that needs another one.
    #[error("is set without {0}")]
    Without(&'static str),
    /// Two keys of which only one may be set.
    #[error("is set together with {0}")]
    Together(&'static str),
    /// Not a list of known girths.
    #[error("{0}")]
    PhantomGirths(PhantomTextFault),
    /// Not a name that file names can begin with.
    #[error("\"{0}\" cannot be the name of the phantom")]
    PhantomName(String),
    /// The phantom's name could be a patient's id.
    #[error("patient.pattern accepts \"{0}\" as a patient's id")]
    PhantomIsPatient(String),
    /// The toes cannot point along the up axis.
    #[error("\"{facing}\" is along the up axis, scanner.up = \"{up}\"")]
    FacesUpOrDown {
        /// `scanner.facing` as written.
        facing: String,
        /// `scanner.up`, as written or by default.
        up: String,
    },
}

impl What {
    /// What to write instead, if there is a suggestion.
    pub fn hint(&self) -> Option<String> {
        let hint = match self {
            What::Notation { hint, .. } => return hint.clone(),
            What::NotUtf8 => "save the file as UTF-8".into(),
            What::Unknown { similar: Some(similar), .. } => format!("did you mean {similar}?"),
            What::Unknown { known, .. } => format!("known here: {}", known.join(", ")),
            What::Removed { instead } => (*instead).into(),
            What::Missing { example } | What::Kind { example, .. } => format!("write {example}"),
            What::NotASection { name, .. } => {
                format!("write [{name}] on a line of its own and the keys below it")
            }
            What::NotADuration(_) => {
                r#"write a number and a unit: "2s", "500ms", "10m""#.to_string()
            }
            What::NotASize(_) => r#"write a number and a unit: "200MB", "1GB""#.into(),
            What::NotALength(_) => r#"write a number and a unit: "5cm", "80mm""#.into(),
            What::EmptyText => "write a text that people understand".into(),
            What::NotALimit { text, .. } if text.to_lowercase().ends_with("ml") => {
                "no limit is in mL: that of arms does not hold for legs".into()
            }
            What::NotALimit { unit: "%", .. } => r#"write a number and %: "3%", "4.5%""#.into(),
            What::NotALimit { .. } => r#"write a number and mm: "20mm""#.into(),
            What::NotADistance(_) => r#"write a number and mm: "0.05mm", "1mm""#.into(),
            What::OutOfRange { least, most, .. } => {
                format!("anything from \"{least}\" to \"{most}\"")
            }
            What::NotAHeight(_) => {
                let Range { start, end } = HEIGHTS_CM;
                format!("a height above the floor in cm, more than {start} and less than {end}")
            }
            What::NotAWord { similar, .. } => {
                return similar.map(|word| format!("did you mean \"{word}\"?"));
            }
            What::NotAGarment { similar, .. } => {
                return similar.as_ref().map(|name| format!("did you mean \"{name}\"?"));
            }
            What::NamedFile(_) => "gaiter sizes check FILE names every fault of a file".into(),
            What::NotAStationId(_) => "1 to 32 letters (a-z, A-Z), digits, - and _".into(),
            What::RelativePath(text) if text.starts_with('~') => {
                "write the home folder in full; ~ is only known to a shell".into()
            }
            What::RelativePath(_) => "write the path from the root on, beginning with /".into(),
            What::ClimbingPath(_) => "write where the path really leads, without ..".into(),
            What::ControlInPath(_) => {
                "in double quotes a \\ begins a special character; use single quotes".into()
            }
            What::LongPath { .. } => "choose a shorter path: \"/var/lib/gaiter\"".into(),
            What::NotAnAddress(_) => {
                r#"write "off", or an address of this machine and a port: "127.0.0.1:9184""#.into()
            }
            What::NotLoopback(_) => {
                r#"the address must be on this machine: "127.0.0.1:9184""#.into()
            }
            What::NotANetworkAddress(_) | What::OnlyLoopback(_) => {
                r#"write "off", or this machine's address on the local network and a port: "192.168.1.20:9180""#.into()
            }
            What::EmptyList => "name at least one folder that the scanner exports to".into(),
            What::Twice(_) | What::Together(_) => "remove one of the two".into(),
            What::Overlap { .. } => "exports, state and records need separate folders".into(),
            What::NotARegex(_) => "in single quotes a \\ needs no doubling: '^P?[0-9]+_'".into(),
            What::NoPatientGroup => {
                "mark the part that is the patient's id: '^(?<patient>P?[0-9]+)_'".into()
            }
            What::LoosePattern(_) => {
                "name the characters an id may hold and how many: '[A-Z]?[0-9]{1,12}'".into()
            }
            What::NotADoneFile(_) => {
                "use {name} or {stem}, no folder, and no ending of a scan: \"{name}.done\"".into()
            }
            What::NotAMarker(_) => "a bare name, without a folder: \".mounted\"".into(),
            What::Misspelt { example, .. } => format!("write {example}"),
            What::NothingToHear => r#"write tokens = ["PRESS"] or contact = "cts""#.into(),
            What::SamePort => "a port can have only one use: remove one".into(),
            What::Invalid { hint, .. } => (*hint).into(),
            What::Without(key) => format!("set {key} too"),
            What::PhantomGirths(_) => {
                r#"in cm: "35.2" for a cylinder, or girths at heights: "10:35.2, 30:38.1""#.into()
            }
            What::PhantomName(_) => "at least 3 letters (a-z, A-Z), digits, - and _".into(),
            What::PhantomIsPatient(_) => "choose a name that no patient's id can be".into(),
            What::FacesUpOrDown { .. } => {
                "choose a horizontal axis, or \"auto\" to find it from the feet".into()
            }
        };
        Some(hint)
    }
}

impl fmt::Display for ConfigFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ConfigFault { file, line, column, key, source_line, width, what } = self;
        write!(f, "{file}:{line}:{column}: ")?;
        if !key.is_empty() {
            write!(f, "{key}: ")?;
        }
        writeln!(f, "{}", printable(&what.to_string()))?;
        // A tab is kept as a tab, so that the caret lines up at any tab width.
        let before: String = source_line
            .chars()
            .take(column - 1)
            .map(|c| if c == '\t' { '\t' } else { ' ' })
            .collect();
        let margin = " ".repeat(line.to_string().len());
        writeln!(f, "{}", format!("  {line} | {source_line}").trim_end())?;
        write!(f, "  {margin} | {before}{}", "^".repeat(*width))?;
        if let Some(hint) = what.hint() {
            write!(f, "\n  {margin} hint: {}", printable(&hint))?;
        }
        Ok(())
    }
}

impl std::error::Error for ConfigFault {}

/// Escapes control characters: values may contain them, and they must not reach a terminal.
fn printable(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        if c.is_control() { shown.extend(c.escape_default()) } else { shown.push(c) }
    }
    shown
}

fn quoted(words: &[&str]) -> String {
    words.iter().map(|word| format!("\"{word}\"")).collect::<Vec<_>>().join(", ")
}
