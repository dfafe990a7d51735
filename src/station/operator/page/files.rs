//! Files of a scan's record, from the folder that the journal names, its latest revision, or a held
//! scan's preview; never from a path in a request. A file that is not what the record's `SHA256SUMS`
//! lists is not handed out.

use std::fs::File;
use std::io::{self, Read, Seek};
use std::path::Path;
use std::sync::Arc;

use axum::body::Body;
use axum::extract::{Path as UrlPath, Query, State};
use axum::http::{HeaderMap, Method, StatusCode, header};
use axum::response::{IntoResponse, Response};
use gaiter_flow::ScanId;
use gaiter_flow::page::files::served;
use hyper::body::Bytes;
use rustix::fs::Mode;
use serde::Deserialize;
use tokio::sync::{Semaphore, mpsc};
use tokio::task::spawn_blocking;

use super::endpoint::HttpEndpoint;
use super::{Pieces, snapshot};
use crate::station::share::stamped_file::{PIECE_BYTES, READ};
use crate::store::{revision, sums};

/// Why a file is not served.
enum NotServed {
    /// The record has no such file, or cannot be read now.
    Absent,
    /// It was changed since the record was made.
    Changed,
}

/// Which row of a scan.
#[derive(Debug, Deserialize)]
pub struct Row {
    of: Option<String>,
}

impl Row {
    /// The key of the row; `None` for the only one.
    pub fn key(&self) -> Option<&str> {
        self.of.as_deref().filter(|key| !key.is_empty())
    }
}

/// `/scan/ID/FILE?of=KEY`: 404 for a missing file, 403 for a reader who may not see whose scan it is, 409 for a
/// file that was changed since the record was made.
pub async fn file(
    State(endpoint): State<Arc<HttpEndpoint>>,
    UrlPath((scan, name)): UrlPath<(String, String)>,
    Query(row): Query<Row>,
    method: Method,
    headers: HeaderMap,
) -> Response {
    let opened = endpoint.of_scan(&scan, &headers, move |desk, scan| {
        let row = snapshot::row(desk, scan, row.key()).ok_or(NotServed::Absent)?;
        let folder = snapshot::folder(desk, &row).ok_or(NotServed::Absent)?;
        let opened = open(&revision::latest(&folder), &name);
        opened.map(|(file, size)| (file, headers_of(&name, scan, size)))
    });
    let (status, sentence) = match opened.await {
        Ok(Ok((file, headers))) => {
            let body = match method {
                Method::HEAD => Body::empty(),
                _ => Body::new(pieces(file, Arc::clone(&endpoint.desk.readers))),
            };
            return (headers, body).into_response();
        }
        Ok(Err(NotServed::Changed)) => (
            StatusCode::CONFLICT,
            "this file was changed since the record was made; compare it with SHA256SUMS in the \
             record's folder\n",
        ),
        Err(status @ StatusCode::FORBIDDEN) => {
            (status, "records are a patient's: open the page with the link from gaiter page\n")
        }
        Err(status @ StatusCode::SERVICE_UNAVAILABLE) => (status, "the record store is busy\n"),
        _ => (StatusCode::NOT_FOUND, "no such file: /scan/ID/FILE needs the whole id of a scan\n"),
    };
    (status, sentence).into_response()
}

/// Opens a file of a record, and reads its size. Blocks.
fn open(folder: &Path, name: &str) -> Result<(File, u64), NotServed> {
    let absent = |_| NotServed::Absent;
    let listed = sums::sum_of(folder, name).map_err(absent)?;
    if listed.is_none() && name != sums::SUMS {
        return Err(NotServed::Absent);
    }
    let file = rustix::fs::open(folder.join(name), READ, Mode::empty());
    let mut file = File::from(file.map_err(|_| NotServed::Absent)?);
    let metadata = file.metadata().map_err(absent)?;
    if !metadata.is_file() {
        return Err(NotServed::Absent);
    }
    if let Some(listed) = listed {
        if sums::read_to_end(&mut file).map_err(absent)? != listed {
            return Err(NotServed::Changed);
        }
        file.rewind().map_err(absent)?;
    }
    Ok((file, metadata.len()))
}

/// The headers of a file. A saved one gets the scan's id before its name, because files of several scans
/// often lie in one folder of downloads.
fn headers_of(name: &str, scan: &ScanId, size: u64) -> HeaderMap {
    let served = served(name);
    let saved = format!("attachment; filename=\"{}_{name}\"", scan.short());
    let saved = (!served.opens).then_some(saved);
    let values = [
        (header::CONTENT_TYPE, Some(served.kind.to_owned())),
        (header::CONTENT_SECURITY_POLICY, Some(served.policy.to_owned())),
        (header::CONTENT_LENGTH, Some(size.to_string())),
        (header::CONTENT_DISPOSITION, saved),
    ];
    let values = values.into_iter().filter_map(|(name, value)| Some((name, value?.parse().ok()?)));
    values.collect()
}

/// Reads a file while it is sent. A slow client holds no reader; a file that shrinks breaks off.
fn pieces(mut file: File, readers: Arc<Semaphore>) -> Pieces {
    let (sender, pieces) = mpsc::channel(1);
    tokio::spawn(async move {
        loop {
            let Ok(reader) = Arc::clone(&readers).acquire_owned().await else { return };
            let read = spawn_blocking(move || {
                let _reader = reader;
                let piece = piece(&mut file);
                (file, piece)
            });
            let Ok((same, piece)) = read.await else { return };
            file = same;
            let is_last = piece.as_ref().map_or(true, Bytes::is_empty);
            if sender.send(piece).await.is_err() || is_last {
                return;
            }
        }
    });
    Pieces(pieces)
}

fn piece(file: &mut File) -> io::Result<Bytes> {
    let mut bytes = Vec::new();
    file.take(PIECE_BYTES).read_to_end(&mut bytes)?;
    Ok(bytes.into())
}
