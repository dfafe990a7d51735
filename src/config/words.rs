//! The words for choices, shared by the configuration and the command line.

use crate::leg::method::{Axis, AxisFit, FacingChoice, SectionFit, Unit, UnitChoice, Up};

/// The words of one choice and what each means, in the order they are shown.
pub type Words<T> = &'static [(&'static str, T)];

/// `scanner.unit`, `--unit`
pub const UNITS: Words<UnitChoice> = &[
    ("auto", UnitChoice::Auto),
    ("mm", UnitChoice::Declared(Unit::Mm)),
    ("cm", UnitChoice::Declared(Unit::Cm)),
    ("m", UnitChoice::Declared(Unit::M)),
    ("in", UnitChoice::Declared(Unit::In)),
];

/// `scanner.up`, `--up`
pub const UPS: Words<Up> = &[("y", Up::Y), ("z", Up::Z), ("x", Up::X)];

/// `scanner.facing`, `--facing`
pub const FACINGS: Words<FacingChoice> = &[
    ("auto", FacingChoice::Auto),
    ("+x", FacingChoice::Declared(Axis::PlusX)),
    ("-x", FacingChoice::Declared(Axis::MinusX)),
    ("+y", FacingChoice::Declared(Axis::PlusY)),
    ("-y", FacingChoice::Declared(Axis::MinusY)),
    ("+z", FacingChoice::Declared(Axis::PlusZ)),
    ("-z", FacingChoice::Declared(Axis::MinusZ)),
];

/// `method.fit`
pub const FITS: Words<SectionFit> =
    &[("skin", SectionFit::Skin), ("periodic", SectionFit::Periodic), ("paper", SectionFit::Paper)];

/// `method.axis`
pub const AXES: Words<AxisFit> =
    &[("centroids", AxisFit::Centroids), ("principal", AxisFit::Principal)];

/// What a word means; `None` for a word that is none of these.
pub fn meaning<T: Copy>(words: Words<T>, word: &str) -> Option<T> {
    words.iter().find(|(known, _)| *known == word).map(|(_, value)| *value)
}

/// Whether the toes are said to point straight up or down, which no standing body does.
pub fn faces_up_or_down(up: Up, facing: FacingChoice) -> bool {
    let FacingChoice::Declared(axis) = facing else { return false };
    match axis {
        Axis::PlusX | Axis::MinusX => up == Up::X,
        Axis::PlusY | Axis::MinusY => up == Up::Y,
        Axis::PlusZ | Axis::MinusZ => up == Up::Z,
    }
}
