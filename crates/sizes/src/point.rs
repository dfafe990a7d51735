//! The points of an order form.

use std::fmt;

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use gaiter_leg::Level;

/// A measure that an order form or a size table asks for; all in mm within the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Point {
    /// Girth at a level: `cB`.
    Girth(Level),
    /// Length from the floor to a level: `lD`.
    Length(Level),
    /// Length along the leg from a level to a higher one: `lBD`.
    Between(Level, Level),
    /// Length of the foot: `foot`.
    Foot,
    /// Length of the inside of the leg: `lK`.
    InsideLeg,
    /// A point of tights above the thigh, which no scan of the legs gives.
    Beyond(Beyond),
}

gaiter_leg::word_enum! {
    /// The points above the thigh.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
    pub enum Beyond {
        /// Girth of the hip: `cH`.
        HipGirth => "cH",
        /// Girth of the waist: `cT`.
        WaistGirth => "cT",
        /// Length to the hip: `lH`.
        HipLength => "lH",
        /// Length to the waist: `lT`.
        WaistLength => "lT",
    }
}

/// The name of the length of a foot.
const FOOT: &str = "foot";

/// The name of the length of the inside of a leg.
const INSIDE_LEG: &str = "lK";

impl Point {
    /// The point of a name such as `cB1`, `lD`, `lBD`, `foot` or `lK`.
    pub fn named(name: &str) -> Option<Point> {
        match name {
            FOOT => return Some(Point::Foot),
            INSIDE_LEG => return Some(Point::InsideLeg),
            _ => {}
        }
        if let Some(beyond) = Beyond::of_word(name) {
            return Some(Point::Beyond(beyond));
        }
        if let Some(level) = name.strip_prefix('c') {
            return Level::of_word(level).map(Point::Girth);
        }
        let levels = name.strip_prefix('l')?;
        if let Some(level) = Level::of_word(levels) {
            return has_height(level).then_some(Point::Length(level));
        }
        let (low, high) = Level::ALL
            .into_iter()
            .find_map(|low| Some((low, Level::of_word(levels.strip_prefix(low.name())?)?)))?;
        (has_height(low) && low < high).then_some(Point::Between(low, high))
    }

    /// Whether it is a girth, which a scanner that is off measures wrong by a common amount.
    pub(crate) fn is_girth(self) -> bool {
        matches!(
            self,
            Point::Girth(_) | Point::Beyond(Beyond::HipGirth) | Point::Beyond(Beyond::WaistGirth)
        )
    }

    /// The levels it is measured at; empty for a length of foot or inside leg.
    pub fn levels(self) -> impl Iterator<Item = Level> {
        let levels = match self {
            Point::Girth(level) | Point::Length(level) => [Some(level), None],
            Point::Between(low, high) => [Some(low), Some(high)],
            Point::Foot | Point::InsideLeg | Point::Beyond(_) => [None, None],
        };
        levels.into_iter().flatten()
    }
}

/// On the foot the tape is not level, so there is no height.
fn has_height(level: Level) -> bool {
    level >= Level::B
}

impl fmt::Display for Point {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Point::Girth(level) => write!(f, "c{}", level.name()),
            Point::Length(level) => write!(f, "l{}", level.name()),
            Point::Between(low, high) => write!(f, "l{}{}", low.name(), high.name()),
            Point::Foot => f.write_str(FOOT),
            Point::InsideLeg => f.write_str(INSIDE_LEG),
            Point::Beyond(beyond) => f.write_str(beyond.word()),
        }
    }
}

impl Serialize for Point {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for Point {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Point, D::Error> {
        let name = String::deserialize(from)?;
        Point::named(&name).ok_or_else(|| D::Error::custom(format_args!("{name:?} names no point")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_stands_for_one_point_and_a_point_for_its_name() {
        for name in [
            "cA", "cY", "cB", "cB1", "cC", "cG", "lB", "lB1", "lG", "lBD", "lBB1", "lB1C", "lBG",
            "foot", "lK", "cH", "cT", "lH", "lT",
        ] {
            assert_eq!(Point::named(name).map(|point| point.to_string()).as_deref(), Some(name));
        }
        assert_eq!(Point::named("lB1D"), Some(Point::Between(Level::B1, Level::D)));
    }

    #[test]
    fn what_no_form_has_is_no_point() {
        for name in ["", "c", "l", "B", "cX", "cb", "lA", "lY", "lDB", "lBB", "lAB", "cBD", "girth"]
        {
            assert_eq!(Point::named(name), None, "{name}");
        }
    }
}
