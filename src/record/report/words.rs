//! The words of the report that do not belong to a single finding.

pub(super) mod findings;
mod german;
mod level_findings;
mod scan_findings;
pub(super) mod statements;
mod told;

use crate::leg::{Level, Side};
use crate::record::{AcquiredFrom, Language, SourceKind};

/// The name of a leg.
pub(super) fn leg(side: Side, language: Language) -> &'static str {
    match side {
        Side::Left => language.pick("left leg", "linkes Bein"),
        Side::Right => language.pick("right leg", "rechtes Bein"),
    }
}

/// The name of a leg as a heading.
pub(super) fn leg_heading(side: Side, language: Language) -> &'static str {
    match side {
        Side::Left => language.pick("Left leg", "Linkes Bein"),
        Side::Right => language.pick("Right leg", "Rechtes Bein"),
    }
}

/// Where a level is on the leg, in words.
pub(super) fn place(level: Level, language: Language) -> &'static str {
    match level {
        Level::A => language.pick("forefoot, around the toe joints", "Vorfuß, um die Zehengelenke"),
        Level::Y => language.pick("over heel and instep", "über Ferse und Rist"),
        Level::B => language.pick("ankle, smallest girth", "Fessel, kleinster Umfang"),
        Level::B1 => language.pick("Achilles tendon to calf", "Achillessehne zur Wade"),
        Level::C => language.pick("calf, largest girth", "Wade, größter Umfang"),
        Level::D => language.pick("below the knee", "unter dem Knie"),
        Level::E => language.pick("knee, middle of the kneecap", "Knie, Mitte der Kniescheibe"),
        Level::F => language.pick("middle of the thigh", "Mitte des Oberschenkels"),
        Level::G => language.pick("root of the thigh", "oben am Oberschenkel"),
    }
}

/// The source that named the patient, in words.
pub(super) fn source(kind: SourceKind, language: Language) -> &'static str {
    match kind {
        SourceKind::FileName => language.pick("the scan's file name", "Dateiname des Scans"),
        SourceKind::Sidecar => language
            .pick("the scanner's own measures beside the scan", "Messwertdatei des Scanners"),
        SourceKind::Operator => {
            language.pick("a person at the station", "eine Person an der Station")
        }
        SourceKind::Reader => language
            .pick("a card or barcode read at the booth", "Karte oder Strichcode an der Kabine"),
        SourceKind::Order => {
            language.pick("an order of the practice software", "Auftrag der Praxissoftware")
        }
        SourceKind::Record => language.pick("the record in its store", "der abgelegte Datensatz"),
    }
}

/// The source of a time of acquisition, in words.
pub(super) fn time_from(from: AcquiredFrom, language: Language) -> &'static str {
    match from {
        AcquiredFrom::Press => language.pick("the button was pressed", "Druck auf den Knopf"),
        AcquiredFrom::FileTime => {
            language.pick("time of the scanner's file", "Zeitstempel der Scannerdatei")
        }
        AcquiredFrom::Unknown => language.pick("no reliable source", "ohne verlässliche Quelle"),
    }
}
