//! How well the surfaces follow the scan, in plain words.

use super::super::words;
use super::{Report, Section};
use crate::leg::Side;
use crate::record::rounding::{cm_words, mm_words, tenths_words};
use crate::record::surface::SurfaceFigures;

impl Report<'_> {
    pub(super) fn surfaces(&self) -> Section {
        Section {
            title: self.say("Surfaces for making the stockings", "Oberflächen für die Fertigung"),
            entries: Side::FROM_FRONT.into_iter().map(|side| self.surface(side)).collect(),
        }
    }

    fn surface(&self, side: Side) -> String {
        let heading = words::leg_heading(side, self.language);
        let words = match self.record.leg(side).map(|leg| &leg.surface) {
            Some(Some(surface)) => self.quality(surface),
            Some(None) => self.say(
                "there is no surface; the notes say why.",
                "es gibt keine Oberfläche; die Hinweise sagen, warum.",
            ),
            None => format!("{}.", self.no_leg(side)),
        };
        format!("{heading}: {words}")
    }

    fn quality(&self, of: &SurfaceFigures) -> String {
        let cm = |mm| cm_words(mm, self.language);
        let mm = |mm| mm_words(mm, self.language);
        let [from, to] = [of.from_height_mm, of.to_height_mm].map(cm);
        let [rms, p95, max] =
            [of.to_points.rms_mm, of.to_points.p95_mm, of.to_points.max_mm].map(mm);
        let (german, holes) = (self.language.pick(false, true), self.holes(of));
        if german {
            format!(
                "Die Oberfläche reicht von {from} bis {to} cm Höhe. Die Punkte des Scans liegen im \
                 quadratischen Mittel {rms} mm von ihr entfernt, 95 % der Fläche höchstens {p95} mm, \
                 die fernste Stelle {max} mm. {holes}"
            )
        } else {
            format!(
                "the surface reaches from {from} to {to} cm of height. The scan's points lie {rms} mm \
                 from it (root mean square), 95 % of the area no further than {p95} mm, the farthest \
                 place {max} mm. {holes}"
            )
        }
    }

    fn holes(&self, of: &SurfaceFigures) -> String {
        let Some(largest) = of.holes.first() else {
            return self.say("It bridges no holes.", "Sie überbrückt keine Lücken.");
        };
        let (count, area) = (of.holes.len(), tenths_words(largest.area_cm2, self.language));
        let height = cm_words(largest.height_mm, self.language);
        let (english, german) = match count {
            1 => (
                format!("It bridges one hole of {area} cm² at {height} cm."),
                format!("Sie überbrückt eine Lücke von {area} cm² in {height} cm Höhe."),
            ),
            _ => (
                format!("It bridges {count} holes; the largest has {area} cm², at {height} cm."),
                format!(
                    "Sie überbrückt {count} Lücken; die größte misst {area} cm², in {height} cm Höhe."
                ),
            ),
        };
        self.language.pick(english, german)
    }
}
