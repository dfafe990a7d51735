//! The parts of figures: scales, grid lines, and labels that do not overlap.

use crate::picture::{Anchor, Ink, Mark, Stroke};

/// Size of the text in figures, px.
pub(super) const TEXT: f64 = 12.0;

/// Size of the text at scales, px.
pub const SMALL: f64 = 10.5;

/// Distance of labels above each other, px.
pub const LINE: f64 = 14.0;

/// A linear scale from figures to px.
#[derive(Debug, Clone, Copy)]
pub struct Scale {
    /// Its ends, in its own unit.
    pub range: [f64; 2],
    /// The places of the ends, px.
    pub px: [f64; 2],
}

impl Scale {
    /// The place of a figure, px.
    pub fn at(&self, figure: f64) -> f64 {
        let ([low, high], [from, to]) = (self.range, self.px);
        from + (figure - low) / (high - low) * (to - from)
    }

    /// The multiples of a step within the scale, both ends included.
    pub fn steps(&self, step: f64) -> impl Iterator<Item = f64> + use<> {
        let [low, high] = self.range;
        let (first, last) = ((low / step).ceil() as i64, (high / step).floor() as i64);
        (first..=last).map(move |index| index as f64 * step)
    }
}

/// This many labels fit on either side of zero.
const STEPS_MAX: f64 = 4.0;

/// A scale about zero that reaches so far to either side, and the step of its labels: the first of these that gives few
/// enough of them.
pub fn about_zero(reach: f64, steps: &[f64], px: [f64; 2]) -> (Scale, f64) {
    let step = steps.iter().copied().find(|step| reach <= STEPS_MAX * step).unwrap_or(reach);
    let end = (reach / step).ceil() * step;
    (Scale { range: [-end, end], px }, step)
}

/// The smallest range that holds all figures and ends at multiples of a step. `None` without figures.
pub fn range(figures: impl Iterator<Item = f64>, step: f64) -> Option<[f64; 2]> {
    let none = [f64::INFINITY, f64::NEG_INFINITY];
    let [low, high] = figures.fold(none, |[low, high], of| [low.min(of), high.max(of)]);
    let [low, high] = [(low / step).floor() * step, (high / step).ceil() * step];
    let is_any = low.is_finite() && high.is_finite();
    is_any.then_some([low, if high > low { high } else { low + step }])
}

/// A frame of two scales.
#[derive(Debug, Clone, Copy)]
pub struct Frame {
    /// The scale to the right.
    pub x: Scale,
    /// The scale upwards.
    pub y: Scale,
}

impl Frame {
    /// The place of a pair of figures.
    pub fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.x.at(x), self.y.at(y)]
    }

    /// Vertical lines at steps of x, with labels below.
    pub fn columns(&self, step: f64, label: impl Fn(f64) -> String) -> Vec<Mark> {
        let [a, b] = self.y.px;
        let line = |x: f64| vec![[self.x.at(x), a], [self.x.at(x), b]];
        let mut marks = vec![lines(self.x.steps(step).map(line).collect(), Ink::Grid, 1.0)];
        let below = a.max(b) + LINE;
        marks.extend(
            self.x.steps(step).map(|x| small_text([self.x.at(x), below], Anchor::Middle, label(x))),
        );
        marks
    }

    /// Horizontal lines at steps of y, with labels to their left.
    pub fn rows(&self, step: f64, label: impl Fn(f64) -> String) -> Vec<Mark> {
        let [a, b] = self.x.px;
        let line = |y: f64| vec![[a, self.y.at(y)], [b, self.y.at(y)]];
        let mut marks = vec![lines(self.y.steps(step).map(line).collect(), Ink::Grid, 1.0)];
        let before = a.min(b) - 6.0;
        marks.extend(self.y.steps(step).map(|y| {
            let at = [before, self.y.at(y) + SMALL / 3.0];
            small_text(at, Anchor::End, label(y))
        }));
        marks
    }
}

/// Open lines of one ink.
pub fn lines(lines: Vec<Vec<[f64; 2]>>, ink: Ink, width: f64) -> Mark {
    stroked(lines, Stroke::solid(ink, width))
}

/// Open lines of one pen.
pub fn stroked(lines: Vec<Vec<[f64; 2]>>, stroke: Option<Stroke>) -> Mark {
    Mark::Lines { lines, is_closed: false, fill: None, stroke }
}

/// A closed shape with an edge.
pub(super) fn shape(outline: Vec<[f64; 2]>, fill: Ink, edge: Ink, width: f64) -> Mark {
    let stroke = Stroke::solid(edge, width);
    Mark::Lines { lines: vec![outline], is_closed: true, fill: Some(fill), stroke }
}

/// An area of one ink.
pub fn area(outlines: Vec<Vec<[f64; 2]>>, fill: Ink) -> Mark {
    Mark::Lines { lines: outlines, is_closed: true, fill: Some(fill), stroke: None }
}

/// Plain text.
pub fn text_mark(
    at: [f64; 2],
    anchor: Anchor,
    size: f64,
    ink: Ink,
    words: impl Into<String>,
) -> Mark {
    Mark::Words { at, anchor, size, is_bold: false, ink, words: words.into() }
}

/// Text at a scale, or beside what is drawn: small and muted.
pub fn small_text(at: [f64; 2], anchor: Anchor, words: impl Into<String>) -> Mark {
    text_mark(at, anchor, SMALL, Ink::Muted, words)
}

/// Bold text.
pub fn heading(at: [f64; 2], anchor: Anchor, ink: Ink, words: impl Into<String>) -> Mark {
    Mark::Words { at, anchor, size: TEXT, is_bold: true, ink, words: words.into() }
}

/// Moves labels from the wished places so that they are at least `apart` from each other, in the same
/// order, with the largest move as small as possible.
pub(super) fn kept_apart(wished: &[f64], apart: f64) -> Vec<f64> {
    let mut order: Vec<usize> = (0..wished.len()).collect();
    order.sort_by(|a, b| wished[*a].total_cmp(&wished[*b]));
    // Groups of labels that touch: the sum of the starts they want, and their number.
    let mut groups: Vec<(f64, usize)> = Vec::new();
    for index in &order {
        let mut group = (wished[*index], 1);
        while let Some((sum, count)) = groups.last().copied() {
            let end = sum / count as f64 + apart * count as f64;
            if end <= group.0 / group.1 as f64 {
                break;
            }
            groups.pop();
            // Each label's wanted place, as the start of the group.
            group = (sum + group.0 - apart * (count * group.1) as f64, count + group.1);
        }
        groups.push(group);
    }
    let mut placed = vec![0.0; wished.len()];
    let places = groups.iter().flat_map(|(sum, count)| {
        (0..*count).map(move |index| sum / *count as f64 + apart * index as f64)
    });
    order.iter().zip(places).for_each(|(index, place)| placed[*index] = place);
    placed
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_that_have_room_stay_and_others_share_the_way() {
        assert_eq!(kept_apart(&[0.0, 30.0, 15.0], 10.0), [0.0, 30.0, 15.0]);
        assert_eq!(kept_apart(&[0.0, 4.0], 10.0), [-3.0, 7.0]);
        let placed = kept_apart(&[0.0, 0.0, 0.0, 100.0, 95.0], 10.0);
        assert_eq!(placed, [-10.0, 0.0, 10.0, 102.5, 92.5]);
        assert_eq!(kept_apart(&[], 10.0), [0.0; 0]);
    }

    #[test]
    fn labels_are_apart_and_in_order_whatever_is_wished() {
        let wished: Vec<f64> = (0..60).map(|i| f64::from(i * i * 37 % 101)).collect();
        let placed = kept_apart(&wished, 7.0);
        let mut both: Vec<(f64, f64)> = wished.into_iter().zip(placed).collect();
        both.sort_by(|a, b| a.1.total_cmp(&b.1));
        for pair in both.windows(2) {
            assert!(pair[1].1 - pair[0].1 >= 7.0 - 1e-9 && pair[1].0 >= pair[0].0, "{pair:?}");
        }
    }

    #[test]
    fn a_range_ends_at_steps_and_has_a_width() {
        assert_eq!(range([12.0, 38.0].into_iter(), 10.0), Some([10.0, 40.0]));
        assert_eq!(range([20.0].into_iter(), 10.0), Some([20.0, 30.0]));
        assert_eq!(range([].into_iter(), 10.0), None);
        assert_eq!(range([f64::NAN].into_iter(), 10.0), None);
    }
}
