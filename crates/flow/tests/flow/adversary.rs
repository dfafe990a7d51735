//! The adversary: people, practice software, exporters, virus scanners, crashes and faults in any
//! order, drawn from a seed, against the decisions by which a scan comes to a patient. Whatever happens,
//! no body lies under another's name. The model knows whose body each export is and uses nothing of
//! `flow::round` for that.
//!
//! It assumes, as the documentation does:
//!
//! - A person at the booth names who is there, or nobody. The next operator says so before a scan, and
//!   says it again where a verb answered that it failed, where the press was seen not to be heard, where
//!   the station was started again after it could not keep a name, and where a name was said more than
//!   ten minutes ago.
//! - A capture is given up only if its export will not come; so nobody is named, and the word of a
//!   person without a button, which gives up the captures of others, is said only then. A body that is
//!   given up or scanned again is not exported anew, nor are its files copied that the station does not know.
//! - Somebody whose scan came in without a patient, or had to be decided upon by a person, and was refused then,
//!   is named to be scanned again; so is a patient who is scanned again while somebody else's name waits,
//!   or without a button the export of somebody who was named.
//! - While a source of names is away, which is for some seconds, somebody is named there and nobody notices
//!   that it is not heard; nobody is named elsewhere, and nobody presses.
//! - While somebody stands in the booth unnamed who has not been scanned, the desk orders for nobody
//!   else, but for late orders of patients who were scanned before. Where the configuration says that
//!   orders come after the press, they do.
//! - Without a button nobody is named, and nothing ordered, while the export of a scan without a name
//!   has not begun; and each scan is named, or one that was refused before it.
//! - Who brings in an older scan copies it without a rest as long as the quiet time and leaves it the time
//!   of its source. Nobody sets its times to now, nor copies it before the station knows it: what looks
//!   like an export in all that a file tells is taken for one.
//! - The scanner writes its own measures of a scan once that lies under its name; it leaves those of
//!   another only where that one was taken.
//! - When the journal was lost nothing is exported again with another comment: one that is built anew
//!   knows the bytes of what was delivered and not its geometry.
//! - In half of the practices a worklist names patients, by taps and by codes. Of a hospital, either all accession
//!   numbers may be ids or none. A number on a paper that is somebody else's number, too, is shown to the reader only
//!   while the station has the entry of who shows it; where a code names nobody, the patient is named by a word.
//! - What comes later than anybody waits for it (an export more than `window + late` after its press or
//!   after its refusal, an order more than that after its press, or one that could not be read before a
//!   scan that nobody was named for) is counted in a row of its own.
//!
//! `GAITER_SEQUENCES` sets how many sequences are run, `GAITER_SEED` runs one again and tells it.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

pub mod booth;
pub mod content;
pub mod desk;
pub mod disk;
pub mod events;
pub mod exports;
pub mod faults;
pub mod folder;
pub mod intake;
pub mod kinds;
pub mod laws;
pub mod oracle;
pub mod people;
pub mod sequence;
pub mod truth;
pub mod work;
pub mod worklist;

use std::env;
use std::sync::OnceLock;

use laws::Off;
use sequence::{Ended, Stations};
use support::chance;

/// Sequences of one run; the claim is proved with ten times as many.
const SEQUENCES: u64 = 10_000;

/// With a law switched off a wrong name comes up within so many.
const CONTROL_SEQUENCES: u64 = 1_000;

/// How often each kind follows each other at least, in a run of [`PAIRS_SEQUENCES`].
const PAIRS_LEAST: u64 = 100;
const PAIRS_SEQUENCES: u64 = 100_000;

fn number(name: &str) -> Option<u64> {
    env::var(name).ok()?.parse().ok()
}

fn tell_again(stations: &Stations, seed: u64, off: Off) -> String {
    let story = sequence::run(stations, seed, off, true).story;
    story.join("\n")
}

/// All sequences of a run, made once for the claims on them; where a body came under a wrong name, the seed
/// and what happened.
fn all() -> Result<&'static Ended, String> {
    static ALL: OnceLock<Result<Ended, String>> = OnceLock::new();
    let run = || {
        let stations = Stations::new();
        let seeds = match number("GAITER_SEED") {
            Some(seed) => {
                println!("{}", tell_again(&stations, seed, Off::Nothing));
                seed..=seed
            }
            None => 1..=sequences(),
        };
        let mut all = Ended::default();
        for seed in seeds {
            let ended = sequence::run(&stations, seed, Off::Nothing, false);
            if let Some(wrong) = ended.wrong.as_ref().or(ended.unclean.as_ref()) {
                let story = tell_again(&stations, seed, Off::Nothing);
                return Err(format!("{story}\nGAITER_SEED={seed}: {wrong}"));
            }
            all.add(ended);
        }
        Ok(all)
    };
    ALL.get_or_init(run).as_ref().map_err(Clone::clone)
}

fn sequences() -> u64 {
    number("GAITER_SEQUENCES").unwrap_or(SEQUENCES)
}

#[test]
fn whatever_happens_no_body_comes_under_a_name_that_is_not_its_own() {
    match all() {
        Ok(all) => println!("{}", all.table()),
        Err(wrong) => panic!("{wrong}"),
    }
}

#[test]
fn every_pair_of_kinds_occurs_and_scans_come_to_their_patients() {
    if number("GAITER_SEED").is_some() {
        return;
    }
    let all = all().expect("a wrong name is the other claim's");
    if env::var_os("GAITER_TELL").is_some() {
        println!("{}", all.pairs.rare());
    }
    let (rarest, count) = all.pairs.rarest();
    let least = PAIRS_LEAST * sequences() / PAIRS_SEQUENCES;
    assert!(count >= least, "{rarest:?} occurred {count} times");
    assert!(all.given > sequences() / 2, "{} scans came to a patient", all.given);
}

/// With a law switched off the same run finds a wrong name.
fn control(off: Off) {
    let stations = Stations::new();
    let found = (1..=CONTROL_SEQUENCES).find_map(|seed| {
        let ended = sequence::run(&stations, seed, off, false);
        ended.wrong.map(|wrong| (seed, wrong))
    });
    let Some((seed, wrong)) = found else { panic!("without {off:?} nothing goes wrong") };
    println!("{off:?}: seed {seed}: {wrong}");
    if env::var_os("GAITER_TELL").is_some() {
        println!("{}", tell_again(&stations, seed, off));
    }
}

/// The oracle notices each of the six rules that is off, whether a name is wrong or not.
#[test]
fn a_round_that_breaks_a_rule_is_noticed() {
    let stations = Stations::new();
    let rules = [
        (Off::RestBefore, "R1"),
        (Off::OrdersAddUp, "R2"),
        (Off::PressAfterName, "R2"),
        (Off::ContentNotName, "R4"),
        (Off::FailedNamingDisarms, "R5"),
        (Off::EarsOpen, "R5"),
        (Off::InTime, "R6"),
    ];
    for (off, rule) in rules {
        let broken = (1..=CONTROL_SEQUENCES).find_map(|seed| {
            let ended = sequence::run(&stations, seed, off, false);
            ended.unclean.filter(|flaw| flaw.starts_with(rule)).map(|flaw| (seed, flaw))
        });
        let Some((seed, flaw)) = broken else {
            panic!("nobody notices that {off:?} does not hold")
        };
        println!("{off:?}: seed {seed}: {flaw}");
    }
}

#[test]
fn an_export_judged_by_the_first_sight_of_its_name_goes_wrong() {
    control(Off::ContentNotName);
}

#[test]
fn an_export_followed_by_its_name_alone_goes_wrong() {
    control(Off::Inodes);
}

#[test]
fn an_older_scan_that_counts_as_new_when_it_is_brought_in_goes_wrong() {
    control(Off::BroughtInIsOlder);
}

#[test]
fn known_scans_that_answer_captures_go_wrong() {
    control(Off::KnownAnswerNothing);
}

#[test]
fn a_round_that_begins_while_another_is_open_goes_wrong() {
    control(Off::RestBefore);
}

#[test]
fn an_order_that_replaces_the_name_that_waits_goes_wrong() {
    control(Off::OrdersAddUp);
}

#[test]
fn a_name_after_a_press_without_one_that_is_certain_goes_wrong() {
    control(Off::PressAfterName);
}

#[test]
fn a_failed_naming_that_does_nothing_goes_wrong() {
    control(Off::FailedNamingDisarms);
}

#[test]
fn a_source_of_names_that_is_away_without_a_word_goes_wrong() {
    control(Off::EarsOpen);
}

#[test]
fn a_failed_command_that_takes_effect_goes_wrong() {
    control(Off::JournalFirst);
}

#[test]
fn decisions_that_a_rebuild_forgets_go_wrong() {
    control(Off::DecisionsOutlive);
}

#[test]
fn a_companion_that_was_there_before_goes_wrong() {
    control(Off::FreshCompanions);
}

#[test]
fn a_code_of_several_patients_that_names_one_of_them_goes_wrong() {
    control(Off::CodesMeanOne);
}

#[test]
fn an_order_that_names_again_when_it_is_touched_goes_wrong() {
    control(Off::OrdersNameOnce);
}
