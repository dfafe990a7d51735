//! What a held scan shows and offers.

use super::*;
use crate::light::LastOutcome;
use crate::page::reasons::{Advice, of_refused};
use crate::patient::erasure::ERASED;

/// For a held scan with these candidates: the patients who can be chosen, and the verbs.
fn choices(
    patients: &[Option<&str>],
    code: &str,
    candidates: &[&str],
) -> (Vec<String>, Vec<&'static str>) {
    let held = patients.iter().map(|patient| delivery(*patient, "held", Some(code))).collect();
    let mut whole = whole("delivered", None, held);
    whole.candidates = candidates.iter().map(|id| (*id).to_owned()).collect();
    let shown = scan_shown(&whole, &ScanDetails::default(), Language::En);
    (shown.candidates.into_iter().map(|of| of.id).collect(), shown.acts)
}

#[test]
fn a_held_scan_offers_its_candidates_and_a_release_only_where_exactly_one_patient_is_held() {
    let late = |patients: &[Option<&str>], candidates: &[&str]| {
        choices(patients, "export-late", candidates)
    };
    let ids = |ids: &[&str]| ids.iter().map(|id| (*id).to_owned()).collect::<Vec<_>>();
    assert_eq!(late(&[Some("1")], &[]), (ids(&[]), vec!["release", "assign", "give_up"]));
    assert_eq!(late(&[Some("1"), Some("2")], &[]), (ids(&[]), vec!["assign", "give_up"]));
    assert_eq!(late(&[Some("1")], &["1", "2"]), (ids(&["1", "2"]), vec!["assign", "give_up"]));
    // A release does the same as the only candidate's button.
    assert_eq!(late(&[Some("1")], &["1"]), (ids(&[]), vec!["release", "assign", "give_up"]));
    assert_eq!(late(&[None], &["1"]), (ids(&["1"]), vec!["assign", "give_up"]));
    let other = "same-scan-other-patient";
    assert_eq!(choices(&[Some("1")], other, &["1", "2"]), (ids(&[]), vec!["release", "give_up"]));
    assert_eq!(choices(&[Some("1"), Some("2")], other, &["1", "2"]), (ids(&[]), vec!["give_up"]));
    let mut stored = whole("delivered", None, vec![delivery(Some("1"), "delivered", None)]);
    stored.candidates = ids(&["1", "2"]);
    assert!(scan_shown(&stored, &ScanDetails::default(), Language::En).candidates.is_empty());
}

#[test]
fn a_held_scan_that_may_be_an_erased_persons_says_so_and_is_never_given_to_them_nor_released() {
    let held = vec![delivery(Some("1"), "held", Some("export-late"))];
    let mut whole = whole("delivered", None, held);
    for (language, said) in [
        (Language::En, "It may also be an erased person's."),
        (Language::De, "Er kann auch von einer gelöschten Person sein."),
    ] {
        whole.candidates = vec!["1".to_owned(), ERASED.to_owned()];
        let shown = scan_shown(&whole, &ScanDetails::default(), language);
        assert!(shown.advice.unwrap().what.ends_with(said));
        assert_eq!(shown.candidates.iter().map(|of| of.id.as_str()).collect::<Vec<_>>(), ["1"]);
        assert_eq!(shown.acts, ["assign", "give_up"], "a release would be a guess");
        assert_eq!(whole.possible_owners(), ["1"]);
        whole.candidates = vec!["1".to_owned()];
        let shown = scan_shown(&whole, &ScanDetails::default(), language);
        assert!(!shown.advice.unwrap().what.contains(said));
    }
}

#[test]
fn a_held_scan_that_cannot_be_measured_says_that_first_and_offers_first_to_give_it_up() {
    let told = ScanDetails { unmeasured: Some("no-leg".to_owned()), ..ScanDetails::default() };
    let held = whole("delivered", None, vec![delivery(Some("1"), "held", Some("export-late"))]);
    for (language, begins, held_for) in [
        (Language::En, "The legs cannot be measured. ", "It arrived after"),
        (Language::De, "Die Beine lassen sich nicht vermessen. ", "Er kam nach"),
    ] {
        let shown = scan_shown(&held, &told, language);
        let Advice { what, next } = shown.advice.clone().unwrap();
        assert!(what.starts_with(begins) && what.contains(held_for), "{what}");
        assert_eq!(next, of_refused("no-leg", language).next);
        assert_eq!(shown.acts, ["give_up", "release", "assign"]);
        assert!(shown.unmeasured.as_deref().unwrap().ends_with("[no-leg]"));
        // The light shows the same for the scan that ended last, and for no other.
        let last = LastOutcome::Held { code: "export-late".to_owned() };
        for (last_scan, is_told) in
            [(Some(shown.scan.as_str()), true), (Some("0"), false), (None, false)]
        {
            let booth = Situation { last: Some(&last), last_scan, ..booth(Signal::Attention) };
            let page = page_with(booth, &[], vec![shown.clone()], language);
            assert_eq!(page.light.said.text.contains(&what), is_told, "{}", page.light.said.text);
        }
    }
    let stored = whole("delivered", None, vec![delivery(Some("1"), "delivered", None)]);
    assert_eq!(scan_shown(&stored, &told, Language::En).unmeasured, None);
}

#[test]
fn who_is_to_be_scanned_again_is_offered_by_name_where_a_refused_scan_is_one_patients() {
    let again = |state, patients: &[Option<&str>]| {
        let of = |patient: &Option<&str>| delivery(*patient, state, Some("no-leg"));
        let whole = whole(state, Some("no-leg"), patients.iter().map(of).collect());
        scan_shown(&whole, &ScanDetails::default(), Language::En).again.map(|of| of.id)
    };
    assert_eq!(again("refused", &[Some("1")]).as_deref(), Some("1"));
    assert_eq!(again("refused", &[Some("1"), Some("2")]), None);
    assert_eq!(again("refused", &[None]), None);
    assert_eq!(again("delivered", &[Some("1")]), None);
}

/// Red while a scan that came without a press offered nobody, although one patient was named.
#[test]
fn the_last_scan_that_came_without_a_press_can_be_given_to_who_is_named() {
    let id = ["4711".to_owned()];
    let offered = |last_scan: Option<&str>, is_in_doubt, deliveries| {
        let scan = scan("delivered", None, deliveries);
        let booth = Situation { next: &id, last_scan, is_in_doubt, ..booth(Signal::Attention) };
        let mut page = page_with(booth, &[], vec![scan], Language::En);
        let offered = page.undecided.remove(0).candidates.into_iter();
        offered.map(|of| of.id).collect::<Vec<_>>()
    };
    let this = "ab".repeat(32);
    let nobodys = || vec![delivery(None, "delivered", None)];
    let unpressed = || vec![delivery(None, "held", Some("no-press"))];
    for deliveries in [nobodys(), unpressed()] {
        assert_eq!(offered(Some(this.as_str()), true, deliveries.clone()), ["4711"]);
        assert!(offered(Some("another"), true, deliveries).is_empty(), "of an earlier patient");
    }
    assert_eq!(offered(Some(this.as_str()), false, unpressed()), ["4711"]);
    assert!(offered(Some(this.as_str()), false, nobodys()).is_empty(), "every press was heard");
    let of_0815 = vec![delivery(Some("0815"), "held", Some("export-late"))];
    assert!(offered(Some(this.as_str()), true, of_0815).is_empty(), "it can be released");
}
