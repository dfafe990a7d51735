//! What the report says, figure by figure: each at its own leg, with its sign, its uncertainty, its
//! mark and its doubts, on the page and on paper alike.

#![allow(clippy::unwrap_used)]

use std::sync::LazyLock;

use gaiter_language::Language;
use gaiter_leg::Method;
use gaiter_leg::finding::Severity;
use gaiter_record::chart::{AtFigures, SliceFigures, VolumeDifferenceFigures};
use gaiter_record::picture::figures;
use gaiter_record::report::content::Table;
use gaiter_record::report::{self, Paper, Reliability, ReportContent, ReportFigure};
use gaiter_record::schema::{FindingNote, LegFigures};
use gaiter_record::{Record, RecordSummary};
use gaiter_sizes::Garment;
use support::page::words;
use support::recorded::export;
use support::records::record_of;

/// A body whose legs have figures that nobody takes for each other's: the left leg's are twice the
/// right leg's.
static RECORD: LazyLock<Record> = LazyLock::new(|| {
    let method = Method { at_heights_mm: vec![300.0], ..Method::default() };
    let mut record = record_of(&export("f_average_clean"), &method).1;
    record.legs.iter_mut().for_each(|leg| {
        let times = if leg.side == "left" { 2.0 } else { 1.0 };
        told_apart(leg, times);
    });
    let slice = |from_mm: f64, ml: f64| VolumeDifferenceFigures {
        from_mm,
        to_mm: from_mm + 40.0,
        ml,
        sd_ml: Some(2.0),
        percent: -ml / 2.0,
    };
    let differences = record.differences.as_mut().unwrap();
    differences.whole = Some(VolumeDifferenceFigures { percent: 100.0, ..slice(0.0, 1000.0) });
    differences.slices = vec![slice(0.0, -50.0), slice(40.0, 3.0)];
    record.findings.clear();
    record
});

fn told_apart(leg: &mut LegFigures, times: f64) {
    let volume = &mut leg.volume;
    (volume.whole_ml, volume.sd_ml) = (Some(times * 1000.0), Some(times * 10.0));
    (volume.b_to_d_ml, volume.b_to_d_sd_ml) = (Some(times * 100.0), Some(times * 3.0));
    (volume.from_height_mm, volume.to_height_mm) = (Some(times * 50.0), Some(times * 400.0));
    let slice = |from_mm: f64, ml: f64| SliceFigures {
        from_mm,
        to_mm: from_mm + 40.0,
        ml: Some(times * ml),
        sd_ml: Some(times),
    };
    volume.slices = vec![slice(0.0, 50.0), slice(40.0, 60.0)];
    let foot = leg.foot.as_mut().unwrap();
    (foot.length_mm, foot.breadth_mm) = (times * 120.0, times * 50.0);
    let [at] = &mut leg.at[..] else { unreachable!("one height was asked for") };
    (at.girth_tape_mm, at.girth_sd_mm) = (Some(times * 200.0), Some(times));
    at.doubts = if times > 1.0 { vec!["gap".to_owned()] } else { Vec::new() };
    let girth = |height_mm: f64, mm: Option<f64>| AtFigures {
        height_mm,
        along_axis_mm: None,
        girth_tape_mm: mm.map(|mm| times * mm),
        girth_contour_mm: None,
        girth_sd_mm: mm.map(|_| times),
        doubts: Vec::new(),
    };
    // At 12 cm the right leg was not seen, and only the left one reaches 16 cm.
    leg.profile = vec![girth(80.0, Some(180.0)), girth(120.0, (times > 1.0).then_some(210.0))];
    leg.profile.extend((times > 1.0).then(|| girth(160.0, Some(230.0))));
    let error = &mut leg.surface.as_mut().unwrap().to_points;
    (error.rms_mm, error.p95_mm, error.max_mm) = (times * 0.11, times * 0.22, times * 0.33);
    leg.landmarks.values_mut().for_each(|found| found.doubts.clear());
    leg.estimates.values_mut().for_each(|of| of.doubts.clear());
    let c = leg.landmarks.get_mut("C").unwrap();
    (c.girth_tape_mm, c.height_mm) = (times * 200.0, times * 150.0);
    (c.girth_sd_mm, c.height_sd_mm) = (Some(times), Some(times * 3.0));
    let e = leg.estimates.get_mut("E").unwrap();
    (e.girth_tape_mm, e.height_mm) = (times * 190.0, times * 250.0);
    (e.girth_sd_mm, e.height_sd_mm) = (Some(times * 2.0), Some(times * 7.0));
}

/// A figure as people see it.
fn told(figure: &ReportFigure) -> String {
    let margin = figure.margin.as_ref().map(|margin| format!(" ± {margin}")).unwrap_or_default();
    let [before, behind] = match figure.mark {
        Reliability::ByHand => ["", " *"],
        Reliability::Doubtful => ["", " ?"],
        Reliability::Estimated => ["~", ""],
        Reliability::Real => ["*", "*"],
        Reliability::Sure | Reliability::Missing => ["", ""],
    };
    format!("{before}{}{margin}{behind}", figure.value)
}

fn rows(table: &Table) -> Vec<Vec<String>> {
    let row = |of: &report::content::TableRow| {
        [of.head.clone()].into_iter().chain(of.figures.iter().map(told)).collect()
    };
    table.rows.iter().map(row).collect()
}

#[test]
fn every_volume_girth_and_foot_stands_at_its_own_leg_with_its_sign_and_uncertainty() {
    let content = ReportContent::from_record(&RECORD, Language::En, &Garment::default());
    let [same, asked, volumes] = &content.tables[..] else { unreachable!() };
    let slices = content.slices.as_ref().unwrap();
    for table in [same, asked, volumes, slices] {
        assert_eq!(table.columns[1..3], ["Right leg", "Left leg"], "{}", table.title);
    }
    assert_eq!(
        rows(volumes),
        [
            ["Whole leg", "1000 ± 20", "2000 ± 40", "*+1000 ± 4*", "*+100.0*"],
            ["Between B and D", "100 ± 6", "200 ± 12", "not compared", "not compared"],
        ]
    );
    let range = volumes.explanation.as_ref().unwrap();
    assert!(range.contains("(right leg 5.0 to 40.0 cm, left leg 10.0 to 80.0 cm)"), "{range}");
    assert_eq!(rows(asked), [["30.0 cm", "20.0 ± 0.2", "40.0 ± 0.4 ?"]]);
    assert_eq!(
        rows(same),
        [
            ["12.0", "not seen there", "42.0 ± 0.4", "not compared"],
            ["8.0", "18.0 ± 0.2", "36.0 ± 0.4", "*+18.0 ± 0.5*"],
        ]
    );
    let lengths = content.levels.lengths.iter().take(2);
    let lengths: Vec<[String; 2]> = lengths.map(|row| row.figures.each_ref().map(told)).collect();
    assert_eq!(lengths, [["12.0", "24.0"], ["5.0", "10.0"]]);
    assert_eq!(
        rows(slices),
        [
            ["4–8", "60 ± 2", "120 ± 4", "+3 ± 4", "\u{2212}1.5"],
            ["0–4", "50 ± 2", "100 ± 4", "*\u{2212}50 ± 4*", "*+25.0*"],
        ]
    );
    for (entry, [leg, rms, p95, max]) in content.surfaces.entries.iter().zip([
        ["Right leg: ", " 0.11 mm from it", " than 0.22 mm", " place 0.33 mm"],
        ["Left leg: ", " 0.22 mm from it", " than 0.44 mm", " place 0.66 mm"],
    ]) {
        assert!(entry.starts_with(leg), "{entry}");
        assert!([rms, p95, max].iter().all(|words| entry.contains(words)), "{entry}");
    }
}

#[test]
fn a_height_has_its_own_uncertainty_an_estimate_is_marked_and_the_foot_has_no_heights() {
    let content = ReportContent::from_record(&RECORD, Language::En, &Garment::default());
    let row = |level: &str| content.levels.rows.iter().find(|row| row.level == level).unwrap();
    let level =
        |level: &str| row(level).legs.each_ref().map(|leg| [&leg.girth, &leg.height].map(told));
    assert_eq!(level("C"), [["20.0 ± 0.2", "15.0 ± 0.6"], ["40.0 ± 0.4", "30.0 ± 1.2"]]);
    assert_eq!(level("E"), [["~19.0 ± 0.4", "~25.0 ± 1.4"], ["~38.0 ± 0.8", "~50.0 ± 2.8"]]);
    assert!(["A", "Y"].iter().all(|of| level(of).iter().all(|[_, height]| height == "–")));
    let heads: Vec<&str> = content.landmarks.rows.iter().map(|row| row.head.as_str()).collect();
    assert!(heads.contains(&"E, left leg, estimated") && heads.contains(&"C, left leg"));
}

/// The record with these doubts at C and E of its legs.
fn doubted() -> Record {
    let mut record = RECORD.clone();
    for leg in &mut record.legs {
        leg.landmarks.get_mut("C").unwrap().doubts = vec!["gap".to_owned()];
        if leg.side == "left" {
            leg.estimates.get_mut("E").unwrap().doubts = vec!["below-d".to_owned()];
        }
    }
    record
}

#[test]
fn a_doubt_is_told_at_its_level_and_among_the_notes_with_all_its_places() {
    let content = ReportContent::from_record(&doubted(), Language::En, &Garment::default());
    let c = content.levels.rows.iter().find(|row| row.level == "C").unwrap();
    let doubts = ["Right leg – Skin partly not seen: C.", "Left leg – Skin partly not seen: C."];
    assert_eq!(content.levels.doubts, doubts);
    // A knee that would lie below D is no knee.
    let e = content.levels.rows.iter().find(|row| row.level == "E").unwrap();
    assert!(!e.legs[0].girth.is_missing() && e.legs[1].girth.is_missing(), "{e:?}");
    assert_eq!(e.legs[1].girth.value, "no estimate: D lies high");
    assert!(c.legs.iter().all(|leg| told(&leg.girth).ends_with(" ?")), "{c:?}");
    let [gap, below] = &content.notes.entries[..] else { unreachable!("{:?}", content.notes) };
    assert_eq!((gap.code.as_str(), gap.weight), ("gap", Severity::Warning));
    let mut places: Vec<&str> = gap.place.split(" · ").collect();
    places.sort_unstable();
    assert_eq!(places, ["left leg, C", "right leg, C"]);
    assert_eq!((below.code.as_str(), below.weight), ("below-d", Severity::Info));
    assert_eq!(below.place, "left leg, E");
    assert_eq!(content.summary, "Check before use: 1 · Worth knowing: 1");
}

#[test]
fn findings_of_one_code_are_one_note_that_keeps_every_message() {
    let finding = |leg: &str, message: &str| FindingNote {
        says: None,
        code: "leg-cut".to_owned(),
        severity: "warning".to_owned(),
        leg: Some(leg.to_owned()),
        level: None,
        message: message.to_owned(),
    };
    let findings = vec![finding("left", "seen to 5 mm"), finding("right", "seen to 7 mm")];
    let content = ReportContent::from_record(
        &Record { findings, ..RECORD.clone() },
        Language::En,
        &Garment::default(),
    );
    let [note] = &content.notes.entries[..] else { unreachable!("{:?}", content.notes) };
    assert_eq!(note.place, "left leg · right leg");
    assert_eq!(note.message, "left leg: Seen to 5 mm. right leg: Seen to 7 mm.");
}

#[test]
fn the_page_shows_marks_uncertainties_and_every_note_with_what_to_do() {
    let record = doubted();
    let content = ReportContent::from_record(&record, Language::En, &Garment::default());
    let document = content.clone().document(&record, &figures::all(&record, Language::En));
    let page = report::page(&document, Paper::A4).unwrap();
    let words = words(&page);
    assert_eq!(words.matches("20.0 ± 0.2 ?").count(), 1, "the measuring sheet");
    assert!(words.contains("~19.0 ± 0.4 ~25.0 ± 1.4"));
    assert!(words.contains("Measure by hand: right leg: C; left leg: C."));
    assert!(words.contains("1000 ± 20"));
    for note in &content.notes.entries {
        for text in [Some(&note.title), note.meaning.as_ref(), note.action.as_ref()] {
            assert!(words.contains(text.unwrap().as_str()), "{text:?}");
        }
    }
    for table in &content.tables {
        assert!(table.explanation.iter().all(|text| words.contains(text.as_str())), "{table:?}");
    }
}

#[test]
fn in_german_right_is_rechts_and_every_level_is_where_it_is_on_the_leg() {
    let content = ReportContent::from_record(&RECORD, Language::De, &Garment::default());
    assert_eq!(content.levels.columns.legs, ["Rechtes Bein", "Linkes Bein"]);
    for table in &content.tables {
        assert_eq!(table.columns[1..3], ["Rechtes Bein", "Linkes Bein"], "{}", table.title);
    }
    let rows: Vec<&str> = content.landmarks.rows.iter().map(|row| row.head.as_str()).collect();
    let place = |head: &str| rows.iter().position(|row| *row == head).unwrap();
    assert!(place("C, rechtes Bein") < place("C, linkes Bein"), "{rows:?}");
    for (level, words) in [
        ("A", "Vorfuß"),
        ("B", "Fessel"),
        ("C", "Wade"),
        ("D", "unter dem Knie"),
        ("E", "Mitte der Kniescheibe"),
    ] {
        let row = content.levels.rows.iter().find(|row| row.level == level).unwrap();
        assert!(row.place.starts_with(words), "{level}: {}", row.place);
    }
}

#[test]
fn at_a_glance_a_doubt_is_seen_and_the_notes_are_counted_as_in_the_report() {
    let mut record = doubted();
    for severity in ["error", "warning", "info"] {
        let (code, message) = ("leg-cut".to_owned(), String::new());
        let severity = severity.to_owned();
        record.findings.push(FindingNote {
            says: None,
            code,
            severity,
            leg: None,
            level: None,
            message,
        });
    }
    let brief = RecordSummary::from_record(&record, Language::De, &Garment::default());
    assert_eq!(
        brief.notes,
        ReportContent::from_record(&record, Language::De, &Garment::default()).summary
    );
    let names: Vec<&str> = brief.levels.iter().map(|level| level.level).collect();
    assert_eq!(names, ["D", "C", "B1", "B", "Y", "Fuß, Länge"], "what a calf stocking needs");
    for level in brief.levels.iter().filter(|level| level.right.is_some()) {
        let figures = [&level.right, &level.left].map(|leg| leg.as_ref().unwrap());
        let doubts = figures.map(|of| [of.is_girth_doubted, of.is_height_doubted]);
        assert_eq!(doubts, [[level.level == "C"; 2]; 2], "{}", level.level);
    }
    let girths =
        [&brief.levels[1].right, &brief.levels[1].left].map(|leg| &leg.as_ref().unwrap().girth_cm);
    assert_eq!(girths, ["20,0", "40,0"]);
}

#[test]
fn a_unit_that_was_found_was_not_declared_and_heights_of_the_body_are_its_own() {
    let mut record = RECORD.clone();
    (record.body.stature_mm, record.body.crotch_height_mm) = (Some(1604.0), Some(743.0));
    for (unit_inferred, words) in [(true, "unit mm, found)"), (false, "unit mm, declared)")] {
        record.scan.unit_inferred = unit_inferred;
        let facts = ReportContent::from_record(&record, Language::En, &Garment::default()).facts;
        let fact = |name: &str| &facts.iter().find(|fact| fact.name == name).unwrap().value;
        assert!(fact("Scan").ends_with(words), "{facts:?}");
        assert_eq!(fact("Body"), "stature 160.4 cm, crotch at 74.3 cm");
    }
}

#[test]
fn why_a_level_has_no_figure_is_told() {
    let mut record = RECORD.clone();
    for leg in &mut record.legs {
        ["D", "G"].into_iter().for_each(|level| drop(leg.landmarks.remove(level)));
    }
    for (code, why) in [
        ("level-absent", "not found"),
        ("level-implausible", "not plausible"),
        ("another", "not seen"),
    ] {
        record.findings = vec![FindingNote {
            says: None,
            code: code.to_owned(),
            severity: "warning".to_owned(),
            leg: Some("left".to_owned()),
            level: Some("D".to_owned()),
            message: String::new(),
        }];
        let levels = ReportContent::from_record(&record, Language::En, &Garment::default()).levels;
        let d = levels.rows.iter().find(|row| row.level == "D").unwrap();
        assert_eq!([&d.legs[0], &d.legs[1]].map(|leg| leg.girth.value.as_str()), ["not seen", why]);
        let g = levels.rows.iter().find(|row| row.level == "G").unwrap();
        assert!(g.legs.iter().all(|leg| leg.girth.value == "not seen"), "{g:?}");
    }
}

#[test]
fn a_level_that_one_leg_lacks_is_told_with_the_girth_at_the_other_s_height() {
    let mut record = RECORD.clone();
    let [left, right] =
        ["left", "right"].map(|side| record.legs.iter().position(|leg| leg.side == side).unwrap());
    record.legs[left].landmarks.remove("C");
    record.legs[right].landmarks.get_mut("C").unwrap().height_mm = 150.0;
    let curve = &mut record.legs[left].girth_curve;
    curve.height_mm = vec![Some(140.0), Some(145.0), Some(155.0)];
    curve.tape_mm = vec![Some(300.0), Some(310.0), Some(330.0)];
    let c = |record: &Record| {
        let levels = ReportContent::from_record(record, Language::En, &Garment::default()).levels;
        levels.rows.into_iter().find(|row| row.level == "C").unwrap().legs[1].girth.value.clone()
    };
    assert_eq!(c(&record), "not seen; here 32.0 cm at 15.0 cm, its height on the other leg");
    record.legs[left].girth_curve.tape_mm[2] = None;
    assert_eq!(c(&record), "not seen");
}
