//! Files of a record that go to the practice with its result.

use std::path::{Path, PathBuf};

use gaiter_record::RecordFile;
use gaiter_record::gdt::{Attachment, Reference};

use super::super::StoreFault;
use super::super::exchange::ExchangeFolder;

/// The description of an attachment, as the practice software shows it.
const DESCRIPTION: &str = "Beinvermessung";

/// A file of a record that goes with a result.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Attached {
    /// The folder for it in the exchange folder; empty for the exchange folder itself.
    pub folder: String,
    /// Its name in the record.
    pub name: String,
}

/// Which files go with a result, where they are put, and how the result refers to them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Attach {
    /// The files; one that the record lacks is left out.
    pub files: Vec<Attached>,
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
        let attachment = |(attached, file): (&Attached, &RecordFile)| Attachment {
            name: key.to_owned(),
            format: file.name.rsplit('.').next().unwrap_or_default().to_ascii_uppercase(),
            description: DESCRIPTION.to_owned(),
            path: self.reference(key, attached, folder),
        };
        self.of(files).map(attachment).collect()
    }

    /// Writes the attachments, durable.
    pub(super) fn write(
        &self,
        key: &str,
        files: &[RecordFile],
        place: &ExchangeFolder,
    ) -> Result<(), StoreFault> {
        for (attached, file) in self.of(files) {
            let name = attached.file_name(key);
            place.stage(&name, &file.bytes)?;
            place.publish(&name, &attached.place(key, place.folder()))?;
        }
        Ok(())
    }

    /// The attachments of a result that are in the exchange folder.
    pub(super) fn there(&self, key: &str, folder: &Path) -> Vec<PathBuf> {
        let places = self.files.iter().map(|attached| attached.place(key, folder));
        places.filter(|path| path.exists()).collect()
    }

    fn of<'a>(
        &'a self,
        files: &'a [RecordFile],
    ) -> impl Iterator<Item = (&'a Attached, &'a RecordFile)> {
        self.files.iter().filter_map(|attached| {
            let file = files.iter().find(|file| file.name == attached.name)?;
            Some((attached, file))
        })
    }

    fn reference(&self, key: &str, attached: &Attached, folder: &Path) -> String {
        let name = attached.file_name(key);
        let root = match self.root.as_str() {
            "" => folder.to_string_lossy().into_owned(),
            root => root.trim_end_matches(['\\', '/']).to_owned(),
        };
        // The program that reads the paths mostly runs on Windows; the root shows whether it does.
        let bar = if root.contains('\\') { '\\' } else { '/' };
        let parts = match self.reference {
            Reference::Full => vec![root.as_str(), &attached.folder, &name],
            Reference::Relative => vec![attached.folder.as_str(), &name],
            Reference::Name => vec![name.as_str()],
        };
        let parts: Vec<&str> = parts.into_iter().filter(|part| !part.is_empty()).collect();
        parts.join(&bar.to_string())
    }
}

impl Attached {
    /// Its name beside a result.
    fn file_name(&self, key: &str) -> String {
        format!("{key}_{}", self.name)
    }

    /// Where it is put.
    fn place(&self, key: &str, folder: &Path) -> PathBuf {
        folder.join(&self.folder).join(self.file_name(key))
    }
}
