//! What is true, and what only the model knows: who stood in the booth when each body was scanned, and
//! what becomes of its exports.

use std::rc::Rc;

use super::booth::Booth;
use super::content::{Content, Whole};
use super::folder::FileContent;

/// What is to come of a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Plan {
    /// Its export has not begun.
    Scanned,
    /// Its export is being written.
    Coming,
    /// Its export broke off, and may go on or come again.
    Broken,
    /// It lies there whole.
    Whole,
    /// Nothing more comes of it.
    Over,
}

/// One scan of somebody.
#[derive(Debug, Clone)]
pub struct Body {
    pub patient: usize,
    pub scanned_ms: u64,
    /// When its export began first.
    pub began_ms: Option<u64>,
    pub whole: Rc<Whole>,
    pub plan: Plan,
    /// The file of its last export.
    pub file: Option<String>,
    /// The measurement refuses it although it is whole.
    pub is_refused: bool,
    /// It was scanned elsewhere long ago, and somebody brings it in.
    pub is_older: bool,
    /// An export began later than any capture waits.
    pub is_late: bool,
    /// When the station refused an export of it.
    pub refused_ms: Option<u64>,
    /// A name was said for just this scan, or a press was heard for it.
    pub is_covered: bool,
}

/// An export that is being written.
#[derive(Debug, Clone)]
pub struct Export {
    pub body: usize,
    pub name: String,
    pub ino: u64,
    pub content: Content,
    /// Under what name it comes when it is whole, where that is another.
    pub then: Option<String>,
    /// When its rest is written; none while somebody must say so.
    pub ends_ms: Option<u64>,
}

#[derive(Debug, Default)]
pub struct Truth {
    pub bodies: Vec<Body>,
    pub exports: Vec<Export>,
    /// A body under another's name.
    pub wrong: Option<String>,
    /// The rule that a scan broke which came to a patient.
    pub unclean: Option<String>,
    /// Bodies under another's name that nobody could have known of, see the assumptions.
    pub excused: usize,
    /// From now on what goes wrong is told apart: a thing came later than anybody waits for it.
    pub is_late: bool,
    pub comments: u64,
}

/// The id of a patient.
pub fn id(patient: usize) -> String {
    format!("{}", 1000 + patient)
}

impl Truth {
    pub fn next_end_ms(&self) -> Option<u64> {
        self.exports.iter().filter_map(|export| export.ends_ms).min()
    }

    pub fn comment(&mut self) -> u64 {
        self.comments += 1;
        self.comments
    }

    /// The bodies with this plan.
    pub fn planned(&self, plan: Plan) -> Vec<usize> {
        (0..self.bodies.len()).filter(|body| self.bodies[*body].plan == plan).collect()
    }
}

impl Booth {
    /// Somebody is scanned.
    pub fn scan_body(&mut self, patient: usize, is_covered: bool) -> usize {
        let body = self.truth.bodies.len();
        let length = 5000 + self.chance.below(3000);
        let tells_its_end = self.chance.below(3) > 0;
        let comment = self.truth.comment();
        self.truth.bodies.push(Body {
            patient,
            scanned_ms: self.now_ms,
            began_ms: None,
            whole: Whole::new(body, comment, length, tells_its_end),
            plan: Plan::Scanned,
            file: None,
            is_refused: false,
            is_older: false,
            is_late: false,
            refused_ms: None,
            is_covered,
        });
        body
    }

    /// Writes the rest of the export that is due.
    pub fn end_due_export(&mut self) {
        let Some(at) = self.truth.next_end_ms() else { return };
        let exports = &self.truth.exports;
        if let Some(place) = exports.iter().position(|export| export.ends_ms == Some(at)) {
            self.end_export(place);
        }
    }

    /// Writes the rest of an export.
    pub fn end_export(&mut self, place: usize) {
        let export = self.truth.exports.remove(place);
        let whole = Content::new(&export.content.whole, usize::MAX);
        self.folder.write(export.ino, FileContent::Export(Some(whole)), self.now_ms);
        if let Some(then) = &export.then {
            self.overwritten(then);
            self.folder.rename(&export.name, then, self.now_ms);
            self.measures(export.body, then);
        }
        let file = export.then.unwrap_or(export.name);
        self.tell(|| format!("the export of body {} is whole in {file}", export.body));
        let body = &mut self.truth.bodies[export.body];
        if body.plan != Plan::Over {
            body.plan = Plan::Whole;
        }
        body.file = Some(file);
        self.hint();
    }

    /// Every record lies under the name of the one who was scanned, or of the patient whom a person named.
    pub fn check_records(&mut self) {
        let mut wrong = None;
        for (scan, (content, whose)) in &self.disk.records {
            let body = &self.truth.bodies[content.whole.body];
            let truth = id(body.patient);
            let decided = self.disk.decision(*scan);
            for who in whose.iter().flatten() {
                let is_right = match decided {
                    Some(decided) => decided.as_ref() == Some(who),
                    None => *who == truth,
                };
                if !is_right && !self.disk.is_withdrawing(*scan, &Some(who.clone())) {
                    wrong = Some((content.whole.body, who.clone(), truth.clone(), body.is_late));
                }
            }
        }
        let Some((body, who, truth, is_late)) = wrong else { return };
        if is_late || self.truth.is_late {
            self.truth.excused += 1;
            // One row for each; the rest of the sequence is not looked at.
            self.truth.is_late = true;
        } else if self.truth.wrong.is_none() {
            self.tell(|| format!("WRONG: body {body} of {truth} lies under {who}"));
            self.truth.wrong = Some(format!("body {body} of {truth} lies under {who}"));
        }
    }
}
