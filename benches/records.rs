//! How soon a patient's records are known in a full store: `cargo bench --bench records`.
//!
//! 10 000 records of 2 000 patients below `TMPDIR`. Only the patients who are asked for have records of the
//! usual length; what the others have is not opened. Times are medians over patients, of which each is asked
//! for once: read from the records themselves, as `gaiter patient visits` does, and from the index, when it is
//! new, known and damaged.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::print_stdout)]

use std::fs::{self, File};
use std::io::Read;
use std::path::Path;
use std::time::{Duration, Instant};

use flate2::read::GzDecoder;
use gaiter::flow::access::Access;
use gaiter::record::sha256;
use gaiter::store::FolderStore;
use gaiter::store::index::RecordIndex;
use gaiter::store::revision::visits::of_patient;

/// Patients in the store.
const PATIENTS: usize = 2000;

/// Records of each.
const RECORDS: usize = 5;

/// Patients who are asked for.
const ASKED: usize = 41;

/// The length of a record with its shapes, bytes: what today's version writes of one body.
const RECORD_BYTES: usize = 350_000;

fn main() {
    let dir = tempfile::tempdir().unwrap();
    let (root, state) = (dir.path().join("records"), dir.path().join("state"));
    fs::create_dir(&state).unwrap();
    let store = FolderStore::new(FolderStore::FIRST, root.clone(), "booth-1", Access::Private);
    store.make_root().unwrap();
    store.mark().unwrap();
    let record = record();
    for patient in 0..PATIENTS {
        for visit in 0..RECORDS {
            put(&root, &record, patient, visit);
        }
    }
    println!("{} records of {PATIENTS} patients", PATIENTS * RECORDS);
    let index = RecordIndex::new(store, &state);
    let ids: Vec<String> = asked().map(id).collect();
    told("read from the records", &ids, |id| of_patient(&root, id).unwrap().records.len());
    told("index made", &ids, |id| index.records_of(Some(id)).unwrap().records.len());
    told("index known", &ids, |id| index.records_of(Some(id)).unwrap().records.len());
    for entry in fs::read_dir(state.join("record-index")).unwrap() {
        fs::write(entry.unwrap().path(), "{").unwrap();
    }
    told("index damaged", &ids, |id| index.records_of(Some(id)).unwrap().records.len());
}

fn told(what: &str, ids: &[String], records: impl Fn(&str) -> usize) {
    let mut took: Vec<Duration> = ids
        .iter()
        .map(|id| {
            let began = Instant::now();
            assert_eq!(records(id), RECORDS);
            began.elapsed()
        })
        .collect();
    took.sort();
    let ms = |took: Duration| took.as_secs_f64() * 1e3;
    println!(
        "{what:24} {:7.2} ms, at most {:7.2} ms",
        ms(took[took.len() / 2]),
        ms(took[took.len() - 1])
    );
}

fn asked() -> impl Iterator<Item = usize> {
    (0..ASKED).map(|at| at * PATIENTS / ASKED)
}

/// An id with a letter: for those the whole store is listed.
fn id(patient: usize) -> String {
    format!("P{patient:06}")
}

/// A record of the usual length.
fn record() -> serde_json::Value {
    let file =
        File::open(concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/records/schema_1.json.gz"));
    let mut text = String::new();
    GzDecoder::new(file.unwrap()).read_to_string(&mut text).unwrap();
    let mut record: serde_json::Value = serde_json::from_str(&text).unwrap();
    let short = RECORD_BYTES.saturating_sub(text.len());
    // A key that is not known is read over, as shapes are.
    record["padding"] = "x".repeat(short).into();
    record
}

fn put(root: &Path, record: &serde_json::Value, patient: usize, visit: usize) {
    let number = patient * RECORDS + visit;
    let (scan, id) = (sha256(number.to_string().as_bytes()), id(patient));
    let place = root.join(&id).join(format!("202701{:02}T080000Z_{}", visit + 1, &scan[..8]));
    fs::create_dir_all(&place).unwrap();
    let is_asked = asked().any(|asked| asked == patient);
    let bytes = match is_asked {
        true => {
            let mut record = record.clone();
            record["patient"] = serde_json::json!({ "id": id, "sources": [] });
            record["scan"]["sha256"] = scan.clone().into();
            record["acquired"] = serde_json::json!({ "at": format!("2027-01-{:02}T08:00:00Z", visit + 1), "from": "press" });
            serde_json::to_vec(&record).unwrap()
        }
        false => b"{}".to_vec(),
    };
    let sums = format!("{}  record.json\n{scan}  scan.obj\n", sha256(&bytes));
    fs::write(place.join("record.json"), bytes).unwrap();
    fs::write(place.join("SHA256SUMS"), sums).unwrap();
}
