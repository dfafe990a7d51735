//! Asks the server of a worklist (C-FIND of the Modality Worklist Information Model).

use std::borrow::Cow;

use gaiter_dicom::dimse::{Found, Model, find};
use gaiter_dicom::{InMemDicomObject, Tag, planned, tags};
use gaiter_flow::worklist::{FindResponse, WorklistEntry};
use jiff::civil::Date;

use crate::config::WorklistConfig;
use crate::store::ServerFault;

/// The most answers that are read. A server that does not know the keys of the query may answer with the day of a
/// whole hospital; more than that is not the list of a day.
const ANSWERS_MOST: usize = 5_000;

/// What a server has answered.
#[derive(Debug)]
pub struct WorklistAnswer {
    /// The entries that it has.
    pub entries: Vec<WorklistEntry>,
    /// How many further ones cannot be read.
    pub unreadable: usize,
}

/// What the server has for this station on a day. Blocks, for as long as the server's limit allows.
///
/// # Errors
/// [`ServerFault`], which holds nothing that an entry says: nothing is known then, and an earlier answer still holds.
pub fn ask(config: &WorklistConfig, day: Date) -> Result<WorklistAnswer, ServerFault> {
    let WorklistConfig { server, filter, .. } = config;
    let query = planned(&server.titles.calling, filter.modality.as_deref(), day);
    let Found { answers, unreadable } = server.asked(|connection, titles| {
        find(connection, titles, Model::Worklist, &query, ANSWERS_MOST)
    })?;
    Ok(WorklistAnswer { entries: answers.iter().map(entry).collect(), unreadable })
}

/// The entry of an answer, which has one planned step.
fn entry(answer: &InMemDicomObject) -> WorklistEntry {
    let steps = answer.get(tags::SCHEDULED_PROCEDURE_STEP_SEQUENCE);
    let step = steps.and_then(|steps| steps.items()?.first());
    let of_step = |tag| step.map(|step| text(step, tag)).unwrap_or_default();
    WorklistEntry::from(FindResponse {
        patient_id: &text(answer, tags::PATIENT_ID),
        issuer_of_patient_id: &text(answer, tags::ISSUER_OF_PATIENT_ID),
        patient_name: &text(answer, tags::PATIENT_NAME),
        patient_birth_date: &text(answer, tags::PATIENT_BIRTH_DATE),
        patient_sex: &text(answer, tags::PATIENT_SEX),
        requested_procedure_description: &text(answer, tags::REQUESTED_PROCEDURE_DESCRIPTION),
        study_instance_uid: &text(answer, tags::STUDY_INSTANCE_UID),
        accession_number: &text(answer, tags::ACCESSION_NUMBER),
        scheduled_station_ae_title: &of_step(tags::SCHEDULED_STATION_AE_TITLE),
        modality: &of_step(tags::MODALITY),
        start_date: &of_step(tags::SCHEDULED_PROCEDURE_STEP_START_DATE),
        start_time: &of_step(tags::SCHEDULED_PROCEDURE_STEP_START_TIME),
        step_id: &of_step(tags::SCHEDULED_PROCEDURE_STEP_ID),
    })
}

/// The text of an element, in which several values are separated by a backslash; empty if there is none.
fn text(set: &InMemDicomObject, tag: Tag) -> Cow<'_, str> {
    set.get(tag).and_then(|element| element.to_str().ok()).unwrap_or_default()
}
