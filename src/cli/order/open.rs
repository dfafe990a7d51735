//! What a person must know before an order is sent: boxes that are open, a scan that is too old, and what is to be
//! made sure of.

use gaiter_record::order::{OpenBox, Order, OrderSide, State};

/// The sentences; empty if there is nothing.
pub fn told(order: &Order) -> Vec<String> {
    let mut told = Vec::new();
    for side in [OrderSide::Right, OrderSide::Left, OrderSide::Body] {
        let of_side = order.open.iter().filter(|of| of.side == side);
        let boxes: Vec<String> = of_side.map(in_words).collect();
        if !boxes.is_empty() {
            told.push(format!("open, {}: {}", side.word(), boxes.join(", ")));
        }
    }
    told.extend(order.is_of_an_old_scan().then(|| of_age(order)));
    if !order.to_check.is_empty() {
        told.push(format!("make sure of: {}", order.to_check.join(", ")));
    }
    let otherwise = order.reorder.as_ref().map(|reorder| reorder.taken_otherwise.join(", "));
    if let Some(otherwise) = otherwise.filter(|words| !words.is_empty()) {
        told.push(format!(
            "no differences are told, because the last order was measured otherwise: {otherwise}"
        ));
    }
    told
}

/// Why the scan is too old.
fn of_age(order: &Order) -> String {
    match order.holds_until {
        Some(last) => format!(
            "the scan is too old for an order: its measures held until {last} (report.max_age); measure again"
        ),
        None => "the day of the scan is not known: measure again before an order".to_owned(),
    }
}

fn in_words(of: &OpenBox) -> String {
    let OpenBox { form_box, why, is_optional, .. } = of;
    let why = match why {
        State::Estimated => "estimated",
        State::Doubtful => "doubtful",
        State::NotMeasurable => "cannot be measured",
        State::NotByScan => "no scan gives it",
        State::NotMeasured | State::Measured | State::ByHand => "not measured",
    };
    let optional = if *is_optional { ", may stay empty" } else { "" };
    format!("{form_box} ({why}{optional})")
}
