//! The files of a record folder, as bytes.

use gaiter_cad::{CadFault, FileHeader, Output};
use gaiter_leg::finding::Severity;
use gaiter_leg::{Extraction, Method, Side};
use gaiter_scan::Format;
use sha2::{Digest, Sha256};

use super::cells::Notation;
use super::file::{RecordFile, file, json};
use super::measure::csv;
use super::order::{Order, is_order_file, order_files};
use super::picture::figures;
use super::report_files::{self, FilesFault, ReportChoice};
use super::schema::FindingNote;
use super::statement::Statement;
use super::{Provenance, Record, compose};

/// The list of the hashes of all other files, in the format of `sha256sum -c`.
pub const SUMS: &str = "SHA256SUMS";

/// The record itself.
pub const RECORD: &str = "record.json";

/// The measures as the exact table for programs.
const MEASUREMENTS: &str = "measurements.csv";

/// The same table for a spreadsheet that is set to the language of the report.
const SPREADSHEET: &str = "measurements-spreadsheet.csv";

/// The file of a record that holds the scanner's own measures of the scan.
pub const ORD: &str = "scanner.ord";

/// The file that was measured.
#[derive(Debug, Clone, Copy)]
pub struct ScanFile<'a> {
    /// Its bytes.
    pub bytes: &'a [u8],
    /// Their format.
    pub format: Format,
    /// The scanner's own measures (`.ord`) that came with the scan, if any.
    pub ord: Option<&'a [u8]>,
}

/// Makes the record and all files of its folder, in the order in which they must be written:
/// `record.json` first, then the scan's own bytes and what came with it, and last `SHA256SUMS` over all
/// others. The same arguments give the same bytes. The scan's hash is taken from the provenance. If a
/// CAD file or the PDF report cannot be made, the record gets a finding.
///
/// # Errors
/// If a figure cannot be written as JSON.
pub fn record_files(
    extraction: &Extraction,
    provenance: &Provenance,
    method: &Method,
    output: &Output,
    choice: &ReportChoice,
    scan: ScanFile<'_>,
) -> Result<(Record, Vec<RecordFile>), FilesFault> {
    let (record, mut files) =
        files_beside_scan(extraction, provenance, method, output, choice, scan)?;
    add_scan(&mut files, scan.format, scan.bytes.to_vec());
    Ok((record, files))
}

/// As [`record_files`] without the scan's own bytes, for callers that have them elsewhere. They are
/// larger than all the other files together. `SHA256SUMS` lists them.
///
/// # Errors
/// As [`record_files`].
pub fn files_beside_scan(
    extraction: &Extraction,
    provenance: &Provenance,
    method: &Method,
    output: &Output,
    choice: &ReportChoice,
    scan: ScanFile<'_>,
) -> Result<(Record, Vec<RecordFile>), FilesFault> {
    let mut record = compose::record(extraction, provenance, method);
    let (surfaces, notes) = surface_files(extraction, output);
    record.findings.extend(notes);
    // Findings added from here on are not in any figure.
    let figures = figures::all(&record, choice.language);
    let paper = report_files::paper(&record, choice, &figures);
    let no_paper = paper.as_ref().err();
    record.findings.extend(no_paper.map(|fault| warning(fault.code(), fault.to_string())));
    let mut files = vec![file(RECORD, json(&record)?)];
    files.extend(tables(&record, choice)?);
    files.push(report_files::drawing(&figures, choice.language));
    files.push(report_files::page(&record, choice, &figures)?);
    files.extend(paper);
    if choice.figures {
        files.extend(report_files::figure_files(&figures));
    }
    files.extend(surfaces);
    files.extend(scan.ord.map(|ord| file(ORD, ord.to_vec())));
    let mut sums = sums_of(&files);
    sums.push_str(&sum(&provenance.sha256, &scan_name(scan.format)));
    files.push(file(SUMS, sums.into_bytes()));
    Ok((record, files))
}

/// The files of a revision that differs from the one before in what people set: what shows a measure is made
/// again from the record, everything else, such as scan and surfaces, stays as it is. The tables and the
/// files of the order are those of now: an earlier one would show measures that no longer count. `before` are
/// all files of the revision before except `SHA256SUMS`, in their order.
///
/// # Errors
/// If a figure cannot be written as JSON, or a file for people cannot be made.
pub fn amended_files(
    record: &Record,
    choice: &ReportChoice,
    before: Vec<RecordFile>,
) -> Result<Vec<RecordFile>, FilesFault> {
    let mut made = vec![file(RECORD, json(record)?)];
    made.extend(report_files::all(record, choice)?);
    let keep = |old: RecordFile| match made.iter().find(|new| new.name == old.name) {
        Some(new) => new.clone(),
        None => old,
    };
    let before = before.into_iter().filter(|old| !is_table(&old.name));
    let mut files: Vec<RecordFile> = before.map(keep).collect();
    let place = files.iter().position(|of| of.name == RECORD).map_or(files.len(), |at| at + 1);
    files.splice(place..place, tables(record, choice)?);
    files.push(file(SUMS, sums_of(&files).into_bytes()));
    Ok(files)
}

/// The measures as tables, and the files of the order.
fn tables(record: &Record, choice: &ReportChoice) -> Result<Vec<RecordFile>, serde_json::Error> {
    let ReportChoice { garment, language, sizes, orders, age_max, .. } = choice;
    let order =
        Order::from_record(record, garment, None, sizes.scanner_girth_mm).on(sizes.today, *age_max);
    let patient = record.patient.as_ref().map(|patient| patient.id.as_str());
    let measures = |notation| csv::table(record, garment, *language, notation).into_bytes();
    let mut files = vec![
        file(MEASUREMENTS, measures(Notation::exact(','))),
        file(SPREADSHEET, measures(Notation::spreadsheet(*language))),
    ];
    files.extend(order_files(&order, orders, *language, patient)?);
    Ok(files)
}

/// Whether a file of a record is one of those.
fn is_table(name: &str) -> bool {
    [MEASUREMENTS, SPREADSHEET].contains(&name) || is_order_file(name)
}

fn sums_of(files: &[RecordFile]) -> String {
    files.iter().map(|file| sum(&sha256(&file.bytes), &file.name)).collect()
}

/// Adds the scan's own bytes to [`files_beside_scan`], at their place before `SHA256SUMS`.
pub fn add_scan(files: &mut Vec<RecordFile>, format: Format, bytes: Vec<u8>) {
    files.insert(files.len().saturating_sub(1), file(&scan_name(format), bytes));
}

fn scan_name(format: Format) -> String {
    format!("scan.{}", format.ending())
}

/// Makes the files of each leg's surface, and the findings for those that cannot be made.
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
        leg: Some(side.word().to_owned()),
        says: Some(Statement::of_missing_file(name, fault)),
        ..warning(fault.code(), format!("{name} was not made: {fault}"))
    }
}

fn warning(code: &str, message: String) -> FindingNote {
    let (code, severity) = (code.to_owned(), Severity::Warning.word().to_owned());
    FindingNote { code, severity, leg: None, level: None, message, says: None }
}

/// SHA-256 of bytes, lower-case hexadecimal.
pub fn sha256(bytes: &[u8]) -> String {
    hex(&Sha256::digest(bytes))
}

/// Bytes as lower-case hexadecimal digits. From a table: with each read of the journal there are thousands.
pub fn hex(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 16] = b"0123456789abcdef";
    let digit = |nibble: u8| char::from(DIGITS[usize::from(nibble & 15)]);
    let mut digits = String::with_capacity(2 * bytes.len());
    for byte in bytes {
        digits.push(digit(byte >> 4));
        digits.push(digit(*byte));
    }
    digits
}

/// A file's line: hash, two spaces, name.
fn sum(sha256: &str, name: &str) -> String {
    format!("{sha256}  {name}\n")
}
