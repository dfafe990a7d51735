//! The messages: a result, and its withdrawal.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use jiff::Timestamp;
use jiff::tz::Offset;

use super::escape::escaped;
use super::{Hl7Rules, PdfForm};
use crate::leg::Side;
use crate::record::completeness::Completeness;
use crate::record::export::{ExportFigure, What, export_figures};
use crate::record::{FIRST_REVISION, Record, sha256};

/// Digits of a control id; MSH-10 has room for 20.
const CONTROL_DIGITS: usize = 20;

/// The order's code.
const ORDER: &str = "LEGS";

/// The code of the PDF.
const PDF: &str = "PDF";

/// The code of the verdict.
const VERDICT: &str = "VERDICT";

/// The version before OBX-18, the station, was added.
const WITHOUT_STATION: &str = "2.3.1";

/// OBX-11 and OBR-25 of a withdrawn result: it was sent for the wrong patient.
const WRONG: &str = "W";

/// Identifies a message: the same one is sent again under the same id.
pub fn control_id(scan: &str, patient: &str, revision: u32, is_withdrawal: bool) -> String {
    let mut digits = sha256(format!("{scan}\0{patient}\0{revision}\0{is_withdrawal}").as_bytes());
    digits.truncate(CONTROL_DIGITS);
    digits
}

/// The codes of what a result of this record holds, in its order.
pub fn observed(record: &Record, has_pdf: bool) -> Vec<String> {
    let figures = export_figures(record);
    let codes = figures.iter().map(code);
    let pdf = has_pdf.then(|| PDF.to_owned());
    codes.chain([VERDICT.to_owned()]).chain(pdf).collect()
}

/// The result of a record, for its patient. `first_seen` is the time of a record that does not say when it was
/// taken, `now` that of the message. `None` if the record names no patient.
pub fn result(
    record: &Record,
    pdf: Option<&[u8]>,
    rules: &Hl7Rules,
    first_seen: Timestamp,
    now: Timestamp,
) -> Option<Vec<u8>> {
    let patient = record.patient.as_ref()?.id.as_str();
    let control = control_id(&record.scan.sha256, patient, record.revision, false);
    // F: final. C: a correction of a final result.
    let status = if record.revision > FIRST_REVISION { "C" } else { "F" };
    let at = taken(record, first_seen);
    let of = Message { rules, patient, status, at: &at };
    let mut segments = of.head(&control, &record.scan.sha256, now);
    let mut number = 0;
    for figure in export_figures(record) {
        number += 1;
        segments.extend(of.figure(number, &figure, record.station.as_deref().unwrap_or_default()));
    }
    let verdict = Completeness::of(record, &rules.garment).sentences(rules.language).join(" ");
    number += 1;
    let text = rules.language.text("fhir.report");
    segments.push(of.observation(number, "ST", (VERDICT, text), &escaped(&verdict), ""));
    if let (Some(pdf), Some(kind)) = (pdf, kind_of(rules.pdf)) {
        let data = format!("^{kind}^Base64^{}", STANDARD.encode(pdf));
        segments.push(of.observation(number + 1, "ED", (PDF, text), &data, ""));
    }
    Some(of.written(&segments))
}

/// The withdrawal of a result that was sent for the wrong patient: each of these codes as wrong, without a value.
pub fn withdrawal(
    scan: &str,
    patient: &str,
    revision: u32,
    codes: &[String],
    rules: &Hl7Rules,
    now: Timestamp,
) -> Vec<u8> {
    let control = control_id(scan, patient, revision, true);
    let at = moment(now, None);
    let of = Message { rules, patient, status: WRONG, at: &at };
    let mut segments = of.head(&control, scan, now);
    for (at, code) in codes.iter().enumerate() {
        segments.push(of.observation(at + 1, "ST", (code, ""), "", ""));
    }
    of.written(&segments)
}

fn kind_of(form: PdfForm) -> Option<&'static str> {
    match form {
        PdfForm::MediaType => Some("application^pdf"),
        PdfForm::Plain => Some("PDF^"),
        PdfForm::None => None,
    }
}

/// What the segments of a message share.
struct Message<'a> {
    rules: &'a Hl7Rules,
    patient: &'a str,
    status: &'a str,
    /// When the scan was taken.
    at: &'a str,
}

impl Message<'_> {
    /// MSH, PID and OBR.
    fn head(&self, control: &str, scan: &str, now: Timestamp) -> Vec<String> {
        let Hl7Rules { sender, receiver, processing, version, authority, coding, charset, .. } =
            self.rules;
        let [[application, facility], [to_application, to_facility]] =
            [sender, receiver].map(|names| names.each_ref().map(|name| escaped(name)));
        let now = moment(now, None);
        let msh = format!(
            "MSH|^~\\&|{application}|{facility}|{to_application}|{to_facility}|{now}||\
             ORU^R01^ORU_R01|{control}|{processing}|{}|||AL|NE||{}",
            escaped(version),
            charset.name()
        );
        // The name is required and not known: its type says so.
        let id = format!("{}^^^{}^PI", escaped(self.patient), escaped(authority));
        let pid = format!("PID|1||{id}||^^^^^^U");
        let filler: String = scan.chars().take(CONTROL_DIGITS).collect();
        let order = escaped(self.rules.language.text("fhir.leg_measures"));
        let obr = format!(
            "OBR|1||{filler}^GAITER|{ORDER}^{order}^{}|||{}|||||||||||||||{now}|||{}",
            escaped(coding),
            self.at,
            self.status
        );
        vec![msh, pid, obr]
    }

    /// An OBX for a girth or height, and an NTE for each doubt.
    fn figure(&self, number: usize, figure: &ExportFigure, station: &str) -> Vec<String> {
        let language = self.rules.language;
        let key = match figure.what {
            What::Girth => "fhir.girth_at",
            What::Height => "fhir.height_at",
        };
        let level = language.filled(key, &[("level", &figure.level.name())]);
        let words = format!("{level}, {}", language.word("leg", figure.side.word()));
        let value = format!("{:.1}|cm^cm^UCUM", figure.cm);
        let name = code(figure);
        let station = if self.rules.version == WITHOUT_STATION { "" } else { station };
        let mut segments = vec![self.observation(number, "NM", (&name, &words), &value, station)];
        let by_hand = figure.is_by_hand.then(|| language.text("fhir.by_hand").to_owned());
        let doubts = figure.doubts.iter().map(|doubt| {
            let title = language.find(&format!("finding.{doubt}.title"));
            format!("{}: {}", language.text("fhir.doubtful"), title.unwrap_or(doubt))
        });
        for (at, note) in by_hand.into_iter().chain(doubts).enumerate() {
            segments.push(format!("NTE|{}|L|{}", at + 1, escaped(&note)));
        }
        segments
    }

    /// An OBX; `value` is OBX-5, and with a `|` OBX-6 as well.
    fn observation(
        &self,
        number: usize,
        kind: &str,
        (code, words): (&str, &str),
        value: &str,
        station: &str,
    ) -> String {
        let value = if kind == "NM" { value.to_owned() } else { format!("{value}|") };
        let coding = escaped(&self.rules.coding);
        let segment = format!(
            "OBX|{number}|{kind}|{code}^{}^{coding}|{}|{value}|||||{}|||{}||||{}",
            escaped(words),
            group(code),
            self.status,
            self.at,
            escaped(station)
        );
        segment.trim_end_matches('|').to_owned()
    }

    /// Segments as bytes, each ended by a carriage return.
    fn written(&self, segments: &[String]) -> Vec<u8> {
        let text: String = segments.iter().map(|segment| format!("{segment}\r")).collect();
        self.rules.charset.encoded(&text)
    }
}

/// The code of a figure with its leg: `cB-R`.
fn code(figure: &ExportFigure) -> String {
    let letter = match figure.side {
        Side::Right => 'R',
        Side::Left => 'L',
    };
    format!("{}-{letter}", figure.code())
}

/// OBX-4 of a code, which some versions require: the right leg, the left one, both.
fn group(code: &str) -> u8 {
    match code.rsplit_once('-') {
        Some((_, "R")) => 1,
        Some((_, "L")) => 2,
        _ => 3,
    }
}

/// When a record's scan was taken, by the clock at the scanner where that is known.
fn taken(record: &Record, first_seen: Timestamp) -> String {
    let acquired = record.acquired.as_ref();
    let offset = acquired.and_then(|acquired| acquired.utc_offset_min);
    let offset = offset.and_then(|min| Offset::from_seconds(60 * i32::from(min)).ok());
    moment(acquired.map_or(first_seen, |acquired| acquired.at), offset)
}

/// A time as HL7 writes it, to the second, with its offset.
fn moment(at: Timestamp, offset: Option<Offset>) -> String {
    let offset = offset.unwrap_or(Offset::UTC);
    let minutes = offset.seconds() / 60;
    let sign = if minutes < 0 { '-' } else { '+' };
    let (hours, minutes) = (minutes.abs() / 60, minutes.abs() % 60);
    format!("{}{sign}{hours:02}{minutes:02}", offset.to_datetime(at).strftime("%Y%m%d%H%M%S"))
}
