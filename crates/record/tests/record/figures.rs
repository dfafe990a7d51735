//! What the figures of a record show: everything inside, no words over others, each leg on its side.
//!
//! `GAITER_SCANS=FOLDER` has the first two claims hold for every `.obj` of a folder too.

#![allow(clippy::unwrap_used)]

use std::path::PathBuf;
use std::sync::LazyLock;
use std::{env, fs};

use gaiter_language::Language;
use gaiter_leg::method::Up;
use gaiter_leg::{Method, Side};
use gaiter_record::Record;
use gaiter_record::picture::figures::{DrawnFigure, all};
use gaiter_record::picture::{Anchor, Ink, Mark};
use support::records::{bodies, measured, record_of};

/// The records of the folder `GAITER_SCANS`.
static OTHERS: LazyLock<Vec<(String, Record)>> = LazyLock::new(|| {
    let Some(folder) = env::var_os("GAITER_SCANS") else { return Vec::new() };
    let mut paths: Vec<PathBuf> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "obj"));
    let measured = paths.iter().map(|path| {
        let name = path.display().to_string();
        let up = if name.contains("zup") { Up::Z } else { Method::default().up };
        let record = record_of(&fs::read(path).unwrap(), &Method { up, ..Method::default() }).1;
        (name, record)
    });
    measured.collect()
});

const LANGUAGES: [Language; 2] = [Language::En, Language::De];

/// What the curves and marks of the legs are drawn with.
static LEGS: LazyLock<[Ink; 2]> = LazyLock::new(|| Side::BOTH.map(Ink::for_side));

/// Left, top, right, bottom of a line of words, px: letters are at most about 0.58 of their height
/// wide in the mean, and reach from 0.73 above the line to 0.22 below it.
fn place(mark: &Mark) -> Option<([f64; 4], &str)> {
    let Mark::Words { at: [x, y], anchor, size, words, .. } = mark else { return None };
    let width = 0.58 * size * words.chars().count() as f64;
    let left = match anchor {
        Anchor::Start => *x,
        Anchor::Middle => x - width / 2.0,
        Anchor::End => x - width,
    };
    Some(([left, y - 0.73 * size, left + width, y + 0.22 * size], words))
}

fn figures() -> impl Iterator<Item = (&'static str, Language, DrawnFigure)> {
    let recorded = bodies().map(|(name, _, record)| (name, record));
    let others = OTHERS.iter().map(|(name, record)| (name.as_str(), record));
    recorded.chain(others).flat_map(|(name, record)| {
        let of = move |language| all(record, language).into_iter().map(move |f| (language, f));
        LANGUAGES.into_iter().flat_map(of).map(move |(language, f)| (name, language, f))
    })
}

#[test]
fn words_are_never_written_over_words() {
    let mut faults = Vec::new();
    for (body, language, figure) in figures() {
        let places: Vec<_> = figure.picture.marks.iter().filter_map(place).collect();
        for (index, (a, first)) in places.iter().enumerate() {
            for (b, second) in &places[index + 1..] {
                // Letters may touch; half a px more is a fault.
                let over =
                    a[2].min(b[2]) - a[0].max(b[0]) > 0.5 && a[3].min(b[3]) - a[1].max(b[1]) > 0.5;
                if over {
                    faults.push(format!(
                        "{body}, {}, {language:?}: {first:?} {a:.0?} {second:?} {b:.0?}",
                        figure.name
                    ));
                }
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// How much of a label of the chart may lie under a curve, px: its edge.
const UNDER_MAX: f64 = 3.0;

#[test]
fn no_label_of_a_level_lies_on_the_mark_or_on_the_curve_of_the_other_leg() {
    let mut faults = Vec::new();
    for (body, language, figure) in figures().filter(|(.., figure)| figure.name == "girths") {
        let marks = &figure.picture.marks;
        let inks = |mark: &Mark| match mark {
            Mark::Lines { lines, fill, stroke, .. } => {
                let ink = fill.or(stroke.map(|stroke| stroke.ink));
                ink.filter(|ink| LEGS.contains(ink)).map(|_| lines.clone())
            }
            _ => None,
        };
        let drawn: Vec<[[f64; 2]; 2]> = marks
            .iter()
            .filter_map(inks)
            .flatten()
            .flat_map(|line| line.windows(2).map(|pair| [pair[0], pair[1]]).collect::<Vec<_>>())
            .collect();
        for (label, words) in marks.iter().filter_map(place) {
            // `R C 31.5`; the legend's `R right leg` stands below the chart.
            let is_level = (words.starts_with("R ") || words.starts_with("L ")) && label[1] < 470.0;
            let [left, top, right, bottom] = label;
            let inner = [left + UNDER_MAX, top, right - UNDER_MAX, bottom];
            if is_level && drawn.iter().any(|pair| crosses(*pair, inner)) {
                faults.push(format!("{body}, {language:?}: {words:?} {label:.0?}"));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// Whether a line between two places comes into a rectangle; looked at every half px.
fn crosses([from, to]: [[f64; 2]; 2], [left, top, right, bottom]: [f64; 4]) -> bool {
    let steps = (2.0 * (to[0] - from[0]).hypot(to[1] - from[1])).ceil().max(1.0);
    (0..=steps as usize).any(|step| {
        let share = step as f64 / steps;
        let [x, y] = [0, 1].map(|axis| from[axis] + share * (to[axis] - from[axis]));
        (left..=right).contains(&x) && (top..=bottom).contains(&y)
    })
}

#[test]
fn nothing_is_drawn_outside_a_figure() {
    let mut faults = Vec::new();
    for (body, language, figure) in figures() {
        let [width, height] = figure.picture.size;
        let mut check = |[x, y]: [f64; 2], what: &str| {
            let inside = (-0.5..=width + 0.5).contains(&x) && (-0.5..=height + 0.5).contains(&y);
            if !inside {
                faults.push(format!("{body}, {}, {language:?}: {what} at {x}, {y}", figure.name));
            }
        };
        for mark in &figure.picture.marks {
            match mark {
                Mark::Lines { lines, .. } => {
                    lines.iter().flatten().for_each(|at| check(*at, "line"))
                }
                Mark::Dots { at, .. } => at.iter().for_each(|at| check(*at, "dot")),
                Mark::Words { .. } => {
                    if let Some((of, words)) = place(mark) {
                        check([of[0], of[1]], words);
                        check([of[2], of[3]], words);
                    }
                }
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

pub fn figure(record: &Record, name: &str) -> DrawnFigure {
    all(record, Language::En).into_iter().find(|figure| figure.name == name).unwrap()
}

pub fn words_of(figure: &DrawnFigure) -> Vec<([f64; 2], &str)> {
    let words = figure.picture.marks.iter().filter_map(|mark| match mark {
        Mark::Words { at, words, .. } => Some((*at, words.as_str())),
        _ => None,
    });
    words.collect()
}

#[test]
fn from_the_front_and_in_every_pair_the_patients_right_leg_is_on_the_left() {
    for (body, _, record) in bodies() {
        for name in ["views", "sections", "fit", "error"] {
            let figure = figure(record, name);
            let words = words_of(&figure);
            let x = |leg: &str| words.iter().find(|(_, word)| *word == leg).unwrap().0[0];
            assert!(x("right leg") < x("left leg"), "{body}, {name}");
        }
        // From the back, the second view, it is the other way round.
        let figure = figure(record, "views");
        let words = words_of(&figure);
        let x = |leg: &str| words.iter().filter(|(_, word)| *word == leg).nth(1).unwrap().0[0];
        assert!(x("right leg") > x("left leg"), "{body}");
    }
}

#[test]
fn the_chart_names_every_level_across_the_leg_with_the_girth_of_the_record() {
    for (body, _, record) in bodies() {
        let figure = figure(record, "girths");
        let words = words_of(&figure);
        for leg in &record.legs {
            for (level, found) in leg.landmarks.iter().filter(|(level, _)| *level != "Y") {
                let of = if leg.side == "left" { "L" } else { "R" };
                let label = format!("{of} {level} {:.1}", found.girth_tape_mm.round() / 10.0);
                assert!(words.iter().any(|(_, word)| *word == label), "{body}: {label}");
            }
        }
    }
}

#[test]
fn no_curve_runs_through_the_girths_of_the_feet() {
    let mut seen = 0;
    for (body, language, figure) in figures().filter(|(.., figure)| figure.name == "girths") {
        let feet: Vec<_> = figure
            .picture
            .marks
            .iter()
            .filter_map(place)
            .filter(|(_, w)| w.contains(": "))
            .collect();
        seen += feet.len();
        let curves = figure.picture.marks.iter().filter_map(|mark| match mark {
            Mark::Lines { lines, stroke: Some(stroke), .. } if stroke.width >= 2.0 => Some(lines),
            _ => None,
        });
        for [x, y] in curves.flatten().flatten() {
            for ([left, top, right, bottom], words) in &feet {
                let is_in = (*left..=*right).contains(x) && (*top..=*bottom).contains(y);
                assert!(!is_in, "{body}, {language:?}: {words} at {x}, {y}");
            }
        }
    }
    // Two of each recorded body in each language; of others as many as are seen.
    assert!(seen >= 12, "{seen}");
}

#[test]
fn every_feature_point_of_the_papers_levels_has_its_name_on_its_section_and_on_its_curvature() {
    for (body, _, record) in bodies() {
        let figure = figure(record, "sections");
        let names = words_of(&figure).into_iter().filter(|(_, word)| word.starts_with('P')).count();
        let is_drawn = |level: &str| ["B", "B1", "C", "D"].contains(&level);
        let features = record.legs.iter().flat_map(|leg| &leg.features);
        let expected = features.filter(|feature| is_drawn(&feature.level)).count();
        assert_eq!(names, 2 * expected, "{body}");
    }
}

#[test]
fn the_map_of_the_error_agrees_with_the_error_of_the_points() {
    for (body, extraction, record) in bodies() {
        for (leg, figures) in extraction.legs.iter().zip(&record.legs) {
            let surface = leg.surface.as_ref().unwrap();
            let told = figures.shape.surface.as_ref().unwrap();
            let seen: Vec<f64> = told.error.as_errors_mm().into_iter().flatten().collect();
            let rms_mm = (seen.iter().map(|mm| mm * mm).sum::<f64>() / seen.len() as f64).sqrt();
            // Means of several points each: less noise than in the points themselves.
            assert!(rms_mm <= surface.to_points.rms_mm, "{body}: {rms_mm}");
            let mean_mm = seen.iter().sum::<f64>() / seen.len() as f64;
            assert!(mean_mm.abs() < 0.05, "{body}: {mean_mm}");
            assert_eq!(told.points.as_points().len(), told.rows * told.columns);
            assert_eq!(told.error.as_errors_mm().len(), told.rows * told.columns);
        }
    }
}

#[test]
fn a_record_without_legs_has_no_figures() {
    let mut record = measured("f_average_clean").1.clone();
    record.legs.clear();
    assert_eq!(all(&record, Language::De), []);
}

#[test]
fn a_lone_leg_is_drawn_alone_and_the_other_is_said_not_to_be_there() {
    let mut record = measured("f_average_clean").1.clone();
    record.legs.retain(|leg| leg.side == "left");
    let count = |figure: &DrawnFigure, word: &str| {
        words_of(figure).into_iter().filter(|(_, found)| *found == word).count()
    };
    assert_eq!(count(&figure(&record, "views"), "right leg"), 0);
    assert_eq!(count(&figure(&record, "sections"), "not found"), 4);
    assert_eq!(count(&figure(&record, "error"), "no surface"), 1);
    assert!(all(&record, Language::En).iter().all(|figure| figure.name != "differences"));
    // What is missing is the right leg's, which is on the left.
    for (name, said) in [("sections", "not found"), ("fit", "not found"), ("error", "no surface")] {
        let figure = figure(&record, name);
        let words = words_of(&figure);
        let mut missing = words.iter().filter(|(_, word)| *word == said);
        assert!(missing.all(|([x, _], _)| *x < figure.picture.size[0] / 2.0), "{name}");
    }
}
