//! The one rounding rule: the number of decimal places for each kind of figure. Everything that is
//! printed or stored uses it, so that the last digits agree everywhere.

use gaiter_language::Language;

pub use gaiter_leg::disturbance::MARGIN_SDS;

/// Lengths, to 1 µm.
pub fn mm(value: f64) -> f64 {
    to_places(value, 3)
}

/// Lengths in mm as cm, to 1 mm, as on a tape, for other programs.
pub fn cm(value_mm: f64) -> f64 {
    to_places(value_mm / 10.0, 1)
}

/// Standard errors in mm as cm, to 10 µm, for other programs.
pub(crate) fn sd_cm(sd_mm: f64) -> f64 {
    to_places(sd_mm / 10.0, 3)
}

/// Lengths in mm as text: cm with one decimal and the decimal sign of the language.
pub fn cm_words(value_mm: f64, language: Language) -> String {
    number(cm(value_mm), 1, language)
}

/// The limit of a size table in mm as text: cm with all its decimals, at least one.
pub fn limit_words(value_mm: f64, language: Language) -> String {
    let cm = to_places(value_mm / 10.0, 4);
    match to_places(cm, 1) == cm {
        true => number(cm, 1, language),
        false => shortest(cm, language),
    }
}

/// A figure with this many decimals and the decimal sign of a language.
pub fn number(value: f64, places: usize, language: Language) -> String {
    in_language(format!("{:.places$}", to_places(value, places as i32)), language)
}

/// A figure with all its decimals and the decimal sign of a language.
pub fn shortest(value: f64, language: Language) -> String {
    in_language(value.to_string(), language)
}

fn in_language(text: String, language: Language) -> String {
    text.replace('.', language.decimal_sign())
}

/// Volumes in mL, to 1 mm³.
pub fn ml(value: f64) -> f64 {
    to_places(value, 3)
}

/// Areas in mm² as cm², to 1 mm².
pub(crate) fn cm2(value_mm2: f64) -> f64 {
    to_places(value_mm2 / 100.0, 2)
}

/// Percentages, to 0.01 %.
pub fn percent(value: f64) -> f64 {
    to_places(value, 2)
}

/// Angles, to 0.01°.
pub(crate) fn degrees(value: f64) -> f64 {
    to_places(value, 2)
}

/// Curvatures, to 10⁻⁵ per mm.
pub(crate) fn per_mm(value: f64) -> f64 {
    to_places(value, 5)
}

/// Shares, ratios and coefficients of determination, to 10⁻⁶.
pub(crate) fn share(value: f64) -> f64 {
    to_places(value, 6)
}

/// Components of a unit vector, to 10⁻⁹: 1 µm at a distance of a kilometre.
pub(crate) fn unit(value: f64) -> f64 {
    to_places(value, 9)
}

/// The uncertainty of a length, from its standard error in mm: cm, rounded up to the next millimetre, so
/// that it is never shown as smaller than it is, and never as zero.
pub fn cm_margin(sd_mm: f64) -> f64 {
    up(MARGIN_SDS * sd_mm) / 10.0
}

/// Volumes in mL for people: whole numbers.
pub(crate) fn whole_ml(value_ml: f64) -> f64 {
    to_places(value_ml, 0)
}

/// The uncertainty of a volume, from its standard error: mL, rounded up.
pub fn ml_margin(sd_ml: f64) -> f64 {
    up(MARGIN_SDS * sd_ml)
}

/// A percentage or an area in cm² to a tenth as text.
pub fn tenths_words(value: f64, language: Language) -> String {
    number(value, 1, language)
}

/// The text of a rounded figure with the sign of a difference; no sign at zero.
pub fn signed(value: f64, words: &str) -> String {
    let is_zero = !words.contains(|digit: char| ('1'..='9').contains(&digit));
    let figure = words.trim_start_matches('-');
    match (is_zero, value < 0.0) {
        (true, _) => figure.to_owned(),
        (false, true) => format!("\u{2212}{figure}"),
        (false, false) => format!("+{figure}"),
    }
}

/// Rounds up to a whole number, at least 1. Tiny excesses from the record's rounding do not count.
fn up(value: f64) -> f64 {
    (value - 1e-9).ceil().max(1.0)
}

/// Rounds half away from zero; a negative zero becomes zero.
fn to_places(value: f64, places: i32) -> f64 {
    let scale = 10.0_f64.powi(places);
    (value * scale).round() / scale + 0.0
}

/// Whether a difference is larger than its uncertainty, both as shown; never without one.
pub(crate) fn exceeds(printed: f64, margin: Option<f64>) -> bool {
    margin.is_some_and(|margin| printed.abs() > margin)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_keep_the_digits_of_the_rule_and_the_comma_of_their_language() {
        let words = |mm| [Language::En, Language::De].map(|language| cm_words(mm, language));
        assert_eq!(words(178.45), ["17.8", "17,8"]);
        assert_eq!(words(178.5), ["17.9", "17,9"]);
        assert_eq!(words(-0.3), ["0.0", "0,0"]);
        assert_eq!(whole_ml(2.5), 3.0);
    }

    #[test]
    fn an_uncertainty_is_two_standard_errors_rounded_up_and_never_nothing() {
        assert_eq!([0.0, 0.1, 0.5, 0.501, 4.0].map(cm_margin), [0.1, 0.1, 0.1, 0.2, 0.8]);
        assert_eq!(ml_margin(7.6), 16.0);
    }

    #[test]
    fn a_difference_has_a_sign_unless_it_is_told_as_nothing() {
        let told = |mm: f64| signed(mm, &cm_words(mm, Language::En));
        assert_eq!([4.0, -4.0, 0.4, -0.4].map(told), ["+0.4", "\u{2212}0.4", "0.0", "0.0"]);
    }

    #[test]
    fn figures_are_rounded_half_away_from_zero_and_never_to_minus_zero() {
        assert_eq!(mm(178.4325), 178.433);
        assert_eq!(degrees(-9.125), -9.13);
        assert_eq!((cm(223.5), cm(223.499), cm(0.4)), (22.4, 22.3, 0.0));
        assert!(mm(-0.0001).is_sign_positive());
    }
}
