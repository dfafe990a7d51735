//! Hands over the latest revision of a record that was amended after a store got it.

use std::path::Path;

use gaiter_flow::facts::StoreAttempt;
use gaiter_flow::outbox::Ended;
use tracing::info;

use super::work::{self, DeliveryFault};
use super::{store_reach, stored_record};
use crate::station::booth::Booth;
use crate::station::event::short;
use crate::station::journal::{Due, GivenRevision};
use crate::store::{Delivery, StoreFault, revision};

/// Puts the latest revision of a record into a store that keeps its own copy.
pub fn hand_over(booth: &Booth, due: &Due) -> Ended {
    match handed_over(booth, due) {
        Ok(()) => Ended::ForGood,
        Err(fault) => work::note_fault(booth, due, fault),
    }
}

fn handed_over(booth: &Booth, due: &Due) -> Result<(), DeliveryFault> {
    let core = booth.core();
    let row = work::row(core, due)?;
    let journal = core.custody.journal();
    let store = core.stores.named(&due.store).ok_or_else(|| work::no_store(due))?;
    let put_off = |error: String| DeliveryFault::PutOff { code: "record-unreadable", error };
    let Some(folder) = journal.record_folder(&due.scan, due.patient_cell())? else {
        return Err(put_off("the record is in no folder that can be read".to_owned()));
    };
    let folder = revision::latest(Path::new(&folder));
    let (stored, files) =
        stored_record::latest(&folder).map_err(|fault| put_off(fault.to_string()))?;
    if stored.record.amendments.is_empty() {
        // The revision that was begun was never written.
        return Ok(journal.handed_over(due, None)?);
    }
    work::note_place(core, due, store, None)?;
    let person = due.patient.as_ref().and_then(|patient| booth.listed_person(patient));
    let put = store.put(&Delivery {
        scan: &due.scan,
        patient: due.patient.as_ref().map(|patient| patient.id.as_str()),
        person: person.as_ref(),
        first_seen: row.first_seen,
        revision: stored.record.revision,
        turn: work::turn(core, due, store)?,
        files: &files,
        scan_file: &folder.join(&stored.scan_file),
        ending: &row.format,
    });
    let receipt = match put {
        Ok(receipt) => receipt,
        // The scan's record is where it belongs: a store that refuses a later revision refuses no scan.
        Err(fault @ StoreFault::Permanent(_)) => {
            let (code, error) = (fault.code(), fault.to_string());
            journal.revision_refused(due, code)?;
            return Err(DeliveryFault::PutOff { code, error });
        }
        Err(fault) => return Err(work::of_store(fault, &row)),
    };
    store_reach::note(core, &due.store, StoreAttempt::Delivery(None));
    work::note_place(core, due, store, Some(&receipt.folder))?;
    let given = GivenRevision { revision: stored.record.revision, place: &receipt.folder };
    journal.handed_over(due, Some(given))?;
    let (scan, store) = (short(&due.scan), &due.store);
    let already_there = receipt.already_there;
    info!(event = "amendment-handed-over", scan, store, already_there);
    Ok(())
}
