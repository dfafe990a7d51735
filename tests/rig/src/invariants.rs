//! The one checker of what must hold after any fault: invariants I1 to I9, read from the folders,
//! the journal and the log alone.
//!
//! I1 every complete scan is delivered, in quarantine with its reason, or held for a person; I2
//! nothing is delivered twice, nor for somebody who was not named; I3 nothing partial lies under a
//! final name; I4 the export is untouched; I5 an incomplete scan is never delivered; I6 the station
//! comes to rest by itself; I7 open files and memory stay flat ([`Vitals`]); I8 the log names
//! nobody; I9 what the station says of itself is so ([`StatusCounts`]).

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::fs;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};

use rusqlite::{Connection, OpenFlags};

use crate::whole::{UNREAD, final_names, folders, names, sha256, whole_entry, whole_record};

/// What the scanner has put into the export folder.
#[derive(Debug, Clone)]
pub struct Put {
    /// File name.
    pub name: String,
    /// The store's folder of the patient whom the name names.
    pub patient: String,
    /// SHA-256 of its bytes; empty for a file too large to be read.
    pub sha256: String,
    /// What it is.
    pub kind: PutKind,
    /// The file as the scanner left it; none where the scanner itself replaced or removed it.
    pub left: Option<Left>,
}

/// What a file in the export folder is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PutKind {
    /// A scan, or what calls itself one, that is complete.
    Whole,
    /// The scanner has not finished it.
    Short,
    /// Larger than the configuration allows.
    Huge,
    /// No scan: a done file, a mark, a link, a pipe.
    Beside,
}

/// A file's identity and time: what reading leaves alone and everything else changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Left {
    inode: u64,
    size: u64,
    mtime: (i64, i64),
    ctime: (i64, i64),
}

/// What the station says of itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StatusCounts {
    /// Scans still to be delivered.
    pub pending: usize,
    /// Scans that wait for a person.
    pub held: usize,
    /// Scans in quarantine.
    pub refused: usize,
}

/// All there is to judge by.
#[derive(Debug, Clone, Copy)]
pub struct Evidence<'a> {
    /// All that was ever put into the export folder.
    pub puts: &'a [Put],
    /// Deliveries that a person has ordered: the store's folder of the patient, and the SHA-256.
    pub released: &'a [(String, String)],
    /// The export folder.
    pub export: &'a Path,
    /// The station's state folder.
    pub state: &'a Path,
    /// The store.
    pub records: &'a Path,
    /// The log of all runs.
    pub log: &'a str,
    /// What the log must not say, apart from the names of the files.
    pub planted: &'a [&'a str],
    /// What the station said, where it was asked.
    pub told: Option<StatusCounts>,
}

/// When the invariants are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Moment {
    /// At any moment, in the middle of a crash too. The journal is left alone.
    Any,
    /// When the station has had its time: I1, I6 and I9 hold as well.
    Rest,
}

/// An invariant that does not hold.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Violation {
    /// 1 to 9.
    pub invariant: u8,
    /// What is so and must not be.
    pub what: String,
}

impl fmt::Display for Violation {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "I{}: {}", self.invariant, self.what)
    }
}

/// A delivery: the store's folder of the patient, and the SHA-256 of the scan.
pub type Delivered = (String, String);

/// Checks everything that can be checked at this moment.
pub fn violations(evidence: &Evidence<'_>, moment: Moment) -> Vec<Violation> {
    let (store, violations) = records(evidence.records);
    let mut found = Found { violations };
    let spool = found.scans_within(&evidence.state.join("spool"), "intake.json");
    let quarantine = found.scans_within(&evidence.state.join("quarantine"), "reason.json");
    found.twice(evidence, &store);
    found.touched(evidence);
    found.incomplete(evidence, &store);
    found.named(evidence);
    if moment == Moment::Rest {
        match journal(evidence.state) {
            Ok(journal) => {
                found.lost(evidence, &store, &spool, &quarantine, &journal);
                found.restless(evidence, &spool, &journal);
                found.untrue(evidence, &journal, &quarantine);
            }
            Err(error) => found.say(6, format!("the journal cannot be read: {error}")),
        }
    }
    found.violations
}

/// The whole records of a store, sorted, and what I3 says of the others.
pub fn records(store: &Path) -> (Vec<Delivered>, Vec<Violation>) {
    let (mut records, mut partial) = (Vec::new(), Vec::new());
    for patient in folders(store) {
        for record in final_names(&store.join(&patient)) {
            match whole_record(&store.join(&patient).join(&record)) {
                Ok(sum) => records.push((patient.clone(), sum)),
                Err(why) => partial.push(Violation {
                    invariant: 3,
                    what: format!("the record {patient}/{record}: {why}"),
                }),
            }
        }
    }
    records.sort();
    (records, partial)
}

/// What the journal holds open.
struct JournalState {
    pending: usize,
    held: BTreeSet<Delivered>,
    /// Scans that were refused and need no decision any more.
    closed: BTreeSet<String>,
}

fn journal(state: &Path) -> rusqlite::Result<JournalState> {
    let flags = OpenFlags::SQLITE_OPEN_READ_WRITE;
    let journal = Connection::open_with_flags(state.join("journal.db"), flags)?;
    let pending = "SELECT count(*) FROM deliveries WHERE state = 'pending'";
    let pending: i64 = journal.query_row(pending, [], |row| row.get(0))?;
    let spooled = "SELECT count(*) FROM scans WHERE state = 'spooled'";
    let spooled: i64 = journal.query_row(spooled, [], |row| row.get(0))?;
    let mut held =
        journal.prepare("SELECT patient, sha256 FROM deliveries WHERE state = 'held'")?;
    let held = held.query_map([], |row| Ok((row.get(0)?, row.get(1)?)))?;
    let mut closed = journal.prepare("SELECT sha256 FROM scans WHERE closed IS NOT NULL")?;
    let closed = closed.query_map([], |row| row.get(0))?;
    Ok(JournalState {
        pending: usize::try_from(pending.max(spooled)).unwrap(),
        held: held.collect::<rusqlite::Result<_>>()?,
        closed: closed.collect::<rusqlite::Result<_>>()?,
    })
}

struct Found {
    violations: Vec<Violation>,
}

impl Found {
    fn say(&mut self, invariant: u8, what: String) {
        self.violations.push(Violation { invariant, what });
    }

    /// I3 in the spool or the quarantine; the scans whose bytes are there.
    fn scans_within(&mut self, folder: &Path, document: &str) -> BTreeSet<String> {
        let mut scans = BTreeSet::new();
        for name in final_names(folder) {
            match whole_entry(&folder.join(&name), &name, document) {
                Ok(()) => drop(scans.insert(name)),
                Err(why) => self.say(3, format!("{name} beside {document}: {why}")),
            }
        }
        scans
    }

    fn twice(&mut self, evidence: &Evidence<'_>, store: &[Delivered]) {
        let mut seen = BTreeSet::new();
        let mut owners: BTreeMap<&str, usize> = BTreeMap::new();
        for delivered @ (patient, sum) in store {
            if !seen.insert(delivered) {
                self.say(2, format!("{patient} has two records of {sum}"));
            }
            if evidence.released.contains(delivered) {
                continue;
            }
            let owners = owners.entry(sum).or_default();
            *owners += 1;
            if *owners == 2 {
                self.say(2, format!("{sum} was delivered for two patients, and nobody said so"));
            }
            let named = |put: &Put| put.patient == *patient && put.sha256 == *sum;
            if !evidence.puts.iter().any(named) {
                self.say(2, format!("{sum} was delivered for {patient}, whom nobody named"));
            }
        }
    }

    /// I4.
    fn touched(&mut self, evidence: &Evidence<'_>) {
        let mut expected = BTreeSet::new();
        for put in evidence.puts {
            let Some(left) = put.left else { continue };
            expected.insert(put.name.clone());
            let path = evidence.export.join(&put.name);
            if left_at(&path) != Some(left) {
                self.say(4, format!("{} was changed, replaced or removed", put.name));
            } else if !matches!(put.kind, PutKind::Huge | PutKind::Beside)
                && fs::read(&path).map(|bytes| sha256(&bytes)).ok().as_ref() != Some(&put.sha256)
            {
                self.say(4, format!("{} has other bytes", put.name));
            }
        }
        for name in names(evidence.export) {
            if !expected.contains(&name) && !folders(evidence.export).contains(&name) {
                self.say(4, format!("{name} in the export folder is not the scanner's"));
            }
        }
    }

    /// I5.
    fn incomplete(&mut self, evidence: &Evidence<'_>, store: &[Delivered]) {
        for put in evidence.puts.iter().filter(|put| put.kind != PutKind::Whole) {
            if store.iter().any(|(_, sum)| *sum == put.sha256) {
                self.say(5, format!("{} is not complete and was delivered", put.name));
            }
        }
    }

    /// I8.
    fn named(&mut self, evidence: &Evidence<'_>) {
        let names = evidence.puts.iter().map(|put| put.name.as_str());
        for planted in evidence.planted.iter().copied().chain(names) {
            if let Some(line) = evidence.log.lines().find(|line| line.contains(planted)) {
                self.say(8, format!("{planted} is in the log: {line}"));
            }
        }
    }

    /// I1.
    fn lost(
        &mut self,
        evidence: &Evidence<'_>,
        store: &[Delivered],
        spool: &BTreeSet<String>,
        quarantine: &BTreeSet<String>,
        journal: &JournalState,
    ) {
        for put in evidence.puts.iter().filter(|put| put.kind == PutKind::Whole) {
            let sum = &put.sha256;
            // Bytes that name nobody are served by a record under any name.
            let anybody = put.patient == NOBODY;
            let delivered =
                store.iter().any(|(patient, s)| s == sum && (anybody || *patient == put.patient));
            let held = journal.held.contains(&(put.patient.clone(), sum.clone()));
            if held && !spool.contains(sum) && !quarantine.contains(sum) {
                self.say(1, format!("{} is held and its bytes are gone", put.name));
            }
            if !delivered && !held && !quarantine.contains(sum) {
                self.say(1, format!("{} is neither delivered nor refused nor held", put.name));
            }
        }
        let huge = evidence.puts.iter().filter(|put| put.kind == PutKind::Huge).count();
        let unread = quarantine.iter().filter(|name| name.starts_with(UNREAD)).count();
        if unread < huge {
            self.say(1, format!("{huge} files are too large, {unread} are noted as refused"));
        }
    }

    /// I6.
    fn restless(
        &mut self,
        evidence: &Evidence<'_>,
        spool: &BTreeSet<String>,
        journal: &JournalState,
    ) {
        if journal.pending > 0 {
            self.say(6, format!("{} deliveries are still to be made", journal.pending));
        }
        for sum in spool {
            if !journal.held.iter().any(|(_, held)| held == sum) {
                self.say(6, format!("{sum} is in the spool and waits for nobody"));
            }
        }
        let patients = folders(evidence.records);
        let stores = patients.iter().map(|patient| evidence.records.join(patient));
        let state = ["spool", "quarantine"].map(|name| evidence.state.join(name));
        for folder in stores.chain(state) {
            for name in names(&folder).into_iter().filter(|name| name.starts_with('.')) {
                self.say(6, format!("{name} was left half made"));
            }
        }
    }

    /// I9.
    fn untrue(
        &mut self,
        evidence: &Evidence<'_>,
        journal: &JournalState,
        quarantine: &BTreeSet<String>,
    ) {
        let held: BTreeSet<&str> = journal.held.iter().map(|(_, sum)| sum.as_str()).collect();
        // The note of a file that was too large to be read is no scan, and a refusal that is closed
        // asks nobody.
        let asks = |name: &&String| !name.starts_with(UNREAD) && !journal.closed.contains(*name);
        let refused = quarantine.iter().filter(asks).count();
        let so = StatusCounts { pending: journal.pending, held: held.len(), refused };
        if let Some(told) = evidence.told.filter(|told| *told != so) {
            self.say(9, format!("the station says {told:?}, and it is {so:?}"));
        }
    }
}

/// The store's folder of scans whose patient nobody named.
pub const NOBODY: &str = "_unassigned";

/// The store's folder of the patient whom a file name names, as the stations under test read it.
pub fn patient_of(name: &str) -> String {
    let name = name.rsplit('/').next().unwrap_or_default();
    let id = name.split_once('_').map_or("", |(id, _)| id);
    let digits = id.strip_prefix('P').unwrap_or(id);
    let named = (1..=12).contains(&digits.len()) && digits.bytes().all(|b| b.is_ascii_digit());
    if named { id.to_owned() } else { NOBODY.to_owned() }
}

/// A file as it is; none where it is not there.
pub fn left_at(path: &Path) -> Option<Left> {
    let metadata = path.symlink_metadata().ok()?;
    Some(Left {
        inode: metadata.ino(),
        size: metadata.len(),
        mtime: (metadata.mtime(), metadata.mtime_nsec()),
        ctime: (metadata.ctime(), metadata.ctime_nsec()),
    })
}

/// What a process holds, for I7: read it twice, and compare.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Vitals {
    /// Open files.
    pub files: usize,
    /// Threads.
    pub threads: usize,
    /// Resident memory, kilobytes.
    pub resident_kb: usize,
}

impl Vitals {
    /// The vitals of a running process; none where it has ended.
    pub fn read(pid: u32) -> Option<Vitals> {
        let process = PathBuf::from(format!("/proc/{pid}"));
        let status = fs::read_to_string(process.join("status")).ok()?;
        let number = |key: &str| {
            let line = status.lines().find_map(|line| line.strip_prefix(key))?;
            line.split_whitespace().next()?.parse().ok()
        };
        let files = fs::read_dir(process.join("fd")).ok()?.count();
        Some(Vitals { files, threads: number("Threads:")?, resident_kb: number("VmRSS:")? })
    }
}
