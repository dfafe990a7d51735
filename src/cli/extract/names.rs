//! How `gaiter extract` calls its scans: by their paths within the folder that holds them all.

use std::path::{Path, PathBuf};

use crate::cli::terminal_safe;

/// The folder that holds all scans, and the name of each within it.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Names {
    folder: PathBuf,
}

impl Names {
    /// The names for these scans.
    pub fn for_scans<'a>(scans: impl Iterator<Item = &'a Path>) -> Names {
        let folders = scans.map(|scan| scan.parent().unwrap_or(Path::new("")).to_owned());
        Names { folder: folders.reduce(|a, b| common(&a, &b)).unwrap_or_default() }
    }

    /// The folder, safe to print; `None` if it is the current one.
    pub fn folder(&self) -> Option<String> {
        let is_here = self.folder.as_os_str().is_empty() || self.folder == Path::new(".");
        (!is_here).then(|| terminal_safe(self.folder.display()))
    }

    /// The name of one of the scans, safe to print.
    pub fn name(&self, scan: &Path) -> String {
        terminal_safe(scan.strip_prefix(&self.folder).unwrap_or(scan).display())
    }
}

/// The deepest folder that two folders have in common.
fn common(a: &Path, b: &Path) -> PathBuf {
    a.components().zip(b.components()).take_while(|(a, b)| a == b).map(|(a, _)| a).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(scans: &[&str]) -> (Option<String>, Vec<String>) {
        let names = Names::for_scans(scans.iter().map(Path::new));
        (names.folder(), scans.iter().map(|scan| names.name(Path::new(scan))).collect())
    }

    #[test]
    fn the_folder_of_all_scans_is_said_once_and_the_names_are_what_differs() {
        let pair = |folder: &str, names: &[&str]| {
            (Some(folder.to_owned()), names.iter().map(|name| (*name).to_owned()).collect())
        };
        assert_eq!(names(&["/day/a.obj"]), pair("/day", &["a.obj"]));
        assert_eq!(names(&["day/a.obj", "day/in/b.obj"]), pair("day", &["a.obj", "in/b.obj"]));
        assert_eq!(names(&["/x/a.obj", "/y/b.obj"]), pair("/", &["x/a.obj", "y/b.obj"]));
        let here = vec!["a.obj".to_owned(), "in/b.obj".to_owned()];
        assert_eq!(names(&["a.obj", "in/b.obj"]), (None, here));
    }
}
