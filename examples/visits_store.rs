//! How long the visits of one patient take in a store of many: the figures of docs/visits.md.
//!
//! `cargo run --release --example visits_store` makes 10 000 records of 2000 patients in a temporary folder,
//! each as large as a real one, and asks for one patient after the other.

use std::error::Error;
use std::fs;
use std::io::{self, Write};
use std::path::Path;
use std::time::Instant;

use gaiter::store::revision::visits::of_patient;
use gaiter_language::Language;
use gaiter_leg::Method;
use gaiter_record::report::{self, AgeMax, Paper};
use gaiter_record::{Acquired, AcquiredFrom, Patient, Record, sha256};
use gaiter_visits::report::ReportOf;
use gaiter_visits::{Choice, Course, GIRTH_COMMON_MM, last_of_days};
use jiff::{Timestamp, ToSpan};
use support::recorded::export;
use support::records::record_of;

const PATIENTS: usize = 2000;
const VISITS: i64 = 5;

/// Every so many patients one is asked for, so that no folder is asked for twice.
const ASKED_APART: usize = 40;

fn main() -> Result<(), Box<dyn Error>> {
    let mut out = io::stdout().lock();
    let store = tempfile::tempdir()?;
    let body = record_of(&export("m_average_clean"), &Method::default()).1;
    writeln!(out, "making {} records …", PATIENTS as i64 * VISITS)?;
    for patient in 0..PATIENTS {
        for visit in 0..VISITS {
            place(store.path(), &body, patient, visit)?;
        }
    }
    let mut read = Vec::new();
    let mut compared = Vec::new();
    let mut page = Vec::new();
    for patient in (0..PATIENTS).step_by(ASKED_APART) {
        let begin = Instant::now();
        let found = of_patient(store.path(), &patient.to_string())?;
        read.push(begin.elapsed());
        let records = found.records.into_iter().map(|of| of.record).collect();
        let records: Vec<Record> = last_of_days(records, |record| record);
        let choice = Choice { volume: None, affected: None, girth_common_mm: GIRTH_COMMON_MM };
        let course = Course::from_records(&records, choice)?;
        let report = ReportOf {
            course: &course,
            records: &records,
            thresholds: &[],
            today: jiff::civil::date(2026, 11, 25),
            age_max: AgeMax::default(),
            language: Language::En,
        };
        let document = report.document();
        compared.push(begin.elapsed());
        report::page(&document, Paper::A4)?;
        page.push(begin.elapsed());
    }
    for (what, mut times) in [
        ("records read and checked", read),
        ("compared, with pictures", compared),
        ("as a page", page),
    ] {
        times.sort();
        let at =
            |share: f64| times[(share * (times.len() - 1) as f64) as usize].as_secs_f64() * 1e3;
        writeln!(out, "{what}: median {:.1} ms, 95 % {:.1} ms", at(0.5), at(0.95))?;
    }
    Ok(())
}

/// A record of another scan of a patient, with its sum.
fn place(store: &Path, body: &Record, patient: usize, visit: i64) -> Result<(), Box<dyn Error>> {
    let mut record = body.clone();
    record.patient = Some(Patient { id: patient.to_string(), sources: Vec::new() });
    record.scan.sha256 = format!("{:08x}{}", patient as i64 * VISITS + visit, "0".repeat(56));
    let at = "2026-01-08T08:00:00Z".parse::<Timestamp>()? + (visit * 24 * 30).hours();
    record.acquired =
        Some(Acquired { utc_offset_min: Some(60), ..Acquired::new(at, AcquiredFrom::Press) });
    let name = format!("{}_{}", at.strftime("%Y%m%dT%H%M%SZ"), &record.scan.sha256[..8]);
    let folder = store.join(patient.to_string()).join(name);
    fs::create_dir_all(&folder)?;
    let json = serde_json::to_vec(&record)?;
    fs::write(folder.join("SHA256SUMS"), format!("{}  record.json\n", sha256(&json)))?;
    fs::write(folder.join("record.json"), json)?;
    Ok(())
}
