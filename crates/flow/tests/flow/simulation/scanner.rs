//! The simulated scanner: an export folder whose files grow, stall, are replaced, and come twice.

use std::collections::BTreeMap;
use std::path::PathBuf;

use gaiter_flow::export::companions::Group;
use gaiter_flow::{Look, Stamp};

use super::chance::Chance;
use super::disk::Patient;

/// Bytes, by number. Bytes that are not whole are another number's beginning.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Bytes {
    /// Which scan.
    pub scan: u32,
    /// How much of it; whole at [`WHOLE`].
    pub length: u8,
}

/// The length of every whole scan.
pub const WHOLE: u8 = 4;

/// The scans of the patients in the booth have numbers from here on; no other scan comes without a press.
const OF_PATIENTS: u32 = 1000;

/// How many bytes one of its lengths stands for: enough for a mark.
const PART: usize = 5000;

/// A file in the export folder.
#[derive(Debug, Clone, Copy)]
pub struct File {
    /// What is in it.
    pub bytes: Bytes,
    /// Whose name it carries; none for a name that says nothing.
    pub patient: Option<u8>,
    /// Whether anybody still writes it.
    pub growing: bool,
    stamp: u64,
    inode: u64,
}

/// The export folder.
#[derive(Debug)]
pub struct Scanner {
    /// Its files.
    pub files: BTreeMap<PathBuf, File>,
    /// Whether it can be listed.
    pub in_reach: bool,
    stamps: u64,
    names: u32,
    /// Whose body a scan from the booth is.
    truth: BTreeMap<u32, Patient>,
}

impl Bytes {
    /// Whether a measurement takes it: no half, and no whole one that is no body.
    pub fn is_measurable(self) -> bool {
        self.length == WHOLE && self.scan % 10 != 9
    }

    /// What stands in a file.
    pub fn content(self) -> Vec<u8> {
        let part = |part: u8| {
            let first = self.scan.wrapping_mul(4) + u32::from(part);
            first.to_le_bytes().repeat(PART / 4)
        };
        (0..self.length).flat_map(part).collect()
    }
}

impl Scanner {
    /// An empty folder in reach.
    pub fn new() -> Scanner {
        Scanner {
            files: BTreeMap::new(),
            in_reach: true,
            stamps: 0,
            names: 0,
            truth: BTreeMap::new(),
        }
    }

    /// Begins an export, mostly of a new scan, now and then of one that was exported before, under
    /// the same name or another's.
    pub fn begin(&mut self, chance: &mut Chance) {
        let scan = chance.below(40) as u32;
        let patient = Some(chance.below(6) as u8).filter(|patient| *patient > 0);
        let reused = chance.below(10) == 0;
        if !reused {
            self.names += 1;
        }
        let who = patient.map_or("scan".to_owned(), |patient| patient.to_string());
        let path = PathBuf::from(format!("{who}_{}.obj", self.names));
        let bytes = Bytes { scan, length: 0 };
        self.write(path, bytes, patient, true);
        self.keep_few();
    }

    /// Begins the export of a patient in the booth, under a name that says nothing: a new one, or the
    /// one of the export before.
    pub fn export(&mut self, patient: Patient, chance: &mut Chance) {
        let scan = OF_PATIENTS + self.truth.len() as u32;
        self.truth.insert(scan, patient);
        let number = scan / (1 + chance.below(2) as u32);
        let path = PathBuf::from(format!("booth_{number}.obj"));
        self.write(path, Bytes { scan, length: 0 }, None, true);
        self.keep_few();
    }

    /// Whose body a scan is, where it came from the booth.
    pub fn truth(&self, bytes: Bytes) -> Option<Patient> {
        self.truth.get(&bytes.scan).copied()
    }

    /// Whether an export is not finished.
    pub fn is_writing(&self) -> bool {
        self.growing().next().is_some()
    }

    fn keep_few(&mut self) {
        if self.files.len() > 30 {
            // The scanner's own housekeeping.
            self.files.pop_first();
        }
    }

    /// Some file grows, or its writer gives up for good.
    pub fn go_on(&mut self, chance: &mut Chance) {
        let growing: Vec<PathBuf> = self.growing().collect();
        let Some(path) = chance.pick(&growing) else { return };
        let File { bytes, patient, .. } = self.files[path];
        let length = bytes.length + 1;
        let gives_up = chance.below(20) == 0;
        let growing = length < WHOLE && !gives_up;
        self.write(path.clone(), Bytes { length, ..bytes }, patient, growing);
    }

    /// Finishes whatever is still growing.
    pub fn finish(&mut self) {
        for path in self.growing().collect::<Vec<_>>() {
            let File { bytes, patient, .. } = self.files[&path];
            self.write(path, Bytes { length: WHOLE, ..bytes }, patient, false);
        }
    }

    fn growing(&self) -> impl Iterator<Item = PathBuf> {
        let growing = self.files.iter().filter(|(_, file)| file.growing);
        growing.map(|(path, _)| path.clone())
    }

    fn write(&mut self, path: PathBuf, bytes: Bytes, patient: Option<u8>, growing: bool) {
        self.stamps += 1;
        let inode = self.files.get(&path).map_or(self.stamps, |file| file.inode);
        self.files.insert(path, File { bytes, patient, growing, stamp: self.stamps, inode });
    }

    /// What a look finds.
    pub fn look(&self) -> Look {
        if !self.in_reach {
            return Look::OutOfReach;
        }
        let group = |file: &File| Group::from(stamp(file));
        Look::Seen(self.files.iter().map(|(path, file)| (path.clone(), group(file))).collect())
    }

    /// The file in the state that settled, if it still is.
    pub fn read(&self, path: &PathBuf, settled: Stamp) -> Option<File> {
        self.files.get(path).copied().filter(|file| stamp(file) == settled)
    }
}

fn stamp(file: &File) -> Stamp {
    let size = u64::from(file.bytes.length) * PART as u64;
    let time = i128::from(file.stamp);
    Stamp { dev: 1, ino: file.inode, size, mtime_ns: time, ctime_ns: time }
}
