//! The worklist: whether its server answers, and whom its entries can name.

use gaiter_flow::Identity;
use gaiter_flow::worklist::{Worklist, WorklistEntry};
use gaiter_https::TlsFiles;
use gaiter_record::SourceKind;
use jiff::Zoned;
use jiff::civil::Date;

use super::{not_encrypted, not_given, of_station};
use crate::cli::check::row::{Row, Verdict};
use crate::config::{Config, WorklistConfig};
use crate::station::booth::worklist::{self, WorklistAnswer};

/// The name of the row of the server.
const CHECK: &str = "worklist";

/// The rows of the worklist, if there is one.
pub(super) fn rows(config: &Config) -> Vec<Row> {
    let worklist = config.patient.worklist.as_ref();
    worklist.map(|worklist| of_server(worklist, config)).unwrap_or_default()
}

fn of_server(worklist: &WorklistConfig, config: &Config) -> Vec<Row> {
    let server = &worklist.server;
    let (place, secret) = (server.place(), server.peer.secret());
    let certificate = server.peer.tls.as_ref().and_then(TlsFiles::certificate);
    let mut rows = of_station(secret.as_slice(), certificate);
    let today = Zoned::now().date();
    let tried = not_given(secret.as_slice(), CHECK, &place).unwrap_or_else(|| {
        match worklist::ask(worklist, today) {
            Ok(answer) => {
                let (verdict, detail) = listed(answer, worklist, config, today);
                Row::at(CHECK, &place, verdict, detail)
            }
            // The station works without it.
            Err(fault) => Row::at(CHECK, &place, Verdict::Warn, fault.cause().to_string()),
        }
    });
    rows.push(tried);
    let what = "names and birth dates";
    rows.extend(not_encrypted(&server.peer, place, what, "server of the worklist"));
    rows
}

/// What an answer holds for this station, without naming anybody.
fn listed(
    answer: WorklistAnswer,
    worklist: &WorklistConfig,
    config: &Config,
    today: Date,
) -> (Verdict, String) {
    let patient = &config.patient;
    let identity = Identity::new(None, None, &patient.pattern, patient.check_digit);
    let is_id = |text: &str| {
        let patient = identity.as_ref().map(|rules| rules.patient(text, SourceKind::Operator));
        patient.is_ok_and(|patient| patient.is_some())
    };
    let WorklistAnswer { entries, unreadable } = answer;
    let all = entries.len() + unreadable;
    let numbers = entries.iter().filter_map(WorklistEntry::accession_number);
    let may_be_ids = numbers.filter(|number| is_id(number)).count();
    let list = Worklist::new(entries, &worklist.filter, today, is_id).with_unreadable(unreadable);
    let mut detail =
        format!("answers: {all} entries, {} of this station today", list.entries(today).len());
    if list.left_out() > 0 {
        detail += &format!(
            ", and {} that name no patient (id not allowed by patient.pattern, no study, or unreadable)",
            list.left_out()
        );
    }
    if may_be_ids > 0 {
        detail += &format!(
            "; patient.pattern allows {may_be_ids} accession numbers as ids: the reader names no patient by an id"
        );
    }
    let is_sound = list.left_out() == 0 && may_be_ids == 0;
    (if is_sound { Verdict::Ok } else { Verdict::Warn }, detail)
}
