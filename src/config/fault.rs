//! A fault of the configuration: where it is, what is wrong, and what to write instead.

use std::ops::Range;

use gaiter_leg::phantom::PhantomTextFault;
use gaiter_toml::Hint;

use super::words::HEIGHTS_CM;

/// One fault in a configuration file.
pub type ConfigFault = gaiter_toml::Fault<What>;

/// What is wrong with a configuration. The message follows the key: `station.id: must be set`.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum What {
    /// What can be wrong with any file.
    #[error(transparent)]
    Toml(#[from] gaiter_toml::What),
    /// A text that is no duration, size, address or the like, or that a format or protocol does not allow here.
    #[error("\"{text}\" is not {what}")]
    NotA {
        /// As written.
        text: String,
        /// What it should be.
        what: &'static str,
        /// What to write.
        hint: &'static str,
    },
    /// Nothing where a text is needed.
    #[error("must not be empty")]
    EmptyText,
    /// Not a limit in the unit of what it limits.
    #[error("\"{text}\" is not a limit in {unit}")]
    NotALimit {
        /// As written.
        text: String,
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
    /// An address that other machines may reach.
    #[error("\"{0}\" can be reached from other machines")]
    NotLoopback(String),
    /// An address that no other machine can reach.
    #[error("\"{0}\" cannot be reached from other machines")]
    OnlyLoopback(String),
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
    /// A port on which neither a line nor a contact counts as a press.
    #[error("has neither tokens nor a contact: no press could be detected")]
    NoInput,
    /// The button and the id reader use the same port.
    #[error("is also the port of patient.reader")]
    SamePort,
    /// A key that needs another one.
    #[error("is set without {0}")]
    Without(&'static str),
    /// Two keys of which only one may be set.
    #[error("is set together with {0}")]
    Together(&'static str),
    /// A key that nothing reads as the others are set.
    #[error("has no effect {0}")]
    NoEffect(&'static str),
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

/// How an address for other machines is written.
pub(super) const ADDRESS: &str = r#"write "off", or this machine's address on the local network and a port: "192.168.1.20:9180""#;

impl Hint for What {
    fn hint(&self) -> Option<String> {
        let hint = match self {
            What::Toml(what) => return what.hint(),
            What::NotA { hint, .. } => (*hint).into(),
            What::EmptyText => "write a text that people understand".into(),
            What::NotALimit { text, .. } if text.to_lowercase().ends_with("ml") => {
                "no limit is in mL: that of arms does not hold for legs".into()
            }
            What::NotALimit { unit: "%", .. } => r#"write a number and %: "3%", "4.5%""#.into(),
            What::NotALimit { .. } => r#"write a number and mm: "20mm""#.into(),
            What::OutOfRange { least, most, .. } => {
                format!("anything from \"{least}\" to \"{most}\"")
            }
            What::NotAHeight(_) => {
                let Range { start, end } = HEIGHTS_CM;
                format!("a height above the floor in cm, more than {start} and less than {end}")
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
            What::NotLoopback(_) => {
                r#"the address must be on this machine: "127.0.0.1:9184""#.into()
            }
            What::OnlyLoopback(_) => ADDRESS.into(),
            What::Together(_) => "remove one of the two".into(),
            What::NoEffect(_) => "remove it".into(),
            What::Overlap { .. } => "exports, state and records need separate folders".into(),
            What::NotARegex(_) => "in single quotes a \\ needs no doubling: '^P?[0-9]+_'".into(),
            What::NoPatientGroup => {
                "mark the part that is the patient's id: '^(?<patient>P?[0-9]+)_'".into()
            }
            What::LoosePattern(_) => {
                "name the characters an id may hold and how many: '[A-Z]?[0-9]{1,12}'".into()
            }
            What::NoInput => r#"write tokens = ["PRESS"] or contact = "cts""#.into(),
            What::SamePort => "a port can have only one use: remove one".into(),
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
