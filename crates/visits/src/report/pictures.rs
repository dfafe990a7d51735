//! The pictures of a report of visits, drawn only from the course.

mod changes;
mod profiles;
mod slices;
mod volumes;

use std::fmt::Display;

use gaiter_leg::Side;
use gaiter_record::picture::figures::DrawnFigure;
use gaiter_record::picture::figures::error::{MapScale, map_of};
use gaiter_record::picture::figures::plot::{SMALL, stroked, text_mark};
use gaiter_record::picture::{Anchor, Ink, Mark, Picture, Stroke, svg};
use gaiter_record::report::document::{Block, Room, View};
use gaiter_record::rounding::{number, tenths_words};

use super::summary::between;
use super::words::Words;
use crate::comparison::Comparison;
use crate::course::Group;
use crate::overlay::Overlay;

/// The ends of the scale of distances, mm: the smallest that holds almost all of them is taken.
const SCALES_MM: [f64; 5] = [2.0, 4.0, 8.0, 16.0, 32.0];

/// The pictures of the first page: the curves of all visits, and where along the legs girths have changed.
pub(super) fn first(words: &Words, compared: &[Comparison]) -> Vec<Block> {
    let volumes = volumes::picture(words).map(|of| ("volumes", of, volumes::caption(words)));
    let changes = changes::picture(words, compared);
    let changes = changes.map(|of| ("changes", of, changes::caption(words, compared)));
    let drawn = volumes.into_iter().chain(changes);
    drawn.map(|(name, of, caption)| captioned(name, of.title.clone(), of, caption)).collect()
}

/// The girths along the legs at the visits that are beside each other.
pub(super) fn profiles(words: &Words, shown: &[usize]) -> Option<Block> {
    // Curves in another posture are not laid over each other.
    let visits = &words.course.visits;
    let last = shown.last().map(|last| &visits[*last]);
    let is_of_posture =
        |visit: &usize| last.is_none_or(|last| !visits[*visit].is_of_other_posture(last));
    let profiled: Vec<usize> = shown.iter().copied().filter(is_of_posture).collect();
    let picture = profiles::picture(words, &profiled)?;
    Some(block(words, "profiles", "visits.picture.profiles", picture))
}

/// The change of the volume of each slice, a picture for each comparison.
pub(super) fn slices(words: &Words, group: &Group, compared: &[Comparison]) -> Vec<Block> {
    let pictures = compared.iter().filter_map(|of| slices::picture(words, group, of));
    pictures.map(|of| block(words, "slices", "visits.picture.slices", of)).collect()
}

fn block(words: &Words, name: &'static str, title: &'static str, picture: Picture) -> Block {
    let caption = words.language.word("visits.caption", name).to_owned();
    captioned(name, words.text(title), picture, caption)
}

fn captioned(name: &'static str, title: String, picture: Picture, caption: String) -> Block {
    let marks = svg::marks(&picture);
    let figure = DrawnFigure { name, picture, marks };
    Block::Picture { title, figure, caption, room: Room::HalfPage }
}

/// The line of a curve below the chart that has it, and what the curve is of.
fn key([left, y]: [f64; 2], stroke: Option<Stroke>, name: String) -> [Mark; 2] {
    let line = vec![vec![[left, y - 4.0], [left + 40.0, y - 4.0]]];
    [stroked(line, stroke), text_mark([left + 48.0, y], Anchor::Start, SMALL, Ink::Text, name)]
}

/// The legs of two visits laid over each other.
pub(super) fn overlay(words: &Words, of: &Comparison, overlay: Overlay) -> Vec<Block> {
    let end_mm = SCALES_MM.into_iter().find(|mm| *mm >= overlay.largest_mm);
    let end_mm = end_mm.unwrap_or(SCALES_MM[SCALES_MM.len() - 1]);
    // Less than what the registration is off by is not marked as a change.
    let errors = Side::BOTH.map(|side| *overlay.error_mm.get(side));
    let error_mm = errors.into_iter().flatten().fold(0.0, f64::max);
    let scale = MapScale { end_mm, sign_mm: (2.0 * error_mm).max(end_mm / 8.0) };
    let pair = between(words, of);
    let title = words.filled("visits.picture.distances", &[("between", &pair)]);
    let sentence = |side: Side| {
        let mm = (*overlay.error_mm.get(side))?;
        let values: [(&str, &dyn Display); 2] =
            [("leg", &words.leg_in_sentence(side)), ("mm", &tenths_words(mm, words.language))];
        Some(words.filled("visits.registered", &values))
    };
    let errors: Vec<String> = Side::FROM_FRONT.into_iter().filter_map(sentence).collect();
    let values: [(&str, &dyn Display); 2] =
        [("errors", &errors.join(", ")), ("sign", &tenths_words(scale.sign_mm, words.language))];
    let caption = words.filled("visits.distances_explained", &values);
    let map = map_of(&overlay.record, scale, &title, words.language)
        .map(|picture| captioned("distances", title, picture, caption.clone()));
    let view = View {
        title: words.filled("visits.picture.in_3d", &[("between", &pair)]),
        whose: None,
        text: Some(format!("{caption} {}", words.text("visits.dots"))),
        record: overlay.record,
        words: vec![
            ("error_mm", number(end_mm, 0, words.language)),
            ("first_layers", "error scan".to_owned()),
            ("error", words.text("visits.view.distance")),
            ("scan", words.text("visits.view.earlier")),
            ("legend", words.text("visits.view.legend")),
            ("skin", words.text("visits.view.later")),
        ],
    };
    [Some(Block::View(Box::new(view))), map].into_iter().flatten().collect()
}
