//! An archive of its own for each test: a database, a bucket, what stations have put there.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::LazyLock;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread::sleep;
use std::time::{Duration, Instant};

use gaiter_https::{Bucket, BucketFault, BucketPlace, HttpsClient, Secret, TlsFiles};
use gaiter_leg::{Extraction, Format, Method, WholeBody, extract};
use gaiter_record::ScanId;
use gaiter_record::archive::{
    Announcement, Document, MethodId, ObjectKey, Outcome, RecordHash, ScanResult, StationId,
    Withdrawal, packed, unpacked,
};
use jiff::Timestamp;
use postgres::Client;
use support::recorded::coarse_body;
use tempfile::TempDir;

use crate::servers::{client, database, store};

/// Where the servers are.
#[derive(Debug, Clone, Copy)]
pub struct Ports {
    pub store: u16,
    pub database: u16,
}

/// How long a verb may take, on a busy machine.
const LONG: Duration = Duration::from_secs(600);

/// More than any result has, bytes.
const RESULT_MOST: u64 = 1 << 26;

/// The id of this version's method.
pub fn method() -> MethodId {
    MethodId::of(&Method::default()).unwrap()
}

/// An archive.
pub struct Place {
    folder: TempDir,
    database: String,
    bucket_name: String,
    pub bucket: Bucket,
    pub ports: Ports,
}

impl Place {
    /// On the servers of all tests.
    pub fn new() -> Place {
        Place::on(Ports { store: store().port, database: database().port })
    }

    /// On these servers.
    pub fn on(ports: Ports) -> Place {
        static COUNT: AtomicUsize = AtomicUsize::new(0);
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("key"), "word").unwrap();
        let (database, bucket_name) = (format!("archive_{number}"), format!("archive-{number}"));
        let mut client = client(ports.database, "postgres");
        client.batch_execute(&format!("create database {database}")).unwrap();
        let bucket = bucket(ports.store, &bucket_name, "key", &folder.path().join("key"));
        // What is put under no key is the bucket itself.
        bucket.put("", Vec::new()).unwrap();
        Place { folder, database, bucket_name, bucket, ports }
    }

    /// The bucket as another key sees it, through another port.
    pub fn bucket_of(&self, key_id: &str, port: u16) -> Bucket {
        bucket(port, &self.bucket_name, key_id, &self.folder.path().join("key"))
    }

    pub fn bucket_name(&self) -> &str {
        &self.bucket_name
    }

    pub fn client(&self) -> Client {
        let mut client = client(self.ports.database, &self.database);
        client.batch_execute("set search_path = gaiter").unwrap();
        client
    }

    /// Removes all objects and tables, and has `scans` announced anew.
    pub fn renew(&self, scans: usize) {
        self.client().batch_execute("drop schema if exists gaiter cascade").unwrap();
        self.keys("").iter().for_each(|key| self.bucket.remove(key).unwrap());
        (0..scans).for_each(|number| self.announce(&crop(number)));
    }

    /// Puts a scan and its announcement there, as a station does.
    pub fn announce(&self, scan: &(Vec<u8>, WholeBody)) {
        send(&self.bucket, scan).unwrap();
    }

    /// Takes a scan of nobody back, as its station does, a moment after it was announced.
    pub fn withdraw(&self, (ply, _): &(Vec<u8>, WholeBody)) {
        let withdrawn = Withdrawal {
            schema: Withdrawal::SCHEMA.to_owned(),
            station: StationId::parse("booth-1").unwrap(),
            export: ScanId::of_bytes(ScanId::of_bytes(ply).as_str().as_bytes()),
            patient: None,
            at: Timestamp::from_millisecond(1).unwrap(),
        };
        self.bucket.put(&withdrawn.key().to_string(), withdrawn.json().unwrap()).unwrap();
    }

    /// A configuration that asks servers at these ports.
    pub fn config(&self, ports: Ports) -> PathBuf {
        let Ports { store, database } = ports;
        let path = self.folder.path().join(format!("{store}-{database}.toml"));
        let text = format!(
            "[database]\nhost = \"127.0.0.1\"\nport = \"{database}\"\nname = \"{}\"\nuser = \"postgres\"\n\
             [objects]\naddress = \"http://127.0.0.1:{store}\"\nbucket = \"{}\"\nkey_id = \"key\"\n\
             key = \"{}\"\n[work]\nprocesses = \"1\"\n",
            self.database,
            self.bucket_name,
            self.folder.path().join("key").display()
        );
        fs::write(&path, text).unwrap();
        path
    }

    /// A verb that is not begun yet.
    pub fn command(&self, args: &[&str]) -> Command {
        self.command_at(self.ports, args)
    }

    fn command_at(&self, ports: Ports, args: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_gaiter-archive"));
        command.arg("--config").arg(self.config(ports)).args(args);
        command.stdin(Stdio::null());
        command
    }

    /// Runs a verb to its end, whichever that is.
    pub fn tried(&self, args: &[&str]) -> Output {
        self.command(args).output().unwrap()
    }

    /// Runs a verb to its end.
    #[track_caller]
    pub fn verb(&self, args: &[&str]) -> Output {
        let output = self.tried(args);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{args:?}: {said}");
        output
    }

    /// Starts a verb whose servers are at these ports.
    pub fn start(&self, ports: Ports, args: &[&str]) -> Running {
        let mut command = self.command_at(ports, args);
        Running(command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap())
    }

    /// As if the leases of workers that are gone, and all waiting times, had run out.
    pub fn time_passes(&self) {
        self.client().batch_execute("update job set due = now()").unwrap();
    }

    pub fn keys(&self, prefix: &str) -> Vec<String> {
        let (mut keys, mut after) = (Vec::new(), String::new());
        loop {
            let page = self.bucket.list(prefix, &after).unwrap();
            keys.extend(page.objects.into_iter().map(|listed| listed.key));
            match keys.last() {
                Some(last) if page.is_more => after.clone_from(last),
                _ => return keys,
            }
        }
    }

    pub fn result(&self, key: &str) -> ScanResult {
        let bytes = unpacked(&self.bucket.get(key).unwrap().unwrap(), RESULT_MOST).unwrap();
        ScanResult::read_at(&key.parse().unwrap(), &bytes).unwrap()
    }

    /// All rows that are made of objects, in an order of their own.
    pub fn rows(&self) -> Vec<String> {
        let statement = "\
            select s::text from scan s union all select a::text from announcement a union all
            select (scan, method, outcome, stature_mm, crotch_height_mm, findings, height_mm, girth_mm, girth_sd_mm)::text
            from result
            order by 1";
        let rows = self.client().query(statement, &[]).unwrap();
        rows.iter().map(|row| row.get(0)).collect()
    }

    /// What does not hold in the index at rest: each scan has one result, and nothing is left to do.
    pub fn wrong_rows(&self, scans: usize) -> Vec<String> {
        let mut found = Vec::new();
        let mut client = self.client();
        for (what, statement, expected) in [
            ("scans", "select count(*) from scan", scans),
            ("announcements", "select count(*) from announcement", scans),
            ("rows of results", "select count(*) from result", scans),
            ("measured", "select count(*) from result where outcome = 'measured'", scans),
            ("jobs", "select count(*) from job", 0),
        ] {
            let count: i64 = client.query_one(statement, &[]).unwrap().get(0);
            if usize::try_from(count) != Ok(expected) {
                found.push(format!("{count} {what}"));
            }
        }
        found
    }

    /// What does not hold at rest: each scan has one result, in the store and in the index, and nothing is left to do.
    pub fn wrong(&self, scans: usize) -> Vec<String> {
        let mut found = self.wrong_rows(scans);
        for (prefix, expected) in
            [(ObjectKey::INBOX, 0), (ObjectKey::ANNOUNCED, scans), (ObjectKey::RESULTS, scans)]
        {
            let keys = self.keys(prefix);
            if keys.len() != expected {
                found.push(format!("{prefix}: {keys:?}"));
            }
        }
        for key in self.keys(ObjectKey::RESULTS) {
            if !matches!(self.result(&key).outcome, Outcome::Measured(_)) {
                found.push(format!("{key} is a refusal"));
            }
        }
        found
    }
}

fn bucket(port: u16, name: &str, key_id: &str, secret: &Path) -> Bucket {
    let place = BucketPlace {
        address: format!("http://127.0.0.1:{port}"),
        bucket: name.to_owned(),
        region: "us-east-1".to_owned(),
        key_id: key_id.to_owned(),
        secret: Secret::File(secret.to_owned()),
    };
    Bucket::new(place, HttpsClient::new(TlsFiles::default(), None, LONG))
}

/// Sends a scan and its announcement, as a station does.
pub fn send(bucket: &Bucket, (ply, whole): &(Vec<u8>, WholeBody)) -> Result<(), BucketFault> {
    let scan = ScanId::of_bytes(ply);
    let announced = Announcement {
        schema: Announcement::SCHEMA.to_owned(),
        station: StationId::parse("booth-1").unwrap(),
        export: ScanId::of_bytes(scan.as_str().as_bytes()),
        scan: scan.clone(),
        bytes: ply.len() as u64,
        record: RecordHash::of_bytes(ply),
        revision: 1,
        at: Timestamp::UNIX_EPOCH,
        method: method(),
        first_seen: Timestamp::UNIX_EPOCH,
        whole: whole.clone(),
        patient: None,
    };
    bucket.put_new(&ObjectKey::Scan(scan).to_string(), packed(ply))?;
    bucket.put_new(&announced.key().to_string(), announced.json().unwrap())?;
    Ok(())
}

/// A verb that runs; it is killed where the test ends before it.
pub struct Running(pub Child);

impl Running {
    pub fn kill(&mut self) {
        self.0.kill().unwrap();
        self.0.wait().unwrap();
    }

    pub fn has_ended(&mut self) -> bool {
        self.0.try_wait().unwrap().is_some()
    }

    #[track_caller]
    pub fn ends(&mut self) {
        wait_for("its end", || self.has_ended());
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[track_caller]
pub fn wait_for(what: &str, mut is_there: impl FnMut() -> bool) {
    let began = Instant::now();
    while !is_there() {
        assert!(began.elapsed() < LONG, "{what} is not there");
        sleep(Duration::from_millis(5));
    }
}

/// A body, measured once.
pub fn whole() -> &'static Extraction {
    static WHOLE: LazyLock<Extraction> =
        LazyLock::new(|| extract(&coarse_body(1), Format::Obj, &Method::default()).unwrap());
    &WHOLE
}

/// A crop of its own for each number, and what the whole body told.
pub fn crop(number: usize) -> (Vec<u8>, WholeBody) {
    let mut crop = whole().crop();
    // Far below all that is measured, and other bytes.
    crop.points[0].x += 1e-9 * number as f64;
    (crop.to_ply(), WholeBody::from_extraction(whole()))
}
