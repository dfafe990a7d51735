//! The indexer: what stations announce becomes rows and jobs. There may be several.

use std::thread;
use std::time::Duration;

use gaiter_https::{Bucket, BucketFault};
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
    loop {
        match pass(config, &method, next) {
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

fn pass(config: &ArchiveConfig, method: &MethodId, which: Pass) -> Result<(), ArchiveFault> {
    let mut client = database::connect(&config.database)?;
    let bucket = bucket(config);
    if let Pass::First { reconcile } = which {
        database::make_schema(&mut client)?;
        if reconcile {
            each_page(&bucket, ObjectKey::ANNOUNCED, |keys| {
                announcements(&bucket, &mut client, method, keys, Then::Wait).map(drop)
            })?;
            each_page(&bucket, ObjectKey::RESULTS, |keys| results(&bucket, &mut client, keys))?;
        }
        database::enter_method(&mut client, method)?;
        database::enter_missing_jobs(&mut client, method)?;
    }
    each_page(&bucket, ObjectKey::INBOX, |keys| {
        let indexed = announcements(&bucket, &mut client, method, keys, Then::Measure)?;
        indexed.into_iter().try_for_each(|(key, bytes)| file_away(&bucket, &key, bytes))
    })?;
    each_page(&bucket, ObjectKey::FLEET, |keys| heartbeats(&bucket, &mut client, keys))
}

/// What a station says in the inbox.
enum Said {
    Announced(Box<Announcement>),
    Withdrawn(Withdrawal),
}

fn said(key: &str, bytes: &[u8]) -> Result<Said, Unread> {
    let key: ObjectKey = key.parse()?;
    Ok(match key {
        ObjectKey::Withdrawal { .. } => Said::Withdrawn(Withdrawal::read_at(&key, bytes)?),
        _ => Said::Announced(Box::new(Announcement::read_at(&key, bytes)?)),
    })
}

/// Enters what stations announced or took back. Returns the keys and bytes of what was entered.
fn announcements(
    bucket: &Bucket,
    client: &mut Client,
    method: &MethodId,
    keys: &[String],
    then: Then,
) -> Result<Vec<(String, Vec<u8>)>, ArchiveFault> {
    let mut entered = Vec::new();
    for key in keys {
        let Some(bytes) = bucket.get(key)? else { continue };
        // Wherever it lies, it is what was in the inbox.
        let own = key.replacen(ObjectKey::ANNOUNCED, ObjectKey::INBOX, 1);
        match said(&own, &bytes) {
            Ok(Said::Announced(announced)) => {
                database::enter_announcement(client, &announced, method, then)?;
            }
            Ok(Said::Withdrawn(withdrawn)) => database::enter_withdrawal(client, &withdrawn)?,
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

fn heartbeats(bucket: &Bucket, client: &mut Client, keys: &[String]) -> Result<(), ArchiveFault> {
    for key in keys {
        let Some(bytes) = bucket.get(key)? else { continue };
        match read::<Heartbeat>(key, &bytes) {
            Ok(beat) => database::enter_heartbeat(client, &beat)?,
            Err(why) => passed_over(key, &why),
        }
    }
    Ok(())
}

fn results(bucket: &Bucket, client: &mut Client, keys: &[String]) -> Result<(), ArchiveFault> {
    for key in keys {
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
