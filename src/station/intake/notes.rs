//! What an intake reports: the current state to the board, changes to the log. The log never names
//! files or folders; a folder is identified by its place in the configuration.

use std::collections::BTreeMap;
use std::error::Error;
use std::io;
use std::mem;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use gaiter_flow::Settling;
use gaiter_flow::cause::Cause;
use gaiter_flow::export::mount::MountGuard;
use gaiter_flow::export::passed_over::{Ignored, PassedOver};
use gaiter_flow::facts::{SourceFacts, SourceState, WaitingFile};
use gaiter_flow::settle::{Gone, Waiting};
use jiff::{SignedDuration, Timestamp};
use tracing::{info, warn};

use crate::station::booth::Booth;
use crate::station::intake::scan_dir::{Found, Passed};
use crate::station::runtime::chain;

/// How many files that are gone are known by name.
const GONE_MOST: usize = 1000;

/// What has been logged about one export folder, and where its facts are on the board.
pub(super) struct Notes {
    booth: Arc<Booth>,
    place: usize,
    /// A wall-clock time, and the station's monotonic clock at that time.
    started: (Timestamp, Duration),
    unwatched: bool,
    /// How much was ignored at the last look, and how much of it may be exports; none before the first.
    ignored: Option<(usize, usize)>,
}

impl Notes {
    pub(super) fn new(booth: Arc<Booth>, place: usize, folder: &Path) -> Notes {
        let started = (Timestamp::now(), booth.core().now());
        let notes = Notes { booth, place, started, unwatched: false, ignored: None };
        notes.note(|source| source.folder = Some(folder.to_owned()));
        notes
    }

    fn note<T>(&self, change: impl FnOnce(&mut SourceFacts) -> T) -> Option<T> {
        self.booth.core().board.note(|facts| facts.sources.get_mut(self.place).map(change))
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

    /// Notes what a look found, `None` if another station has the folder. Returns it if it is believed; otherwise the
    /// folder is out of reach.
    pub(super) fn found(
        &mut self,
        found: io::Result<Option<Found>>,
        guard: &mut MountGuard,
    ) -> Option<Found> {
        let mut found = match found {
            Ok(Some(found)) => found,
            Ok(None) => {
                self.state(SourceState::Taken);
                return None;
            }
            Err(error) => {
                self.state(SourceState::OutOfReach(Cause::of_system(&error)));
                return None;
            }
        };
        self.note(|source| source.file_system = Some(found.mount.file_system.to_string()));
        if let Err(why) = guard.check(found.mount) {
            self.state(SourceState::NotMounted(why));
            return None;
        }
        self.state(SourceState::Watched);
        self.ignored(mem::take(&mut found.ignored), mem::take(&mut found.passed_over));
        Some(found)
    }

    /// Notes what a look passed over, and logs it if there is more of it.
    fn ignored(
        &mut self,
        found: BTreeMap<PathBuf, Passed>,
        passed_over: BTreeMap<PassedOver, usize>,
    ) {
        let count: usize = passed_over.values().sum();
        let unread = passed_over.iter().filter(|(why, _)| why.is_unread());
        let unread: usize = unread.map(|(_, count)| count).sum();
        let before = self.ignored.replace((count, unread));
        if count > before.map_or(0, |(count, _)| count)
            || unread > before.map_or(0, |(_, unread)| unread)
        {
            info!(event = "files-ignored", export_dir = self.place, count, unread);
        }
        // What the first look finds was there before.
        let came = before.map_or(Duration::ZERO, |_| self.booth.core().now());
        self.note(|source| {
            source.last_look = Some(Timestamp::now());
            let known = mem::take(&mut source.ignored);
            let ignored = |(path, Passed { why, changed_ns }): (PathBuf, Passed)| {
                let is_same = |known: &&Ignored| (known.why, known.changed_ns) == (why, changed_ns);
                let since = known.get(&path).filter(is_same).map_or(came, |known| known.since);
                (path, Ignored { why, changed_ns, since })
            };
            source.ignored = found.into_iter().map(ignored).collect();
            source.passed_over = passed_over;
        });
    }

    /// Notes contents that are gone before they were taken, and logs them.
    pub(super) fn gone(&self, gone: Vec<Gone>) {
        let Some(last) = gone.iter().map(|content| content.stamp.mtime_ns).max() else { return };
        let written = Timestamp::from_nanosecond(last).map(|at| at.to_string()).unwrap_or_default();
        warn!(event = "export-gone", export_dir = self.place, count = gone.len(), written);
        self.note(|source| {
            source.gone_count += gone.len();
            let now = Timestamp::now();
            source.gone.extend(gone.into_iter().map(|content| (content.path, now)));
            while source.gone.len() > GONE_MOST {
                source.gone.pop_first();
            }
        });
    }

    /// Notes the state of the folder, and logs it if it has changed.
    fn state(&self, state: SourceState) {
        let before = self.note(|source| {
            if source.state != state {
                source.since = Timestamp::now();
            }
            mem::replace(&mut source.state, state.clone())
        });
        let Some(before) = before else { return };
        let export_dir = self.place;
        if mem::discriminant(&before) == mem::discriminant(&state) {
            return;
        }
        match &state {
            SourceState::OutOfReach(error) => {
                warn!(event = "export-dir-out-of-reach", export_dir, error = error.to_string());
            }
            SourceState::NotMounted(why) => {
                warn!(event = "export-dir-not-mounted", export_dir, why = why.to_string());
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
                if !mem::replace(&mut self.unwatched, true) {
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
            wait: waiting.wait,
            since: self.wall(waiting.since),
            overdue: waiting.overdue,
        };
        let files = settling.waiting(now);
        let waiting = files.map(|(path, waiting)| (path.to_owned(), file(waiting))).collect();
        let left = settling.left(now).filter_map(|(path, since)| {
            let why = PassedOver::of_scan_to_come(&path.file_name()?.to_string_lossy())?;
            Some((path.to_owned(), Ignored { why, changed_ns: 0, since }))
        });
        let left: Vec<(PathBuf, Ignored)> = left.collect();
        self.note(|source| {
            source.waiting = waiting;
            source.ignored.retain(|_, ignored| !ignored.why.is_of_name());
            source.passed_over.retain(|why, _| !why.is_of_name());
            for (path, ignored) in left {
                *source.passed_over.entry(ignored.why).or_default() += 1;
                source.ignored.insert(path, ignored);
            }
        });
        self.booth.looked(self.place, settling.sights());
    }

    /// Converts a time of the station's monotonic clock to wall time, despite later clock changes.
    fn wall(&self, at: Duration) -> Timestamp {
        let (wall, clock) = self.started;
        let signed = |time| SignedDuration::try_from(time).unwrap_or(SignedDuration::MAX);
        wall.checked_add(signed(at) - signed(clock)).unwrap_or(wall)
    }
}
