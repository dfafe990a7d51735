//! How to read the figures of a report of visits: only those in it.

use std::fmt::Display;

use gaiter_leg::Side;
use gaiter_leg::levels::at_height::PROFILE_STEP_MM;
use gaiter_record::rounding::{number, shortest};

use super::words::Words;
use crate::comparison::Comparison;
use crate::course::{Course, Group};
use crate::excess::Reduction;
use crate::place::along_mm;

/// How to read the comparisons of a group of visits.
pub(super) fn legend(words: &Words, group: &Group, compared: &[Comparison]) -> Vec<String> {
    let legs = || compared.iter().flat_map(|of| Side::BOTH.map(|side| (of, side)));
    let is_of_girths = legs().any(|(of, side)| !of.girths(side).is_empty());
    let is_of_volumes = legs().any(|(of, side)| of.volume(side).is_some());
    let mut sentences: Vec<String> = Vec::new();
    sentences.extend(is_of_girths.then(|| words.text("visits.legend_girths")));
    sentences.extend(volumes(words, group));
    let percentages = percentages(words, group, compared, is_of_volumes);
    sentences.extend((!percentages.is_empty()).then_some(percentages));
    if is_of_girths || is_of_volumes {
        let mm = shortest(words.course.choice.girth_common_mm, words.language);
        sentences.push(words.filled("visits.legend_uncertainty", &[("mm", &mm)]));
        sentences.extend(bound(words, group));
        sentences.push(words.text("visits.legend_limits"));
    }
    sentences
}

/// Which volumes are reported; nothing if there are none.
fn volumes(words: &Words, group: &Group) -> Option<String> {
    let cm = |mm: f64| number(mm / 10.0, 0, words.language);
    let of = |side: Side| {
        let pieces = group.pieces.get(side);
        let (low, high) = (pieces.first()?, pieces.last()?);
        let values: [(&str, &dyn Display); 3] = [
            ("leg", &words.leg_in_sentence(side)),
            ("from", &cm(along_mm(*low))),
            ("to", &cm(along_mm(*high) + PROFILE_STEP_MM)),
        ];
        Some(words.filled("visits.legend_range", &values))
    };
    let ranges: Vec<String> = Side::FROM_FRONT.into_iter().filter_map(of).collect();
    let method = words.language.word("visits.volume_by", group.volume.word());
    let values: [(&str, &dyn Display); 2] = [("method", &method), ("ranges", &ranges.join(", "))];
    (!ranges.is_empty()).then(|| words.filled("visits.legend_volumes", &values))
}

/// What the percentages and the excess are.
fn percentages(
    words: &Words,
    group: &Group,
    compared: &[Comparison],
    is_of_volumes: bool,
) -> String {
    let course: &Course = words.course;
    let excesses: Vec<f64> = group
        .visits
        .iter()
        .filter_map(|visit| Some(course.excess(group, *visit)?.ml.value))
        .collect();
    let reductions: Vec<Reduction> =
        compared.iter().filter_map(|of| of.excess.as_ref()?.reduction.ok()).collect();
    words.joined(&[
        (is_of_volumes, "visits.legend_percent"),
        (!excesses.is_empty(), "visits.legend_excess"),
        (excesses.iter().any(|ml| *ml < 0.0), "visits.legend_excess_negative"),
        (!reductions.is_empty(), "visits.legend_reduction"),
        (reductions.iter().any(|of| of.percent < 0.0), "visits.legend_reduction_negative"),
        (is_of_volumes && !reductions.is_empty(), "visits.legend_not_interchangeable"),
    ])
}

/// What part of the last visit's volumes the errors are that all girths of a scan have in common.
fn bound(words: &Words, group: &Group) -> Option<String> {
    let last = *group.visits.last()?;
    let share = |side: Side| {
        let volume = words.course.volume(group, last, side)?;
        let percent = number(100.0 * volume.parts.common() / volume.value, 2, words.language);
        Some(format!("{} {percent} %", words.leg_in_sentence(side)))
    };
    let shares: Vec<String> = Side::FROM_FRONT.into_iter().filter_map(share).collect();
    let all = shares.join(", ");
    (!shares.is_empty()).then(|| words.filled("visits.legend_bound", &[("shares", &all)]))
}
