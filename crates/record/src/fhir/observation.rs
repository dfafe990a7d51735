//! An observation per leg: each girth and height of the sheet as a component.

use gaiter_leg::Side;
use serde_json::{Value, json};

use super::bundle::Entry;
use super::{Parts, codes, narrative};
use crate::export::{ExportFigure, What, export_figures};
use crate::report::{grouped, title};
use crate::rounding;

impl Parts<'_> {
    /// The observation of a leg.
    pub(super) fn observation(&self, side: Side, device: &Entry) -> Entry {
        let (record, language) = (self.sent.record, self.rules.language);
        let part = side.word();
        let identifier = self.identifier(self.sent.key.part(part));
        let figures: Vec<ExportFigure> =
            export_figures(record).into_iter().filter(|figure| figure.side == side).collect();
        let leg = language.word("leg.heading", part);
        let line = |figure: &ExportFigure| {
            format!("{} {} cm", figure.code(), rounding::number(figure.cm, 1, language))
        };
        let lines: Vec<String> = figures.iter().map(line).collect();
        let mut resource = json!({
            "resourceType": "Observation",
            "language": language.tag(),
            "text": narrative(leg, &lines),
            "identifier": self.identifiers(part),
            "status": self.status().word(),
            "category": [codes::exam()],
            "code": self.concept("leg-measures", language.text("hospital.leg_measures"), &[]),
            "subject": { "reference": self.sent.subject },
            "effectiveDateTime": self.effective(),
            "bodySite": self.concept(&format!("{part}-leg"), leg, &[codes::lower_limb()]),
            "method": { "text": format!("gaiter {}", record.made_by.gaiter) },
            "device": { "reference": device.reference() },
            "component": figures.iter().map(|figure| self.component(figure)).collect::<Vec<_>>(),
        });
        if figures.is_empty() {
            // An observation has a value, components, or the reason why it has neither.
            resource["dataAbsentReason"] = codes::unknown();
            if let Some(fields) = resource.as_object_mut() {
                fields.remove("component");
            }
        }
        let notes = self.notes(&figures);
        if !notes.is_empty() {
            resource["note"] = notes.into();
        }
        Entry::new(identifier, resource)
    }

    fn component(&self, figure: &ExportFigure) -> Value {
        let language = self.rules.language;
        let (key, further) = match figure.what {
            What::Girth => ("hospital.girth_at", vec![codes::limb_circumference()]),
            What::Height => ("hospital.height_at", Vec::new()),
        };
        let words = language.filled(key, &[("level", &figure.level.name())]);
        let mut quantity = json!({
            "value": figure.cm, "unit": "cm", "system": codes::UCUM, "code": "cm",
        });
        if let Some(sd_cm) = figure.sd_cm {
            quantity["extension"] = json!([codes::uncertainty(sd_cm)]);
        }
        let mut component = json!({
            "code": self.concept(&figure.code(), &words, &further), "valueQuantity": quantity,
        });
        let mark = match (figure.is_by_hand, figure.doubts.is_empty()) {
            (true, _) => Some(("by-hand", "hospital.by_hand")),
            (false, false) => Some(("doubtful", "hospital.doubtful")),
            (false, true) => None,
        };
        if let Some((code, key)) = mark {
            component["interpretation"] = json!([self.concept(code, language.text(key), &[])]);
        }
        component
    }

    /// The doubts about a leg's figures, each with the figures that it is about.
    fn notes(&self, figures: &[ExportFigure]) -> Vec<Value> {
        let doubts = figures.iter().flat_map(|figure| {
            figure.doubts.iter().map(move |doubt| (doubt.as_str(), figure.code()))
        });
        let said = |(doubt, boxes): (&str, Vec<String>)| {
            let title = title(doubt, self.rules.language);
            json!({ "text": format!("{}: {title}", boxes.join(", ")) })
        };
        grouped(doubts).into_iter().map(said).collect()
    }
}
