//! The verdicts of size tables for a terminal.

use std::fmt::{Display, Write};

use anstyle::Style;
use gaiter_language::Language;
use gaiter_record::rounding::{cm_margin, cm_words, limit_words, number, shortest};
use gaiter_record::sizing::{LegSizes, SizeVerdicts, TableVerdict, words};
use gaiter_sizes::Garment;
use gaiter_sizes::verdict::{Fit, PointVerdict, Reading, SURE, UNLIKELY};

use crate::cli::terminal::screen::indented;
use crate::cli::terminal::{self, painted};

/// Widths of the columns of points, characters: point, measure, limits, margins, probability.
const WIDTHS: [usize; 5] = [6, 15, 13, 17, 10];

/// The verdicts in lines of at most this many characters.
pub fn render(
    verdicts: &SizeVerdicts,
    garment: &Garment,
    language: Language,
    columns: usize,
) -> String {
    let title = language.text("sizes.title");
    let mut text = format!("{title}: {}, {}\n", garment.title(language.tag()), verdicts.today);
    let mut line = |sentence: &str| text.push_str(&indented(sentence, "  ", columns));
    if verdicts.tables.is_empty() {
        line(language.text("sizes.no_tables"));
    }
    for (index, table) in verdicts.tables.iter().enumerate() {
        line(&words::heading(index, table, language));
        line(&words::identity(table, language));
        words::warnings(table, language).iter().for_each(|sentence| line(sentence));
    }
    let has_legs = verdicts.tables.iter().any(|table| !table.legs.is_empty());
    if has_legs {
        reading_help(verdicts, language).iter().for_each(|sentence| line(sentence));
    }
    for side in gaiter_leg::Side::FROM_FRONT {
        text += &leg(verdicts, side.word(), language, columns);
    }
    text += &calibre(verdicts, language, columns);
    text
}

/// How to read the figures.
fn reading_help(verdicts: &SizeVerdicts, language: Language) -> Vec<String> {
    let percent = |share: f64| number(100.0 * share, 0, language);
    let limits: [(&str, &dyn Display); 2] =
        [("sure", &percent(SURE)), ("unlikely", &percent(UNLIKELY))];
    let mut sentences = vec![language.filled("sizes.explanation", &limits)];
    if verdicts.has(|of| !of.is_required) {
        sentences.push(language.text("sizes.not_required").to_owned());
    }
    if verdicts.has(PointVerdict::is_by_hand) {
        let mm = shortest(verdicts.tape_girth_mm, language);
        sentences.push(language.filled("sizes.tape", &[("mm", &mm)]));
    }
    if verdicts.scanner_girth_mm > 0.0 {
        let mm = shortest(verdicts.scanner_girth_mm, language);
        sentences.push(language.filled("sizes.common", &[("mm", &mm)]));
    }
    sentences
}

/// The verdicts of all tables on a leg.
fn leg(verdicts: &SizeVerdicts, side: &str, language: Language, columns: usize) -> String {
    let tables = verdicts.tables.iter().enumerate();
    let legs: Vec<(usize, &TableVerdict, &LegSizes)> = tables
        .filter_map(|(index, table)| {
            Some((index, table, table.legs.iter().find(|of| of.side == side)?))
        })
        .collect();
    if legs.is_empty() {
        return String::new();
    }
    let mut text = format!("\n{}\n{}", language.word("leg.heading", side), heads(language));
    for (index, table, leg) in legs {
        text += &of_table(index, table, leg, language, columns);
    }
    text
}

/// The headings of the columns of points.
fn heads(language: Language) -> String {
    let heads = ["sizes.point", "sizes.measure", "sizes.limits", "sizes.margins", "sizes.inside"];
    row(&heads.map(|key| language.text(key).to_owned()))
}

fn row(cells: &[String; 5]) -> String {
    let [point, rest @ ..] = cells;
    let mut text = format!("    {point:<0$}", WIDTHS[0]);
    for (cell, width) in rest.iter().zip(&WIDTHS[1..]) {
        let _ = write!(text, "{cell:>width$}");
    }
    text.trim_end().to_owned() + "\n"
}

/// The candidates of a table for a leg, its lengths, and both together.
fn of_table(
    index: usize,
    table: &TableVerdict,
    leg: &LegSizes,
    language: Language,
    columns: usize,
) -> String {
    let sign = words::marked(index, table, language);
    let verdict = &leg.verdict;
    let mut text = String::new();
    let mut entry = |name: &str, fit: Fit, fit_words: &str, points: &[PointVerdict]| {
        let line = indented(&format!("{sign} · {name}: {fit_words}"), "  ", columns);
        text.extend(line.lines().map(|line| painted(colour(fit), line) + "\n"));
        text.extend(points.iter().map(|of| point(of, language)));
    };
    for of in verdict.sizes.iter().filter(|of| of.is_candidate) {
        let codes =
            words::codes(of, language).map(|codes| format!("; {codes}")).unwrap_or_default();
        let fit_words = words::fit(of.fit, &of.points, language) + &codes;
        entry(&words::size(of, language), of.fit, &fit_words, &of.points);
    }
    for of in &verdict.lengths {
        let name = language.filled("sizes.length", &[("name", &of.length)]);
        entry(&name, of.fit, &words::fit(of.fit, &of.points, language), &of.points);
    }
    text + &indented(&words::together(index, table, leg, language), "  ", columns)
}

/// The colour of a verdict, which only repeats its words.
fn colour(fit: Fit) -> Style {
    match fit {
        Fit::Fits => terminal::GOOD,
        Fit::FitsWithinUncertainty | Fit::NotDecided => terminal::CARE,
        Fit::DoesNotFit => terminal::BAD,
    }
}

fn point(of: &PointVerdict, language: Language) -> String {
    let cm = |mm: f64| cm_words(mm, language);
    let name = of.point.to_string();
    let name = match of.is_required {
        true => name,
        false => format!("[{name}]"),
    };
    let limits = of.limits_mm.map(|mm| limit_words(mm, language)).join("–");
    match (of.reading, of.margins_mm) {
        (Reading::Given(given), Some(margins_mm)) => {
            let sign = if given.is_by_hand { "*" } else { "" };
            let margin = given.uncertainty_mm.map(|mm| number(cm_margin(mm), 1, language));
            let margin = margin.map(|of| format!(" ± {of}")).unwrap_or_default();
            row(&[
                name,
                format!("{sign}{}{margin}", cm(given.mm)),
                limits,
                words::margins(margins_mm, language),
                words::inside(of, language),
            ])
        }
        _ => {
            let why = words::not_given(of, language).unwrap_or_default();
            let (first, second) = (WIDTHS[0], WIDTHS[1] + WIDTHS[2]);
            let limits = format!("{limits:>0$}", second);
            format!("    {name:<first$}{limits}  {why}\n")
        }
    }
}

/// The calibre jumps of both legs.
fn calibre(verdicts: &SizeVerdicts, language: Language, columns: usize) -> String {
    let mut text = format!("\n{}\n", language.text("sizes.calibre.title"));
    for sentence in words::calibre(&verdicts.calibre, language) {
        text += &indented(&sentence, "  ", columns);
    }
    text + &indented(language.text("sizes.calibre.explanation"), "  ", columns)
}
