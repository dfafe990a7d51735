//! One sentence that explains why a file is where it is.

use std::path::Path;

use jiff::Timestamp;
use jiff::tz::TimeZone;

use super::export::companions;
use super::export::passed_over::PassedOver;
use super::facts::{Facts, IntakeState, SourceFacts, SourceState, WaitingFile};
use super::health::local;

/// What the journal knows about a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Known {
    /// The outcome for its scan, in words that follow "it": "was delivered", "is held: a person
    /// decides", "was refused (scan-cut-short)".
    pub state: String,
    /// When that was; `None` if the journal does not say.
    pub at: Option<Timestamp>,
    /// The scan's first digits; `None` for a file that was refused unread.
    pub scan: Option<String>,
    /// When that scan came in, if the file only has its points and triangles again, in other bytes.
    pub again_since: Option<Timestamp>,
}

/// Explains in one sentence where a file is and why. Times are told in this time zone.
pub fn of_file(facts: &Facts, path: &Path, known: Option<Known>, zone: &TimeZone) -> String {
    let source = facts.sources.iter().find(|source| {
        source.folder.as_ref().is_some_and(|folder| path != folder && path.starts_with(folder))
    });
    if let Some(file) = source.and_then(|source| source.waiting.get(path)) {
        let again = match known {
            Some(_) => "The file has changed since it was taken: it",
            None => "The file",
        };
        return format!("{again} {}.", waits(file, facts.intake, zone));
    }
    if let Some(known) = known {
        return said(&known, zone);
    }
    match source {
        Some(source) => not_seen(source, path, zone),
        None => "The file is not in an export folder of this station.".to_owned(),
    }
}

fn waits(file: &WaitingFile, intake: IntakeState, zone: &TimeZone) -> String {
    let WaitingFile { why, since, overdue } = file;
    let since = local(*since, zone);
    let late = if *overdue { ", longer than a file should wait" } else { "" };
    let shut = match intake {
        IntakeState::Open => String::new(),
        IntakeState::Paused => "; the operator has paused the station".to_owned(),
        IntakeState::DiskLow { free, floor } => {
            format!("; the disk is nearly full: {free} bytes are free, {floor} must stay free")
        }
    };
    format!("{why} (seen since {since}{late}){shut}")
}

fn said(known: &Known, zone: &TimeZone) -> String {
    let which = match (&known.scan, known.again_since) {
        (None, _) => "The file".to_owned(),
        (Some(scan), None) => format!("The file's scan {scan}"),
        (Some(scan), Some(taken)) => {
            let taken = local(taken, zone);
            format!("The file has the points and triangles of scan {scan}, taken {taken}, which")
        }
    };
    let at = known.at.map_or(String::new(), |at| format!(" ({})", local(at, zone)));
    format!("{which} {}{at}.", known.state)
}

fn not_seen(source: &SourceFacts, path: &Path, zone: &TimeZone) -> String {
    let ignored = path.ancestors().find_map(|place| Some((place, *source.ignored.get(place)?)));
    if let Some((place, why)) = ignored.map(|(place, ignored)| (place, ignored.why)) {
        let said = if place == path { why.words() } else { why.words_within() };
        let left = match why.is_of_name() {
            true => " It has lain there for longer than a file should.",
            false => "",
        };
        return format!("The file {said}.{left}");
    }
    if let Some(at) = source.gone.get(path) {
        let at = local(*at, zone);
        return format!(
            "The file was overwritten or deleted before it was taken in (noticed {at})."
        );
    }
    let since = local(source.since, zone);
    match &source.state {
        SourceState::NotLooked => "The file's folder has not been looked at yet.".to_owned(),
        SourceState::OutOfReach(error) => {
            format!("The file's folder has been out of reach since {since}: {error}.")
        }
        SourceState::NotMounted(why) => {
            format!("The file's folder has been ignored since {since}: the export folder {why}.")
        }
        SourceState::Taken => "Another station on this machine uses the file's folder.".to_owned(),
        SourceState::Stalled => format!("The file's folder has not answered since {since}."),
        SourceState::Watched => unseen(source, path, zone),
    }
}

/// A file that the last look did not find among the scans.
fn unseen(source: &SourceFacts, path: &Path, zone: &TimeZone) -> String {
    let name = path.file_name().unwrap_or_default();
    if let Some(why) = PassedOver::by_name(&name.to_string_lossy()) {
        return format!("The file {}.", why.words());
    }
    if companions::is_companion(name) {
        return "The file is not a scan; it belongs to the scan of the same name.".to_owned();
    }
    match source.last_look {
        Some(at) => {
            format!("No scan of that name was there at the last look, {}.", local(at, zone))
        }
        None => "The file's folder has not been looked through yet.".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::export::passed_over::Ignored;

    fn at(second: i64) -> Timestamp {
        Timestamp::from_second(second).unwrap()
    }

    fn facts(change: impl FnOnce(&mut SourceFacts)) -> Facts {
        let mut facts = Facts::new(at(0), 1);
        let source = &mut facts.sources[0];
        source.folder = Some("/e".into());
        source.state = SourceState::Watched;
        source.last_look = Some(at(60));
        change(source);
        facts
    }

    fn said(facts: &Facts, path: &str) -> String {
        of_file(facts, Path::new(path), None, &TimeZone::UTC)
    }

    fn waiting(why: &str, overdue: bool) -> WaitingFile {
        WaitingFile { why: why.into(), since: at(1), overdue }
    }

    #[test]
    fn a_waiting_file_says_for_what_and_what_else_is_in_the_way() {
        let mut facts = facts(|source| {
            source.waiting.insert("/e/a.obj".into(), waiting("is still being written", true));
        });
        assert_eq!(
            said(&facts, "/e/a.obj"),
            "The file is still being written (seen since 1970-01-01 00:00:01, longer than a file \
             should wait)."
        );
        facts.intake = IntakeState::Paused;
        assert!(said(&facts, "/e/a.obj").ends_with("; the operator has paused the station."));
        facts.intake = IntakeState::DiskLow { free: 1, floor: 2 };
        assert!(said(&facts, "/e/a.obj").contains("1 bytes are free, 2 must stay free"));
    }

    #[test]
    fn a_known_file_says_what_became_of_it_unless_it_has_changed() {
        let known = Known {
            state: "was delivered".into(),
            at: Some(at(5)),
            scan: Some("0123abcd".into()),
            again_since: None,
        };
        let path = Path::new("/e/a.obj");
        assert_eq!(
            of_file(&facts(|_| ()), path, Some(known.clone()), &TimeZone::UTC),
            "The file's scan 0123abcd was delivered (1970-01-01 00:00:05)."
        );
        let again = Known { again_since: Some(at(3)), ..known.clone() };
        assert_eq!(
            of_file(&facts(|_| ()), path, Some(again), &TimeZone::UTC),
            "The file has the points and triangles of scan 0123abcd, taken 1970-01-01 00:00:03, \
             which was delivered (1970-01-01 00:00:05)."
        );
        let facts = facts(|source| {
            source.waiting.insert(path.into(), waiting("is still being written", false));
        });
        let said = of_file(&facts, path, Some(known), &TimeZone::UTC);
        assert!(said.starts_with("The file has changed since it was taken: it is still"), "{said}");
    }

    #[test]
    fn every_state_of_a_folder_has_its_sentence() {
        let states = [
            (SourceState::NotLooked, "has not been looked at yet"),
            (SourceState::OutOfReach("Permission denied".into()), "Permission denied"),
            (SourceState::NotMounted("lacks the marker".into()), "export folder lacks the marker"),
            (SourceState::Stalled, "has not answered since"),
            (SourceState::Watched, "was there at the last look, 1970-01-01 00:01:00"),
        ];
        for (state, expected) in states {
            let facts = facts(|source| source.state = state);
            let said = said(&facts, "/e/a.obj");
            assert!(said.contains(expected), "{said}");
        }
    }

    #[test]
    fn a_file_that_is_passed_over_says_why() {
        let facts = facts(|source| {
            for (path, why) in [
                ("/e/pipe.obj", PassedOver::Pipe),
                ("/e/sub", PassedOver::SubFolder),
                ("/e/link", PassedOver::Link),
                ("/e/b.obj.gz", PassedOver::Packed),
                ("/e/left.obj.part", PassedOver::Unfinished),
            ] {
                let ignored = Ignored { why, changed_ns: 0, since: Duration::ZERO };
                source.ignored.insert(path.into(), ignored);
            }
            source.gone.insert("/e/gone.obj".into(), at(5));
        });
        for (path, expected) in [
            ("/e/pipe.obj", "The file is a pipe, not a file."),
            ("/e/sub", "The file is a folder, and scanner.subfolders is false."),
            ("/e/sub/deep/a.obj", "The file is in a sub-folder, and scanner.subfolders is false."),
            (
                "/e/link/a.obj",
                "The file is in a folder that is a link, and links are not followed.",
            ),
            ("/e/b.obj.gz", "The file is packed; unpacked it is read."),
            (
                "/e/left.obj.part",
                "The file has the name of an unfinished file; it is taken in once it is renamed. It \
                 has lain there for longer than a file should.",
            ),
            (
                "/e/gone.obj",
                "The file was overwritten or deleted before it was taken in (noticed 1970-01-01 \
                 00:00:05).",
            ),
            ("/e/.a.obj", "The file is hidden; hidden files are ignored."),
            ("/e/a.ord", "The file is not a scan; it belongs to the scan of the same name."),
            ("/f/a.obj", "The file is not in an export folder of this station."),
            ("/e", "The file is not in an export folder of this station."),
        ] {
            assert_eq!(said(&facts, path), expected, "{path}");
        }
        assert!(said(&facts, "/e/a.obj.PART").contains("has the name of an unfinished file"));
    }
}
