//! The languages of what people read.

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
    /// What is said in this language.
    pub fn pick<T>(self, english: T, german: T) -> T {
        match self {
            Language::En => english,
            Language::De => german,
        }
    }

    /// Its tag on pages (BCP 47).
    pub fn tag(self) -> &'static str {
        self.pick("en", "de")
    }
}
