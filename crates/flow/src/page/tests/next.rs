//! Who is next, as the page, the light and `gaiter patient show` show it.

use super::*;

/// The sentence on who is next, with ids and without.
fn next(booth: Situation<'_>, language: Language) -> [String; 2] {
    let page = page(booth, &[], language);
    let pieces = page.next.said.pieces.concat();
    assert_eq!(page.next.said.text, pieces);
    assert!(
        page.next.said.pieces.len() % 2 == 1,
        "words first and last: {:?}",
        page.next.said.pieces
    );
    [pieces, page.without_ids().next.said.text]
}

#[test]
fn who_is_next_is_named_with_a_button_and_without() {
    let ids = |ids: &[&str]| ids.iter().map(|id| (*id).to_owned()).collect::<Vec<_>>();
    let (none, one, two) = (ids(&[]), ids(&["4711"]), ids(&["4711", "0815"]));
    for (has_button, next_ids, awaited_for, awaited, english, german, hidden) in [
        (
            true,
            &none,
            &none,
            0,
            "No patient is named.",
            "Kein Patient ausgewählt.",
            "No patient is named.",
        ),
        (true, &one, &none, 0, "Next: 4711.", "Als Nächstes: 4711.", "The next patient is named."),
        (
            true,
            &two,
            &none,
            0,
            "4711 or 0815: who is in the booth?",
            "4711 oder 0815: Wer ist in der Kabine?",
            "More than one patient is named: who is in the booth?",
        ),
        (
            true,
            &none,
            &one,
            1,
            "4711's export is expected.",
            "Der Export von 4711 wird erwartet.",
            "One export is expected.",
        ),
        (
            true,
            &ids(&["12"]),
            &two,
            3,
            "Next: 12. The exports of 4711 and 0815 are expected. One export is expected.",
            "Als Nächstes: 12. Die Exporte von 4711 und 0815 werden erwartet. Ein Export wird erwartet.",
            "The next patient is named. 3 exports are expected.",
        ),
        (
            true,
            &none,
            &none,
            2,
            "2 exports are expected.",
            "2 Exporte werden erwartet.",
            "2 exports are expected.",
        ),
        (
            false,
            &none,
            &one,
            1,
            "4711's export is expected.",
            "Der Export von 4711 wird erwartet.",
            "The next patient is named.",
        ),
        (
            false,
            &none,
            &two,
            2,
            "4711 or 0815: who is in the booth?",
            "4711 oder 0815: Wer ist in der Kabine?",
            "More than one patient is named: who is in the booth?",
        ),
    ] {
        let booth =
            Situation { has_button, next: next_ids, awaited_for, awaited, ..booth(Signal::Ready) };
        assert_eq!(next(booth, Language::En), [english, hidden]);
        assert_eq!(next(booth, Language::De)[0], german);
    }
}

#[test]
fn those_who_may_be_next_are_told_once_each_and_nothing_in_their_ids_is_hidden() {
    let ids = ["4711", "0815\u{202e}", "4711"].map(str::to_owned);
    let who = page(Situation { next: &ids, ..booth(Signal::Ready) }, &[], Language::En).next.who;
    assert_eq!(who, ["4711", "0815\u{202e}"].map(PatientShown::new));
    assert_eq!((who[1].id.as_str(), who[1].shown.as_str()), ("0815\u{202e}", "0815[U+202E]"));
}

#[test]
fn while_it_is_in_doubt_who_is_next_the_light_asks_for_it_before_the_press() {
    let ids = ["1", "2"].map(str::to_owned);
    let shown = |next, is_asked| {
        page(Situation { next, is_asked, ..booth(Signal::Ready) }, &[], Language::En)
    };
    for next in [&ids[..], &ids[..1]] {
        assert!(shown(next, true).light.said.text.starts_with("Say who is in the booth"));
    }
    assert_eq!(shown(&ids[..1], true).next.said.text, "Is it 1 who is in the booth?");
    assert!(shown(&ids[..1], false).light.said.text.starts_with("Press the button"));
}

/// Red while the page asked who is in the booth as soon as a card was read during a scan.
#[test]
fn while_the_export_of_a_press_is_expected_nobody_is_asked_for_the_next() {
    let ids = ["1", "2"].map(str::to_owned);
    for (next, said, hidden) in [
        (&ids[..], "Next: 1 or 2.", "More than one patient is named."),
        (&ids[..1], "Next: 1.", "The next patient is named."),
    ] {
        let armed = Situation { next, is_asked: true, ..booth(Signal::Armed) };
        let shown = page(armed, &[], Language::En);
        assert!(!shown.next.is_asked && shown.next.is_asked_later);
        assert_eq!(shown.next.said.text, said);
        assert_eq!(shown.without_ids().next.said.text, hidden);
        // Without a button the answer is of that export.
        let armed = Situation { has_button: false, ..armed };
        assert!(page(armed, &[], Language::En).next.is_asked);
    }
}
