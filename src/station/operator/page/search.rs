//! The search among all scans, and one scan with the details of its record.

use std::sync::Arc;

use axum::extract::{Path as UrlPath, Query, State};
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse, Response};
use gaiter_flow::ScanId;
use gaiter_flow::account::Search;
use gaiter_flow::page::ScanShown;
use serde::Serialize;
use tokio::task::spawn_blocking;

use super::ask::json;
use super::desk::Desk;
use super::endpoint::HttpEndpoint;
use super::files::Row;
use super::snapshot;

/// How many scans one answer lists.
const LIMIT: u32 = 50;

/// The scans that were found.
#[derive(Debug, Serialize)]
struct Found {
    scans: Vec<ScanShown>,
    /// Where the next part begins, if there is one.
    next: Option<u32>,
}

/// `/scans?text=…&state=…&from=…&until=…&incomplete=true&offset=…`: the scans, newest first; 403 for a
/// reader who may not see whose scans these are.
pub async fn scans(
    State(endpoint): State<Arc<HttpEndpoint>>,
    Query(search): Query<Search>,
    headers: HeaderMap,
) -> Response {
    if !endpoint.shows_ids(&headers, None) {
        return StatusCode::FORBIDDEN.into_response();
    }
    let search = Search { limit: LIMIT, ..search };
    let found = spawn_blocking(move || {
        let (scans, has_more) = snapshot::found(&endpoint.desk, &search);
        Found { scans, next: has_more.then_some(search.offset.saturating_add(LIMIT)) }
    });
    answer(found.await.map_err(|_| StatusCode::INTERNAL_SERVER_ERROR))
}

/// `/scan/ID`: the rows of one scan with the details of their records.
pub async fn one(
    State(endpoint): State<Arc<HttpEndpoint>>,
    UrlPath(scan): UrlPath<String>,
    headers: HeaderMap,
) -> Response {
    answer(endpoint.of_scan(&scan, &headers, snapshot::one).await)
}

/// `/scan/ID/measures?of=KEY`: every measure of the record, for a person who sets some of them.
pub async fn measures(
    State(endpoint): State<Arc<HttpEndpoint>>,
    UrlPath(scan): UrlPath<String>,
    Query(row): Query<Row>,
    headers: HeaderMap,
) -> Response {
    let sheet = move |desk: &Desk, scan: &ScanId| snapshot::sheet(desk, scan, row.key());
    answer(endpoint.of_scan(&scan, &headers, sheet).await)
}

fn answer(of: Result<impl Serialize, StatusCode>) -> Response {
    match of {
        Ok(of) => json(&of),
        Err(status) => status.into_response(),
    }
}
