//! An archive of many stations as a store: a bucket of an S3-compatible store, into which the station may write and
//! from which it may read nothing. [`gaiter_record::archive`] says what is there.
//!
//! A scan leaves the house as what [`CropScan`] makes of it, a record with a pseudonym. Both have keys of their content,
//! so they can be sent again at any time, whoever sent them before. The announcement comes last: what is not announced is
//! not there. Whether a record was announced cannot be looked up; if an answer is lost it is announced again, which says
//! the same.

mod clock;
#[cfg(test)]
mod tests;

use std::fmt;
use std::path::{Path, PathBuf};
use std::time::Duration;

use gaiter_flow::ScanId;
use gaiter_https::{
    Bucket, BucketFault, BucketPlace, HttpFault, HttpsClient, PutNew, Secret, TlsFiles, secret,
};
use gaiter_leg::{Method, WholeBody};
use gaiter_record::archive::{
    Announcement, Document, MethodId, ObjectKey, Pseudonym, RecordHash, SiteKey, StationId,
    Withdrawal, packed, pseudonymous,
};
use serde::{Deserialize, Serialize};

use self::clock::MonotonicClock;
use super::server::ServerFault;
use super::{Delivery, Receipt, RecordStore, Rejection, StoreFault, TakeBack};

/// For a whole exchange: a crop has one or two million bytes, and a clinic's line may be slow.
const EXCHANGE_MOST: Duration = Duration::from_secs(60);

/// Requests of a long step: for the scan, its length, the record, the announcement.
const REQUESTS_MOST: u32 = 4;

/// What is put to try the archive out: the scan without a byte, which is never announced.
const TRIAL_SCAN: &[u8] = b"";

/// Where the archive is, and who writes there.
#[derive(Debug, Clone)]
pub struct ArchivePlace {
    /// The bucket, and the station's key to it.
    pub bucket: BucketPlace,
    /// Which authorities are trusted.
    pub tls: TlsFiles,
    /// The station's name in the archive.
    pub station: StationId,
    /// Where the key of the site is, from which pseudonyms are made.
    pub site_key: Secret,
}

impl ArchivePlace {
    /// The bucket, asked by a client of its own.
    pub fn bucket(&self) -> Bucket {
        Bucket::new(self.bucket.clone(), HttpsClient::new(self.tls.clone(), None, EXCHANGE_MOST))
    }

    /// The secrets that the store needs.
    pub fn secrets(&self) -> Vec<&Secret> {
        vec![&self.bucket.secret, &self.site_key]
    }
}

/// How much of a body leaves the house.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum CropChoice {
    /// What lies below the crotch + 10 cm.
    Legs,
    /// All of it, with the face.
    Whole,
}

/// What leaves the house of a scan.
#[derive(Debug, Clone)]
pub struct Cropped {
    /// The bytes of a PLY file.
    pub ply: Vec<u8>,
    /// What the whole body told.
    pub whole: WholeBody,
}

/// Crops scans, and measures the crop again: all numbers are those of the whole body. Calls block.
pub trait CropScan: fmt::Debug + Send + Sync {
    /// What leaves the house of the scan in this file.
    ///
    /// # Errors
    /// [`Rejection::CropDiffers`] if on the crop other numbers are measured than on the whole body, or none;
    /// [`StoreFault::NoCrop`] if it could not be made now.
    fn crop(&self, scan: &ScanId, file: &Path, ending: &str) -> Result<Cropped, StoreFault>;

    /// The longest that this takes.
    fn longest(&self) -> Duration;
}

#[derive(Debug)]
pub struct ArchiveStore {
    place: ArchivePlace,
    bucket: Bucket,
    /// With this scans are measured when they are cropped.
    method: Method,
    crops: Box<dyn CropScan>,
    clock: MonotonicClock,
}

impl ArchiveStore {
    /// Its name in the journal.
    pub const NAME: &str = "archive";

    /// A store at this place, of scans that are cropped so. The time of its last message is noted in the state folder.
    pub fn new(
        place: ArchivePlace,
        method: Method,
        crops: Box<dyn CropScan>,
        state_dir: &Path,
    ) -> ArchiveStore {
        let (bucket, clock) = (place.bucket(), MonotonicClock::in_state(state_dir));
        ArchiveStore { place, bucket, method, crops, clock }
    }

    fn site_key(&self) -> Result<SiteKey, ServerFault> {
        let text = secret::read(&self.place.site_key).map_err(HttpFault::from)?;
        SiteKey::parse(&text).map_err(ServerFault::SiteKey)
    }

    /// Puts a scan where it belongs, unless it is there. A store that lets nobody ask for the length has said that it is.
    fn put_scan(&self, scan: &ScanId, ply: &[u8]) -> Result<(), StoreFault> {
        let (key, bytes) = (ObjectKey::Scan(scan.clone()).to_string(), packed(ply));
        let own = bytes.len() as u64;
        if self.bucket.put_new(&key, bytes).map_err(fault)? == PutNew::Stored {
            return Ok(());
        }
        match self.bucket.length(&key) {
            Ok(Some(there)) if there != own => {
                Err(StoreFault::Permanent(Rejection::OtherObject { there, own }))
            }
            Ok(None) => {
                let why = "the scan was there, and is gone".to_owned();
                Err(ServerFault::Busy { status: 404, why }.into())
            }
            Ok(Some(_)) | Err(BucketFault::Status { status: 403, .. }) => Ok(()),
            Err(other) => Err(fault(other)),
        }
    }

    /// Says something in the inbox. Its key has the time, and no time comes twice: if something is there, another station
    /// has this name, or this one has lost its state folder.
    fn say(&self, document: &impl Document) -> Result<(), StoreFault> {
        let json = document.json().map_err(|_| StoreFault::Permanent(Rejection::NoRecord))?;
        match self.bucket.put_new(&document.key().to_string(), json).map_err(fault)? {
            PutNew::Stored => Ok(()),
            PutNew::AlreadyThere => {
                let why = "it was told something else at the same time".to_owned();
                Err(ServerFault::Busy { status: 412, why }.into())
            }
        }
    }
}

/// Any fault of the store of objects may pass: what is wrong with one request is wrong with all, and a person mends it
/// in the configuration or there.
fn fault(fault: BucketFault) -> StoreFault {
    let fault: ServerFault = match fault {
        BucketFault::Http(fault) => fault.into(),
        BucketFault::Words => ServerFault::Answer(BucketFault::Words.to_string()),
        BucketFault::Status { status: status @ (401 | 403), said } => {
            ServerFault::Forbidden { status, why: said }
        }
        BucketFault::Status { status, said } => ServerFault::Busy { status, why: said },
    };
    fault.into()
}

impl RecordStore for ArchiveStore {
    fn name(&self) -> &'static str {
        ArchiveStore::NAME
    }

    fn place(&self) -> String {
        format!("{}/{}", self.place.bucket.address, self.place.bucket.bucket)
    }

    fn is_server(&self) -> bool {
        true
    }

    fn step_most(&self) -> Duration {
        EXCHANGE_MOST * REQUESTS_MOST + self.crops.longest()
    }

    /// The station can make pseudonyms, and the store of objects takes what it writes.
    fn reach(&self) -> Result<(), StoreFault> {
        self.site_key()?;
        self.put_scan(&ScanId::of_bytes(TRIAL_SCAN), TRIAL_SCAN)
    }

    fn put(&self, delivery: &Delivery<'_>) -> Result<Receipt, StoreFault> {
        let (record, _) = delivery.named_record().map_err(StoreFault::Permanent)?;
        let unwritten = |_| StoreFault::Permanent(Rejection::NoRecord);
        let method = MethodId::of(&self.method).map_err(unwritten)?;
        let (record, patient) = pseudonymous(record, &self.site_key()?);
        let json = serde_json::to_vec(&record).map_err(unwritten)?;
        let Cropped { ply, whole } =
            self.crops.crop(delivery.scan, delivery.scan_file, delivery.ending)?;
        let (scan, record) = (ScanId::of_bytes(&ply), RecordHash::of_bytes(&json));
        self.put_scan(&scan, &ply)?;
        let station = self.place.station.clone();
        let key = ObjectKey::Record {
            station: station.clone(),
            scan: scan.clone(),
            record: record.clone(),
        };
        self.bucket.put_new(&key.to_string(), packed(&json)).map_err(fault)?;
        let folder = PathBuf::from(ObjectKey::Scan(scan.clone()).to_string());
        self.say(&Announcement {
            schema: Announcement::SCHEMA.to_owned(),
            station,
            scan,
            export: delivery.scan.clone(),
            bytes: ply.len() as u64,
            record,
            revision: delivery.revision,
            at: self.clock.tick()?,
            method,
            first_seen: delivery.first_seen,
            whole,
            patient,
        })?;
        Ok(Receipt { folder, already_there: false })
    }

    /// Says that the scan is no longer this patient's. Nothing is removed.
    fn withdraw(&self, record: &TakeBack<'_>) -> Result<(), StoreFault> {
        let Some(patient) = record.from else { return Ok(()) };
        let site = self.site_key()?;
        self.say(&Withdrawal {
            schema: Withdrawal::SCHEMA.to_owned(),
            station: self.place.station.clone(),
            export: record.scan.clone(),
            patient: Some(Pseudonym::of(&site, patient)),
            at: self.clock.tick()?,
        })
    }
}
