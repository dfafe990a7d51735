//! Looks and takes, step by step as the intake makes them, so that anything may happen in between:
//! composed as in `station/intake.rs`, `station/intake/ingest.rs` and
//! `station/custody.rs`.

#![allow(clippy::large_enum_variant)]
use std::collections::{BTreeMap, VecDeque};
use std::time::Duration;

use gaiter_flow::export::companions::{self, Done};
use gaiter_flow::patient::identity;
use gaiter_flow::round::{Capture, CaptureMatch, ExportContent, Named};
use gaiter_flow::settle::{Folders, Gone};
use gaiter_flow::{Fingerprint, Look, LookTime, Settled, Stamp, StatedPatient, Verdict};
use gaiter_record::SourceKind;

use super::booth::{Booth, NEVER, NOBODY, RESCAN_MS, Run, change};
use super::content::Content;
use super::disk::{DiskFault, Intake};
use super::folder::{self, FileContent, name_of};
use super::laws::Off;
use super::oracle::{Seen, Went};
use super::work::first_sights;

/// A refused scan with fewer bytes than this tells nothing by being the beginning of another: the
/// station's `COMPLETED_LEAST`, in proportion to the contents of the model.
pub const COMPLETED_LEAST: usize = 4096;

/// The shortest time from one look to the next, milliseconds.
const LOOK_PAUSE_MIN_MS: u64 = 100;

/// What the intake does next.
pub enum Phase {
    /// A look begins.
    Rest,
    /// The folder is listed.
    List { began: Duration },
    /// The look ends.
    Decide { began: Duration, found: Vec<(String, Stamp)>, folders: Folders },
    /// Parts of files are read.
    Mark { due: VecDeque<Settled> },
    /// A file that has settled is read.
    Read { due: VecDeque<Settled> },
    /// What was read is taken.
    Take { due: VecDeque<Settled>, settled: Settled, mark: Fingerprint, content: Content },
}

/// What goes wrong with one scan that comes in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TakeFault {
    /// The spool keeps nothing.
    Spool,
    /// The bytes are kept and the sync of their name fails.
    Sync,
    /// The bytes are kept and the journal fails.
    Journal,
    /// The process ends when the bytes are kept.
    Crash,
    /// The process ends when the journal has the scan.
    CrashEntered,
}

impl Booth {
    /// Something in the folder changed, or the button was pressed.
    pub fn look_at_once(&mut self) {
        if let Some(run) = &mut self.run
            && matches!(run.phase, Phase::Rest)
        {
            run.step_at_ms = run.step_at_ms.min(self.now_ms + LOOK_PAUSE_MIN_MS);
            run.idle_ms = None;
        }
    }

    pub fn hint(&mut self) {
        if self.setup.hints && !self.is_away {
            self.look_at_once();
        }
    }

    /// The next step of the intake.
    pub fn step(&mut self) {
        let Some(run) = &mut self.run else { return };
        let phase = std::mem::replace(&mut run.phase, Phase::Rest);
        let (next, pause_ms) = match phase {
            Phase::Rest => (Phase::List { began: self.clock() }, self.chance.below(60) as u64),
            Phase::List { began } => {
                run.listed = self.folder.version;
                let (found, folders) = (self.folder.list(), self.folder.folders());
                (Phase::Decide { began, found, folders }, self.chance.below(60) as u64)
            }
            Phase::Decide { began, found, folders } => {
                let due = self.decide(began, found, folders);
                (Phase::Mark { due }, self.chance.below(30) as u64)
            }
            Phase::Mark { due } => {
                self.mark(!due.is_empty());
                (Phase::Read { due }, 1)
            }
            Phase::Read { due } => self.read(due),
            Phase::Take { due, settled, mark, content } => {
                self.taken(&settled, &mark, &content);
                (Phase::Read { due }, 1)
            }
        };
        if let Some(run) = &mut self.run {
            (run.phase, run.step_at_ms) = (next, self.now_ms + pause_ms);
        }
    }

    fn decide(
        &mut self,
        began: Duration,
        found: Vec<(String, Stamp)>,
        folders: Folders,
    ) -> VecDeque<Settled> {
        let ended = self.clock();
        let off = self.setup.off;
        let is_away = self.is_away;
        let Some(run) = &mut self.run else { return VecDeque::new() };
        let when = LookTime { began, ended };
        if is_away {
            run.settling.observe(Look::OutOfReach, when);
            run.sights = run.settling.sights();
            return VecDeque::new();
        }
        first_sights(run, &found, began, ended);
        let (mut scans, mut beside, mut passers) =
            (BTreeMap::new(), BTreeMap::new(), BTreeMap::new());
        for (name, stamp) in found {
            let stamp = as_found(off, &name, stamp);
            let ending = name.rsplit_once('.').filter(|_| !name.starts_with('.'));
            let of = match ending {
                Some((_, "obj")) => &mut scans,
                Some((_, "ord")) => &mut beside,
                _ => &mut passers,
            };
            of.insert(folder::path(&name), stamp);
        }
        if off != Off::BroughtInIsOlder {
            run.settling.found_in(folders);
        }
        run.settling.pass_over(passers, when);
        let groups = companions::groups(scans, beside, |_| Done::NotAsked);
        let due = run.settling.observe(Look::Seen(groups), when);
        run.sights = run.settling.sights();
        let journal = &self.disk;
        due.into_iter().filter(|file| !dealt_with(journal, run, file)).collect()
    }

    fn mark(&mut self, is_any_due: bool) {
        let now = self.clock();
        let Some(run) = self.run.as_mut().filter(|_| !self.is_away) else { return };
        for (path, stamp) in run.settling.unmarked() {
            let content = self.folder.export(&name_of(&path));
            let mark = content.and_then(|content| content.mark(now, now, stamp.size));
            run.settling.marked(&path, stamp, mark);
        }
        let gone = run.settling.gone(is_any_due);
        self.lose(gone);
        let Some(run) = &mut self.run else { return };
        let memory = run.settling.memory();
        let opened = run.captures.waiting().map(|capture| capture.opened).max();
        let is_kept = run.kept.as_ref().is_some_and(|kept| {
            let covers = opened.is_none_or(|at| kept.looked.is_some_and(|looked| looked > at));
            kept.files == memory.files && covers && kept.looked.is_some() == memory.looked.is_some()
        });
        if !is_kept {
            run.kept = self.disk.looked(&memory).ok().map(|()| memory);
        }
    }

    /// As `Intake::lose` and `Booth::gone`. That contents count, and not names, is one law.
    fn lose(&mut self, gone: Vec<Gone>) {
        let off = self.setup.off;
        let Some(run) = &mut self.run else { return };
        let is_known = |of: &Gone| self.disk.was_sighted(&name_of(&of.path), of.stamp);
        let lost: Vec<Gone> = gone.into_iter().filter(|content| !is_known(content)).collect();
        if lost.is_empty() || [Off::ContentNotName, Off::Inodes].contains(&off) {
            return;
        }
        let mut after = run.captures.clone();
        lost.iter().for_each(|content| after.gone(content.appeared));
        let _ = change(off, &mut self.disk, run, after.clone());
        run.captures = after;
        for content in &lost {
            self.observe(Seen::Gone(self.began(content.appeared)));
        }
        self.tell(|| format!("gone before it was taken: {lost:?}"));
    }

    /// Reads the next file that has settled; else rests.
    fn read(&mut self, mut due: VecDeque<Settled>) -> (Phase, u64) {
        let now = self.clock();
        let off = self.setup.off;
        let is_shut = self.is_paused || self.is_away;
        let Some(run) = &mut self.run else { return (Phase::Rest, 0) };
        while let Some(settled) = due.pop_front().filter(|_| !is_shut) {
            let name = name_of(&settled.path);
            let state = self.folder.stamp(&name).map(|stamp| as_found(off, &name, stamp));
            let is_it = state == Some(settled.group.stamp);
            let Some(content) = self.folder.export(&name).filter(|_| is_it).cloned() else {
                run.settling.changed(&settled, now);
                continue;
            };
            if let Some(mark) = content.mark(now, now, settled.group.stamp.size) {
                return (Phase::Take { due, settled, mark, content }, self.chance.below(20) as u64);
            }
        }
        run.sights = run.settling.sights();
        let is_idle = run.settling.next_due().is_none() && !is_shut;
        if is_idle && run.listed == self.folder.version {
            run.idle_ms = Some(self.now_ms + RESCAN_MS);
            return (Phase::Rest, NEVER - self.now_ms);
        }
        let soon = run.settling.next_due().map_or(RESCAN_MS, |at| {
            let left = at.saturating_sub(now).as_millis() as u64;
            if is_shut { left.max(2000) } else { left }
        });
        (Phase::Rest, soon.clamp(LOOK_PAUSE_MIN_MS, RESCAN_MS))
    }

    fn taken(&mut self, settled: &Settled, mark: &Fingerprint, content: &Content) {
        if let Some(run) = &mut self.run {
            let gone = run.settling.overwritten_by(settled, content.bytes());
            run.settling.read(settled, mark);
            self.lose(gone.into_iter().collect());
        }
        let awaits_rest = !settled.awaited && content.awaits_rest();
        let came = if awaits_rest { Ok(()) } else { self.take(settled, content) };
        let (now, chance) = (self.clock(), self.chance.unit());
        let Some(run) = &mut self.run else { return };
        match came {
            Ok(()) if awaits_rest => run.settling.cut_short(settled),
            Ok(()) => run.settling.taken(settled),
            Err(DiskFault) => {
                if self.disk.spool_holds(content.scan()) {
                    run.settling.kept(settled);
                }
                run.settling.failed(settled, now, chance);
            }
        }
    }

    /// As `ingest::take`.
    fn take(&mut self, settled: &Settled, content: &Content) -> Result<(), DiskFault> {
        let says = self.beside(settled);
        self.admit(settled, content, says)?;
        if self.run.is_none() {
            return Ok(());
        }
        let name = name_of(&settled.path);
        self.note_companion(&name, settled)?;
        self.disk.sighted(&name, settled.group.stamp)
    }

    /// As `ingest::admit`.
    fn admit(
        &mut self,
        settled: &Settled,
        content: &Content,
        says: StatedPatient,
    ) -> Result<(), DiskFault> {
        let (scan, off, now) = (content.scan(), self.setup.off, self.clock());
        let Some(run) = &self.run else { return Err(DiskFault) };
        let observed = run.settling.began(settled, content.bytes());
        let mut began = observed;
        self.tell(|| format!("{} is read; its content began {began:?}", name_of(&settled.path)));
        self.enter_kept()?;
        let known = self.disk.known(scan, &content.geometry());
        let completes = match known {
            Some(_) => None,
            None => self.completes(settled, content),
        };
        let Some(run) = &mut self.run else { return Err(DiskFault) };
        if off == Off::ContentNotName
            && let Some(first) = run.names.get(&name_of(&settled.path))
        {
            began = *first;
        }
        let is_known = known.is_some() && off != Off::KnownAnswerNothing;
        let is_cut_short = content.awaits_rest();
        let others = run.settling.others(settled, content.bytes());
        let is_rest = completes.is_some();
        let judge =
            ExportContent { began, others: others.clone(), is_known, is_cut_short, completes };
        let judged = match run.captures.match_content(&judge, now) {
            CaptureMatch::Of(capture) if capture.named().any(|named| named.id == NOBODY) => {
                CaptureMatch::Of(Capture { patient: None, ..capture })
            }
            judged => judged,
        };
        let named = self.setup.identity.of_file_name(&name_of(&settled.path));
        let says = [named, says];
        let whose = identity::of_judged(&judged, self.setup.hold_unpressed, says);
        let judged = match whose.held {
            Some(identity::PATIENTS_DIFFER) => judged.contradicted(),
            _ => judged,
        };
        let patient = whose.patient.map(|patient| patient.id);
        let patients = known.map_or_else(Vec::new, |known| self.disk.patients(known));
        let verdict = identity::verdict(patients.iter().map(Option::as_deref), patient.as_deref());
        let verdict = match verdict {
            Verdict::New => whose.held.map_or(Verdict::New, Verdict::Held),
            other => other,
        };
        if verdict == Verdict::Already {
            if off == Off::KnownAnswerNothing {
                run.captures.answer(&judged, now);
            }
            self.tell(|| format!("{:?} is known", content.scan()));
            return Ok(());
        }
        let held = match verdict {
            Verdict::Held(why) => Some(why),
            Verdict::New | Verdict::Already => None,
        };
        let intake = Intake {
            content: content.clone(),
            patient,
            held,
            geometry: content.geometry(),
            judged: judged.clone(),
        };
        let was_kept = self.disk.spool_holds(scan);
        let entered = self.keep(content, &intake);
        let is_kept = self.run.is_none() || entered.is_ok() || self.disk.spool_holds(scan);
        if let Some(went) = Went::from_match(&judged).filter(|_| is_kept && !was_kept) {
            let others = others.iter().map(|other| self.began(*other)).collect();
            let began = self.began(observed);
            self.observe(Seen::Taken { scan, began, others, went, is_rest });
            self.check_round();
        }
        entered
    }

    /// What was just given to a patient had a clean round.
    fn check_round(&mut self) {
        let Some(flaw) = self.oracle.flaw() else { return };
        self.tell(|| format!("NO CLEAN ROUND: {flaw}"));
        self.truth.unclean.get_or_insert(flaw);
    }

    /// Spool, then journal, then memory; or what goes wrong in between.
    fn keep(&mut self, content: &Content, intake: &Intake) -> Result<(), DiskFault> {
        let (scan, now) = (content.scan(), self.clock());
        let fault = self.fault.take();
        let kept = match fault {
            Some(TakeFault::Spool) => Err(DiskFault),
            _ => {
                self.disk.spool_keep(scan, intake.clone());
                if fault == Some(TakeFault::Crash) {
                    self.crash();
                    return Ok(());
                }
                if fault == Some(TakeFault::Sync) { Err(DiskFault) } else { Ok(()) }
            }
        };
        let was_locked = self.disk.is_locked;
        self.disk.is_locked |= fault == Some(TakeFault::Journal);
        let entered = kept.and_then(|()| self.disk.enter(scan, intake));
        self.disk.is_locked = was_locked;
        if entered.is_ok() && fault == Some(TakeFault::CrashEntered) {
            self.crash();
            return Ok(());
        }
        let (is_kept, judged) = (self.disk.spool_holds(scan), &intake.judged);
        let Some(run) = &mut self.run else { return Err(DiskFault) };
        if entered.is_ok() || is_kept {
            run.captures.answer(judged, now);
        }
        if entered.is_ok() {
            let at = self.now_ms + 1000 + self.chance.below(3000) as u64;
            run.work.insert(at, scan);
        }
        self.tell(|| {
            let of = content.whole.body;
            let how = if entered.is_ok() { "is taken" } else { "cannot be entered" };
            let Intake { patient, held, .. } = intake;
            format!(
                "body {of} ({} bytes) {how}: {patient:?} {held:?}; {judged:?}",
                content.length()
            )
        });
        entered
    }

    /// As `Custody::enter_kept`.
    fn enter_kept(&mut self) -> Result<(), DiskFault> {
        let now = self.clock();
        for (scan, intake) in self.disk.unentered() {
            self.disk.enter(scan, &intake)?;
            let Some(run) = &mut self.run else { return Err(DiskFault) };
            run.captures.answer(&intake.judged, now);
            run.work.insert(self.now_ms + 1500, scan);
            self.tell(|| format!("{scan:?} is entered after all"));
        }
        Ok(())
    }

    /// As `Custody::completed_by`.
    fn completes(&self, settled: &Settled, content: &Content) -> Option<Vec<Named>> {
        let part = self.disk.beginning(content, settled.writing.read(), COMPLETED_LEAST)?;
        let whose = self.disk.whose(part).into_iter();
        Some(whose.map(|id| Named::new(id, SourceKind::Record)).collect())
    }

    /// What the scanner's own measures beside a scan say, where they are of this scan.
    fn beside(&self, settled: &Settled) -> StatedPatient {
        let [only] = settled.group.companions.as_slice() else { return StatedPatient::Nothing };
        let used = self.disk.companions.get(&name_of(&settled.path));
        let is_fresh =
            self.setup.off == Off::FreshCompanions || companions::is_fresh(&only.stamp, used);
        if !self.setup.has_measures || !is_fresh {
            return StatedPatient::Nothing;
        }
        let name = name_of(&only.path);
        match self.folder.held(&name).filter(|_| self.folder.stamp(&name) == Some(only.stamp)) {
            Some(FileContent::Measures(text)) => self.setup.identity.of_sidecar(text),
            _ => StatedPatient::Nothing,
        }
    }

    /// A journal that was lost knew which companions had been used: none that lies there counts.
    pub fn pass_over_companions(&mut self) {
        for (name, stamp) in self.folder.list() {
            if let Some(stem) = name.strip_suffix(".ord") {
                self.disk.companions.insert(format!("{stem}.obj"), stamp);
            }
        }
    }

    fn note_companion(&mut self, scan: &str, settled: &Settled) -> Result<(), DiskFault> {
        if let [only] = settled.group.companions.as_slice() {
            self.disk.companions.insert(scan.to_owned(), only.stamp);
        }
        Ok(())
    }
}

fn dealt_with(disk: &super::disk::Disk, run: &mut Run, file: &Settled) -> bool {
    let is_dealt_with = disk.was_sighted(&name_of(&file.path), file.group.stamp);
    if is_dealt_with {
        run.settling.taken(file);
    }
    is_dealt_with
}

/// The state of a file as a look finds it, where a law may be switched off.
fn as_found(off: Off, name: &str, stamp: Stamp) -> Stamp {
    match off {
        // Each name stands for itself.
        Off::Inodes => {
            let ino = name.bytes().fold(7, |sum, byte| sum * 31 % 1_000_003 + u64::from(byte));
            Stamp { ino, ..stamp }
        }
        // A content is as young as its file.
        Off::BroughtInIsOlder => Stamp { mtime_ns: stamp.ctime_ns, ..stamp },
        _ => stamp,
    }
}
