//! How a mapping writes dates.

use jiff::civil::DateTime;
use serde::{Deserialize, Serialize};

/// A format of dates and times, such as `%d.%m.%Y`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct DateFormat(Vec<Part>);

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
enum Part {
    Sign(char),
    Day,
    Month,
    Year,
    ShortYear,
    Hour,
    Minute,
    Second,
}

impl Default for DateFormat {
    /// `%Y-%m-%d`.
    fn default() -> DateFormat {
        DateFormat(vec![Part::Year, Part::Sign('-'), Part::Month, Part::Sign('-'), Part::Day])
    }
}

impl DateFormat {
    /// The format of a text; `None` if it has no part of a date, or another letter behind `%`.
    pub fn new(text: &str) -> Option<DateFormat> {
        let mut parts = Vec::new();
        let mut letters = text.chars();
        while let Some(letter) = letters.next() {
            parts.push(match letter {
                '%' => match letters.next()? {
                    'd' => Part::Day,
                    'm' => Part::Month,
                    'Y' => Part::Year,
                    'y' => Part::ShortYear,
                    'H' => Part::Hour,
                    'M' => Part::Minute,
                    'S' => Part::Second,
                    _ => return None,
                },
                sign => Part::Sign(sign),
            });
        }
        parts.iter().any(|part| !matches!(part, Part::Sign(_))).then_some(DateFormat(parts))
    }

    /// A date and time in this format.
    pub fn text(&self, at: DateTime) -> String {
        let part = |part: &Part| match part {
            Part::Sign(sign) => sign.to_string(),
            Part::Day => format!("{:02}", at.day()),
            Part::Month => format!("{:02}", at.month()),
            Part::Year => format!("{:04}", at.year()),
            Part::ShortYear => format!("{:02}", at.year().rem_euclid(100)),
            Part::Hour => format!("{:02}", at.hour()),
            Part::Minute => format!("{:02}", at.minute()),
            Part::Second => format!("{:02}", at.second()),
        };
        self.0.iter().map(part).collect()
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
