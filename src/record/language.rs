//! The languages of texts for people.

/// The language of a report and of the operator's page.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Language {
    /// English.
    #[default]
    En,
    /// German.
    De,
}

impl Language {
    /// Returns the text for this language.
    pub fn pick<T>(self, english: T, german: T) -> T {
        match self {
            Language::En => english,
            Language::De => german,
        }
    }

    /// Its language tag on pages (BCP 47).
    pub fn tag(self) -> &'static str {
        self.pick("en", "de")
    }
}
