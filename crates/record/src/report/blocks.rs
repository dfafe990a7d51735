//! The report of a record as blocks, in reading order.

use gaiter_language::Language;

use super::content::{ReportContent, Section, Sizes};
use super::document::{Appendix, Block, Document, Origin, Room, Sheet, View};
use crate::Record;
use crate::picture::figures::{DrawnFigure, SHEET};

/// How many facts about the record are on the sheet: patient, record, order, and who named the patient.
const SHEET_FACTS: usize = 4;

/// The figures of the appendix, by their names.
const APPENDIX: [&str; 3] = ["sections", "fit", "error"];

impl ReportContent {
    /// The report of the record that this is the content of, with its figures in the same language.
    pub fn document(self, record: &Record, figures: &[DrawnFigure]) -> Document {
        let language = self.head.language;
        let text = |key: &'static str| language.text(key).to_owned();
        let sheet = Sheet {
            facts: self.facts.iter().take(SHEET_FACTS).cloned().collect(),
            levels: self.levels,
            age: self.age,
            see_sizes: self.sizes.as_ref().and_then(|of| of.see.clone()),
            legs: figures.iter().find(|of| of.name == SHEET).cloned(),
            open: self.open,
        };
        let view = View {
            title: text("report.pictures.view"),
            whose: Some(self.head.patient.clone()),
            text: None,
            record: record.clone(),
            words: Vec::new(),
        };
        let others = figures.iter().filter(|of| of.name != SHEET);
        let (appended, pictures): (Vec<&DrawnFigure>, Vec<&DrawnFigure>) =
            others.partition(|of| APPENDIX.contains(&of.name));
        let drawn = |of: &DrawnFigure| picture(of, language);
        let mut blocks =
            vec![Block::Verdict(self.verdict), Block::Sheet(Box::new(sheet)), Block::Turn];
        blocks.extend(self.sizes.into_iter().flat_map(sizes));
        blocks.push(Block::View(Box::new(view)));
        blocks.push(Block::Notes { notes: self.notes, summary: self.summary });
        blocks.extend(pictures.into_iter().map(drawn));
        blocks.extend(self.tables.into_iter().map(Block::Table));
        blocks.push(Block::Section(self.legend));
        blocks.push(Block::Facts(Section { title: text("report.origin"), entries: self.facts }));
        let mut appendix: Vec<Block> = appended.into_iter().map(drawn).collect();
        appendix.extend(self.slices.map(Block::Table));
        appendix.extend([Block::Section(self.surfaces), Block::Table(self.landmarks)]);
        let appendix = Appendix { title: text("report.pictures.appendix"), blocks: appendix };
        let origin = origin(record);
        Document { head: self.head, origin, paper: None, blocks, appendix: Some(appendix) }
    }
}

fn origin(record: &Record) -> Origin {
    Origin {
        id: format!("{} {}", record.scan.sha256, record.revision),
        author: record.station.clone().unwrap_or_else(|| "gaiter".to_owned()),
        made_by: format!("gaiter {}", record.made_by.gaiter),
        at: record.acquired.as_ref().map(|acquired| acquired.at),
    }
}

/// The sizes of makers' tables. Without tables there is only the form.
fn sizes(of: Sizes) -> impl Iterator<Item = Block> {
    let about = Section { title: of.title, entries: of.about };
    let about = (!about.entries.is_empty()).then_some(Block::Section(about));
    let tables = of.tables.into_iter().map(Block::Table);
    about
        .into_iter()
        .chain(tables)
        .chain(of.calibre.map(Block::Section))
        .chain([Block::Table(of.form)])
}

/// A figure of a record below what it shows, and above how to read it.
fn picture(of: &DrawnFigure, language: Language) -> Block {
    let word = |part: &str| language.find(&format!("report.caption.{}.{part}", of.name));
    Block::Picture {
        title: word("title").map_or_else(|| of.picture.title.clone(), str::to_owned),
        figure: of.clone(),
        caption: word("text").unwrap_or_default().to_owned(),
        room: Room::Page,
    }
}
