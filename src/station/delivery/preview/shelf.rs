//! The folder of the previews, and what is known about each.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use gaiter_flow::ScanId;
use gaiter_flow::page::files::PREVIEW;
use gaiter_record::RecordFile;
use tokio::sync::Notify;

use crate::station::runtime::{locked, random_bits};
use crate::store::sums::{self, SUMS};
use crate::store::{Access, durable};

/// The folder's name in the state folder.
const NAME: &str = "previews";

/// The previews of held scans.
#[derive(Debug)]
pub struct Previews {
    folder: PathBuf,
    known: Mutex<BTreeMap<ScanId, Preview>>,
    news: Notify,
}

/// What is known about a held scan's legs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Preview {
    /// Their preview is in this folder.
    Made(PathBuf),
    /// They cannot be measured; the code gives the reason.
    Impossible(String),
}

impl Previews {
    /// The previews of a state folder. None is known yet, whatever the folder contains.
    pub fn new(state_dir: &Path) -> Previews {
        Previews { folder: state_dir.join(NAME), known: Mutex::default(), news: Notify::new() }
    }

    /// What is known about a scan.
    pub fn get(&self, scan: &ScanId) -> Option<Preview> {
        locked(&self.known).get(scan).cloned()
    }

    /// Whether there is nothing to make: the preview exists, or it never will.
    pub fn has(&self, scan: &ScanId) -> bool {
        match self.get(scan) {
            Some(Preview::Made(folder)) => folder.is_dir(),
            Some(Preview::Impossible(_)) => true,
            None => false,
        }
    }

    /// Forgets all previews except those of these scans, and removes their folders. The first call
    /// removes everything that an earlier run left.
    ///
    /// # Errors
    /// Any I/O error; the next call tries again to remove what is left.
    pub fn keep_only(&self, scans: &[ScanId]) -> io::Result<()> {
        let mut known = locked(&self.known);
        known.retain(|scan, _| scans.contains(scan));
        for entry in durable::if_there(fs::read_dir(&self.folder))?.into_iter().flatten() {
            let entry = entry?;
            let name = entry.file_name();
            let is_kept = known.keys().any(|scan| name.to_str() == Some(scan.as_str()));
            if !is_kept {
                remove(&entry.path())?;
            }
        }
        Ok(())
    }

    /// Keeps what the page shows of a scan. It is written elsewhere and renamed, so a folder under its
    /// final name is complete. It is not synced: the next start makes it again.
    ///
    /// # Errors
    /// Any I/O error; nothing is kept then.
    pub fn keep(&self, scan: &ScanId, files: &[RecordFile]) -> io::Result<()> {
        durable::make_folder_once(&self.folder)?;
        let staged = self.folder.join(format!(".tmp-{:016x}", random_bits()));
        let folder = self.folder.join(scan.as_str());
        let written = write(&staged, files).and_then(|()| fs::rename(&staged, &folder));
        if let Err(error) = written {
            // The next look removes what is left of it.
            let _ = remove(&staged);
            return Err(error);
        }
        self.note(scan, Preview::Made(folder));
        Ok(())
    }

    /// Returns when a preview has been made or cannot be made.
    pub async fn changed(&self) {
        self.news.notified().await;
    }

    /// Notes what is known about a scan's legs.
    pub(super) fn note(&self, scan: &ScanId, preview: Preview) {
        locked(&self.known).insert(scan.clone(), preview);
        self.news.notify_one();
    }
}

/// Writes the files that the page shows into a new folder, and their sums.
fn write(folder: &Path, files: &[RecordFile]) -> io::Result<()> {
    durable::make_folder(folder)?;
    // For the owner only: the files show patients' bodies.
    let write =
        |name: &str, bytes: &[u8]| Access::Private.write_unsynced(&folder.join(name), bytes);
    let mut listed = String::new();
    for RecordFile { name, bytes } in files.iter().filter(|file| PREVIEW.contains(&&*file.name)) {
        write(name, bytes)?;
        listed += &sums::line(&sums::scan_id(bytes), name);
    }
    write(SUMS, listed.as_bytes()).map(drop)
}

/// Removes whatever is at this path, if anything.
fn remove(path: &Path) -> io::Result<()> {
    match durable::if_there(fs::symlink_metadata(path))? {
        Some(metadata) if metadata.is_dir() => durable::remove_folder(path),
        Some(_) => durable::remove_file(path),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scan(n: u8) -> ScanId {
        ScanId::of_digest([n; 32])
    }

    fn files() -> Vec<RecordFile> {
        let file = |name: &str| RecordFile { name: name.to_owned(), bytes: name.into() };
        ["legs.svg", "record.json", "order-spreadsheet.csv", "left.step"].map(file).into()
    }

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn a_preview_holds_what_the_page_shows_for_its_owner_only() {
        use std::os::unix::fs::PermissionsExt;
        let dir = tempfile::tempdir().unwrap();
        let previews = Previews::new(dir.path());
        previews.keep(&scan(1), &files()).unwrap();
        let Some(Preview::Made(folder)) = previews.get(&scan(1)) else { panic!("not made") };
        assert_eq!(names(&folder), [SUMS, "legs.svg", "record.json"]);
        assert_eq!(sums::listed(&folder).unwrap(), ["legs.svg", "record.json"]);
        let drawing = fs::read(folder.join("legs.svg")).unwrap();
        assert_eq!(sums::check_file(&folder, "legs.svg", &drawing).unwrap(), Ok(true));
        for (path, mode) in [(folder.join("record.json"), 0o600), (folder, 0o700)] {
            assert_eq!(fs::metadata(path).unwrap().permissions().mode() & 0o777, mode);
        }
        assert_eq!(names(&dir.path().join(NAME)), [scan(1).as_str()], "nothing half made is left");
    }

    #[test]
    fn what_an_earlier_run_left_and_what_is_held_no_more_goes() {
        let dir = tempfile::tempdir().unwrap();
        Previews::new(dir.path()).keep(&scan(1), &files()).unwrap();
        fs::write(dir.path().join(NAME).join(".tmp-1"), "").unwrap();
        let previews = Previews::new(dir.path());
        assert_eq!(previews.get(&scan(1)), None, "it is not this run's");
        previews.keep_only(&[scan(1)]).unwrap();
        assert_eq!(names(&dir.path().join(NAME)), [""; 0]);
        previews.keep(&scan(1), &files()).unwrap();
        previews.keep(&scan(2), &files()).unwrap();
        previews.keep_only(&[scan(2)]).unwrap();
        assert_eq!(names(&dir.path().join(NAME)), [scan(2).as_str()]);
        assert_eq!(previews.get(&scan(1)), None);
    }

    #[test]
    fn a_preview_whose_folder_is_gone_is_to_be_made_again_and_an_impossible_one_is_not() {
        let dir = tempfile::tempdir().unwrap();
        let previews = Previews::new(dir.path());
        previews.keep(&scan(1), &files()).unwrap();
        previews.note(&scan(2), Preview::Impossible("no-leg".to_owned()));
        assert!(previews.has(&scan(1)) && previews.has(&scan(2)) && !previews.has(&scan(3)));
        fs::remove_dir_all(dir.path().join(NAME)).unwrap();
        assert!(!previews.has(&scan(1)) && previews.has(&scan(2)));
        previews.keep(&scan(1), &files()).unwrap();
        assert!(previews.has(&scan(1)));
    }
}
