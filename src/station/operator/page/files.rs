//! Files of a scan's record, out of the folder that the journal names, or its latest revision, or of a
//! held scan's preview: never a path of a request.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;
use std::sync::Arc;

use axum::extract::{Path as Asked, State};
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use tokio::task::spawn_blocking;

use super::{HttpEndpoint, snapshot};
use crate::flow::ScanId;
use crate::store::revision;

/// A file of a record that the page shows.
#[derive(Debug)]
pub struct Shown {
    /// Its name.
    pub name: &'static str,
    kind: &'static str,
    policy: &'static str,
    /// It says whose the scan is.
    names_patient: bool,
}

/// A drawing runs nothing and fetches nothing.
const DRAWING: &str = "default-src 'none'; style-src 'unsafe-inline'; frame-ancestors 'none'";

/// A report runs its own viewer, as a page of nobody: it reaches neither the token nor the station.
const REPORT: &str = "sandbox allow-scripts allow-modals; default-src 'none'; \
                      script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; \
                      font-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// Data for programs.
const DATA: &str = "default-src 'none'; frame-ancestors 'none'";

/// The browser's own reader of such files draws with styles of its own.
const PAPER: &str = "default-src 'self'; style-src 'unsafe-inline'; script-src 'none'; \
                     frame-ancestors 'self'";

/// The files that are served, and no other.
pub const FILES: [Shown; 4] = [
    Shown {
        name: "report.html",
        kind: "text/html; charset=utf-8",
        policy: REPORT,
        names_patient: true,
    },
    Shown { name: "report.pdf", kind: "application/pdf", policy: PAPER, names_patient: true },
    Shown { name: "legs.svg", kind: "image/svg+xml", policy: DRAWING, names_patient: false },
    Shown { name: "record.json", kind: "application/json", policy: DATA, names_patient: true },
];

/// The largest file that is served, bytes: a report has under two million.
const MOST: u64 = 32_000_000;

/// `/scan/ID/FILE`: 404 for what is not there, 403 for what this reader may not know.
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
        let sentence = "this names a patient: open the page with the link of gaiter page\n";
        return (StatusCode::FORBIDDEN, sentence).into_response();
    }
    let Ok(reader) = Arc::clone(&endpoint.station.page.readers).try_acquire_owned() else {
        return (StatusCode::SERVICE_UNAVAILABLE, "the record store is busy\n").into_response();
    };
    let read = spawn_blocking(move || {
        let _reader = reader;
        let whole = endpoint.station.custody.journal().whole(&scan);
        let whole = whole.inspect_err(|error| endpoint.station.check_corruption(error)).ok()??;
        bytes(&revision::latest(&snapshot::folder(&endpoint.station, &whole)?).join(file.name)).ok()
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
