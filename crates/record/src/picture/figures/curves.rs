//! What the charts of girths and of slopes have in common: the lines of the legs and the places of labels.

use gaiter_language::Language;
use gaiter_leg::Side;

use super::plot::stroked;
use crate::picture::{Anchor, Ink, Mark, Stroke};

/// Top and bottom of both charts, px.
pub(super) const ROWS_PX: [f64; 2] = [64.0, 446.0];

/// Length of the dashes of the right leg's line, px; the left leg's has none.
const DASH: f64 = 6.0;

/// Distance from a level's mark to its label, px.
const ASIDE: f64 = 19.0;

/// The legs in the order of their curves: the dashes of the right leg lie over the line of the left one, so
/// that both are seen where they have the same girth.
pub(super) fn left_first<T>(legs: impl Iterator<Item = T>) -> impl Iterator<Item = T> {
    legs.collect::<Vec<_>>().into_iter().rev()
}

/// The line of a leg, broken where a place is missing.
pub(super) fn line(side: Side, places: impl Iterator<Item = Option<[f64; 2]>>) -> Mark {
    let mut lines = vec![Vec::new()];
    for place in places {
        match place {
            Some(place) => {
                lines.last_mut().into_iter().for_each(|line: &mut Vec<_>| line.push(place))
            }
            None => lines.push(Vec::new()),
        }
    }
    lines.retain(|line| line.len() > 1);
    let ink = Ink::for_side(side);
    let stroke = match side {
        Side::Left => Stroke::solid(ink, 2.0),
        Side::Right => Stroke::dashed(ink, 2.0, DASH),
    };
    stroked(lines, stroke)
}

/// Whether a place is to the right of the other leg's line, so that a label there does not cross it.
pub(super) fn is_outer_right(
    side: Side,
    [here, height_mm]: [f64; 2],
    line: Option<impl Iterator<Item = Option<[f64; 2]>>>,
) -> bool {
    let places: Vec<[f64; 2]> = line.into_iter().flatten().flatten().collect();
    let around = places.windows(2).find(|pair| pair[0][1] <= height_mm && height_mm <= pair[1][1]);
    let there = around.map(|pair| {
        let share = (height_mm - pair[0][1]) / (pair[1][1] - pair[0][1]).max(f64::MIN_POSITIVE);
        pair[0][0] + share * (pair[1][0] - pair[0][0])
    });
    match there {
        Some(there) if there != here => here > there,
        _ => side == Side::Left,
    }
}

/// Distance of a label from its place, px, and the anchor of the label.
pub(super) fn beside(at_right: bool) -> (f64, Anchor) {
    if at_right { (ASIDE, Anchor::Start) } else { (-ASIDE, Anchor::End) }
}

/// The letter of a leg, for those who do not see its colour.
pub(super) fn short(side: Side, language: Language) -> &'static str {
    language.word("leg.short", side.word())
}

/// The mark of B1.
pub(super) fn diamond([x, y]: [f64; 2], size: f64) -> Vec<[f64; 2]> {
    vec![[x + size, y], [x, y + size], [x - size, y], [x, y - size]]
}
