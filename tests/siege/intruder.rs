//! The intruder: the same hostile user in the export folder, where he puts what is no file or has no end,
//! and among the processes that measure, which he stops and kills.

use std::fs::{self, File};
use std::os::unix::fs::symlink;
use std::os::unix::net::UnixListener;
use std::path::{Path, PathBuf};
use std::time::Duration;

use rig::invariants::PutKind;
use rustix::fs::{CWD, FileType, Mode, makedev, mkfifoat, mknodat};
use rustix::process::{Pid, Signal, kill_process};
use support::coarse_body;

use crate::chance::Chance;
use crate::field::Field;
use crate::plan::{Event, follow, seconds, weighed};
use crate::process::family;

/// So many names of one file lie beside a scan.
const LINKS: usize = 150;

/// The first number of his scans, far from those of the exporter.
const SCANS: usize = 700_000;

/// What he does.
#[derive(Debug, Clone, Copy)]
pub enum Act {
    Link,
    Pipe,
    Folder,
    Socket,
    Device,
    /// Larger than anything that is read.
    Endless,
    /// As large as a scan may be, and nothing but zeros.
    Zeros,
    /// One file under many names beside a scan.
    Companions,
    /// A link in the place of a scan and back, again and again.
    Swap,
    /// Takes one of his things away.
    Remove,
    /// Stops measuring processes for a while.
    Stop,
    /// Kills them.
    Kill,
}

pub fn draw(chance: &mut Chance) -> Act {
    let acts = [
        (4, Act::Link),
        (2, Act::Pipe),
        (2, Act::Folder),
        (1, Act::Socket),
        (1, Act::Device),
        (1, Act::Endless),
        (1, Act::Zeros),
        (1, Act::Companions),
        (2, Act::Swap),
        (3, Act::Remove),
        (4, Act::Stop),
        (4, Act::Kill),
    ];
    weighed(chance, &acts)
}

/// The intruder, and what he has put.
pub struct Intruder<'a> {
    field: &'a Field,
    planted: Vec<String>,
    count: usize,
}

/// Intrudes for as long as the siege lasts.
pub fn intrude(field: &Field, events: Vec<Event<Act>>) {
    let mut intruder = Intruder { field, planted: Vec::new(), count: 0 };
    follow(field, events, |act, chance| intruder.perform(act, chance));
}

impl Intruder<'_> {
    fn perform(&mut self, act: Act, chance: &mut Chance) {
        self.count += 1;
        let name = format!("{}_intruder{}.obj", 4700 + chance.below(5), self.count);
        let path = self.at(&name);
        match act {
            Act::Stop | Act::Kill => return self.torment(act, chance),
            Act::Remove => return self.remove(chance),
            Act::Endless => self.sparse(&name, 50_000_000_000, PutKind::Huge),
            Act::Zeros => self.sparse(&name, 10_000_000, PutKind::Whole),
            Act::Companions => self.companions(&name),
            Act::Swap => self.swap(&name, chance),
            Act::Link => self.beside(&name, |at| symlink(link_to(at, chance), at).unwrap()),
            Act::Pipe => {
                self.beside(&name, |at| mkfifoat(CWD, at, Mode::RUSR | Mode::WUSR).unwrap());
            }
            Act::Socket => self.beside(&name, |at| drop(UnixListener::bind(at).unwrap())),
            // Only root may.
            Act::Device => self.beside(&name, |at| {
                let zero = makedev(1, 5);
                let _ = mknodat(CWD, at, FileType::CharacterDevice, Mode::RUSR, zero);
            }),
            Act::Folder => {
                fs::create_dir(&path).unwrap();
                fs::write(path.join("4711_inside.obj"), coarse_body(SCANS)).unwrap();
            }
        }
        self.field.tell(format_args!("{act:?} in the export folder: {name}"));
    }

    fn at(&self, name: &str) -> PathBuf {
        self.field.booth.path("export").join(name)
    }

    /// Puts something that is no scan.
    fn beside(&mut self, name: &str, put: impl FnOnce(&PathBuf)) {
        put(&self.at(name));
        self.field.booth.has_put(name, b"", PutKind::Beside);
        self.planted.push(name.to_owned());
    }

    fn sparse(&self, name: &str, size: u64, kind: PutKind) {
        File::create(self.at(name)).unwrap().set_len(size).unwrap();
        let bytes = match kind {
            PutKind::Whole => vec![0; usize::try_from(size).unwrap()],
            _ => Vec::new(),
        };
        self.field.booth.has_put(name, &bytes, kind);
    }

    fn companions(&mut self, scan: &str) {
        let stem = scan.trim_end_matches(".obj");
        let (head, tail) = stem.split_once('_').unwrap();
        // Letter case apart these are one name, so all of them lie beside the scan.
        let names = (0..LINKS).map(|n| {
            let bits = tail.char_indices().map(|(at, c)| match n >> at & 1 {
                1 => c.to_ascii_uppercase(),
                _ => c,
            });
            format!("{head}_{}.mtl", bits.collect::<String>())
        });
        let names: Vec<String> = names.collect();
        let bytes = format!("newmtl skin of {scan}\n").repeat(4000).into_bytes();
        fs::write(self.at(&names[0]), &bytes).unwrap();
        names[1..]
            .iter()
            .for_each(|name| fs::hard_link(self.at(&names[0]), self.at(name)).unwrap());
        for name in &names {
            self.field.booth.has_put(name, &bytes, PutKind::Beside);
        }
        self.field.booth.export(scan, &coarse_body(SCANS + self.count));
    }

    /// A scan of his own, so that nobody else notes what has become of it.
    fn swap(&self, name: &str, chance: &mut Chance) {
        let (booth, bytes) = (&self.field.booth, coarse_body(SCANS + self.count));
        let (path, secret, link) = (self.at(name), booth.path("secret.obj"), booth.path("link"));
        fs::write(&secret, coarse_body(SCANS)).unwrap();
        symlink(&secret, &link).unwrap();
        booth.export(name, &bytes);
        let spare = booth.path("spare");
        let until = self.field.elapsed() + seconds(chance, 0.3, 1.5);
        while self.field.elapsed() < until && self.field.goes_on() {
            fs::rename(&path, &spare).unwrap();
            fs::rename(&link, &path).unwrap();
            fs::rename(&path, &link).unwrap();
            fs::rename(&spare, &path).unwrap();
            std::thread::yield_now();
        }
        fs::remove_file(&link).unwrap();
        booth.has_put(name, &bytes, PutKind::Whole);
    }

    fn remove(&mut self, chance: &mut Chance) {
        if self.planted.is_empty() {
            return;
        }
        let name = self.planted.swap_remove(chance.below(self.planted.len()));
        let _ = fs::remove_file(self.at(&name));
        self.field.booth.has_gone(&name);
        self.field.tell(format_args!("the intruder takes {name} away"));
    }

    /// Lies in wait for measuring processes, and stops or kills what comes.
    fn torment(&self, act: Act, chance: &mut Chance) {
        let until = self.field.elapsed() + seconds(chance, 0.5, 2.5);
        let mut met = Vec::new();
        while self.field.elapsed() < until && self.field.goes_on() && met.len() < 4 {
            let others: Vec<Pid> =
                self.children().into_iter().filter(|child| !met.contains(child)).collect();
            for child in others {
                let signal = if let Act::Kill = act { Signal::KILL } else { Signal::STOP };
                let _ = kill_process(child, signal);
                self.field.tell(format_args!("{act:?} to the measuring process {child:?}"));
                met.push(child);
            }
            self.field.pass(Duration::from_millis(10));
        }
        if let Act::Stop = act {
            self.field.pass(seconds(chance, 0.2, 3.0));
            met.iter().for_each(|child| _ = kill_process(*child, Signal::CONT));
        }
    }

    /// The measuring processes of the station.
    fn children(&self) -> Vec<Pid> {
        let Some(station) = self.field.keeper.life().pid else { return Vec::new() };
        let measures = |pid: &u32| {
            let words = fs::read(format!("/proc/{pid}/cmdline")).unwrap_or_default();
            words.split(|byte| *byte == 0).nth(1) == Some(b"measure")
        };
        let children = family(station).into_iter().skip(1).filter(measures);
        children.filter_map(|pid| Pid::from_raw(i32::try_from(pid).ok()?)).collect()
    }
}

fn link_to(own: &Path, chance: &mut Chance) -> PathBuf {
    let places = [PathBuf::from("/dev/zero"), PathBuf::from("/etc/passwd"), own.to_owned()];
    let nowhere = own.with_extension("nowhere");
    chance.pick(&places).cloned().unwrap_or(nowhere)
}
