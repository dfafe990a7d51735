//! What counts as a corrupt journal, and what does not.

use super::*;

/// Changes the file behind the station's back.
pub(super) fn edit(path: &Path, sql: &str) {
    Connection::open(path).unwrap().execute_batch(sql).unwrap();
}

/// The SQL that made a trigger.
fn trigger_of(path: &Path, name: &str) -> String {
    let connection = Connection::open(path).unwrap();
    let sql = "SELECT sql FROM sqlite_schema WHERE name = ?1";
    connection.query_row(sql, [name], |row| row.get(0)).unwrap()
}

#[test]
fn a_table_or_index_that_is_not_as_it_was_made_is_ruin_and_one_that_somebody_added_is_not() {
    for sql in [
        "DROP INDEX scans_by_state",
        "DROP TRIGGER history_is_not_cut",
        "ALTER TABLE looks RENAME COLUMN memory TO memorx",
        "DROP TABLE orders",
        "PRAGMA user_version = 0",
    ] {
        let (_dir, path) = used();
        edit(&path, sql);
        let opened = Journal::open(&path);
        assert!(opened.as_ref().is_err_and(JournalError::is_ruin), "{sql}: {opened:?}");
    }
    let (_dir, path) = used();
    edit(&path, "CREATE INDEX of_mine ON scans (size); CREATE TABLE of_mine_too (x); ANALYZE;");
    Journal::open(&path).unwrap().check().unwrap();
}

#[test]
fn bytes_that_are_no_text_are_ruin() {
    let (_dir, path) = used();
    edit(&path, "UPDATE scans SET message = CAST(x'ff41' AS TEXT)");
    assert!(Journal::open(&path).unwrap_err().is_ruin());
}

#[test]
fn a_statement_that_a_sound_journal_refuses_is_looked_into_and_is_no_ruin() {
    let (_dir, path) = used();
    edit(
        &path,
        "CREATE TRIGGER stubborn BEFORE INSERT ON scans BEGIN SELECT RAISE(ABORT, 'no'); END",
    );
    let journal = Journal::open(&path).unwrap();
    let row = row('7');
    let entry = Entry {
        row: &row,
        patient: None,
        held: None,
        claims: &[],
        judged: &CaptureMatch::Unpressed,
        geometry: "",
        candidates: &[],
    };
    let error = journal.enter(&entry, &["folder"]).unwrap_err();
    assert!(error.is_suspicious() && !error.is_ruin(), "{error}");
    journal.check().unwrap();
    let unknown = journal.connection().execute("SELECT nothing FROM scans", []).unwrap_err();
    let unknown = JournalError::from(unknown);
    assert!(unknown.is_suspicious() && !unknown.is_ruin(), "{unknown}");
}

#[test]
fn a_digit_of_a_patient_s_id_that_has_become_another_is_noticed() {
    let (_dir, path) = used();
    edit(&path, "UPDATE deliveries SET patient = '4712' WHERE rowid = 3");
    let error = Journal::open(&path).unwrap_err();
    assert!(matches!(error, JournalError::Seal { table: "deliveries" }) && error.is_ruin());
}

#[test]
fn a_time_of_first_sight_that_has_changed_is_noticed() {
    let (_dir, path) = used();
    edit(&path, "UPDATE scans SET first_seen = '2026-11-21T09:15:01Z' WHERE rowid = 2");
    assert!(Journal::open(&path).unwrap_err().is_ruin());
}

#[test]
fn a_history_that_was_changed_is_noticed() {
    for (trigger, sql) in [
        ("history_is_not_changed", "UPDATE history SET event = 'refused' WHERE seq = 3"),
        ("history_is_not_cut", "DELETE FROM history WHERE seq = 4"),
        ("history_is_not_changed", "UPDATE history SET detail = '{}' WHERE seq = 1"),
    ] {
        let (_dir, path) = used();
        let kept = trigger_of(&path, trigger);
        edit(&path, &format!("DROP TRIGGER {trigger}; {sql}; {kept}"));
        let error = Journal::open(&path).unwrap_err();
        assert!(matches!(error, JournalError::Chain { .. }) && error.is_ruin(), "{sql}");
    }
}

#[test]
fn nobody_changes_the_history_by_mistake() {
    let (_dir, path) = used();
    let connection = Connection::open(&path).unwrap();
    for sql in ["UPDATE history SET event = 'x'", "DELETE FROM history"] {
        assert!(connection.execute(sql, []).is_err(), "{sql}");
    }
}

#[test]
fn an_older_copy_of_the_journal_is_told_from_the_present_one() {
    let (dir, path) = used();
    let copy = dir.path().join("copy");
    std::fs::copy(&path, &copy).unwrap();
    let journal = Journal::open(&path).unwrap();
    enter(&journal, &row('7'), None, DeliveryState::Pending);
    drop(journal);
    std::fs::copy(&copy, &path).unwrap();
    let error = Journal::open(&path).unwrap_err();
    assert!(matches!(error, JournalError::Behind { .. }) && error.is_ruin(), "{error}");
}

#[test]
fn a_flipped_bit_in_any_row_or_index_that_names_a_scan_is_ruin() {
    let (dir, journal) = journal();
    for digit in ['a', 'b', 'c'] {
        enter(&journal, &row(digit), Some("4711"), DeliveryState::Pending);
    }
    drop(journal);
    let path = dir.path().join("journal.db");
    let sound = std::fs::read(&path).unwrap();
    let name = row('b').scan.to_string().into_bytes();
    let names = sound.windows(name.len()).enumerate().filter(|(_, found)| *found == name);
    let places: Vec<usize> = names.map(|(at, _)| at).collect();
    // Two tables, the index of each key, and the history.
    assert!(places.len() >= 5, "{places:?}");
    for at in places {
        let mut flipped = sound.clone();
        flipped[at + 7] ^= 1;
        std::fs::write(&path, flipped).unwrap();
        let opened = Journal::open(&path);
        assert!(opened.as_ref().is_err_and(JournalError::is_ruin), "at {at}: {opened:?}");
    }
    std::fs::write(&path, sound).unwrap();
    Journal::open(&path).unwrap();
}
