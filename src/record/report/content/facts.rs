//! Where a record comes from, in words.

use jiff::Timestamp;
use jiff::tz::TimeZone;

use super::super::words;
use super::{Fact, Report, Section};
use crate::record::rounding::cm_words;
use crate::record::shown;

/// How many digits of a scan's hash distinguish it from all others of a clinic.
const HASH_DIGITS: usize = 16;

impl Report<'_> {
    pub(super) fn patient(&self) -> String {
        match &self.record.patient {
            Some(patient) => shown::id(&patient.id),
            None => self.say("not assigned", "nicht zugeordnet"),
        }
    }

    pub(super) fn taken(&self) -> String {
        let station = self.record.station.as_ref().map(|station| shown::id(station));
        [Some(self.time()), station].into_iter().flatten().collect::<Vec<_>>().join(" · ")
    }

    fn time(&self) -> String {
        match &self.record.acquired {
            Some(acquired) => self.utc(acquired.at),
            None => self.say("time of the scan unknown", "Zeit des Scans unbekannt"),
        }
    }

    /// Date and time in the format of the language.
    fn utc(&self, at: Timestamp) -> String {
        let format = self.language.pick("%-d %B %Y, %H:%M UTC", "%d.%m.%Y, %H:%M UTC");
        at.to_zoned(TimeZone::UTC).strftime(format).to_string()
    }

    pub(super) fn facts(&self) -> Vec<Fact> {
        let record = self.record;
        let fact = |name: String, value: String| Fact { name, value };
        let mut facts = vec![fact(self.say("Patient", "Patient"), self.patient())];
        facts.extend(self.sources().map(|by| fact(self.say("Named by", "Benannt durch"), by)));
        facts.push(fact(self.say("Scan taken", "Scan vom"), self.time_and_source()));
        let station = record.station.as_deref().map_or_else(
            || self.say("none (measured by hand)", "keine (von Hand vermessen)"),
            shown::id,
        );
        facts.push(fact(self.say("Station", "Station"), station));
        facts.extend(self.heights().map(|heights| fact(self.say("Body", "Körper"), heights)));
        let hash: String = record.scan.sha256.chars().take(HASH_DIGITS).collect();
        facts.push(fact(self.say("Scan", "Scan"), self.scan(&shown::id(&hash))));
        let program = format!("gaiter {}", shown::id(&record.made_by.gaiter));
        facts.push(fact(self.say("Program", "Programm"), program));
        facts.push(fact(self.say("Revision", "Revision"), record.revision.to_string()));
        facts
    }

    /// All sources that named the patient.
    fn sources(&self) -> Option<String> {
        let patient = self.record.patient.as_ref()?;
        let words = patient.sources.iter().map(|source| words::source(source.kind, self.language));
        let words = words.collect::<Vec<_>>().join(", ");
        (!words.is_empty()).then_some(words)
    }

    fn time_and_source(&self) -> String {
        let from = self.record.acquired.as_ref().map(|acquired| acquired.from);
        let from = from.map(|from| format!(" ({})", words::time_from(from, self.language)));
        self.time() + &from.unwrap_or_default()
    }

    /// Heights of the body, if the scan holds more than a single leg.
    fn heights(&self) -> Option<String> {
        let body = &self.record.body;
        let told = |name: String, mm: f64| format!("{name} {} cm", cm_words(mm, self.language));
        let stature = body.stature_mm.map(|mm| told(self.say("stature", "Körpergröße"), mm));
        let crotch = body.crotch_height_mm.map(|mm| told(self.say("crotch at", "Schritthöhe"), mm));
        let words = [stature, crotch].into_iter().flatten().collect::<Vec<_>>().join(", ");
        (!words.is_empty()).then_some(words)
    }

    fn scan(&self, hash: &str) -> String {
        let scan = &self.record.scan;
        let (format, unit) = (shown::id(&scan.format), shown::id(&scan.unit));
        let unit_from = match scan.unit_inferred {
            true => self.say("found", "erkannt"),
            false => self.say("declared", "vorgegeben"),
        };
        let [points, unit_word] = [self.say("points", "Punkte"), self.say("unit", "Einheit")];
        format!("{hash}… ({format}, {} {points}, {unit_word} {unit}, {unit_from})", scan.points)
    }

    pub(super) fn legend(&self) -> Section {
        let entries = [
            self.say(
                "Girth: what a tape laid around the leg reads, without tension.",
                "Umfang: was ein Maßband ohne Zug um das Bein anzeigt.",
            ),
            self.say(
                "Length: from the floor along the skin of the inner side up to the level. “h” before \
                 a figure: vertical height above the floor, where the length is not known.",
                "Länge: vom Boden an der Innenseite entlang der Haut bis zum Messpunkt. „h“ vor \
                 einer Zahl: senkrechte Höhe über dem Boden, wo die Länge nicht bekannt ist.",
            ),
            self.say(
                "±: two standard errors, rounded up; about 95 of 100 repeated scans lie within. ± ?: \
                 it cannot be judged.",
                "±: zwei Standardfehler, aufgerundet; etwa 95 von 100 wiederholten Scans liegen \
                 darin. ± ?: nicht zu beurteilen.",
            ),
            self.say(
                "~ (≈ in pictures): estimated by the body's proportions, not measured. ?: there is a doubt; see the \
                 notes.",
                "~ (in Bildern ≈): aus den Proportionen des Körpers geschätzt, nicht gemessen. ?: es gibt einen \
                 Zweifel; siehe Hinweise.",
            ),
            self.say(
                "Difference: left minus right, of the exact figures; in bold where it is larger than \
                 its own uncertainty.",
                "Differenz: links minus rechts, aus den genauen Zahlen; fett, wo sie größer ist als \
                 ihre eigene Unsicherheit.",
            ),
            self.say(
                "Left and right are the patient's own. Whatever is drawn from the front shows the \
                 right leg on the left.",
                "Links und rechts sind die Seiten des Patienten. In allem, was von vorn gezeichnet \
                 ist, steht das rechte Bein links.",
            ),
        ];
        let title = self.say("How to read this", "So ist es zu lesen");
        Section { title, entries: entries.into() }
    }
}
