//! What an intake reports: the current state to the board, changes to the log. The log never names
//! files or folders; a folder is identified by its place in the configuration.

use std::collections::BTreeMap;
use std::error::Error;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use gaiter_flow::export::mount::MountGuard;
use gaiter_flow::facts::{SourceFacts, SourceState, WaitingFile};
use gaiter_flow::settle::Waiting;
use gaiter_flow::{Look, Settling, Stamp};
use jiff::{SignedDuration, Timestamp};
use tracing::{info, warn};

use crate::station::booth::Booth;
use crate::station::intake::scan_dir::Found;
use crate::station::runtime::causes::chain;

/// What has been logged about one export folder, and where its facts are on the board.
pub(super) struct Notes {
    booth: Arc<Booth>,
    place: usize,
    /// A wall-clock time, and the station's monotonic clock at that time.
    started: (Timestamp, Duration),
    unwatched: bool,
    ignored: usize,
}

impl Notes {
    pub(super) fn new(booth: Arc<Booth>, place: usize, folder: &Path) -> Notes {
        let started = (Timestamp::now(), booth.core().now());
        let notes = Notes { booth, place, started, unwatched: false, ignored: 0 };
        notes.note(|source| source.folder = Some(folder.to_owned()));
        notes
    }

    fn note(&self, change: impl FnOnce(&mut SourceFacts)) {
        self.booth.core().board.note(|facts| {
            if let Some(source) = facts.sources.get_mut(self.place) {
                change(source);
            }
        });
    }

    /// Notes that the share does not answer; the caller keeps waiting.
    pub(super) fn stalled(&self) {
        self.state(SourceState::Stalled);
    }

    /// Logs what could not be done with a file.
    pub(super) fn failed(&self, fault: &(dyn Error + 'static)) {
        self.booth.core().check_corruption(fault);
        warn!(event = "intake-failed", export_dir = self.place, error = chain(fault));
    }

    /// Takes in what a look found, and judges whether to believe it; `None` if another station has the
    /// folder.
    pub(super) fn found(
        &mut self,
        found: io::Result<Option<Found>>,
        guard: &mut MountGuard,
    ) -> (Look, BTreeMap<PathBuf, Stamp>) {
        let found = match found {
            Ok(Some(found)) => found,
            Ok(None) => {
                self.state(SourceState::Taken);
                return (Look::OutOfReach, BTreeMap::new());
            }
            Err(error) => {
                self.state(SourceState::OutOfReach(error.to_string()));
                return (Look::OutOfReach, BTreeMap::new());
            }
        };
        self.note(|source| source.file_system = Some(found.mount.file_system.to_string()));
        if let Err(why) = guard.judge(found.mount) {
            self.state(SourceState::NotMounted(why.to_string()));
            return (Look::OutOfReach, BTreeMap::new());
        }
        self.state(SourceState::Watched);
        if found.ignored_count > self.ignored {
            info!(event = "files-ignored", export_dir = self.place, count = found.ignored_count);
        }
        self.ignored = found.ignored_count;
        self.note(|source| {
            source.last_look = Some(Timestamp::now());
            source.ignored = found.ignored;
        });
        (Look::Seen(found.scans), found.passers)
    }

    /// Notes the state of the folder, and logs it if it has changed.
    fn state(&self, state: SourceState) {
        let mut before = state.clone();
        self.note(|source| {
            before = std::mem::replace(&mut source.state, state.clone());
            if before != state {
                source.since = Timestamp::now();
            }
        });
        let export_dir = self.place;
        if std::mem::discriminant(&before) == std::mem::discriminant(&state) {
            return;
        }
        match &state {
            SourceState::OutOfReach(error) => {
                warn!(event = "export-dir-out-of-reach", export_dir, error);
            }
            SourceState::NotMounted(why) => {
                warn!(event = "export-dir-not-mounted", export_dir, why);
            }
            SourceState::Stalled => warn!(event = "export-dir-stalled", export_dir),
            SourceState::Taken => warn!(event = "export-dir-taken", export_dir),
            SourceState::Watched if before != SourceState::NotLooked => {
                info!(event = "export-dir-in-reach", export_dir);
            }
            SourceState::Watched | SourceState::NotLooked => {}
        }
    }

    /// Notes whether there is a watch.
    pub(super) fn watched(&mut self, armed: notify::Result<bool>) {
        self.note(|source| source.polled = !matches!(armed, Ok(true)));
        match armed {
            Ok(_) => self.unwatched = false,
            // The kind only: notify's errors name the path.
            Err(error) => {
                if !std::mem::replace(&mut self.unwatched, true) {
                    let (event, export_dir) = ("watch-unavailable", self.place);
                    info!(event, export_dir, error = ?error.kind);
                }
            }
        }
    }

    /// Notes the files that wait, and logs once for each that waits too long.
    pub(super) fn waiting(&self, settling: &mut Settling) {
        let now = self.booth.core().now();
        let overdue = settling.newly_overdue(now);
        if overdue > 0 {
            warn!(event = "file-overdue", export_dir = self.place, count = overdue);
        }
        let file = |waiting: Waiting| WaitingFile {
            why: waiting.wait.to_string(),
            since: self.wall(waiting.since),
            overdue: waiting.overdue,
        };
        let files = settling.waiting(now);
        let waiting = files.map(|(path, waiting)| (path.to_owned(), file(waiting))).collect();
        self.note(|source| source.waiting = waiting);
        self.booth.looked(self.place, settling.sights());
    }

    /// Converts a time of the station's monotonic clock to wall time, despite later clock changes.
    fn wall(&self, at: Duration) -> Timestamp {
        let (wall, clock) = self.started;
        let signed = |time| SignedDuration::try_from(time).unwrap_or(SignedDuration::MAX);
        wall.checked_add(signed(at) - signed(clock)).unwrap_or(wall)
    }
}
