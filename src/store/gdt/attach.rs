//! Files of a record that go to the practice with its result.

use std::path::{Path, PathBuf};

use gaiter_record::RecordFile;
use gaiter_record::gdt::{Attachment, Reference};

use super::super::StoreFault;
use super::place::Place;

/// The description of an attachment, as the practice software shows it.
const DESCRIPTION: &str = "Beinvermessung";

/// Which files go with a result, where they are put, and how the result refers to them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Attach {
    /// Names of a record's files; a file that the record lacks is left out.
    pub files: Vec<String>,
    /// A folder for them in the exchange folder; empty for the exchange folder itself.
    pub folder: String,
    /// How the result refers to their place.
    pub reference: Reference,
    /// The exchange folder as the practice software sees it; empty if it sees it as the station does.
    pub root: String,
}

impl Attach {
    /// The attachments as the result lists them.
    pub(super) fn attachments(
        &self,
        key: &str,
        files: &[RecordFile],
        folder: &Path,
    ) -> Vec<Attachment> {
        let attachment = |file: &RecordFile| Attachment {
            name: key.to_owned(),
            format: file.name.rsplit('.').next().unwrap_or_default().to_ascii_uppercase(),
            description: DESCRIPTION.to_owned(),
            path: self.reference(&file_name(key, file), folder),
        };
        self.of(files).map(attachment).collect()
    }

    /// Writes the attachments, durable.
    pub(super) fn write(
        &self,
        key: &str,
        files: &[RecordFile],
        place: &Place,
    ) -> Result<(), StoreFault> {
        for file in self.of(files) {
            let path: PathBuf = place.folder().join(&self.folder).join(file_name(key, file));
            place.write_attachment(&path, &file.bytes)?;
        }
        Ok(())
    }

    /// The attachments of a result that are in the exchange folder.
    pub(super) fn there(&self, key: &str, folder: &Path) -> Vec<PathBuf> {
        let place = |name: &String| folder.join(&self.folder).join(format!("{key}_{name}"));
        self.files.iter().map(place).filter(|path| path.exists()).collect()
    }

    fn of<'a>(&'a self, files: &'a [RecordFile]) -> impl Iterator<Item = &'a RecordFile> {
        let named = |name: &String| files.iter().find(|file| file.name == *name);
        self.files.iter().filter_map(named)
    }

    fn reference(&self, name: &str, folder: &Path) -> String {
        let root = match self.root.as_str() {
            "" => folder.to_string_lossy().into_owned(),
            root => root.trim_end_matches(['\\', '/']).to_owned(),
        };
        // The program that reads the paths mostly runs on Windows; the root shows whether it does.
        let bar = if root.contains('\\') { '\\' } else { '/' };
        let parts = match self.reference {
            Reference::Full => vec![root.as_str(), &self.folder, name],
            Reference::Relative => vec![self.folder.as_str(), name],
            Reference::Name => vec![name],
        };
        let parts: Vec<&str> = parts.into_iter().filter(|part| !part.is_empty()).collect();
        parts.join(&bar.to_string())
    }
}

fn file_name(key: &str, file: &RecordFile) -> String {
    format!("{key}_{}", file.name)
}
