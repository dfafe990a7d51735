//! The indexer: what stations announce becomes rows and jobs. There may be several.

use std::collections::BTreeMap;
use std::thread;
use std::time::Duration;

use gaiter_https::{Bucket, BucketFault, Listed};
use gaiter_leg::Method;
use gaiter_record::archive::{
    Announcement, Document, DocumentFault, Heartbeat, KeyFault, MethodId, ObjectKey, PackingFault,
    ScanResult, Withdrawal, unpacked,
};
use postgres::Client;

use crate::config::ArchiveConfig;
use crate::database::{self, Then};
use crate::fault::{ArchiveFault, chain};
use crate::note;
use crate::objects::{bucket, each_page};

/// How often the inbox is looked through.
const PAUSE: Duration = Duration::from_secs(10);

/// The longest result, bytes, not packed: a record has a few hundred thousand.
pub const RESULT_MOST: u64 = 64 << 20;

/// Which pass through the bucket it is.
#[derive(Debug, Clone, Copy)]
enum Pass {
    /// The first: tables, method and missing jobs are made.
    First {
        /// From all objects, not only those of the inbox.
        reconcile: bool,
    },
    /// Any other: what is new is indexed.
    Later,
}

/// Why an object is not indexed. Others are.
#[derive(Debug, thiserror::Error)]
pub enum Unread {
    /// Its key is none of ours.
    #[error(transparent)]
    Key(#[from] KeyFault),
    /// Its content is not what its key says.
    #[error(transparent)]
    Document(#[from] DocumentFault),
    /// It cannot be unpacked.
    #[error(transparent)]
    Packing(#[from] PackingFault),
    #[error("it is no longer there")]
    Gone,
}

/// Indexes what stations announce. Without `once` it continues, and waits for servers that are away.
///
/// # Errors
/// With `once`: whatever keeps it from indexing.
pub fn index(config: &ArchiveConfig, reconcile: bool, once: bool) -> Result<(), ArchiveFault> {
    let method = MethodId::of(&Method::default())?;
    let mut next = Pass::First { reconcile };
    let mut indexed = IndexedHeartbeats::default();
    loop {
        match pass(config, &method, next, &mut indexed) {
            Ok(()) => next = Pass::Later,
            Err(fault) if once => return Err(fault),
            Err(fault) => note(format_args!("index: {}", chain(&fault))),
        }
        if once {
            return Ok(());
        }
        thread::sleep(PAUSE);
    }
}

fn pass(
    config: &ArchiveConfig,
    method: &MethodId,
    which: Pass,
    indexed: &mut IndexedHeartbeats,
) -> Result<(), ArchiveFault> {
    let mut client = database::connect(&config.database)?;
    let bucket = bucket(config);
    if let Pass::First { reconcile } = which {
        database::make_schema(&mut client)?;
        if reconcile {
            each_page(&bucket, ObjectKey::ANNOUNCED, |listed| {
                announcements(&bucket, &mut client, method, listed, Then::Wait).map(drop)
            })?;
            each_page(&bucket, ObjectKey::RESULTS, |listed| results(&bucket, &mut client, listed))?;
        }
        database::enter_method(&mut client, method)?;
        database::enter_missing_jobs(&mut client, method)?;
    }
    each_page(&bucket, ObjectKey::INBOX, |listed| {
        let indexed = announcements(&bucket, &mut client, method, listed, Then::Measure)?;
        indexed.into_iter().try_for_each(|(key, bytes)| file_away(&bucket, &key, bytes))
    })?;
    each_page(&bucket, ObjectKey::FLEET, |listed| heartbeats(&bucket, &mut client, listed, indexed))
}

/// Enters what stations announced or took back. Returns the keys and bytes of what was entered.
fn announcements(
    bucket: &Bucket,
    client: &mut Client,
    method: &MethodId,
    listed: &[Listed],
    then: Then,
) -> Result<Vec<(String, Vec<u8>)>, ArchiveFault> {
    let mut entered = Vec::new();
    for Listed { key, .. } in listed {
        let Some(bytes) = bucket.get(key)? else { continue };
        // Wherever it lies, it is what was in the inbox.
        let own = key.replacen(ObjectKey::ANNOUNCED, ObjectKey::INBOX, 1);
        let done = match own.parse::<ObjectKey>() {
            Ok(ObjectKey::Withdrawal { .. }) => read::<Withdrawal>(&own, &bytes)
                .map(|said| database::enter_withdrawal(client, &said)),
            _ => read::<Announcement>(&own, &bytes)
                .map(|said| database::enter_announcement(client, &said, method, then)),
        };
        match done {
            Ok(done) => done?,
            Err(why) => {
                passed_over(key, &why);
                continue;
            }
        }
        entered.push((key.clone(), bytes));
    }
    Ok(entered)
}

/// Moves an indexed announcement out of the inbox. Until it has gone from there it is indexed again, which changes
/// nothing.
fn file_away(bucket: &Bucket, key: &str, bytes: Vec<u8>) -> Result<(), ArchiveFault> {
    bucket.put_new(&key.replacen(ObjectKey::INBOX, ObjectKey::ANNOUNCED, 1), bytes)?;
    bucket.remove(key)?;
    Ok(())
}

/// The heartbeats that are indexed, each with its tag in the list. They change once a minute and the list comes more
/// often, so what has the tag that it had is not read again.
#[derive(Debug, Default)]
struct IndexedHeartbeats(BTreeMap<String, String>);

impl IndexedHeartbeats {
    /// Whether this one is indexed already. Without a tag nobody knows.
    fn has(&self, listed: &Listed) -> bool {
        listed.tag.is_some() && self.0.get(&listed.key) == listed.tag.as_ref()
    }

    /// Notes that one is indexed. If it was overwritten after it was listed, the next list has another tag.
    fn note(&mut self, Listed { key, tag }: &Listed) {
        if let Some(tag) = tag {
            self.0.insert(key.clone(), tag.clone());
        }
    }
}

fn heartbeats(
    bucket: &Bucket,
    client: &mut Client,
    listed: &[Listed],
    indexed: &mut IndexedHeartbeats,
) -> Result<(), ArchiveFault> {
    for object in listed {
        if indexed.has(object) {
            continue;
        }
        let Some(bytes) = bucket.get(&object.key)? else { continue };
        match read::<Heartbeat>(&object.key, &bytes) {
            Ok(beat) => database::enter_heartbeat(client, &beat)?,
            Err(why) => passed_over(&object.key, &why),
        }
        indexed.note(object);
    }
    Ok(())
}

fn results(bucket: &Bucket, client: &mut Client, listed: &[Listed]) -> Result<(), ArchiveFault> {
    for Listed { key, .. } in listed {
        match result_at(bucket, key)? {
            Ok(result) => {
                database::enter_method(client, &result.method)?;
                database::enter_result(client, &result)?;
            }
            Err(why) => passed_over(key, &why),
        }
    }
    Ok(())
}

/// The result in an object.
///
/// # Errors
/// Those of the store; within, why the object is no result.
pub fn result_at(bucket: &Bucket, key: &str) -> Result<Result<ScanResult, Unread>, BucketFault> {
    let Some(bytes) = bucket.get(key)? else { return Ok(Err(Unread::Gone)) };
    let bytes = unpacked(&bytes, RESULT_MOST).map_err(Unread::from);
    Ok(bytes.and_then(|bytes| read(key, &bytes)))
}

fn read<D: Document>(key: &str, bytes: &[u8]) -> Result<D, Unread> {
    let key: ObjectKey = key.parse()?;
    Ok(D::read_at(&key, bytes)?)
}

fn passed_over(key: &str, why: &Unread) {
    // A key may hold anything; what is not one of ours is not told.
    let shown = if key.is_ascii() && !key.contains(char::is_control) { key } else { "an object" };
    note(format_args!("index: {shown}: {}", chain(why)));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_heartbeat_is_read_again_only_if_its_tag_in_the_list_is_another() {
        let listed = |key: &str, tag: Option<&str>| Listed {
            key: key.to_owned(),
            tag: tag.map(str::to_owned),
        };
        let mut indexed = IndexedHeartbeats::default();
        let first = listed("fleet/booth-1.json", Some("0b"));
        assert!(!indexed.has(&first));
        indexed.note(&first);
        assert!(indexed.has(&first));
        let other = listed("fleet/booth-2.json", Some("0b"));
        let next = listed("fleet/booth-1.json", Some("0c"));
        assert!(!indexed.has(&other) && !indexed.has(&next));
        indexed.note(&next);
        assert!(indexed.has(&next) && !indexed.has(&first));
        let untold = listed("fleet/booth-1.json", None);
        indexed.note(&untold);
        assert!(!indexed.has(&untold));
    }
}
