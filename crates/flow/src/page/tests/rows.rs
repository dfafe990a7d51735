//! A scan of several patients has a row for each, and each row opens its own record only.

use gaiter_language::Language;

use super::{delivery, whole, with_folders};
use crate::Closed;
use crate::account::Whole;
use crate::page::rows::rows;
use crate::page::{ScanDetails, ScanShown, record_folder, row_key, scan_shown};

/// State, patients, folder and verbs of a row.
type RowShown = (String, Vec<String>, Option<String>, Vec<&'static str>);

fn told(whole: Whole) -> Vec<RowShown> {
    let shown = |row: &Whole| scan_shown(row, &ScanDetails::default(), Language::En);
    let told = |row: Whole| {
        let ScanShown { state, patients, acts, .. } = shown(&row);
        (state.to_owned(), patients, record_folder(&row, "folder").map(str::to_owned), acts)
    };
    rows(whole).into_iter().map(told).collect()
}

fn row(
    state: &str,
    patient: Option<&str>,
    folder: Option<&str>,
    acts: &[&'static str],
) -> RowShown {
    let patients = patient.map(str::to_owned).into_iter().collect();
    (state.to_owned(), patients, folder.map(str::to_owned), acts.to_vec())
}

#[test]
fn the_first_patient_keeps_the_record_while_the_scan_is_held_for_a_second_and_after_its_release() {
    let (first, second) = (Some("1"), Some("2"));
    let theirs = row("delivered", first, Some("of-1"), &["unassign"]);
    let mut held = with_folders(&[(first, "delivered"), (second, "held")]);
    held.deliveries[1].code = Some("same-scan-other-patient".to_owned());
    assert_eq!(told(held), [row("held", second, None, &["release", "give_up"]), theirs.clone()]);
    let released = with_folders(&[(first, "delivered"), (second, "pending")]);
    assert_eq!(told(released), [row("spooled", second, None, &[]), theirs.clone()]);
    let both = with_folders(&[(first, "delivered"), (second, "delivered")]);
    let second = row("delivered", second, Some("of-2"), &["unassign"]);
    assert_eq!(told(both), [theirs, second]);
}

#[test]
fn a_record_is_taken_back_from_an_id_as_it_is_and_not_as_it_is_shown() {
    let hidden = "\u{202e}4711";
    let both = with_folders(&[(Some("1"), "delivered"), (Some(hidden), "delivered")]);
    let shown = |row: &Whole| scan_shown(row, &ScanDetails::default(), Language::En);
    let owners: Vec<_> = rows(both).iter().filter_map(|row| shown(row).owner).collect();
    assert_eq!(owners.iter().map(|of| of.id.as_str()).collect::<Vec<_>>(), ["1", hidden]);
    assert_ne!(owners[1].shown, hidden);
    assert_eq!(shown(&with_folders(&[(Some("1"), "held")])).owner, None);
}

#[test]
fn a_scan_of_one_patient_is_one_row_whatever_its_deliveries() {
    let (first, nobody) = (Some("1"), None);
    for deliveries in [
        vec![(first, "delivered")],
        vec![(first, "delivered"), (first, "pending")],
        vec![(nobody, "delivered"), (first, "delivered")],
        vec![(first, "withdrawn"), (nobody, "delivered")],
        vec![(first, "held")],
    ] {
        let whole = with_folders(&deliveries);
        assert_eq!(rows(whole.clone()), [whole], "{deliveries:?}");
    }
}

#[test]
fn rows_have_keys_of_their_own_that_name_no_patient() {
    let both = with_folders(&[(Some("4711"), "delivered"), (Some("0815"), "delivered")]);
    let keys: Vec<String> = rows(both).iter().filter_map(row_key).collect();
    assert_eq!(keys.len(), 2);
    assert_ne!(keys[0], keys[1]);
    assert!(keys.iter().all(|key| key.len() == 16 && !key.contains("4711")), "{keys:?}");
    let unassigned = with_folders(&[(None, "delivered")]);
    assert_eq!(rows(unassigned).iter().find_map(row_key), None);
}

#[test]
fn a_scan_that_was_given_up_while_it_was_held_can_still_be_assigned_and_needs_no_decision() {
    let mut held = whole("delivered", None, vec![delivery(Some("1"), "held", Some("export-late"))]);
    held.summary.closed = Some(Closed::GivenUp);
    let shown = scan_shown(&held, &ScanDetails::default(), Language::En);
    assert_eq!((shown.state, shown.acts.clone()), ("closed", vec!["assign"]));
    assert!(!held.disposition().needs_decision());
}
