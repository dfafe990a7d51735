//! The legs from the front, the back and their outer sides, with their sections, levels and feature
//! points (paper, fig. 5). In the front view the patient's right leg is on the left.

use gaiter_language::Language;
use gaiter_leg::{Level, Side};
use nalgebra::{Point3, Vector3};

use super::plot::{LINE, SMALL, TEXT, area, heading, kept_apart, lines, text_mark};
use crate::Record;
use crate::measure::Measure;
use crate::picture::{Anchor, Ink, Mark, Picture, Stroke};
use crate::report::Reliability;
use crate::rounding::cm_words;
use crate::schema::LegFigures;
use crate::shape::{OutlineFigures, ShapeFigures};

/// Width, px.
const WIDTH: f64 = 720.0;

/// Space above the legs, px.
const TOP: f64 = 44.0;

/// Space below the legs, px.
const BOTTOM: f64 = 30.0;

/// Space on either side of each view for the names of its levels, px.
const MARGIN: f64 = 22.0;

/// Space on either side of the front view, whose levels also have their girths, px.
const GIRTH_MARGIN: f64 = 54.0;

/// Mean width of a bold letter, as a share of its size.
const LETTER: f64 = 0.58;

/// Distance of a label from the line to its level, and of that line from the label's margin, px.
const LED: f64 = 4.0;

/// Space between two views, px, so that their labels are no pair.
const GAP: f64 = 16.0;

/// The largest height at which the legs are drawn, px.
const HEIGHT_MAX: f64 = 560.0;

/// One in this many rows of the skin is drawn: every 30 mm.
const ROWS_APART: usize = 3;

/// A scan point is part of the foot if it is below the lowest row by more than this, mm.
const BELOW_MM: f64 = 2.0;

/// Distance of the heights at which a foot's extent is taken, mm: each has some points of the scan.
const SPAN_MM: f64 = 6.0;

/// The direction from which the legs are seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum From {
    Front,
    Back,
    Outside(Side),
}

/// A leg with the data of this figure.
pub(super) struct Drawn<'a> {
    pub record: &'a Record,
    pub side: Side,
    pub leg: &'a LegFigures,
    rows: Vec<Vec<Point3<f64>>>,
    foot: Vec<Point3<f64>>,
}

impl From {
    const ALL: [From; 4] =
        [From::Front, From::Back, From::Outside(Side::Right), From::Outside(Side::Left)];

    /// Space on either side for labels, px.
    fn margin(self) -> f64 {
        if self == From::Front { GIRTH_MARGIN } else { MARGIN }
    }

    fn shows(self, side: Side) -> bool {
        match self {
            From::Front | From::Back => true,
            From::Outside(of) => of == side,
        }
    }

    /// The direction towards the viewer, in the body frame.
    fn towards(self) -> Vector3<f64> {
        match self {
            From::Front => -Vector3::y(),
            From::Back => Vector3::y(),
            From::Outside(Side::Left) => Vector3::x(),
            From::Outside(Side::Right) => -Vector3::x(),
        }
    }

    /// The direction to the viewer's right, in the body frame.
    fn right(self) -> Vector3<f64> {
        Vector3::z().cross(&self.towards())
    }

    fn name(self, language: Language) -> &'static str {
        match self {
            From::Front => language.text("picture.front"),
            From::Back => language.text("picture.back"),
            From::Outside(_) => language.text("picture.outer_side"),
        }
    }
}

/// The figure; `None` for a record without shapes.
pub(super) fn picture(record: &Record, language: Language) -> Option<Picture> {
    let legs: Vec<Drawn> =
        Side::FROM_FRONT.into_iter().filter_map(|side| Drawn::new(record, side)).collect();
    let views: Vec<(From, [f64; 2])> =
        From::ALL.into_iter().filter_map(|from| Some((from, extent(&legs, from)?))).collect();
    let points = || legs.iter().flat_map(Drawn::points);
    let top_mm = points().map(|point| point.z).fold(f64::NEG_INFINITY, f64::max);
    let wide_mm: f64 = views.iter().map(|(_, [low, high])| high - low).sum();
    if !(top_mm > 0.0 && wide_mm > 0.0) {
        return None;
    }
    let beside: f64 = views.iter().map(|(from, _)| 2.0 * from.margin() + GAP).sum::<f64>() - GAP;
    let px_per_mm = ((WIDTH - beside) / wide_mm).min(HEIGHT_MAX / top_mm);
    let floor = TOP + top_mm * px_per_mm;
    let mut left = (WIDTH - wide_mm * px_per_mm - beside) / 2.0;
    let (mut marks, mut cuts) = (Vec::new(), Vec::new());
    for (from, [low_mm, high_mm]) in views {
        let margin = from.margin();
        let view = View { from, left: left + margin - low_mm * px_per_mm, floor, px_per_mm };
        let right = left + 2.0 * margin + (high_mm - low_mm) * px_per_mm;
        let title = [f64::midpoint(left, right), 18.0];
        marks.push(heading(title, Anchor::Middle, Ink::Text, from.name(language)));
        for leg in legs.iter().filter(|leg| from.shows(leg.side)) {
            marks.extend(view.leg(leg));
        }
        marks.extend(view.below(&legs, language));
        marks.extend(view.names(&legs, [left, right], language));
        left = right + GAP;
        cuts.push(right + GAP / 2.0);
    }
    cuts.pop();
    let title = language.text("picture.views").to_owned();
    Some(Picture { title, size: [WIDTH, floor + BOTTOM], cuts, marks })
}

impl<'a> Drawn<'a> {
    /// The leg of a side; `None` without skin.
    pub fn new(record: &'a Record, side: Side) -> Option<Drawn<'a>> {
        let leg = record.leg(side)?;
        let ShapeFigures { skin, scan, .. } = &leg.shape;
        let points = skin.points.as_points();
        let rows = points.chunks(skin.columns.max(1));
        let rows: Vec<Vec<Point3<f64>>> =
            rows.filter_map(|row| row.iter().copied().collect()).collect();
        let lowest_mm = rows.first()?.iter().map(|point| point.z).fold(f64::INFINITY, f64::min);
        let scan = scan.points.as_points();
        let foot = scan.into_iter().flatten().filter(|point| point.z < lowest_mm - BELOW_MM);
        Some(Drawn { record, side, leg, foot: foot.collect(), rows })
    }

    /// The girth at a level of this name, as on the measuring sheet, and how to read it.
    pub fn girth(&self, name: &str, language: Language) -> Option<(String, Reliability)> {
        let level = Level::of_word(name)?;
        let measure = Measure::find(self.record, self.side, level).ok()?;
        Some((cm_words(measure.girth.mm, language), measure.mark()))
    }

    /// All of its points.
    pub fn points(&self) -> impl Iterator<Item = &Point3<f64>> {
        self.rows.iter().flatten().chain(&self.foot)
    }
}

/// The range of a view along its right, mm; `None` if it shows nothing.
pub(super) fn extent(legs: &[Drawn], from: From) -> Option<[f64; 2]> {
    let shown = legs.iter().filter(|leg| from.shows(leg.side));
    let places = shown.flat_map(Drawn::points).map(|point| point.coords.dot(&from.right()));
    let none = [f64::INFINITY, f64::NEG_INFINITY];
    let [low, high] = places.fold(none, |[low, high], at| [low.min(at), high.max(at)]);
    (low < high).then_some([low, high])
}

pub(super) struct View {
    pub from: From,
    /// Place of the body frame's origin, px.
    pub left: f64,
    pub floor: f64,
    pub px_per_mm: f64,
}

impl View {
    fn at(&self, point: &Point3<f64>) -> [f64; 2] {
        let across = point.coords.dot(&self.from.right());
        [self.left + across * self.px_per_mm, self.floor - point.z * self.px_per_mm]
    }

    /// The leg: skin, sections, levels, feature points.
    pub fn leg(&self, leg: &Drawn) -> Vec<Mark> {
        let ends: Vec<[[f64; 2]; 2]> = leg.rows.iter().map(|row| self.ends(row)).collect();
        let up = ends.iter().map(|[left, _]| *left);
        let down = ends.iter().rev().map(|[_, right]| *right);
        let ink = Ink::for_side(leg.side);
        let thin = leg.rows.iter().step_by(ROWS_APART);
        let foot = self.foot(leg);
        let mut marks = vec![
            area(vec![foot.clone()], Ink::Skin),
            lines(vec![foot], ink, 1.25),
            area(vec![up.clone().chain(down.clone()).collect()], Ink::Skin),
            lines(thin.map(|row| self.near_side(row)).collect(), Ink::Unseen, 0.6),
            lines(vec![up.collect(), down.collect()], ink, 1.25),
        ];
        let at_levels = outlines(leg.leg).map(|(_, outline)| ring(outline));
        marks.push(lines(at_levels.map(|ring| self.near_side(&ring)).collect(), ink, 2.0));
        marks.extend(self.features(leg.leg));
        marks
    }

    /// The silhouette of the foot below the lowest row, from its left end there around the sole to its right
    /// end. Where a span of heights has no points, the foot is as wide as those below and above it.
    fn foot(&self, leg: &Drawn) -> Vec<[f64; 2]> {
        let Some(top) = leg.rows.first().map(|row| self.ends(row)) else { return Vec::new() };
        if leg.foot.is_empty() {
            return Vec::new();
        }
        let spans = silhouette(leg.foot.iter().map(|p| [p.coords.dot(&self.from.right()), p.z]));
        let place = |[across_mm, z_mm]: [f64; 2]| {
            [self.left + across_mm * self.px_per_mm, self.floor - z_mm * self.px_per_mm]
        };
        let left = spans.iter().rev().map(|(z, [low, _])| place([*low, *z]));
        let right = spans.iter().map(|(z, [_, high])| place([*high, *z]));
        [top[0]].into_iter().chain(left).chain(right).chain([top[1]]).collect()
    }

    /// The leftmost and the rightmost place of a row.
    pub fn ends(&self, row: &[Point3<f64>]) -> [[f64; 2]; 2] {
        let places = || row.iter().map(|point| self.at(point));
        let first = places().min_by(|a, b| a[0].total_cmp(&b[0])).unwrap_or_default();
        let last = places().max_by(|a, b| a[0].total_cmp(&b[0])).unwrap_or_default();
        [first, last]
    }

    /// The half of a closed row that faces the viewer, from left to right.
    fn near_side(&self, row: &[Point3<f64>]) -> Vec<[f64; 2]> {
        let key = |at: &usize| self.at(&row[*at])[0];
        let indices = || 0..row.len();
        let left = indices().min_by(|a, b| key(a).total_cmp(&key(b))).unwrap_or(0);
        let right = indices().max_by(|a, b| key(a).total_cmp(&key(b))).unwrap_or(0);
        let run = |from: usize, to: usize| {
            let count = (to + row.len() - from) % row.len().max(1);
            (0..=count).map(|step| row[(from + step) % row.len()]).collect::<Vec<_>>()
        };
        let near = |run: &Vec<Point3<f64>>| {
            let sum: f64 = run.iter().map(|point| point.coords.dot(&self.from.towards())).sum();
            sum / run.len() as f64
        };
        if row.is_empty() {
            return Vec::new();
        }
        let (ahead, back) = (run(left, right), run(right, left));
        let nearer = if near(&ahead) >= near(&back) { ahead } else { back };
        nearer.iter().map(|point| self.at(point)).collect()
    }

    /// The feature points that the viewer sees: peaks filled, valleys hollow.
    fn features(&self, leg: &LegFigures) -> Vec<Mark> {
        let seen = leg.features.iter().filter(|feature| {
            let at = leg.sections.iter().find(|section| section.level == feature.level);
            let centre = at.map_or(feature.position_mm, |section| section.outline.centre_mm);
            let arm = Vector3::from(feature.position_mm) - Vector3::from(centre);
            arm.dot(&self.from.towards()) > 0.0
        });
        let (peaks, valleys): (Vec<_>, Vec<_>) = seen.partition(|feature| feature.kind == "peak");
        let dots = |features: Vec<&crate::schema::FeatureFigures>, fill: Ink| Mark::Dots {
            at: features.iter().map(|f| self.at(&Point3::from(f.position_mm))).collect(),
            radius: 2.75,
            fill: Some(fill),
            stroke: Stroke::solid(Ink::Text, 1.0),
        };
        vec![dots(valleys, Ink::Paper), dots(peaks, Ink::Text)]
    }

    /// The sides of the legs that are seen, as text below their feet.
    pub fn below(&self, legs: &[Drawn], language: Language) -> Vec<Mark> {
        let middle = |leg: &&Drawn| {
            let [left, right] = extent(std::slice::from_ref(leg), self.from)?;
            Some(self.left + f64::midpoint(left, right) * self.px_per_mm)
        };
        let seen = legs.iter().filter(|leg| self.from.shows(leg.side));
        let seen: Vec<(&Drawn, f64)> = seen.filter_map(|leg| Some((leg, middle(&leg)?))).collect();
        let name = |leg: &Drawn| language.word("leg", leg.side.word());
        let letters = seen.iter().map(|(leg, _)| name(leg).chars().count()).max().unwrap_or(0);
        let wished: Vec<f64> = seen.iter().map(|(_, x)| *x).collect();
        let places = kept_apart(&wished, LETTER * TEXT * (letters + 1) as f64);
        let label = |((leg, _), x): (&(&Drawn, f64), f64)| {
            heading([x, self.floor + 20.0], Anchor::Middle, Ink::for_side(leg.side), name(leg))
        };
        seen.iter().zip(places).map(label).collect()
    }

    /// The names of the levels, from the front with their girths in cm: on the left for the leg on the
    /// left of the view, else on the right.
    fn names(&self, legs: &[Drawn], [left, right]: [f64; 2], language: Language) -> Vec<Mark> {
        let mut marks = Vec::new();
        for leg in legs.iter().filter(|leg| self.from.shows(leg.side)) {
            let is_left = match self.from {
                From::Front => leg.side == Side::Right,
                From::Back => leg.side == Side::Left,
                From::Outside(_) => true,
            };
            let found: Vec<(&str, Vec<Point3<f64>>)> =
                outlines(leg.leg).map(|(name, outline)| (name, ring(outline))).collect();
            let end = |ring: &[Point3<f64>]| self.ends(ring)[usize::from(!is_left)];
            let wished: Vec<f64> = found.iter().map(|(_, ring)| end(ring)[1]).collect();
            for ((name, ring), y) in found.iter().zip(kept_apart(&wished, LINE)) {
                let tip = self.from.margin() - LED;
                let (tip, x, anchor) = if is_left {
                    (left + tip, left + tip - LED, Anchor::End)
                } else {
                    (right - tip, right - tip + LED, Anchor::Start)
                };
                marks.push(lines(vec![vec![[tip, y], end(ring)]], Ink::Muted, 0.6));
                let girth = leg.girth(name, language).filter(|_| self.from == From::Front);
                let girth = girth.map(|(girth, mark)| girth + mark.by_hand_sign());
                let label = [Some((*name).to_owned()), girth].into_iter().flatten();
                let label = label.collect::<Vec<_>>().join(" ");
                let at = [x, y + SMALL / 3.0];
                marks.push(text_mark(at, anchor, SMALL, Ink::for_side(leg.side), label));
            }
        }
        marks
    }
}

/// The extent of places at each height that has any, lowest first, mm: the first and the last height are
/// those of the lowest and the highest place.
fn silhouette(places: impl Iterator<Item = [f64; 2]> + Clone) -> Vec<(f64, [f64; 2])> {
    let none = [f64::INFINITY, f64::NEG_INFINITY];
    let joined = |[low, high]: [f64; 2], at: f64| [low.min(at), high.max(at)];
    let [from_mm, to_mm] = places.clone().fold(none, |ends, [_, z]| joined(ends, z));
    let count = ((to_mm - from_mm) / SPAN_MM).ceil().max(1.0) as usize;
    let height = |index: usize| from_mm + (to_mm - from_mm) * index as f64 / count as f64;
    let span = |index: usize| {
        let z_mm = height(index);
        let near = places.clone().filter(|[_, z]| (z - z_mm).abs() <= SPAN_MM);
        let ends = near.fold(none, |ends, [across, _]| joined(ends, across));
        (ends[0] <= ends[1]).then_some((z_mm, ends))
    };
    (0..=count).filter_map(span).collect()
}

/// The outlines at the levels, with their names.
pub(super) fn outlines(leg: &LegFigures) -> impl Iterator<Item = (&str, &OutlineFigures)> {
    leg.sections.iter().map(|at| (at.level.as_str(), &at.outline))
}

/// An outline in the body frame.
pub(super) fn ring(outline: &OutlineFigures) -> Vec<Point3<f64>> {
    let [front, lateral]: [Vector3<f64>; 2] = [outline.front, outline.lateral].map(Vector3::from);
    let count = outline.radius_mm.len();
    let point = |(index, radius): (usize, &f64)| {
        let (sin, cos) = (-180.0 + 360.0 * index as f64 / count as f64).to_radians().sin_cos();
        Point3::from(outline.centre_mm) + (front * cos + lateral * sin) * *radius
    };
    outline.radius_mm.iter().enumerate().map(point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn from_the_front_the_patients_left_is_on_the_right_and_toes_point_outward_of_the_outer_views()
    {
        let (left, toes) = (Vector3::x(), -Vector3::y());
        assert_eq!(left.dot(&From::Front.right()), 1.0);
        assert_eq!(left.dot(&From::Back.right()), -1.0);
        assert_eq!(toes.dot(&From::Outside(Side::Left).right()), -1.0);
        assert_eq!(toes.dot(&From::Outside(Side::Right).right()), 1.0);
    }
}
