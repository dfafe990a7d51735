//! What to do, in words.

use std::fmt::Display;

use gaiter_language::Language;
use gaiter_leg::{Level, Side};

use super::{Completeness, Item, Kind, Part};

impl Completeness {
    /// What to do in sentences, the most important first; at least one.
    pub fn sentences(&self, language: Language) -> Vec<String> {
        let garment = self.garment.in_sentence(language.tag());
        if self.kind() == Kind::Complete {
            return vec![language.filled("completeness.complete", &[("garment", &garment)])];
        }
        let mut lines = Vec::new();
        if !self.again.is_empty() {
            let why: Vec<&str> = self
                .again
                .iter()
                .map(|why| language.word("completeness.again", why.word()))
                .collect();
            lines.push(language.filled("completeness.scan_again", &[("why", &why.join(", "))]));
        }
        let legs = items_by_leg(&self.by_hand, language);
        if !legs.is_empty() {
            let key = if self.again.is_empty() {
                "completeness.by_hand"
            } else {
                "completeness.or_by_hand"
            };
            let words: [(&str, &dyn Display); 2] = [("items", &legs), ("garment", &garment)];
            lines.push(language.filled(key, &words));
        }
        let not_measurable = items_by_leg(&self.not_measurable, language);
        if !not_measurable.is_empty() {
            let words: [(&str, &dyn Display); 1] = [("items", &not_measurable)];
            lines.push(language.filled("completeness.not_measurable", &words));
        }
        let checks = self.checks.iter();
        lines.extend(
            checks.map(|check| language.word("completeness.check", check.word()).to_owned()),
        );
        lines
    }
}

/// `right leg: C and D; left leg: D`; empty if there are none.
fn items_by_leg(of_legs: &[Vec<Item>; 2], language: Language) -> String {
    let of_leg = |(side, items): (Side, &Vec<Item>)| {
        let names: Vec<String> = items.iter().map(|item| item.name(language)).collect();
        let items = match names.as_slice() {
            [] => return None,
            [only] => only.clone(),
            [first @ .., last] => {
                format!("{}{}{last}", first.join(", "), language.text("completeness.and"))
            }
        };
        let leg = match side {
            Side::Left => "completeness.leg.left",
            Side::Right => "completeness.leg.right",
        };
        Some(language.filled(leg, &[("items", &items)]))
    };
    let legs = Side::FROM_FRONT.into_iter().zip(of_legs);
    legs.filter_map(of_leg).collect::<Vec<_>>().join("; ")
}

impl Item {
    /// The short name: `C`, `C (height)`, or a word.
    fn name(self, language: Language) -> String {
        let of_level =
            |key, level: Level| language.filled(key, &[("level", &level.name() as &dyn Display)]);
        match self {
            Item::Level(level, Part::Both) => level.name().to_owned(),
            Item::Level(level, Part::Girth) => of_level("completeness.item.girth", level),
            Item::Level(level, Part::Height) => of_level("completeness.item.height", level),
            Item::Foot => language.text("completeness.item.foot").to_owned(),
            Item::InsideLeg => language.text("completeness.item.inside_leg").to_owned(),
        }
    }
}
