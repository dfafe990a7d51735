//! Files that belong together: a scan, what the scanner writes beside it under the same stem, and the
//! done file that marks the scan as finished.

use std::collections::BTreeMap;
use std::ffi::{OsStr, OsString};
use std::os::unix::ffi::OsStrExt;
use std::path::{Path, PathBuf};

use gaiter_language::{Piece, pieces};
use gaiter_scan::{Format, ord};

use crate::export::stamp::Stamp;

/// The endings of files that scanners write beside a scan: their own measures, and the colours of an
/// OBJ.
const ENDINGS: [&str; 2] = ["ord", "mtl"];

/// A larger file beside a scan is not kept with it, bytes: measures are never larger, and the colours of
/// an OBJ take some hundred bytes.
const BYTES_MAX: u64 = ord::BYTES_MAX as u64;

/// How many files beside a scan are kept with it. A scanner writes one of each ending; there can be
/// hundreds of names that differ only in letter case or separators.
const FILES_MAX: usize = 8;

/// The most that the files beside a scan may take together, bytes: less than a scan itself.
const ALL_BYTES_MAX: u64 = 4 * BYTES_MAX;

/// A scan and the files that belong to it, as one look found them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Group {
    /// The state of the scan itself.
    pub stamp: Stamp,
    /// The files beside it that are kept with it, in name order.
    pub companions: Vec<Companion>,
    /// How many files beside it are not kept, because they are too large or too many.
    pub left_out: usize,
    /// There are files beside it that could equally belong to another scan under the same stem: they are
    /// kept with neither.
    pub is_shared: bool,
    /// Whether the scanner has marked it as finished.
    pub done: Done,
}

/// A file beside a scan.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Companion {
    pub path: PathBuf,
    /// Its state.
    pub stamp: Stamp,
    /// The ending under which it is kept beside the scan, numbered from the second of the same ending
    /// on: `ord`, `2.ord`.
    pub name_ending: String,
}

/// Whether the scanner has marked a scan as finished.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Done {
    /// This scanner writes no done file.
    NotAsked,
    Missing,
    /// The done file exists, in this state.
    There(Stamp),
}

impl From<Stamp> for Group {
    /// A scan on its own.
    fn from(stamp: Stamp) -> Group {
        Group { stamp, companions: Vec::new(), left_out: 0, is_shared: false, done: Done::NotAsked }
    }
}

/// Whether a file of this name is kept with a scan and is not a scan itself.
pub fn is_companion(name: &OsStr) -> bool {
    ord::parted(name.as_bytes())
        .is_some_and(|(_, ending)| ENDINGS.iter().any(|known| known.as_bytes() == ending))
}

/// Whether a companion may name the patient of a scan: it was created or rewritten since the previous
/// scan under this stem was taken with the companion as `used`. A change of its name, mode or links does
/// not count.
pub fn is_fresh(companion: &Stamp, used: Option<&Stamp>) -> bool {
    used.is_none_or(|used| !companion.has_content_of(used))
}

/// The disk space of a scan and the files kept with it, bytes.
pub fn bytes(scan: &Stamp, companions: &[Companion]) -> u64 {
    companions.iter().fold(scan.size, |sum, file| sum.saturating_add(file.stamp.size))
}

/// The scans of a look with the files that belong to each; `done` gives the state of each scan's done
/// file.
pub fn groups(
    scans: BTreeMap<PathBuf, Stamp>,
    companions: BTreeMap<PathBuf, Stamp>,
    done: impl Fn(&Path) -> Done,
) -> BTreeMap<PathBuf, Group> {
    let mut beside: BTreeMap<Stem, Beside> = BTreeMap::new();
    for (path, stamp) in companions {
        if let Some(stem) = stem(&path) {
            beside.entry(stem).or_default().files.push((path, stamp));
        }
    }
    for stem in scans.keys().filter_map(|path| stem(path)) {
        beside.entry(stem).and_modify(|beside| beside.scans += 1);
    }
    let grouped = scans.into_iter().map(|(path, stamp)| {
        let group = Group { done: done(&path), ..Group::from(stamp) };
        let group = match stem(&path).and_then(|stem| beside.get(&stem)) {
            None => group,
            Some(beside) if beside.scans > 1 => Group { is_shared: true, ..group },
            Some(beside) => {
                let (companions, left_out) = kept(&beside.files);
                Group { companions, left_out, ..group }
            }
        };
        (path, group)
    });
    grouped.collect()
}

/// The folder of a file and the stem that files of one scan share.
type Stem = (PathBuf, Vec<u8>);

/// The files under a stem.
#[derive(Debug, Default)]
struct Beside {
    /// The files that are not scans, in name order.
    files: Vec<(PathBuf, Stamp)>,
    scans: usize,
}

fn stem(path: &Path) -> Option<Stem> {
    let (stem, _) = ord::parted(path.file_name()?.as_bytes())?;
    Some((path.parent()?.to_owned(), stem))
}

/// Which of the files beside a scan are kept with it, in name order, and how many are not.
fn kept(files: &[(PathBuf, Stamp)]) -> (Vec<Companion>, usize) {
    let is_measures = |file: &Companion| file.name_ending.ends_with(ENDINGS[0]);
    // Measures first: if there are two of them, both must be kept, so that neither is trusted.
    let (measures, others): (Vec<_>, Vec<_>) = named(files).into_iter().partition(is_measures);
    let (mut kept, mut bytes): (Vec<Companion>, u64) = (Vec::new(), 0);
    for file in measures.into_iter().chain(others) {
        let size = file.stamp.size;
        let is_small = size <= BYTES_MAX && bytes + size <= ALL_BYTES_MAX;
        if is_small && kept.len() < FILES_MAX {
            bytes += size;
            kept.push(file);
        }
    }
    kept.sort_by(|a, b| a.path.cmp(&b.path));
    let left_out = files.len() - kept.len();
    (kept, left_out)
}

fn named(files: &[(PathBuf, Stamp)]) -> Vec<Companion> {
    let mut counts: BTreeMap<String, u32> = BTreeMap::new();
    let mut companions = Vec::with_capacity(files.len());
    for (path, stamp) in files {
        let ending = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
        let count = counts.entry(ending.clone()).or_default();
        *count += 1;
        let name_ending = if *count == 1 { ending } else { format!("{count}.{ending}") };
        companions.push(Companion { path: path.clone(), stamp: *stamp, name_ending });
    }
    companions
}

/// How a scan's done file is named: `{name}` stands for the scan's whole file name, `{stem}` for the
/// name without its ending.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DoneFile(String);

impl DoneFile {
    /// Parses a rule; `None` if it has no placeholder, contains a folder, or would name a done file that
    /// is taken for a scan.
    pub fn new(text: &str) -> Option<DoneFile> {
        let bare = text.replace("{name}", "").replace("{stem}", "");
        let is_valid = bare.len() < text.len()
            && !bare.contains(['/', '{', '}'])
            && !bare.contains(char::is_control);
        let rule = DoneFile(text.to_owned());
        let name = rule.of(Path::new("a.obj"));
        (is_valid && Format::of_file_name(&name.to_string_lossy()).is_err()).then_some(rule)
    }

    /// The done file of a scan.
    pub fn of(&self, scan: &Path) -> PathBuf {
        let name = scan.file_name().unwrap_or_default();
        let stem = scan.file_stem().unwrap_or_default();
        let parts = pieces(&self.0).map(|piece| match piece {
            Piece::Words(words) => OsStr::new(words),
            Piece::Place { name: "stem", .. } => stem,
            Piece::Place { .. } => name,
        });
        scan.with_file_name(parts.collect::<OsString>())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stamp(ino: u64) -> Stamp {
        Stamp { dev: 1, ino, size: 1, mtime_ns: 0, ctime_ns: 0 }
    }

    fn files(names: &[&str]) -> BTreeMap<PathBuf, Stamp> {
        (1..).zip(names).map(|(ino, name)| (PathBuf::from(name), stamp(ino))).collect()
    }

    #[test]
    fn files_of_one_stem_in_one_folder_belong_together() {
        let scans = files(&["/e/a b.obj", "/e/c.ply", "/f/a b.obj"]);
        let beside = files(&["/e/a+b.ORD", "/e/a_b.ord", "/e/a b.mtl", "/e/c.ord", "/e/d.ord"]);
        let groups = groups(scans, beside, |_| Done::NotAsked);
        let of = |scan: &str| -> Vec<(&str, &str)> {
            let files = &groups[Path::new(scan)].companions;
            files.iter().map(|c| (c.path.to_str().unwrap(), c.name_ending.as_str())).collect()
        };
        assert_eq!(
            of("/e/a b.obj"),
            [("/e/a b.mtl", "mtl"), ("/e/a+b.ORD", "ord"), ("/e/a_b.ord", "2.ord")]
        );
        assert_eq!(of("/e/c.ply"), [("/e/c.ord", "ord")]);
        assert_eq!(of("/f/a b.obj"), []);
    }

    #[test]
    fn what_may_belong_to_two_scans_belongs_to_neither() {
        let scans = files(&["/e/a b.obj", "/e/a_b.obj", "/e/c.ply", "/e/c.stl", "/e/d.obj"]);
        let scans = scans.into_iter().chain(files(&["/f/c.ply", "/f/c c.ply", "/f/c+c.ply"]));
        let beside = files(&["/e/a b.ord", "/e/a+b.mtl", "/e/c.ord", "/e/d.ord", "/f/c.ord"]);
        let groups = groups(scans.collect(), beside, |_| Done::NotAsked);
        let told = |scan: &str| {
            let group = &groups[Path::new(scan)];
            (group.is_shared, group.companions.len(), group.left_out)
        };
        for scan in ["/e/a b.obj", "/e/a_b.obj", "/e/c.ply", "/e/c.stl"] {
            assert_eq!(told(scan), (true, 0, 0), "{scan}");
        }
        for scan in ["/e/d.obj", "/f/c.ply"] {
            assert_eq!(told(scan), (false, 1, 0), "{scan}");
        }
        assert_eq!(told("/f/c c.ply"), (false, 0, 0), "nothing lies beside the two");
    }

    /// Groups a scan of 10 bytes with this many files of measures and of colours, of `size` bytes each.
    /// Returns how many of both are kept, how many are not, and the bytes of the scan and what is kept.
    fn bounded(measures: usize, colours: usize, size: u64) -> (usize, usize, usize, u64) {
        let name = |ending: &str, n: usize| format!("/e/{}.{ending}", "a_".repeat(20) + &spelt(n));
        let names = (0..measures).map(|n| name("ord", n));
        let names = names.chain((0..colours).map(|n| name("mtl", n)));
        let stamp = |size| Stamp { size, ..stamp(1) };
        let beside: BTreeMap<_, _> = names.map(|name| (name.into(), stamp(size))).collect();
        assert_eq!(beside.len(), measures + colours);
        let scan = PathBuf::from(format!("/e/{}.obj", "a_".repeat(20) + &spelt(0)));
        let scans = BTreeMap::from([(scan.clone(), stamp(10))]);
        let group = groups(scans, beside, |_| Done::NotAsked).remove(&scan).unwrap();
        let kept = group.companions.iter().filter(|file| file.name_ending.ends_with("ord"));
        let kept = kept.count();
        let colours = group.companions.len() - kept;
        (kept, colours, group.left_out, bytes(&group.stamp, &group.companions))
    }

    /// A number written in separators, which are all the same in a stem.
    fn spelt(n: usize) -> String {
        (0..10).map(|bit| if n >> bit & 1 == 1 { ' ' } else { '+' }).collect()
    }

    #[test]
    fn what_is_kept_with_a_scan_is_bounded_in_number_and_size_before_anything_is_read() {
        assert_eq!(bounded(1, 1, 100), (1, 1, 0, 210));
        assert_eq!(bounded(0, 8, 1000), (0, 8, 0, 8010));
        assert_eq!(bounded(0, 9, 1000), (0, 8, 1, 8010));
        assert_eq!(bounded(0, 1000, BYTES_MAX), (0, 4, 996, 10 + ALL_BYTES_MAX));
        assert_eq!(bounded(0, 1, BYTES_MAX + 1), (0, 0, 1, 10));
    }

    #[test]
    fn two_files_of_measures_are_both_kept_however_much_else_there_is() {
        assert_eq!(bounded(2, 900, 1), (2, 6, 894, 18));
        assert_eq!(bounded(2, 900, BYTES_MAX), (2, 2, 898, 10 + ALL_BYTES_MAX));
    }

    #[test]
    fn a_companion_is_fresh_once_it_is_made_or_written_anew() {
        let used = Stamp { dev: 1, ino: 2, size: 3, mtime_ns: 4, ctime_ns: 5 };
        let cases = [
            (used, false, "nothing"),
            (Stamp { ctime_ns: 6, ..used }, false, "chmod or link"),
            (Stamp { mtime_ns: 6, ..used }, true, "the same size written"),
            (Stamp { mtime_ns: 3, ..used }, true, "an older time restored"),
            (Stamp { size: 4, ..used }, true, "grown"),
            (Stamp { ino: 3, ..used }, true, "another file"),
            (Stamp { dev: 2, ..used }, true, "another disk"),
        ];
        for (now, fresh, what) in cases {
            assert_eq!(is_fresh(&now, Some(&used)), fresh, "{what}");
        }
        assert!(is_fresh(&used, None), "no scan had it before");
    }

    #[test]
    fn companions_are_told_by_their_ending_in_any_letter_case() {
        for (name, is) in [("a.ord", true), ("a.b.MTL", true), ("a.obj", false), ("ord", false)] {
            assert_eq!(is_companion(OsStr::new(name)), is, "{name}");
        }
    }

    #[test]
    fn a_done_file_is_called_after_the_name_or_the_stem() {
        let of = |rule: &str| DoneFile::new(rule).unwrap().of(Path::new("/e/a.b.obj"));
        assert_eq!(of("{name}.done"), Path::new("/e/a.b.obj.done"));
        assert_eq!(of("{stem}.ord"), Path::new("/e/a.b.ord"));
        assert_eq!(of(".{stem}-{name}.ok"), Path::new("/e/.a.b-a.b.obj.ok"));
        let odd = Path::new(OsStr::from_bytes(b"/e/\xff.obj"));
        let done = DoneFile::new("{name}.done").unwrap().of(odd);
        assert_eq!(done.as_os_str().as_bytes(), b"/e/\xff.obj.done");
    }

    #[test]
    fn a_rule_that_names_no_file_of_its_own_is_none() {
        for text in
            ["", "done", "{name}", "{stem}.txt", "x/{name}", "{who}.done", "{name", "{name}}"]
        {
            assert_eq!(DoneFile::new(text), None, "{text}");
        }
    }
}
