//! How well the surfaces follow the scan, in plain words.

use gaiter_leg::Side;

use super::{Report, Section};
use crate::rounding::{cm_words, number, tenths_words};
use crate::surface::SurfaceFigures;

impl Report<'_> {
    pub(super) fn surfaces(&self) -> Section {
        Section {
            title: self.text("report.surfaces.title"),
            entries: Side::FROM_FRONT.into_iter().map(|side| self.surface(side)).collect(),
        }
    }

    fn surface(&self, side: Side) -> String {
        let heading = self.leg_heading(side);
        let words = match self.record.leg(side).map(|leg| &leg.surface) {
            Some(Some(surface)) => self.quality(surface),
            Some(None) => self.text("report.surfaces.none"),
            None => format!("{}.", self.no_leg(side)),
        };
        format!("{heading}: {words}")
    }

    fn quality(&self, of: &SurfaceFigures) -> String {
        let cm = |mm| cm_words(mm, self.language);
        let mm = |mm| number(mm, 2, self.language);
        let [from, to] = [of.from_height_mm, of.to_height_mm].map(cm);
        let [rms, p95, max] =
            [of.to_points.rms_mm, of.to_points.p95_mm, of.to_points.max_mm].map(mm);
        let quality = self.filled(
            "report.surfaces.quality",
            &[("from", &from), ("to", &to), ("rms", &rms), ("p95", &p95), ("max", &max)],
        );
        format!("{quality} {}", self.holes(of))
    }

    fn holes(&self, of: &SurfaceFigures) -> String {
        let Some(largest) = of.holes.first() else { return self.text("report.surfaces.no_holes") };
        let area = tenths_words(largest.area_cm2, self.language);
        let height = cm_words(largest.height_mm, self.language);
        match of.holes.len() {
            1 => self.filled("report.surfaces.one_hole", &[("area", &area), ("height", &height)]),
            count => self.filled(
                "report.surfaces.holes",
                &[("count", &count), ("area", &area), ("height", &height)],
            ),
        }
    }
}
