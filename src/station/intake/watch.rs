//! The watch on an export folder: a hint to look sooner, never the truth.
//!
//! A watch may stay silent forever: after the folder was replaced, or when the kernel's limits are
//! reached. So nothing depends on it, and before every look it is armed again if it is not on the
//! folder that now has the path. Network shares have none, because it is mostly silent there.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use notify::event::{AccessKind, AccessMode};
use notify::{Config, Event, EventKind, RecommendedWatcher, RecursiveMode, Watcher};
use tokio::sync::Notify;

use crate::station::share::file_system;

/// A best-effort watch on one folder.
#[derive(Debug)]
pub struct Watch {
    folder: PathBuf,
    depth: RecursiveMode,
    hint: Arc<Notify>,
    /// The watcher has reported an error; its next events are not reliable.
    broken: Arc<AtomicBool>,
    armed: Option<Armed>,
}

#[derive(Debug)]
struct Armed {
    _watcher: RecommendedWatcher,
    /// Device and inode of the folder.
    on: (u64, u64),
}

impl Watch {
    /// Creates a watch that is not armed yet and will notify `hint`; it covers sub-folders if asked.
    pub fn new(folder: PathBuf, subfolders: bool, hint: Arc<Notify>) -> Watch {
        let depth = if subfolders { RecursiveMode::Recursive } else { RecursiveMode::NonRecursive };
        Watch { folder, depth, hint, broken: Arc::new(AtomicBool::new(false)), armed: None }
    }

    /// Arms the watch unless it is on the current folder. Must be called before each look, so that
    /// changes after the look are not missed. Returns whether there is a watch: a share has none.
    ///
    /// # Errors
    /// If it cannot be armed. Looks then only happen at their normal interval.
    pub fn keep_armed(&mut self) -> notify::Result<bool> {
        let now = file_system::folder_id(&self.folder).ok();
        let broken = self.broken.swap(false, Ordering::Relaxed);
        let on = self.armed.as_ref().map(|armed| armed.on);
        if on.is_some() && on == now && !broken {
            return Ok(true);
        }
        self.armed = None;
        let Some(on) = now else { return Err(notify::Error::path_not_found()) };
        if file_system::detect(&self.folder)?.is_network() {
            return Ok(false);
        }
        let (hint, broken) = (Arc::clone(&self.hint), Arc::clone(&self.broken));
        let on_event = move |event: notify::Result<Event>| {
            match event {
                Ok(event) if !tells(&event) => return,
                Ok(_) => {}
                Err(_) => broken.store(true, Ordering::Relaxed),
            }
            hint.notify_one();
        };
        let config = Config::default().with_follow_symlinks(false);
        let mut watcher = RecommendedWatcher::new(on_event, config)?;
        watcher.watch(&self.folder, self.depth)?;
        self.armed = Some(Armed { _watcher: watcher, on });
        Ok(true)
    }
}

/// Whether an event reports a change or lost events. Our own looks and copies open and close files;
/// hints from those would make the station look forever.
fn tells(event: &Event) -> bool {
    match event.kind {
        EventKind::Access(AccessKind::Close(AccessMode::Write)) => true,
        EventKind::Access(_) => event.need_rescan(),
        _ => true,
    }
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::time::Duration;

    use notify::event::Flag;

    use super::*;

    async fn hinted(hint: &Notify) -> bool {
        tokio::time::timeout(Duration::from_secs(10), hint.notified()).await.is_ok()
    }

    #[tokio::test]
    async fn a_change_gives_a_hint_even_in_a_folder_that_was_replaced() {
        let dir = tempfile::tempdir().unwrap();
        let folder = dir.path().join("export");
        let hint = Arc::new(Notify::new());
        let mut watch = Watch::new(folder.clone(), false, Arc::clone(&hint));
        assert!(watch.keep_armed().is_err());

        fs::create_dir(&folder).unwrap();
        watch.keep_armed().unwrap();
        fs::write(folder.join("a"), "a").unwrap();
        assert!(hinted(&hint).await);

        fs::rename(&folder, dir.path().join("old")).unwrap();
        fs::create_dir(&folder).unwrap();
        watch.keep_armed().unwrap();
        let hint = Arc::clone(&watch.hint);
        // Late events of the old folder are not tested here.
        while tokio::time::timeout(Duration::from_millis(50), hint.notified()).await.is_ok() {}
        fs::write(folder.join("b"), "b").unwrap();
        assert!(hinted(&hint).await);
    }

    #[tokio::test]
    async fn reading_gives_no_hint() {
        let dir = tempfile::tempdir().unwrap();
        fs::write(dir.path().join("a"), "a").unwrap();
        let hint = Arc::new(Notify::new());
        let mut watch = Watch::new(dir.path().to_owned(), false, Arc::clone(&hint));
        watch.keep_armed().unwrap();
        fs::read(dir.path().join("a")).unwrap();
        fs::read_dir(dir.path()).unwrap().count();
        // Events keep their order: the first hint must be the one of this write.
        let quiet = tokio::time::timeout(Duration::from_millis(200), hint.notified()).await;
        assert!(quiet.is_err());
        fs::write(dir.path().join("a"), "b").unwrap();
        assert!(hinted(&hint).await);
    }

    #[tokio::test]
    async fn a_change_in_a_folder_within_gives_a_hint_by_choice() {
        let dir = tempfile::tempdir().unwrap();
        fs::create_dir(dir.path().join("within")).unwrap();
        let hint = Arc::new(Notify::new());
        let mut watch = Watch::new(dir.path().to_owned(), true, Arc::clone(&hint));
        assert!(watch.keep_armed().unwrap());
        fs::write(dir.path().join("within/a"), "a").unwrap();
        assert!(hinted(&hint).await);
    }

    #[test]
    fn lost_events_tell_that_something_may_have_changed() {
        // What the kernel's queue reports when it overflows: no kind, no path, only the flag.
        let overflow = Event::new(EventKind::Other).set_flag(Flag::Rescan);
        assert!(overflow.paths.is_empty() && tells(&overflow));
        let read = EventKind::Access(AccessKind::Close(AccessMode::Read));
        assert!(!tells(&Event::new(read)));
        assert!(tells(&Event::new(read).set_flag(Flag::Rescan)));
    }
}
