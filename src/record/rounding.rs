//! The one rounding rule: what a figure is worth, decimal places by its kind. Everything that is
//! printed or stored goes through here, so that no two places show different last digits.

use super::Language;

/// Lengths, to 1 µm.
pub fn mm(value: f64) -> f64 {
    to_places(value, 3)
}

/// Lengths in mm as cm, to 1 mm: what a tape shows, for practice software.
pub fn cm(value_mm: f64) -> f64 {
    to_places(value_mm / 10.0, 1)
}

/// Lengths in mm as people read them: cm with one decimal, and the decimal sign of their language.
pub fn cm_words(value_mm: f64, language: Language) -> String {
    number(cm(value_mm), 1, language)
}

/// A figure with so many decimals, and the decimal sign of a language.
pub fn number(value: f64, places: usize, language: Language) -> String {
    let text = format!("{:.places$}", to_places(value, places as i32));
    match language {
        Language::En => text,
        Language::De => text.replace('.', ","),
    }
}

/// Volumes in mL, to 1 mm³.
pub fn ml(value: f64) -> f64 {
    to_places(value, 3)
}

/// Areas in mm² as cm², to 1 mm².
pub fn cm2(value_mm2: f64) -> f64 {
    to_places(value_mm2 / 100.0, 2)
}

/// Percentages, to 0.01 %.
pub fn percent(value: f64) -> f64 {
    to_places(value, 2)
}

/// Angles, to 0.01°.
pub fn degrees(value: f64) -> f64 {
    to_places(value, 2)
}

/// Curvatures, to 10⁻⁵ per mm.
pub fn per_mm(value: f64) -> f64 {
    to_places(value, 5)
}

/// Shares, ratios and coefficients of determination, to 10⁻⁶.
pub fn share(value: f64) -> f64 {
    to_places(value, 6)
}

/// Parts of a unit vector, to 10⁻⁹: 1 µm at a kilometre.
pub fn unit(value: f64) -> f64 {
    to_places(value, 9)
}

/// Half away from zero; a negative zero becomes zero.
fn to_places(value: f64, places: i32) -> f64 {
    let scale = 10.0_f64.powi(places);
    (value * scale).round() / scale + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_rounded_half_away_from_zero_and_never_to_minus_zero() {
        assert_eq!(mm(178.4325), 178.433);
        assert_eq!(degrees(-9.125), -9.13);
        assert_eq!((cm(223.5), cm(223.499), cm(0.4)), (22.4, 22.3, 0.0));
        assert!(mm(-0.0001).is_sign_positive());
    }
}
