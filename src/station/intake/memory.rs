//! What the looks know of files that are not taken: marks of their contents, and what the journal keeps
//! of it for the next run.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use tokio::task::{JoinError, spawn_blocking};
use tracing::warn;

use super::Intake;
use crate::flow::settle::Memory;
use crate::flow::{Mark, Stamp};
use crate::station::assembly::Station;
use crate::station::error::chain;
use crate::station::intake::stable_read;
use crate::station::stall::{DEADLINE, Pulse, patiently};
use crate::station::stop::Stop;

/// What the last run knew of a folder; nothing where the journal cannot say.
pub(super) async fn recall(station: &Arc<Station>, folder: &Path) -> Result<Memory, JoinError> {
    let (station, folder) = (Arc::clone(station), folder.to_owned());
    let recalled = spawn_blocking(move || {
        let boot = station.booth.boot();
        if boot.is_empty() {
            return Memory::default();
        }
        let memory = station.custody.journal().look(&folder, boot);
        memory.unwrap_or_else(|error| {
            station.check_corruption(&error);
            warn!(event = "journal-failed", error = chain(&error));
            Memory::default()
        })
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
        let station = Arc::clone(&self.station);
        let read = move |pulse: &Pulse| {
            let marked = unmarked.into_iter().map(|(path, stamp)| {
                pulse.beat();
                let mark = stable_read::mark(&path, stamp, || station.now());
                (path, stamp, mark)
            });
            marked.collect::<Vec<(PathBuf, Stamp, Option<Mark>)>>()
        };
        let marked =
            patiently(DEADLINE, stop, read, || self.beat(), || self.notes.stalled()).await?;
        for (path, stamp, mark) in marked.into_iter().flatten() {
            self.settling.marked(&path, stamp, mark);
        }
        Ok(())
    }

    /// Keeps what is known of the folder where it has changed, or where a capture has been opened
    /// since: the last look before a stop must not seem older than that.
    pub(super) async fn remember(&mut self) -> Result<(), JoinError> {
        let memory = self.settling.memory();
        let opened = self.station.booth.last_opened();
        let is_kept = self.kept.as_ref().is_some_and(|kept| {
            let covers = opened.is_none_or(|at| kept.looked.is_some_and(|looked| looked > at));
            kept.files == memory.files && covers && kept.looked.is_some() == memory.looked.is_some()
        });
        if is_kept {
            return Ok(());
        }
        let (station, folder) = (Arc::clone(&self.station), self.folder.clone());
        let written = spawn_blocking(move || {
            let written = station.custody.journal().looked(&folder, station.booth.boot(), &memory);
            written.map(|()| memory).map_err(|error| {
                station.check_corruption(&error);
                warn!(event = "journal-failed", error = chain(&error));
            })
        });
        self.kept = written.await?.ok();
        Ok(())
    }
}
