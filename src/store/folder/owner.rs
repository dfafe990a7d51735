//! Whose a patient's folder is: one person, one folder. A folder that is a link leads elsewhere, maybe
//! to another patient's. If names differ only in letter case, a file system, or a person, may confuse
//! them. Both are refused: records of two people must never be merged.

use std::fs;
use std::io;
use std::path::PathBuf;

use gaiter_flow::patient::naming;

use super::FolderStore;
use crate::store::{Misfit, StoreFault, durable, tried};

impl FolderStore {
    /// The patient's folder, made durable under the root.
    pub(super) fn patient_folder(&self, patient: Option<&str>) -> Result<PathBuf, StoreFault> {
        let name = naming::patient_folder(patient);
        let folder = self.root.join(&name);
        let is_new = match fs::symlink_metadata(&folder) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => true,
            found => {
                refuse_link(&tried("examining", &folder, found)?)?;
                false
            }
        };
        tried("making the folder", &folder, self.access.make_folder_once(&folder))?;
        if patient.is_some_and(has_case)
            && let Standing::Mistakable = self.standing(&name)?
        {
            if is_new {
                // This removes only an empty folder; another station may be using it.
                let _ = fs::remove_dir(&folder);
            }
            return Err(StoreFault::Permanent(Misfit::FolderClash));
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
        match fs::symlink_metadata(&folder) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            found => refuse_link(&tried("examining", &folder, found)?)?,
        }
        // If the file system ignores case, the folder found may be another patient's.
        let is_own = !patient.is_some_and(has_case) || self.is_listed(&name)?;
        Ok(is_own.then_some(folder))
    }

    fn standing(&self, name: &str) -> Result<Standing, StoreFault> {
        Ok(standing(name, &self.listed()?))
    }

    fn is_listed(&self, name: &str) -> Result<bool, StoreFault> {
        Ok(self.listed()?.iter().any(|listed| listed == name))
    }

    /// The names in the store that are UTF-8, as all of ours are.
    fn listed(&self) -> Result<Vec<String>, StoreFault> {
        let list = || -> io::Result<Vec<String>> {
            let names = fs::read_dir(&self.root)?.map(|entry| Ok(entry?.file_name()));
            let names =
                names.filter_map(|name| name.map(|name| name.into_string().ok()).transpose());
            names.collect()
        };
        tried("listing", &self.root, list())
    }
}

fn refuse_link(found: &fs::Metadata) -> Result<(), StoreFault> {
    match found.is_symlink() {
        true => Err(StoreFault::Permanent(Misfit::FolderIsLink)),
        false => Ok(()),
    }
}

/// How a folder's name compares with the other names in its store.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Standing {
    /// It is there under its name, and no other name is like it.
    Alone,
    /// It is there under another name, or beside one that differs only in letter case.
    Mistakable,
}

/// How the name of a folder that was just made compares with the names that are listed then.
fn standing(name: &str, listed: &[String]) -> Standing {
    let own = folded(name);
    let is_other = |other: &&String| {
        *other != name && (other.eq_ignore_ascii_case(name) || folded(other) == own)
    };
    let is_there = listed.iter().any(|listed| listed == name);
    if is_there && !listed.iter().any(|other| is_other(&other)) {
        Standing::Alone
    } else {
        Standing::Mistakable
    }
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
        assert_eq!(standing("P1", &listed(&alone)), Standing::Alone);
        assert_eq!(standing("P1", &listed(&["P1", "p1"])), Standing::Mistakable);
        assert_eq!(standing("p1", &listed(&["P1"])), Standing::Mistakable, "it was made as P1");
        // Ä and ä, whose bytes are in the name.
        assert_eq!(standing("%C3%84", &listed(&["%C3%84", "%C3%A4"])), Standing::Mistakable);
        assert_eq!(standing("a%2F", &listed(&["a%2F", "a%2f"])), Standing::Mistakable);
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
                if has_case(&id) && standing(&name, &disk.listed()) != Standing::Alone {
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
                prop_assert_eq!(standing(&names[1], &names), Standing::Mistakable);
            }
            prop_assert_eq!(standing(&names[0], &names[..1]), Standing::Alone);
        }
    }
}
