//! The visits of the patient of a scan, compared: made when they are asked for, from the records in the store.

use std::path::Path;
use std::sync::Arc;

use axum::extract::{Path as Asked, Query, State};
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use gaiter_flow::ScanId;
use gaiter_flow::page;
use gaiter_flow::page::files::served;
use gaiter_record::Record;
use gaiter_record::report;
use gaiter_visits::report::ReportOf;
use gaiter_visits::{Affected, Choice, Course, last_of_days};
use jiff::Zoned;
use tokio::task::spawn_blocking;
use tracing::warn;

use super::desk::Desk;
use super::endpoint::HttpEndpoint;
use super::files::Row;
use super::plain_page::plain_page;
use super::snapshot;
use crate::station::persons;
use crate::station::runtime::causes::chain;
use crate::store::FolderStore;
use crate::store::revision::visits::of_patient;

/// Why there is no comparison.
enum NoVisits {
    /// There is no such scan, or it is no patient's.
    Unknown,
    /// The store is out of reach.
    Unreachable,
    /// There is one visit only.
    One,
    /// Only one can be used, because records are left out.
    OneUsable,
    /// It cannot be made.
    Failed,
}

/// What of the comparison is asked for.
#[derive(Debug, Clone, Copy)]
enum Form {
    Page,
    Paper,
}

/// `/scan/ID/visits.html?of=KEY` and `/scan/ID/visits.pdf?of=KEY`: 404 for a scan that is no patient's, 403 for
/// a reader who may not see whose scan it is, 409 if there is nothing to compare.
pub async fn visits(
    State(endpoint): State<Arc<HttpEndpoint>>,
    Asked(scan): Asked<String>,
    Query(row): Query<Row>,
    headers: HeaderMap,
) -> Response {
    answer(endpoint, scan, row, headers, Form::Page).await
}

/// As [`visits`], as a PDF.
pub async fn visits_paper(
    State(endpoint): State<Arc<HttpEndpoint>>,
    Asked(scan): Asked<String>,
    Query(row): Query<Row>,
    headers: HeaderMap,
) -> Response {
    answer(endpoint, scan, row, headers, Form::Paper).await
}

async fn answer(
    endpoint: Arc<HttpEndpoint>,
    scan: String,
    row: Row,
    headers: HeaderMap,
    form: Form,
) -> Response {
    let language = endpoint.desk.core.config.language;
    let told = |status, key| plain_page(status, key, language);
    let none = || told(StatusCode::NOT_FOUND, "page.plain.no_visits");
    let Some(scan) = ScanId::parse(&scan) else { return none() };
    if !endpoint.shows_ids(&headers, None) {
        return told(StatusCode::FORBIDDEN, "page.plain.no_link");
    }
    let Ok(reader) = Arc::clone(&endpoint.desk.readers).try_acquire_owned() else {
        return told(StatusCode::SERVICE_UNAVAILABLE, "page.plain.busy");
    };
    let made = spawn_blocking(move || {
        let _reader = reader;
        let row = snapshot::row(&endpoint.desk, &scan, row.key()).ok_or(NoVisits::Unknown)?;
        let patient = page::record_patient(&row, FolderStore::FIRST).ok_or(NoVisits::Unknown)?;
        made(&endpoint.desk, patient, form)
    });
    match made.await {
        Ok(Ok(bytes)) => {
            let served = served(match form {
                Form::Page => "report.html",
                Form::Paper => "report.pdf",
            });
            let kind = (header::CONTENT_TYPE, served.kind);
            let policy = (header::CONTENT_SECURITY_POLICY, served.policy);
            ([kind, policy], bytes).into_response()
        }
        Ok(Err(NoVisits::One)) => told(StatusCode::CONFLICT, "page.plain.one_visit"),
        Ok(Err(NoVisits::OneUsable)) => told(StatusCode::CONFLICT, "page.plain.one_visit_usable"),
        Ok(Err(NoVisits::Unreachable)) => {
            told(StatusCode::SERVICE_UNAVAILABLE, "page.plain.store_away")
        }
        Ok(Err(NoVisits::Unknown)) => none(),
        Ok(Err(NoVisits::Failed)) | Err(_) => StatusCode::INTERNAL_SERVER_ERROR.into_response(),
    }
}

/// The comparison of a patient's visits. Blocks as long as the store does.
fn made(desk: &Desk, patient: &str, form: Form) -> Result<Vec<u8>, NoVisits> {
    let config = &desk.core.config;
    let failed = |error: &dyn std::error::Error| {
        warn!(event = "visits-failed", error = chain(error));
        NoVisits::Failed
    };
    // First what was delivered, then what is there: a delivery in between is not told as removed.
    let known = persons::visits(&desk.core.custody, patient).map_err(|error| {
        desk.core.check_corruption(&error);
        failed(&error)
    })?;
    let root: &Path = &config.store.folder.path;
    let found = of_patient(root, patient).map_err(|_| NoVisits::Unreachable)?;
    let left_out = found.left_out(&known.delivered);
    let records: Vec<Record> = found.records.into_iter().map(|of| of.record).collect();
    let records = last_of_days(records, |record| record);
    if records.len() < 2 {
        return Err(if left_out.is_empty() { NoVisits::One } else { NoVisits::OneUsable });
    }
    let girth_common_mm = config.scanner.girth_error_mm;
    let affected = known.affected.as_deref().and_then(Affected::of_word);
    let choice = Choice { volume: None, affected, girth_common_mm };
    let course = Course::of(&records, choice).map_err(|error| failed(&error))?;
    let course = course.with_left_out(left_out);
    let course = course.with_affected_unreadable(known.is_affected_unreadable);
    let report = ReportOf {
        course: &course,
        records: &records,
        thresholds: &config.visits.thresholds,
        today: Zoned::now().date(),
        age_max: config.age_max,
        language: config.language,
    };
    let document = report.document();
    match form {
        Form::Page => report::page(&document, config.print.paper)
            .map(String::into_bytes)
            .map_err(|error| failed(&error)),
        Form::Paper => report::paper(&document, config.print).map_err(|error| failed(&error)),
    }
}
