//! Writes a record as a result (6310): girths and heights of both legs as test blocks, a table for
//! people, and the paths of the record's files.
//!
//! Lengths are in centimetres with one decimal, as on a tape. Girths are those of a tape.

use jiff::civil::DateTime;

use super::line::{WriteFault, message};
use super::rules::{AttachmentFields, GdtRules};
use super::words;
use crate::language::Language;
use crate::leg::{Level, Side};
use crate::record::rounding::cm_words;
use crate::record::schema::{FindingNote, LandmarkFigures, LegFigures, Record};

/// The kind of message for the result of an examination.
const RESULT: u16 = 6310;

/// The longest line of free text, characters.
const TEXT_MOST: usize = 60;

/// A file that a result refers to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Attachment {
    /// Its name or number in an archive.
    pub name: String,
    /// Its format, such as `SVG`.
    pub format: String,
    /// What it contains.
    pub description: String,
    /// Its path, as the practice software sees it.
    pub path: String,
}

/// Why there is no message for a record.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum ResultFault {
    /// The record is unassigned.
    #[error("the record names no patient, which practice software requires")]
    NoPatient,
    /// The message cannot be written.
    #[error(transparent)]
    Write(#[from] WriteFault),
}

type Fields = Vec<(u16, String)>;

/// Writes the message of a record. `taken` is the local time of its scan.
///
/// # Errors
/// See [`ResultFault`].
pub fn result(
    record: &Record,
    rules: &GdtRules,
    taken: DateTime,
    attachments: &[Attachment],
) -> Result<Vec<u8>, ResultFault> {
    let patient = record.patient.as_ref().ok_or(ResultFault::NoPatient)?;
    let (date, time) = (taken.strftime("%d%m%Y").to_string(), taken.strftime("%H%M%S").to_string());
    let mut fields = header(rules, record);
    fields.push((3000, patient.id.clone()));
    fields.extend([(6200, date.clone()), (6201, time.clone()), (8402, rules.procedure.clone())]);
    for (leg, side) in sides(record) {
        for level in Level::ALL.map(Level::name) {
            let Some(found) = leg.landmarks.get(level) else { continue };
            let block = Block { level, side, found, date: &date, time: &time, rules };
            block.write(&mut fields);
        }
    }
    fields.extend(table(record, rules).into_iter().map(|line| (6228, line)));
    fields.extend(comments(record, rules).into_iter().map(|line| (6227, line)));
    for attachment in attachments {
        fields.extend(of_attachment(attachment, &rules.attachment_fields));
    }
    Ok(message(RESULT, rules.charset, &fields)?)
}

fn header(rules: &GdtRules, record: &Record) -> Fields {
    let mut fields = vec![(8315, rules.receiver.clone()), (8316, rules.sender.clone())];
    fields.extend(rules.charset.number().map(|number| (9206, number.to_owned())));
    fields.extend([
        (9218, rules.version.clone()),
        (103, "gaiter".to_owned()),
        (132, record.made_by.gaiter.clone()),
    ]);
    fields
}

/// The legs of a record, each with its side.
fn sides(record: &Record) -> impl Iterator<Item = (&LegFigures, Side)> {
    let side = |leg: &LegFigures| {
        [Side::Left, Side::Right].into_iter().find(|side| side.word() == leg.side)
    };
    record.legs.iter().filter_map(move |leg| Some((leg, side(leg)?)))
}

/// The two test blocks of a level: its girth, and its height above the floor.
struct Block<'a> {
    level: &'a str,
    side: Side,
    found: &'a LandmarkFigures,
    date: &'a str,
    time: &'a str,
    rules: &'a GdtRules,
}

impl Block<'_> {
    fn write(&self, fields: &mut Fields) {
        let height = words::written("Höhe", self.rules.charset);
        let figures =
            [("L", "Umfang", self.found.girth_tape_mm), ("H", &height, self.found.height_mm)];
        let letter = match self.side {
            Side::Left => "L",
            Side::Right => "R",
        };
        for (kind, name, figure_mm) in figures {
            let side = words::side(self.side);
            fields.extend([
                (8410, format!("{kind}{}_{letter}", self.level)),
                (8411, format!("{name} {} {side}", self.level)),
                (8420, in_cm(figure_mm)),
                (8421, "cm".to_owned()),
                (8432, self.date.to_owned()),
                (8439, self.time.to_owned()),
            ]);
            let doubts = self.found.doubts.iter();
            fields.extend(
                doubts.map(|code| (8470, words::written(words::doubt(code), self.rules.charset))),
            );
        }
    }
}

fn in_cm(figure_mm: f64) -> String {
    cm_words(figure_mm, Language::En)
}

/// The figures for people, in columns of fixed width.
fn table(record: &Record, rules: &GdtRules) -> Vec<String> {
    let legs: Vec<(&LegFigures, Side)> = sides(record).collect();
    let cell = |level: &str, side: Side, figure: fn(&LandmarkFigures) -> f64| {
        let leg = legs.iter().find(|(_, its)| *its == side);
        let found = leg.and_then(|(leg, _)| leg.landmarks.get(level));
        found.map_or("-".to_owned(), |found| in_cm(figure(found)))
    };
    let mut lines = vec![row("Messung [cm]", "links", "rechts")];
    let height = words::written("Höhe", rules.charset);
    let girth: fn(&LandmarkFigures) -> f64 = |found| found.girth_tape_mm;
    let above: fn(&LandmarkFigures) -> f64 = |found| found.height_mm;
    for level in Level::ALL.map(Level::name) {
        if !legs.iter().any(|(leg, _)| leg.landmarks.contains_key(level)) {
            continue;
        }
        for (name, figure) in [("Umfang", girth), (&height, above)] {
            let [left, right] = [Side::Left, Side::Right].map(|side| cell(level, side, figure));
            lines.push(row(&format!("{name} {level}"), &left, &right));
        }
    }
    lines
}

fn row(name: &str, left: &str, right: &str) -> String {
    format!("{name:<14}{left:>8}{right:>8}")
}

/// What readers must know about the measurement. A sentence that the character set cannot write is
/// replaced by its code.
fn comments(record: &Record, rules: &GdtRules) -> Vec<String> {
    let scan = record.scan.sha256.get(..8).unwrap_or_default();
    let mut lines = vec![format!("gaiter {}, Scan {scan}", record.made_by.gaiter)];
    for finding in record.findings.iter().filter(|finding| finding.severity != "info") {
        let place = place(finding);
        let german = finding.says.as_ref().and_then(|says| says.in_words(Language::De));
        let message = german.unwrap_or_else(|| finding.message.clone());
        let comment = words::written(&format!("{place}{message}"), rules.charset);
        let can_be_written =
            wrapped(&comment).iter().all(|line| rules.charset.encode(line).is_ok());
        let comment = if can_be_written { comment } else { format!("{place}{}", finding.code) };
        lines.extend(wrapped(&comment));
    }
    lines
}

/// The leg and level of a finding, before its message.
fn place(finding: &FindingNote) -> String {
    let side = Side::BOTH.into_iter().find(|side| finding.leg.as_deref() == Some(side.word()));
    let parts: Vec<&str> =
        side.map(words::side).into_iter().chain(finding.level.as_deref()).collect();
    if parts.is_empty() { String::new() } else { format!("{}: ", parts.join(" ")) }
}

fn wrapped(text: &str) -> Vec<String> {
    words::wrapped(text, TEXT_MOST)
}

/// The fields of an attachment in the order of their numbers, which practice software expects.
fn of_attachment(attachment: &Attachment, ids: &AttachmentFields) -> Fields {
    let parts = [
        (ids.name, &attachment.name),
        (ids.format, &attachment.format),
        (ids.description, &attachment.description),
        (ids.path, &attachment.path),
    ];
    let told = parts.into_iter().filter_map(|(field, content)| Some((field?, content.clone())));
    let mut told: Fields = told.collect();
    told.sort_by_key(|(field, _)| *field);
    told
}
