//! What happens when, drawn from a seed before anything begins: the same seed gives the same plan.

use std::env;
use std::time::Duration;

use crate::chance::Chance;
use crate::field::Field;

/// Where the environment says nothing else.
const LENGTH_S: u64 = 60;
const SEED: u64 = 20_261_121;

/// How long the siege lasts, and the seed of its plan.
#[derive(Debug, Clone, Copy)]
pub struct Plan {
    pub length: Duration,
    pub seed: u64,
}

/// Something that one adversary does, when, and the draws that it takes.
#[derive(Debug)]
pub struct Event<Act> {
    pub at: Duration,
    pub act: Act,
    draws: u64,
}

impl Plan {
    pub fn of_environment() -> Plan {
        let number = |name: &str| env::var(name).ok().map(|text| text.parse::<u64>().unwrap());
        let length = Duration::from_secs(number("GAITER_SIEGE_S").unwrap_or(LENGTH_S));
        Plan { length, seed: number("GAITER_SEED").unwrap_or(SEED) }
    }

    /// Whether a part of the siege is left out, so that it can be told whose doing something is.
    pub fn is_without(part: &str) -> bool {
        let without = env::var("GAITER_SIEGE_WITHOUT").unwrap_or_default();
        without.split(',').any(|word| word == part)
    }

    /// The chance of one adversary.
    fn chance(&self, of: u64) -> Chance {
        let mut chance = Chance(self.seed.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(of));
        // The first draws of neighbouring seeds are alike.
        (0..8).for_each(|_| _ = chance.unit());
        chance
    }

    /// The events of an adversary: from `after` on one every `pace` or so.
    pub fn events<Act>(
        &self,
        (of, part): (u64, &str),
        after: Duration,
        pace: Duration,
        mut draw: impl FnMut(&mut Chance) -> Act,
    ) -> Vec<Event<Act>> {
        if Plan::is_without(part) {
            return Vec::new();
        }
        let mut chance = self.chance(of);
        let (mut events, mut at) = (Vec::new(), after);
        while at < self.length {
            let act = draw(&mut chance);
            let draws = (chance.unit() * 1e15) as u64;
            events.push(Event { at, act, draws });
            at += pace.mul_f64(0.25 + 1.5 * chance.unit());
        }
        events
    }
}

/// Does what was planned, each thing when its time has come and the one before is done, until the siege
/// is over.
pub fn follow<Act>(
    field: &Field,
    events: Vec<Event<Act>>,
    mut perform: impl FnMut(Act, &mut Chance),
) {
    for event in events {
        if !field.wait_until(event.at) {
            return;
        }
        perform(event.act, &mut Chance(event.draws));
    }
}

/// Evenly between two numbers of seconds.
pub fn seconds(chance: &mut Chance, from: f64, to: f64) -> Duration {
    Duration::from_secs_f64(from + (to - from) * chance.unit())
}

/// One of these, by their weights.
pub fn weighed<Of: Copy>(chance: &mut Chance, of: &[(usize, Of)]) -> Of {
    let mut left = chance.below(of.iter().map(|(weight, _)| weight).sum());
    for (weight, it) in of {
        if left < *weight {
            return *it;
        }
        left -= weight;
    }
    of[0].1
}
