//! Numbers as text, many at a time: a drawing or a CAD file has tens of thousands of them, and the
//! standard library's formatting takes several hundred instructions for each. The text is the same.

use std::fmt::Write;

/// Appends the number that `{value:?}` gives: with a decimal point or an exponent, in the fewest digits
/// that read back as `value`.
pub(crate) fn push_shortest(text: &mut String, value: f64) {
    let magnitude = value.abs();
    if magnitude < FAST.end && magnitude.trunc() == magnitude {
        text.push_str(if value.is_sign_negative() { "-" } else { "" });
        push_whole(text, magnitude as u64);
        text.push_str(".0");
    } else if FAST.contains(&magnitude) && value.to_bits().trailing_zeros() < TIE_ZEROS {
        text.push_str(zmij::Buffer::new().format_finite(value));
    } else {
        // Writing to memory never fails.
        let _ = write!(text, "{value:?}");
    }
}

/// The magnitudes that are written fast: below, the standard library writes an exponent; above,
/// [`TIE_ZEROS`] would not do. The coordinates of a body lie between.
const FAST: std::ops::Range<f64> = 1e-4..1_048_576.0;

/// A double may lie exactly between two decimals of the fewest digits. The standard library then takes
/// the larger one, and the fast way the even one. With k decimals such a double is an odd multiple of
/// 2⁻ᵏ⁻¹, and 10⁻ᵏ is not more than its last bit. Below 2²⁰ its fraction ends with at least 22 zeros.
const TIE_ZEROS: u32 = 20;

/// Appends the number that `{value:.places$}` gives: rounded from its exact value, and a tie to the
/// even digit.
pub fn push_fixed(text: &mut String, value: f64, places: usize) {
    let Some(units) = units(value, places) else {
        let _ = write!(text, "{value:.places$}");
        return;
    };
    if value.is_sign_negative() {
        text.push('-');
    }
    let scale = POWERS_OF_TEN[places];
    push_whole(text, units / scale);
    if places > 0 {
        text.push('.');
        push_padded(text, units % scale, places);
    }
}

/// Appends a number of tenths as a decimal, without a decimal point if it is whole.
pub fn push_tenths(text: &mut String, tenths: i64) {
    if tenths < 0 {
        text.push('-');
    }
    let (whole, rest) = (tenths.unsigned_abs() / 10, tenths.unsigned_abs() % 10);
    push_whole(text, whole);
    if rest != 0 {
        text.push('.');
        push_digit(text, rest);
    }
}

/// Appends a whole number. Those of drawings have few digits, which need no detour.
pub(crate) fn push_whole(text: &mut String, number: u64) {
    if number >= 1000 {
        return push_padded(text, number, number.ilog10() as usize + 1);
    }
    if number >= 100 {
        push_digit(text, number / 100);
    }
    if number >= 10 {
        push_digit(text, number / 10);
    }
    push_digit(text, number);
}

/// Powers of ten up to the largest number of places that is written fast.
const POWERS_OF_TEN: [u64; 10] =
    [1, 10, 100, 1_000, 10_000, 100_000, 1_000_000, 10_000_000, 100_000_000, 1_000_000_000];

/// Bits of the fraction of a double, without the leading one.
const FRACTION_BITS: u32 = 52;

/// Bias of the exponent of a double whose fraction is taken as a whole number.
const EXPONENT_BIAS: i32 = 1023 + FRACTION_BITS as i32;

/// A shift by this many bits leaves less than half a unit of any number of places: 53 bits of the
/// fraction and 30 of the power of ten.
const SHIFT_MAX: u32 = 53 + 30 + 1;

/// The magnitude in units of the last place, rounded; `None` if the fast way does not know it. The
/// product with the power of ten is exact, so that a tie is one.
fn units(value: f64, places: usize) -> Option<u64> {
    let scale = *POWERS_OF_TEN.get(places)?;
    let bits = value.to_bits();
    let biased = (bits >> FRACTION_BITS) as i32 & 0x7ff;
    let shift = EXPONENT_BIAS - biased;
    if biased == 0 {
        // Zero, and numbers far too small to be seen in any place.
        return Some(0);
    }
    // Larger numbers have no fraction to round, and the largest are not finite.
    let shift = u32::try_from(shift).ok().filter(|shift| *shift > 0)?;
    if shift > SHIFT_MAX {
        return Some(0);
    }
    let fraction = bits & ((1 << FRACTION_BITS) - 1) | 1 << FRACTION_BITS;
    let product = u128::from(fraction) * u128::from(scale);
    let (whole, rest) = (product >> shift, product & ((1 << shift) - 1));
    let half = 1 << (shift - 1);
    let is_up = rest > half || rest == half && whole & 1 == 1;
    u64::try_from(whole + u128::from(is_up)).ok()
}

/// Appends a number with this many digits, 0 at the front included.
fn push_padded(text: &mut String, mut number: u64, digits: usize) {
    let mut reversed = [0_u8; 20];
    let used = &mut reversed[..digits.min(20)];
    for digit in used.iter_mut().rev() {
        *digit = b'0' + (number % 10) as u8;
        number /= 10;
    }
    text.push_str(std::str::from_utf8(used).unwrap_or_default());
}

/// Appends the last digit of a number.
fn push_digit(text: &mut String, number: u64) {
    text.push(char::from(b'0' + (number % 10) as u8));
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn shortest(value: f64) -> String {
        let mut text = String::new();
        push_shortest(&mut text, value);
        text
    }

    fn fixed(value: f64, places: usize) -> String {
        let mut text = String::new();
        push_fixed(&mut text, value, places);
        text
    }

    /// Values at the borders of both ways to write a number, with their neighbours.
    fn hard() -> Vec<f64> {
        let powers = (-330..309).map(|power| format!("1e{power}").parse::<f64>().unwrap());
        let halves = (-70..70).map(|power| 2.0_f64.powi(power));
        // 0.5, 1.5, 2.5, … and the same in every place are ties, or are next to one.
        let ties = (0..2000).map(|odd| f64::from(2 * odd + 1) / 2.0);
        let ties = ties.flat_map(|tie| (0..8).map(move |place| tie / 10.0_f64.powi(place)));
        let eighths = (0..2000).map(|count| f64::from(count) / 1024.0);
        // Doubles between two decimals of the fewest digits.
        let between = (0..53).flat_map(|bit| (-14..50).map(move |power| (bit, power)));
        let between = between.map(|(bit, power)| 2.0_f64.powi(power) * (1.0 + 0.5_f64.powi(bit)));
        let ends = [0.0, f64::MIN_POSITIVE, f64::MAX, 5e-324, 9_007_199_254_740_991.5];
        let all = powers.chain(halves).chain(ties).chain(eighths).chain(between).chain(ends);
        all.flat_map(|value| [value, value.next_up(), value.next_down()])
            .flat_map(|value| [value, -value])
            .collect()
    }

    #[test]
    fn hard_numbers_are_written_as_the_standard_library_does() {
        for value in hard() {
            assert_eq!(shortest(value), format!("{value:?}"));
            for places in 0..12 {
                assert_eq!(fixed(value, places), format!("{value:.places$}"), "{value:?} {places}");
            }
        }
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!(
                (shortest(value), fixed(value, 2)),
                (format!("{value:?}"), format!("{value:.2}"))
            );
        }
        assert_eq!(
            [0.125, 0.375, -0.125, -0.0].map(|value| fixed(value, 2)),
            ["0.12", "0.38", "-0.12", "-0.00"]
        );
    }

    #[test]
    fn whole_numbers_and_tenths_have_no_digit_too_many() {
        let whole = |number: u64| {
            let mut text = String::new();
            push_whole(&mut text, number);
            text
        };
        for power in 0..20 {
            for number in [10_u64.pow(power) - 1, 10_u64.pow(power), u64::MAX >> power] {
                assert_eq!(whole(number), number.to_string());
            }
        }
        let tenths = |number: i64| {
            let mut text = String::new();
            push_tenths(&mut text, number);
            text
        };
        let written = [0, 7, 10, -1, -10, -305, i64::MIN].map(tenths);
        assert_eq!(written, ["0", "0.7", "1", "-0.1", "-1", "-30.5", "-922337203685477580.8"]);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn any_bits_are_written_as_the_standard_library_does(bits: u64, places in 0_usize..11) {
            let value = f64::from_bits(bits);
            prop_assert_eq!(shortest(value), format!("{value:?}"));
            prop_assert_eq!(fixed(value, places), format!("{value:.places$}"));
        }

        #[test]
        fn lengths_are_written_as_the_standard_library_does(
            value in -3000.0..3000.0_f64, count in -3_000_000_i32..3_000_000, places in 0_usize..11,
        ) {
            for value in [value, f64::from(count) / 2000.0, f64::from(count) / 1024.0] {
                prop_assert_eq!(shortest(value), format!("{value:?}"));
                prop_assert_eq!(fixed(value, places), format!("{value:.places$}"));
            }
        }
    }
}
