//! Puts together what a station holds of a person. Reads; changes nothing but a cache. Blocks, on shares too.

use std::ffi::OsStr;
use std::fs;
use std::os::unix::ffi::OsStrExt;
use std::path::{Path, PathBuf};

use gaiter_flow::patient::naming::RecordName;
use gaiter_flow::patient::person::{
    KnownVisits, NamedLeg, OnServer, Person, PersonAmendment, PersonDelivery, PersonRecord,
    PersonScan, PersonStore, WhoseScan,
};
use gaiter_flow::{DeliveryState, Identity, ScanId, StatedPatient};
use gaiter_record::RECORD;
use gaiter_visits::Affected;
use jiff::Timestamp;
use tracing::warn;

use crate::config::Config;
use crate::station::custody::{Custody, CustodyFault, OLD_JOURNALS, REFUSED_ORDERS, files_naming};
use crate::station::journal::ScanOfPerson;
use crate::station::runtime::chain;
use crate::station::stores::Stores;
use crate::store::brief::Brief;
use crate::store::{FolderStore, PersonFolder, RecordStore, StoreFault};

/// The version of what is put together.
const SCHEMA: &str = "gaiter.person/1";

/// What a station holds of a person. A store that is out of reach is named with its fault.
///
/// # Errors
/// If the journal or the state folder cannot be read.
pub(in crate::station) fn person(
    config: &Config,
    identity: &Identity,
    custody: &Custody,
    stores: &Stores,
    patient: &str,
) -> Result<Person, CustodyFault> {
    let (journal, state_dir) = (custody.journal(), &config.station.state_dir);
    let theirs = journal.scans_of_person(patient)?;
    let alone = theirs.iter().filter(|of| of.whose == WhoseScan::Theirs);
    let alone: Vec<ScanId> = alone.map(|of| of.scan.clone()).collect();
    let mut scans = Vec::new();
    for of in &theirs {
        let ScanOfPerson { scan, whose } = of;
        // It may just have been forgotten.
        let Some(whole) = journal.whole(scan)? else { continue };
        scans.push(PersonScan {
            sha256: scan.to_string(),
            whose: *whose,
            goes_whole: custody.goes_whole(of, patient)?,
            summary: whole.summary,
            deliveries: journal.deliveries_of_person(scan, patient)?,
            kept: kept(custody, state_dir, scan),
        });
    }
    let servers = stores.iter().filter(|store| store.is_server());
    let on_servers = servers.flat_map(|store| on_server(store, &scans)).collect();
    let mut exports = Vec::new();
    for ScanOfPerson { scan, .. } in &theirs {
        let paths = journal.paths_of(scan)?.into_iter();
        exports.extend(paths.map(|path| PathBuf::from(OsStr::from_bytes(&path))));
    }
    exports.extend(named_exports(config, identity, patient));
    // The same bytes may be there under the name of another patient.
    exports.retain(|path| path.is_file() && !names_another(identity, path, patient));
    exports.sort();
    exports.dedup();
    let naming = |what, files| {
        let found = files_naming(state_dir, files, patient);
        found.map_err(|source| CustodyFault::Io { what, source })
    };
    Ok(Person {
        schema: SCHEMA.to_owned(),
        patient: patient.to_owned(),
        station: config.station.id.clone(),
        at: now(),
        scans,
        stores: stores.iter().filter_map(|store| in_folders(store, patient)).collect(),
        // Nothing of a store that cannot list it.
        handed_over: stores
            .iter()
            .flat_map(|store| store.given(patient).unwrap_or_default())
            .collect(),
        on_servers,
        owed: custody.owed_to_servers(patient)?,
        captures: journal.captures_of_person(patient)?,
        affected: custody.affected_of(patient)?,
        orders: naming("reading refused orders", REFUSED_ORDERS)?,
        exports,
        journals: naming("reading old journals", OLD_JOURNALS)?,
        history: journal.history_of_person(patient, &alone)?,
    })
}

/// What a station knows of a patient whose visits are compared. An affected leg that cannot be read is reported so:
/// visits can be compared without it.
///
/// # Errors
/// If the journal cannot be read.
pub(in crate::station) fn visits(
    custody: &Custody,
    patient: &str,
) -> Result<KnownVisits, CustodyFault> {
    let delivered = custody.journal().delivered_for_person(patient, FolderStore::FIRST)?;
    let named = custody.affected_of(patient);
    let is_leg = |named: &NamedLeg| Affected::of_word(&named.affected).is_some();
    let is_affected_unreadable = match &named {
        Ok(named) => !named.iter().all(is_leg),
        Err(fault) => {
            warn!(event = "affected-leg-unreadable", error = chain(fault));
            true
        }
    };
    let affected = named.ok().flatten().filter(is_leg).map(|named| named.affected);
    Ok(KnownVisits { delivered, affected, is_affected_unreadable })
}

fn now() -> Timestamp {
    let now = Timestamp::now();
    Timestamp::from_second(now.as_second()).unwrap_or(now)
}

/// The folders of the state folder that hold a scan.
fn kept(custody: &Custody, state_dir: &Path, scan: &ScanId) -> Vec<PathBuf> {
    let quarantined = state_dir.join("quarantine").join(scan.as_str());
    let preview = state_dir.join("previews").join(scan.as_str());
    let all = [custody.spool().entry(scan), quarantined, preview];
    all.into_iter().filter(|folder| folder.is_dir()).collect()
}

/// The files in export folders whose names name a person. Folders that cannot be listed have none.
fn named_exports<'a>(
    config: &'a Config,
    identity: &'a Identity,
    patient: &'a str,
) -> impl Iterator<Item = PathBuf> + 'a {
    let folders = config.scanner.export_dirs.iter();
    let entries = folders.filter_map(|folder| fs::read_dir(folder).ok()).flatten().flatten();
    entries.map(|entry| entry.path()).filter(move |path| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        matches!(identity.of_file_name(&name), StatedPatient::Patient(named) if named.id == patient)
    })
}

/// Whether a file's name names another patient.
fn names_another(identity: &Identity, path: &Path, patient: &str) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    matches!(identity.of_file_name(&name), StatedPatient::Patient(named) if named.id != patient)
}

/// What a store holds in folders; `None` for one that keeps none.
fn in_folders(store: &dyn RecordStore, patient: &str) -> Option<PersonStore> {
    let mut of = PersonStore {
        store: store.name().to_owned(),
        place: PathBuf::from(store.place()),
        fault: None,
        cause: None,
        records: Vec::new(),
        others: Vec::new(),
        of_another: 0,
    };
    let found = store.of_person(patient).transpose()?;
    if let Err(fault) = found.and_then(|found| fill(&mut of, found)) {
        let cause = fault.cause();
        (of.fault, of.cause) = (Some(cause.to_string()), Some(cause));
    }
    Some(of)
}

fn fill(of: &mut PersonStore, found: PersonFolder) -> Result<(), StoreFault> {
    (of.others, of.of_another) = (found.others, found.of_another.len());
    for folder in found.records {
        let brief = Brief::read(&folder.join(RECORD))?;
        of.records.push(record(folder, brief));
    }
    of.records.sort_by_key(|record| record.acquired.as_ref().map(|acquired| acquired.at));
    Ok(())
}

fn record(folder: PathBuf, brief: Option<Brief>) -> PersonRecord {
    let named = folder.file_name().and_then(OsStr::to_str).and_then(RecordName::read);
    let Some(brief) = brief else {
        let revision = named.map(|name| name.revision);
        return PersonRecord { folder, acquired: None, revision, amendments: Vec::new() };
    };
    let amendments = brief.amendments.into_iter().map(|of| PersonAmendment {
        what: format!("{} {}", of.leg, of.measure),
        by: of.by,
        at: of.at,
        reason: of.reason,
    });
    PersonRecord {
        folder,
        acquired: brief.acquired,
        revision: Some(brief.revision),
        amendments: amendments.collect(),
    }
}

/// What a server was given, or may have been. The journal knows it by its receipts. It has none of what is still to
/// be sent, or was taken back before an answer came: the server may have it all the same.
fn on_server(store: &dyn RecordStore, scans: &[PersonScan]) -> Vec<OnServer> {
    let nothing_sent = [DeliveryState::Held, DeliveryState::Refused].map(DeliveryState::word);
    let was_given =
        |of: &PersonDelivery| of.folder.is_some() || !nothing_sent.contains(&of.state.as_str());
    let all = scans.iter().flat_map(|scan| scan.deliveries.iter().map(move |of| (scan, of)));
    let given = all.filter(|&(_, of)| of.store == store.name() && was_given(of));
    let row = |scan: &PersonScan, of: &PersonDelivery, place: String, reference: Option<String>| {
        let unfetched = reference.as_deref().filter(|_| place == store.place());
        OnServer {
            sha256: scan.sha256.clone(),
            store: of.store.clone(),
            unfetched: unfetched.and_then(|reference| store.unfetched(reference)),
            place,
            reference,
            at: of.at,
            is_withdrawn: of.state == DeliveryState::Withdrawn.word(),
            is_withdrawing: of.state == DeliveryState::Withdrawing.word(),
        }
    };
    let rows = given.flat_map(|(scan, of)| {
        if of.places.is_empty() {
            return vec![row(scan, of, store.place(), of.folder.clone())];
        }
        let places = of.places.iter();
        let reference = |receipt: &String| Some(receipt.clone()).filter(|text| !text.is_empty());
        places.map(|(at, receipt)| row(scan, of, at.clone(), reference(receipt))).collect()
    });
    rows.collect()
}
