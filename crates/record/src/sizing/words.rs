//! Verdicts of size tables in words.

use std::fmt::Display;

use gaiter_language::Language;
use gaiter_sizes::Point;
use gaiter_sizes::table::Status;
use gaiter_sizes::verdict::{Fit, PointVerdict, Reading, SizeVerdict};

use super::calibre::Stretch;
use super::{LegSizes, TableVerdict};
use crate::rounding::{cm_words, number, signed};
use crate::shown;

/// How many digits of a file's hash identify it within a clinic.
pub(crate) const HASH_DIGITS: usize = 12;

/// Probabilities this near to a deciding one, as shares, are shown with a decimal.
const NEAR: f64 = 0.005;

/// The sign of a table in a report: T1, T2 …. A letter alone would be that of a level.
pub(crate) fn sign(index: usize) -> String {
    format!("T{}", index + 1)
}

/// The sign with what a table may be used for, if it is not released: `T1 (test only)`.
pub fn marked(index: usize, table: &TableVerdict, language: Language) -> String {
    match table.status {
        Status::Released => sign(index),
        status => format!("{} ({})", sign(index), language.word("sizes.status", status.word())),
    }
}

/// Maker and product behind the sign.
pub fn heading(index: usize, table: &TableVerdict, language: Language) -> String {
    let (maker, product) = (shown::id(&table.maker), shown::id(&table.product));
    let words: [(&str, &dyn Display); 3] =
        [("sign", &marked(index, table, language)), ("maker", &maker), ("product", &product)];
    language.filled("sizes.table", &words)
}

/// What identifies the table: name, edition and the beginning of its hash.
pub fn identity(table: &TableVerdict, language: Language) -> String {
    let hash: String = table.sha256.chars().take(HASH_DIGITS).collect();
    let (id, edition) = (shown::id(&table.id), shown::id(&table.edition));
    language.filled("sizes.identity", &[("id", &id), ("edition", &edition), ("hash", &hash)])
}

/// What a reader must know before the verdicts of a table: what it may not be used for, that it is expired,
/// that it cannot be compared.
pub fn warnings(table: &TableVerdict, language: Language) -> Vec<String> {
    let mut sentences = Vec::new();
    match table.status {
        Status::TestOnly => sentences.push(language.text("sizes.warning.test-only").to_owned()),
        Status::Draft => sentences.push(language.text("sizes.warning.draft").to_owned()),
        Status::Released => {}
    }
    if let Some(last) = table.valid_until.filter(|_| table.is_expired) {
        sentences.push(language.filled("sizes.warning.expired", &[("date", &last)]));
    }
    let why = table.not_comparable;
    sentences.extend(why.map(|why| language.word("sizes.not_comparable", why.word()).to_owned()));
    sentences
}

/// A size with its variant: `II`, `II, wide thigh`.
pub fn size(of: &SizeVerdict, language: Language) -> String {
    match &of.variant {
        None => shown::id(&of.size),
        Some(variant) => {
            let (size, variant) = (shown::id(&of.size), shown::id(variant));
            language.filled("sizes.variant", &[("size", &size), ("variant", &variant)])
        }
    }
}

/// A verdict, with the points that contradict it or are missing for it.
pub fn fit(fit: Fit, points: &[PointVerdict], language: Language) -> String {
    let verdict = language.word("sizes.fit", fit.word());
    let key = match fit {
        Fit::DoesNotFit => "sizes.outside",
        Fit::NotDecided => "sizes.missing",
        Fit::FitsWithinUncertainty | Fit::Fits => return verdict.to_owned(),
    };
    let named = points.iter().filter(|of| of.is_required && of.fit == fit);
    let points: Vec<String> = named.map(|of| of.point.to_string()).collect();
    if points.is_empty() {
        return verdict.to_owned();
    }
    language.filled(key, &[("verdict", &verdict), ("points", &points.join(", "))])
}

/// How far a value lies above the lower and below the upper limit, cm: `+0.4 / −0.1`. The sign of a margin
/// that is rounded to zero stays: it shows on which side of the limit the value lies.
pub fn margins(margins_mm: [f64; 2], language: Language) -> String {
    margins_mm.map(|mm| margin(mm, language)).join(" / ")
}

fn margin(mm: f64, language: Language) -> String {
    let text = signed(mm, &cm_words(mm, language));
    match text.starts_with(['+', '\u{2212}']) || mm == 0.0 {
        true => text,
        false if mm < 0.0 => format!("\u{2212}{text}"),
        false => format!("+{text}"),
    }
}

/// A probability in per cent. Next to a deciding one it has a decimal, so that 94.9 % is not shown as 95 %.
pub(crate) fn percent(share: f64, language: Language) -> String {
    use gaiter_sizes::verdict::{SURE, UNLIKELY};
    let is_near = [SURE, UNLIKELY].iter().any(|limit| (share - limit).abs() < NEAR);
    match 100.0 * share {
        most if most > 99.0 => ">\u{a0}99\u{a0}%".to_owned(),
        least if least < 1.0 => "<\u{a0}1\u{a0}%".to_owned(),
        percent if is_near => format!("{}\u{a0}%", number(percent, 1, language)),
        percent => format!("{}\u{a0}%", number(percent, 0, language)),
    }
}

/// The probability of a point, or that its value alone counts.
pub fn inside(of: &PointVerdict, language: Language) -> String {
    match of.probability {
        Some(share) => percent(share, language),
        None => language.text("sizes.value_alone").to_owned(),
    }
}

/// Why a point has no value, in the place of its margins; `None` if it has one.
pub fn not_given(of: &PointVerdict, language: Language) -> Option<&'static str> {
    match of.reading {
        Reading::Given(_) => None,
        Reading::NotGiven { why } => language.find(&format!("sizes.not_given.{}", why.word())),
    }
}

/// The article codes of a size in one text; `None` if it has none.
pub fn codes(of: &SizeVerdict, language: Language) -> Option<String> {
    let code = |code: &gaiter_sizes::table::Code| match &code.length {
        Some(length) => format!("{} ({})", shown::id(&code.code), shown::id(length)),
        None => shown::id(&code.code),
    };
    let codes: Vec<String> = of.codes.iter().map(code).collect();
    (!codes.is_empty()).then(|| language.filled("sizes.codes", &[("codes", &codes.join(", "))]))
}

/// What sizes and lengths of a table allow together for a leg, and what the deciding point leaves out:
/// `T1: fits. Left out by cB: I, III.`
pub fn together(index: usize, table: &TableVerdict, leg: &LegSizes, language: Language) -> String {
    let verdict = language.word("sizes.fit", leg.verdict.fit.word());
    let sign = marked(index, table, language);
    let together = language.filled("sizes.together", &[("sign", &sign), ("verdict", &verdict)]);
    let left_out = left_out(table, leg, language).map(|text| format!(" {text}."));
    together + &left_out.unwrap_or_default()
}

/// The sizes that the deciding point does not allow, in a line; `None` if it allows all.
fn left_out(table: &TableVerdict, leg: &LegSizes, language: Language) -> Option<String> {
    let point = table.decides?;
    let (allowed, not): (Vec<_>, Vec<_>) = leg.verdict.sizes.iter().partition(|of| of.is_candidate);
    if allowed.is_empty() {
        let sizes = nearest(leg, point, language).join(", ");
        let words: [(&str, &dyn Display); 2] = [("point", &point), ("sizes", &sizes)];
        return Some(language.filled("sizes.none_allowed", &words));
    }
    let mut names: Vec<String> = not.into_iter().map(|of| shown::id(&of.size)).collect();
    names.dedup();
    let words: [(&str, &dyn Display); 2] = [("point", &point), ("sizes", &names.join(", "))];
    (!names.is_empty()).then(|| language.filled("sizes.left_out", &words))
}

/// The sizes whose ranges of a point are nearest to the leg below and above it: `II (−0.1)`.
fn nearest(leg: &LegSizes, point: Point, language: Language) -> Vec<String> {
    let own = leg.verdict.sizes.iter().filter(|of| of.variant.is_none());
    let margins = own.filter_map(|of| {
        let its = of.points.iter().find(|of| of.point == point)?;
        Some((of, its.margins_mm?))
    });
    let margins: Vec<(&SizeVerdict, [f64; 2])> = margins.collect();
    // Outside a range, exactly one of the two margins is negative.
    let side = |index: usize| {
        let outside = margins.iter().filter(|(_, margins_mm)| margins_mm[index] < 0.0);
        outside.max_by(|(_, a), (_, b)| a[index].total_cmp(&b[index])).map(|(of, margins_mm)| {
            format!("{} ({})", shown::id(&of.size), margin(margins_mm[index], language))
        })
    };
    [1, 0].into_iter().filter_map(side).collect()
}

/// The calibre jumps in sentences; if there is none, the largest change.
pub fn calibre(stretches: &[Stretch], language: Language) -> Vec<String> {
    let jumps: Vec<String> = stretches
        .iter()
        .filter(|of| of.is_jump)
        .map(|of| stretch("sizes.calibre.jump", of, language))
        .collect();
    let largest = stretches.iter().max_by(|a, b| a.per_length.total_cmp(&b.per_length));
    match (jumps.is_empty(), largest) {
        (false, _) => jumps,
        (true, Some(largest)) => vec![stretch("sizes.calibre.none", largest, language)],
        (true, None) => vec![language.text("sizes.calibre.unknown").to_owned()],
    }
}

fn stretch(key: &'static str, of: &Stretch, language: Language) -> String {
    let leg = match of.is_jump {
        true => language.word("leg.heading", of.side),
        false => language.word("leg", of.side),
    };
    // As every uncertainty of the report: two standard errors, rounded up.
    let margin = of.per_length_sd.map(|sd| (200.0 * sd).ceil() / 100.0);
    let margin = margin.map(|of| format!(" ± {}", number(of, 2, language))).unwrap_or_default();
    let ratio = format!("{}{margin}", number(of.per_length, 2, language));
    let change = signed(of.girth_change_mm, &cm_words(of.girth_change_mm, language));
    let words: [(&str, &dyn Display); 6] = [
        ("leg", &leg),
        ("from", &of.from),
        ("to", &of.to),
        ("ratio", &ratio),
        ("change", &change),
        ("length", &cm_words(of.length_mm, language)),
    ];
    language.filled(key, &words)
}
