//! What to write instead of what is wrong in a configuration.

use std::ops::Range;

use super::fault::What;
use super::words::{COLUMNS, HEIGHTS_CM, ROWS};

impl What {
    /// What to write instead, if there is a suggestion.
    pub fn hint(&self) -> Option<String> {
        let hint = match self {
            What::Notation { hint, .. } => return hint.clone(),
            What::NotUtf8 => "save the file as UTF-8".into(),
            What::Unknown { similar: Some(similar), .. } => format!("did you mean {similar}?"),
            What::Unknown { known, .. } => format!("known here: {}", known.join(", ")),
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
            What::NotControlPoints(_) => format!(
                r#"write "auto" or their number along and around: "{}x{}" to "{}x{}""#,
                ROWS.start(),
                COLUMNS.start(),
                ROWS.end(),
                COLUMNS.end()
            ),
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
            What::Twice(_) => "remove one of the two".into(),
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
            What::SamePort | What::TwoPorts => "a port can have only one use: remove one".into(),
            What::OutsideMask => {
                r#"write as many bytes in both: mask = "00 01", value = "00 01""#.into()
            }
            What::Invalid { hint, .. } => (*hint).into(),
            What::Without(key) => format!("set {key} too"),
            What::Together(_) => "remove one of the two".into(),
            What::PhantomGirths(_) => {
                r#"in cm: "35.2" for a cylinder, or girths at heights: "10:35.2, 30:38.1""#.into()
            }
            What::PhantomName(_) => "at least 3 letters (a-z, A-Z), digits, - and _".into(),
            What::PhantomIsPatient(_) => "choose a name that no patient's id can be".into(),
            What::FacesUpOrDown { .. } => {
                "choose a horizontal axis, or \"auto\" to find it from the feet".into()
            }
            What::AxisOfNoLeg { .. } => {
                "set tape = \"leg\" for the published method, or axis = \"centroids\"".into()
            }
        };
        Some(hint)
    }
}
