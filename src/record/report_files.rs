//! The files of a record that are made for people: its report as a page and on paper, and figures.

use std::collections::BTreeSet;

use super::file::{RecordFile, file};
use super::picture::figures::{self, Figure};
use super::picture::png::{PngFault, png};
use super::picture::{Theme, svg};
use super::report::{self, PdfFault};
use super::{Language, Record};

/// The report as a page.
const PAGE: &str = "report.html";

/// The report on paper.
const PAPER: &str = "report.pdf";

/// Both legs at a glance.
const DRAWING: &str = "legs.svg";

/// Pixels of a PNG a px of its picture: sharp on paper, 250 to the inch where a figure is as wide as
/// an A4 page.
const PNG_SCALE: f64 = 2.0;

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
    /// Pixels on white, for programs that show nothing else.
    Png,
}

/// Why a file cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum FilesFault {
    /// A figure of the record cannot be written as JSON.
    #[error(transparent)]
    Json(#[from] serde_json::Error),
    /// There is no report on paper.
    #[error(transparent)]
    Paper(#[from] PdfFault),
    /// There is no PNG of a figure.
    #[error(transparent)]
    Png(#[from] PngFault),
}

/// The report of a record: of the same record in the same language the same bytes, whether it was
/// just measured or read back.
///
/// # Errors
/// See [`FilesFault`].
pub fn report_files(record: &Record, language: Language) -> Result<Vec<RecordFile>, FilesFault> {
    let figures = figures::all(record, language);
    Ok(vec![page(record, language, &figures)?, paper(record, language, &figures)?])
}

pub(super) fn page(
    record: &Record,
    language: Language,
    figures: &[Figure],
) -> Result<RecordFile, serde_json::Error> {
    Ok(file(PAGE, report::page(record, language, figures)?.into_bytes()))
}

pub(super) fn paper(
    record: &Record,
    language: Language,
    figures: &[Figure],
) -> Result<RecordFile, PdfFault> {
    Ok(file(PAPER, report::paper(record, language, figures)?))
}

/// Both legs and their girths as one drawing, which practice software and pages show.
pub(super) fn drawing(figures: &[Figure], language: Language) -> RecordFile {
    file(DRAWING, svg::file(&figures::overview(figures, language)).into_bytes())
}

/// The figures as files of their own, in the notations that are wanted.
pub(super) fn figure_files(
    figures: &[Figure],
    formats: &BTreeSet<FigureFormat>,
) -> Result<Vec<RecordFile>, PngFault> {
    let files = figures.iter().flat_map(|figure| {
        formats.iter().map(move |format| {
            let (ending, bytes) = match format {
                FigureFormat::Svg => ("svg", svg::file(&figure.picture).into_bytes()),
                FigureFormat::Png => ("png", png(&figure.picture, Theme::Light, PNG_SCALE)?),
            };
            Ok(file(&format!("figure-{}.{ending}", figure.name), bytes))
        })
    });
    files.collect()
}
