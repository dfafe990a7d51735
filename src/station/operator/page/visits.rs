//! The visits of the patient of a scan, compared: made when they are asked for, from the records in the store.

use std::path::Path;
use std::sync::Arc;

use axum::extract::{Path as UrlPath, Query, State};
use axum::http::{HeaderMap, StatusCode, Uri, header};
use axum::response::{IntoResponse, Response};
use gaiter_flow::page;
use gaiter_flow::page::files::served;
use gaiter_record::Record;
use gaiter_record::report;
use gaiter_visits::report::ReportOf;
use gaiter_visits::{Affected, Choice, Course, last_of_days};
use jiff::Zoned;
use tracing::warn;

use super::desk::Desk;
use super::endpoint::HttpEndpoint;
use super::files::Row;
use super::{plain_page, snapshot};
use crate::station::persons;
use crate::station::runtime::chain;
use crate::store::FolderStore;
use crate::store::revision::visits::of_patient;

/// Why there is no comparison: the status of the answer, and the key of its sentence unless something failed.
struct NoVisits(StatusCode, Option<&'static str>);

/// There is no such scan, or it is no patient's.
const UNKNOWN: NoVisits = NoVisits(StatusCode::NOT_FOUND, Some("page.plain.no_visits"));

/// The comparison cannot be made.
const FAILED: NoVisits = NoVisits(StatusCode::INTERNAL_SERVER_ERROR, None);

/// `/scan/ID/visits.html?of=KEY` and `/scan/ID/visits.pdf?of=KEY`: 404 for a scan that is no patient's, 403 for
/// a reader who may not see whose scan it is, 409 if there is nothing to compare.
pub async fn visits(
    State(endpoint): State<Arc<HttpEndpoint>>,
    UrlPath(scan): UrlPath<String>,
    Query(row): Query<Row>,
    uri: Uri,
    headers: HeaderMap,
) -> Response {
    let is_paper = uri.path().ends_with(".pdf");
    let language = endpoint.desk.core.config.language;
    let plain = |status, key| plain_page(status, key, language);
    let made = endpoint.of_scan(&scan, &headers, move |desk, scan| {
        let row = snapshot::row(desk, scan, row.key()).ok_or(UNKNOWN)?;
        let patient = page::record_patient(&row, FolderStore::FIRST).ok_or(UNKNOWN)?;
        made(desk, patient, is_paper)
    });
    match made.await {
        Ok(Ok(bytes)) => {
            let served = served(if is_paper { "report.pdf" } else { "report.html" });
            let kind = (header::CONTENT_TYPE, served.kind);
            let policy = (header::CONTENT_SECURITY_POLICY, served.policy);
            ([kind, policy], bytes).into_response()
        }
        Ok(Err(NoVisits(status, Some(key)))) => plain(status, key),
        Err(status @ StatusCode::NOT_FOUND) => plain(status, "page.plain.no_visits"),
        Err(status @ StatusCode::FORBIDDEN) => plain(status, "page.plain.no_link"),
        Err(status @ StatusCode::SERVICE_UNAVAILABLE) => plain(status, "page.plain.busy"),
        Ok(Err(NoVisits(status, None))) | Err(status) => status.into_response(),
    }
}

/// The comparison of a patient's visits. Blocks as long as the store does.
fn made(desk: &Desk, patient: &str, is_paper: bool) -> Result<Vec<u8>, NoVisits> {
    let config = &desk.core.config;
    let failed = |error: &dyn std::error::Error| {
        warn!(event = "visits-failed", error = chain(error));
        FAILED
    };
    // First what was delivered, then what is there: a delivery in between is not reported as removed.
    let known = persons::visits(&desk.core.custody, patient).map_err(|error| {
        desk.core.check_corruption(&error);
        failed(&error)
    })?;
    let root: &Path = &config.store.folder.path;
    let away = NoVisits(StatusCode::SERVICE_UNAVAILABLE, Some("page.plain.store_away"));
    let found = of_patient(root, patient).map_err(|_| away)?;
    let left_out = found.left_out(&known.delivered);
    let records: Vec<Record> = found.records.into_iter().map(|of| of.record).collect();
    let records = last_of_days(records, |record| record);
    if records.len() < 2 {
        // There is one visit only; or only one can be used, because records are left out.
        let key = match left_out.is_empty() {
            true => "page.plain.one_visit",
            false => "page.plain.one_visit_usable",
        };
        return Err(NoVisits(StatusCode::CONFLICT, Some(key)));
    }
    let girth_common_mm = config.scanner.girth_error_mm;
    let affected = known.affected.as_deref().and_then(Affected::of_word);
    let choice = Choice { volume: None, affected, girth_common_mm };
    let course = Course::from_records(&records, choice).map_err(|error| failed(&error))?;
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
    match is_paper {
        false => report::page(&document, config.print.paper)
            .map(String::into_bytes)
            .map_err(|error| failed(&error)),
        true => report::paper(&document, config.print).map_err(|error| failed(&error)),
    }
}
