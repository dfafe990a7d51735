//! Whose a patient's folder is: one person, one folder. A folder that is a link leads elsewhere, maybe
//! to another patient's. If names differ only in letter case, a file system, or a person, may confuse
//! them. Both are refused: records of two people must never be merged.

use std::fs;
use std::path::{Path, PathBuf};

use gaiter_flow::patient::naming;

use super::FolderStore;
use crate::store::{Rejection, StoreFault, durable, listed, tried};

impl FolderStore {
    /// The patient's folder, made durable under the root.
    pub(super) fn patient_folder(&self, patient: Option<&str>) -> Result<PathBuf, StoreFault> {
        let name = naming::patient_folder(patient);
        let folder = self.root.join(&name);
        let is_new = !exists_and_is_no_link(&folder)?;
        tried("making the folder", &folder, self.access.make_folder_once(&folder))?;
        if patient.is_some_and(has_case) && is_mistakable(&name, &self.listed()?) {
            if is_new {
                // This removes only an empty folder; another station may be using it.
                let _ = fs::remove_dir(&folder);
            }
            return Err(StoreFault::Permanent(Rejection::FolderClash));
        }
        tried("syncing", &self.root, durable::sync_folder(&self.root))?;
        Ok(folder)
    }

    /// The patient's folder; `None` if there is no folder of exactly this name.
    pub(in crate::store) fn own_folder(
        &self,
        patient: Option<&str>,
    ) -> Result<Option<PathBuf>, StoreFault> {
        let name = naming::patient_folder(patient);
        let folder = self.root.join(&name);
        if !exists_and_is_no_link(&folder)? {
            return Ok(None);
        }
        // If the file system ignores case, the folder found may be another patient's.
        let is_own = !patient.is_some_and(has_case) || self.listed()?.contains(&name);
        Ok(is_own.then_some(folder))
    }

    /// The names in the store that are UTF-8, as all of ours are.
    fn listed(&self) -> Result<Vec<String>, StoreFault> {
        let entries = listed(&self.root)?.into_iter();
        Ok(entries.filter_map(|entry| entry.file_name().into_string().ok()).collect())
    }
}

/// Whether there is a folder of this name. One that is a link is refused.
fn exists_and_is_no_link(folder: &Path) -> Result<bool, StoreFault> {
    let found = durable::if_there(fs::symlink_metadata(folder));
    match tried("examining", folder, found)? {
        Some(found) if found.is_symlink() => Err(StoreFault::Permanent(Rejection::FolderIsLink)),
        found => Ok(found.is_some()),
    }
}

/// Whether a folder that was just made under this name is, among the names that are listed then, there under another
/// one, or beside one that differs only in letter case.
fn is_mistakable(name: &str, listed: &[String]) -> bool {
    let own = folded(name);
    let is_other = |other: &String| {
        other != name && (other.eq_ignore_ascii_case(name) || folded(other) == own)
    };
    !listed.iter().any(|listed| listed == name) || listed.iter().any(is_other)
}

/// Whose folder it is, ignoring the case of letters in the id; `None` for the unassigned.
fn folded(name: &str) -> Option<String> {
    let id = naming::patient_of_folder(name)??;
    Some(id.chars().flat_map(char::to_lowercase).collect())
}

/// Whether an id holds anything that has more than one case. Other ids cannot be confused.
fn has_case(id: &str) -> bool {
    id.chars()
        .any(|letter| !letter.to_lowercase().eq([letter]) || !letter.to_uppercase().eq([letter]))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use proptest::prelude::*;

    use super::*;

    /// A file system that ignores the case of ASCII letters and keeps the first name.
    #[derive(Default)]
    struct Caseless(BTreeMap<String, String>);

    impl Caseless {
        /// Makes a folder if there is none of that name. Returns the one that is then used.
        fn make(&mut self, name: &str) -> String {
            let folder = self.0.entry(name.to_ascii_lowercase()).or_insert_with(|| name.to_owned());
            folder.clone()
        }

        fn listed(&self) -> Vec<String> {
            self.0.values().cloned().collect()
        }
    }

    fn listed(names: &[&str]) -> Vec<String> {
        names.iter().map(|name| (*name).to_owned()).collect()
    }

    #[test]
    fn a_folder_is_alone_or_another_can_be_mistaken_for_it() {
        let alone = ["P1", "P2", "_unassigned", "readme", ".gaiter-store", "p12"];
        assert!(!is_mistakable("P1", &listed(&alone)));
        assert!(is_mistakable("P1", &listed(&["P1", "p1"])));
        assert!(is_mistakable("p1", &listed(&["P1"])), "it was made as P1");
        // Ä and ä, whose bytes are in the name.
        assert!(is_mistakable("%C3%84", &listed(&["%C3%84", "%C3%A4"])));
        assert!(is_mistakable("a%2F", &listed(&["a%2F", "a%2f"])));
    }

    #[test]
    fn what_has_no_case_is_not_looked_for() {
        for id in ["4711", "12-34", "1/2", "12 34"] {
            assert!(!has_case(id), "{id}");
        }
        for id in ["P1", "p1", "ä1", "Σ", "ß"] {
            assert!(has_case(id), "{id}");
        }
    }

    proptest! {
        #[test]
        fn different_ids_never_share_a_folder_that_knows_no_case(
            ids in proptest::collection::vec("[aAbB1äÄ/]{1,3}", 1..12),
        ) {
            let mut disk = Caseless::default();
            let mut owners: BTreeMap<String, String> = BTreeMap::new();
            for id in ids {
                let name = naming::patient_folder(Some(&id));
                let folder = disk.make(&name);
                if has_case(&id) && is_mistakable(&name, &disk.listed()) {
                    continue;
                }
                let owner = owners.entry(folder).or_insert_with(|| id.clone());
                prop_assert_eq!(&*owner, &id);
            }
        }

        #[test]
        fn the_first_of_ids_that_differ_in_case_only_keeps_its_folder_alone(
            id in "[a-zä]{1,4}", flips in 1_u8..15,
        ) {
            let other: String = id.chars().enumerate().map(|(at, letter)| {
                if flips >> at & 1 == 1 { letter.to_uppercase().next().unwrap() } else { letter }
            }).collect();
            let names = [&id, &other].map(|id| naming::patient_folder(Some(id)));
            if id != other {
                prop_assert!(is_mistakable(&names[1], &names));
            }
            prop_assert!(!is_mistakable(&names[0], &names[..1]));
        }
    }
}
