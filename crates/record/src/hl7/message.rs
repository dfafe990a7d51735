//! The messages: a result, and its withdrawal.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use gaiter_leg::Side;
use jiff::tz::TimeZone;
use jiff::{Timestamp, Zoned};

use super::escape::escaped;
use super::{Charset, Hl7Rules, PdfForm};
use crate::completeness::Completeness;
use crate::export::{ExportFigure, What, export_figures, taken};
use crate::report::title;
use crate::schema::Record;
use crate::{FIRST_REVISION, sha256};

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

/// Identifies a message: the same one is sent again under the same id. Two stations that have the same scan send
/// different messages.
pub fn control_id(
    station: &str,
    scan: &str,
    patient: &str,
    revision: u32,
    is_withdrawal: bool,
) -> String {
    let of = format!("{station}\0{scan}\0{patient}\0{revision}\0{is_withdrawal}");
    let mut digits = sha256(of.as_bytes());
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

/// The result of a record, for its patient. `gone` are the codes of what earlier results held and this one does not,
/// such as a girth that cannot be measured after all: each is marked as wrong, because a receiver keeps what a
/// correction does not name. `control` is its [`control_id`], `first_seen` the time of a record that does not state
/// when it was taken, `now` that of the message. `None` if the record names no patient.
pub fn result(
    control: &str,
    record: &Record,
    pdf: Option<&[u8]>,
    gone: &[String],
    rules: &Hl7Rules,
    first_seen: Timestamp,
    now: Timestamp,
) -> Option<Vec<u8>> {
    let named = record.patient.as_ref()?;
    let patient = named.id.as_str();
    let number = named.request().and_then(|request| request.accession_number.as_deref());
    let status = match record.revision > FIRST_REVISION {
        true => Status::Corrected,
        false => Status::Final,
    };
    let at = moment(&taken(record, first_seen));
    let of = Message { rules, patient, status, at: at.clone(), number };
    let mut segments = of.head(control, &record.scan.sha256, now);
    let figures = export_figures(record);
    let station = record.station.as_deref().unwrap_or_default();
    for (at, figure) in figures.iter().enumerate() {
        segments.extend(of.figure(at + 1, figure, station));
    }
    let mut place = figures.len() + 1;
    let words = rules.language.text("hospital.report");
    let verdict =
        Completeness::from_record(record, &rules.garment).sentences(rules.language).join(" ");
    let (kind, value) = ("TX", escaped(&verdict));
    let verdict = Observation { kind, code: VERDICT, words, value, ..Observation::default() };
    segments.push(of.observation(place, &verdict));
    if let (Some(pdf), Some(kind)) = (pdf, kind_of(rules.pdf)) {
        place += 1;
        let (kind, value) = ("ED", format!("^{kind}^Base64^{}", STANDARD.encode(pdf)));
        let pdf = Observation { kind, code: PDF, words, value, ..Observation::default() };
        segments.push(of.observation(place, &pdf));
    }
    let wrong = Message { rules, patient, status: Status::Wrong, at, number };
    segments.extend(wrong.wrong(place + 1, gone));
    Some(of.written(&segments))
}

/// The withdrawal of a result that was sent for the wrong patient: each of these codes as wrong, without a value.
/// `control` is its [`control_id`].
pub fn withdrawal(
    control: &str,
    scan: &str,
    patient: &str,
    codes: &[String],
    rules: &Hl7Rules,
    now: Timestamp,
) -> Vec<u8> {
    let at = moment(&now.to_zoned(TimeZone::UTC));
    let of = Message { rules, patient, status: Status::Wrong, at, number: None };
    let mut segments = of.head(control, scan, now);
    segments.extend(of.wrong(1, codes));
    of.written(&segments)
}

/// The data type of a PDF in an observation; `None` if it is not sent.
fn kind_of(form: PdfForm) -> Option<&'static str> {
    match form {
        PdfForm::MediaType => Some("application^pdf"),
        PdfForm::Plain => Some("PDF^"),
        PdfForm::None => None,
    }
}

/// The status of the figures in a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Status {
    /// They hold.
    Final,
    /// They hold, in place of those that were final.
    Corrected,
    /// They were sent for the wrong patient.
    Wrong,
}

impl Status {
    /// OBX-11 (HL7 table 0085).
    fn of_observation(self) -> char {
        match self {
            Status::Final => 'F',
            Status::Corrected => 'C',
            Status::Wrong => 'W',
        }
    }

    /// OBR-25 (HL7 table 0123), which has no code for a wrong result: it is a correction.
    fn of_order(self) -> char {
        match self {
            Status::Final => 'F',
            Status::Corrected | Status::Wrong => 'C',
        }
    }
}

/// The content of an OBX.
#[derive(Default)]
struct Observation<'a> {
    /// OBX-2: the data type.
    kind: &'static str,
    /// OBX-3.1.
    code: &'a str,
    /// OBX-3.2: the same in words.
    words: &'a str,
    /// OBX-5: the value, with its separators.
    value: String,
    /// OBX-6.
    unit: &'static str,
    /// OBX-18: the station; empty for what is no figure.
    station: &'a str,
}

/// What the segments of a message share.
struct Message<'a> {
    rules: &'a Hl7Rules,
    patient: &'a str,
    status: Status,
    /// When the scan was taken.
    at: String,
    /// The accession number of the request that the scan answers.
    number: Option<&'a str>,
}

impl Message<'_> {
    fn charset(&self) -> Charset {
        self.rules.charset.that_writes(self.patient)
    }

    /// MSH, PID and OBR.
    fn head(&self, control: &str, scan: &str, now: Timestamp) -> Vec<String> {
        let Hl7Rules { sender, receiver, processing, version, authority, coding, .. } = self.rules;
        let [[application, facility], [to_application, to_facility]] =
            [sender, receiver].map(|names| names.each_ref().map(|name| escaped(name)));
        let now = moment(&now.to_zoned(TimeZone::UTC));
        let msh = format!(
            "MSH|^~\\&|{application}|{facility}|{to_application}|{to_facility}|{now}||\
             ORU^R01^ORU_R01|{control}|{processing}|{}|||AL|NE||{}",
            escaped(version),
            self.charset().name()
        );
        // The name is required and not known: its type states that.
        let id = format!("{}^^^{}^PI", escaped(self.patient), escaped(authority));
        let pid = format!("PID|1||{id}||^^^^^^U");
        let filler: String = scan.chars().take(CONTROL_DIGITS).collect();
        let order = escaped(self.rules.language.text("hospital.leg_measures"));
        let obr = format!(
            "OBR|1||{filler}^GAITER|{ORDER}^{order}^{}|||{}|||||||||||{}||||{now}|||{}",
            escaped(coding),
            self.at,
            escaped(self.number.unwrap_or_default()),
            self.status.of_order()
        );
        vec![msh, pid, obr]
    }

    /// An OBX for a girth or height, and an NTE for each doubt.
    fn figure(&self, number: usize, figure: &ExportFigure, station: &str) -> Vec<String> {
        let language = self.rules.language;
        let key = match figure.what {
            What::Girth => "hospital.girth_at",
            What::Height => "hospital.height_at",
        };
        let level = language.filled(key, &[("level", &figure.level.name())]);
        let words = format!("{level}, {}", language.word("leg", figure.side.word()));
        let value = format!("{:.1}", figure.cm);
        let station = if self.rules.version == WITHOUT_STATION { "" } else { station };
        let (code, unit) = (code(figure), "cm^cm^UCUM");
        let observation =
            Observation { kind: "NM", code: &code, words: &words, value, unit, station };
        let mut segments = vec![self.observation(number, &observation)];
        let by_hand = figure.is_by_hand.then(|| language.text("hospital.by_hand").to_owned());
        let doubts = figure.doubts.iter().map(|doubt| {
            format!("{}: {}", language.text("hospital.doubtful"), title(doubt, language))
        });
        for (at, note) in by_hand.into_iter().chain(doubts).enumerate() {
            segments.push(format!("NTE|{}|L|{}", at + 1, escaped(&note)));
        }
        segments
    }

    /// An OBX without a value for each of these codes, numbered from `first`.
    fn wrong(&self, first: usize, codes: &[String]) -> Vec<String> {
        let wrong = |(at, code): (usize, &String)| {
            self.observation(
                first + at,
                &Observation { kind: "ST", code, ..Observation::default() },
            )
        };
        codes.iter().enumerate().map(wrong).collect()
    }

    fn observation(&self, number: usize, of: &Observation<'_>) -> String {
        let Observation { kind, code, words, value, unit, station } = of;
        let segment = format!(
            "OBX|{number}|{kind}|{}^{}^{}|{}|{value}|{unit}|||||{}|||{}||||{}",
            escaped(code),
            escaped(words),
            escaped(&self.rules.coding),
            group(code),
            self.status.of_observation(),
            self.at,
            escaped(station)
        );
        segment.trim_end_matches('|').to_owned()
    }

    /// Segments as bytes, each ended by a carriage return.
    fn written(&self, segments: &[String]) -> Vec<u8> {
        let text: String = segments.iter().map(|segment| format!("{segment}\r")).collect();
        self.charset().encoded(&text)
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

/// A time as HL7 writes it, to the second, with its offset.
fn moment(at: &Zoned) -> String {
    at.strftime("%Y%m%d%H%M%S%z").to_string()
}
