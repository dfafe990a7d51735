//! Why a file is where it is, in words.

use std::fmt::Display;
use std::path::Path;

use gaiter_language::Language;
use jiff::Timestamp;
use jiff::tz::TimeZone;

use super::cause::Cause;
use super::export::companions;
use super::export::passed_over::PassedOver;
use super::facts::{Facts, IntakeState, SourceFacts, SourceState, WaitingFile};
use super::health::local;
use super::words::bytes;

/// What the journal knows about a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FileHistory {
    /// The outcome for its scan, in words that follow the scan: "was delivered", "was refused
    /// (scan-cut-short) and is in quarantine".
    pub state: String,
    /// The reason as a sentence of its own, if there is one.
    pub why: Option<&'static str>,
    /// When that was; `None` if the journal does not know.
    pub at: Option<Timestamp>,
    /// The scan's first digits; `None` for a file that was refused unread.
    pub scan: Option<String>,
    /// When that scan came in, if the file only has its points and triangles again, in other bytes.
    pub again_since: Option<Timestamp>,
}

/// Who asks: the language and time zone of the answer.
#[derive(Debug, Clone, Copy)]
pub struct Asked<'a> {
    pub language: Language,
    pub zone: &'a TimeZone,
}

impl Asked<'_> {
    fn text(self, key: &'static str) -> String {
        self.language.text(key).to_owned()
    }

    fn at(self, key: &'static str, name: &str, at: Timestamp) -> String {
        self.language.filled(key, &[(name, &local(at, self.zone))])
    }
}

/// Explains where a file is and why.
pub fn of_file(facts: &Facts, path: &Path, known: Option<FileHistory>, asked: Asked<'_>) -> String {
    let source = facts.sources.iter().find(|source| {
        source.folder.as_ref().is_some_and(|folder| path != folder && path.starts_with(folder))
    });
    if let Some(file) = source.and_then(|source| source.waiting.get(path)) {
        let key = if known.is_some() { "explain.file_changed" } else { "explain.file" };
        return asked.language.filled(key, &[("state", &waits(file, facts.intake, asked))]);
    }
    if let Some(known) = known {
        return known_file(&known, asked);
    }
    match source {
        Some(source) => not_seen(source, path, asked),
        None => asked.text("explain.elsewhere"),
    }
}

fn waits(file: &WaitingFile, intake: IntakeState, asked: Asked<'_>) -> String {
    let language = asked.language;
    let shut = match intake {
        IntakeState::Open => String::new(),
        IntakeState::Paused => asked.text("explain.paused"),
        IntakeState::DiskLow { free, floor } => {
            let [free, floor] = [free, floor].map(|size| bytes(size, language));
            language.filled("explain.disk_low", &[("free", &free), ("floor", &floor)])
        }
    };
    let words: [(&str, &dyn Display); 3] = [
        ("wait", &file.wait.words(language)),
        ("since", &local(file.since, asked.zone)),
        ("shut", &shut),
    ];
    language.filled(if file.overdue { "explain.waits_late" } else { "explain.waits" }, &words)
}

fn known_file(known: &FileHistory, asked: Asked<'_>) -> String {
    let language = asked.language;
    let state = match known.at {
        None => known.state.clone(),
        Some(at) => language
            .filled("explain.state_at", &[("state", &known.state), ("at", &local(at, asked.zone))]),
    };
    let sentence = match (&known.scan, known.again_since) {
        (None, _) => language.filled("explain.file", &[("state", &state)]),
        (Some(scan), None) => {
            language.filled("explain.scan_of_file", &[("scan", scan), ("state", &state)])
        }
        (Some(scan), Some(taken)) => {
            let words: [(&str, &dyn Display); 3] =
                [("scan", scan), ("taken", &local(taken, asked.zone)), ("state", &state)];
            language.filled("explain.same_as", &words)
        }
    };
    match known.why {
        Some(why) => format!("{sentence} {why}"),
        None => sentence,
    }
}

fn not_seen(source: &SourceFacts, path: &Path, asked: Asked<'_>) -> String {
    let language = asked.language;
    let ignored = path.ancestors().find_map(|place| Some((place, source.ignored.get(place)?.why)));
    if let Some((place, why)) = ignored {
        let words = if place == path { why.words(language) } else { why.words_within(language) };
        let sentence = language.filled("explain.file", &[("state", &words)]);
        return match why.is_of_name() {
            true => format!("{sentence} {}", language.text("explain.name_stays")),
            false => sentence,
        };
    }
    if let Some(at) = source.gone.get(path) {
        return asked.at("explain.gone", "at", *at);
    }
    let because = |key, why: &Cause| {
        let words: [(&str, &dyn Display); 2] =
            [("since", &local(source.since, asked.zone)), ("why", &why.in_words(language))];
        language.filled(key, &words)
    };
    match &source.state {
        SourceState::NotLooked => asked.text("explain.folder.not_looked"),
        SourceState::OutOfReach(error) => because("explain.folder.out_of_reach", error),
        SourceState::NotMounted(why) => because("explain.folder.not_mounted", why),
        SourceState::Taken => asked.text("explain.folder.taken"),
        SourceState::Stalled => asked.at("explain.folder.stalled", "since", source.since),
        SourceState::Watched => unseen(source, path, asked),
    }
}

/// A file that the last look did not find among the scans.
fn unseen(source: &SourceFacts, path: &Path, asked: Asked<'_>) -> String {
    let name = path.file_name().unwrap_or_default();
    if let Some(why) = PassedOver::by_name(&name.to_string_lossy()) {
        let words = why.words(asked.language);
        return asked.language.filled("explain.file", &[("state", &words)]);
    }
    if companions::is_companion(name) {
        return asked.text("explain.companion");
    }
    match source.last_look {
        Some(at) => asked.at("explain.not_there", "at", at),
        None => asked.text("explain.folder.not_looked_through"),
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::export::passed_over::Ignored;
    use crate::settle::Wait;

    static UTC: TimeZone = TimeZone::UTC;

    fn in_english() -> Asked<'static> {
        Asked { language: Language::En, zone: &UTC }
    }

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
        of_file(facts, Path::new(path), None, in_english())
    }

    fn waiting(overdue: bool) -> WaitingFile {
        WaitingFile { wait: Wait::Changing, since: at(1), overdue }
    }

    #[test]
    fn a_waiting_file_says_for_what_and_what_else_is_in_the_way() {
        let mut facts = facts(|source| {
            source.waiting.insert("/e/a.obj".into(), waiting(true));
        });
        assert_eq!(
            said(&facts, "/e/a.obj"),
            "The file is still being written (seen since 1970-01-01 00:00:01, longer than a file \
             should wait)."
        );
        facts.intake = IntakeState::Paused;
        assert!(said(&facts, "/e/a.obj").ends_with("; the operator has paused the station."));
        facts.intake = IntakeState::DiskLow { free: 1, floor: 2 };
        assert!(said(&facts, "/e/a.obj").contains("1 B are free, 2 B must stay free"));
        let german = Asked { language: Language::De, ..in_english() };
        let said = of_file(&facts, Path::new("/e/a.obj"), None, german);
        assert!(said.starts_with("Die Datei wird noch geschrieben (gesehen seit 1970"), "{said}");
    }

    #[test]
    fn a_known_file_says_what_became_of_it_unless_it_has_changed() {
        let known = FileHistory {
            state: "was delivered".into(),
            why: None,
            at: Some(at(5)),
            scan: Some("0123abcd".into()),
            again_since: None,
        };
        let path = Path::new("/e/a.obj");
        assert_eq!(
            of_file(&facts(|_| ()), path, Some(known.clone()), in_english()),
            "The file's scan 0123abcd was delivered (1970-01-01 00:00:05)."
        );
        let held = FileHistory { why: Some("Nobody pressed the button for it."), ..known.clone() };
        let said = of_file(&facts(|_| ()), path, Some(held), in_english());
        assert!(said.ends_with("00:00:05). Nobody pressed the button for it."), "{said}");
        let again = FileHistory { again_since: Some(at(3)), ..known.clone() };
        assert_eq!(
            of_file(&facts(|_| ()), path, Some(again), in_english()),
            "The file has the points and triangles of scan 0123abcd, taken 1970-01-01 00:00:03, \
             which was delivered (1970-01-01 00:00:05)."
        );
        let facts = facts(|source| {
            source.waiting.insert(path.into(), waiting(false));
        });
        let said = of_file(&facts, path, Some(known), in_english());
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
