//! Files that belong together: a scan, what the scanner writes beside it under the same stem, and
//! the done file that says that the scanner has finished.

use std::collections::BTreeMap;
use std::ffi::{OsStr, OsString};
use std::os::unix::ffi::OsStrExt;
use std::path::{Path, PathBuf};

use super::stamp::Stamp;
use crate::scan::{Format, ord};

/// The endings of what scanners write beside a scan: their own measures, and the colours of an OBJ.
pub const ENDINGS: [&str; 2] = ["ord", "mtl"];

/// A scan and what belongs to it, as one look found them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Group {
    /// The state of the scan itself.
    pub stamp: Stamp,
    /// The files beside it, in name order.
    pub companions: Vec<Companion>,
    /// Whether the scanner has said that it is finished.
    pub done: Done,
}

/// A file beside a scan.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Companion {
    /// The file.
    pub path: PathBuf,
    /// Its state.
    pub stamp: Stamp,
    /// How it is kept beside the scan: its ending, numbered from the second of the same on:
    /// `ord`, `2.ord`.
    pub name_ending: String,
}

/// Whether the scanner has said that a scan is finished.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Done {
    /// This scanner says nothing.
    NotAsked,
    /// The done file is not there.
    Missing,
    /// The done file is there, in this state.
    There(Stamp),
}

impl From<Stamp> for Group {
    /// A scan alone.
    fn from(stamp: Stamp) -> Group {
        Group { stamp, companions: Vec::new(), done: Done::NotAsked }
    }
}

/// Whether a file of this name is kept with a scan rather than being one.
pub fn is_companion(name: &OsStr) -> bool {
    ord::parted(name.as_bytes())
        .is_some_and(|(_, ending)| ENDINGS.iter().any(|known| known.as_bytes() == ending))
}

/// The scans of a look with what belongs to each; `done` tells of each scan's done file.
pub fn groups(
    scans: BTreeMap<PathBuf, Stamp>,
    companions: BTreeMap<PathBuf, Stamp>,
    done: impl Fn(&Path) -> Done,
) -> BTreeMap<PathBuf, Group> {
    let mut beside: BTreeMap<Stem, Vec<(PathBuf, Stamp)>> = BTreeMap::new();
    for (path, stamp) in companions {
        if let Some(stem) = stem(&path) {
            beside.entry(stem).or_default().push((path, stamp));
        }
    }
    let grouped = scans.into_iter().map(|(path, stamp)| {
        let files = stem(&path).and_then(|stem| beside.get(&stem));
        let companions = named(files.map_or(&[], Vec::as_slice));
        let done = done(&path);
        (path, Group { stamp, companions, done })
    });
    grouped.collect()
}

/// The folder of a file and the stem that files of one scan share.
type Stem = (PathBuf, Vec<u8>);

fn stem(path: &Path) -> Option<Stem> {
    let (stem, _) = ord::parted(path.file_name()?.as_bytes())?;
    Some((path.parent()?.to_owned(), stem))
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

/// How a scan's done file is called: `{name}` stands for the scan's whole file name, `{stem}` for
/// the name without its ending.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DoneFile(String);

impl DoneFile {
    /// The rule that a text says; none where it says none: without a placeholder, with a folder in
    /// it, or so that a done file would be taken for a scan.
    pub fn new(text: &str) -> Option<DoneFile> {
        let bare = text.replace("{name}", "").replace("{stem}", "");
        let says = bare.len() < text.len()
            && !bare.contains(['/', '{', '}'])
            && !bare.contains(char::is_control);
        let rule = DoneFile(text.to_owned());
        let name = rule.of(Path::new("a.obj"));
        (says && Format::of_file_name(&name.to_string_lossy()).is_err()).then_some(rule)
    }

    /// The done file of a scan.
    pub fn of(&self, scan: &Path) -> PathBuf {
        let name = scan.file_name().unwrap_or_default();
        let stem = scan.file_stem().unwrap_or_default();
        let mut done = OsString::new();
        let mut rest = self.0.as_str();
        while let Some(open) = rest.find('{') {
            done.push(&rest[..open]);
            let end = rest[open..].find('}').map_or(rest.len(), |close| open + close + 1);
            done.push(if &rest[open..end] == "{stem}" { stem } else { name });
            rest = &rest[end..];
        }
        done.push(rest);
        scan.with_file_name(done)
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
        let scans = files(&["/e/a b.obj", "/e/c.ply", "/e/c.stl", "/f/a b.obj"]);
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
        assert_eq!(of("/e/c.stl"), [("/e/c.ord", "ord")]);
        assert_eq!(of("/f/a b.obj"), []);
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
