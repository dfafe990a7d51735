//! What a comparison of visits shows, in sentences.

use std::fmt::Display;

use gaiter_leg::Side;
use gaiter_record::report::content::VerdictPart;
use gaiter_record::report::grouped;
use gaiter_record::rounding::shortest;

use super::ReportOf;
use super::words::Words;
use crate::caution::Caution;
use crate::comparison::Comparison;
use crate::course::{Affected, Group};
use crate::excess::{ExcessChange, NoReduction};
use crate::left_out::LeftOut;
use crate::quantity::{Change, Shown};
use crate::threshold::{Limited, Reached, verdicts};

impl ReportOf<'_> {
    /// What the last visit shows, compared with the first and with the one before it: a part for each pair of days.
    pub(super) fn summary(&self, words: &Words) -> Vec<VerdictPart> {
        let Some(group) = self.course.last_group() else { return Vec::new() };
        let compared = self.course.last_compared(group);
        let affected = self.course.affected_word();
        let affected = words.language.word("visits.affected", affected).to_owned();
        // Where none is named, it is no news, and comes last.
        let is_named = matches!(self.course.choice.affected, Some(Affected::One(_)))
            || self.course.is_affected_unreadable;
        let (mut before, mut last) = (Vec::new(), Vec::new());
        // What both comparisons share: it belongs to the last visit.
        if let Some(of) = compared.first() {
            last.extend(self.of_thresholds(words, of, |limited| limited == Limited::Excess));
            // That the later visit is not the last one.
            let [_, date] = words.days(of);
            let key = "visits.stand_in_later";
            last.extend(of.stand_ins.later.then(|| words.filled(key, &[("date", &date)])));
        }
        if compared.is_empty() {
            last.push(words.text("visits.alone"));
        }
        let place = if is_named { &mut before } else { &mut last };
        place.push(affected);
        last.extend(self.age(words));
        let pairs = compared.iter().map(|of| VerdictPart {
            heading: Some(between(words, of)),
            sentences: self.of_comparison(words, group, of),
        });
        let alone = |sentences: Vec<String>| VerdictPart { heading: None, sentences };
        let parts = [alone(before)].into_iter().chain(pairs).chain([alone(last)]);
        parts.filter(|part| !part.sentences.is_empty()).collect()
    }

    fn of_comparison(&self, words: &Words, group: &Group, of: &Comparison) -> Vec<String> {
        let legs = words.affected_first().into_iter();
        let mut sentences: Vec<String> = legs.filter_map(|side| volume(words, of, side)).collect();
        if of.is_of_other_posture() {
            let posture = words.caution(of, &Caution::Posture);
            sentences.push(format!("{}: {posture}", between(words, of)));
        }
        let apart = match &of.excess {
            Some(change) => Some(excess(words, change)),
            None => difference(words, group, of),
        };
        sentences.extend(apart.map(|apart| match cancelling(words, of) {
            Some(why) => format!("{apart} {why}"),
            None => apart,
        }));
        sentences.extend(self.of_thresholds(words, of, |limited| limited != Limited::Excess));
        // What depends on the earlier visit, where it replaces a record that is left out.
        let [date, _] = words.days(of);
        let key = "visits.stand_in_earlier";
        sentences.extend(of.stand_ins.earlier.then(|| words.filled(key, &[("date", &date)])));
        sentences
    }

    /// The verdicts of those of the clinic's thresholds that limit such a figure.
    fn of_thresholds(
        &self,
        words: &Words,
        of: &Comparison,
        is_such: impl Fn(Limited) -> bool,
    ) -> Vec<String> {
        let verdicts = verdicts(self.thresholds, of).into_iter();
        let verdicts = verdicts.filter(|verdict| is_such(verdict.threshold.of));
        let sentences = verdicts.map(|verdict| {
            let key = match verdict.reached() {
                Reached::Yes => "visits.threshold.reached",
                Reached::No => "visits.threshold.not_reached",
                Reached::Open => "visits.threshold.open",
            };
            let of = verdict.threshold;
            let values: [(&str, &dyn Display); 6] = [
                ("leg", &words.leg(verdict.side)),
                ("name", &of.name),
                ("source", &of.source),
                ("of", &words.language.word("visits.limited", of.of.word())),
                ("limit", &format!("{} {}", shortest(of.limit, words.language), of.of.unit())),
                ("value", &format!("{} {}", words.percent_change(verdict.value), of.of.unit())),
            ];
            words.filled(key, &values)
        });
        sentences.collect()
    }

    /// The records that are left out, with the reason.
    pub(super) fn left_out(&self, words: &Words) -> Vec<String> {
        let sentence = |of: &LeftOut| {
            let day = self.course.seen(of).local();
            let day = day.strftime(words.language.text("visits.day")).to_string();
            let why = words.language.word("visits.left_out", of.code);
            words.filled("visits.left_out_of", &[("date", &day), ("scan", &of.scan), ("why", &why)])
        };
        self.course.left_out.iter().map(sentence).collect()
    }

    /// How old the last scan is.
    fn age(&self, words: &Words) -> Option<String> {
        let acquired = self.course.visits.last()?.acquired.as_ref()?;
        let days = acquired.age_days(self.today);
        let key = if days > i64::from(self.age_max.0) { "visits.too_old" } else { "visits.age" };
        Some(words.filled(key, &[("days", &days), ("most", &self.age_max.0)]))
    }

    /// Reasons for caution in the comparisons, and where visits cannot be compared.
    pub(super) fn cautions(&self, words: &Words) -> Vec<String> {
        let mut sentences: Vec<String> = Vec::new();
        for pair in self.course.groups.windows(2) {
            let [before, after] = [&pair[0], &pair[1]];
            let means = |group: &Group| {
                let girths = &self.course.visits[group.visits[0]].definition.girths;
                let volume = words.language.word("visits.volume_by", group.volume.word());
                format!("{girths}; {volume}")
            };
            let values: [(&str, &dyn Display); 3] = [
                ("date", &words.day(after.visits[0])),
                ("before", &means(before)),
                ("after", &means(after)),
            ];
            sentences.push(words.filled("visits.break", &values));
        }
        let Some(group) = self.course.last_group() else { return sentences };
        // What holds for several comparisons is stated once.
        let compared = self.course.last_compared(group);
        let all = compared.iter().flat_map(|of| {
            let placed = move |caution| (words.caution(of, caution), between(words, of));
            of.cautions.iter().map(placed)
        });
        let all = grouped(all).into_iter();
        sentences.extend(all.map(|(text, pairs)| format!("{}: {text}", pairs.join(", "))));
        sentences
    }
}

/// The days of a comparison.
pub(super) fn between(words: &Words, of: &Comparison) -> String {
    let [earlier, later] = words.days(of);
    words.filled("visits.between", &[("earlier", &earlier), ("later", &later)])
}

/// Why the legs' difference is reported where no change of either leg is shown.
pub(super) fn cancelling(words: &Words, of: &Comparison) -> Option<String> {
    let volumes = Side::BOTH.map(|side| of.volume(side));
    let is_shown = volumes.into_iter().flatten().any(|of| of.shown() != Shown::NoChange);
    let is_reported = of.excess.is_some() || of.left_minus_right.is_some();
    (is_reported && !is_shown).then(|| words.text("visits.cancels"))
}

fn volume(words: &Words, of: &Comparison, side: Side) -> Option<String> {
    let change = of.volume(side)?;
    let [printed, _] = words.printed(&change);
    let [percent, detectable] = words.printed_percent(&change);
    let values: [(&str, &dyn Display); 4] = [
        ("leg", &words.leg(side)),
        ("ml", &printed),
        ("percent", &percent),
        ("detectable", &detectable),
    ];
    Some(words.language.filled_word("visits.volume", change.shown().word(), &values))
}

fn excess(words: &Words, change: &ExcessChange) -> String {
    let only = |side: Side| words.language.word("leg.only", side.word());
    let [printed, detectable] = words.printed(&change.change);
    let ends = [change.earlier.ml.value, change.later.ml.value];
    let [before, after] = ends.map(|ml| words.ml_change(ml));
    let values: [(&str, &dyn Display); 6] = [
        ("side", &only(change.later.affected)),
        ("ml", &printed),
        ("before", &before),
        ("after", &after),
        ("other_side", &only(change.later.affected.other())),
        ("detectable", &detectable),
    ];
    if change.reduction == Err(NoReduction::SmallerLeg) {
        return words.filled("visits.smaller_leg", &values);
    }
    let shown = words.language.filled_word("visits.excess", change.change.shown().word(), &values);
    let reduction = match &change.reduction {
        Ok(reduction) => {
            let [percent, margin] = words.reduction(reduction);
            words.filled("visits.reduction", &[("percent", &percent), ("margin", &margin)])
        }
        // The sentence before it states that already.
        Err(NoReduction::NoChange) => return shown,
        Err(why) => words.language.word("visits.no_reduction", why.word()).to_owned(),
    };
    format!("{shown} {reduction}")
}

/// The difference of the legs where no excess of one is reported.
fn difference(words: &Words, group: &Group, of: &Comparison) -> Option<String> {
    let change: Change = of.left_minus_right?;
    let at = |visit: usize| words.course.left_minus_right(group, visit);
    let [before, after] =
        [at(of.earlier)?, at(of.later)?].map(|volume| words.ml_change(volume.value));
    let [printed, detectable] = words.printed(&change);
    let values: [(&str, &dyn Display); 4] =
        [("ml", &printed), ("before", &before), ("after", &after), ("detectable", &detectable)];
    let key = match change.shown() {
        Shown::Larger | Shown::Smaller => "visits.difference",
        Shown::NoChange => "visits.difference_unchanged",
    };
    Some(words.filled(key, &values))
}
