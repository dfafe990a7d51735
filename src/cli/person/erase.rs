//! `gaiter patient erase`.

use std::io::{self, IsTerminal, Write};
use std::time::Duration;

use gaiter_flow::patient::erasure::Erasure;
use gaiter_language::Language;
use jiff::{SignedDuration, Timestamp};
use serde_json::json;

use super::preview;
use super::reach::{Fault, Reached};
use crate::cli::args::EraseArgs;
use crate::cli::ask::read_patient;
use crate::cli::{Exit, complain, print};
use crate::store::polling::poll;

/// How long the station may take to begin anew and to clear its folder and the stores.
const PATIENCE: Duration = Duration::from_secs(60);

/// How long after its own folder the stores that are in reach are cleared.
const STORES_PATIENCE: SignedDuration = SignedDuration::from_secs(10);

/// Erases all that the station holds of a person, once the id was given twice.
pub fn erase(args: &EraseArgs) -> Exit {
    match erased(args) {
        Ok(exit) => exit,
        Err(fault) => {
            complain(format_args!("gaiter: {fault}"));
            if let Some(hint) = fault.hint() {
                complain(format_args!("  hint: {hint}"));
            }
            fault.exit()
        }
    }
}

fn erased(args: &EraseArgs) -> Result<Exit, Fault> {
    let patient = read_patient().map_err(Fault::NoId)?;
    if patient.is_empty() {
        return Err(Fault::EmptyId);
    }
    let (reached, person) = Reached::of(&args.ask.config, &patient)?;
    if person.is_unknown() {
        return Err(Fault::Unknown);
    }
    if person.is_awaited() {
        return Err(Fault::Awaited);
    }
    let language = reached.language;
    complain(preview::of(&person, language));
    let again = read_again(language).map_err(Fault::NoId)?;
    if again != patient {
        return Err(Fault::NotAgain);
    }
    let erasure = match reached.erase(&patient, &again)? {
        Some(erasure) => Some(erasure),
        None => waited(&reached, &patient),
    };
    told(args, erasure.as_ref(), language)
}

/// Reads the id a second time, with a prompt if it is typed.
fn read_again(language: Language) -> io::Result<String> {
    if io::stdin().is_terminal() {
        let mut screen = io::stderr().lock();
        writeln!(screen, "{}", language.text("erase.again"))?;
    }
    read_patient()
}

/// Waits until nothing is left to do, or only a store that is out of reach.
fn waited(reached: &Reached<'_>, patient: &str) -> Option<Erasure> {
    let mut last = None;
    let ended = poll(PATIENCE, || {
        // The socket is away for a moment while the station begins anew.
        let erasure = reached.erasure(patient).ok().flatten()?;
        let own =
            erasure.cleared.is_some_and(|at| at.duration_until(Timestamp::now()) > STORES_PATIENCE);
        let is_over = erasure.ended.is_some() || own;
        last = Some(erasure.clone());
        is_over.then_some(erasure)
    });
    ended.or(last)
}

fn told(args: &EraseArgs, erasure: Option<&Erasure>, language: Language) -> Result<Exit, Fault> {
    let ended = erasure.and_then(|erasure| erasure.ended);
    let stores = erasure.map(|erasure| erasure.stores.clone()).unwrap_or_default();
    let own = erasure.is_some_and(|erasure| erasure.cleared.is_some());
    let text = match (args.ask.json, ended.is_some(), own) {
        (true, ..) => {
            format!("{:#}\n", json!({ "ended": ended, "own_cleared": own, "waits_for": stores }))
        }
        (false, true, _) => format!("{}\n", language.text("erase.done")),
        (false, false, true) => {
            format!("{}\n", language.filled("erase.waits", &[("stores", &stores.join(", "))]))
        }
        (false, false, false) => format!("{}\n", language.text("erase.not_yet")),
    };
    print(text).map_err(Fault::Print)?;
    Ok(if ended.is_some() { Exit::Done } else { Exit::Io })
}
