//! The keys of `[scanner]` that control what is watched and when it is trusted.

use gaiter_flow::DoneFile;

use super::parse::{self, Reader, What};

/// How export folders are watched.
#[derive(Debug, Clone)]
pub struct WatchConfig {
    /// Subfolders are searched too.
    pub subfolders: bool,
    /// A scan is taken in only while the file that this names exists.
    pub done_file: Option<DoneFile>,
    /// The file that an export folder must contain for a look at it to be trusted.
    pub marker: Option<String>,
}

/// Reads the keys.
pub(super) fn config(reader: &mut Reader) -> Option<WatchConfig> {
    let subfolders = reader.flag("scanner.subfolders", "false");
    let done_file = reader.value("scanner.done_file", "", parse::or_none(done_file))?;
    let marker = reader.value("scanner.marker", "", parse::or_none(marker))?;
    Some(WatchConfig { subfolders, done_file, marker })
}

fn done_file(text: &str) -> Result<DoneFile, What> {
    let hint = "use {name} or {stem}, no folder, and no ending of a scan: \"{name}.done\"";
    DoneFile::new(text).ok_or_else(|| What::not_a(text, "a valid name for done files", hint))
}

fn marker(text: &str) -> Result<String, What> {
    let is_a_name = !text.contains('/') && !text.contains(char::is_control);
    if is_a_name && text != "." && text != ".." {
        Ok(text.into())
    } else {
        Err(What::not_a(text, "the name of a file", "a bare name, without a folder: \".mounted\""))
    }
}
