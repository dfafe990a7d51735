//! What the station complains of, as data, and its words in a language.

use std::collections::BTreeMap;
use std::fmt::Display;
use std::time::Duration;

use gaiter_language::{Language, fill};
use serde::{Deserialize, Serialize};

use super::cause::Cause;
use super::export::passed_over::{self, PassedOver};
use super::words::{bytes, decimals, duration, signed};

/// In the place of a figure that a complaint does not have.
const NOT_KNOWN: &str = "?";

/// The figure for the cause: it follows the message.
const WHY: &str = "why";

/// The end of the name under which a cause stands as data beside its English words.
const AS_DATA: &str = "_is";

/// What a fault of a disk is about.
const DISK: &str = "disk";

/// Whether a complaint keeps the station from being ready.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Severity {
    /// Scans do not become records.
    #[default]
    Fault,
    /// They do, and a person should know something all the same.
    Notice,
}

/// Something that keeps the station from being ready, or that a person should know. Its words are under its
/// code in the table `complaint` of each language.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Complaint {
    /// Stable code.
    pub code: String,
    /// Whether it keeps the station from being ready.
    #[serde(default)]
    pub severity: Severity,
    /// The store or port that it is about.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub subject: Option<String>,
    /// The figures in its message.
    #[serde(default, skip_serializing_if = "ComplaintFigures::is_empty")]
    pub figures: ComplaintFigures,
}

/// The figures of a complaint, by name. Names end with the unit.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct ComplaintFigures(BTreeMap<String, ComplaintFigure>);

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum ComplaintFigure {
    /// A number of things, seconds or bytes.
    Count(u64),
    /// A measure.
    Number(f64),
    /// How much is passed over in the export folders, by its reason.
    Unread(BTreeMap<PassedOver, usize>),
    /// A name, which of the complaint's texts it is, or a cause in English.
    Words(String),
    /// A cause as data, so that every language has its words.
    Cause(Cause),
}

impl ComplaintFigures {
    /// The cause, and nothing else.
    pub fn why(why: &Cause) -> ComplaintFigures {
        ComplaintFigures::default().cause(WHY, why)
    }

    /// A number of things, and which of the complaint's texts fits it: `one` or `more`.
    pub fn counted(count: usize) -> ComplaintFigures {
        let case = if count == 1 { "one" } else { "more" };
        ComplaintFigures::default().count("count", count as u64).words("case", case)
    }

    /// With a number of things, or of bytes.
    pub fn count(self, name: &str, count: u64) -> ComplaintFigures {
        self.with(name, ComplaintFigure::Count(count))
    }

    /// With a duration in seconds. One that is not known is left out.
    pub fn seconds(self, name: &str, duration: Option<Duration>) -> ComplaintFigures {
        match duration {
            Some(duration) => self.with(name, ComplaintFigure::Count(duration.as_secs())),
            None => self,
        }
    }

    /// With a measure.
    pub fn number(self, name: &str, value: f64) -> ComplaintFigures {
        self.with(name, ComplaintFigure::Number(value))
    }

    /// With how much is passed over, by its reason.
    pub fn unread(self, counts: BTreeMap<PassedOver, usize>) -> ComplaintFigures {
        self.with("unread", ComplaintFigure::Unread(counts))
    }

    /// With a name, the key of one of the complaint's texts, or the system's own words.
    pub fn words(self, name: &str, words: impl Display) -> ComplaintFigures {
        self.with(name, ComplaintFigure::Words(words.to_string()))
    }

    /// With a cause: its English words, and itself beside them if other languages have words for it.
    pub fn cause(self, name: &str, cause: &Cause) -> ComplaintFigures {
        let beside = format!("{name}{AS_DATA}");
        let figures = self.words(name, cause);
        match cause.is_known() {
            true => figures.with(&beside, ComplaintFigure::Cause(cause.clone())),
            false => figures,
        }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    fn with(mut self, name: &str, figure: ComplaintFigure) -> ComplaintFigures {
        self.0.insert(name.to_owned(), figure);
        self
    }
}

impl Complaint {
    /// A fault with this code.
    pub fn new(code: &str, figures: ComplaintFigures) -> Complaint {
        Complaint { code: code.to_owned(), severity: Severity::Fault, subject: None, figures }
    }

    /// A notice with this code.
    pub(crate) fn notice(code: &str, figures: ComplaintFigures) -> Complaint {
        Complaint { severity: Severity::Notice, ..Complaint::new(code, figures) }
    }

    /// The same about a store or port.
    pub(crate) fn about(self, subject: &str) -> Complaint {
        Complaint { subject: Some(subject.to_owned()), ..self }
    }

    /// The journal cannot be read.
    pub fn journal() -> Complaint {
        Complaint::new("journal-failed", ComplaintFigures::default())
    }

    /// Whether it keeps the station from being ready.
    pub fn is_fault(&self) -> bool {
        self.severity == Severity::Fault
    }

    /// What is wrong, for the technician: a sentence without its full stop. An unknown code stands for itself.
    pub fn message(&self, language: Language) -> String {
        let Some(what) = self.text("message", language) else { return self.code.clone() };
        match self.figures.0.get(WHY) {
            Some(ComplaintFigure::Words(why)) => {
                let why = self.words_of(WHY, why, language);
                language.filled("complaint.because", &[("what", &what), ("why", &why)])
            }
            _ => what,
        }
    }

    /// What the technician can do, in the same form.
    pub fn remedy(&self, language: Language) -> String {
        let own = self.text("remedy", language);
        own.unwrap_or_else(|| language.text("complaint.other.remedy").to_owned())
    }

    /// Its code with what it is about, under which it may have texts of its own; `None` if it is about nothing. The
    /// advice of a server is about the network: with a fault of the disk, that of disks counts.
    pub(crate) fn own_code(&self) -> Option<String> {
        let own = format!("{}-{}", self.code, self.subject.as_ref()?);
        let why = self.figures.0.get(&format!("{WHY}{AS_DATA}"));
        let is_of_disk = matches!(why, Some(ComplaintFigure::Cause(why)) if why.is_of_disk());
        let has_advice = Language::En.find(&format!("complaint.{own}.remedy")).is_some();
        Some(if is_of_disk && has_advice { format!("{}-{DISK}", self.code) } else { own })
    }

    /// One of its texts with its figures; `None` if there is none.
    fn text(&self, which: &str, language: Language) -> Option<String> {
        let of = |code: &str| language.find(&format!("complaint.{code}.{which}"));
        let template = self.own_code().and_then(|code| of(&code)).or_else(|| of(&self.code))?;
        fill(template, |name, form| Some(self.word(name, form, language)))
    }

    /// What fills a place of a text. `time` is of a duration in seconds, `size` of bytes, `signed` of a measure with
    /// its sign, `tenths` of one without; in the place of a `word` stands the text of the complaint with that key.
    fn word(&self, name: &str, form: &str, language: Language) -> String {
        if let ("subject", Some(subject)) = (name, &self.subject) {
            return subject.clone();
        }
        match (form, self.figures.0.get(name)) {
            ("time", Some(ComplaintFigure::Count(s))) => {
                duration(Duration::from_secs(*s), language)
            }
            ("time", _) => language.text("duration.unknown").to_owned(),
            ("size", Some(ComplaintFigure::Count(size))) => bytes(*size, language),
            ("signed", Some(ComplaintFigure::Number(value))) => signed(*value, 1, language),
            ("tenths", Some(ComplaintFigure::Number(value))) => decimals(*value, 1, language),
            ("word", Some(ComplaintFigure::Words(which))) => {
                self.text(which, language).unwrap_or_else(|| which.clone())
            }
            (_, Some(ComplaintFigure::Count(count))) => count.to_string(),
            (_, Some(ComplaintFigure::Number(value))) => {
                value.to_string().replace('.', language.decimal_sign())
            }
            (_, Some(ComplaintFigure::Unread(counts))) => {
                let counts = counts.iter().map(|(why, count)| (why.word(), *count));
                passed_over::listed(counts, language)
            }
            (_, Some(ComplaintFigure::Words(words))) => self.words_of(name, words, language),
            (_, Some(ComplaintFigure::Cause(cause))) => cause.in_words(language),
            (_, None) => NOT_KNOWN.to_owned(),
        }
    }

    /// The words of a figure, in the language if they are those of a cause.
    fn words_of(&self, name: &str, words: &str, language: Language) -> String {
        match self.figures.0.get(&format!("{name}{AS_DATA}")) {
            Some(ComplaintFigure::Cause(cause)) => cause.in_words(language),
            _ => words.to_owned(),
        }
    }
}
