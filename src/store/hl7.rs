//! A receiver of HL7 v2 as a store: each record is a result (ORU^R01), over MLLP or as a file in a folder.
//!
//! A receiver has no place where the station could look what it has. What it is sent is noted in the state folder
//! before, and that it was accepted afterwards. So nothing is sent twice even if the journal is lost; a message whose
//! answer was lost is sent again with the same control id, by which receivers know it, and is taken back like any
//! other.

mod mllp;
mod sent;
#[cfg(test)]
mod tests;

use std::path::{Path, PathBuf};

use gaiter_flow::ScanId;
use gaiter_record::hl7::{self, Acknowledgment, Hl7Rules, PdfForm};
use gaiter_record::sha256;
use jiff::Timestamp;

use self::sent::{Sent, SentMessages};
use super::exchange::ExchangeFolder;
use super::server::ServerFault;
use super::{Delivery, Peer, Receipt, RecordStore, Rejection, StoreFault, TakeBack};

/// Digits of the hash that stands for a scan of a patient.
const KEY_DIGITS: usize = 32;

/// How messages get to their receiver.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Hl7Way {
    /// Over a connection, with an answer to each.
    Mllp(Peer),
    /// As files in a folder, which the receiver removes.
    Files(PathBuf),
}

impl Hl7Way {
    /// The folder of message files, if that is the way.
    pub fn folder(&self) -> Option<&PathBuf> {
        match self {
            Hl7Way::Mllp(_) => None,
            Hl7Way::Files(folder) => Some(folder),
        }
    }

    /// The receiver, if messages get there over a connection.
    pub fn receiver(&self) -> Option<&Peer> {
        match self {
            Hl7Way::Mllp(receiver) => Some(receiver),
            Hl7Way::Files(_) => None,
        }
    }
}

/// A receiver of HL7 v2 as a store.
#[derive(Debug, Clone)]
pub struct Hl7Store {
    way: Hl7Way,
    rules: Hl7Rules,
    sent: SentMessages,
    /// The station's name: its folder among message files and its control ids are its own.
    station: String,
}

impl Hl7Store {
    /// Its name in the journal.
    pub const NAME: &str = "hl7";

    /// The store of a station, of messages by `rules`, on this way; what was sent is noted in the state folder.
    pub fn new(way: Hl7Way, rules: Hl7Rules, state_dir: &Path, station: &str) -> Hl7Store {
        let sent = SentMessages::in_state(state_dir);
        Hl7Store { way, rules, sent, station: station.to_owned() }
    }

    fn folder(&self) -> Option<ExchangeFolder> {
        Some(ExchangeFolder::new(self.way.folder()?.clone(), &self.station))
    }

    /// Sends a message and notes that the receiver has it. It is noted before: if the answer is lost, or cannot be
    /// noted, the receiver may have the message, and a take-back must not leave it there.
    fn send(
        &self,
        key: &str,
        patient: &str,
        message: &[u8],
        sent: &Sent,
    ) -> Result<(), StoreFault> {
        let Some(receiver) = self.way.receiver() else {
            return self.hand_out(key, message, sent);
        };
        let connection = receiver.connected().map_err(ServerFault::Http)?;
        let before = self.sent.of(key)?;
        self.sent.note(key, &Sent { is_answered: false, ..sent.clone() })?;
        let answer = mllp::exchange(receiver, connection, message).map_err(ServerFault::Http)?;
        match accepted(&answer, &sent.control, patient) {
            Ok(()) => self.sent.note(key, sent),
            Err(fault @ (StoreFault::Permanent(_) | StoreFault::Server(ServerFault::Later(_)))) => {
                self.sent.restore(key, before.as_ref())?;
                Err(fault)
            }
            Err(fault) => Err(fault),
        }
    }

    /// Makes the file of a message. It is noted before it has its name: if it is not there any more, it was fetched.
    fn hand_out(&self, key: &str, message: &[u8], sent: &Sent) -> Result<(), StoreFault> {
        let Some(folder) = self.folder() else { return Ok(()) };
        folder.reach()?;
        let name = staged_name(key, &sent.control);
        folder.stage(&name, message)?;
        self.sent.note(key, sent)?;
        folder.publish(&name, &message_file(&folder, &sent.control))
    }

    /// Gives the last message its name if a crash came before that.
    fn settle(&self, key: &str, sent: &Sent) -> Result<(), StoreFault> {
        let Some(folder) = self.folder() else { return Ok(()) };
        let name = staged_name(key, &sent.control);
        match folder.is_staged(&name)? {
            true => folder.publish(&name, &message_file(&folder, &sent.control)),
            // The run that gave it its name may have ended before this sync.
            false => folder.sync(),
        }
    }
}

impl RecordStore for Hl7Store {
    fn name(&self) -> &'static str {
        Hl7Store::NAME
    }

    fn place(&self) -> String {
        match &self.way {
            Hl7Way::Mllp(Peer { host, port, .. }) => format!("{host}:{port}"),
            Hl7Way::Files(folder) => folder.to_string_lossy().into_owned(),
        }
    }

    fn is_server(&self) -> bool {
        true
    }

    fn own_certificate(&self) -> Option<&Path> {
        self.way.receiver()?.tls.as_ref()?.certificate()
    }

    fn begin(&self, make_folder: bool) -> Result<(), StoreFault> {
        self.folder().map_or(Ok(()), |folder| folder.begin(make_folder))
    }

    /// Names staged messages that were noted, and removes the others: they are made again.
    fn open(&self) -> Result<(), StoreFault> {
        let Some(folder) = self.folder() else { return Ok(()) };
        for name in folder.staged()? {
            let Some((key, control)) = name.split_once('.') else { continue };
            match self.sent.of(key)?.is_some_and(|sent| sent.control == control) {
                true => folder.publish(&name, &message_file(&folder, control))?,
                false => folder.unstage(&name)?,
            }
        }
        Ok(())
    }

    fn reach(&self) -> Result<(), StoreFault> {
        match self.way.receiver() {
            Some(receiver) => Ok(receiver.open().map_err(ServerFault::Http)?),
            None => self.folder().map_or(Ok(()), |folder| folder.reach()),
        }
    }

    fn put(&self, delivery: &Delivery<'_>) -> Result<Receipt, StoreFault> {
        let (mut record, patient) = delivery.named_record().map_err(StoreFault::Permanent)?;
        let (revision, key) = (record.revision, key(delivery.scan, patient));
        let known = self.sent.of(&key)?;
        let place = self.place();
        let is_there = |known: &&Sent| {
            let is_here = known.is_answered && known.place == place;
            known.holds && is_here && known.revision >= revision
        };
        if let Some(known) = known.as_ref().filter(is_there) {
            self.settle(&key, known)?;
            return Ok(Receipt { folder: PathBuf::from(&known.control), already_there: true });
        }
        let number = match &known {
            None => revision,
            // Its answer was lost, or another receiver has it: it is the same message.
            Some(known) if known.holds && known.revision == revision => known.number,
            // A result that comes after its withdrawal is a correction of that: under the control id of the first
            // one, a receiver would not enter it.
            Some(known) => revision.max(known.number + 1),
        };
        record.revision = number;
        let pdf = delivery.file("report.pdf").map(|file| file.bytes.as_slice());
        let now = Timestamp::now();
        let mut codes = hl7::observed(&record, pdf.is_some() && self.rules.pdf != PdfForm::None);
        let before = known.map(|known| known.codes).unwrap_or_default();
        let gone: Vec<String> = before.into_iter().filter(|code| !codes.contains(code)).collect();
        let first_seen = delivery.first_seen;
        let control =
            hl7::control_id(&self.station, delivery.scan.as_str(), patient, number, false);
        let message = hl7::result(&control, &record, pdf, &gone, &self.rules, first_seen, now);
        let message = message.ok_or(StoreFault::Permanent(Rejection::Unassigned))?;
        codes.extend(gone);
        let folder = PathBuf::from(&control);
        let sent = Sent { revision, number, control, place, holds: true, is_answered: true, codes };
        self.send(&key, patient, &message, &sent)?;
        Ok(Receipt { folder, already_there: false })
    }

    /// All that results held is marked as wrong.
    fn withdraw(&self, record: &TakeBack<'_>) -> Result<(), StoreFault> {
        let (scan, Some(patient)) = (record.scan, record.from) else { return Ok(()) };
        let key = key(scan, patient);
        let Some(sent) = self.sent.of(&key)? else { return Ok(()) };
        let place = self.place();
        if !sent.holds && sent.is_answered && sent.place == place {
            return self.settle(&key, &sent);
        }
        let (id, number) = (scan.as_str(), sent.number);
        let control = hl7::control_id(&self.station, id, patient, number, true);
        let now = Timestamp::now();
        let message = hl7::withdrawal(&control, id, patient, &sent.codes, &self.rules, now);
        let withdrawn = Sent { control, place, holds: false, is_answered: true, ..sent };
        self.send(&key, patient, &message, &withdrawn)
    }

    /// Forgets what was sent of these scans. The messages are the receiver's own; what is staged of them is removed
    /// when the store is opened.
    fn erase(&self, patient: &str, _before: Timestamp, scans: &[ScanId]) -> Result<(), StoreFault> {
        scans.iter().map(|scan| key(scan, patient)).try_for_each(|key| self.sent.forget(&key))
    }

    fn unfetched(&self, reference: &str) -> Option<PathBuf> {
        let folder = self.folder()?;
        Some(message_file(&folder, reference)).filter(|file| file.is_file())
    }
}

/// The name under which a message is staged.
fn staged_name(key: &str, control: &str) -> String {
    format!("{key}.{control}")
}

/// The file of a message.
fn message_file(folder: &ExchangeFolder, control: &str) -> PathBuf {
    folder.folder().join(format!("{control}.hl7"))
}

/// Whether a receiver has the message of this control id, by its answer. A refusal is reported without the patient's id.
fn accepted(answer: &[u8], control: &str, patient: &str) -> Result<(), StoreFault> {
    let answer = hl7::acknowledgment(answer, control, &[patient]);
    match answer.map_err(|fault| ServerFault::Answer(fault.to_string()))? {
        Acknowledgment::Accepted => Ok(()),
        Acknowledgment::Refused { code, why, is_passing: true } => {
            Err(ServerFault::Later(format!("{code}: {why}")).into())
        }
        Acknowledgment::Refused { code, why, is_passing: false } => {
            Err(StoreFault::Permanent(Rejection::ReceiverRefused { code, why }))
        }
    }
}

/// The hash that stands for a scan of a patient in the notes.
fn key(scan: &ScanId, patient: &str) -> String {
    let mut digits = sha256(format!("{scan}\0{patient}").as_bytes());
    digits.truncate(KEY_DIGITS);
    digits
}
