//! The orders of practice software that were handled and are still in their folder.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::os::unix::ffi::OsStrExt;
use std::path::{Path, PathBuf};

use gaiter_flow::OrderState;
use gaiter_flow::orders::FolderId;
use rusqlite::{Row, params};

use super::meta::{fact, set_fact};
use super::row::{all, cell, first, run};
use super::{Journal, JournalError};

/// The name of the fact: the folder in which the known orders were seen.
const FOLDER: &str = "orders-folder";

impl Journal {
    /// The order that was handled under this name; `None` if there was none or it is gone.
    pub fn order_known(&self, path: &Path) -> Result<Option<OrderState>, JournalError> {
        let known = "SELECT size, mtime_ns, digest FROM orders WHERE path = ?1";
        first(&self.connection(), known, [key(path)], state)
    }

    /// Records that an order is about to be handled or was skipped: it is not handled again.
    pub fn order_handled(&self, path: &Path, state: &OrderState) -> Result<(), JournalError> {
        let OrderState { size, mtime_ns, digest } = state;
        let size = i64::try_from(*size).unwrap_or(i64::MAX);
        run(
            &self.connection(),
            "INSERT INTO orders (path, size, mtime_ns, digest) VALUES (?1, ?2, ?3, ?4)
             ON CONFLICT (path) DO UPDATE SET size = ?2, mtime_ns = ?3, digest = ?4",
            params![key(path), size, mtime_ns.to_string(), digest],
        )
    }

    /// The known orders of a folder.
    pub fn orders_known(
        &self,
        folder: &Path,
    ) -> Result<BTreeMap<PathBuf, OrderState>, JournalError> {
        let known = "SELECT size, mtime_ns, digest, path FROM orders";
        let known = all(&self.connection(), known, [], |row| {
            let path: Vec<u8> = row.get(3)?;
            Ok((PathBuf::from(OsStr::from_bytes(&path)), state(row)?))
        })?;
        Ok(known.into_iter().filter(|(path, _)| path.parent() == Some(folder)).collect())
    }

    /// Forgets orders that are gone: a file that comes under the same name is a new order.
    pub fn forget_orders(&self, paths: &[&Path]) -> Result<(), JournalError> {
        if paths.is_empty() {
            return Ok(());
        }
        self.change(|transaction| {
            for path in paths {
                transaction.execute("DELETE FROM orders WHERE path = ?1", [key(path)])?;
            }
            Ok(())
        })
    }

    /// The folder in which the known orders were seen.
    pub fn orders_folder(&self) -> Result<Option<FolderId>, JournalError> {
        fact(&self.connection(), FOLDER, |text| {
            let (device, inode) = text.split_once(':')?;
            Some((device.parse().ok()?, inode.parse().ok()?))
        })
    }

    /// Records the folder in which the known orders were seen.
    pub fn orders_seen_in(&self, (device, inode): FolderId) -> Result<(), JournalError> {
        set_fact(&self.connection(), FOLDER, &format!("{device}:{inode}"))
    }
}

/// An order's state in the first three columns of a row.
fn state(row: &Row<'_>) -> Result<OrderState, JournalError> {
    let size: i64 = row.get(0)?;
    let mtime_ns = cell(row, 1, |text| text.parse().ok())?;
    Ok(OrderState { size: size.unsigned_abs(), mtime_ns, digest: row.get(2)? })
}

fn key(path: &Path) -> &[u8] {
    path.as_os_str().as_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state(mtime_ns: i128) -> OrderState {
        OrderState { size: 3, mtime_ns, digest: "d".into() }
    }

    #[test]
    fn a_known_order_is_known_until_it_is_forgotten_and_only_in_its_folder() {
        let dir = tempfile::tempdir().unwrap();
        let journal = Journal::open(&dir.path().join("journal.db")).unwrap();
        let (a, b) = (Path::new("/orders/a.gdt"), Path::new("/orders/sub/b.gdt"));
        for mtime_ns in [1, -2] {
            journal.order_handled(a, &state(mtime_ns)).unwrap();
            assert_eq!(journal.order_known(a).unwrap(), Some(state(mtime_ns)));
        }
        journal.order_handled(b, &state(3)).unwrap();
        let known = journal.orders_known(Path::new("/orders")).unwrap();
        assert_eq!(known, BTreeMap::from([(a.to_owned(), state(-2))]));
        journal.forget_orders(&[a]).unwrap();
        assert_eq!(journal.order_known(a).unwrap(), None);
        assert_eq!(journal.order_known(b).unwrap(), Some(state(3)));
        assert_eq!(journal.orders_folder().unwrap(), None);
        journal.orders_seen_in((1, u64::MAX)).unwrap();
        assert_eq!(journal.orders_folder().unwrap(), Some((1, u64::MAX)));
    }
}
