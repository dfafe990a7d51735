//! The everyday: days at a booth where nobody means harm, each workflow alone. Forty to sixty patients
//! in eight hours; people are late, forget, and answer half of what the light asks. Nobody's scan comes
//! under another's name, hardly any named scan is held, and a hold stays with those whom it concerns, if
//! somebody answers when the light asks who is there: where an order waits whose patient never came, and
//! nobody answers, the next order cannot tell who of the two is next (the adversary finds a wrong name
//! for each rule that guesses). Those days are counted in the table.
//!
//! `GAITER_DAYS` sets how many days each workflow is played, `GAITER_SEED` plays one again and tells it.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

mod count;
mod day;
mod workflow;

use std::env;

use count::Count;
use workflow::{Habits, Naming};

use super::adversary::{booth, disk, exports, laws, truth};

/// Days of one run; the claim is proved with ten times as many.
const DAYS: u64 = 30;

/// Of the named scans at most so many in a hundred are held where a card or a file names the patient, and
/// where orders alone do: an order does not say who is there.
const HELD_MOST_PERCENT: f64 = 2.0;
const HELD_BY_ORDER_MOST_PERCENT: f64 = 4.0;

/// The most answers at the booth that an order costs whose patient never comes. The light asks when the next order
/// comes, because two wait then. It asks again at the order after that, because the patient of the first may still
/// come. If the operator gives up the waiting orders with the first answer, it does not ask again.
///
/// What is held follows from that and from how often the light is answered, so it has no limit of its own. Where a
/// share `a` of the questions is answered, `n` answers leave `n (1 - a) / a` unanswered, with a variance of
/// `n (1 - a) / a²`, and each of those holds a scan. Half of them and two answers make 2 held scans, variance 4, for
/// each who never came: 1.9 because some overlap, and 1.75 because the evening ends the last. For the days below
/// 3.1 ± 0.7 % of 1414 scans are so expected in 30 days (26 never came), 3.8 ± 0.2 % of 14 640 in 300 (311), and
/// 3.5 ± 0.1 % of 48 968 in 1000 (975).
const ANSWERS_MOST: usize = 2;
const ANSWERS_GIVING_UP_MOST: usize = 1;

fn number(name: &str) -> Option<u64> {
    env::var(name).ok()?.parse().ok()
}

/// Plays the days of a workflow and holds it to the claims.
fn days(workflow: &str, habits: Habits) {
    let naming = habits.naming;
    let count = played(workflow, &habits);
    if number("GAITER_SEED").is_some() {
        // One day is no share.
        return;
    }
    let percent = count.held_percent();
    let most = match naming {
        Naming::Order => HELD_BY_ORDER_MOST_PERCENT,
        _ => HELD_MOST_PERCENT,
    };
    assert!(percent <= most, "{workflow}: {percent:.2} % of the named scans are held");
    assert!(count.spread.is_empty(), "{workflow}: a hold spreads, on days {:?}", count.spread);
    if naming == Naming::Nobody {
        assert_eq!(count.held, 0, "{workflow}: nothing is held where nobody is named");
    }
}

/// Plays the days of a workflow in which orders are left over: only scans about which the light asked and nobody
/// answered are held, and each no-show costs at most so many answers.
fn days_with_orders_left(workflow: &str, habits: &Habits, answers_most: usize) {
    let count = played(workflow, habits);
    let Count { no_shows, answers, held_unasked, .. } = count;
    assert_eq!(held_unasked, 0, "{workflow}: scans are held that nobody was asked about");
    let most = answers_most * no_shows;
    assert!(answers <= most, "{workflow}: {answers} answers for {no_shows} who never came");
}

/// Plays the days of a workflow: nobody's scan comes under another's name, and none is lost.
fn played(workflow: &str, habits: &Habits) -> Count {
    let days = number("GAITER_DAYS").unwrap_or(DAYS);
    let seeds = match number("GAITER_SEED") {
        Some(seed) => seed..seed + 1,
        None => 1..days + 1,
    };
    let tells = seeds.end - seeds.start == 1;
    let mut count = Count::default();
    for seed in seeds {
        let day = day::play(habits, seed, tells);
        if tells {
            println!("{}", day.booth.story.clone().unwrap_or_default().join("\n"));
        }
        if let Some(wrong) = &day.booth.truth.wrong {
            panic!("{workflow}, GAITER_SEED={seed}: {wrong}");
        }
        count.add(&day, seed);
    }
    println!("{workflow:<44} {count}");
    assert!(count.lost == 0, "{workflow}: {} scans never came in", count.lost);
    let any_given = habits.naming == Naming::Nobody || count.given > 0;
    assert!(any_given, "{workflow}: no scan comes to its patient");
    count
}

#[test]
fn order_then_press() {
    days("order, then press", Habits::new(Naming::Order, true));
}

#[test]
fn press_then_order() {
    let habits = Habits::new(Naming::Order, true);
    days("press, then order", Habits { after_press: true, ..habits });
}

#[test]
fn card_then_press() {
    days("card, then press", Habits::new(Naming::Card, true));
}

#[test]
fn worklist_then_press() {
    days("worklist, then press", Habits::new(Naming::Worklist, true));
}

#[test]
fn worklist_without_a_button() {
    days("worklist, no button", Habits::new(Naming::Worklist, false));
}

#[test]
fn order_without_a_button() {
    days("order, no button", Habits::new(Naming::Order, false));
}

#[test]
fn card_without_a_button() {
    days("card, no button", Habits::new(Naming::Card, false));
}

#[test]
fn names_in_file_names() {
    days("names in file names", Habits::new(Naming::FileName, false));
}

#[test]
fn press_without_names() {
    days("press, nobody named", Habits::new(Naming::Nobody, true));
}

#[test]
fn exports_without_names() {
    days("nobody named, no button", Habits::new(Naming::Nobody, false));
}

/// A habit besides, in each of the ways in which patients are named.
fn in_every_way(habit: &str, of: impl Fn(Habits) -> Habits) {
    let ways = [
        ("order, then press", Naming::Order, true),
        ("card, then press", Naming::Card, true),
        ("order, no button", Naming::Order, false),
        ("card, no button", Naming::Card, false),
        ("worklist, then press", Naming::Worklist, true),
        ("worklist, no button", Naming::Worklist, false),
    ];
    for (way, naming, button) in ways {
        days(&format!("{way}; {habit}"), of(Habits::new(naming, button)));
    }
}

#[test]
fn one_file_name_for_every_patient() {
    in_every_way("one file name", |habits| Habits { one_name: true, ..habits });
}

#[test]
fn a_temporary_name_and_then_renamed() {
    in_every_way("temporary name", |habits| Habits { temporary: true, ..habits });
}

#[test]
fn writes_of_a_minute() {
    in_every_way("60 s writes", |habits| Habits { slow: true, ..habits });
}

#[test]
fn two_exports_for_one_press() {
    in_every_way("two exports", |habits| Habits { two_exports: true, ..habits });
}

#[test]
fn refusals() {
    in_every_way("4 % refused", |habits| Habits { refused: true, ..habits });
}

#[test]
fn the_next_order_sent_early() {
    let early = |button| Habits { early: true, ..Habits::new(Naming::Order, button) };
    days("order, then press; 30 % sent early", early(true));
    // Without a button the next order may come before the export of the scan before has begun, and
    // nothing tells whose that is: it is held. Such a practice needs a button.
    played("order, no button; 30 % sent early", &early(false));
}

#[test]
fn patients_who_never_come() {
    for (way, button) in [("order, then press", true), ("order, no button", false)] {
        let habits = Habits { no_shows: true, ..Habits::new(Naming::Order, button) };
        days_with_orders_left(&format!("{way}; 2 % never come"), &habits, ANSWERS_MOST);
        let giving_up = Habits { gives_up: true, ..habits };
        let workflow = format!("{way}; 2 % never come, given up");
        days_with_orders_left(&workflow, &giving_up, ANSWERS_GIVING_UP_MOST);
    }
    // A patient who is only on the list competes with nobody for a scan.
    for (way, button) in [("worklist, then press", true), ("worklist, no button", false)] {
        let habits = Habits { no_shows: true, ..Habits::new(Naming::Worklist, button) };
        days(&format!("{way}; 2 % never come"), habits);
    }
}
