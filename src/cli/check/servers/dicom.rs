//! The archive of images: whether it takes the station, and whether it gets what is to be sent.

use gaiter_leg::Side;

use super::{not_encrypted, of_store};
use crate::cli::check::row::{Row, Verdict};
use crate::config::{Config, DicomStoreConfig};
use crate::station::stores::Stores;
use crate::store::dicom::DicomServer;
use crate::store::{DicomStore, RecordStore};

/// The rows of the archive, if there is one.
pub(super) fn rows(config: &Config, stores: &Stores) -> Vec<Row> {
    let dicom = config.store.dicom.as_ref().zip(stores.named(DicomStore::NAME));
    dicom.map(|(dicom, store)| of_archive(config, dicom, store)).unwrap_or_default()
}

fn of_archive(config: &Config, dicom: &DicomStoreConfig, store: &dyn RecordStore) -> Vec<Row> {
    let detail = "lets the station look for studies";
    let mut rows = of_store("DICOM archive", store, &dicom.server.secrets(), detail);
    if let DicomServer::Dimse(server) = &dicom.server {
        rows.extend(not_encrypted(&server.peer, store.place(), "the results", "archive"));
    }
    rows.extend(of_attached(config, dicom, store));
    rows
}

/// The files that are to be sent and that no record has.
fn of_attached(config: &Config, dicom: &DicomStoreConfig, store: &dyn RecordStore) -> Option<Row> {
    let missing = not_made(config, dicom);
    let detail = format!(
        "no record has {}: name its kind in output.files, or remove it from store.dicom.attach",
        missing.join(", ")
    );
    (!missing.is_empty()).then(|| Row::at("attach", store.place(), Verdict::Warn, detail))
}

/// Those that the station's own settings keep from being made.
fn not_made<'c>(config: &Config, dicom: &'c DicomStoreConfig) -> Vec<&'c str> {
    let kinds = config.output.files.iter();
    let surfaces = kinds
        .flat_map(|kind| Side::FROM_FRONT.map(|side| format!("{}{}", side.word(), kind.ending())));
    let made: Vec<String> = surfaces.chain(["report.pdf".to_owned()]).collect();
    dicom.attach.iter().filter(|name| !made.contains(name)).map(String::as_str).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config;

    fn not_made_by(keys: &str) -> Vec<String> {
        let text = format!(
            "[station]\nid = \"booth-1\"\nstate_dir = \"/var/lib/gaiter\"\n\
             [scanner]\nexport_dirs = [\"/srv/scanner/export\"]\n\
             [store.folder]\npath = \"/srv/records\"\n\
             [store.dicom]\naddress = \"https://pacs.clinic.example/dicom-web\"\n{keys}"
        );
        let config = config::load(&text).unwrap();
        let missing = not_made(&config, config.store.dicom.as_ref().unwrap());
        missing.into_iter().map(str::to_owned).collect()
    }

    #[test]
    fn what_goes_by_default_is_in_every_record_and_what_is_in_none_is_told() {
        assert!(not_made_by("").is_empty());
        let attach = "attach = [\"left.stl\", \"report.pdf\"]\n";
        assert_eq!(not_made_by(attach), ["left.stl"]);
        assert!(not_made_by(&format!("{attach}[output]\nfiles = [\"stl\"]\n")).is_empty());
    }
}
