//! The verbs that query a running station.

use std::ffi::OsString;
use std::path::PathBuf;

use gaiter_flow::account::Filter;

use super::{of_words, usual_config};
use crate::station::operator::control::protocol::{DIGITS_LEAST, LIST_MOST};

/// The options of every verb that queries a running station.
#[derive(Debug, Clone, clap::Args)]
pub struct AskArgs {
    /// The configuration of the station to query; the variable GAITER_CONFIG names another default
    #[arg(long, value_name = "FILE", default_value_os_t = usual_config())]
    pub config: PathBuf,
    /// Print the answer as JSON, for programs
    #[arg(long)]
    pub json: bool,
}

/// `gaiter scans`
#[derive(Debug, clap::Args)]
pub struct ScansArgs {
    /// Only scans in this state: spooled (waiting for a record), held (waiting for a decision),
    /// unassigned (stored without a patient)
    #[arg(long, value_parser = of_words(&Filter::WORDS))]
    pub state: Option<Filter>,
    /// The largest number of scans to list
    #[arg(long, value_name = "N", default_value_t = 20,
          value_parser = clap::value_parser!(u32).range(1..=i64::from(LIST_MOST)))]
    pub limit: u32,
    /// The station to query, and the output format.
    #[command(flatten)]
    pub ask: AskArgs,
}

/// `gaiter show`, `retry`, `release`, `unassign` and `give-up`
#[derive(Debug, clap::Args)]
pub struct OneArgs {
    /// The scan: the first digits of its id, at least four, as `gaiter scans` and the log show them
    #[arg(value_name = "ID", value_parser = digits)]
    pub scan: String,
    /// The station to query, and the output format.
    #[command(flatten)]
    pub ask: AskArgs,
}

/// `gaiter unassign`
#[derive(Debug, clap::Args)]
pub struct UnassignArgs {
    /// Which scan.
    #[command(flatten)]
    pub of: OneArgs,
    /// Ask for the patient's id: needed if the scan belongs to more than one patient
    #[arg(long)]
    pub from: bool,
}

/// `gaiter assign`
#[derive(Debug, clap::Args)]
pub struct AssignArgs {
    /// The scan, and the station to query.
    #[command(flatten)]
    pub one: OneArgs,
    /// A patient's id that does not belong here: it is only taken to say so.
    #[arg(hide = true)]
    pub stray: Option<OsString>,
}

/// `gaiter patient set`
#[derive(Debug, clap::Args)]
pub struct SetArgs {
    /// A patient's id that does not belong here: it is only taken to say so.
    #[arg(hide = true)]
    pub stray: Option<OsString>,
    /// The station to query, and the output format.
    #[command(flatten)]
    pub ask: AskArgs,
}

/// `gaiter explain`
#[derive(Debug, clap::Args)]
pub struct ExplainArgs {
    /// A file in an export folder, or a scan: the first digits of its id, at least four
    #[arg(value_name = "FILE|ID")]
    pub what: OsString,
    /// The station to query, and the output format.
    #[command(flatten)]
    pub ask: AskArgs,
}

/// `gaiter gdt-order`
#[derive(Debug, clap::Args)]
pub struct GdtOrderArgs {
    /// The order's file
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// The station to query, and the output format.
    #[command(flatten)]
    pub ask: AskArgs,
}

/// The argument of `gaiter explain`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Named {
    /// The beginning of a scan's id.
    Scan(String),
    /// A file.
    File(PathBuf),
}

impl Named {
    /// A text of digits that can begin an id is a scan, unless a file has that name; else it is a file.
    pub fn from_arg(what: &OsString) -> Named {
        let file = PathBuf::from(what);
        match what.to_str().map(digits) {
            Some(Ok(scan)) if !file.exists() => Named::Scan(scan),
            _ => Named::File(file),
        }
    }
}

/// Parses the beginning of a scan's id and returns it in lower case.
fn digits(text: &str) -> Result<String, String> {
    let text = text.to_ascii_lowercase();
    let hexadecimal = text.bytes().all(|byte| byte.is_ascii_hexdigit());
    if hexadecimal && (DIGITS_LEAST..=64).contains(&text.len()) {
        return Ok(text);
    }
    Err(format!("a scan's id begins with {DIGITS_LEAST} or more of the digits 0-9 and a-f"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_of_an_id_are_hexadecimal_and_enough() {
        assert_eq!(digits("ABCD1234"), Ok("abcd1234".to_owned()));
        assert_eq!(digits(&"a".repeat(64)).map(|id| id.len()), Ok(64));
        for text in ["", "abc", "abcg", "abcd.obj", "ab cd", &"a".repeat(65)] {
            assert!(digits(text).is_err(), "{text}");
        }
    }

    #[test]
    fn what_could_be_an_id_is_one_unless_a_file_has_its_name() {
        assert_eq!(Named::from_arg(&"abcd1234".into()), Named::Scan("abcd1234".into()));
        assert_eq!(Named::from_arg(&"4711_a.obj".into()), Named::File("4711_a.obj".into()));
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("abcd");
        std::fs::write(&path, "").unwrap();
        assert_eq!(Named::from_arg(&path.clone().into()), Named::File(path));
    }
}
