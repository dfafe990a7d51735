//! The files of a record folder, as bytes.

use std::collections::BTreeSet;

use sha2::{Digest, Sha256};
use thiserror::Error;

use super::picture::png::{self, PngFault};
use super::picture::{Theme, figures, svg};
use super::report::PdfFault;
use super::schema::FindingNote;
use super::{Language, Provenance, Record, compose, csv, drawing, report};
use crate::cad::{CadFault, FileHeader, Output};
use crate::leg::finding::Severity;
use crate::leg::{Extraction, Method, Side};
use crate::scan::Format;

/// The list of all other files' hashes, as `sha256sum -c` reads it.
pub const SUMS: &str = "SHA256SUMS";

/// The report as a page.
const REPORT_PAGE: &str = "report.html";

/// The report on paper.
const REPORT_PAPER: &str = "report.pdf";

/// Pixels to one px of a figure: 20 cm at 180 dots an inch.
const PNG_SCALE: f64 = 2.0;

/// Why the files of a record cannot be made; none of it lies in the scan.
#[derive(Debug, Error)]
pub enum NotMade {
    /// A figure cannot be written as JSON.
    #[error("the record cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
    /// There is no paper.
    #[error(transparent)]
    Paper(#[from] PdfFault),
    /// There is no image of a figure.
    #[error("no image of a figure: {0}")]
    Image(#[from] PngFault),
}

/// One file of a record folder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RecordFile {
    /// File name within the folder, ASCII, no separators.
    pub name: String,
    /// Content.
    pub bytes: Vec<u8>,
}

/// The file of a record that holds the scanner's own measures of the scan.
pub const ORD: &str = "scanner.ord";

/// What is made of a record for people.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ReportChoice {
    /// The language of the report and its figures.
    pub language: Language,
    /// The notations in which each figure is a file of its own besides; none: only in the report.
    pub figures: BTreeSet<FigureFormat>,
}

/// The notation of a figure's file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum FigureFormat {
    /// Lines and words, for pages and for editing.
    Svg,
    /// Pixels, for programs that show no SVG.
    Png,
}

/// What was measured.
#[derive(Debug, Clone, Copy)]
pub struct ScanFile<'a> {
    /// Its bytes.
    pub bytes: &'a [u8],
    /// Their format.
    pub format: Format,
    /// The scanner's own measures (`.ord`) that came with it, if any.
    pub ord: Option<&'a [u8]>,
}

/// The record and all files of its folder in the order in which they are to be written:
/// `record.json` first, the scan's own bytes and what came with it, and `SHA256SUMS` over all others
/// last. The same arguments give the same bytes. The scan's hash is the provenance's. A CAD file that
/// cannot be made is a finding of the record.
///
/// # Errors
/// Where a figure cannot be written as JSON, or the report cannot be printed.
pub fn record_files(
    extraction: &Extraction,
    provenance: &Provenance,
    method: &Method,
    output: &Output,
    choice: &ReportChoice,
    scan: ScanFile<'_>,
) -> Result<(Record, Vec<RecordFile>), NotMade> {
    let mut record = compose::record(extraction, provenance, method);
    let (surfaces, notes) = surface_files(extraction, output);
    record.findings.extend(notes);
    let mut json = serde_json::to_vec_pretty(&record)?;
    json.push(b'\n');
    let mut files = vec![
        file("record.json", json),
        file("measurements.csv", csv::measurements(&record).into_bytes()),
        file("legs.svg", drawing::legs(extraction).into_bytes()),
    ];
    files.extend(report_files(&record, choice.language)?);
    files.extend(figure_files(&record, choice)?);
    files.extend(surfaces);
    files.extend(scan.ord.map(|ord| file(ORD, ord.to_vec())));
    let mut sums: String = files.iter().map(|file| sum(&sha256(&file.bytes), &file.name)).collect();
    let scan = file(&format!("scan.{}", scan.format.ending()), scan.bytes.to_vec());
    // Hashed already, and larger than all the others together.
    sums.push_str(&sum(&provenance.sha256, &scan.name));
    files.push(scan);
    files.push(file(SUMS, sums.into_bytes()));
    Ok((record, files))
}

/// The report of a record: of the same record in the same language the same bytes, whether it was
/// just measured or read back.
///
/// # Errors
/// Where a figure cannot be written as JSON, or the report cannot be printed.
pub fn report_files(record: &Record, language: Language) -> Result<Vec<RecordFile>, NotMade> {
    let page = report::page(record, language)?;
    let paper = report::paper(record, language)?;
    Ok(vec![file(REPORT_PAGE, page.into_bytes()), file(REPORT_PAPER, paper)])
}

/// The figures as files of their own.
fn figure_files(record: &Record, choice: &ReportChoice) -> Result<Vec<RecordFile>, PngFault> {
    if choice.figures.is_empty() {
        return Ok(Vec::new());
    }
    let mut files = Vec::new();
    for figure in figures::all(record, choice.language) {
        for format in &choice.figures {
            let (ending, bytes) = match format {
                FigureFormat::Svg => ("svg", svg::file(&figure.picture).into_bytes()),
                FigureFormat::Png => ("png", png::png(&figure.picture, Theme::Light, PNG_SCALE)?),
            };
            files.push(file(&format!("figure-{}.{ending}", figure.name), bytes));
        }
    }
    Ok(files)
}

fn file(name: &str, bytes: Vec<u8>) -> RecordFile {
    RecordFile { name: name.to_owned(), bytes }
}

/// The files that are made of each leg's surface, and what is to be said of those that are not.
fn surface_files(extraction: &Extraction, output: &Output) -> (Vec<RecordFile>, Vec<FindingNote>) {
    let (mut files, mut notes) = (Vec::new(), Vec::new());
    for leg in &extraction.legs {
        let Some(surface) = &leg.surface else { continue };
        let side = leg.side.word();
        let product = format!("{side} leg");
        for kind in &output.files {
            let name = format!("{side}{}", kind.ending());
            let header = FileHeader { file_name: &name, product: &product };
            match kind.bytes(&surface.surface, output.mesh_tolerance_mm, &header) {
                Ok(bytes) => files.push(RecordFile { name, bytes }),
                Err(fault) => notes.push(not_made(leg.side, &name, &fault)),
            }
        }
    }
    (files, notes)
}

fn not_made(side: Side, name: &str, fault: &CadFault) -> FindingNote {
    FindingNote {
        code: fault.code().to_owned(),
        severity: Severity::Warning.word().to_owned(),
        leg: Some(side.word().to_owned()),
        level: None,
        message: format!("{name} was not made: {fault}"),
    }
}

/// SHA-256 of bytes, lower-case hexadecimal.
pub fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// A file's line: hash, two spaces, name.
fn sum(sha256: &str, name: &str) -> String {
    format!("{sha256}  {name}\n")
}
