//! Writes a record as a result (6310): girths and heights of both legs as test blocks, the verdict and a
//! table for people, and the paths of the record's files.
//!
//! Order and figures are those of the measuring sheet: the right leg first, from G down to A, girths by
//! tape and vertical heights above the floor in centimetres with one decimal.

use gaiter_language::Language;
use gaiter_leg::Side;
use gaiter_sizes::Garment;
use jiff::civil::DateTime;

use super::line::{WriteFault, message};
use super::rules::{AttachmentFields, GdtRules};
use super::{table, words};
use crate::completeness::Completeness;
use crate::export::{ExportFigure, What, export_figures};
use crate::report::{ReportContent, title};
use crate::rounding::number;
use crate::schema::{FindingNote, Record};

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

/// Writes the message of a record, with the verdict for an order of this garment. `taken` is the local time
/// of its scan.
///
/// # Errors
/// See [`ResultFault`].
pub fn result(
    record: &Record,
    garment: &Garment,
    rules: &GdtRules,
    taken: DateTime,
    attachments: &[Attachment],
) -> Result<Vec<u8>, ResultFault> {
    let patient = record.patient.as_ref().ok_or(ResultFault::NoPatient)?;
    let (date, time) = (taken.strftime("%d%m%Y").to_string(), taken.strftime("%H%M%S").to_string());
    let mut fields = header(rules, record);
    fields.push((3000, patient.id.clone()));
    fields.extend([(6200, date.clone()), (6201, time.clone()), (8402, rules.procedure.clone())]);
    let figures = export_figures(record);
    fields.extend(figures.iter().flat_map(|figure| test_block(figure, &date, &time, rules)));
    fields.extend(verdict(record, garment, rules).into_iter().map(|line| (6228, line)));
    let table = table::lines(record).into_iter();
    fields.extend(table.map(|line| (6228, words::written(&line, rules.charset))));
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

/// The test block of a girth or a height.
fn test_block(figure: &ExportFigure, date: &str, time: &str, rules: &GdtRules) -> Fields {
    let (kind, name) = match figure.what {
        What::Girth => ("L", "Umfang"),
        What::Height => ("H", "Höhe"),
    };
    let letter = match figure.side {
        Side::Left => "L",
        Side::Right => "R",
    };
    let (level, side) = (figure.level.name(), words::side(figure.side));
    let written = |text: &str| words::written(text, rules.charset);
    let mut fields = vec![
        (8410, format!("{kind}{level}_{letter}")),
        (8411, written(&format!("{name} {level} {side}"))),
        (8420, number(figure.cm, 1, Language::En)),
        (8421, "cm".to_owned()),
        (8432, date.to_owned()),
        (8439, time.to_owned()),
    ];
    let by_hand = figure.is_by_hand.then_some(words::BY_HAND);
    let doubts = figure.doubts.iter().map(|code| title(code, Language::De));
    fields.extend(by_hand.into_iter().chain(doubts).map(|text| (8470, written(text))));
    fields
}

/// What to do for an order of this garment, in lines.
fn verdict(record: &Record, garment: &Garment, rules: &GdtRules) -> Vec<String> {
    let sentences = Completeness::from_record(record, garment).sentences(Language::De);
    let written =
        |sentence: &String| words::wrapped(&words::written(sentence, rules.charset), TEXT_MOST);
    sentences.iter().flat_map(written).collect()
}

/// What readers must know about the measurement. A sentence that the character set cannot write is
/// replaced by its code.
fn comments(record: &Record, rules: &GdtRules) -> Vec<String> {
    let scan = record.scan.sha256.get(..8).unwrap_or_default();
    let mut lines = vec![format!("gaiter {}, Scan {scan}", record.made_by.gaiter)];
    let set: Vec<String> = ReportContent::by_hand(record, Language::De);
    lines.extend(set.iter().flat_map(|line| comment(line, words::BY_HAND, rules)));
    for finding in record.findings.iter().filter(|finding| finding.severity != "info") {
        let place = place(finding);
        let german = finding.says.as_ref().and_then(|says| says.in_words(Language::De));
        let message = german.unwrap_or_else(|| finding.message.clone());
        let code = format!("{place}{}", finding.code);
        lines.extend(comment(&format!("{place}{message}"), &code, rules));
    }
    lines
}

/// A comment in lines; what stands instead of it if the character set cannot write it.
fn comment(text: &str, instead: &str, rules: &GdtRules) -> Vec<String> {
    let lines = words::wrapped(&words::written(text, rules.charset), TEXT_MOST);
    match lines.iter().all(|line| rules.charset.encode(line).is_ok()) {
        true => lines,
        false => words::wrapped(instead, TEXT_MOST),
    }
}

/// The leg and level of a finding, before its message.
fn place(finding: &FindingNote) -> String {
    let parts: Vec<&str> =
        finding.side().map(words::side).into_iter().chain(finding.level.as_deref()).collect();
    if parts.is_empty() { String::new() } else { format!("{}: ", parts.join(" ")) }
}

/// The fields of an attachment in the order of their numbers, which practice software expects.
fn of_attachment(attachment: &Attachment, ids: &AttachmentFields) -> Fields {
    let parts = [
        (ids.name, &attachment.name),
        (ids.format, &attachment.format),
        (ids.description, &attachment.description),
        (ids.path, &attachment.path),
    ];
    let fields = parts.into_iter().filter_map(|(field, content)| Some((field?, content.clone())));
    let mut fields: Fields = fields.collect();
    fields.sort_by_key(|(field, _)| *field);
    fields
}
