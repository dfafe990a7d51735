//! The figures of the sheet as a measurement report (PS3.16, TID 1500): a group for each leg.

use dicom_dictionary_std::tags;
use gaiter_language::Language;
use gaiter_leg::Side;
use gaiter_record::export::{ExportFigure, What, export_figures};
use gaiter_record::report::title;

use super::content::{Concept, DCM, Item, Relation, SCT};
use super::dataset::Dataset;
use super::study::uid;
use super::{DicomObject, Parts, SopClass};

/// The part of a record that is its figures.
const PART: &str = "measurements";

/// The place of the figures among the objects of a record.
const NUMBER: u32 = 1;

// Names of items, from PS3.16.
const REPORT: Concept<'_> = Concept::new("126000", DCM, "Imaging Measurement Report");
const LANGUAGE: Concept<'_> =
    Concept::new("121049", DCM, "Language of Content Item and Descendants");
const OBSERVER_TYPE: Concept<'_> = Concept::new("121005", DCM, "Observer Type");
const DEVICE: Concept<'_> = Concept::new("121007", DCM, "Device");
const DEVICE_UID: Concept<'_> = Concept::new("121012", DCM, "Device Observer UID");
const DEVICE_NAME: Concept<'_> = Concept::new("121013", DCM, "Device Observer Name");
const PROCEDURE: Concept<'_> = Concept::new("121058", DCM, "Procedure reported");
const MEASUREMENTS: Concept<'_> = Concept::new("126010", DCM, "Imaging Measurements");
const GROUP: Concept<'_> = Concept::new("125007", DCM, "Measurement Group");
const TRACKING: Concept<'_> = Concept::new("112039", DCM, "Tracking Identifier");
const TRACKING_UID: Concept<'_> = Concept::new("112040", DCM, "Tracking Unique Identifier");
const COMMENT: Concept<'_> = Concept::new("121106", DCM, "Comment");
const HEIGHT: Concept<'_> = Concept::new("121207", DCM, "Height");
const SITE: Concept<'_> = Concept::new("363698007", SCT, "Finding Site");
const LOWER_LIMB: Concept<'_> = Concept::new("61685007", SCT, "Lower limb");
const LATERALITY: Concept<'_> = Concept::new("272741003", SCT, "Laterality");
const RIGHT: Concept<'_> = Concept::new("24028007", SCT, "Right");
const LEFT: Concept<'_> = Concept::new("7771000", SCT, "Left");
const CIRCUMFERENCE: Concept<'_> = Concept::new("74551000", SCT, "Circumference");
const PLACE: Concept<'_> = Concept::new("106233006", SCT, "Topographical modifier");
const METHOD: Concept<'_> = Concept::new("370129005", SCT, "Measurement Method");
const STANDARD_DEVIATION: Concept<'_> = Concept::new("386136009", SCT, "Standard Deviation");

impl Parts<'_> {
    /// The object with the figures of both legs.
    pub(crate) fn measurements(&self) -> DicomObject {
        let own = Dataset::new()
            .items(tags::REFERENCED_PERFORMED_PROCEDURE_STEP_SEQUENCE, Vec::new())
            .items(tags::PERFORMED_PROCEDURE_CODE_SEQUENCE, Vec::new())
            .text(tags::COMPLETION_FLAG, "COMPLETE")
            .text(tags::VERIFICATION_FLAG, "UNVERIFIED")
            .and(self.content());
        let own = match self.sent.study.request() {
            Some(request) => own.items(tags::REFERENCED_REQUEST_SEQUENCE, vec![request]),
            None => own,
        };
        self.object(SopClass::Measurements, PART, NUMBER, own)
    }

    fn content(&self) -> Dataset {
        let (record, language) = (self.sent.record, self.rules.language);
        let station = record.station.as_deref().unwrap_or_default();
        let spoken = Concept::new(language.tag(), "RFC5646", name_of(language));
        let procedure = self.own("leg-measures", language.text("hospital.leg_measures"));
        let figures = export_figures(record);
        let legs = record.sides().map(|side| {
            let of_leg = figures.iter().filter(|figure| figure.side == side);
            (Relation::Contains, self.leg(side, of_leg))
        });
        let measurements = Item::container(MEASUREMENTS).with(legs.collect());
        let device = uid(&format!("device\0{station}"));
        let mut below = vec![
            (Relation::HasConceptModifier, Item::code(LANGUAGE, spoken)),
            (Relation::HasObservationContext, Item::code(OBSERVER_TYPE, DEVICE)),
            (Relation::HasObservationContext, Item::uid(DEVICE_UID, &device)),
        ];
        if !station.is_empty() {
            let name = Item::text(DEVICE_NAME, station);
            below.push((Relation::HasObservationContext, name));
        }
        below.push((Relation::HasConceptModifier, Item::code(PROCEDURE, procedure)));
        below.push((Relation::Contains, measurements));
        Item::container(REPORT).with(below).root("1500")
    }

    /// The group of a leg.
    fn leg<'f>(&self, side: Side, figures: impl Iterator<Item = &'f ExportFigure>) -> Item {
        let tracking = self.rules.language.word("leg.heading", side.word());
        let tracking_uid = self.sent.study.part_uid(side.word());
        let laterality = match side {
            Side::Right => RIGHT,
            Side::Left => LEFT,
        };
        let laterality = vec![(Relation::HasConceptModifier, Item::code(LATERALITY, laterality))];
        let head = [
            (Relation::HasObservationContext, Item::text(TRACKING, tracking)),
            (Relation::HasObservationContext, Item::uid(TRACKING_UID, &tracking_uid)),
            (Relation::HasConceptModifier, Item::code(SITE, LOWER_LIMB).with(laterality)),
        ];
        let figures = figures.map(|figure| (Relation::Contains, self.figure(figure)));
        Item::container(GROUP).with(head.into_iter().chain(figures).collect())
    }

    /// A girth or height: at which level, by whom, how sure.
    fn figure(&self, figure: &ExportFigure) -> Item {
        let language = self.rules.language;
        let name = match figure.what {
            What::Girth => CIRCUMFERENCE,
            What::Height => HEIGHT,
        };
        let level = figure.level.name();
        let place = Item::code(PLACE, self.own(level, level));
        let mut below = vec![(Relation::HasConceptModifier, place)];
        if figure.is_by_hand {
            let by_hand = self.own("by-hand", language.text("hospital.by_hand"));
            below.push((Relation::HasConceptModifier, Item::code(METHOD, by_hand)));
        }
        if let Some(sd_cm) = figure.sd_cm {
            let sd = Item::length_cm(STANDARD_DEVIATION, &sd_cm.to_string());
            below.push((Relation::HasProperties, sd));
        }
        below.extend(figure.doubts.iter().map(|doubt| {
            let title = title(doubt, language);
            let text = format!("{}: {title}", language.text("hospital.doubtful"));
            (Relation::HasProperties, Item::text(COMMENT, &text))
        }));
        Item::length_cm(name, &format!("{:.1}", figure.cm)).with(below)
    }

    /// A code of gaiter's own.
    fn own<'c>(&'c self, value: &'c str, meaning: &'c str) -> Concept<'c> {
        Concept::new(value, &self.rules.coding, meaning)
    }
}

/// The meaning of the code of a language. Meanings of codes are English, as in PS3.16.
fn name_of(language: Language) -> &'static str {
    match language {
        Language::En => "English",
        Language::De => "German",
    }
}
