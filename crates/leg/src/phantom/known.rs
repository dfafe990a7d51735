//! The girths that are known of a phantom.

use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// Plausible girths of a phantom, mm: from a child's ankle to a large thigh.
const GIRTH_MM: [f64; 2] = [100.0, 1200.0];

/// Heights at which a girth can be known, mm. Nearer to the floor the scanner sees little.
const HEIGHT_MM: [f64; 2] = [20.0, 1800.0];

/// Notation is in centimetres, as on a tape.
const MM_PER_CM: f64 = 10.0;

/// A body of known girths.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Phantom {
    /// A cylinder: the same girth at every height, mm.
    Cylinder {
        /// The girth, mm.
        girth_mm: f64,
    },
    /// A cone or another shape: girths at heights, at least one, lowest first.
    AtHeights(Vec<KnownGirth>),
}

/// A known girth.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct KnownGirth {
    /// Height above the phantom's lower end, along its axis, mm.
    pub height_mm: f64,
    /// Circumference, mm.
    pub girth_mm: f64,
}

/// Why a text is not a list of known girths.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum PhantomTextFault {
    /// Not a number where one is needed.
    #[error("\"{0}\" is not a number of centimetres")]
    NotANumber(String),
    /// A girth that no phantom has.
    #[error("a girth of {0} cm is not between 10 and 120 cm")]
    Girth(String),
    /// A height at which no girth is measured.
    #[error("a height of {0} cm is not between 2 and 180 cm")]
    Height(String),
    /// Several girths, one of them without its height.
    #[error("\"{0}\" has no height")]
    NoHeight(String),
    /// Heights that do not ascend.
    #[error("heights must ascend: {0} cm does not")]
    Order(String),
}

impl FromStr for Phantom {
    type Err = PhantomTextFault;

    /// Reads "35.2" for a cylinder, or "10:35.2, 30:38.1" for girths at heights, in centimetres.
    fn from_str(text: &str) -> Result<Phantom, PhantomTextFault> {
        let entries: Vec<&str> = text.split(',').map(str::trim).collect();
        if let [only] = entries.as_slice()
            && !only.contains(':')
        {
            return Ok(Phantom::Cylinder { girth_mm: girth_mm(only)? });
        }
        let mut girths: Vec<KnownGirth> = Vec::new();
        for entry in entries {
            let no_height = || PhantomTextFault::NoHeight(entry.to_owned());
            let (height, girth) = entry.split_once(':').ok_or_else(no_height)?;
            let height_mm = number_mm(height)?;
            if !(HEIGHT_MM[0]..=HEIGHT_MM[1]).contains(&height_mm) {
                return Err(PhantomTextFault::Height(height.trim().to_owned()));
            }
            if girths.last().is_some_and(|last| last.height_mm >= height_mm) {
                return Err(PhantomTextFault::Order(height.trim().to_owned()));
            }
            girths.push(KnownGirth { height_mm, girth_mm: girth_mm(girth)? });
        }
        Ok(Phantom::AtHeights(girths))
    }
}

fn girth_mm(text: &str) -> Result<f64, PhantomTextFault> {
    let girth_mm = number_mm(text)?;
    if !(GIRTH_MM[0]..=GIRTH_MM[1]).contains(&girth_mm) {
        return Err(PhantomTextFault::Girth(text.trim().to_owned()));
    }
    Ok(girth_mm)
}

fn number_mm(text: &str) -> Result<f64, PhantomTextFault> {
    let text = text.trim();
    let number: f64 = text.parse().map_err(|_| PhantomTextFault::NotANumber(text.to_owned()))?;
    Ok(number * MM_PER_CM)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cylinder_needs_one_girth_and_other_bodies_their_heights() {
        assert_eq!("35.2".parse(), Ok(Phantom::Cylinder { girth_mm: 352.0 }));
        let at = |height_mm, girth_mm| KnownGirth { height_mm, girth_mm };
        let both = Phantom::AtHeights(vec![at(100.0, 352.0), at(305.0, 381.0)]);
        assert_eq!("10:35.2, 30.5:38.1".parse(), Ok(both));
    }

    #[test]
    fn what_is_wrong_is_named() {
        use PhantomTextFault::{Girth, Height, NoHeight, NotANumber, Order};
        for (text, fault) in [
            ("", NotANumber(String::new())),
            ("35,2", NoHeight("35".into())),
            ("10:x", NotANumber("x".into())),
            ("352", Girth("352".into())),
            ("NaN", Girth("NaN".into())),
            ("1:35.2", Height("1".into())),
            ("30:35.2, 30:38", Order("30".into())),
        ] {
            assert_eq!(text.parse::<Phantom>(), Err(fault), "{text}");
        }
    }
}
