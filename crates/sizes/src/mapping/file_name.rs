//! How the files of a mapping are named. Never by a patient.

use jiff::civil::Date;
use serde::{Deserialize, Serialize};

/// A name with places, such as `order-{id}-{scan}.csv`.
///
/// It begins with `order`, so that a later revision of a record knows which files it replaces, and differs
/// from `order.csv` and `order.json`, which gaiter itself writes.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct FileName(String);

/// What fills the places of a name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Named<'a> {
    /// The mapping.
    pub id: &'a str,
    /// The reference of the scan.
    pub scan: &'a str,
    /// The day of the scan; `None` if it is unknown.
    pub date: Option<Date>,
    /// The garment.
    pub garment: &'a str,
    /// The order's reference; `None` if it has none.
    pub order_ref: Option<&'a str>,
}

/// How a name begins.
const BEGIN: &str = "order";

/// Names that gaiter itself gives.
const TAKEN: [&str; 2] = ["order.csv", "order.json"];

/// The places of a name, in the order of [`Named`].
const PLACES: [&str; 5] = ["{id}", "{scan}", "{date}", "{garment}", "{ref}"];

/// The longest name with its places, and the longest text of a place, characters: all together stay below
/// the 255 that file systems take, also behind the key that practice software gets.
const NAME_MAX: usize = 80;
const PLACE_MAX: usize = 30;

/// The most places of a name; each is there once.
const PLACES_MAX: usize = 4;

/// What stands for a date or reference that is not known.
const NO_DATE: &str = "undated";
const NO_REF: &str = "noref";

impl FileName {
    /// The name of a text; `None` if it is none.
    pub fn new(text: &str) -> Option<FileName> {
        let is_taken = TAKEN.iter().any(|name| name.eq_ignore_ascii_case(text));
        let (stem, ending) = text.rsplit_once('.')?;
        let is_ending =
            (1..=5).contains(&ending.len()) && ending.chars().all(|c| c.is_ascii_alphanumeric());
        if is_taken || !is_ending || !stem.starts_with(BEGIN) || text.len() > NAME_MAX {
            return None;
        }
        let places = PLACES.iter().map(|place| text.matches(place).count()).sum::<usize>();
        // A place within a place is none: the letter keeps what is around it apart.
        let filled = PLACES.iter().fold(text.to_owned(), |text, place| text.replace(place, "x"));
        let is_plain = |letter: char| letter.is_ascii_alphanumeric() || "-_.".contains(letter);
        (places <= PLACES_MAX && filled.chars().all(is_plain) && !text.contains(".."))
            .then(|| FileName(text.to_owned()))
    }

    /// The name of a file: ASCII letters, digits, `-`, `_` and `.`; every other letter of a place is `-`.
    pub fn filled(&self, of: Named<'_>) -> String {
        let date = of.date.map_or(NO_DATE.to_owned(), |date| date.to_string());
        let words = [of.id, of.scan, &date, of.garment, of.order_ref.unwrap_or(NO_REF)];
        let places = PLACES.iter().zip(words);
        places.fold(self.0.clone(), |name, (place, word)| name.replace(place, &plain(word)))
    }
}

/// A text as part of a name.
fn plain(text: &str) -> String {
    let letter = |letter: char| match letter {
        letter if letter.is_ascii_alphanumeric() || letter == '_' => letter,
        _ => '-',
    };
    text.chars().map(letter).take(PLACE_MAX).collect()
}

#[cfg(test)]
mod tests {
    use jiff::civil::date;

    use super::*;

    const NAMED: Named<'_> = Named {
        id: "shop",
        scan: "1a2b3c4d",
        date: Some(date(2026, 3, 7)),
        garment: "Überstrumpf",
        order_ref: Some("../4 a"),
    };

    #[test]
    fn a_name_is_ascii_and_stays_in_its_folder() {
        let told = |text: &str| FileName::new(text).map(|name| name.filled(NAMED));
        let all = told("order-{id}_{scan}-{date}-{garment}.csv").unwrap();
        assert_eq!(all, "order-shop_1a2b3c4d-2026-03-07--berstrumpf.csv");
        assert_eq!(told("order{ref}.txt").as_deref(), Some("order---4-a.txt"));
        let unknown = Named { date: None, order_ref: None, ..NAMED };
        let name = FileName::new("order-{date}-{ref}.json").unwrap();
        assert_eq!(name.filled(unknown), "order-undated-noref.json");
        let long = Named { order_ref: Some("x".repeat(300).leak()), ..NAMED };
        assert!(FileName::new("order-{ref}.csv").unwrap().filled(long).len() < 100);
    }

    #[test]
    fn what_could_hide_replace_or_leave_is_no_name() {
        for text in [
            "",
            "order",
            "order.",
            "shop.csv",
            "report.pdf",
            "order.csv",
            "Order.CSV",
            "order.json",
            "order-{patient}.csv",
            "order-{.csv",
            "order-{id.csv",
            "order-ä.csv",
            "order/../x.csv",
            "order-..csv",
            "order x.csv",
            ".order.csv",
            "order-{id}.",
            "order-x.toolong",
            "order:.csv",
        ] {
            assert_eq!(FileName::new(text), None, "{text}");
        }
    }
}
