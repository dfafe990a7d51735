//! The restless exporter: the scanner's computer and everybody who works on it, who write, cut short,
//! finish, rewrite, rename, remove and copy exports. What is told to the checker of the invariants is what
//! was put; nothing is taken away of which the station has not said that it has it.

use std::collections::BTreeSet;
use std::fs::{self, File, Permissions};
use std::io::Write;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use rig::invariants::{self, PutKind};
use rig::{Booth, names, sha256};
use support::coarse_body;

use crate::chance::Chance;
use crate::exports::{Act, Whom};
use crate::field::{Field, Tail};
use crate::plan::{Event, follow, seconds};

/// An export that lies there.
#[derive(Debug, Clone)]
struct Lying {
    name: String,
    /// Which scan it is.
    n: usize,
    sum: String,
    /// Only its beginning lies there.
    is_short: bool,
    /// Its bytes lie there under another name, too, or have: it stays as it is.
    is_twin: bool,
}

/// The exporter.
pub struct Exporter<'a> {
    field: &'a Field,
    scans: usize,
    names: usize,
    lying: Vec<Lying>,
    said: Tail,
    /// First digits of the scans of which the station has said that it has them.
    taken: BTreeSet<String>,
    fleeting: Fleeting,
}

/// Scans that were taken away before anybody may have seen them.
pub type Fleeting = Vec<(String, Vec<u8>)>;

/// Exports for as long as the siege lasts; gives what was there for a moment only.
pub fn export(field: &Field, events: Vec<Event<Act>>) -> Fleeting {
    let said = Tail::from_now(&field.booth);
    let (lying, fleeting) = (Vec::new(), Vec::new());
    let mut exporter =
        Exporter { field, scans: 0, names: 0, lying, said, taken: BTreeSet::new(), fleeting };
    follow(field, events, |act, chance| exporter.perform(act, chance));
    println!("{} scans were exported under {} names", exporter.scans, exporter.names);
    exporter.fleeting
}

impl Exporter<'_> {
    fn perform(&mut self, act: Act, chance: &mut Chance) {
        self.hear();
        match act {
            Act::Whole => self.put_whole(chance),
            Act::Renamed => self.put_renamed(chance),
            Act::Pieces => self.put_in_pieces(chance),
            Act::Many(count) => self.put_many(count, chance),
            Act::Begin => self.begin(chance),
            Act::Finish => self.finish(chance),
            Act::Rewrite => self.rewrite(chance),
            Act::Replace => self.replace(chance),
            Act::Rename { same_patient } => self.rename(same_patient, chance),
            Act::Remove => self.remove(chance),
            Act::Chmod => self.change(chance, |path, chance| {
                let mode = [0o400, 0o644, 0o000, 0o666][chance.below(4)];
                fs::set_permissions(path, Permissions::from_mode(mode)).unwrap();
            }),
            Act::Touch => self.change(chance, |path, chance| {
                let ago = seconds(chance, 0.0, 1e8);
                File::open(path).unwrap().set_modified(SystemTime::now() - ago).unwrap();
            }),
            Act::Again(whom) => self.again(whom, chance),
            Act::Garbage => self.garbage(chance),
            Act::NoScan => self.no_scan(chance),
            Act::Fleeting => self.fleeting(chance),
        }
    }

    /// Hears which scans the station has.
    fn hear(&mut self) {
        for line in self.said.lines().iter().filter(|line| line.contains("\"scan-spooled\"")) {
            let scan = line.split("scan=\"").nth(1).and_then(|rest| rest.split('"').next());
            self.taken.extend(scan.map(str::to_owned));
        }
    }

    fn at(&self, name: &str) -> PathBuf {
        self.field.booth.path("export").join(name)
    }

    fn tell(&self, what: &str, name: &str) {
        self.field.tell(format_args!("export: {what} {name}"));
    }

    /// A new name; of nobody now and then.
    fn new_name(&mut self, chance: &mut Chance) -> String {
        match chance.below(8) {
            0 => self.name_of("scan"),
            n => self.name_of(&format!("{}", 4710 + n % 5)),
        }
    }

    fn name_of(&mut self, patient: &str) -> String {
        self.names += 1;
        format!("{patient}_siege{:05}.obj", self.names)
    }

    /// A new scan.
    fn new_scan(&mut self) -> (usize, Vec<u8>) {
        self.scans += 1;
        (self.scans, coarse_body(self.scans))
    }

    /// Notes what lies under a name now.
    fn lies(&mut self, name: &str, n: usize, bytes: &[u8], kind: PutKind) {
        self.field.booth.has_put(name, bytes, kind);
        self.lying.retain(|other| other.name != name);
        let sum = sha256(bytes);
        let is_short = kind == PutKind::Short;
        self.lying.push(Lying { name: name.to_owned(), n, sum, is_short, is_twin: false });
    }

    /// One that lies there, whole, once, and that the station has.
    fn taken_one(&self, chance: &mut Chance) -> Option<Lying> {
        let is_taken =
            |it: &&Lying| !it.is_short && !it.is_twin && self.taken.contains(&it.sum[..8]);
        let taken: Vec<&Lying> = self.lying.iter().filter(is_taken).collect();
        chance.pick(&taken).map(|it| (*it).clone())
    }

    fn put_whole(&mut self, chance: &mut Chance) {
        let (name, (n, bytes)) = (self.new_name(chance), self.new_scan());
        fs::write(self.at(&name), &bytes).unwrap();
        self.lies(&name, n, &bytes, PutKind::Whole);
        self.tell("a scan", &name);
    }

    fn put_renamed(&mut self, chance: &mut Chance) {
        let (name, (n, bytes)) = (self.new_name(chance), self.new_scan());
        let spare = self.at(&format!(".{name}.part"));
        fs::write(&spare, &bytes).unwrap();
        self.field.pass(seconds(chance, 0.0, 0.5));
        fs::rename(spare, self.at(&name)).unwrap();
        self.lies(&name, n, &bytes, PutKind::Whole);
        self.tell("a scan, renamed,", &name);
    }

    fn put_in_pieces(&mut self, chance: &mut Chance) {
        let (name, (n, bytes)) = (self.new_name(chance), self.new_scan());
        let mut file = File::create(self.at(&name)).unwrap();
        let mut rest = bytes.as_slice();
        for _ in 0..2 + chance.below(4) {
            let (piece, behind) = rest.split_at(middle(rest, 0.4));
            file.write_all(piece).unwrap();
            rest = behind;
            self.field.pass(seconds(chance, 0.05, 0.6));
        }
        file.write_all(rest).unwrap();
        drop(file);
        self.lies(&name, n, &bytes, PutKind::Whole);
        self.tell("a scan in pieces", &name);
    }

    fn put_many(&mut self, count: usize, chance: &mut Chance) {
        for _ in 0..count {
            match chance.below(3) {
                0 => self.put_whole(chance),
                1 => self.garbage(chance),
                _ => self.no_scan(chance),
            }
        }
    }

    fn begin(&mut self, chance: &mut Chance) {
        let (name, (n, bytes)) = (self.new_name(chance), self.new_scan());
        let half = &bytes[..middle(&bytes, 0.2 + 0.3 * chance.unit())];
        fs::write(self.at(&name), half).unwrap();
        self.lies(&name, n, half, PutKind::Short);
        self.tell("a scan cut short", &name);
    }

    fn finish(&mut self, chance: &mut Chance) {
        let short: Vec<Lying> = self.lying.iter().filter(|it| it.is_short).cloned().collect();
        let Some(it) = chance.pick(&short) else { return };
        let bytes = coarse_body(it.n);
        let length = usize::try_from(fs::metadata(self.at(&it.name)).unwrap().len()).unwrap();
        let mut file = File::options().append(true).open(self.at(&it.name)).unwrap();
        file.write_all(&bytes[length..]).unwrap();
        self.lies(&it.name, it.n, &bytes, PutKind::Whole);
        self.tell("the rest of", &it.name);
    }

    fn rewrite(&mut self, chance: &mut Chance) {
        let Some(it) = self.taken_one(chance) else { return };
        let (n, bytes) = self.new_scan();
        let half = middle(&bytes, 0.4);
        let mut file = File::create(self.at(&it.name)).unwrap();
        file.write_all(&bytes[..half]).unwrap();
        self.field.booth.has_put(&it.name, &bytes[..half], PutKind::Short);
        self.field.pass(seconds(chance, 0.0, 1.0));
        file.write_all(&bytes[half..]).unwrap();
        drop(file);
        self.lies(&it.name, n, &bytes, PutKind::Whole);
        self.tell("rewritten", &it.name);
    }

    fn replace(&mut self, chance: &mut Chance) {
        let Some(it) = self.taken_one(chance) else { return };
        let (n, bytes) = self.new_scan();
        let spare = self.at(&format!(".{}.new", it.name));
        fs::write(&spare, &bytes).unwrap();
        fs::rename(spare, self.at(&it.name)).unwrap();
        self.lies(&it.name, n, &bytes, PutKind::Whole);
        self.tell("replaced", &it.name);
    }

    fn rename(&mut self, same_patient: bool, chance: &mut Chance) {
        let Some(it) = self.taken_one(chance) else { return };
        let patient = it.name.split('_').next().unwrap().to_owned();
        let patient = if same_patient { patient } else { format!("{}", 4720 + chance.below(5)) };
        let name = self.name_of(&patient);
        fs::rename(self.at(&it.name), self.at(&name)).unwrap();
        self.gone(&it.name);
        self.lies(&name, it.n, &coarse_body(it.n), PutKind::Whole);
        self.note_twins(&it.sum, !same_patient);
        self.tell(&format!("{} is now", it.name), &name);
    }

    fn remove(&mut self, chance: &mut Chance) {
        let Some(it) = self.taken_one(chance) else { return };
        fs::remove_file(self.at(&it.name)).unwrap();
        self.gone(&it.name);
        self.tell("removed", &it.name);
    }

    fn gone(&mut self, name: &str) {
        self.field.booth.has_gone(name);
        self.lying.retain(|other| other.name != name);
    }

    /// Changes what is no content of any export.
    fn change(&mut self, chance: &mut Chance, change: impl FnOnce(&Path, &mut Chance)) {
        let whole: Vec<Lying> = self.lying.iter().filter(|it| !it.is_short).cloned().collect();
        let Some(it) = chance.pick(&whole) else { return };
        change(&self.at(&it.name), chance);
        self.field.booth.has_put(&it.name, &coarse_body(it.n), PutKind::Whole);
        self.tell("mode or time of", &it.name);
    }

    fn again(&mut self, whom: Whom, chance: &mut Chance) {
        let Some(it) = self.taken_one(chance) else { return };
        let name = match whom {
            Whom::Same => self.name_of(it.name.split('_').next().unwrap()),
            Whom::Another => self.name_of(&format!("{}", 4730 + chance.below(5))),
            Whom::Nobody => self.name_of("scan"),
        };
        let bytes = coarse_body(it.n);
        fs::write(self.at(&name), &bytes).unwrap();
        self.lies(&name, it.n, &bytes, PutKind::Whole);
        self.note_twins(&it.sum, true);
        self.tell(&format!("{} again as", it.name), &name);
    }

    fn note_twins(&mut self, sum: &str, are_twins: bool) {
        let twins = self.lying.iter_mut().filter(|it| it.sum == sum);
        twins.for_each(|it| it.is_twin |= are_twins);
    }

    fn garbage(&mut self, chance: &mut Chance) {
        let name = self.new_name(chance);
        let ending = [".obj", ".ply", ".stl", ".xyz"][chance.below(4)];
        let name = name.replace(".obj", ending);
        let bytes = format!("garbage {}\n", self.names).into_bytes();
        fs::write(self.at(&name), &bytes).unwrap();
        self.field.booth.has_put(&name, &bytes, PutKind::Whole);
        self.tell("garbage", &name);
    }

    fn no_scan(&mut self, chance: &mut Chance) {
        let name = self.new_name(chance);
        let ending = [".pdf", ".jpg", ".ord", ".obj.tmp", ".xls"][chance.below(5)];
        let name = name.replace(".obj", ending);
        let bytes = format!("no scan {}\n", self.names).into_bytes();
        fs::write(self.at(&name), &bytes).unwrap();
        self.field.booth.has_put(&name, &bytes, PutKind::Beside);
        self.tell("no scan", &name);
    }

    fn fleeting(&mut self, chance: &mut Chance) {
        let (name, (_, bytes)) = (self.new_name(chance), self.new_scan());
        fs::write(self.at(&name), &bytes).unwrap();
        self.field.pass(seconds(chance, 0.0, 0.7));
        fs::remove_file(self.at(&name)).unwrap();
        self.tell("a scan that is gone again", &name);
        self.fleeting.push((name, bytes));
    }
}

/// What nobody could be expected to have seen counts only where the station has it.
pub fn account_for(booth: &Booth, fleeting: &mut Fleeting) {
    let (state, log) = (booth.path("state"), booth.log());
    let mut held: Vec<String> =
        ["spool", "quarantine"].map(|name| names(&state.join(name))).concat();
    held.extend(invariants::records(&booth.path("records")).0.into_iter().map(|(_, sum)| sum));
    fleeting.retain(|(name, bytes)| {
        let sum = sha256(bytes);
        let was_taken = log.contains(&format!("scan=\"{}\"", &sum[..8])) || held.contains(&sum);
        if was_taken {
            booth.has_put(name, bytes, PutKind::Whole);
        }
        !was_taken
    });
}

/// A place in the middle of a line, about so far in.
fn middle(bytes: &[u8], part: f64) -> usize {
    let about = (bytes.len() as f64 * part) as usize;
    let end = bytes[about..].iter().position(|byte| *byte == b'\n').unwrap();
    about + end + 1 + 4
}
