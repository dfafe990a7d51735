//! What the looks know about files that are not taken: marks of their contents, and what the journal
//! keeps of it for the next run.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use gaiter_flow::settle::Memory;
use gaiter_flow::{Fingerprint, Stamp};
use tokio::task::{JoinError, spawn_blocking};

use super::Intake;
use crate::station::core::Core;
use crate::station::intake::stable_read;
use crate::station::runtime::Stop;
use crate::station::share::stall::{DEADLINE, StepCounter, patiently};

/// What the last run knew about a folder; nothing if the journal cannot answer.
pub(super) async fn recall(core: &Arc<Core>, folder: &Path) -> Result<Memory, JoinError> {
    let (core, folder) = (Arc::clone(core), folder.to_owned());
    let recalled = spawn_blocking(move || {
        let boot = core.clock.boot();
        if boot.is_empty() {
            return Memory::default();
        }
        core.logged(core.custody.journal().look(&folder, boot)).unwrap_or_default()
    });
    recalled.await
}

impl Intake {
    /// Reads the ends of files whose content has changed since the last look.
    pub(super) async fn mark(&mut self, stop: &mut Stop) -> Result<(), JoinError> {
        let unmarked = self.settling.unmarked();
        if unmarked.is_empty() {
            return Ok(());
        }
        let core = Arc::clone(self.booth.core());
        let read = move |counter: &StepCounter| {
            let marked = unmarked.into_iter().map(|(path, stamp)| {
                counter.step();
                let mark = stable_read::mark(&path, stamp, || core.now());
                (path, stamp, mark)
            });
            marked.collect::<Vec<(PathBuf, Stamp, Option<Fingerprint>)>>()
        };
        let marked =
            patiently(DEADLINE, stop, read, || self.beat.beat(), || self.notes.stalled()).await?;
        for (path, stamp, mark) in marked.into_iter().flatten() {
            self.settling.marked(&path, stamp, mark);
        }
        Ok(())
    }

    /// Stores what is known about the folder if it has changed or if a capture has been opened since:
    /// the last look before a stop must not seem older than that capture.
    pub(super) async fn remember(&mut self) -> Result<(), JoinError> {
        let memory = self.settling.memory();
        let booth = Arc::clone(&self.booth);
        let opened = spawn_blocking(move || booth.last_opened()).await?;
        let is_kept = self.kept.as_ref().is_some_and(|kept| {
            let covers = opened.is_none_or(|at| kept.looked.is_some_and(|looked| looked > at));
            kept.files == memory.files && covers && kept.looked.is_some() == memory.looked.is_some()
        });
        if is_kept {
            return Ok(());
        }
        let (core, folder) = (Arc::clone(self.booth.core()), self.folder.clone());
        let written = spawn_blocking(move || {
            let written = core.custody.journal().looked(&folder, core.clock.boot(), &memory);
            core.logged(written).map(|()| memory)
        });
        self.kept = written.await?;
        Ok(())
    }
}
