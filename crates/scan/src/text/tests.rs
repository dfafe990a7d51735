//! Numbers as exporters write them.

use super::*;

fn numbers(words: &[&str]) -> Result<Vec<f64>, ScanFault> {
    let mut decimals = Decimals::default();
    let numbered = words.iter().zip(1..);
    numbered.map(|(word, line)| decimals.number(word.as_bytes(), line)).collect()
}

#[test]
fn points_and_commas_are_both_decimal_signs() {
    assert_eq!(numbers(&["1.5", "-2", "3e2", "+.5"]).unwrap(), [1.5, -2.0, 300.0, 0.5]);
    assert_eq!(numbers(&["1,5", "-2", "3,25e2", "-0,5"]).unwrap(), [1.5, -2.0, 325.0, -0.5]);
}

#[test]
fn a_file_that_has_both_is_refused_at_the_second_of_them() {
    for words in [["0", "1,5", "7", "2.5"], ["0", "1.5", "7", "2,5"]] {
        let said = numbers(&words).unwrap_err().to_string();
        assert!(said.starts_with("line 4: ") && said.contains("line 2 has the other"), "{said}");
    }
}

#[test]
fn a_comma_that_is_no_decimal_sign_is_refused() {
    for word in ["1,234.5", "1,234,5", ",5", "5,", "-,5", ","] {
        assert!(matches!(numbers(&[word]), Err(ScanFault::Malformed { .. })), "{word}");
    }
}

#[test]
fn what_stands_for_no_number_is_not_finite() {
    for word in ["nan", "-NaN", "inf", "-Infinity", "1e999", "1.#QNAN", "-1.#IND00", "nan(0x1)"] {
        let place = SourcePosition::Line(1);
        let fault = ScanFault::NotFinite { place, found: word.to_owned() };
        assert_eq!(numbers(&[word]), Err(fault), "{word}");
    }
    for word in ["", "x", "1d5", "0x10", "1..5", "--1"] {
        assert!(matches!(numbers(&[word]), Err(ScanFault::Malformed { .. })), "{word}");
    }
}

#[test]
fn a_very_long_number_with_a_comma_is_refused_and_not_copied() {
    assert!(numbers(&[&format!("0,{}", "1".repeat(10_000))]).is_err());
}
