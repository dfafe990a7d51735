//! Orders: as a table, as JSON, as mappings say, and again.

#![allow(clippy::disallowed_methods, clippy::disallowed_types, clippy::panic, clippy::unwrap_used)]

mod again;
mod cases;
mod hostile;
mod laws;
mod page;
#[path = "../../../sizes/tests/sizes/placed.rs"]
mod placed;

use std::sync::LazyLock;

use gaiter_leg::{Level, Method, Side};
use gaiter_record::measure::amendment::{Amendment, Deed};
use gaiter_record::order::{Order, OrderRef};
use gaiter_record::{Acquired, AcquiredFrom, Patient, Record, Source, SourceKind};
use gaiter_sizes::Garment;
use support::recorded::export;
use support::records::record_of;

/// The patient of the record.
pub const ID: &str = "4711";

/// Girth, its standard error and height of a level of the right leg, mm; the left leg has 2 mm and 3 mm more.
const LEVELS: [(Level, f64, f64, f64); 4] = [
    (Level::B, 212.5, 0.4, 121.0),
    (Level::B1, 268.0, 0.5, 204.94),
    (Level::C, 371.25, 0.6, 331.05),
    (Level::D, 349.0, 0.5, 428.0),
];

/// What a person set: girth and height, or that a level cannot be measured.
fn amendment(leg: &str, measure: &str, set_mm: [Option<f64>; 2], reason: &str) -> Amendment {
    let [girth_mm, height_mm] = set_mm;
    Amendment {
        leg: leg.to_owned(),
        measure: measure.to_owned(),
        is: if girth_mm.is_some() { Deed::Measured } else { Deed::NotMeasurable },
        girth_mm,
        height_mm,
        length_mm: None,
        reason: reason.to_owned(),
        by: "Jörg Øster".to_owned(),
        at: "2026-11-20T10:00:00Z".parse().unwrap(),
    }
}

/// What the scanner measured of a body with round figures, of which the left leg lacks B1.
pub static SCANNED: LazyLock<Record> = LazyLock::new(|| {
    let mut record = record_of(&export("m_average_clean"), &Method::default()).1;
    record.findings.clear();
    record.scan.sha256 = "0123456789abcdef".repeat(4);
    record.station = Some("booth-1".to_owned());
    let sources = vec![Source { kind: SourceKind::Reader, confidence: None, request: None }];
    record.patient = Some(Patient { id: ID.to_owned(), sources });
    let at = "2026-11-19T23:30:00Z".parse().unwrap();
    let acquired = Acquired::new(at, AcquiredFrom::FileTime);
    record.acquired = Some(Acquired { utc_offset_min: Some(60), ..acquired });
    record.made_by.method.insert("posture".to_owned(), "both-legs".to_owned());
    for leg in &mut record.legs {
        let [more_girth_mm, more_height_mm] =
            if leg.side == Side::Left.word() { [2.0, 3.0] } else { [0.0, 0.0] };
        for (level, girth_mm, sd_mm, height_mm) in LEVELS {
            let known = leg.landmarks.get_mut(level.name());
            let found = known.unwrap_or_else(|| panic!("no {}", level.name()));
            found.girth_tape_mm = girth_mm + more_girth_mm;
            found.girth_sd_mm = Some(sd_mm);
            found.height_mm = height_mm + more_height_mm;
            found.height_sd_mm = Some(2.0);
            found.doubts.clear();
        }
    }
    let left = record.legs.iter_mut().find(|leg| leg.side == Side::Left.word()).unwrap();
    left.landmarks.remove("B1");
    record
});

/// The same with what a person set: a girth in the place of the scan's, one that the scan lacks, and one that
/// cannot be measured.
pub static RECORD: LazyLock<Record> = LazyLock::new(|| {
    let amendments = [
        amendment("right", "C", [Some(380.0), None], "=swollen; \"hard\""),
        amendment("left", "B1", [Some(270.0), Some(210.0)], "hem of a sock, of 4711"),
        amendment("left", "D", [None, None], "bandage"),
    ];
    SCANNED.amended(&amendments, true).unwrap()
});

fn garment() -> Garment {
    Garment::named("AD").unwrap()
}

/// The order of the record.
pub fn order() -> Order {
    let order_ref = OrderRef::new("A-1042", &RECORD).unwrap();
    Order::from_record(&RECORD, &garment(), Some(&order_ref), 1.0)
}
