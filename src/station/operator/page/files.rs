//! Files of a scan's record, from the folder that the journal names, its latest revision, or a held
//! scan's preview; never from a path in a request.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;
use std::sync::Arc;

use axum::extract::{Path as Asked, State};
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use tokio::task::spawn_blocking;

use super::endpoint::HttpEndpoint;
use super::snapshot;
use crate::flow::ScanId;
use crate::flow::page::FILES;
use crate::store::revision;

/// The largest file that is served, bytes: a report has under two million.
const MOST: u64 = 32_000_000;

/// `/scan/ID/FILE`: 404 for a missing file, 403 for a file that this reader may not see.
pub async fn file(
    State(endpoint): State<Arc<HttpEndpoint>>,
    Asked((scan, name)): Asked<(String, String)>,
    headers: HeaderMap,
) -> Response {
    let none = StatusCode::NOT_FOUND;
    let Some(file) = FILES.iter().find(|file| file.name == name) else {
        return none.into_response();
    };
    let Ok(scan) = ScanId::parse(&scan) else { return none.into_response() };
    if file.names_patient && !endpoint.shows_ids(&headers, None) {
        let sentence = "this file names a patient: open the page with the link from gaiter page\n";
        return (StatusCode::FORBIDDEN, sentence).into_response();
    }
    let Ok(reader) = Arc::clone(&endpoint.desk.readers).try_acquire_owned() else {
        return (StatusCode::SERVICE_UNAVAILABLE, "the record store is busy\n").into_response();
    };
    let read = spawn_blocking(move || {
        let _reader = reader;
        let whole = endpoint.desk.core.custody.journal().whole(&scan);
        let whole =
            whole.inspect_err(|error| endpoint.desk.core.check_corruption(error)).ok()??;
        bytes(&revision::latest(&snapshot::folder(&endpoint.desk, &whole)?).join(file.name)).ok()
    });
    match read.await {
        Ok(Some(bytes)) => {
            let kinds =
                [(header::CONTENT_TYPE, file.kind), (header::CONTENT_SECURITY_POLICY, file.policy)];
            (kinds, bytes).into_response()
        }
        _ => none.into_response(),
    }
}

fn bytes(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    File::open(path)?.take(MOST).read_to_end(&mut bytes)?;
    Ok(bytes)
}
