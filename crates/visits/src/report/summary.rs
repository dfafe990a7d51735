//! What a comparison of visits shows, in sentences.

use std::collections::BTreeSet;
use std::fmt::Display;

use gaiter_leg::Side;
use gaiter_leg::levels::at_height::PROFILE_STEP_MM;
use gaiter_record::rounding::{number, shortest, tenths_words};

use super::ReportOf;
use super::words::Words;
use crate::caution::Caution;
use crate::comparison::Comparison;
use crate::course::{Affected, Group};
use crate::excess::{ExcessChange, NoReduction};
use crate::left_out::LeftOut;
use crate::place::along_mm;
use crate::quantity::{Change, Shown};
use crate::threshold::{Reached, verdicts};

impl ReportOf<'_> {
    /// What the last visit shows, compared with the first and with the one before it.
    pub(super) fn summary(&self, words: &Words) -> Vec<String> {
        let Some(group) = self.course.last_group() else { return Vec::new() };
        let compared = self.course.last_compared(group);
        let mut said: Vec<String> =
            compared.iter().flat_map(|of| self.of_comparison(words, group, of)).collect();
        for of in &compared {
            said.extend(stand_ins(words, of));
        }
        // What both comparisons share stands once.
        let mut known = BTreeSet::new();
        said.retain(|sentence| known.insert(sentence.clone()));
        if compared.is_empty() {
            said.push(words.text("visits.alone"));
        }
        let affected = self.course.choice.affected.map_or(Affected::NOT_NAMED, Affected::word);
        said.push(words.language.word("visits.affected", affected).to_owned());
        said.extend(self.age(words));
        said
    }

    fn of_comparison(&self, words: &Words, group: &Group, of: &Comparison) -> Vec<String> {
        let volumes =
            Side::FROM_FRONT.into_iter().filter_map(|side| volume(words, group, of, side));
        let mut said: Vec<String> = volumes.collect();
        if of.is_of_other_posture() {
            let posture = words.caution(of, &Caution::Posture);
            said.push(format!("{}: {posture}", between(words, of)));
        }
        said.extend(match &of.excess {
            Some(change) => Some(excess(words, of, change)),
            None => difference(words, group, of),
        });
        let verdicts = verdicts(self.thresholds, of);
        said.extend(verdicts.iter().map(|verdict| {
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
        }));
        said
    }

    /// The records that are left out, with the reason.
    pub(super) fn left_out(&self, words: &Words) -> Vec<String> {
        let said = |of: &LeftOut| {
            let day = self.course.seen(of).local();
            let day = day.strftime(words.language.text("visits.day")).to_string();
            let why = words.language.word("visits.left_out", of.code);
            let values: [(&str, &dyn Display); 3] =
                [("date", &day), ("scan", &of.scan), ("why", &why)];
            words.filled("visits.left_out_of", &values)
        };
        self.course.left_out.iter().map(said).collect()
    }

    /// How old the last scan is.
    fn age(&self, words: &Words) -> Option<String> {
        let acquired = self.course.visits.last()?.acquired.as_ref()?;
        let days = acquired.age_days(self.today);
        let key = if days > i64::from(self.age_max.0) { "visits.too_old" } else { "visits.age" };
        let values: [(&str, &dyn Display); 2] = [("days", &days), ("most", &self.age_max.0)];
        Some(words.filled(key, &values))
    }

    /// What speaks against the comparisons, and where visits cannot be compared.
    pub(super) fn cautions(&self, words: &Words) -> Vec<String> {
        let mut said: Vec<String> = Vec::new();
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
            said.push(words.filled("visits.break", &values));
        }
        let Some(group) = self.course.last_group() else { return said };
        // What holds for several comparisons is told once.
        let mut all: Vec<(String, Vec<String>)> = Vec::new();
        for of in self.course.last_compared(group) {
            let pair = between(words, &of);
            for caution in &of.cautions {
                let text = words.caution(&of, caution);
                match all.iter_mut().find(|(known, _)| *known == text) {
                    Some((_, pairs)) => pairs.push(pair.clone()),
                    None => all.push((text, vec![pair.clone()])),
                }
            }
        }
        said.extend(all.into_iter().map(|(text, pairs)| format!("{}: {text}", pairs.join(", "))));
        said
    }

    /// How to read the figures.
    pub(super) fn legend(&self, words: &Words) -> Vec<String> {
        let language = self.language;
        let mut said = vec![words.text("visits.legend_girths")];
        if let Some(group) = self.course.last_group() {
            let method = language.word("visits.volume_by", group.volume.word());
            let of = |side: Side| {
                let pieces = group.pieces.get(side);
                let (low, high) = (pieces.first()?, pieces.last()?);
                let cm = |mm: f64| number(mm / 10.0, 0, language);
                let values: [(&str, &dyn Display); 3] = [
                    ("leg", &words.leg_in_sentence(side)),
                    ("from", &cm(along_mm(*low))),
                    ("to", &cm(along_mm(*high) + PROFILE_STEP_MM)),
                ];
                Some(words.filled("visits.legend_range", &values))
            };
            let ranges: Vec<String> = Side::FROM_FRONT.into_iter().filter_map(of).collect();
            let values: [(&str, &dyn Display); 2] =
                [("method", &method), ("ranges", &ranges.join(", "))];
            said.push(words.filled("visits.legend_volumes", &values));
        }
        said.push(words.text("visits.legend_percent"));
        said.push(words.text("visits.legend_rounding"));
        let mm = shortest(self.course.choice.girth_common_mm, language);
        said.push(words.filled("visits.legend_uncertainty", &[("mm", &mm)]));
        said.extend(self.bound(words));
        said.push(words.text("visits.legend_limits"));
        said
    }
}

impl ReportOf<'_> {
    /// What part of the last visit's volumes the errors are that all girths of a scan have in common.
    fn bound(&self, words: &Words) -> Option<String> {
        let (group, last) = (self.course.last_group()?, self.course.visits.len().checked_sub(1)?);
        let share = |side: Side| {
            let volume = self.course.volume(group, last, side)?;
            let percent = number(100.0 * volume.parts.common() / volume.value, 2, words.language);
            Some(format!("{} {percent} %", words.leg_in_sentence(side)))
        };
        let shares: Vec<String> = Side::FROM_FRONT.into_iter().filter_map(share).collect();
        let all = shares.join(", ");
        (!shares.is_empty()).then(|| words.filled("visits.legend_bound", &[("shares", &all)]))
    }
}

/// The days of a comparison.
pub(super) fn between(words: &Words, of: &Comparison) -> String {
    let [earlier, later] = words.days(of);
    words.filled("visits.between", &[("earlier", &earlier), ("later", &later)])
}

/// What hangs on a visit that stands in the place of a record that is left out.
fn stand_ins(words: &Words, of: &Comparison) -> Vec<String> {
    let [earlier, later] = words.days(of);
    let said = |is_stand_in: bool, key: &'static str, date: &String| {
        is_stand_in.then(|| words.filled(key, &[("date", date)]))
    };
    let ends = [
        said(of.stand_ins.earlier, "visits.stand_in_earlier", &earlier),
        said(of.stand_ins.later, "visits.stand_in_later", &later),
    ];
    ends.into_iter().flatten().collect()
}

fn volume(words: &Words, group: &Group, of: &Comparison, side: Side) -> Option<String> {
    let change = of.legs.get(side).as_ref()?.volume?;
    let at = |visit: usize| words.course.volume(group, visit, side);
    let told = words.told([at(of.earlier)?.value, at(of.later)?.value], &change);
    let [percent, detectable] = words.told_percent(&change);
    let values: [(&str, &dyn Display); 5] = [
        ("leg", &words.leg(side)),
        ("between", &between(words, of)),
        ("ml", &told.change),
        ("percent", &percent),
        ("detectable", &detectable),
    ];
    Some(words.of_code("visits.volume", change.shown().word(), &values))
}

fn excess(words: &Words, of: &Comparison, change: &ExcessChange) -> String {
    let only = |side: Side| words.language.word("leg.only", side.word());
    let ends = [change.earlier.ml.value, change.later.ml.value];
    let told = words.told(ends, &change.change);
    let [before, after] = ends.map(|ml| words.ml_apart(ml, told.decimals));
    let values: [(&str, &dyn Display); 7] = [
        ("side", &only(change.later.affected)),
        ("between", &between(words, of)),
        ("ml", &told.change),
        ("before", &before),
        ("after", &after),
        ("other_side", &only(change.later.affected.other())),
        ("detectable", &told.detectable),
    ];
    if change.reduction == Err(NoReduction::SmallerLeg) {
        return words.filled("visits.smaller_leg", &values);
    }
    let shown = words.of_code("visits.excess", change.change.shown().word(), &values);
    let reduction = match &change.reduction {
        Ok(reduction) => {
            let percent = words.unsigned_percent(reduction.percent);
            let margin = tenths_words((10.0 * reduction.expanded).ceil() / 10.0, words.language);
            words.filled("visits.reduction", &[("percent", &percent), ("margin", &margin)])
        }
        // The sentence before it says so already.
        Err(NoReduction::NoChange) => return shown,
        Err(why) => words.of_code("visits.no_reduction", why.word(), &[]),
    };
    format!("{shown} {reduction}")
}

/// The difference of the legs where no excess of one is told.
fn difference(words: &Words, group: &Group, of: &Comparison) -> Option<String> {
    let change: Change = of.left_minus_right?;
    let at = |visit: usize| words.course.left_minus_right(group, visit);
    let ends = [at(of.earlier)?.value, at(of.later)?.value];
    let told = words.told(ends, &change);
    let [before, after] = ends.map(|ml| words.ml_apart(ml, told.decimals));
    let values: [(&str, &dyn Display); 5] = [
        ("between", &between(words, of)),
        ("ml", &told.change),
        ("before", &before),
        ("after", &after),
        ("detectable", &told.detectable),
    ];
    let key = match change.shown() {
        Shown::Larger | Shown::Smaller => "visits.difference",
        Shown::NoChange => "visits.difference_unchanged",
    };
    Some(words.filled(key, &values))
}
