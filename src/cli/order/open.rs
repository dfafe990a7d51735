//! What a person must know before an order is sent: boxes that are open, a scan that is too old, and what is to be
//! made sure of.

use gaiter_language::Language;
use gaiter_record::order::{OpenBox, Order, OrderSide, State};

/// The sentences; empty if there is nothing.
pub fn lines(order: &Order, language: Language) -> Vec<String> {
    let mut sentences = Vec::new();
    for side in [OrderSide::Right, OrderSide::Left, OrderSide::Body] {
        let of_side = order.open.iter().filter(|of| of.side == side);
        let boxes: Vec<String> = of_side.map(|of| in_words(of, language)).collect();
        if !boxes.is_empty() {
            let side = language.word("ordering.side", side.word());
            let boxes = boxes.join(", ");
            sentences.push(language.filled("ordering.open", &[("side", &side), ("boxes", &boxes)]));
        }
    }
    sentences.extend(order.is_of_an_old_scan().then(|| of_age(order, language)));
    if !order.to_check.is_empty() {
        let codes = order.to_check.join(", ");
        sentences.push(language.filled("ordering.make_sure", &[("codes", &codes)]));
    }
    let otherwise = order.reorder.as_ref().map(|reorder| reorder.taken_otherwise.join(", "));
    if let Some(what) = otherwise.filter(|words| !words.is_empty()) {
        sentences.push(language.filled("ordering.otherwise", &[("what", &what)]));
    }
    sentences
}

/// Why the scan is too old.
fn of_age(order: &Order, language: Language) -> String {
    match order.holds_until {
        Some(last) => language.filled("ordering.too_old", &[("last", &last)]),
        None => language.text("ordering.no_day").to_owned(),
    }
}

fn in_words(of: &OpenBox, language: Language) -> String {
    let OpenBox { form_box, why, is_optional, .. } = of;
    let why = match why {
        State::Measured | State::ByHand => State::NotMeasured,
        why => *why,
    };
    let why = language.word("ordering.why", why.word());
    match is_optional {
        true => format!("{form_box} ({})", language.filled("ordering.optional", &[("why", &why)])),
        false => format!("{form_box} ({why})"),
    }
}
