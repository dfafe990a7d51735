//! The keys of `[scanner]` that say what is watched and when it is believed.

use std::path::PathBuf;
use std::time::Duration;

use super::fault::What;
use super::nearest::nearest;
use super::parse::{self, Bounds};
use super::reader::{Absent, Reader};
use crate::flow::file_system::KINDS;
use crate::flow::mount::Expected;
use crate::flow::{DoneFile, FileSystem};

/// How export folders are watched.
#[derive(Debug, Clone)]
pub struct WatchConfig {
    /// Sub-folders are looked through too.
    pub subfolders: bool,
    /// A scan is taken only while the file that this names is there.
    pub done_file: Option<DoneFile>,
    /// A file that is kept from being taken for this long is worth an alarm.
    pub overdue: Duration,
    /// What must hold of an export folder for its look to be believed.
    pub expected: Expected,
    /// A folder at which something must be mounted.
    pub mount_point: Option<PathBuf>,
}

/// Asks for the keys.
pub(super) fn config(reader: &mut Reader) -> Option<WatchConfig> {
    use Absent::Default;
    let subfolders = reader.flag("scanner.subfolders", "false");
    let done_file = reader.text("scanner.done_file", Default(""), or_none(done_file));
    let bounds = Bounds { least: "1s", most: "24h" };
    let overdue = reader.text("scanner.overdue", Default("10m"), parse::duration_in(bounds));
    let marker = reader.text("scanner.marker", Default(""), or_none(marker));
    let file_systems = reader.list("scanner.file_system", Default(""), file_system);
    let mount_point = reader.text("scanner.mount_point", Default(""), or_none(parse::full_path));
    let file_systems = file_systems.into_iter().map(|kind| kind.value).collect();
    Some(WatchConfig {
        subfolders: subfolders?.value,
        done_file: done_file?.value,
        overdue: overdue?.value,
        expected: Expected { marker: marker?.value, file_systems },
        mount_point: mount_point?.value,
    })
}

/// An empty text chooses nothing.
pub(super) fn or_none<T>(
    parse: impl Fn(&str) -> Result<T, What>,
) -> impl Fn(&str) -> Result<Option<T>, What> {
    move |text| if text.is_empty() { Ok(None) } else { parse(text).map(Some) }
}

fn done_file(text: &str) -> Result<DoneFile, What> {
    DoneFile::new(text).ok_or_else(|| What::NotADoneFile(text.into()))
}

fn marker(text: &str) -> Result<String, What> {
    let is_a_name = !text.contains('/') && !text.contains(char::is_control);
    if is_a_name && text != "." && text != ".." {
        Ok(text.into())
    } else {
        Err(What::NotAMarker(text.into()))
    }
}

fn file_system(text: &str) -> Result<FileSystem, What> {
    FileSystem::of_name(text).ok_or_else(|| {
        let words: Vec<&str> = KINDS.iter().map(|kind| kind.name).collect();
        let similar = nearest(text, words.iter().copied());
        What::NotAWord { text: text.into(), words, similar }
    })
}
