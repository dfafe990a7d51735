//! The orders of practice software that were handled and are still in their folder.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::os::unix::ffi::OsStrExt;
use std::path::{Path, PathBuf};

use gaiter_flow::OrderState;
use gaiter_flow::orders::FolderId;
use rusqlite::{Row, params};

use super::meta::{fact, set_fact};
use super::row::{all, first, json_cell, json_text, of_json, run};
use super::{Journal, JournalError};

/// The name of the fact: the folder in which the known orders were seen.
const FOLDER: &str = "orders-folder";

impl Journal {
    /// The order that was handled under this name; `None` if there was none or it is gone.
    pub fn order_known(&self, path: &Path) -> Result<Option<OrderState>, JournalError> {
        let known = "SELECT state FROM orders WHERE path = ?1";
        first(&self.connection(), known, [key(path)], state)
    }

    /// Records that an order is about to be handled or was skipped: it is not handled again.
    pub fn order_handled(&self, path: &Path, state: &OrderState) -> Result<(), JournalError> {
        let OrderState { size, mtime_ns, digest } = state;
        let handled = "INSERT INTO orders (path, state) VALUES (?1, ?2)
                       ON CONFLICT (path) DO UPDATE SET state = ?2";
        let state = json_text(&(size, mtime_ns, digest))?;
        run(&self.connection(), handled, params![key(path), state])
    }

    /// The known orders of a folder.
    pub fn orders_known(
        &self,
        folder: &Path,
    ) -> Result<BTreeMap<PathBuf, OrderState>, JournalError> {
        let known = "SELECT state, path FROM orders";
        let known = all(&self.connection(), known, [], |row| {
            let path: Vec<u8> = row.get(1)?;
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
        fact(&self.connection(), FOLDER, of_json)
    }

    /// Records the folder in which the known orders were seen.
    pub fn orders_seen_in(&self, folder: FolderId) -> Result<(), JournalError> {
        set_fact(&self.connection(), FOLDER, &json_text(&folder)?)
    }
}

/// An order's state in the first column of a row.
fn state(row: &Row<'_>) -> Result<OrderState, JournalError> {
    let (size, mtime_ns, digest) = json_cell(row, 0)?;
    Ok(OrderState { size, mtime_ns, digest })
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
