//! Years in seconds: the station's decisions, `gaiter_flow`, over a simulated booth, scanner, disk,
//! stores and person, with faults drawn from a seed. After each event the invariants hold,
//! and once the faults end everything comes to rest. A seed that fails prints itself; set
//! `GAITER_SEED` to run it again and `GAITER_EVENTS` for longer runs.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

mod booth;
mod disk;
mod scanner;
mod station;
mod world;

use std::env;

use support::chance;
use world::World;

/// Events of one run, all seeds together.
const EVENTS: u64 = 200_000;

/// Seeds of one run: many short lives find more than one long one.
const SEEDS: u64 = 100;

fn number(name: &str) -> Option<u64> {
    env::var(name).ok()?.parse().ok()
}

/// Runs one life; what it did.
fn live(seed: u64, events: u64) -> world::Tally {
    let life = std::panic::catch_unwind(|| {
        let mut world = World::new(seed);
        for _ in 0..events {
            world.event();
            world.check();
        }
        world.rest();
        world.tally()
    });
    life.unwrap_or_else(|_| panic!("GAITER_SEED={seed} GAITER_EVENTS={events} fails"))
}

#[test]
fn many_events_lose_nothing_mix_nobody_up_and_come_to_rest() {
    let events = number("GAITER_EVENTS").unwrap_or(EVENTS);
    let seeds: Vec<u64> = match number("GAITER_SEED") {
        Some(seed) => vec![seed],
        None => (1..=SEEDS).collect(),
    };
    let each = if seeds.len() == 1 { events } else { events / seeds.len() as u64 };
    let mut all = world::Tally::default();
    for seed in seeds {
        all.add(&live(seed, each));
    }
    println!("{all:?}");
    // A simulation in which a fault never came up proves nothing of it.
    for (what, count) in all.counts() {
        assert!(count > 0, "no {what} in {events} events");
    }
}
