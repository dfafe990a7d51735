//! `station.toml` → [`Config`], checked as a whole: all faults at once, each with its place.
//!
//! [`load`] takes a text, and reads the files that it names; [`read`] takes the text from a file.

mod capture;
mod gdt;
mod load;
mod observability;
mod page;
mod parse;
mod phantom;
pub mod port;
mod removed;
mod servers;
pub mod sizes;
#[cfg(test)]
mod tests;
pub mod trigger;
pub mod visits;
mod watch;
pub mod words;

use std::collections::BTreeSet;
use std::io;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::time::Duration;

use jiff::civil::Date;
use regex::Regex;

use crate::store::Access;
pub use capture::{CaptureConfig, PatientConfig};
use gaiter_cad::Output;
use gaiter_flow::confinement::Confine;
use gaiter_flow::health::counted;
use gaiter_flow::retention::Retention;
use gaiter_language::Language;
use gaiter_leg::Method;
use gaiter_record::ReportChoice;
use gaiter_record::gdt::Product;
use gaiter_record::report::{AgeMax, Print};
use gaiter_record::sizing::SizeChoice;
use gaiter_sizes::{Garment, Mapping, SizeTable};
pub use gdt::{AfterOrder, GdtStoreConfig, OrdersConfig};
pub use load::{load, nested};
pub use observability::{control_path, state_dir};
pub use page::PageConfig;
pub use phantom::PhantomConfig;
pub use servers::{ArchiveStoreConfig, FhirStoreConfig, Hl7StoreConfig};
#[cfg(feature = "dicom")]
pub use servers::{DicomStoreConfig, WorklistConfig};
pub use trigger::TriggerConfig;
pub use visits::VisitsConfig;
pub use watch::WatchConfig;
pub use words::WithoutTrigger;

/// One fault in a configuration file.
pub type ConfigFault = gaiter_toml::Fault<gaiter_toml::What>;

/// The whole configuration of a station, checked.
#[derive(Debug, Clone)]
pub struct Config {
    pub station: StationConfig,
    pub scanner: ScannerConfig,
    pub capture: CaptureConfig,
    pub patient: PatientConfig,
    /// `[trigger]` and `[patient.reader]`: the devices on the ports of the booth.
    pub trigger: TriggerConfig,
    /// `[phantom]`: the body of known girths, if there is one.
    pub phantom: Option<PhantomConfig>,
    /// `[method]`, and what `[scanner]` declares about exports: unit, up, facing.
    pub method: Method,
    /// `[output]`: which CAD files and meshes are made of each leg.
    pub output: Output,
    /// `[report]`: the language of reports and of the operator's page.
    pub language: Language,
    /// `[report]`: the garment that is usually ordered.
    pub garment: Garment,
    /// `[report]`: the garments that can be ordered.
    pub garments: Vec<Garment>,
    /// `[report]`: how old a scan may be for an order.
    pub age_max: AgeMax,
    /// `[sizes]`: the size tables that reports are made with, in the order of the configuration.
    pub tables: Vec<SizeTable>,
    /// `[orders]`: the mappings by which each record gets its order, too.
    pub orders: Vec<Mapping>,
    /// `[report]`: the paper.
    pub print: Print,
    /// `[visits]`: how the visits of a patient are compared.
    pub visits: VisitsConfig,
    /// `[measure]`: limits on the measurement of one scan.
    pub measure: MeasureConfig,
    pub store: StoreConfig,
    /// `[retention]`: how long data is kept after it is no longer needed.
    pub retention: Retention,
    pub status: StatusConfig,
    /// `[page]`: the operator's page.
    pub page: PageConfig,
}

impl Config {
    /// How reports are made on this day.
    pub fn report_choice(&self, today: Date) -> ReportChoice {
        ReportChoice {
            language: self.language,
            garment: self.garment.clone(),
            print: self.print,
            age_max: self.age_max,
            sizes: SizeChoice {
                tables: self.tables.clone(),
                today,
                scanner_girth_mm: self.scanner.girth_error_mm,
            },
            orders: self.orders.clone(),
            ..ReportChoice::default()
        }
    }

    /// The names of the ports with buttons, as the trigger's workers call them.
    pub fn buttons(&self) -> BTreeSet<&'static str> {
        let TriggerConfig { serial, usb, keys, .. } = &self.trigger;
        let ports =
            [("serial", serial.is_some()), ("usb", usb.is_some()), ("keys", keys.is_some())];
        ports.into_iter().filter(|(_, there)| *there).map(|(name, _)| name).collect()
    }
}

/// `[measure]`: limits on the measurement of one scan.
#[derive(Debug, Clone, Copy)]
pub struct MeasureConfig {
    /// Address space, bytes.
    pub memory_bytes: u64,
    /// Wall-clock time.
    pub wall: Duration,
    /// What to do where the kernel cannot confine the measuring process.
    pub confine: Confine,
}

/// `[station]`: the station's name and where it keeps its state.
#[derive(Debug, Clone)]
pub struct StationConfig {
    /// The station's name in records and folders: letters, digits, `-` and `_`.
    pub id: String,
    /// The folder for journal, spool and quarantine; on a local disk, used by this station only.
    pub state_dir: PathBuf,
    /// Bytes that stay free on the disk of `state_dir`; intake stops before that.
    pub disk_floor_bytes: u64,
}

/// `[scanner]`: where and how the scanner exports.
#[derive(Debug, Clone)]
pub struct ScannerConfig {
    /// Folders watched for exports.
    pub export_dirs: Vec<PathBuf>,
    /// A file unchanged for this long has settled.
    pub quiet: Duration,
    /// Every folder is looked at with this interval, regardless of the watch.
    pub rescan: Duration,
    /// How long to wait for the rest of a settled file that its format shows to be truncated.
    pub short_wait: Duration,
    /// The largest accepted file, bytes; a larger file is refused before it is read.
    pub max_scan_bytes: u64,
    /// What is watched and when it is trusted.
    pub watch: WatchConfig,
    /// Standard error that all girths of a scan have in common, mm.
    pub girth_error_mm: f64,
    /// Regular expression for the file name; its group `patient` is the patient's id.
    pub file_name: Option<Regex>,
}

/// `[store]`: where records go.
#[derive(Debug, Clone)]
pub struct StoreConfig {
    pub folder: FolderStoreConfig,
    /// `[store.copy]`: a second folder that receives every record too, if configured.
    pub copy: Option<FolderStoreConfig>,
    /// `store.gdt.profile`: the practice software. Orders that name no character set are in its own.
    pub gdt_product: Product,
    /// `[store.gdt]`: practice software that is notified of every named record, if configured.
    pub gdt: Option<GdtStoreConfig>,
    /// `[store.fhir]`: a FHIR server that gets every named record, if configured.
    pub fhir: Option<FhirStoreConfig>,
    /// `[store.hl7]`: a receiver of HL7 v2 that gets every named record, if configured.
    pub hl7: Option<Hl7StoreConfig>,
    /// `[store.dicom]`: an archive of images that gets every named record, if configured.
    #[cfg(feature = "dicom")]
    pub dicom: Option<DicomStoreConfig>,
    /// `[store.archive]`: an archive of many stations that gets every named record, if configured.
    pub archive: Option<ArchiveStoreConfig>,
}

/// `[store.folder]`: records as folders.
#[derive(Debug, Clone)]
pub struct FolderStoreConfig {
    /// The folder that holds a folder per patient.
    pub path: PathBuf,
    /// Who may read the records.
    pub access: Access,
}

/// `[status]`: what the station reports about itself, and where.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StatusConfig {
    /// A scan without a record for longer than this makes the station not ready; a file that is kept from intake
    /// for longer raises an alarm.
    pub overdue: Duration,
    /// Address for metrics, health and the operator's page, on this machine only; `None` if off.
    pub listen: Option<SocketAddr>,
}

/// Why a file yields no configuration.
#[derive(Debug, thiserror::Error)]
pub enum ConfigError {
    #[error("cannot read {}", path.display())]
    Unreadable {
        /// The file name as given.
        path: PathBuf,
        /// The cause; its kind distinguishes a missing file from other errors.
        source: io::Error,
    },
    /// The file was read but is wrong; all faults in the order of their lines, at least one.
    #[error("{} has {}", path.display(), counted(faults.len(), "fault"))]
    Faults {
        /// The file name as given.
        path: PathBuf,
        faults: Vec<ConfigFault>,
    },
}

/// Reads a configuration file.
///
/// # Errors
/// [`ConfigError`]: the file cannot be read, or it has faults.
pub fn read(path: &Path) -> Result<Config, ConfigError> {
    let bytes = std::fs::read(path)
        .map_err(|source| ConfigError::Unreadable { path: path.into(), source })?;
    let loaded = match gaiter_toml::utf8(&bytes) {
        Ok(text) => load(text),
        Err(fault) => Err(vec![fault]),
    };
    loaded.map_err(|mut faults| {
        for fault in &mut faults {
            fault.file = path.display().to_string();
        }
        ConfigError::Faults { path: path.into(), faults }
    })
}
