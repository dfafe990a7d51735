//! Questions over all scans, by the role that reads and in a transaction that changes nothing.

use std::io;

use postgres::{Client, Transaction};

use crate::config::ArchiveConfig;
use crate::database;
use crate::fault::ArchiveFault;
use crate::print;

/// The questions of docs/archive.md, by name.
const QUESTIONS: [(&str, &str); 3] = [
    ("calf-by-stature", include_str!("../questions/calf-by-stature.sql")),
    ("repeatability", include_str!("../questions/repeatability.sql")),
    ("phantom-drift", include_str!("../questions/phantom-drift.sql")),
];

/// The role, and what a question may use: workers need the database, too. The costs are those of a disk without moving
/// parts. With more memory, joins of a million announcements are made by a hash of them instead of in the order of their
/// index, and take longer.
const AS_READER: &str = "\
    set local role gaiter_reader; set local statement_timeout = '10min'; \
    set local work_mem = '16MB'; set local random_page_cost = 1.1; set local jit = off";

/// Answers one of the worked questions, or a statement in SQL.
///
/// # Errors
/// Those of the database.
pub fn query(config: &ArchiveConfig, question: &str, json: bool) -> Result<(), ArchiveFault> {
    let named = QUESTIONS.iter().find(|(name, _)| *name == question);
    let statement = named.map_or(question, |(_, statement)| *statement);
    // On a line of its own: a comment may end the statement.
    let statement = format!("({}\n)", statement.trim_end_matches([';', ' ', '\n']));
    let mut client = database::connect(&config.database)?;
    let mut transaction = as_reader(&mut client)?;
    if json {
        let rows = format!("select coalesce(json_agg(answer), '[]')::text from {statement} answer");
        let answer: String = transaction.query_one(rows.as_str(), &[])?.get(0);
        print(answer)?;
        return Ok(());
    }
    let copy = format!("copy {statement} to stdout (format csv, header)");
    io::copy(&mut transaction.copy_out(copy.as_str())?, &mut io::stdout().lock())?;
    Ok(())
}

/// A transaction of the role that reads, on one state of the tables.
///
/// # Errors
/// Those of the database.
pub fn as_reader(client: &mut Client) -> Result<Transaction<'_>, ArchiveFault> {
    let mut transaction = database::moment(client)?;
    transaction.batch_execute(AS_READER)?;
    Ok(transaction)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worked_questions_stand_in_the_docs_word_by_word() {
        let docs = include_str!("../../../docs/archive.md");
        for (name, statement) in QUESTIONS {
            assert!(docs.contains(&format!("gaiter-archive query {name}")), "{name}");
            assert!(docs.contains(&format!("```sql\n{statement}```\n")), "{name}");
        }
    }
}
