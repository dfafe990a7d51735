//! The orders of practice software that were handled and are still in their folder.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::os::unix::ffi::OsStrExt;
use std::path::{Path, PathBuf};

use gaiter_flow::OrderState;
use gaiter_flow::orders::news::FolderId;
use rusqlite::{OptionalExtension, Row, Transaction, params};

use super::{Journal, JournalError, cell};

/// The name of the fact: the folder in which the known orders were seen.
const FOLDER: &str = "orders-folder";

impl Journal {
    /// The order that was handled under this name; `None` if there was none or it is gone.
    pub fn order_known(&self, path: &Path) -> Result<Option<OrderState>, JournalError> {
        let connection = self.connection();
        let mut query = connection
            .prepare_cached("SELECT size, mtime_ns, digest FROM orders WHERE path = ?1")?;
        let mut rows = query.query([key(path)])?;
        rows.next()?.map(state).transpose()
    }

    /// Records that an order is about to be handled or was skipped: it is not handled again.
    pub fn order_heard(&self, path: &Path, state: &OrderState) -> Result<(), JournalError> {
        self.change(|transaction| heard(transaction, path, state))
    }

    /// Takes over what an older gaiter knew about an order: whether it has handled this file. The old
    /// entry is removed, so this works only once.
    pub fn order_sighted(&self, path: &Path, state: &OrderState) -> Result<bool, JournalError> {
        self.change(|transaction| {
            let stamp: Option<String> = transaction
                .query_row("SELECT stamp FROM sightings WHERE path = ?1", [key(path)], |row| {
                    row.get(0)
                })
                .optional()?;
            let Some(stamp) = stamp else { return Ok(false) };
            transaction.execute("DELETE FROM sightings WHERE path = ?1", [key(path)])?;
            // Device, inode, size and the two times; what changes with the file's mode does not count.
            let mut cells = stamp.split(':').skip(2);
            let size = cells.next().and_then(|text| text.parse().ok());
            let mtime_ns = cells.next().and_then(|text| text.parse().ok());
            let is_heard = (size, mtime_ns) == (Some(state.size), Some(state.mtime_ns));
            if is_heard {
                heard(transaction, path, state)?;
            }
            Ok(is_heard)
        })
    }

    /// The known orders of a folder.
    pub fn orders_known(
        &self,
        folder: &Path,
    ) -> Result<BTreeMap<PathBuf, OrderState>, JournalError> {
        let connection = self.connection();
        let mut query =
            connection.prepare_cached("SELECT size, mtime_ns, digest, path FROM orders")?;
        let (mut rows, mut known) = (query.query([])?, BTreeMap::new());
        while let Some(row) = rows.next()? {
            let path: Vec<u8> = row.get(3)?;
            let path = PathBuf::from(OsStr::from_bytes(&path));
            if path.parent() == Some(folder) {
                known.insert(path, state(row)?);
            }
        }
        Ok(known)
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
        let Some(text) = self.fact(FOLDER)? else { return Ok(None) };
        let read = |text: &str| {
            let (device, inode) = text.split_once(':')?;
            Some((device.parse().ok()?, inode.parse().ok()?))
        };
        cell("value", text, read).map(Some)
    }

    /// Records the folder in which the known orders were seen.
    pub fn orders_seen_in(&self, (device, inode): FolderId) -> Result<(), JournalError> {
        self.change(|transaction| {
            transaction.execute(
                "INSERT INTO meta (name, value) VALUES (?1, ?2)
                 ON CONFLICT (name) DO UPDATE SET value = excluded.value",
                [FOLDER, &format!("{device}:{inode}")],
            )?;
            Ok(())
        })
    }
}

/// An order's state in the first three columns of a row.
fn state(row: &Row<'_>) -> Result<OrderState, JournalError> {
    let (size, mtime_ns): (i64, String) = (row.get(0)?, row.get(1)?);
    let mtime_ns = cell("mtime_ns", mtime_ns, |text| text.parse().ok())?;
    Ok(OrderState { size: size.unsigned_abs(), mtime_ns, digest: row.get(2)? })
}

fn heard(
    transaction: &Transaction<'_>,
    path: &Path,
    state: &OrderState,
) -> Result<(), JournalError> {
    let OrderState { size, mtime_ns, digest } = state;
    let size = i64::try_from(*size).unwrap_or(i64::MAX);
    transaction.execute(
        "INSERT INTO orders (path, size, mtime_ns, digest) VALUES (?1, ?2, ?3, ?4)
         ON CONFLICT (path) DO UPDATE SET size = ?2, mtime_ns = ?3, digest = ?4",
        params![key(path), size, mtime_ns.to_string(), digest],
    )?;
    Ok(())
}

fn key(path: &Path) -> &[u8] {
    path.as_os_str().as_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;
    use gaiter_flow::Stamp;

    fn state(mtime_ns: i128) -> OrderState {
        OrderState { size: 3, mtime_ns, digest: "d".into() }
    }

    #[test]
    fn a_known_order_is_known_until_it_is_forgotten_and_only_in_its_folder() {
        let dir = tempfile::tempdir().unwrap();
        let journal = Journal::open(&dir.path().join("journal.db")).unwrap();
        let (a, b) = (Path::new("/orders/a.gdt"), Path::new("/orders/sub/b.gdt"));
        for mtime_ns in [1, -2] {
            journal.order_heard(a, &state(mtime_ns)).unwrap();
            assert_eq!(journal.order_known(a).unwrap(), Some(state(mtime_ns)));
        }
        journal.order_heard(b, &state(3)).unwrap();
        let known = journal.orders_known(Path::new("/orders")).unwrap();
        assert_eq!(known, BTreeMap::from([(a.to_owned(), state(-2))]));
        journal.forget_orders(&[a]).unwrap();
        assert_eq!(journal.order_known(a).unwrap(), None);
        assert_eq!(journal.order_known(b).unwrap(), Some(state(3)));
        assert_eq!(journal.orders_folder().unwrap(), None);
        journal.orders_seen_in((1, u64::MAX)).unwrap();
        assert_eq!(journal.orders_folder().unwrap(), Some((1, u64::MAX)));
    }

    #[test]
    fn what_an_older_gaiter_heard_is_known_once_and_not_what_was_written_since() {
        let dir = tempfile::tempdir().unwrap();
        let journal = Journal::open(&dir.path().join("journal.db")).unwrap();
        let (same, other) = (Path::new("/orders/a.gdt"), Path::new("/orders/b.gdt"));
        let stamp = Stamp { dev: 1, ino: 2, size: 3, mtime_ns: 4, ctime_ns: 5 };
        for path in [same, other] {
            journal.sighted(path, stamp, None).unwrap();
        }
        assert!(journal.order_sighted(same, &state(4)).unwrap());
        assert_eq!(journal.order_known(same).unwrap(), Some(state(4)));
        assert!(!journal.order_sighted(other, &state(6)).unwrap());
        assert_eq!(journal.order_known(other).unwrap(), None);
        // The old entry was used up: a later file is new.
        assert!(!journal.order_sighted(same, &state(4)).unwrap());
        assert!(!journal.order_sighted(other, &state(4)).unwrap());
    }
}
