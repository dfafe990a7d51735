//! Left and right, front and back, in and out in the figures of a record: each thing on its own leg
//! and on its own side of it.

#![allow(clippy::unwrap_used)]

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use gaiter_leg::Side;
use gaiter_record::picture::{Ink, Mark};
use support::records::{bodies, measured};

use crate::figures::{figure, words_of};

#[test]
fn a_section_has_its_front_up_and_its_lateral_side_outward() {
    for (body, _, record) in bodies() {
        let figure = figure(record, "sections");
        let outlines = figure.picture.marks.iter().filter_map(|mark| match mark {
            Mark::Lines { lines, fill: Some(Ink::Skin), stroke: Some(stroke), .. } => {
                Some((stroke.ink, &lines[0]))
            }
            _ => None,
        });
        let outlines: Vec<_> = outlines.collect();
        assert!(outlines.len() >= 6, "{body}");
        for (ink, line) in outlines {
            let quarter = line.len() / 4;
            let [back, medial, front, lateral] = [0, 1, 2, 3].map(|at| line[at * quarter]);
            assert!(front[1] < back[1], "{body}");
            assert_eq!(lateral[0] > medial[0], ink == Ink::for_side(Side::Left), "{body}");
        }
    }
}

#[test]
fn directions_are_named_where_they_are() {
    let row = |name: &str| {
        let figure = figure(&measured("f_average_clean").1, name);
        let is_side = |word: &str| ["inner", "outer"].contains(&word);
        let words = words_of(&figure).into_iter().filter(|(_, word)| is_side(word));
        let mut words: Vec<([f64; 2], String)> =
            words.map(|(at, word)| (at, word.to_owned())).collect();
        let top = words.iter().map(|([_, y], _)| *y).fold(f64::INFINITY, f64::min);
        words.retain(|([_, y], _)| *y < top + 1.0);
        words.sort_by(|(a, _), (b, _)| a[0].total_cmp(&b[0]));
        words.into_iter().map(|(_, word)| word).collect::<Vec<_>>()
    };
    for name in ["sections", "fit"] {
        assert_eq!(row(name), ["inner", "outer", "inner", "outer"], "{name}");
    }
    // Unrolled as seen from in front.
    assert_eq!(row("error"), ["outer", "inner", "inner", "outer"]);
}

#[test]
fn the_scan_s_points_lie_on_the_curve_that_was_fitted_to_them() {
    for (body, _, record) in bodies() {
        let marks = figure(record, "fit").picture.marks;
        let mut seen = 0;
        for pair in marks.windows(2) {
            let [Mark::Dots { at: dots, .. }, Mark::Lines { lines, .. }] = pair else { continue };
            if dots.len() < 20 {
                continue;
            }
            let off = |[x, y]: &[f64; 2]| {
                let near = lines[0].windows(2).find(|pair| pair[0][0] <= *x && *x <= pair[1][0]);
                let [from, to] = near.map(|pair| [pair[0], pair[1]]).unwrap_or_default();
                let share = (x - from[0]) / (to[0] - from[0]).max(1e-9);
                (y - from[1] - share * (to[1] - from[1])).abs()
            };
            let mean = dots.iter().map(off).sum::<f64>() / dots.len() as f64;
            assert!(mean < 3.0, "{body}: {mean} px");
            seen += 1;
        }
        assert!(seen >= 6, "{body}: {seen}");
    }
}

/// The base64 of what lies this far outside at each place of rows of a map, 0.01 mm.
fn packed(rows: usize, row: &[i16]) -> String {
    let bytes = (0..rows).flat_map(|_| row.iter().flat_map(|of| of.to_le_bytes()));
    STANDARD.encode(bytes.collect::<Vec<u8>>())
}

#[test]
fn what_lies_outside_on_the_lateral_side_is_drawn_there_in_the_colour_that_the_scale_gives_it() {
    let mut record = serde_json::to_value(&measured("f_average_clean").1).unwrap();
    for leg in record["legs"].as_array_mut().unwrap() {
        let surface = &mut leg["shape"]["surface"];
        let [rows, columns] =
            ["rows", "columns"].map(|key| surface[key].as_u64().unwrap() as usize);
        let mut row = vec![0; columns];
        (row[columns / 4], row[columns * 3 / 4]) = (-100, 100);
        surface["error"] = packed(rows, &row).into();
    }
    let figure = figure(&serde_json::from_value(record).unwrap(), "error");
    let places = |ink: Ink| {
        let areas = figure.picture.marks.iter().filter_map(move |mark| match mark {
            Mark::Lines { lines, fill, .. } if *fill == Some(ink) => Some(lines),
            _ => None,
        });
        areas.flatten().map(|area| [0, 1].map(|axis| (area[0][axis] + area[2][axis]) / 2.0))
    };
    let words = words_of(&figure);
    for (off, on_right_leg, scale) in [(1.0, true, "1.0"), (-1.0, false, "-1.0")] {
        let all: Vec<[f64; 2]> = places(Ink::Off(off)).collect();
        let (key, map): (Vec<_>, Vec<_>) = all.into_iter().partition(|[_, y]| *y > 440.0);
        // Lateral is the outer side, medial the inner one.
        let is_outer = |[x, _]: &[f64; 2]| !(191.0..551.0).contains(x);
        assert!(map.len() > 20 && map.iter().all(|at| is_outer(at) == on_right_leg), "{off}");
        // Each map has its scale.
        assert_eq!(key.len(), 2, "{key:?}");
        for [x, _] in key {
            let near = words.iter().find(|([at, y], _)| (at - x).abs() < 1.0 && *y > 440.0);
            assert_eq!(near.map(|(_, word)| *word), Some(scale));
        }
    }
}

#[test]
fn a_record_tells_the_map_as_it_was_found_and_each_place_of_a_grid_on_its_side() {
    for (body, extraction, record) in bodies() {
        for (leg, figures) in extraction.legs.iter().zip(&record.legs) {
            let shape = &figures.shape;
            let told = shape.surface.as_ref().unwrap();
            let found = &leg.surface.as_ref().unwrap().error_map.outside_mm;
            for (told, found) in told.error.as_errors_mm().iter().zip(found) {
                assert_eq!(told.is_some(), found.is_some(), "{body}");
                let off = told.zip(*found).map_or(0.0, |(told, found)| told - found);
                assert!(off.abs() <= 0.005 + 1e-9, "{body}: {told:?} {found:?}");
            }
            let axis = &figures.axis;
            let outward = if figures.side == "left" { 1.0 } else { -1.0 };
            assert!(axis.lateral[0] * outward > 0.5 && axis.front[1] < -0.5, "{body}: {axis:?}");
            for (points, columns) in
                [(&shape.skin.points, shape.skin.columns), (&told.points, told.columns)]
            {
                for row in points.as_points().chunks(columns) {
                    let [Some(back), Some(medial), Some(front), Some(lateral)] =
                        [0, 1, 2, 3].map(|at| row[at * columns / 4])
                    else {
                        continue;
                    };
                    assert!((lateral.x - medial.x) * outward > 0.0, "{body}: {lateral} {medial}");
                    assert!(front.y < back.y, "{body}: {front} {back}");
                }
            }
            for outline in figures.sections.iter().map(|at| &at.outline) {
                assert!(outline.curvature_per_mm.iter().sum::<f64>() > 0.0, "{body}");
            }
        }
    }
}

#[test]
fn a_feature_on_the_front_is_not_seen_from_the_back() {
    let mut record = measured("f_average_clean").1.clone();
    for leg in &mut record.legs {
        for feature in &mut leg.features {
            let section = leg.sections.iter().find(|at| at.level == feature.level).unwrap();
            let centre = section.outline.centre_mm;
            feature.position_mm = [centre[0], centre[1] - 30.0, centre[2]];
        }
    }
    let figure = figure(&record, "views");
    let words = words_of(&figure);
    let legs = words.iter().filter(|(_, word)| word.ends_with(" leg"));
    let mut legs: Vec<f64> = legs.map(|([x, _], _)| *x).collect();
    legs.sort_by(f64::total_cmp);
    let mut seen = vec![0; legs.len()];
    for mark in &figure.picture.marks {
        let Mark::Dots { at, stroke: Some(_), .. } = mark else { continue };
        for [x, _] in at {
            let near = |leg: &usize| (legs[*leg] - x).abs();
            let leg = (0..legs.len()).min_by(|a, b| near(a).total_cmp(&near(b))).unwrap();
            seen[leg] += 1;
        }
    }
    // Front, back, and the outer sides.
    assert!(seen[0] > 4 && seen[1] > 4 && seen[2] == 0 && seen[3] == 0, "{seen:?}");
}

#[test]
fn every_curve_mark_and_girth_of_the_chart_is_of_its_own_leg_and_estimates_are_marked() {
    let mut record = measured("f_average_clean").1.clone();
    // The left leg is thicker everywhere, and grows faster.
    for leg in record.legs.iter_mut().filter(|leg| leg.side == "left") {
        leg.girth_curve.tape_mm.iter_mut().flatten().for_each(|mm| *mm += 200.0);
        leg.girth_curve.slope.iter_mut().flatten().for_each(|slope| *slope += 9.0);
        leg.landmarks.values_mut().for_each(|found| found.girth_tape_mm += 200.0);
        leg.estimates.values_mut().for_each(|of| of.girth_tape_mm += 200.0);
    }
    let figure = figure(&record, "girths");
    let mean = |line: &[[f64; 2]]| line.iter().map(|[x, _]| *x).sum::<f64>() / line.len() as f64;
    // Curves and the full marks of levels, above the legend, left and right of 470 px.
    let of = |side: Side, is_closed: bool, is_slope: bool| -> Vec<f64> {
        let marks = figure.picture.marks.iter().filter_map(|mark| match mark {
            Mark::Lines { lines, fill, stroke, is_closed: closed, .. } if *closed == is_closed => {
                let ink = if is_closed { *fill } else { stroke.map(|stroke| stroke.ink) };
                (ink == Some(Ink::for_side(side))).then_some(lines)
            }
            _ => None,
        });
        let lines = marks.flatten().filter(|line| line[0][1] < 470.0);
        lines.map(|line| mean(line)).filter(|x| (*x > 470.0) == is_slope).collect()
    };
    for (is_closed, is_slope) in [(false, false), (true, false), (false, true), (true, true)] {
        let [left, right] = Side::BOTH.map(|side| of(side, is_closed, is_slope));
        assert!(!left.is_empty() && !right.is_empty(), "{is_closed} {is_slope}");
        let mean = |of: &[f64]| of.iter().sum::<f64>() / of.len() as f64;
        assert!(mean(&left) > mean(&right) + 20.0, "{is_closed} {is_slope}: {left:?} {right:?}");
    }
    let words = words_of(&figure);
    let cm = |mm: f64| format!("{:.1}", (mm + 1e-9).round() / 10.0);
    for leg in &record.legs {
        let [a, y] = [leg.estimates["A"].girth_tape_mm, leg.landmarks["Y"].girth_tape_mm].map(cm);
        let feet = format!("{} leg: Y {y}, ≈ A {a}", leg.side);
        assert!(words.iter().any(|(_, word)| *word == feet), "{feet}");
        let of = if leg.side == "left" { "L" } else { "R" };
        let e = format!("{of} ≈ E {}", cm(leg.estimates["E"].girth_tape_mm));
        assert!(words.iter().any(|(_, word)| *word == e), "{e}");
    }
}
