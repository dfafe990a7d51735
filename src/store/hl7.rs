//! A receiver of HL7 v2 as a store: each record is a result (ORU^R01), over MLLP or as a file in a folder.
//!
//! A receiver has no place where the station could look what it has. What it has accepted is noted in the state
//! folder, so that nothing is sent twice even if the journal is lost; a message whose answer was lost is sent again
//! with the same control id, by which receivers know it.

mod mllp;
mod sent;

use std::io;
use std::path::{Path, PathBuf};

use jiff::Timestamp;

use self::sent::{Sent, SentMessages};
use super::server::ServerFault;
use super::{Delivery, Misfit, Receipt, StoreFault, durable, tried};
use crate::flow::ScanId;
use crate::flow::server::hl7::Way;
use crate::record::hl7::{self, Answer, Hl7Rules, PdfForm};
use crate::record::{FIRST_REVISION, Record, sha256};

/// The ending of message files.
const ENDING: &str = "hl7";

/// Digits of the hash that stands for a scan of a patient.
const KEY_DIGITS: usize = 32;

/// A receiver of HL7 v2 as a store.
#[derive(Debug, Clone)]
pub struct Hl7Store {
    way: Way,
    rules: Hl7Rules,
    sent: SentMessages,
}

impl Hl7Store {
    /// Its name in the journal.
    pub const NAME: &str = crate::flow::server::hl7::NAME;

    /// Messages as `rules` says, on this way; what was sent is noted in the state folder.
    pub fn new(way: Way, rules: Hl7Rules, state_dir: &Path) -> Hl7Store {
        Hl7Store { way, rules, sent: SentMessages::in_state(state_dir) }
    }

    /// Where the messages go, as configured.
    pub fn place(&self) -> String {
        match &self.way {
            Way::Mllp { host, port, .. } => format!("{host}:{port}"),
            Way::Files(folder) => folder.to_string_lossy().into_owned(),
        }
    }

    /// Begins the store: makes the folder of files if `make_folder` is set, and the notes of what was sent.
    ///
    /// # Errors
    /// A transient fault if that is not possible now.
    pub fn begin(&self, make_folder: bool) -> Result<(), StoreFault> {
        self.sent.open()?;
        match &self.way {
            Way::Files(folder) if make_folder => {
                tried("making", folder, durable::make_folder_once(folder))
            }
            _ => Ok(()),
        }
    }

    /// Checks that the receiver can be reached.
    ///
    /// # Errors
    /// A transient fault if not.
    pub fn reach(&self) -> Result<(), StoreFault> {
        match &self.way {
            Way::Mllp { .. } => Ok(mllp::open(&self.way)?),
            Way::Files(folder) => match folder.is_dir() {
                true => Ok(()),
                false => tried("looking for", folder, Err(io::ErrorKind::NotFound.into())),
            },
        }
    }

    /// Sends a record, or finds that it was sent.
    pub fn put(&self, delivery: &Delivery<'_>) -> Result<Receipt, StoreFault> {
        let misfit = |misfit| StoreFault::Permanent(misfit);
        let patient = delivery.patient.ok_or(misfit(Misfit::Unassigned))?;
        let file = |name: &str| delivery.files.iter().find(|file| file.name == name);
        let json = file("record.json");
        let record = json.and_then(|file| serde_json::from_slice::<Record>(&file.bytes).ok());
        let record = record.ok_or(misfit(Misfit::NoRecord))?;
        if record.patient.as_ref().map(|patient| patient.id.as_str()) != Some(patient) {
            return Err(misfit(Misfit::OtherPatient));
        }
        let (scan, key) = (delivery.scan.as_str(), key(delivery.scan, patient));
        let control = hl7::control_id(scan, patient, record.revision, false);
        let known = self.sent.of(&key)?;
        if known.is_some_and(|known| known.holds && known.revision >= record.revision) {
            return Ok(Receipt { folder: PathBuf::from(control), already_there: true });
        }
        let pdf = file("report.pdf").map(|file| file.bytes.as_slice());
        let now = Timestamp::now();
        let message = hl7::result(&record, pdf, &self.rules, delivery.first_seen, now);
        let message = message.ok_or(misfit(Misfit::Unassigned))?;
        self.send(&message, &control, patient)?;
        let has_pdf = pdf.is_some() && self.rules.pdf != PdfForm::None;
        let codes = hl7::observed(&record, has_pdf);
        self.sent.note(&key, &Sent { revision: record.revision, holds: true, codes })?;
        Ok(Receipt { folder: PathBuf::from(control), already_there: false })
    }

    /// Withdraws the result of a scan that was sent for the wrong patient: all that it held is marked as wrong.
    pub fn withdraw(&self, scan: &ScanId, from: Option<&str>) -> Result<(), StoreFault> {
        let Some(patient) = from else { return Ok(()) };
        let key = key(scan, patient);
        let Some(sent) = self.sent.of(&key)?.filter(|sent| sent.holds) else { return Ok(()) };
        let control = hl7::control_id(scan.as_str(), patient, sent.revision, true);
        let (scan, now) = (scan.as_str(), Timestamp::now());
        let message = hl7::withdrawal(scan, patient, sent.revision, &sent.codes, &self.rules, now);
        self.send(&message, &control, patient)?;
        // A later result for this patient is a new one.
        let revision = FIRST_REVISION - 1;
        self.sent.note(&key, &Sent { revision, holds: false, codes: sent.codes })
    }

    /// The file of a message that the receiver has not fetched; `None` if it has, or if messages are no files.
    pub fn unfetched(&self, control: &str) -> Option<PathBuf> {
        let file = self.way.folder()?.join(file_name(control));
        file.is_file().then_some(file)
    }

    fn send(&self, message: &[u8], control: &str, patient: &str) -> Result<(), StoreFault> {
        let folder = match &self.way {
            Way::Files(folder) => folder,
            Way::Mllp { .. } => {
                let bytes = mllp::exchange(&self.way, message)?;
                let answer = hl7::answer(&bytes, control, &[patient]);
                let answer = answer.map_err(|fault| ServerFault::Answer(fault.to_string()))?;
                return match answer {
                    Answer::Accepted => Ok(()),
                    Answer::Refused { code, why, is_passing: true } => {
                        Err(ServerFault::Later(format!("{code}: {why}")).into())
                    }
                    Answer::Refused { code, why, is_passing: false } => {
                        Err(StoreFault::Permanent(Misfit::ReceiverRefused { code, why }))
                    }
                };
            }
        };
        self.reach()?;
        tried("writing", folder, durable::replace_file(folder, &file_name(control), message))
    }
}

/// Forgets what a receiver was sent of these scans of a person. The messages are the house's own.
///
/// # Errors
/// If the state folder cannot be written.
pub fn forget<'a>(
    state_dir: &Path,
    patient: &str,
    scans: impl Iterator<Item = &'a ScanId>,
) -> io::Result<()> {
    let sent = SentMessages::in_state(state_dir);
    scans.into_iter().try_for_each(|scan| sent.forget(&key(scan, patient)))
}

fn file_name(control: &str) -> String {
    format!("{control}.{ENDING}")
}

/// The hash that stands for a scan of a patient in the notes.
fn key(scan: &ScanId, patient: &str) -> String {
    let mut digits = sha256(format!("{scan}\0{patient}").as_bytes());
    digits.truncate(KEY_DIGITS);
    digits
}
