//! What disturbs the station: other programs at its files, faults, and people who stop it.

use super::booth::Booth;
use super::folder::FileContent;
use super::intake::TakeFault;
use super::kinds::Kind;
use super::oracle::Seen;
use super::people::{People, Said};
use super::truth::Plan;

impl People {
    /// A disturbance, if there is occasion for it.
    pub fn disturb(&mut self, kind: Kind) -> bool {
        let is_tampered = matches!(kind, Kind::Chmod | Kind::Link | Kind::Rename | Kind::Touch);
        if self.booth.is_suspended && kind != Kind::Sleep && !is_tampered {
            return false;
        }
        match kind {
            Kind::Sleep if self.booth.is_suspended => {
                self.booth.resumes();
                true
            }
            Kind::Sleep => {
                let runs = self.runs();
                if runs {
                    self.booth.suspends();
                }
                runs
            }
            Kind::Chmod | Kind::Link | Kind::Rename | Kind::Touch => self.tamper(kind),
            Kind::Pause => {
                self.booth.is_paused = !self.booth.is_paused;
                let is_paused = self.booth.is_paused;
                self.booth.tell(|| format!("paused: {is_paused}"));
                true
            }
            Kind::FolderAway => {
                self.booth.is_away = !self.booth.is_away;
                let is_away = self.booth.is_away;
                self.booth.tell(|| format!("the folder is away: {is_away}"));
                true
            }
            Kind::Unplug => {
                let is_open = self.booth.is_unplugged;
                if self.has_button() {
                    self.booth.tell(|| format!("the button's port is open: {is_open}"));
                    self.booth.port(is_open);
                }
                self.has_button()
            }
            Kind::Crash => {
                match self.runs() {
                    true => self.crash(),
                    false => self.booth.start(),
                }
                true
            }
            Kind::Reboot => {
                self.booth.reboot();
                self.all_is_over();
                true
            }
            Kind::Rebuild => {
                self.booth.tell(|| "the journal is lost".to_owned());
                self.booth.run = None;
                self.booth.disk.is_locked = false;
                self.booth.observe(Seen::JournalLost);
                self.booth.disk.rebuild(self.booth.setup.off);
                self.booth.pass_over_companions();
                self.pass_over_orders();
                self.booth.start();
                self.all_is_over();
                self.geometries_are_lost();
                self.booth.check_records();
                true
            }
            Kind::JournalLocked => {
                let until = self.booth.now_ms + 500 + self.booth.chance.below(20_000) as u64;
                if self.runs() {
                    (self.booth.disk.is_locked, self.booth.unlock_ms) = (true, Some(until));
                    self.booth.tell(|| "the journal cannot be written".to_owned());
                }
                self.runs()
            }
            Kind::ClockSet => {
                let steps_ms = [500, 10_000, 600_000, 7_200_000];
                let by_ms = steps_ms[self.booth.chance.below(steps_ms.len())];
                let by_ms = if self.booth.chance.below(2) == 0 { by_ms } else { -by_ms };
                self.booth.folder.set_clock(by_ms);
                self.booth.tell(|| format!("the clock is set by {by_ms} ms"));
                true
            }
            Kind::TakeFails => {
                let fault = some_fault(&mut self.booth);
                self.booth.tell(|| format!("with the next scan goes wrong: {fault:?}"));
                self.booth.fault.replace(fault) != Some(fault)
            }
            Kind::StoreAway => {
                self.booth.disk.is_store_away = !self.booth.disk.is_store_away;
                let is_away = self.booth.disk.is_store_away;
                self.booth.tell(|| format!("the store is away: {is_away}"));
                self.booth.disk.withdraw();
                self.booth.check_records();
                true
            }
            _ => false,
        }
    }

    /// An operator who saw that the station could not keep a name says it again after the restart.
    fn crash(&mut self) {
        self.booth.crash();
        self.said = self.said.filter(|(said, _)| *said != Said::Unheard);
    }

    /// What was said before is over, and everybody sees that the station began anew.
    fn all_is_over(&mut self) {
        self.said = None;
        self.nothing_waits();
        self.booth.truth.bodies.iter_mut().for_each(|body| body.is_covered = false);
    }

    /// A journal that was built anew knows bytes, and not the geometries of what was delivered.
    fn geometries_are_lost(&mut self) {
        for body in 0..self.booth.truth.bodies.len() {
            if self.booth.is_settled(body) {
                self.booth.truth.bodies[body].plan = Plan::Over;
            }
        }
    }

    /// A virus scanner, a backup or somebody by hand at a file.
    fn tamper(&mut self, kind: Kind) -> bool {
        let names: Vec<String> = self
            .booth
            .folder
            .list()
            .into_iter()
            .map(|(name, _)| name)
            .filter(|name| matches!(self.booth.folder.held(name), Some(FileContent::Export(_))))
            .collect();
        let Some(name) = self.booth.chance.pick(&names).cloned() else { return false };
        let Some(ino) = self.booth.folder.inode(&name) else { return false };
        if kind == Kind::Touch && self.is_older(&name) {
            return false;
        }
        if kind == Kind::Link && self.booth.setup.has_measures {
            // Rewriting one of two names leaves the measures of the other.
            return false;
        }
        let now = self.booth.now_ms;
        let fresh = self.booth.fresh_name();
        let to = match self.booth.chance.below(3) {
            0 => format!(".{fresh}"),
            1 => format!("{fresh}.bak"),
            _ => fresh,
        };
        match kind {
            Kind::Chmod => self.booth.folder.change_status(ino, now),
            Kind::Link => self.booth.folder.link(&name, &to, now),
            Kind::Rename if self.booth.chance.below(4) == 0 => {
                self.booth.overwritten(&name);
                self.booth.folder.unlink(&name);
                self.booth.tell(|| format!("{name} is deleted"));
                self.booth.hint();
                return true;
            }
            Kind::Rename => {
                self.booth.folder.rename(&name, &to, now);
                for export in &mut self.booth.truth.exports {
                    if export.name == name {
                        export.name = to.clone();
                    }
                }
                for body in &mut self.booth.truth.bodies {
                    if body.file.as_deref() == Some(&name) {
                        body.file = Some(to.clone());
                    }
                }
            }
            _ => self.booth.folder.touch(ino, now),
        }
        self.booth.tell(|| format!("{kind:?} of {name} (to {to})"));
        self.booth.hint();
        true
    }
}

/// What goes wrong with the next scan.
fn some_fault(booth: &mut Booth) -> TakeFault {
    let faults = [
        TakeFault::Spool,
        TakeFault::Sync,
        TakeFault::Journal,
        TakeFault::Crash,
        TakeFault::CrashEntered,
    ];
    faults[booth.chance.below(faults.len())]
}
