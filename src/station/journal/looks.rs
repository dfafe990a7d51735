//! What the looks at each export folder know about files that are not taken in yet.
//!
//! This matters only as long as captures do, and captures end with the machine. So it is written without
//! a sync: a killed process leaves it to the next one, and a power cut that loses it ends the captures
//! too.

use std::os::unix::ffi::OsStrExt;
use std::path::Path;

use gaiter_flow::settle::Memory;
use rusqlite::params;

use super::row::{first, json_cell, json_text};
use super::{Journal, JournalError};

impl Journal {
    /// What the last run since this machine start knew about a folder; empty if there was none.
    pub fn look(&self, folder: &Path, boot: &str) -> Result<Memory, JournalError> {
        let found = "SELECT memory FROM looks WHERE folder = ?1 AND boot = ?2";
        let cells = params![folder.as_os_str().as_bytes(), boot];
        let found = first(&self.connection(), found, cells, |row| json_cell(row, 0))?;
        Ok(found.unwrap_or_default())
    }

    /// Saves what is known about a folder.
    pub fn looked(&self, folder: &Path, boot: &str, memory: &Memory) -> Result<(), JournalError> {
        let memory = json_text(memory)?;
        let connection = self.connection();
        connection.pragma_update(None, "synchronous", "NORMAL")?;
        let written = connection.execute(
            "INSERT INTO looks (folder, boot, memory) VALUES (?1, ?2, ?3)
             ON CONFLICT (folder) DO UPDATE SET boot = ?2, memory = ?3",
            params![folder.as_os_str().as_bytes(), boot, memory],
        );
        connection.pragma_update(None, "synchronous", "FULL")?;
        written?;
        Ok(())
    }
}
