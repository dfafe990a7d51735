//! The report has words in both languages for everything that a record can say of its scan.

#![allow(clippy::unwrap_used)]

use std::collections::BTreeSet;
use std::fs;

use gaiter_cad::{CadFault, End, EndNotPlane};
use gaiter_language::Language;
use gaiter_leg::doubt::Doubt;
use gaiter_leg::finding::Severity;
use gaiter_leg::level::By;
use gaiter_leg::{Finding, Level, Side, What};
use gaiter_record::Record;
use gaiter_record::chart::VolumeFigures;
use gaiter_record::report::ReportContent;
use gaiter_record::schema::FindingNote;
use gaiter_record::shape::ShapeFigures;
use gaiter_record::statement::Statement;
use gaiter_sizes::Garment;
use gaiter_spline::tessellate::TessellationFault;
use serde_json::json;

use crate::every_finding::all;

/// A record of no leg with these findings, by code, message and statement.
fn record(findings: &[(String, String, Option<Statement>)]) -> Record {
    let note = |(code, message, says): &(String, String, Option<Statement>)| FindingNote {
        says: says.clone(),
        code: code.clone(),
        leg: Some("left".to_owned()),
        message: message.clone(),
        ..FindingNote::not_vouched()
    };
    let record = json!({
        "schema": "gaiter.leg-record/1", "revision": 1, "station": null, "patient": null,
        "acquired": null, "made_by": {"gaiter": "0.1.0", "method": {}},
        "scan": {"sha256": "0", "format": "obj", "unit": "mm", "unit_inferred": false,
                 "points": 0, "triangles": 0},
        "body": {"stature_mm": null, "crotch_height_mm": null, "crotch_from": "saddle",
                 "facing_deg": 0.0,
                 "facing_from": "feet", "from_export": vec![0.0; 16]},
        "legs": [], "differences": null, "findings": findings.iter().map(note).collect::<Vec<_>>(),
    });
    serde_json::from_value(record).unwrap()
}

/// The codes that the functions `code` of these files hand out to records.
fn codes() -> BTreeSet<String> {
    let sources = [
        "crates/leg/src/finding.rs",
        "crates/leg/src/doubt.rs",
        "crates/leg/src/frame/soles.rs",
        "crates/leg/src/comparison/difference.rs",
        "crates/leg/src/comparison/opinion.rs",
        "crates/cad/src/kind.rs",
        "crates/record/src/report/pdf.rs",
    ];
    let text = sources.map(|source| fs::read_to_string(support::root().join(source)).unwrap());
    let after = text.iter().flat_map(|text| text.split("=> \"").skip(1));
    let quoted = after.filter_map(|rest| rest.split('"').next());
    let severities = Severity::ALL.map(Severity::word);
    let quoted = quoted.filter(|word| {
        word.starts_with(|first: char| first.is_ascii_lowercase()) && !severities.contains(word)
    });
    quoted.map(str::to_owned).collect()
}

#[test]
fn every_code_has_a_title_a_meaning_and_an_action_in_both_languages() {
    let codes = codes();
    assert!(codes.len() > 28, "only {codes:?}");
    for code in &codes {
        let record = record(&[(code.clone(), String::new(), None)]);
        let notes = Language::ALL.map(|language| {
            ReportContent::from_record(&record, language, &Garment::default()).notes.entries
        });
        let [english, german] = notes.map(|notes| notes[0].clone());
        for note in [&english, &german] {
            assert!(note.meaning.is_some() && note.action.is_some(), "{code}: {note:?}");
        }
        assert_ne!(english.title, german.title, "{code}");
        assert_ne!(english.meaning, german.meaning, "{code}");
        assert_ne!(english.action, german.action, "{code}");
    }
}

/// A code, words of its title in both languages, and of its meaning in German.
const KEYWORDS: [[&str; 4]; 50] = [
    ["level-absent", "absent", "fehlt", "nicht gefunden"],
    ["level-implausible", "plausible", "plausibel", "120 cm"],
    ["shallow", "stands out", "kaum", "kehrt dort kaum um"],
    ["flat", "uncertain", "unsicher", "fast gleich"],
    ["double", "second", "zweite", "zweite Stelle"],
    ["several", "Several turning", "Wendestellen", "Sockenrand"],
    ["unusual-height", "Unusual", "Ungewöhnlich", "verdecken"],
    ["edge", "edge of the visible", "Rand", "vom Ende"],
    ["gap", "partly", "teilweise", "30°"],
    ["scatter", "scatter", "streuen", "nicht eine Haut"],
    ["cloth", "Cloth", "Kleidung", "Rand einer Binde"],
    ["views-apart", "views do not meet", "Kamerabilder", "Kamera wurde bewegt"],
    ["smoothed", "smoothed", "geglättet", "zu seinen Nachbarn"],
    ["folds", "folded", "Falten", "Hautfalten"],
    ["not-seen", "Skin not", "Haut nicht", "nicht zu messen"],
    ["knee-bent", "Knee bent", "Knie gebeugt", "so großem Winkel"],
    ["below-d", "below D", "unter D", "gefundenen D"],
    ["sole-not-seen", "Sole", "Sohle", "Sohle"],
    ["height-not-measured", "Height", "Höhe", "gewünschte Höhe"],
    ["girth-uncertain", "Girth uncertain", "Umfang unsicher", "größer als 5 mm"],
    ["facing-unchecked", "not checked", "nicht geprüft", "Füße zeigen nicht"],
    ["facing-by-calves", "by the calves", "nach den Waden", "Füße zeigen nicht"],
    ["floor-uneven", "level", "eben", "waagerechten Ebene"],
    ["feet-cut", "Sole not", "Fußrand", "Schuhe"],
    ["mirror-unchecked", "Mirror", "Spiegelung", "spiegelverkehrt"],
    ["no-faces", "without a mesh", "ohne Netz", "nur Punkte"],
    ["no-line-end", "line end", "Zeilenende", "ohne Zeilenende"],
    ["coarse", "far apart", "weit auseinander", "liegen 10 mm und mehr"],
    ["foot-forward", "One foot", "Ein Fuß", "weit vor dem anderen"],
    ["thighs-touch", "Thighs", "Oberschenkel", "berühren sich"],
    ["proportions", "proportions", "Proportionen", "Der Schritt liegt"],
    ["crown-not-seen", "Head not in", "Kopf nicht", "Füßen und Schritt geschätzt"],
    ["thigh-axis-missing", "without an axis", "ohne Achse", "quer zum Unterschenkel"],
    ["crotch-uncertain", "Crotch uncertain", "Schritt unsicher", "gute Schätzung"],
    ["crotch-not-seen", "Crotch not seen", "Schritt nicht", "Körpergröße geschätzt"],
    ["leg-cut", "its top", "bis oben", "gewissen Höhe"],
    ["leg-not-measured", "Leg not measured", "nicht vermessen", "nicht zu vermessen"],
    ["no-surface", "No surface", "Keine Oberfläche", "zu wenig vom Bein"],
    ["surface-short", "too short", "zu kurz", "20 mm unter B"],
    ["holes-filled", "filled by", "gefüllt", "keine Kamera"],
    ["surface-holes", "holes", "Lücken", "Lücken glatt"],
    ["ends-not-plane", "Solid", "Körper", "nicht eben"],
    ["mesh-not-made", "Mesh", "Netz", "keine Dreiecke"],
    ["paper-not-made", "paper", "PDF", "report.pdf"],
    ["legs-differ", "differ", "unterscheiden", "Schwellung"],
    ["ord-disagrees", "measures differ", "anders", "Scanner"],
    ["ord-sides", "swapped", "vertauscht", "Bein"],
    ["ord-unit", "unit", "Einheit", "Einheit"],
    ["ord-unreadable", "not readable", "nicht lesbar", "Scan"],
    ["ord-ambiguous", "Several", "Mehrere", "keine wurde verwendet"],
];

#[test]
fn the_words_of_a_code_are_its_own_and_of_no_other() {
    let known: BTreeSet<String> = KEYWORDS.iter().map(|[code, ..]| (*code).to_owned()).collect();
    assert_eq!(known, codes());
    for [code, english, german, meaning] in KEYWORDS {
        let record = record(&[(code.to_owned(), String::new(), None)]);
        let notes = Language::ALL.map(|language| {
            ReportContent::from_record(&record, language, &Garment::default()).notes.entries
        });
        let [in_english, in_german] = notes.each_ref().map(|notes| &notes[0]);
        assert!(in_english.title.contains(english), "{code}: {in_english:?}");
        assert!(in_german.title.contains(german), "{code}: {in_german:?}");
        assert!(in_german.meaning.as_ref().unwrap().contains(meaning), "{code}: {in_german:?}");
    }
}

/// Words of messages whose exchange would hurt, and the same in German.
const ALIKE: [[&str; 2]; 12] = [
    ["the left leg's girth", "Umfang des linken Beins"],
    ["the right leg's girth", "Umfang des rechten Beins"],
    ["the left leg's volume", "Volumen des linken Beins"],
    ["the right leg's volume", "Volumen des rechten Beins"],
    ["calf girth", "Wadenumfang"],
    ["ankle girth", "Knöchelumfang"],
    ["body height", "Körpergröße"],
    ["361 mm left", "links 361 mm"],
    ["the skin is", "Die Haut ist"],
    ["where the search begins", "wo die Suche beginnt"],
    ["where the search ends", "wo die Suche endet"],
    ["leg is seen up to", "Das Bein ist nur bis"],
];

#[test]
fn a_message_in_german_is_about_the_same_leg_and_measure() {
    let mut seen = BTreeSet::new();
    for what in all() {
        let finding = Finding { side: Some(Side::Left), level: None, what };
        let says = Statement::of_finding(&finding.what);
        let message = says.in_english();
        let record = record(&[(finding.code().to_owned(), message.clone(), Some(says))]);
        let german =
            ReportContent::from_record(&record, Language::De, &Garment::default()).notes.entries[0]
                .message
                .clone();
        for [english, in_german] in ALIKE {
            if message.contains(english) {
                assert!(german.contains(in_german), "{message:?}: {german:?}");
                seen.insert(english);
            }
        }
    }
    assert_eq!(seen.len(), ALIKE.len(), "{seen:?}");
}

#[test]
fn a_code_of_a_later_version_is_told_by_its_message() {
    let record = record(&[("new-code".to_owned(), "something new".to_owned(), None)]);
    for language in Language::ALL {
        let notes = ReportContent::from_record(&record, language, &Garment::default()).notes;
        let [note] = &notes.entries[..] else { unreachable!("{notes:?}") };
        assert_eq!((note.title.as_str(), note.message.as_str()), ("new-code", "Something new."));
        assert_eq!(note.is_message_english, language == Language::De);
        assert_eq!((&note.meaning, &note.action), (&None, &None));
    }
}

/// The figures of a text, the decimal sign set aside.
fn figures(text: &str) -> Vec<String> {
    let parts = text.split(|c: char| !c.is_ascii_digit() && !",.".contains(c));
    let parts = parts.map(|part| part.trim_matches([',', '.']).replace(',', "."));
    let mut figures: Vec<String> = parts.filter(|part| !part.is_empty()).collect();
    figures.sort();
    figures
}

#[test]
fn every_message_is_told_in_both_languages_with_all_its_figures() {
    for what in all() {
        let finding = Finding { side: Some(Side::Left), level: None, what };
        let says = Statement::of_finding(&finding.what);
        let message = says.in_english();
        assert_eq!(says.in_words(Language::En).as_ref(), Some(&message));
        let record = record(&[(finding.code().to_owned(), message.clone(), Some(says))]);
        let [english, german] = Language::ALL.map(|language| {
            let notes =
                ReportContent::from_record(&record, language, &Garment::default()).notes.entries;
            notes[0].clone()
        });
        assert!(!german.is_message_english, "no German for: {message}");
        assert_ne!(english.message, german.message);
        // One hole is `eine Lücke`.
        let told = figures(&message).into_iter().filter(|figure| figure != "1");
        let missing: Vec<String> =
            told.filter(|figure| !figures(&german.message).contains(figure)).collect();
        assert!(missing.is_empty(), "{missing:?} of {message:?} in {:?}", german.message);
    }
}

#[test]
fn something_of_every_code_of_a_leg_was_told() {
    let told: BTreeSet<String> = all()
        .into_iter()
        .map(|what| Finding { side: None, level: None, what }.code().to_owned())
        .collect();
    // Those of the CAD files, and of a file that names its own line.
    let others =
        ["ends-not-plane", "mesh-not-made", "paper-not-made", "ord-unreadable"].map(str::to_owned);
    let missing: Vec<String> =
        codes().into_iter().filter(|code| !told.contains(code) && !others.contains(code)).collect();
    assert!(missing.is_empty(), "{missing:?}");
}

#[test]
fn by_what_a_level_is_found_is_told_in_german() {
    let ways = [
        By::Turn,
        By::Steepest,
        By::AboveB { distance_mm: 70.0 },
        By::BelowCrotch { distance_mm: 50.0 },
        By::HeelTape,
        By::Knee { stature_share: 0.277, above_d_mm: 45.0 },
        By::StatureShare { share: 0.277 },
        By::Between { low: Level::E, high: Level::G },
        By::FootShares { medial: 0.735, lateral: 0.635 },
    ];
    for by in ways {
        let english = Statement::from(by.said()).in_english();
        let mut record = serde_json::to_value(record(&[])).unwrap();
        record["legs"] = json!([{
            "side": "left", "tilt_deg": 1.0,
            "axis": {"foot_mm": vec![0.0; 3], "direction": vec![0.0; 3],
                "front": vec![0.0; 3], "lateral": vec![0.0; 3]},
            "landmarks": {"C": {"by": english, "rule": Statement::from(by.said()), "height_mm": 300.0, "along_axis_mm": 301.0,
                "girth_tape_mm": 380.0, "girth_contour_mm": 381.0, "height_sd_mm": null,
                "girth_sd_mm": null, "doubts": []}},
            "estimates": {},
            "girth_curve": {"height_mm": [], "along_axis_mm": [], "tape_mm": [], "contour_mm": [],
                "slope": [], "r2": 1.0, "rms_mm": 0.0},
            "sections": [], "features": [], "surface": null, "volume": VolumeFigures::default(),
            "at": [], "profile": [], "along": [], "shape": ShapeFigures::default(),
        }]);
        let record: Record = serde_json::from_value(record).unwrap();
        let told = Language::ALL.map(|language| {
            let table =
                ReportContent::from_record(&record, language, &Garment::default()).landmarks;
            let column = table.rows[0].figures.len() - 2;
            table.rows[0].figures[column].value.clone()
        });
        assert_eq!(told[0], english);
        assert_ne!(told[1], english);
        assert_eq!(figures(&told[1]).len(), figures(&english).len(), "{told:?}");
    }
}

#[test]
fn a_file_that_was_not_made_says_so_in_both_languages() {
    let tessellation = [
        TessellationFault::NoTolerance { tolerance_mm: -0.5 },
        TessellationFault::TooFine { tolerance_mm: 0.001, triangles: 9e9 },
        TessellationFault::Degenerate { u: 0.25, v: 1.5 },
    ];
    let ends = [End::First, End::Last].map(|end| EndNotPlane { end, off_mm: 0.125 });
    let faults = tessellation.map(CadFault::from).into_iter().chain(ends.map(CadFault::from));
    let mut seen = BTreeSet::new();
    for fault in faults {
        let says = Some(Statement::of_missing_file("left.stl", &fault));
        let english = says.as_ref().and_then(|says| says.in_words(Language::En));
        assert_eq!(english.unwrap(), format!("left.stl was not made: {fault}"));
        let record = record(&[(fault.code().to_owned(), "was not made".to_owned(), says)]);
        let note =
            ReportContent::from_record(&record, Language::De, &Garment::default()).notes.entries[0]
                .clone();
        assert!(!note.is_message_english, "{fault}");
        assert!(note.message.starts_with("left.stl wurde nicht erzeugt: "), "{note:?}");
        seen.insert(note.message);
    }
    assert_eq!(seen.len(), 5, "{seen:?}");
}

#[test]
fn a_figure_that_is_not_finite_is_told_to_be_unknown() {
    let what = What::Doubtful(Doubt::Flat { height_sd_mm: f64::INFINITY });
    let says = Statement::of_finding(&what);
    let text = serde_json::to_string(&says).unwrap();
    assert_eq!(serde_json::from_str::<Statement>(&text).unwrap(), says);
    for language in Language::ALL {
        let told = says.in_words(language).unwrap();
        assert!(told.contains("? mm"), "{told}");
    }
}
