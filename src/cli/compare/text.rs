//! A report of visits for a terminal.

use gaiter_record::report::content::{Section, Table, VerdictPart};
use gaiter_record::report::document::{Block, Document};
use gaiter_record::report::{Reliability, ReportFigure};

use crate::cli::terminal::screen::indented;
use crate::cli::terminal::{self, painted};

/// The report in lines of at most this many characters; pictures and what reports of visits do not have are left out.
pub(super) fn render(document: &Document, columns: usize) -> String {
    let head = &document.head;
    let mut text = format!("{}: {} · {}\n", head.title, head.patient, head.taken);
    for block in &document.blocks {
        text += &match block {
            Block::Verdict(of) => {
                let parts: Vec<String> = of.parts.iter().map(|of| part(of, columns)).collect();
                parts.join("\n")
            }
            Block::Section(of) => section(of, columns),
            Block::Table(of) => {
                let bold = document.head.language.text("visits.bold_in_text");
                let bold = has_bold(of).then(|| indented(bold, "  ", columns));
                table(of, columns) + &bold.unwrap_or_default()
            }
            _ => String::new(),
        };
    }
    text
}

fn part(of: &VerdictPart, columns: usize) -> String {
    let heading = of.heading.as_ref().map(|heading| format!("{heading}\n"));
    let sentences = of.sentences.iter().map(|sentence| indented(sentence, "  ", columns));
    heading.into_iter().chain(sentences).collect()
}

fn section(of: &Section, columns: usize) -> String {
    let entries: String =
        of.entries.iter().map(|sentence| indented(sentence, "  ", columns)).collect();
    format!("\n{}\n{entries}", of.title)
}

/// A table; its rows are broken between columns if they do not fit.
fn table(of: &Table, columns: usize) -> String {
    let cells: Vec<Vec<(String, Reliability)>> = of
        .rows
        .iter()
        .map(|row| {
            let head = (row.head.clone(), Reliability::Sure);
            std::iter::once(head).chain(row.figures.iter().map(figure)).collect()
        })
        .collect();
    let width = |column: usize| {
        let own =
            cells.iter().filter_map(|row| row.get(column)).map(|(cell, _)| cell.chars().count());
        own.chain(of.columns.get(column).map(|head| head.chars().count())).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..of.columns.len()).map(width).collect();
    let mut text = format!("\n{}\n", of.title);
    text.extend(of.explanation.as_ref().map(|sentence| indented(sentence, "  ", columns)));
    for part in parts(&widths, columns.saturating_sub(2)) {
        let head: Vec<(String, Reliability)> =
            of.columns.iter().map(|head| (head.clone(), Reliability::Sure)).collect();
        for row in std::iter::once(&head).chain(&cells) {
            text += &line(row, &widths, &part);
        }
    }
    text.extend(of.below.as_ref().map(|sentence| indented(sentence, "  ", columns)));
    text
}

/// Whether a change is shown in it, which the sheet has in bold.
fn has_bold(of: &Table) -> bool {
    of.rows.iter().flat_map(|row| &row.figures).any(|figure| figure.mark == Reliability::Real)
}

/// The columns of each part of a table that fits into this many characters; every part begins with the
/// first column.
fn parts(widths: &[usize], most: usize) -> Vec<Vec<usize>> {
    let first = widths.first().copied().unwrap_or(0);
    let mut parts: Vec<Vec<usize>> = Vec::new();
    let mut used = usize::MAX;
    for (column, width) in widths.iter().enumerate().skip(1) {
        if used.saturating_add(width + GAP) > most {
            parts.push(vec![0]);
            used = first;
        }
        used += width + GAP;
        parts.iter_mut().last().into_iter().for_each(|part| part.push(column));
    }
    parts
}

/// Blanks between two columns.
const GAP: usize = 2;

fn line(row: &[(String, Reliability)], widths: &[usize], columns: &[usize]) -> String {
    let mut line = String::from("  ");
    for (place, column) in columns.iter().enumerate() {
        let Some((cell, mark)) = row.get(*column) else { continue };
        let blanks = " ".repeat(widths[*column].saturating_sub(cell.chars().count()));
        let cell = match mark {
            Reliability::Real => painted(terminal::CARE, cell),
            _ => cell.clone(),
        };
        line += &match place {
            0 => format!("{cell}{blanks}"),
            _ => format!("{:GAP$}{blanks}{cell}", ""),
        };
    }
    line.trim_end().to_owned() + "\n"
}

/// A figure with its uncertainty and its sign; one that is shown to have changed ends in an exclamation mark,
/// because a terminal may have no colour.
fn figure(of: &ReportFigure) -> (String, Reliability) {
    let margin = of.margin.as_ref().map(|margin| format!(" ± {margin}")).unwrap_or_default();
    let sign = if of.mark == Reliability::Real { "!" } else { of.mark.sign() };
    (format!("{}{margin}{sign}", of.value), of.mark)
}
