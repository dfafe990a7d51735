//! What marks objects as another patient's: a key object selection with the title that archives of images know for it
//! (IHE Imaging Object Change Management). Nothing is deleted by it.

use dicom_dictionary_std::tags;
use gaiter_record::report::grouped;
use jiff::Timestamp;
use jiff::tz::TimeZone;

use super::content::{Concept, DCM, Item, Relation, reference};
use super::dataset::Dataset;
use super::{DicomObject, DicomRules, Listed, SopClass, Study, common, equipment};

/// The title of a selection of objects that were made for another patient (PS3.16, CID 7010).
const WRONG_PATIENT: Concept<'_> = Concept::new("113038", DCM, "Incorrect Modality Worklist Entry");

/// The object that withdraws all that a server shows of the record in its first `turns` turns; `None` if that is
/// nothing, or if the server shows this object, too. Its UID derives from what it names: for the same objects it is the
/// same, and what appears later has one of its own. `station` is the one that withdraws it.
pub fn withdrawal(
    study: &Study,
    turns: u32,
    listed: &[Listed],
    station: &str,
    rules: &DicomRules,
    now: Timestamp,
) -> Option<DicomObject> {
    let (class, shown) = (SopClass::Withdrawal, study.shown(turns, listed));
    let mut named: Vec<&str> = shown.iter().map(|of| of.uid.as_str()).collect();
    named.sort_unstable();
    let uid = study.part_uid(&format!("withdrawal\0{}", named.join("\0")));
    if shown.is_empty() || listed.iter().any(|of| of.uid == uid) {
        return None;
    }
    let references =
        shown.iter().map(|of| (Relation::Contains, Item::reference(&of.class, &of.uid)));
    // The times of an object are all in one zone.
    let zone = study.taken().map_or(TimeZone::UTC, |taken| TimeZone::fixed(taken.offset()));
    let dataset = common(study, rules, class, 0, &now.to_zoned(zone))
        .and(equipment(Some(station), env!("CARGO_PKG_VERSION")))
        .text(tags::SOP_INSTANCE_UID, uid.as_str())
        .text(tags::INSTANCE_NUMBER, turns.to_string())
        .items(tags::REFERENCED_PERFORMED_PROCEDURE_STEP_SEQUENCE, Vec::new())
        .items(tags::CURRENT_REQUESTED_PROCEDURE_EVIDENCE_SEQUENCE, vec![evidence(study, &shown)])
        .and(Item::container(WRONG_PATIENT).with(references.collect()).root("2010"));
    Some(DicomObject { class, uid, dataset: dataset.0 })
}

/// The withdrawn objects, by their series.
fn evidence(study: &Study, shown: &[&Listed]) -> Dataset {
    let of_series =
        grouped(shown.iter().map(|of| (of.series.as_str(), reference(&of.class, &of.uid))));
    let series = of_series.into_iter().map(|(series, references)| {
        Dataset::new()
            .text(tags::SERIES_INSTANCE_UID, series)
            .items(tags::REFERENCED_SOP_SEQUENCE, references)
    });
    Dataset::new()
        .text(tags::STUDY_INSTANCE_UID, study.uid())
        .items(tags::REFERENCED_SERIES_SEQUENCE, series.collect())
}
