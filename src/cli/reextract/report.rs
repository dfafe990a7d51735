//! Tables for people that show what changed by measuring again, and by how much.

use std::collections::BTreeMap;
use std::fmt::Write;

use gaiter_flow::health::counted;
use gaiter_leg::Level;
use gaiter_record::change::{Change, LegLevel, LevelChange};

use super::{Again, ReextractOutcome};
use crate::cli::terminal::{self, painted};

/// The most records that are named: those that changed most.
const WORST: usize = 20;

/// A record that was measured again, with its name in the report.
#[derive(Debug, Clone, PartialEq)]
pub struct ReextractEntry {
    pub name: String,
    /// What became of it.
    pub again: Again,
}

impl ReextractEntry {
    /// The largest change of a figure, and its level.
    fn largest(&self, figure: fn(&LevelChange) -> Change) -> Option<(f64, &LegLevel)> {
        let levels = self.again.changes.levels.iter();
        let changes = levels.map(|level| (figure(level).by(), &level.place));
        changes.max_by(|one, other| one.0.abs().total_cmp(&other.0.abs()))
    }

    /// How much it changed: levels that came or went count before girths, girths before heights.
    fn weight(&self) -> (usize, f64, f64) {
        let changes = &self.again.changes;
        let by = |figure: fn(&LevelChange) -> Change| {
            self.largest(figure).map_or(0.0, |(by, _)| by.abs())
        };
        (changes.came.len() + changes.went.len(), by(|of| of.girth_mm), by(|of| of.height_mm))
    }
}

/// The whole report, with colours. `failed` records were not measured again. `left_out` records were
/// first seen too early.
pub fn report(entries: &[ReextractEntry], failed: usize, left_out: usize) -> String {
    let mut text = totals(entries, failed, left_out);
    let changed: Vec<&ReextractEntry> =
        entries.iter().filter(|one| one.again.outcome != ReextractOutcome::Unchanged).collect();
    if changed.is_empty() {
        return text;
    }
    let _ = writeln!(text, "\n{}", painted(terminal::LABEL, "later minus earlier, mm"));
    text += &levels(entries);
    text += &worst(changed);
    text += &findings(entries);
    text
}

/// How many records had which outcome.
fn totals(entries: &[ReextractEntry], failed: usize, left_out: usize) -> String {
    let count = |outcome| entries.iter().filter(|one| one.again.outcome == outcome).count();
    let records = counted(entries.len() + failed, "record");
    let mut text = format!("{records}: {} unchanged", count(ReextractOutcome::Unchanged));
    for (outcome, words) in [
        (ReextractOutcome::Revised, "with a new revision"),
        (ReextractOutcome::WouldBeRevised, "would have a new revision"),
        (ReextractOutcome::Withdrawn, "taken back from their patients meanwhile"),
    ] {
        let count = count(outcome);
        if count > 0 {
            let _ = write!(text, ", {count} {words}");
        }
    }
    if failed > 0 {
        let failed = format!("{failed} not measured again");
        let _ = write!(text, ", {}", painted(terminal::BAD, failed));
    }
    if left_out > 0 {
        let _ = write!(text, "; {left_out} were first seen earlier and skipped");
    }
    text + "\n"
}

/// What changed at one level in all records.
#[derive(Default)]
struct Row<'a> {
    girths: Vec<(f64, &'a str)>,
    heights: Vec<(f64, &'a str)>,
    came: usize,
    went: usize,
}

/// One row per level, both legs together.
fn levels(entries: &[ReextractEntry]) -> String {
    let mut rows: BTreeMap<&str, Row<'_>> = BTreeMap::new();
    for ReextractEntry { name, again } in entries {
        for level in &again.changes.levels {
            let row = rows.entry(&level.place.level).or_default();
            row.girths.push((level.girth_mm.by(), name));
            row.heights.push((level.height_mm.by(), name));
        }
        for place in &again.changes.came {
            rows.entry(&place.level).or_default().came += 1;
        }
        for place in &again.changes.went {
            rows.entry(&place.level).or_default().went += 1;
        }
    }
    let mut text = format!("{:13}{:28}{}\n", "", "girth", "height");
    text += "level  legs     mean  largest  of           mean  largest  of        came  went\n";
    for level in Level::ALL.map(Level::name) {
        let Some(row) = rows.get(level) else { continue };
        let [girths, heights] = [&row.girths, &row.heights].map(|changes| figures(changes));
        let _ = writeln!(
            text,
            "{level:5}  {:>4}  {girths}  {heights}  {:>4}  {:>4}",
            row.girths.len(),
            row.came,
            row.went
        );
    }
    text
}

/// The mean change, the largest change, and its record.
fn figures(changes: &[(f64, &str)]) -> String {
    let largest = changes.iter().max_by(|one, other| one.0.abs().total_cmp(&other.0.abs()));
    let Some((largest, name)) = largest else {
        return format!("{:>7} {:>8}  {:8}", "-", "-", "");
    };
    let mean = changes.iter().map(|(by, _)| by).sum::<f64>() / changes.len() as f64;
    let name = if *largest == 0.0 { "" } else { name };
    format!("{:>7} {:>8}  {name:8}", signed(mean), signed(*largest))
}

/// A change with its sign, so that it is not mistaken for a measure. Zero has no sign.
fn signed(by: f64) -> String {
    let text = format!("{by:+.2}");
    if text.trim_start_matches(['+', '-']) == "0.00" { "0.00".to_owned() } else { text }
}

/// The records that changed most.
fn worst(mut changed: Vec<&ReextractEntry>) -> String {
    changed.sort_by(|one, other| {
        let ((a, b, c), (d, e, f)) = (one.weight(), other.weight());
        d.cmp(&a).then(e.total_cmp(&b)).then(f.total_cmp(&c)).then(one.name.cmp(&other.name))
    });
    let more = changed.len().saturating_sub(WORST);
    let wide = changed.iter().take(WORST).map(|one| one.name.chars().count()).max().unwrap_or(0);
    let wide = wide.max("record".len());
    let mut text = format!("\n{:wide$}  revision     girth at           height at\n", "record");
    for entry in changed.into_iter().take(WORST) {
        let Again { from_revision, revision, changes, .. } = &entry.again;
        let to = revision.map_or("-".to_owned(), |revision| revision.to_string());
        let cell = |figure: fn(&LevelChange) -> Change| match entry.largest(figure) {
            Some((by, place)) if by != 0.0 => format!("{:>8} {:9}", signed(by), named(place)),
            _ => format!("{:>8} {:9}", "0.00", ""),
        };
        let (girths, heights) = (cell(|of| of.girth_mm), cell(|of| of.height_mm));
        let came = changes.came.iter().map(|place| format!("  +{}", named(place)));
        let went = changes.went.iter().map(|place| format!("  -{}", named(place)));
        let levels: String = came.chain(went).collect();
        let name = &entry.name;
        let line = format!(
            "{name:wide$}  {:8}  {girths}  {heights}{levels}",
            format!("{from_revision} > {to}")
        );
        let _ = writeln!(text, "{}", line.trim_end());
    }
    if more > 0 {
        let _ = writeln!(text, "and {more} more with smaller changes; --json lists all");
    }
    text
}

fn named(place: &LegLevel) -> String {
    format!("{} {}", place.leg, place.level)
}

/// Findings that came or went, by code.
fn findings(entries: &[ReextractEntry]) -> String {
    let mut codes: BTreeMap<&str, [usize; 2]> = BTreeMap::new();
    for ReextractEntry { again, .. } in entries {
        for (which, notes) in
            [&again.changes.new_findings, &again.changes.gone_findings].iter().enumerate()
        {
            notes.iter().for_each(|note| codes.entry(&note.code).or_default()[which] += 1);
        }
    }
    if codes.is_empty() {
        return String::new();
    }
    let mut text = "\nfindings   new  gone\n".to_owned();
    for (code, [new, gone]) in codes {
        let _ = writeln!(text, "          {new:4}  {gone:4}  {code}");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use gaiter_record::change::{Changes, Sameness};
    use gaiter_record::schema::FindingNote;

    fn place(leg: &str, level: &str) -> LegLevel {
        LegLevel { leg: leg.to_owned(), level: level.to_owned() }
    }

    fn level(place: LegLevel, girth_by: f64, height_by: f64) -> LevelChange {
        let change = |old: f64, by: f64| Change { old, new: old + by };
        let (girth_mm, height_mm) = (change(200.0, girth_by), change(120.0, height_by));
        LevelChange { place, girth_mm, height_mm }
    }

    fn told(
        name: &str,
        levels: Vec<LevelChange>,
        came: Vec<LegLevel>,
        revision: Option<u32>,
    ) -> ReextractEntry {
        let sameness = if revision.is_some() { Sameness::Differs } else { Sameness::Same };
        let (new_findings, gone_findings) = (Vec::new(), Vec::new());
        let went = Vec::new();
        let changes = Changes { sameness, levels, came, went, new_findings, gone_findings };
        let outcome = if revision.is_some() {
            ReextractOutcome::Revised
        } else {
            ReextractOutcome::Unchanged
        };
        let again = Again { outcome, from_revision: 1, revision, changes };
        ReextractEntry { name: name.to_owned(), again }
    }

    #[test]
    fn means_are_over_all_legs_and_the_largest_change_says_where_it_is() {
        let told = [
            told("01234567", vec![level(place("left", "B"), -0.6, 0.0)], vec![], Some(2)),
            told("89abcdef", vec![level(place("right", "B"), 0.0, 0.0)], vec![], None),
            told("deadbeef", vec![], vec![place("left", "D")], Some(3)),
        ];
        let said = anstream::adapter::strip_str(&report(&told, 1, 2)).to_string();
        assert!(said.starts_with("4 records: 1 unchanged, 2 with a new revision, 1 not"), "{said}");
        assert!(said.contains("; 2 were first seen earlier and skipped\n"), "{said}");
        let rows = "
             girth                       height
level  legs     mean  largest  of           mean  largest  of        came  went
B         2    -0.30    -0.60  01234567     0.00     0.00               0     0
D         0        -        -                  -        -               1     0

record    revision     girth at           height at
deadbeef  1 > 3         0.00                0.00            +left D
01234567  1 > 2        -0.60 left B         0.00
";
        assert!(said.ends_with(rows), "{said}");
    }

    #[test]
    fn findings_that_came_are_counted_apart_from_those_that_went() {
        let note = |code: &str| FindingNote {
            says: None,
            code: code.to_owned(),
            severity: "info".to_owned(),
            leg: None,
            level: None,
            message: String::new(),
        };
        let mut one = told("01234567", vec![], vec![], Some(2));
        one.again.changes.new_findings = vec![note("gap"), note("gap"), note("legs-differ")];
        one.again.changes.gone_findings = vec![note("legs-differ")];
        assert_eq!(
            findings(&[one]),
            "\nfindings   new  gone\n             2     0  gap\n             1     1  legs-differ\n"
        );
    }

    #[test]
    fn no_more_than_the_worst_are_named_and_the_rest_is_counted() {
        let one = |n: u32| {
            let levels = vec![level(place("left", "B"), f64::from(n), 0.0)];
            told(&format!("{n:08}"), levels, vec![], Some(2))
        };
        let told: Vec<ReextractEntry> = (1..=25).map(one).collect();
        let said = report(&told, 0, 0);
        assert!(said.contains("00000025  1 > 2") && said.contains("00000006  1 > 2"), "{said}");
        assert!(!said.contains("00000005  1 > 2"), "{said}");
        assert!(said.ends_with("and 5 more with smaller changes; --json lists all\n"), "{said}");
    }
}
