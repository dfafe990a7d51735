//! How a mapping writes dates.

use jiff::civil::DateTime;
use serde::{Deserialize, Serialize};

/// A format of dates and times, such as `%d.%m.%Y`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct DateFormat(String);

impl Default for DateFormat {
    fn default() -> DateFormat {
        DateFormat("%Y-%m-%d".to_owned())
    }
}

impl DateFormat {
    /// The format of a text; `None` if it has no part of a date, or another letter behind `%`.
    pub fn new(text: &str) -> Option<DateFormat> {
        let mut parts = text.split('%').skip(1).peekable();
        let is_date = parts.peek().is_some();
        let is_known = |part: &str| part.starts_with(['d', 'm', 'Y', 'y', 'H', 'M', 'S']);
        (is_date && parts.all(is_known)).then(|| DateFormat(text.to_owned()))
    }

    /// A date and time in this format.
    pub fn text(&self, at: DateTime) -> String {
        at.strftime(&self.0).to_string()
    }
}

#[cfg(test)]
mod tests {
    use jiff::civil::date;

    use super::*;

    #[test]
    fn a_date_is_written_as_its_format_says() {
        let at = date(2026, 3, 7).at(9, 5, 0, 0);
        let told = |format: &str| DateFormat::new(format).map(|of| of.text(at));
        assert_eq!(told("%d.%m.%Y").as_deref(), Some("07.03.2026"));
        assert_eq!(told("%y%m%d %H:%M:%S").as_deref(), Some("260307 09:05:00"));
        assert_eq!(DateFormat::default().text(at), "2026-03-07");
        assert_eq!(["", "today", "%", "%d%", "%B", "%%"].map(told), [const { None }; 6]);
    }
}
