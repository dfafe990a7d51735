//! What the looks at each export folder know about files that are not taken in yet.
//!
//! This matters only as long as captures do, and captures end with the machine. So it is written without
//! a sync: a killed process leaves it to the next one, and a power cut that loses it ends the captures
//! too.

use std::os::unix::ffi::OsStrExt;
use std::path::Path;
use std::time::Duration;

use gaiter_flow::settle::Memory;
use rusqlite::{OptionalExtension, params};

use super::{Journal, JournalError, json_cell};

impl Journal {
    /// What the last run since this machine start knew about a folder; empty if there was none.
    pub fn look(&self, folder: &Path, boot: &str) -> Result<Memory, JournalError> {
        let connection = self.connection();
        let found: Option<(Option<i64>, String)> = connection
            .query_row(
                "SELECT looked_ms, files FROM looks WHERE folder = ?1 AND boot = ?2",
                params![folder.as_os_str().as_bytes(), boot],
                |row| Ok((row.get(0)?, row.get(1)?)),
            )
            .optional()?;
        let Some((looked_ms, files)) = found else { return Ok(Memory::default()) };
        let looked = looked_ms.map(|looked_ms| Duration::from_millis(looked_ms.unsigned_abs()));
        let files = json_cell("files", files)?;
        Ok(Memory { looked, files })
    }

    /// Saves what is known about a folder.
    pub fn looked(&self, folder: &Path, boot: &str, memory: &Memory) -> Result<(), JournalError> {
        let files = serde_json::to_string(&memory.files)
            .map_err(|error| rusqlite::Error::ToSqlConversionFailure(error.into()))?;
        // Rounded down, so that the stored time is never later than the look.
        let looked_ms = memory.looked.map(|at| i64::try_from(at.as_millis()).unwrap_or(i64::MAX));
        let connection = self.connection();
        connection.pragma_update(None, "synchronous", "NORMAL")?;
        let written = connection.execute(
            "INSERT INTO looks (folder, boot, looked_ms, files) VALUES (?1, ?2, ?3, ?4)
             ON CONFLICT (folder) DO UPDATE SET boot = ?2, looked_ms = ?3, files = ?4",
            params![folder.as_os_str().as_bytes(), boot, looked_ms, files],
        );
        connection.pragma_update(None, "synchronous", "FULL")?;
        written?;
        Ok(())
    }
}
