//! Cases: files with the words that are expected of each beside it.

#![allow(clippy::unwrap_used)]

use std::path::PathBuf;
use std::{env, fs};

/// The files of folders of the project that end so, sorted; fewer than `min`, and a folder was not found.
pub fn with_ending(folders: &[&str], ending: &str, min: usize) -> Vec<PathBuf> {
    let files = folders.iter().flat_map(|folder| fs::read_dir(crate::root().join(folder)).unwrap());
    let mut cases: Vec<PathBuf> = files.map(|file| file.unwrap().path()).collect();
    cases.retain(|path| path.extension().is_some_and(|found| found == ending));
    cases.sort();
    assert!(cases.len() >= min, "only {} cases were found", cases.len());
    cases
}

/// Holds the words about each case against its file of expected words; `GAITER_RENEW=1` writes the files
/// anew.
pub fn are_as_expected(cases: impl IntoIterator<Item = (PathBuf, String)>) {
    let renew = env::var_os("GAITER_RENEW").is_some();
    let mut wrong = String::new();
    for (beside, said) in cases {
        if renew {
            fs::write(&beside, &said).unwrap();
        }
        let expected = fs::read_to_string(&beside).unwrap_or_default();
        if said != expected {
            let name = beside.display();
            wrong += &format!("--- {name}: expected\n{expected}--- {name}: said\n{said}");
        }
    }
    assert!(wrong.is_empty(), "\n{wrong}");
}
