//! How exports come to lie in the folder.

use super::booth::Booth;
use super::content::{Content, Whole};
use super::folder::FileContent;
use super::truth::{Export, Plan, id};
use std::rc::Rc;

/// How an export begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum How {
    /// Under a name of its own.
    New,
    /// Over a file of that name: truncated and written anew.
    Rewrite,
    /// In place of a file of that name: a new one.
    Replace,
    /// Under a temporary name, and renamed when it is whole.
    Temporary,
    /// All of it, written elsewhere and moved in.
    MovedIn,
}

/// How somebody brings in an older scan.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Brought {
    /// With a folder that is moved in.
    Folder,
    /// Copied under a name of its own, content first and the time of its source last.
    Copy,
    /// Copied so over a file of that name, in place.
    Over,
    /// It lies in another folder, to which the path of the export folder leads for a while.
    Turned,
}

/// An older scan was made this long ago at least, milliseconds: longer than any name waits.
const OLDER_MS: u64 = 3_000_000;

/// How the rest of an export comes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rest {
    /// By itself after so long, milliseconds.
    After(u64),
    /// When somebody says so.
    Open,
}

impl Booth {
    /// A name for a new file.
    pub fn fresh_name(&mut self) -> String {
        format!("n{}.obj", self.truth.comment())
    }

    /// The export of a body begins: `whole` is what it will be, the first scan of it or with another
    /// comment.
    pub fn begin_export(
        &mut self,
        body: usize,
        whole: &Rc<Whole>,
        how: How,
        name: &str,
        rest: Rest,
    ) {
        let now = self.now_ms;
        let part = match self.chance.below(4) {
            0 => 0,
            1 => 500 + self.chance.below(3000),
            _ => 4096 + self.chance.below(800),
        };
        let content = Content::new(whole, part);
        let held = FileContent::Export((part > 0).then(|| content.clone()));
        let temporary = match self.chance.below(2) {
            0 => format!(".{name}.part"),
            _ => format!("{name}.tmp"),
        };
        let under = if how == How::Temporary { temporary } else { name.to_owned() };
        self.overwritten(&under);
        let of = &mut self.truth.bodies[body];
        of.began_ms.get_or_insert(now);
        if how == How::MovedIn {
            let all = FileContent::Export(Some(Content::new(whole, usize::MAX)));
            let since = of.scanned_ms.min(now);
            let written = since + (now - since) / 2;
            (of.plan, of.file) = (Plan::Whole, Some(name.to_owned()));
            self.folder.move_in(name, all, written, now);
            self.measures(body, name);
            self.tell(|| format!("the export of body {body} is moved in as {name}"));
            self.hint();
            return;
        }
        of.plan = Plan::Coming;
        of.file = Some(name.to_owned());
        let ino = match (how, self.folder.inode(&under)) {
            (How::Rewrite, Some(ino)) => {
                self.folder.write(ino, held, now);
                ino
            }
            _ => self.folder.create(&under, held, now),
        };
        let ends_ms = match rest {
            Rest::After(after) => Some(now + after),
            Rest::Open => None,
        };
        let then = (how == How::Temporary).then(|| name.to_owned());
        self.tell(|| {
            format!("the export of body {body} begins as {under} ({how:?}, {part} bytes)")
        });
        if then.is_none() {
            self.measures(body, name);
        }
        self.truth.exports.push(Export { body, name: under, ino, content, then, ends_ms });
        self.hint();
    }

    /// Somebody brings in the scan of a patient who was scanned elsewhere.
    pub fn bring_in(&mut self, patient: usize, how: Brought, name: &str) {
        let body = self.scan_body(patient, false);
        let written = self.now_ms - OLDER_MS - self.chance.below(500_000) as u64;
        let of = &mut self.truth.bodies[body];
        (of.scanned_ms, of.plan, of.is_older) = (written, Plan::Over, true);
        let whole = Rc::clone(&of.whole);
        let all = FileContent::Export(Some(Content::new(&whole, usize::MAX)));
        self.tell(|| format!("body {body}, made long ago, is brought in as {name} ({how:?})"));
        match how {
            Brought::Folder => self.folder.move_in_folder(name, all, written, self.now_ms),
            Brought::Copy | Brought::Over => self.copy_in(name, &whole, written),
            Brought::Turned => {
                self.folder.put_aside(name, all, written);
                self.folder.turn();
                self.hint();
                let by_ms = 500 + self.chance.below(15_000) as u64;
                self.advance(by_ms);
                self.folder.turn();
            }
        }
        self.hint();
    }

    /// A copy, in less than the quiet time; looks may come in between.
    fn copy_in(&mut self, name: &str, whole: &Rc<Whole>, written_ms: u64) {
        self.overwritten(name);
        let part = Content::new(whole, 1 + self.chance.below(whole.length()));
        let part = FileContent::Export(Some(part));
        let ino = match self.folder.inode(name) {
            Some(ino) => {
                self.folder.write(ino, part, self.now_ms);
                ino
            }
            None => self.folder.create(name, part, self.now_ms),
        };
        self.hint();
        let by_ms = self.chance.below(900) as u64;
        self.advance(by_ms);
        let all = FileContent::Export(Some(Content::new(whole, usize::MAX)));
        self.folder.write(ino, all, self.now_ms);
        self.hint();
        let by_ms = self.chance.below(900) as u64;
        self.advance(by_ms);
        self.folder.set_back(ino, written_ms, self.now_ms);
    }

    /// Another file takes a name: what was being written there is lost.
    pub fn overwritten(&mut self, name: &str) {
        let exports = std::mem::take(&mut self.truth.exports);
        // Nobody writes into a file that another export is written over, under whatever name.
        let ino = self.folder.inode(name);
        let (lost, kept): (Vec<Export>, Vec<Export>) =
            exports.into_iter().partition(|export| export.name == name || Some(export.ino) == ino);
        self.truth.exports = kept;
        for export in lost {
            let body = &mut self.truth.bodies[export.body];
            if body.plan == Plan::Coming {
                body.plan = Plan::Broken;
            }
        }
        for (at, body) in self.truth.bodies.iter_mut().enumerate() {
            let was_here = body.file.as_deref() == Some(name) && body.plan == Plan::Whole;
            let is_known = self
                .disk
                .scans()
                .any(|(_, row)| row.content.whole.body == at && row.content.is_whole());
            if was_here && !is_known {
                // Nobody has taken it: it may come again.
                body.plan = Plan::Broken;
            }
        }
    }

    /// The scanner's own measures beside an export, once that lies under its name. Now and then it
    /// writes none, and leaves those of another that were taken with their scan.
    pub fn measures(&mut self, body: usize, name: &str) {
        let there = self.folder.stamp(&name.replace(".obj", ".ord"));
        let used = self.disk.companions.get(name);
        let was_taken = there.is_none_or(|there| used == Some(&there));
        if !self.setup.has_measures || (was_taken && self.chance.below(5) == 0) {
            return;
        }
        let text = format!("PATIENT={}", id(self.truth.bodies[body].patient));
        let name = name.replace(".obj", ".ord");
        let now = self.now_ms;
        match self.folder.inode(&name).filter(|_| self.chance.below(2) == 0) {
            Some(ino) => self.folder.write(ino, FileContent::Measures(text), now),
            None => drop(self.folder.create(&name, FileContent::Measures(text), now)),
        }
    }

    /// More of an export is written.
    pub fn grow(&mut self, place: usize) {
        let export = &mut self.truth.exports[place];
        let more = 300 + self.chance.below(1500);
        let length = (export.content.length() + more).min(export.content.whole.length() - 1);
        export.content = Content::new(&export.content.whole, length);
        let (ino, content, body) = (export.ino, export.content.clone(), export.body);
        self.folder.write(ino, FileContent::Export(Some(content)), self.now_ms);
        self.tell(|| format!("the export of body {body} grows to {length} bytes"));
        self.hint();
    }

    /// The same body with another comment.
    pub fn with_another_comment(&mut self, body: usize) -> Rc<Whole> {
        let whole = Rc::clone(&self.truth.bodies[body].whole);
        let comment = self.truth.comment();
        Whole::new(body, comment, whole.length(), whole.tells_its_end)
    }
}
