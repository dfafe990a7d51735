//! Check digits of patients' ids: they find a typing or reading error before it names another patient.

/// How ids are checked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CheckDigit {
    /// Ids have no check digit.
    None,
    /// The last digit follows Luhn's rule (ISO/IEC 7812-1, annex B): finds every single wrong digit and
    /// every exchange of neighbours except 09 and 90.
    Luhn,
    /// The last character follows ISO/IEC 7064, MOD 11-2, as in ORCID: 0 to 9 or X; always finds both.
    Mod11Dash2,
    /// The last two digits follow ISO/IEC 7064, MOD 97-10, as in IBAN: finds nearly all errors.
    Mod97Dash10,
}

impl CheckDigit {
    /// Whether an id matches its own check digit. Only its digits count, and a final X if the rule has
    /// one: letters before them, such as a clinic's prefix, are not part of the sum.
    pub fn holds(self, id: &str) -> bool {
        match self {
            CheckDigit::None => true,
            CheckDigit::Luhn => digits(id).is_some_and(|digits| luhn(&digits)),
            CheckDigit::Mod11Dash2 => {
                let (body, last) = match id.strip_suffix('X') {
                    Some(body) => (digits(body), 10),
                    None => {
                        let mut all = digits(id);
                        let last = all.as_mut().and_then(Vec::pop).unwrap_or(0);
                        (all, last)
                    }
                };
                body.is_some_and(|body| mod_11_2(&body, last))
            }
            CheckDigit::Mod97Dash10 => digits(id).is_some_and(|digits| mod_97_10(&digits)),
        }
    }
}

/// The digits of an id after the letters it may begin with; `None` if it contains anything else.
fn digits(id: &str) -> Option<Vec<u32>> {
    let id = id.trim_start_matches(|c: char| c.is_ascii_alphabetic());
    id.chars().map(|c| c.to_digit(10)).collect()
}

fn luhn(digits: &[u32]) -> bool {
    let doubled = |(place, digit): (usize, &u32)| match place % 2 {
        0 => *digit,
        _ => digit * 2 / 10 + digit * 2 % 10,
    };
    digits.len() > 1 && digits.iter().rev().enumerate().map(doubled).sum::<u32>() % 10 == 0
}

fn mod_11_2(body: &[u32], last: u32) -> bool {
    let sum = body.iter().fold(0, |sum, digit| (sum + digit) * 2 % 11);
    !body.is_empty() && (sum + last) % 11 == 1
}

fn mod_97_10(digits: &[u32]) -> bool {
    digits.len() > 2 && digits.iter().fold(0, |rest, digit| (rest * 10 + digit) % 97) == 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_examples_hold_and_their_neighbours_do_not() {
        // Wikipedia's example of Luhn's rule; the example ORCID of its own documentation; 794 with
        // its check digits, from ISO/IEC 7064.
        for (rule, id) in [
            (CheckDigit::Luhn, "17893729974"),
            (CheckDigit::Luhn, "P17893729974"),
            (CheckDigit::Mod11Dash2, "0000000218250097"),
            (CheckDigit::Mod11Dash2, "000000021694233X"),
            (CheckDigit::Mod97Dash10, "79444"),
        ] {
            assert!(rule.holds(id), "{rule:?} {id}");
        }
    }

    #[test]
    fn every_single_wrong_digit_is_found() {
        for (rule, id) in [
            (CheckDigit::Luhn, "17893729974"),
            (CheckDigit::Mod11Dash2, "0000000218250097"),
            (CheckDigit::Mod97Dash10, "79444"),
        ] {
            for (place, right) in id.char_indices() {
                for wrong in ('0'..='9').filter(|digit| *digit != right) {
                    let mut text = id.to_owned();
                    text.replace_range(place..=place, &wrong.to_string());
                    assert!(!rule.holds(&text), "{rule:?} {text}");
                }
            }
        }
    }

    #[test]
    fn what_has_no_digits_or_something_between_them_does_not_hold() {
        for id in ["", "P", "4", "47-11", "4711P"] {
            for rule in [CheckDigit::Luhn, CheckDigit::Mod11Dash2, CheckDigit::Mod97Dash10] {
                assert!(!rule.holds(id), "{rule:?} {id:?}");
            }
            assert!(CheckDigit::None.holds(id));
        }
    }
}
