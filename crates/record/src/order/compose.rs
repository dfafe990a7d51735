//! Record → [`Order`], for the form of a garment.

use gaiter_leg::Side;
use gaiter_leg::method::Posture;
use gaiter_sizes::garment::FormBox;
use gaiter_sizes::{Garment, Point};
use jiff::civil::Date;

use super::place::{Part, length_from, place};
use super::reading::{Read, edited, read};
use super::text::{OrderRef, patient_check, without_id};
use super::{
    BASIS, NOT_OF_A_SCAN, OpenBox, Order, OrderFigure, OrderSide, OrderedGarment, OrderedRecord,
    OrderedScan, Row, SCAN_AGE, SCHEMA, Units,
};
use crate::completeness::Completeness;
use crate::report::AgeMax;
use crate::{Acquired, FIRST_REVISION, Record, rounding};

/// The digits of a scan's reference, as lists of scans show it.
const REFERENCE_DIGITS: usize = 8;

impl Order {
    /// The order of a garment from a record. `scanner_girth_mm` is a standard error common to all girths of the
    /// scanner; 0 if none is known.
    pub fn from_record(
        record: &Record,
        garment: &Garment,
        order_ref: Option<&OrderRef>,
        scanner_girth_mm: f64,
    ) -> Order {
        let of = Ordered { record, garment, scanner_girth_mm };
        let completeness = Completeness::from_record(record, garment);
        let posture = record.made_by.method.get("posture").cloned();
        let rows: Vec<Row> = of.sides().into_iter().flat_map(|side| of.rows(side)).collect();
        Order {
            schema: SCHEMA.to_owned(),
            gaiter: env!("CARGO_PKG_VERSION").to_owned(),
            order_ref: order_ref.map(|of| of.as_str().to_owned()),
            reorder: None,
            garment: ordered_garment(garment),
            scan: scan(record),
            holds_until: None,
            record: OrderedRecord {
                schema: record.schema.clone(),
                revision: record.revision,
                station: record.station.clone(),
            },
            made_by: record.made_by.clone(),
            basis: BASIS.to_owned(),
            weight_on_both_legs: posture.as_deref().map(|word| word == Posture::BothLegs.word()),
            posture,
            units: Units::default(),
            scanner_girth_mm,
            state: completeness.kind().word().to_owned(),
            to_check: completeness.checks.iter().map(|of| of.word().to_owned()).collect(),
            patient_check: record
                .patient
                .as_ref()
                .map(|patient| patient_check(&record.scan.sha256, &patient.id)),
            open: open(garment, &rows),
            rows,
            not_of_a_scan: NOT_OF_A_SCAN.map(str::to_owned).into(),
        }
    }

    /// The order as it is made on a day: it states until when its measures are valid, and whether they have
    /// expired.
    pub fn on(mut self, today: Date, most: AgeMax) -> Order {
        let taken = self.scan.acquired.as_ref().map(|acquired: &Acquired| acquired.local().date());
        self.holds_until = taken.and_then(|taken| most.last_day(taken));
        self.to_check.retain(|code| code != SCAN_AGE);
        if self.holds_until.is_none_or(|last| today > last) {
            self.to_check.push(SCAN_AGE.to_owned());
        }
        self
    }

    /// Whether the scan was too old for an order on its day, or was taken on a day that is not known.
    pub fn is_of_an_old_scan(&self) -> bool {
        self.to_check.iter().any(|code| code == SCAN_AGE)
    }
}

pub(super) fn ordered_garment(garment: &Garment) -> OrderedGarment {
    OrderedGarment {
        name: garment.name().to_owned(),
        boxes: garment.boxes().iter().map(|of| of.name.clone()).collect(),
        round_girths_mm: garment.round_girths_mm(),
        round_lengths_mm: garment.round_lengths_mm(),
    }
}

fn scan(record: &Record) -> OrderedScan {
    let digits: String = record.scan.sha256.chars().take(REFERENCE_DIGITS).collect();
    let reference = match record.revision > FIRST_REVISION {
        true => format!("{digits}-r{}", record.revision),
        false => digits,
    };
    let time_of_day = record.acquired.as_ref().and_then(|acquired| {
        let local = acquired.offset()?.to_datetime(acquired.at);
        Some(format!("{:02}:{:02}", local.hour(), local.minute()))
    });
    OrderedScan {
        sha256: record.scan.sha256.clone(),
        reference,
        acquired: record.acquired.clone(),
        time_of_day,
    }
}

/// A record and the garment that is ordered.
struct Ordered<'a> {
    record: &'a Record,
    garment: &'a Garment,
    scanner_girth_mm: f64,
}

/// The side of a point on a leg, or of one that lies on neither.
fn side_of(point: Point, leg: Option<Side>) -> Option<OrderSide> {
    match (point, leg) {
        (Point::Beyond(_), None) => Some(OrderSide::Body),
        (Point::Beyond(_), Some(_)) | (_, None) => None,
        (_, Some(Side::Right)) => Some(OrderSide::Right),
        (_, Some(Side::Left)) => Some(OrderSide::Left),
    }
}

impl Ordered<'_> {
    /// The legs with boxes, the right one first, and then neither. A leg that was sought and not measured has
    /// boxes, all of them open.
    fn sides(&self) -> Vec<Option<Side>> {
        let is_sought = |side: Side| self.record.has_finding_at("leg-not-measured", side, None);
        let known: Vec<Side> = self.record.sides().collect();
        let legs = Side::FROM_FRONT.into_iter();
        let legs = legs.filter(|side| known.contains(side) || is_sought(*side));
        legs.map(Some).chain([None]).collect()
    }

    /// The rows of a leg, or of neither, in the order of the form.
    fn rows(&self, leg: Option<Side>) -> Vec<Row> {
        let boxes = self.garment.boxes().iter();
        let boxes: Vec<&FormBox> = boxes.filter(|of| side_of(of.point, leg).is_some()).collect();
        let mut points: Vec<String> = Vec::new();
        for name in boxes.iter().map(|of| place(of.point).0) {
            if !points.contains(&name) {
                points.push(name);
            }
        }
        let of_point = |name: &String| {
            let its = boxes.iter().copied().filter(|of| place(of.point).0 == *name);
            self.of_point(leg, name, &its.collect::<Vec<_>>())
        };
        points.iter().flat_map(of_point).collect()
    }

    /// The row of a point, and before it one with the scan's measure where a person set another value.
    fn of_point(&self, leg: Option<Side>, name: &str, boxes: &[&FormBox]) -> Vec<Row> {
        let reads: Vec<(&FormBox, Read)> = boxes
            .iter()
            .map(|of| (*of, read(self.record, leg, of.point, self.scanner_girth_mm)))
            .collect();
        let is_edited = reads.iter().any(|(_, read)| read.is_edited());
        let row = |counts: bool| {
            let part = |part: Part| {
                let (of, read) = reads.iter().find(|(of, _)| place(of.point).1 == part)?;
                Some(self.figure(of, read, counts))
            };
            let from = boxes.iter().find_map(|of| length_from(of.point)).map(str::to_owned);
            let point = boxes.first().map(|of| of.point);
            let edit = point
                .filter(|_| counts && is_edited)
                .and_then(|point| edited(self.record, leg?, point));
            let words = |text: &str| without_id(text, self.record);
            Row {
                side: point.and_then(|of| side_of(of, leg)).unwrap_or(OrderSide::Body),
                point: name.to_owned(),
                counts,
                girth: part(Part::Girth),
                length: part(Part::Length),
                length_from: from,
                edited_by: edit.and_then(|edit| words(&edit.by)),
                edited_at: edit.map(|edit| edit.at),
                reason: edit.and_then(|edit| words(&edit.reason)),
                last: None,
            }
        };
        let scanned = is_edited.then(|| row(false));
        // A scan that shows nothing of a point has nothing to keep readable.
        let scanned = scanned.filter(|row| row.figures().any(|figure| figure.mm.is_some()));
        scanned.into_iter().chain([row(true)]).collect()
    }

    fn figure(&self, of: &FormBox, read: &Read, counts: bool) -> OrderFigure {
        let value = if counts { &read.counting } else { &read.scanned };
        let printed_mm = value.mm.filter(|_| counts && value.is.is_sure());
        let printed_mm = printed_mm.map(|mm| self.garment.printed_mm(of.point, mm));
        OrderFigure {
            form_box: of.name.clone(),
            is: value.is,
            mm: value.mm.map(rounding::mm),
            u95_mm: value.sd_mm.map(|sd_mm| rounding::mm(rounding::MARGIN_SDS * sd_mm)),
            method: value.method,
            doubts: value.doubts.clone(),
            printed_cm: printed_mm.map(|mm| rounding::mm(mm / 10.0)),
        }
    }
}

/// The boxes of the form that are not filled.
pub(super) fn open(garment: &Garment, rows: &[Row]) -> Vec<OpenBox> {
    let is_optional = |name: &str| {
        let mut boxes = garment.boxes().iter();
        boxes.any(|of| of.name == name && of.is_optional)
    };
    let counting = rows.iter().filter(|row| row.counts);
    let figures = counting.flat_map(|row| row.figures().map(|figure| (row.side, figure)));
    let open = figures.filter(|(_, figure)| !figure.is.is_sure());
    let open = open.map(|(side, figure)| OpenBox {
        side,
        form_box: figure.form_box.clone(),
        why: figure.is,
        is_optional: is_optional(&figure.form_box),
    });
    open.collect()
}
