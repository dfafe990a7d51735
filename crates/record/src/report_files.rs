//! The files of a record for people: its report as a page and as a PDF, and figures.

use gaiter_language::Language;
use gaiter_sizes::{Garment, Mapping};
use serde::{Deserialize, Serialize};

use super::Record;
use super::file::{RecordFile, file};
use super::picture::figures::{self, DrawnFigure};
use super::picture::svg;
use super::report::{self, AgeMax, Document, PdfFault, Print, ReportContent};
use super::sizing::{SizeChoice, SizeVerdicts};

const PAGE: &str = "report.html";

const PAPER: &str = "report.pdf";

/// Both legs at a glance.
const DRAWING: &str = "legs.svg";

/// Which files for people are made of a record.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct ReportChoice {
    /// The language of the report and its figures.
    pub language: Language,
    /// The garment that is ordered: the sheet states which measures are missing.
    pub garment: Garment,
    /// What the report is printed on, and how much of it.
    pub print: Print,
    /// Whether each figure also gets a file of its own.
    pub figures: bool,
    /// How old the scan may be for an order.
    pub age_max: AgeMax,
    /// The size tables that the report shows, and the day on which it does.
    pub sizes: SizeChoice,
    /// The files of the order for makers and shop systems, besides gaiter's own.
    pub orders: Vec<Mapping>,
}

/// Why a file cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum FilesFault {
    /// A figure of the record cannot be written as JSON.
    #[error(transparent)]
    Json(#[from] serde_json::Error),
    /// The PDF cannot be made.
    #[error(transparent)]
    Paper(#[from] PdfFault),
}

/// The report of a record. The same record with the same choice gives the same bytes, whether it was
/// just measured or read back.
///
/// # Errors
/// See [`FilesFault`].
pub fn report_files(record: &Record, choice: &ReportChoice) -> Result<Vec<RecordFile>, FilesFault> {
    let figures = figures::all(record, choice.language);
    Ok(vec![page(record, choice, &figures)?, paper(record, choice, &figures)?])
}

/// Every file for people with the record's measures: the report, the drawing, and each figure.
pub(super) fn all(record: &Record, choice: &ReportChoice) -> Result<Vec<RecordFile>, FilesFault> {
    let figures = figures::all(record, choice.language);
    let mut files = vec![page(record, choice, &figures)?, paper(record, choice, &figures)?];
    files.push(drawing(&figures, choice.language));
    files.extend(figure_files(&figures));
    Ok(files)
}

pub(super) fn page(
    record: &Record,
    choice: &ReportChoice,
    figures: &[DrawnFigure],
) -> Result<RecordFile, serde_json::Error> {
    Ok(file(
        PAGE,
        report::page(&document(record, choice, figures), choice.print.paper)?.into_bytes(),
    ))
}

pub(super) fn paper(
    record: &Record,
    choice: &ReportChoice,
    figures: &[DrawnFigure],
) -> Result<RecordFile, PdfFault> {
    Ok(file(PAPER, report::paper(&document(record, choice, figures), choice.print)?))
}

fn document(record: &Record, choice: &ReportChoice, figures: &[DrawnFigure]) -> Document {
    let ReportChoice { language, garment, sizes, age_max, .. } = choice;
    let sizes = SizeVerdicts::new(record, garment, sizes);
    let content = ReportContent::with_sizes(record, *language, garment, &sizes, *age_max);
    content.document(record, figures)
}

/// Both legs and their girths as one drawing, shown by practice software and pages.
pub(super) fn drawing(figures: &[DrawnFigure], language: Language) -> RecordFile {
    file(DRAWING, figures::overview(figures, language).into_bytes())
}

/// The figures as files of their own.
pub(super) fn figure_files(figures: &[DrawnFigure]) -> Vec<RecordFile> {
    let svg = |figure: &DrawnFigure| {
        let drawn = svg::file(&figure.picture.title, figure.picture.size, &figure.marks);
        file(&format!("figure-{}.svg", figure.name), drawn.into_bytes())
    };
    figures.iter().map(svg).collect()
}
