//! `gaiter patient erase`.

use std::io::{self, IsTerminal, Write};

use gaiter_flow::patient::erasure::Erasure;
use gaiter_language::Language;
use serde_json::json;

use super::preview;
use super::reach::{PersonFault, Reached};
use super::watch::Watch;
use crate::cli::args::EraseArgs;
use crate::cli::ask::read_patient;
use crate::cli::{Exit, complain, print};

pub(super) fn erased(args: &EraseArgs) -> Result<Exit, PersonFault> {
    let (reached, person) = Reached::find(&args.ask.config)?;
    if person.is_awaited() {
        return Err(PersonFault::Awaited);
    }
    let language = reached.language;
    complain(preview::render(&person, args.leave_at_servers, language));
    let again = read_again(language).map_err(PersonFault::NoId)?;
    if again != person.patient {
        return Err(PersonFault::NotAgain);
    }
    let watch = Watch::new(&reached, &person.patient, args.leave_at_servers);
    let erasure = match reached.erase(&person.patient, args.leave_at_servers) {
        Ok(Some(erasure)) => Some(erasure),
        Ok(None) => watch.noted().until_known()?,
        // It ended before it answered, so nobody knows yet whether it noted the wish.
        Err(fault) if fault.is_silence() => watch.until_known()?,
        Err(fault) => return Err(fault),
    };
    print_erasure(args, erasure.as_ref(), language)
}

/// Reads the id a second time, with a prompt if it is typed.
fn read_again(language: Language) -> io::Result<String> {
    if io::stdin().is_terminal() {
        let mut screen = io::stderr().lock();
        writeln!(screen, "{}", language.text("erase.again"))?;
    }
    read_patient()
}

/// Prints what is known of an erasure; `None` if no station answered to the end.
fn print_erasure(
    args: &EraseArgs,
    erasure: Option<&Erasure>,
    language: Language,
) -> Result<Exit, PersonFault> {
    let ended = erasure.and_then(|erasure| erasure.ended);
    let text = match erasure {
        _ if args.ask.json => format!("{:#}\n", as_json(erasure)),
        None => format!("{}\n", language.text("erase.unknown")),
        Some(erasure) => in_words(erasure, language),
    };
    print(text).map_err(PersonFault::Print)?;
    Ok(if ended.is_some() { Exit::Done } else { Exit::Io })
}

/// What has become of an erasure, and what is left to do or was left undone.
fn in_words(erasure: &Erasure, language: Language) -> String {
    let mut text = match erasure {
        Erasure { ended: Some(_), .. } => language.text("erase.done").to_owned(),
        Erasure { cleared: Some(_), stores, .. } => {
            language.filled("erase.waits", &[("stores", &stores.join(", "))])
        }
        Erasure { owed, .. } if !owed.is_empty() => {
            let waits = language.text("erase.waits_for_servers");
            format!("{waits}\n{}", preview::list(&preview::owed(owed, language)))
        }
        _ => language.text("erase.not_yet").to_owned(),
    };
    text = format!("{}\n", text.trim_end());
    if !erasure.left.is_empty() {
        text += &format!("{}\n", language.text("erase.left"));
        text += &preview::list(&preview::owed(&erasure.left, language));
    }
    text
}

fn as_json(erasure: Option<&Erasure>) -> serde_json::Value {
    json!({
        "known": erasure.is_some(),
        "ended": erasure.and_then(|erasure| erasure.ended),
        "own_cleared": erasure.is_some_and(|erasure| erasure.cleared.is_some()),
        "waits_for": erasure.map(|erasure| erasure.stores.clone()).unwrap_or_default(),
        "owed": erasure.map(|erasure| erasure.owed.clone()).unwrap_or_default(),
        "left": erasure.map(|erasure| erasure.left.clone()).unwrap_or_default(),
    })
}
