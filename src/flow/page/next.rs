//! Who is next: the patient who is named, and the exports that are awaited.

use serde::Serialize;

use super::light::Situation;
use super::words::say;
use crate::record::{Language, shown};

/// The next patient on the page.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct NextShown {
    /// Who is next, without the id.
    pub sentence: String,
    /// The id of who is named for the next press, where ids are shown.
    pub id: Option<String>,
    /// There is something that can be called off.
    pub can_be_called_off: bool,
    /// A press may have gone unheard, in words.
    pub doubt: Option<&'static str>,
}

/// Who is next.
pub(super) fn shown(booth: &Situation<'_>, language: Language) -> NextShown {
    let awaited = match (booth.awaited, language) {
        (0, _) => None,
        (1, Language::En) => Some("One export is awaited.".to_owned()),
        (1, Language::De) => Some("Ein Export wird erwartet.".to_owned()),
        (count, Language::En) => Some(format!("{count} exports are awaited.")),
        (count, Language::De) => Some(format!("{count} Exporte werden erwartet.")),
    };
    let named = match booth.named {
        Some(_) => Some(("Named for the next scan.", "Benannt für den nächsten Scan.")),
        None if awaited.is_none() => Some(("Nobody is named.", "Niemand ist benannt.")),
        None => None,
    };
    let named = named.map(|both| say(language, both).to_owned());
    let sentences: Vec<String> = named.into_iter().chain(awaited).collect();
    let doubt = (
        "A press of the button may have gone unheard: scans of named patients are held.",
        "Ein Knopfdruck wurde vielleicht nicht gehört: Scans benannter Personen werden angehalten.",
    );
    NextShown {
        sentence: sentences.join(" "),
        id: booth.named.map(shown::id),
        can_be_called_off: booth.named.is_some() || booth.awaited > 0,
        doubt: booth.is_in_doubt.then(|| say(language, doubt)),
    }
}
