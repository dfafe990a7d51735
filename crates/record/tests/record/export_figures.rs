//! The figures that go to systems of others are those of the measuring sheet, to the last digit and with the same
//! marks.

#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;

use gaiter_language::Language;
use gaiter_leg::{Level, Side};
use gaiter_record::Record;
use gaiter_record::export::{ExportFigure, What, export_figures};
use gaiter_record::report::{Reliability, ReportContent, ReportFigure};
use gaiter_sizes::Garment;
use support::records::{bodies, marked};

/// The girths and heights of the sheet that are not estimated, with their marks, by leg and box.
fn on_sheet(record: &Record) -> BTreeMap<String, String> {
    let content = ReportContent::from_record(record, Language::En, &Garment::default());
    let mut told = BTreeMap::new();
    let mut tell = |side: Side, code: String, figure: &ReportFigure| {
        if ![Reliability::Missing, Reliability::Estimated].contains(&figure.mark) {
            let words = format!("{} {:?}", figure.value, figure.mark);
            told.insert(format!("{} {code}", side.word()), words);
        }
    };
    for row in &content.levels.rows {
        for (side, leg) in Side::FROM_FRONT.into_iter().zip(&row.legs) {
            tell(side, format!("c{}", row.level), &leg.girth);
            if row.has_height {
                tell(side, format!("l{}", row.level), &leg.height);
            }
        }
    }
    told
}

fn exported(record: &Record) -> BTreeMap<String, String> {
    let mark = |figure: &ExportFigure| match (figure.is_by_hand, figure.doubts.is_empty()) {
        (true, _) => Reliability::ByHand,
        (false, true) => Reliability::Sure,
        (false, false) => Reliability::Doubtful,
    };
    let told = |figure: &ExportFigure| {
        let place = format!("{} {}", figure.side.word(), figure.code());
        (place, format!("{} {:?}", serde_json::to_string(&figure.cm).unwrap(), mark(figure)))
    };
    export_figures(record).iter().map(told).collect()
}

#[test]
fn every_figure_of_the_sheet_goes_out_with_its_digits_and_its_mark_and_no_other() {
    for (body, _, record) in bodies() {
        let told = exported(record);
        assert!(told.len() > 12, "{body}: only {told:?}");
        assert_eq!(told, on_sheet(record), "{body}");
    }
    let record = marked();
    let told = exported(&record);
    assert_eq!(told, on_sheet(&record));
    let of = |place: &str| told.get(place).map(String::as_str);
    assert_eq!((of("right cC"), of("right cB")), (Some("22.4 Doubtful"), Some("23.1 ByHand")));
    assert_eq!((of("right cE"), of("right lE"), of("right cD")), (None, None, None));
}

#[test]
fn figures_come_in_the_order_of_the_sheet_and_the_foot_has_no_heights() {
    for (body, _, record) in bodies() {
        let figures = export_figures(record);
        let place = |figure: &ExportFigure| {
            let levels = Level::ALL.iter().rev().position(|level| *level == figure.level);
            (figure.side == Side::Left, levels, figure.what == What::Height)
        };
        assert!(figures.is_sorted_by_key(place), "{body}: {figures:?}");
        let has_height = |figure: &ExportFigure| figure.what == What::Height;
        let lowest = figures.iter().filter(|of| has_height(of)).map(|of| of.level).min();
        assert!(lowest.is_some_and(|level| level >= Level::B), "{body}: {lowest:?}");
    }
}

#[test]
fn a_figure_has_its_error_and_its_doubts_unless_a_person_set_it() {
    let record = marked();
    let figures = export_figures(&record);
    let of =
        |code: &str| figures.iter().find(|of| of.side == Side::Right && of.code() == code).unwrap();
    let c = of("cC");
    assert_eq!((c.sd_cm, c.is_by_hand), (Some(0.123), false));
    assert_eq!(c.doubts, ["gap", "never-heard-of"]);
    let b = of("cB");
    assert_eq!((b.sd_cm, b.is_by_hand, b.doubts.len()), (None, true, 0));
    assert!(!of("lB").is_by_hand);
}
