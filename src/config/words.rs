//! The words for choices, shared by the configuration and the command line.

use std::ops::Range;

use gaiter_cad::{FileFormat, FileKind, Schema, Shape};
use gaiter_flow::confinement::Confine;
use gaiter_flow::page::IdsShown;
use gaiter_flow::patient::check_digit::CheckDigit;
use gaiter_language::Language;
use gaiter_leg::Side;
use gaiter_leg::method::{
    Axis, AxisFit, FacingChoice, Posture, Scope, Tape, Unit, UnitChoice, Up, VolumeBy, Winding,
};
use gaiter_record::report::Paper;
use gaiter_visits::Affected;
use gaiter_visits::threshold::Limited;

use crate::store::Access;

/// What happens to an export for which nobody pressed the button or named a patient.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WithoutTrigger {
    /// It is processed by its file name.
    Process,
    /// It is held until the operator decides.
    Hold,
}

/// The words of one choice and their meanings, in the order they are shown.
pub type Words<T> = &'static [(&'static str, T)];

/// `capture.without_trigger`
pub const WITHOUT_TRIGGER: Words<WithoutTrigger> =
    &[("process", WithoutTrigger::Process), ("hold", WithoutTrigger::Hold)];

/// `measure.confine`
pub const CONFINES: Words<Confine> =
    &[("where-possible", Confine::WherePossible), ("required", Confine::Required)];

/// `store.folder.mode`
pub const ACCESSES: Words<Access> = &[("private", Access::Private), ("group", Access::Group)];

/// `report.language`, `--language`
pub const LANGUAGES: Words<Language> =
    &[(Language::En.tag(), Language::En), (Language::De.tag(), Language::De)];

/// `report.paper` and `--paper`
pub const PAPERS: Words<Paper> =
    &[(Paper::A4.name(), Paper::A4), (Paper::Letter.name(), Paper::Letter)];

/// `page.patient_ids`
pub const IDS_SHOWN: Words<IdsShown> = &[
    ("nobody", IdsShown::Nobody),
    ("operator", IdsShown::Operator),
    ("everyone", IdsShown::Everyone),
];

/// `patient.check_digit`
pub const CHECK_DIGITS: Words<CheckDigit> = &[
    ("none", CheckDigit::None),
    ("luhn", CheckDigit::Luhn),
    ("mod11-2", CheckDigit::Mod11Dash2),
    ("mod97-10", CheckDigit::Mod97Dash10),
];

/// `scanner.scope`, `--scope`
pub const SCOPES: Words<Scope> = &[
    ("body", Scope::Body),
    ("left-leg", Scope::Leg(Side::Left)),
    ("right-leg", Scope::Leg(Side::Right)),
];

/// `scanner.unit`, `--unit`
pub const UNITS: Words<UnitChoice> = &[
    ("auto", UnitChoice::Auto),
    ("mm", UnitChoice::Declared(Unit::Mm)),
    ("cm", UnitChoice::Declared(Unit::Cm)),
    ("m", UnitChoice::Declared(Unit::M)),
    ("in", UnitChoice::Declared(Unit::In)),
];

/// `scanner.up`, `--up`
pub const UPS: Words<Up> = &Up::WORDS;

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

/// `scanner.winding`, `--winding`
pub const WINDINGS: Words<Winding> = &Winding::WORDS;

/// `scanner.posture`
pub const POSTURES: Words<Posture> = &Posture::WORDS;

/// `--affected`
pub const AFFECTED: Words<Affected> = &Affected::WORDS;

/// `visits.thresholds.limb`: thresholds for arms are none for legs.
pub const LIMBS: Words<()> = &[("leg", ())];

/// `visits.thresholds.of`
pub const LIMITED: Words<Limited> = &Limited::WORDS;

/// `method.volume`
pub const VOLUMES: Words<VolumeBy> = &VolumeBy::WORDS;

/// `method.tape`
pub const TAPES: Words<Tape> = &[
    ("shank", Tape::Shank),
    ("leg", Tape::Leg(AxisFit::Centroids)),
    ("horizontal", Tape::Horizontal),
];

const fn tube(format: FileFormat) -> FileKind {
    FileKind { format, shape: Shape::Tube }
}

const fn solid(format: FileFormat) -> FileKind {
    FileKind { format, shape: Shape::Solid }
}

/// `output.files`, `--files`
pub const FILES: Words<FileKind> = &[
    ("step", tube(FileFormat::Step(Schema::Ap214))),
    ("step-solid", solid(FileFormat::Step(Schema::Ap214))),
    ("step-ap242", tube(FileFormat::Step(Schema::Ap242))),
    ("step-ap242-solid", solid(FileFormat::Step(Schema::Ap242))),
    ("iges", tube(FileFormat::Iges)),
    ("iges-solid", solid(FileFormat::Iges)),
    ("stl", tube(FileFormat::Stl)),
    ("stl-solid", solid(FileFormat::Stl)),
    ("obj", tube(FileFormat::Obj)),
    ("obj-solid", solid(FileFormat::Obj)),
    ("glb", tube(FileFormat::Glb)),
    ("glb-solid", solid(FileFormat::Glb)),
];

/// What a word means; `None` for an unknown word.
pub fn meaning<T: Copy>(words: Words<T>, word: &str) -> Option<T> {
    words.iter().find(|(known, _)| *known == word).map(|(_, value)| *value)
}

/// Whether the declared facing is straight up or down, which no standing body has.
pub fn faces_up_or_down(up: Up, facing: FacingChoice) -> bool {
    let FacingChoice::Declared(axis) = facing else { return false };
    match axis {
        Axis::PlusX | Axis::MinusX => up == Up::X,
        Axis::PlusY | Axis::MinusY => up == Up::Y,
        Axis::PlusZ | Axis::MinusZ => up == Up::Z,
    }
}

/// Heights at which a girth can be requested, cm: above the floor and below every hip.
pub const HEIGHTS_CM: Range<f64> = 0.0..200.0;

/// Parses a height above the floor in cm, such as `10` or `10.5`, into mm; `None` for anything else,
/// including 0 and heights that no leg reaches.
pub fn height_mm(text: &str) -> Option<f64> {
    let cm = text.trim().parse::<f64>().ok()?;
    (cm > HEIGHTS_CM.start && cm < HEIGHTS_CM.end).then_some(cm * 10.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_facing_has_the_same_word_in_records_as_here() {
        for (word, facing) in FACINGS {
            assert_eq!(facing.word(), *word);
        }
    }
}
