//! Volumes, slices, feet, heights that were asked for, and every figure of the levels in mm.

use super::super::words;
use super::super::words::findings::short;
use super::{Figure, Report, SIDES, Table, TableRow};
use crate::leg::{Level, Side};
use crate::record::chart::{AtFigures, SliceFigures, VolumeDifferenceFigures, VolumeFigures};
use crate::record::report::Mark;
use crate::record::rounding::cm_words;
use crate::record::schema::{EstimateFigures, FootFigures, LandmarkFigures};

impl Report<'_> {
    pub(super) fn tables(&self) -> Vec<Table> {
        let tables = [Some(self.volumes()), self.asked(), self.feet(), self.slices()];
        tables.into_iter().flatten().collect()
    }

    /// Heads of a table with a column a leg and one or more of differences.
    fn columns(&self, first: String, differences: &[String]) -> Vec<String> {
        let legs = SIDES.map(|side| words::leg_heading(side, self.language).to_owned());
        [first].into_iter().chain(legs).chain(differences.iter().cloned()).collect()
    }

    fn differences(&self) -> [String; 2] {
        [
            self.say("Left − right", "Links − rechts"),
            self.say("in % of the smaller", "in % des kleineren"),
        ]
    }

    fn volumes(&self) -> Table {
        let whole = self.record.differences.as_ref().and_then(|of| of.whole.as_ref());
        let whole_row = TableRow {
            head: self.say("Whole leg", "Ganzes Bein"),
            figures: self.volume_row(|of| (of.whole_ml, of.sd_ml), whole),
        };
        let between = TableRow {
            head: self.say("Between B and D", "Zwischen B und D"),
            figures: self.volume_row(|of| (of.b_to_d_ml, of.b_to_d_sd_ml), None),
        };
        Table {
            title: self.say("Volumes (ml)", "Volumen (ml)"),
            explanation: Some(self.ranges()),
            columns: self.columns(self.say("Part", "Abschnitt"), &self.differences()),
            rows: vec![whole_row, between],
        }
    }

    /// From where to where whole legs go, and over what they are compared.
    fn ranges(&self) -> String {
        let cm = |mm| cm_words(mm, self.language);
        let of_leg = |side: Side| {
            let volume = &self.leg(side)?.volume;
            let (from_mm, to_mm) = (volume.from_height_mm?, volume.to_height_mm?);
            let leg = words::leg(side, self.language);
            let to = self.say("to", "bis");
            Some(format!("{leg} {} {to} {} cm", cm(from_mm), cm(to_mm)))
        };
        let legs: Vec<String> = SIDES.into_iter().filter_map(of_leg).collect();
        let mut words = self.say(
            "The whole leg goes from its lowest to its highest measured section",
            "Das ganze Bein reicht vom untersten bis zum obersten gemessenen Schnitt",
        );
        if !legs.is_empty() {
            words += &format!(" ({})", legs.join(", "));
        }
        words.push('.');
        if self.record.differences.iter().any(|of| of.whole.is_some()) {
            words += &self.say(
                " The difference is taken over the range that both legs have.",
                " Die Differenz gilt für den Bereich, den beide Beine haben.",
            );
        }
        words
    }

    fn volume_row(
        &self,
        figure: fn(&VolumeFigures) -> (Option<f64>, Option<f64>),
        difference: Option<&VolumeDifferenceFigures>,
    ) -> Vec<Figure> {
        let of_leg = |side: Side| match self.leg(side).map(|leg| figure(&leg.volume)) {
            Some((Some(ml), sd_ml)) => Figure::ml(ml, sd_ml, self.language),
            Some((None, _)) => {
                Figure::missing(self.language.pick("not measured whole", "nicht ganz gemessen"))
            }
            None => Figure::missing(self.no_leg(side)),
        };
        SIDES.map(of_leg).into_iter().chain(self.volume_difference(difference)).collect()
    }

    fn volume_difference(&self, difference: Option<&VolumeDifferenceFigures>) -> [Figure; 2] {
        match difference {
            Some(of) => Figure::ml_difference([of.ml, of.percent], of.sd_ml, self.language),
            None => {
                let why = self.language.pick("not compared", "nicht verglichen");
                [Figure::missing(why), Figure::missing(why)]
            }
        }
    }

    /// Girths at the heights that were asked for; none where nobody asked.
    fn asked(&self) -> Option<Table> {
        let heights = &self.record.legs.iter().map(|leg| &leg.at).find(|at| !at.is_empty())?;
        let row = |(index, at): (usize, &AtFigures)| TableRow {
            head: format!("{} cm", cm_words(at.height_mm, self.language)),
            figures: SIDES.map(|side| self.girth_asked(side, index)).into(),
        };
        Some(Table {
            title: self.say(
                "Girths at heights that were asked for (cm)",
                "Umfänge in gewünschten Höhen (cm)",
            ),
            explanation: None,
            columns: self.columns(self.say("Height", "Höhe"), &[]),
            rows: heights.iter().enumerate().map(row).collect(),
        })
    }

    fn girth_asked(&self, side: Side, index: usize) -> Figure {
        let Some(leg) = self.leg(side) else { return Figure::missing(self.no_leg(side)) };
        let girth = leg.at.get(index).and_then(|at| Some((at, at.girth_tape_mm?)));
        let Some((at, girth_mm)) = girth else {
            return Figure::missing(self.language.pick("not seen there", "dort nicht zu sehen"));
        };
        let mark = if at.doubts.is_empty() { Mark::Sure } else { Mark::Doubtful };
        Figure::cm(girth_mm, at.girth_sd_mm, mark, self.language)
    }

    fn feet(&self) -> Option<Table> {
        let legs = self.legs();
        legs.iter().flatten().any(|leg| leg.foot.is_some()).then(|| {
            let figure = |side: Side, of: fn(&FootFigures) -> f64| {
                let foot = self.leg(side).map(|leg| leg.foot.as_ref());
                match foot {
                    Some(Some(foot)) => Figure::plain(cm_words(of(foot), self.language)),
                    Some(None) => {
                        Figure::missing(self.language.pick("foot not seen", "Fuß nicht zu sehen"))
                    }
                    None => Figure::missing(self.no_leg(side)),
                }
            };
            let row = |head: String, of: fn(&FootFigures) -> f64| TableRow {
                head,
                figures: SIDES.map(|side| figure(side, of)).into(),
            };
            Table {
                title: self.say("Feet (cm)", "Füße (cm)"),
                explanation: None,
                columns: self.columns(self.say("Measure", "Maß"), &[]),
                rows: vec![
                    row(self.say("Length", "Länge"), |foot| foot.length_mm),
                    row(self.say("Breadth", "Breite"), |foot| foot.breadth_mm),
                ],
            }
        })
    }

    /// Volumes of the slices of 4 cm; none where no leg has any.
    fn slices(&self) -> Option<Table> {
        let longest = self.record.legs.iter().map(|leg| &leg.volume.slices);
        let longest = longest.max_by_key(|slices| slices.len()).filter(|all| !all.is_empty())?;
        let row = |slice: &SliceFigures| {
            let figure = |side: Side| self.slice(side, slice);
            let differences = self.record.differences.iter().flat_map(|of| &of.slices);
            let difference = differences.into_iter().find(|at| at.from_mm == slice.from_mm);
            let ends = [slice.from_mm, slice.to_mm].map(|mm| format!("{:.0}", mm / 10.0));
            let legs = SIDES.map(figure).into_iter();
            TableRow {
                head: ends.join("–"),
                figures: legs.chain(self.volume_difference(difference)).collect(),
            }
        };
        Some(Table {
            title: self.say("Volumes of slices (ml)", "Volumen in Scheiben (ml)"),
            explanation: Some(self.say(
                "Slices across the leg's axis, along it from the floor.",
                "Scheiben quer zur Achse des Beins, entlang der Achse vom Boden an.",
            )),
            columns: self.columns(self.say("From–to (cm)", "Von–bis (cm)"), &self.differences()),
            rows: longest.iter().rev().map(row).collect(),
        })
    }

    fn slice(&self, side: Side, at: &SliceFigures) -> Figure {
        let Some(leg) = self.leg(side) else { return Figure::missing(self.no_leg(side)) };
        let slice = leg.volume.slices.iter().find(|slice| slice.from_mm == at.from_mm);
        match slice.and_then(|slice| Some((slice.ml?, slice.sd_ml))) {
            Some((ml, sd_ml)) => Figure::ml(ml, sd_ml, self.language),
            None => Figure::missing(self.language.pick("not seen whole", "nicht ganz zu sehen")),
        }
    }

    /// Every figure of the levels, with the digits of `record.json`.
    pub(super) fn landmarks(&self) -> Table {
        let columns = [
            ("Level", "Messstelle"),
            ("Height", "Höhe"),
            ("Its standard error", "Standardfehler"),
            ("Along the axis", "Entlang der Achse"),
            ("Along the skin", "Entlang der Haut"),
            ("Girth by tape", "Umfang mit Band"),
            ("Its standard error", "Standardfehler"),
            ("Girth along the skin", "Umfang der Haut"),
            ("Found by", "Gefunden durch"),
            ("Doubts", "Zweifel"),
        ];
        let rows = SIDES.into_iter().flat_map(|side| self.landmarks_of(side)).collect();
        Table {
            title: self.say("All levels as recorded (mm)", "Alle Messstellen wie im Datensatz (mm)"),
            explanation: Some(self.say(
                "Digit by digit as in record.json, with one standard error, not two. Heights are \
                 vertical above the floor.",
                "Ziffer für Ziffer wie in record.json, mit einem Standardfehler, nicht zweien. Höhen \
                 sind senkrecht über dem Boden.",
            )),
            columns: columns.map(|(english, german)| self.say(english, german)).into(),
            rows,
        }
    }

    fn landmarks_of(&self, side: Side) -> Vec<TableRow> {
        let Some(leg) = self.leg(side) else { return Vec::new() };
        let head = |level: Level, about: &str| {
            format!("{}, {}{about}", level.name(), words::leg(side, self.language))
        };
        let estimated = self.say(", estimated", ", geschätzt");
        let row =
            |level: Level| match (leg.landmarks.get(level.name()), leg.estimates.get(level.name()))
            {
                (Some(found), _) => {
                    Some(TableRow { head: head(level, ""), figures: self.found_in_mm(found) })
                }
                (None, Some(of)) => Some(TableRow {
                    head: head(level, &estimated),
                    figures: self.estimate_in_mm(of),
                }),
                (None, None) => None,
            };
        Level::ALL.into_iter().rev().filter_map(row).collect()
    }

    fn found_in_mm(&self, of: &LandmarkFigures) -> Vec<Figure> {
        vec![
            self.digits(Some(of.height_mm)),
            self.digits(of.height_sd_mm),
            self.digits(Some(of.along_axis_mm)),
            self.digits(of.surface_length_mm),
            self.digits(Some(of.girth_tape_mm)),
            self.digits(of.girth_sd_mm),
            self.digits(Some(of.girth_contour_mm)),
            Figure::plain(words::messages::told(&of.by, self.language).0),
            self.doubts_in_words(&of.doubts),
        ]
    }

    fn estimate_in_mm(&self, of: &EstimateFigures) -> Vec<Figure> {
        vec![
            self.digits(Some(of.height_mm)),
            self.digits(of.height_sd_mm),
            self.digits(Some(of.along_axis_mm)),
            self.digits(None),
            self.digits(Some(of.girth_tape_mm)),
            self.digits(of.girth_sd_mm),
            self.digits(None),
            Figure::plain(words::messages::told(&of.by, self.language).0),
            self.doubts_in_words(&of.doubts),
        ]
    }

    /// A figure as JSON writes it.
    fn digits(&self, mm: Option<f64>) -> Figure {
        match mm {
            Some(mm) => Figure::plain(format!("{mm:?}")),
            None => Figure::missing(self.language.pick("not known", "nicht bekannt")),
        }
    }

    fn doubts_in_words(&self, codes: &[String]) -> Figure {
        match codes {
            [] => Figure::plain(self.say("none", "keine")),
            codes => {
                let words: Vec<String> =
                    codes.iter().map(|code| short(code, self.language)).collect();
                Figure::plain(words.join(", "))
            }
        }
    }
}
