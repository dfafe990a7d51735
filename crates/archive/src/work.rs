//! The worker: claims jobs, measures, writes results. It holds no state: killed at any point, its claims run out and
//! others do them again, to the same results.

use std::io;
use std::process::{self, ExitCode};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use gaiter_confined::{Ended, Trouble};
use gaiter_https::{Bucket, PutNew};
use gaiter_leg::Method;
use gaiter_record::archive::{Document, MethodId, ObjectKey, ScanResult};
use postgres::Client;
use rustix::system::uname;
use tokio::runtime;
use tokio::signal::unix::{SignalKind, signal};
use zstd::bulk::compress;

use crate::config::ArchiveConfig;
use crate::database::{self, Claimed};
use crate::fault::{ArchiveFault, chain};
use crate::index::result_at;
use crate::measure::{Answer, Job, measure};
use crate::note;
use crate::objects::bucket;

/// How many jobs are claimed at a time: with 16 a claim one server gives 10 000 jobs a second, one by one 500.
const CLAIM: i64 = 16;

/// The level of Zstandard at which results are packed: the fastest of its ordinary ones.
const PACKING_LEVEL: i32 = 1;

/// How long a worker waits if there is nothing to do.
const PAUSE: Duration = Duration::from_secs(2);

/// How long it waits if a server is away.
const SETBACK: Duration = Duration::from_secs(5);

/// The worker was asked to end before all scans were measured, and can be started again (`EX_TEMPFAIL` of `sysexits.h`).
const EXIT_ASKED_TO_END: u8 = 75;

/// One of the threads, each with a connection of its own.
struct Worker<'a> {
    config: &'a ArchiveConfig,
    method: Method,
    id: MethodId,
    name: String,
    until_empty: bool,
    asked_to_end: &'a AtomicBool,
}

/// Measures what is to be measured. It waits for servers that are away. Asked to end by SIGTERM it hands back what it
/// has claimed and not measured.
///
/// # Errors
/// If the method cannot be named, or signals cannot be heard.
pub fn work(config: &ArchiveConfig, until_empty: bool) -> Result<ExitCode, ArchiveFault> {
    let method = Method::default();
    let id = MethodId::of(&method)?;
    // Not from /proc/sys, which the unit hides.
    let system = uname();
    let host = system.nodename().to_string_lossy();
    let asked = asked_to_end()?;
    let asked_to_end = &*asked;
    thread::scope(|scope| {
        for number in 0..config.processes {
            let name = format!("{host}:{}:{number}", process::id());
            let (method, id) = (method.clone(), id.clone());
            let worker = Worker { config, method, id, name, until_empty, asked_to_end };
            scope.spawn(move || worker.run());
        }
    });
    Ok(match asked_to_end.load(Ordering::Relaxed) {
        true => ExitCode::from(EXIT_ASKED_TO_END),
        false => ExitCode::SUCCESS,
    })
}

/// What is set when SIGTERM comes. systemd, Slurm and Kubernetes send it, and kill what has not ended some time later.
fn asked_to_end() -> io::Result<Arc<AtomicBool>> {
    let runtime = runtime::Builder::new_current_thread().enable_io().build()?;
    let mut terminate = runtime.block_on(async { signal(SignalKind::terminate()) })?;
    let asked = Arc::new(AtomicBool::new(false));
    let set = Arc::clone(&asked);
    thread::spawn(move || {
        runtime.block_on(terminate.recv());
        set.store(true, Ordering::Relaxed);
    });
    Ok(asked)
}

impl Worker<'_> {
    fn run(&self) {
        while !self.is_asked_to_end()
            && let Err(fault) = self.session()
        {
            note(format_args!("work: {}", chain(&fault)));
            if !self.is_asked_to_end() {
                thread::sleep(SETBACK);
            }
        }
    }

    fn is_asked_to_end(&self) -> bool {
        self.asked_to_end.load(Ordering::Relaxed)
    }

    /// Works until nothing is left, it is asked to end, or a server fails.
    fn session(&self) -> Result<(), ArchiveFault> {
        let mut client = database::connect(&self.config.database)?;
        database::check_schema(&mut client)?;
        let bucket = bucket(self.config);
        while !self.is_asked_to_end() {
            let claimed = database::claim(&mut client, &self.name, &self.id, CLAIM)?;
            if !claimed.is_empty() {
                self.batch(&mut client, &bucket, &claimed)?;
            } else if self.until_empty && database::open_jobs(&mut client, &self.id)? == 0 {
                return Ok(());
            } else {
                thread::sleep(PAUSE);
            }
        }
        Ok(())
    }

    fn batch(
        &self,
        client: &mut Client,
        bucket: &Bucket,
        claimed: &[Claimed],
    ) -> Result<(), ArchiveFault> {
        let scans: Vec<&str> = claimed.iter().map(|job| job.scan.as_str()).collect();
        for (at, job) in claimed.iter().enumerate() {
            if !database::begin(client, &self.name, &self.id, &scans[at..])? {
                continue;
            }
            match self.done(bucket, job) {
                Ok(Ok(result)) => database::enter_result(client, &result)?,
                Ok(Err(reason)) => {
                    note(format_args!("work: {}: {reason}", job.scan));
                    database::put_off(client, &self.name, &self.id, scans[at], &reason)?;
                }
                Err(fault) => {
                    database::give_back(client, &self.name, &self.id, &scans[at..])?;
                    return Err(fault);
                }
            }
        }
        Ok(())
    }

    /// Fetches a scan, measures it, and writes its result. Within: why there is none.
    fn done(
        &self,
        bucket: &Bucket,
        job: &Claimed,
    ) -> Result<Result<ScanResult, String>, ArchiveFault> {
        if self.is_asked_to_end() {
            return Err(ArchiveFault::AskedToEnd);
        }
        let not = |reason: String| Ok(Err(reason));
        let Some(object) = bucket.get(&ObjectKey::Scan(job.scan.clone()).to_string())? else {
            return not("the scan is not in the store".to_owned());
        };
        let whole = match serde_json::from_str(&job.whole) {
            Ok(whole) => whole,
            Err(why) => return not(format!("what its station said of the body: {why}")),
        };
        let (scan, bytes, method) = (job.scan.clone(), job.bytes, self.method.clone());
        let outcome = match measure(&Job { scan, bytes, whole, method }, &object)? {
            Ended::Answered(Answer::Said(outcome)) => outcome,
            Ended::Answered(Answer::Damaged(why)) => return not(format!("the scan: {why}")),
            // Who ends a worker may end its processes with it: that is no attempt.
            Ended::Trouble(Trouble::Killed { signal })
                if signal == SignalKind::terminate().as_raw_value() =>
            {
                return Err(ArchiveFault::AskedToEnd);
            }
            Ended::Trouble(trouble) => return not(format!("{}: {trouble}", trouble.code())),
        };
        let result = ScanResult {
            schema: ScanResult::SCHEMA.to_owned(),
            scan: job.scan.clone(),
            method: self.id.clone(),
            outcome,
        };
        let key = result.key().to_string();
        match bucket.put_new(&key, compress(&result.json()?, PACKING_LEVEL)?)? {
            PutNew::Stored => Ok(Ok(result)),
            // Somebody measured it before and was ended before saying so: what is in the store counts.
            PutNew::AlreadyThere => match result_at(bucket, &key)? {
                Ok(result) => Ok(Ok(result)),
                Err(why) => not(format!("the result in the store: {}", chain(&why))),
            },
        }
    }
}
