//! The stores of a station, each with its name in the journal.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::Mutex;

use gaiter_record::fhir::FhirRules;
use gaiter_record::hl7::Hl7Rules;
use jiff::tz::TimeZone;

use super::measure::CropJob;
use super::measure::crop::ConfinedCrop;
use super::runtime::locked;
use crate::config::{ArchiveStoreConfig, Config, FhirStoreConfig, GdtStoreConfig, Hl7StoreConfig};
use crate::store::gdt::Attach;
use crate::store::{
    ArchiveStore, FhirStore, FolderStore, GdtStore, Hl7Store, RecordStore, StoreFault,
};

/// The system of gaiter's codes in FHIR. It is the same everywhere, so that a code means the same everywhere.
const FHIR_CODES: &str = "urn:gaiter:measure";

/// The name of gaiter's codes in HL7 v2 and DICOM: a local coding system (table 0396, 99zzz; PS3.16, 8.2).
const LOCAL_CODES: &str = "99GTR";

/// Where records go.
#[derive(Debug)]
pub struct Stores {
    all: Vec<Box<dyn RecordStore>>,
    /// The names of the stores that this run has opened.
    opened: Mutex<BTreeSet<&'static str>>,
}

impl Stores {
    /// The stores of a configuration, none of them opened yet.
    pub fn from_config(config: &Config) -> Stores {
        let station = &config.station.id;
        let store = &config.store;
        let folder = |name, path: &PathBuf, access| {
            boxed(FolderStore::new(name, path.clone(), station, access))
        };
        let first = folder(FolderStore::FIRST, &store.folder.path, store.folder.access);
        let copy = store.copy.as_ref().map(|copy| folder("copy", &copy.path, copy.access));
        let gdt = store.gdt.as_ref().map(|gdt| boxed(gdt_store(config, gdt)));
        let fhir = store.fhir.as_ref().map(|fhir| boxed(fhir_store(config, fhir)));
        let hl7 = store.hl7.as_ref().map(|hl7| boxed(hl7_store(config, hl7)));
        #[cfg(feature = "dicom")]
        let dicom = store.dicom.as_ref().map(|dicom| boxed(dicom_store(config, dicom)));
        let archive = store.archive.as_ref().map(|of| boxed(archive_store(config, of)));
        let all = [
            Some(first),
            copy,
            gdt,
            fhir,
            hl7,
            #[cfg(feature = "dicom")]
            dicom,
            archive,
        ];
        let all = all.into_iter().flatten().collect();
        Stores { all, opened: Mutex::default() }
    }

    /// All of them, in the configuration's order.
    pub fn iter(&self) -> impl Iterator<Item = &dyn RecordStore> {
        self.all.iter().map(Box::as_ref)
    }

    /// The store of this name in the journal, if the configuration has it.
    pub fn named(&self, name: &str) -> Option<&dyn RecordStore> {
        self.iter().find(|store| store.name() == name)
    }

    /// The names of all stores.
    pub fn names(&self) -> Vec<&'static str> {
        self.iter().map(|store| store.name()).collect()
    }

    /// The names of the stores that take no record of a scan without a patient.
    pub fn named_only(&self) -> Vec<&'static str> {
        self.iter().filter(|store| !store.takes_unassigned()).map(|store| store.name()).collect()
    }

    /// The names of the stores that are servers.
    pub fn servers(&self) -> Vec<&'static str> {
        self.iter().filter(|store| store.is_server()).map(|store| store.name()).collect()
    }

    /// Removes what a crash left half made in a store, once per run. Blocks.
    ///
    /// # Errors
    /// See [`StoreFault`]; the next call tries again.
    pub fn open(&self, store: &dyn RecordStore) -> Result<(), StoreFault> {
        if !self.is_open(store) {
            store.open()?;
            locked(&self.opened).insert(store.name());
        }
        Ok(())
    }

    /// Reports whether this run has opened a store.
    pub fn is_open(&self, store: &dyn RecordStore) -> bool {
        locked(&self.opened).contains(store.name())
    }
}

fn boxed(store: impl RecordStore + 'static) -> Box<dyn RecordStore> {
    Box::new(store)
}

/// The store of practice software.
fn gdt_store(config: &Config, gdt: &GdtStoreConfig) -> GdtStore {
    let attach = Attach {
        files: gdt.attach.clone(),
        reference: gdt.attach_as,
        root: gdt.attach_root.clone(),
    };
    let rules = (gdt.rules.clone(), config.garment.clone(), attach);
    let station = (config.station.id.as_str(), config.station.state_dir.clone());
    let names = gdt.file_name.clone();
    // Practices expect the time of their clock.
    GdtStore::new(gdt.path.clone(), names, rules, station, TimeZone::system())
}

/// The store of a FHIR server.
fn fhir_store(config: &Config, fhir: &FhirStoreConfig) -> FhirStore {
    let rules = FhirRules {
        identifiers: fhir.identifiers.clone(),
        codes: FHIR_CODES.to_owned(),
        language: config.language,
        garment: config.garment.clone(),
        attach: fhir.attach.clone(),
    };
    FhirStore::new(fhir.server.clone(), rules, &config.station.id)
}

/// The store of a receiver of HL7 v2. A station without a name for its facility has its own.
fn hl7_store(config: &Config, hl7: &Hl7StoreConfig) -> Hl7Store {
    let station = &config.station.id;
    let [application, facility] = hl7.sender.clone();
    let facility = if facility.is_empty() { station.clone() } else { facility };
    let rules = Hl7Rules {
        sender: [application, facility],
        receiver: hl7.receiver.clone(),
        processing: hl7.processing,
        version: hl7.version.clone(),
        authority: hl7.authority.clone(),
        coding: LOCAL_CODES.to_owned(),
        pdf: hl7.pdf,
        charset: hl7.charset,
        language: config.language,
        garment: config.garment.clone(),
    };
    Hl7Store::new(hl7.way.clone(), rules, &config.station.state_dir, station)
}

/// The store of an archive of images.
#[cfg(feature = "dicom")]
fn dicom_store(
    config: &Config,
    dicom: &crate::config::DicomStoreConfig,
) -> crate::store::DicomStore {
    let rules = gaiter_dicom::DicomRules {
        issuer: dicom.issuer.clone(),
        coding: LOCAL_CODES.to_owned(),
        language: config.language,
        attach: dicom.attach.clone(),
        names: dicom.names,
    };
    crate::store::DicomStore::new(dicom.server.clone(), rules, &config.station.id)
}

fn archive_store(config: &Config, archive: &ArchiveStoreConfig) -> ArchiveStore {
    let job = CropJob { method: config.method.clone(), choice: archive.crop };
    let crops = ConfinedCrop { limits: config.measure, job };
    let (place, method) = (archive.place.clone(), config.method.clone());
    ArchiveStore::new(place, method, Box::new(crops), &config.station.state_dir)
}
