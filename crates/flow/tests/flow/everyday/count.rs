//! What came of the days of a workflow.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use gaiter_flow::DeliveryState;
use gaiter_flow::round::CaptureMatch;

use super::day::Day;
use super::disk::ScanRow;
use super::truth::{Plan, id};
use super::workflow::Naming;

#[derive(Debug, Default)]
pub struct Count {
    pub scans: usize,
    /// Scans of patients who were named.
    pub named: usize,
    pub given: usize,
    pub held: usize,
    /// Of these, where the light had asked nothing, or was answered.
    pub held_unasked: usize,
    pub unassigned: usize,
    /// Scans without a patient although one was named: the name was lost.
    pub nameless: usize,
    pub refused: usize,
    /// Bodies whose export never came in.
    pub lost: usize,
    /// Patients who were expected and never came.
    pub no_shows: usize,
    /// How often the light asked who is there and was answered.
    pub answers: usize,
    causes: BTreeMap<&'static str, usize>,
    /// The days on which a hold came to a third patient although the booth had said who is there.
    pub spread: Vec<u64>,
    /// The days on which it did so, and the light had asked and got no answer.
    pub spread_unanswered: Vec<u64>,
}

impl Count {
    pub fn add(&mut self, day: &Day<'_>, seed: u64) {
        self.no_shows += day.no_shows;
        self.answers += day.answers;
        let bodies = &day.booth.truth.bodies;
        let mut chains: Vec<BTreeSet<String>> = Vec::new();
        for (body, of) in bodies.iter().enumerate() {
            let rows = day.booth.disk.scans().map(|(_, row)| row);
            let rows: Vec<&ScanRow> = rows.filter(|row| row.content.whole.body == body).collect();
            if rows.is_empty() {
                self.lost += 1;
                continue;
            }
            self.scans += 1;
            let is_named = day.habits.naming != Naming::Nobody;
            self.named += usize::from(is_named);
            let own = Some(id(of.patient));
            let is_given =
                |row: &&ScanRow| row.deliveries.get(&own) == Some(&DeliveryState::Delivered);
            // A body may be exported more than once: what a person must decide about any of it is held.
            let held = rows.iter().find_map(|row| Some((row, row.held?)));
            if let Some((row, why)) = held {
                self.held += 1;
                self.held_unasked += usize::from(!day.unanswered.contains(&of.patient));
                *self.causes.entry(why).or_default() += 1;
                let mut concerned = BTreeSet::from([id(of.patient)]);
                if let CaptureMatch::Held { candidates, .. } = &row.judged {
                    concerned.extend(candidates.iter().map(|named| named.id.clone()));
                }
                join(&mut chains, concerned);
            } else if of.is_refused || of.plan == Plan::Broken {
                self.refused += 1;
            } else if rows.iter().any(is_given) {
                self.given += 1;
            } else {
                self.unassigned += 1;
                self.nameless += usize::from(is_named);
            }
        }
        let unanswered: BTreeSet<String> = day.unanswered.iter().map(|who| id(*who)).collect();
        for chain in chains.iter().filter(|chain| chain.len() > 2) {
            let was_answered = chain.is_disjoint(&unanswered);
            let days = if was_answered { &mut self.spread } else { &mut self.spread_unanswered };
            days.push(seed);
        }
    }

    /// Of the scans of patients who were named, so many in a hundred are held.
    pub fn held_percent(&self) -> f64 {
        self.percent_of_named(self.held)
    }

    fn percent_of_named(&self, count: usize) -> f64 {
        100.0 * count as f64 / self.named.max(1) as f64
    }
}

/// Puts together what concerns the same patients.
fn join(chains: &mut Vec<BTreeSet<String>>, mut concerned: BTreeSet<String>) {
    chains.retain(|chain| {
        let is_same = !chain.is_disjoint(&concerned);
        if is_same {
            concerned.extend(chain.iter().cloned());
        }
        !is_same
    });
    chains.push(concerned);
}

impl fmt::Display for Count {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Count { scans, given, held, unassigned, nameless, refused, .. } = self;
        write!(
            out,
            "{scans:6} scans {given:6} given {held:4} held ({:.2} %) {unassigned:5} unassigned \
             {nameless:4} of them named ({:.2} %) {refused:4} refused   0 wrong   {} spread, {} unanswered ",
            self.held_percent(),
            self.percent_of_named(*nameless),
            self.spread.len(),
            self.spread_unanswered.len(),
        )?;
        for (why, count) in &self.causes {
            write!(out, " {why} {count}")?;
        }
        if self.no_shows > 0 {
            let each = |count: usize| count as f64 / self.no_shows as f64;
            let (held, answers) = (each(self.held), each(self.answers));
            write!(out, "   for each of {} who never came {held:.2} held", self.no_shows)?;
            write!(out, ", {answers:.2} answers")?;
        }
        Ok(())
    }
}
