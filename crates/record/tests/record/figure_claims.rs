//! What single figures claim, with numbers: the bars of the differences, feature points where their curvature
//! says, signs on the map of the error, cuts for narrow screens.

#![allow(clippy::unwrap_used)]

use gaiter_language::Language;
use gaiter_leg::Side;
use gaiter_record::Record;
use gaiter_record::picture::figures::{DrawnFigure, all};
use gaiter_record::picture::{Ink, Mark};
use support::records::{bodies, measured};

use crate::figures::figure;

fn words_of(figure: &DrawnFigure) -> Vec<&str> {
    let words = figure.picture.marks.iter().filter_map(|mark| match mark {
        Mark::Words { words, .. } => Some(words.as_str()),
        _ => None,
    });
    words.collect()
}

/// A record whose left leg has these girths more than the right one, from the floor up, mm, each with a
/// standard error of 2 mm.
fn differing(by_mm: &[f64]) -> Record {
    let mut record = measured("f_average_clean").1.clone();
    for leg in &mut record.legs {
        let is_left = leg.side == "left";
        leg.profile.truncate(by_mm.len());
        assert_eq!(leg.profile.len(), by_mm.len());
        for (at, mm) in leg.profile.iter_mut().zip(by_mm) {
            at.girth_tape_mm = Some(if is_left { 300.0 + mm } else { 300.0 });
            at.girth_sd_mm = Some(if is_left { 2.0 } else { 0.0 });
        }
    }
    record
}

/// A bar of the figure: its fill, its height and the ways of its end and of its whisker from zero, px.
struct Bar {
    fill: Ink,
    y: f64,
    length: f64,
}

/// The bars, lowest first.
fn bars(figure: &DrawnFigure) -> Vec<Bar> {
    let bars = figure.picture.marks.iter().filter_map(|mark| match mark {
        Mark::Lines { lines, is_closed: true, fill: Some(fill), .. } => {
            let [from, to, ..] = lines[0][..] else { unreachable!("{lines:?}") };
            Some(Bar {
                fill: *fill,
                y: f64::midpoint(from[1], lines[0][2][1]),
                length: to[0] - from[0],
            })
        }
        _ => None,
    });
    let mut bars: Vec<Bar> = bars.collect();
    bars.sort_by(|a, b| b.y.total_cmp(&a.y));
    bars
}

#[test]
fn bars_are_as_long_as_the_differences_on_the_side_of_the_larger_leg_and_full_where_they_are_real()
{
    let by_mm = [3.0, -50.0, 100.0, -4.5, 25.0];
    let drawn = figure(&differing(&by_mm), "differences");
    let bars = bars(&drawn);
    assert_eq!(bars.len(), by_mm.len());
    let px_per_mm = bars[2].length / 100.0;
    assert!(px_per_mm > 0.5, "{px_per_mm}");
    for (bar, mm) in bars.iter().zip(by_mm) {
        assert!((bar.length - mm * px_per_mm).abs() < 1e-9, "{mm}: {}", bar.length);
        let side = if mm < 0.0 { Side::Right } else { Side::Left };
        // 3 mm do not exceed two standard errors of 2 mm; 4.5 mm are shown as 0.5 cm and do.
        let fill = if mm == 3.0 { Ink::Paper } else { Ink::for_side(side) };
        assert_eq!(bar.fill, fill, "{mm}");
    }
    // Heights are equally far apart, as on the legs.
    let apart: Vec<f64> = bars.windows(2).map(|pair| pair[0].y - pair[1].y).collect();
    assert!(apart.iter().all(|px| (px - apart[0]).abs() < 1e-9 && *px > 10.0), "{apart:?}");
}

#[test]
fn the_largest_difference_is_told_in_words_and_in_the_text_for_those_who_do_not_see_it() {
    let drawn = figure(&differing(&[1.0, 1.0, -60.0, 100.0, 25.0]), "differences");
    let told = "largest difference: left 10.0 cm more at 20 cm";
    assert!(words_of(&drawn).contains(&told), "{:?}", words_of(&drawn));
    assert!(drawn.picture.title.ends_with(told), "{}", drawn.picture.title);
    let record = differing(&[0.0, 0.0, -81.0, 1.0]);
    let german =
        all(&record, Language::De).into_iter().find(|of| of.name == "differences").unwrap();
    let told = "größter Unterschied: rechts 8,1 cm mehr in 16 cm Höhe";
    assert!(words_of(&german).contains(&told), "{:?}", words_of(&german));
    let alike = figure(&differing(&[1.0, -3.0, 2.0]), "differences");
    assert!(words_of(&alike).contains(&"no difference exceeds its uncertainty"));
}

/// The value of a row at an angle, between the two nearest places.
fn at_angle(row: &[f64], angle_deg: f64) -> f64 {
    let place = (angle_deg + 180.0).rem_euclid(360.0) / 360.0 * row.len() as f64;
    let (below, part) = (place as usize, place.fract());
    row[below % row.len()] * (1.0 - part) + row[(below + 1) % row.len()] * part
}

#[test]
fn a_feature_point_is_drawn_where_the_curvature_turns_and_a_peak_bulges_more_than_its_neighbours() {
    let mut seen = 0;
    for (body, _, record) in bodies() {
        let drawn = figure(record, "sections");
        let dots: Vec<([f64; 2], bool)> = drawn
            .picture
            .marks
            .iter()
            .filter_map(|mark| match mark {
                Mark::Dots { at, fill: Some(fill), .. } => Some((at[0], *fill == Ink::Text)),
                _ => None,
            })
            .collect();
        let outlines: Vec<(Ink, &Vec<[f64; 2]>)> = drawn
            .picture
            .marks
            .iter()
            .filter_map(|mark| match mark {
                Mark::Lines { lines, fill: Some(Ink::Skin), stroke: Some(stroke), .. } => {
                    Some((stroke.ink, &lines[0]))
                }
                _ => None,
            })
            .collect();
        for leg in &record.legs {
            let ink = if leg.side == "left" {
                Ink::for_side(Side::Left)
            } else {
                Ink::for_side(Side::Right)
            };
            let mut own = outlines.iter().filter(|(of, _)| *of == ink).map(|(_, line)| *line);
            for level in ["D", "C", "B1", "B"] {
                let Some(section) = leg.sections.iter().find(|at| at.level == level) else {
                    continue;
                };
                let (line, told) = (own.next().unwrap(), &section.outline);
                for (dot, is_peak) in dots.iter().filter(|(dot, _)| distance(line, *dot).1 < 0.6) {
                    let place = distance(line, *dot).0;
                    let angle = -180.0 + 3.0 * place as f64;
                    let size = |deg: f64| {
                        at_angle(&told.curvature_per_mm, deg) * if *is_peak { 1.0 } else { -1.0 }
                    };
                    // No place within 9 degrees is more extreme by more than what 3 degrees blur.
                    let near = (-9..=9).map(|step| size(angle + f64::from(step)));
                    let most = near.fold(f64::NEG_INFINITY, f64::max);
                    assert!(size(angle) > most - 0.002, "{body}, {} {level}, {angle}", leg.side);
                    seen += 1;
                }
            }
        }
    }
    assert!(seen > 100, "{seen}");
}

#[test]
fn a_feature_point_is_drawn_on_its_section_where_the_record_has_it() {
    let mut record = measured("f_average_clean").1.clone();
    for feature in record.legs.iter_mut().flat_map(|leg| &mut leg.features) {
        // Half-way up a flank: no drawing may look for the extreme by itself.
        feature.angle_deg = (feature.angle_deg + 20.0 + 180.0).rem_euclid(360.0) - 180.0;
    }
    let drawn = figure(&record, "sections");
    let marks = || drawn.picture.marks.iter();
    let dots = marks().filter_map(|mark| match mark {
        Mark::Dots { at, .. } => Some(at[0]),
        _ => None,
    });
    let dots: Vec<[f64; 2]> = dots.collect();
    let outlines = marks().filter_map(|mark| match mark {
        Mark::Lines { lines, fill: Some(Ink::Skin), stroke: Some(stroke), .. } => {
            Some((stroke.ink, &lines[0]))
        }
        _ => None,
    });
    let outlines: Vec<(Ink, &Vec<[f64; 2]>)> = outlines.collect();
    for leg in &record.legs {
        let ink =
            if leg.side == "left" { Ink::for_side(Side::Left) } else { Ink::for_side(Side::Right) };
        let own = outlines.iter().filter(|(of, _)| *of == ink).map(|(_, line)| *line);
        let levels = ["D", "C", "B1", "B"].into_iter();
        let seen = levels.filter(|level| leg.sections.iter().any(|at| at.level == *level));
        for (level, line) in seen.zip(own) {
            let here = dots.iter().filter(|dot| distance(line, **dot).1 < 0.6);
            let drawn: Vec<f64> =
                here.map(|dot| -180.0 + 3.0 * distance(line, *dot).0 as f64).collect();
            for feature in leg.features.iter().filter(|feature| feature.level == level) {
                let off =
                    |deg: &f64| ((deg - feature.angle_deg + 180.0).rem_euclid(360.0) - 180.0).abs();
                assert!(drawn.iter().any(|deg| off(deg) < 1.6), "{feature:?}: {drawn:?}");
            }
        }
    }
}

/// The index of the nearest place of a line, and how far it is, px.
fn distance(line: &[[f64; 2]], [x, y]: [f64; 2]) -> (usize, f64) {
    let far = |at: &[f64; 2]| (at[0] - x).hypot(at[1] - y);
    let places = line.iter().map(far).enumerate();
    let (index, _) = places.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
    // From the line, not only from its places.
    let count = line.len();
    let ways =
        [count - 1, 0].map(|step| (line[(index + step) % count], line[(index + step + 1) % count]));
    let far = ways.map(|([ax, ay], [bx, by])| {
        let (ux, uy) = (bx - ax, by - ay);
        let share = ((x - ax) * ux + (y - ay) * uy) / (ux * ux + uy * uy);
        let share = share.clamp(0.0, 1.0);
        (ax + share * ux - x).hypot(ay + share * uy - y)
    });
    (index, far[0].min(far[1]))
}

#[test]
fn the_sign_of_an_error_is_told_without_colour_and_what_was_not_seen_has_a_net() {
    let record = &measured("f_average_tc2").1;
    let errors =
        record.legs.iter().flat_map(|leg| leg.shape.surface.as_ref().unwrap().error.as_errors_mm());
    let errors: Vec<Option<f64>> = errors.collect();
    let count = |is: fn(f64) -> bool| errors.iter().flatten().filter(|mm| is(**mm)).count();
    let (inside, outside) = (count(|mm| mm <= -0.5), count(|mm| mm >= 0.5));
    let unseen = errors.iter().filter(|error| error.is_none()).count();
    assert!(inside > 5 && outside > 5 && unseen > 5, "{inside} {outside} {unseen}");
    let drawn = figure(record, "error");
    let marks = || drawn.picture.marks.iter();
    let dots = marks().filter_map(|mark| match mark {
        Mark::Dots { at, .. } => Some(at.len()),
        _ => None,
    });
    let is_sign = |ink: Ink| matches!(ink, Ink::Off(_));
    let strokes = marks().filter_map(|mark| match mark {
        Mark::Lines { lines, fill: None, stroke: Some(of), .. } if is_sign(of.ink) => {
            assert!(lines.iter().all(|line| line[1][0] > line[0][0] && line[1][1] < line[0][1]));
            Some(lines.len())
        }
        _ => None,
    });
    // The two scales have three of each.
    assert_eq!((dots.sum::<usize>(), strokes.sum::<usize>()), (inside + 6, outside + 6));
    let net = marks().filter_map(|mark| match mark {
        Mark::Lines { lines, is_closed: false, stroke: Some(of), .. }
            if of.ink == Ink::Muted && of.width == 0.7 =>
        {
            Some(lines.iter().map(|line| line.len() - 1).sum::<usize>())
        }
        _ => None,
    });
    assert_eq!(net.sum::<usize>(), unseen + 8);
}

#[test]
fn no_mark_crosses_the_place_where_a_narrow_screen_cuts_a_figure() {
    for (body, _, record) in bodies() {
        for language in Language::ALL {
            let figures = all(record, language);
            assert!(figures.iter().filter(|of| !of.picture.cuts.is_empty()).count() >= 5, "{body}");
            for DrawnFigure { name, picture, .. } in figures {
                for cut in picture.cuts {
                    let lines = picture.marks.iter().filter_map(|mark| match mark {
                        Mark::Lines { lines, .. } => Some(lines.iter().map(Vec::as_slice)),
                        _ => None,
                    });
                    for line in lines.flatten() {
                        let x = |of: fn(f64, f64) -> f64| line.iter().map(|at| at[0]).reduce(of);
                        let is_left = x(f64::max).is_none_or(|x| x < cut);
                        let is_right = x(f64::min).is_none_or(|x| x > cut);
                        assert!(is_left || is_right, "{body}, {name}, {cut}: {line:?}");
                    }
                }
            }
        }
    }
}

#[test]
fn the_front_view_tells_the_girth_of_every_section_that_it_shows() {
    for (body, _, record) in bodies() {
        let drawn = figure(record, "views");
        let words = words_of(&drawn);
        for leg in &record.legs {
            for section in &leg.sections {
                let Some(found) = leg.landmarks.get(&section.level) else { continue };
                let label = format!("{} {:.1}", section.level, found.girth_tape_mm.round() / 10.0);
                assert!(words.contains(&label.as_str()), "{body}: {label}");
            }
        }
    }
}
