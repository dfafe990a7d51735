//! Compares the scanner's own measures (`.ord`) with ours: a second opinion on stature, calf and
//! ankle, and on which leg is the left one. It only gives findings and corrects nothing.

use gaiter_scan::ord::Ord;

use super::opinion::{Measure, SecondOpinion};
use crate::finding::{Finding, What};
use crate::level::Level;
use crate::measured::LegReport;
use crate::side::Side;
use crate::{Extraction, Landmark};

/// Names of measures as scanners write them, lower case, without spaces, underscores and sides.
/// `Head_Top_Height`, `Calf_Left`, `Calf_Right`, `Calf_Circ`, `Ankle_Girth_Left`,
/// `Ankle_Girth_Right` and `Ankle_Circ` come from a public program for \[TC\]2 files (the NOMO data
/// set); the others are obvious spellings of the same names, not seen in a file.
const NAMES: [(&str, Measure); 12] = [
    ("headtopheight", Measure::Stature),
    ("height", Measure::Stature),
    ("stature", Measure::Stature),
    ("bodyheight", Measure::Stature),
    ("calf", Measure::Calf),
    ("calfcirc", Measure::Calf),
    ("calfgirth", Measure::Calf),
    ("calfcircumference", Measure::Calf),
    ("ankle", Measure::Ankle),
    ("anklecirc", Measure::Ankle),
    ("anklegirth", Measure::Ankle),
    ("anklecircumference", Measure::Ankle),
];

/// Statures agree within this share: hair, and soles that no scanner sees, add some millimetres.
const STATURE_SHARE: f64 = 0.02;

/// If the ratio of two statures is one of these, or its inverse, their units differ (among mm, cm,
/// m and inch).
const UNIT_RATIOS: [f64; 6] = [2.54, 10.0, 25.4, 39.37, 100.0, 1000.0];

/// Calf girths agree within this, mm: two programs search for the largest girth in different planes
/// and smooth differently; tapes differ by 4 mm on average (ISO 20685). Judgement.
const CALF_MM: f64 = 15.0;

/// An ankle girth may be smaller than B by up to this, mm. It is taken over the malleoli, where the
/// leg is wider than at B, its narrowest point. Judgement.
const ANKLE_BELOW_B_MM: f64 = 10.0;

/// … and larger than B by up to this factor: the girth around heel and instep is 1.5 times B on
/// average (ANSUR II), and is not an ankle girth. Judgement.
const ANKLE_MAX_SHARE: f64 = 1.6;

/// The sides are in doubt if each of the two calves fits the other leg better by this much, mm. Two
/// programs differ by about 5 mm on one calf, and usually in the same direction on both. Judgement.
const SIDES_MM: f64 = 10.0;

/// Compares the scanner's measures with an extraction's. Measures that either side lacks are
/// skipped; after a unit mismatch nothing else is compared.
pub fn compare(extraction: &Extraction, ord: &Ord) -> Vec<Finding> {
    let stature = extraction.body.stature_mm.and_then(|ours_mm| stature(ord, ours_mm));
    let girths = match stature {
        Some(SecondOpinion::Unit { .. }) => Vec::new(),
        _ => legs(ord, &extraction.legs),
    };
    stature.map(Finding::from).into_iter().chain(girths).collect()
}

/// The first measure of this meaning and side, mm; a value of zero means that it was not taken.
fn mm(ord: &Ord, measure: Measure, side: Option<Side>) -> Option<f64> {
    let is = |(name, mm): &&(String, f64)| meaning(name) == Some((measure, side)) && *mm > 0.0;
    ord.measures.iter().find(is).map(|(_, mm)| *mm)
}

fn stature(ord: &Ord, ours_mm: f64) -> Option<SecondOpinion> {
    let theirs_mm = mm(ord, Measure::Stature, None)?;
    let ratio = (theirs_mm / ours_mm).max(ours_mm / theirs_mm);
    let near = |factor: f64| (ratio / factor - 1.0).abs() <= STATURE_SHARE;
    if near(1.0) {
        return None;
    }
    Some(match UNIT_RATIOS.into_iter().find(|&factor| near(factor)) {
        Some(factor) => SecondOpinion::Unit { theirs_mm, ours_mm, factor },
        None => SecondOpinion::Disagrees { measure: Measure::Stature, theirs_mm, ours_mm },
    })
}

fn legs(ord: &Ord, legs: &[LegReport]) -> Vec<Finding> {
    let calves = match sides(ord, legs) {
        // This finding covers the disagreement on each calf.
        Some(sides) => vec![Finding::from(sides)],
        None => girths(ord, legs, Measure::Calf, Level::C, |theirs_mm, ours_mm| {
            (theirs_mm - ours_mm).abs() <= CALF_MM
        }),
    };
    let ankles = girths(ord, legs, Measure::Ankle, Level::B, |theirs_mm, ours_mm| {
        (ours_mm - ANKLE_BELOW_B_MM..=ours_mm * ANKLE_MAX_SHARE).contains(&theirs_mm)
    });
    [calves, ankles].concat()
}

/// Whether each of the two calves fits the other leg clearly better.
fn sides(ord: &Ord, legs: &[LegReport]) -> Option<SecondOpinion> {
    let [left_mm, right_mm] = {
        let theirs = |side| mm(ord, Measure::Calf, Some(side));
        [theirs(Side::Left)?, theirs(Side::Right)?]
    };
    let ours = |side| Some(level_of(legs, side, Level::C)?.girth_tape_mm);
    let (left, right) = (ours(Side::Left)?, ours(Side::Right)?);
    let fits_better = |theirs: f64, other: f64, own: f64| {
        (theirs - own).abs() - (theirs - other).abs() >= SIDES_MM
    };
    let is_swapped = fits_better(left_mm, right, left) && fits_better(right_mm, left, right);
    is_swapped.then_some(SecondOpinion::Sides { left_mm, right_mm })
}

/// The disagreements about one girth: on each side, and for a measure without a side, which may
/// belong to either leg.
fn girths(
    ord: &Ord,
    legs: &[LegReport],
    measure: Measure,
    level: Level,
    agrees: impl Fn(f64, f64) -> bool,
) -> Vec<Finding> {
    let disagrees = |side: Option<Side>| {
        let theirs_mm = mm(ord, measure, side)?;
        let sides = side.map_or(Side::BOTH.to_vec(), |side| vec![side]);
        let ours = sides.into_iter().filter_map(|side| level_of(legs, side, level));
        let ours: Vec<f64> = ours.map(|landmark| landmark.girth_tape_mm).collect();
        if ours.iter().any(|&ours_mm| agrees(theirs_mm, ours_mm)) {
            return None;
        }
        let far = |a: &&f64| (**a - theirs_mm).abs();
        let ours_mm = *ours.iter().min_by(|a, b| far(a).total_cmp(&far(b)))?;
        let what = What::SecondOpinion(SecondOpinion::Disagrees { measure, theirs_mm, ours_mm });
        Some(Finding { side, level: Some(level), what })
    };
    [Some(Side::Left), Some(Side::Right), None].into_iter().filter_map(disagrees).collect()
}

fn level_of(legs: &[LegReport], side: Side, level: Level) -> Option<&Landmark> {
    legs.iter().find(|leg| leg.side == side)?.landmarks.iter().find(|l| l.level == level)
}

/// The measure and side that a name means; `None` if there is no counterpart here.
///
/// The side may occur as a word before, behind or within the name, or as a letter before or behind it.
fn meaning(name: &str) -> Option<(Measure, Option<Side>)> {
    let plain: String = name.chars().filter(char::is_ascii_alphanumeric).collect();
    let plain = plain.to_ascii_lowercase();
    let known = |name: &str| NAMES.iter().find(|(known, _)| *known == name).map(|(_, m)| *m);
    if let Some(measure) = known(&plain) {
        return Some((measure, None));
    }
    let of_side = |side: Side| {
        let word = side.word();
        let without = [
            plain.contains(word).then(|| plain.replacen(word, "", 1)),
            plain.strip_prefix(&word[..1]).map(str::to_owned),
            plain.strip_suffix(&word[..1]).map(str::to_owned),
        ];
        let measure = without.into_iter().flatten().find_map(|name| known(&name))?;
        (measure != Measure::Stature).then_some((measure, Some(side)))
    };
    Side::BOTH.into_iter().find_map(of_side)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_known_whatever_their_case_spaces_underscores_and_sides() {
        let (left, right) = (Some(Side::Left), Some(Side::Right));
        let names = [
            ("Head_Top_Height", Measure::Stature, None),
            ("Height", Measure::Stature, None),
            ("STATURE", Measure::Stature, None),
            ("Calf_Circ", Measure::Calf, None),
            ("Calf_Left", Measure::Calf, left),
            ("Calf Right", Measure::Calf, right),
            ("CalfLeft", Measure::Calf, left),
            ("LeftCalf", Measure::Calf, left),
            ("LCalf", Measure::Calf, left),
            ("R_Calf", Measure::Calf, right),
            ("calf-l", Measure::Calf, left),
            ("Calf_Right_Girth", Measure::Calf, right),
            ("Ankle", Measure::Ankle, None),
            ("Ankle_Girth_Left", Measure::Ankle, left),
            ("Ankle_Girth_Right", Measure::Ankle, right),
        ];
        for (name, measure, side) in names {
            assert_eq!(meaning(name), Some((measure, side)), "{name}");
        }
    }

    #[test]
    fn names_of_other_measures_mean_nothing_here() {
        let others = [
            "Calf_Height",
            "Ankle_Height",
            "Thigh_Left",
            "Hip_Height",
            "Knee_Circ",
            "Inseam",
            "",
            "Left",
            "Calf_Left_Right",
            "Head_Top_Height_Left",
            "Calves",
            "Left_Height",
        ];
        for name in others {
            assert_eq!(meaning(name), None, "{name}");
        }
    }
}
