//! Why something does not work, as data: logs, journal and programs have it in English, people in the language
//! of the station.

use std::collections::BTreeMap;
use std::fmt::{self, Display};
use std::io;

use gaiter_language::{Language, fill};
use gaiter_record::gdt::OrderFault;
use serde::{Deserialize, Serialize};

/// The key of an error of the operating system. Its words stand below [`SYSTEM`], under its number.
const OF_SYSTEM: &str = "of-system";

/// The texts of the errors of the operating system, by their numbers (errno of Linux).
const SYSTEM: &str = "system";

/// The errors that disks and folders have: not there, no rights, broken, full, not writable, gone with its share.
const OF_DISK: [&str; 9] = ["2", "5", "13", "20", "21", "28", "30", "116", "122"];

/// Why something does not work.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Cause {
    english: String,
    /// The key of its text in the table `cause` of each language; `None` if there are only the English words of
    /// a library.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    is: Option<String>,
    /// What fills the places of its text.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    names: BTreeMap<String, String>,
}

impl Cause {
    /// One that has a text in each language, with what fills its places.
    pub fn known(is: &str, names: impl IntoIterator<Item = (&'static str, String)>) -> Cause {
        let names: BTreeMap<String, String> =
            names.into_iter().map(|(name, words)| (name.to_owned(), words)).collect();
        let english = worded(is, &names, Language::En).unwrap_or_else(|| is.to_owned());
        Cause { english, is: Some(is.to_owned()), names }
    }

    /// One in English in every language: the words of a library, or a text for experts.
    pub fn verbatim(words: impl Display) -> Cause {
        Cause { english: words.to_string(), is: None, names: BTreeMap::new() }
    }

    /// An error of the operating system. Any other error keeps its own text.
    pub fn of_system(error: &io::Error) -> Cause {
        let plain = Cause::verbatim(error);
        match (error.raw_os_error(), error.kind()) {
            (Some(number), _) => {
                let names = BTreeMap::from([("number".to_owned(), number.to_string())]);
                Cause { is: Some(OF_SYSTEM.to_owned()), names, ..plain }
            }
            (None, io::ErrorKind::TimedOut) => Cause::known("timed-out", []),
            (None, _) => plain,
        }
    }

    /// The same after what was tried, for logs. A person reads only the cause itself.
    pub fn after(self, tried: impl Display) -> Cause {
        Cause { english: format!("{tried}: {}", self.english), ..self }
    }

    /// Whether another language may have words for it.
    pub fn is_known(&self) -> bool {
        self.is.is_some()
    }

    /// Whether it is an error that disks and folders have, not one of a network.
    pub(crate) fn is_of_disk(&self) -> bool {
        let number = self.names.get("number").filter(|_| self.is.as_deref() == Some(OF_SYSTEM));
        number.is_some_and(|number| OF_DISK.contains(&number.as_str()))
    }

    /// In a language.
    pub fn in_words(&self, language: Language) -> String {
        let own = match (language, &self.is) {
            (Language::En, _) | (_, None) => None,
            (_, Some(is)) => worded(is, &self.names, language),
        };
        own.unwrap_or_else(|| self.english.clone())
    }
}

/// The text of a key with its places filled; `None` if the language has none.
fn worded(is: &str, names: &BTreeMap<String, String>, language: Language) -> Option<String> {
    let text = language.find(&format!("cause.{is}"))?;
    fill(text, |name, _| match (is, name) {
        (OF_SYSTEM, "what") => {
            let what = language.find(&format!("cause.{SYSTEM}.{}", names.get("number")?))?;
            Some(what.to_owned())
        }
        _ => names.get(name).cloned(),
    })
}

impl Display for Cause {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(&self.english)
    }
}

impl From<&str> for Cause {
    fn from(words: &str) -> Cause {
        Cause::verbatim(words)
    }
}

impl From<String> for Cause {
    fn from(words: String) -> Cause {
        Cause { english: words, is: None, names: BTreeMap::new() }
    }
}

impl From<&OrderFault> for Cause {
    fn from(fault: &OrderFault) -> Cause {
        let (is, names) = fault.says();
        Cause::known(is, names)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_of_the_system_is_worded_by_its_number_and_english_words_stay_as_they_are() {
        let full = Cause::of_system(&io::Error::from_raw_os_error(28)).after("writing failed");
        assert_eq!(full.to_string(), "writing failed: No space left on device (os error 28)");
        assert_eq!(full.in_words(Language::En), full.to_string());
        assert_eq!(full.in_words(Language::De), "der Datenträger ist voll (Systemfehler 28)");
        let unknown = Cause::of_system(&io::Error::from_raw_os_error(4095));
        assert_eq!(unknown.in_words(Language::De), unknown.to_string());
        let other = Cause::of_system(&io::Error::other("the ledger is shut"));
        assert_eq!(other.in_words(Language::De), "the ledger is shut");
    }

    /// Red if a number of the table means another error on Linux.
    #[test]
    fn the_table_of_errors_says_in_english_what_the_system_says() {
        let table: Vec<_> = Language::En.table("cause.system").collect();
        assert!(table.len() > 20, "{table:?}");
        for (number, what) in table {
            let error = io::Error::from_raw_os_error(number.parse().unwrap());
            assert_eq!(format!("{what} (os error {number})"), error.to_string());
            let german = Cause::of_system(&error).in_words(Language::De);
            assert!(german.ends_with(&format!("(Systemfehler {number})")), "{german}");
        }
    }

    #[test]
    fn a_cause_goes_to_another_program_and_is_worded_there() {
        let found = [("found", "ext4".to_owned()), ("was", "SMB".to_owned())];
        let gone = Cause::known("share-gone", found);
        assert_eq!(gone.to_string(), "was on SMB before and is on ext4 now, so the share is gone");
        assert_eq!(
            gone.in_words(Language::De),
            "er lag vorher auf SMB und liegt jetzt auf ext4: Die Freigabe ist weg"
        );
    }

    #[test]
    fn why_an_order_was_refused_is_worded_in_each_language() {
        let fault = OrderFault::TwoPatients { first: 4, second: 7 };
        let cause = Cause::from(&fault);
        assert_eq!(cause.to_string(), fault.to_string());
        let german = "die Zeilen 4 und 7 nennen verschiedene Patienten";
        assert_eq!(cause.in_words(Language::De), german);
    }
}
