//! The control socket's server. Slow or flooding clients only delay other clients, for a while, and
//! never the station: the number of clients, the length of a request and the time for each are limited.

use std::fs::{self, Permissions};
use std::io;
use std::os::unix::fs::{MetadataExt, PermissionsExt};
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use tokio::io::{AsyncBufReadExt, AsyncReadExt, AsyncWriteExt, BufReader};
use tokio::net::{UnixListener, UnixStream};
use tokio::sync::Semaphore;
use tokio::task::{JoinError, spawn_blocking};
use tokio::time::{sleep, timeout};
use tracing::{info, warn};

use super::answer::answer;
use super::protocol::{Answer, Fault, FaultKind, REQUEST_MOST, Request};
use crate::config::control_path;
use crate::station::operator::page::desk::Desk;
use crate::station::runtime::stop::Stop;

/// The number of connections served at once; further ones wait in the kernel.
const MOST_CLIENTS: usize = 8;

/// How long a request may take to arrive.
const REQUEST_TIME: Duration = Duration::from_secs(5);

/// How long it may take to find an answer, and to send it.
const ANSWER_TIME: Duration = Duration::from_secs(30);

/// How often the socket's name is checked. If another process removed it, no client could connect.
const RECHECK: Duration = Duration::from_secs(30);

/// The pause before the socket is tried again after a failure.
const RETRY: Duration = Duration::from_secs(10);

/// For the station's user and root only.
const SOCKET_MODE: u32 = 0o600;

/// Serves the control socket until asked to stop, and then removes it.
///
/// # Errors
/// None; all workers have this type.
pub async fn worker(desk: Arc<Desk>, mut stop: Stop) -> Result<(), JoinError> {
    let path = control_path(&desk.core.config.station.state_dir);
    let mut said = false;
    while !stop.is_requested() {
        match listen(&path) {
            Ok(listener) => {
                said = false;
                let clients = Arc::new(Semaphore::new(MOST_CLIENTS));
                serve(&desk, &listener, &clients, &path, &mut stop).await;
                // Without its name no client finds it. The next start creates it again in any case.
                let _ = fs::remove_file(&path);
                let left = answer_those_who_wait(&desk, listener, &clients);
                let _ = left.inspect_err(|error| warn!(event = "control-unavailable", %error));
            }
            Err(error) => {
                if !std::mem::replace(&mut said, true) {
                    warn!(event = "control-unavailable", %error);
                }
                tokio::select! {
                    () = stop.requested() => {}
                    () = sleep(RETRY) => {}
                }
            }
        }
    }
    Ok(())
}

/// Creates the socket in place of an old one; the state folder's lock proves that no one serves it.
fn listen(path: &Path) -> io::Result<UnixListener> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
        _ => {}
    }
    let listener = UnixListener::bind(path)?;
    // Until now, the state folder kept others out because only its owner can enter it.
    fs::set_permissions(path, Permissions::from_mode(SOCKET_MODE))?;
    Ok(listener)
}

/// Serves until a stop is requested or the path no longer names this socket.
async fn serve(
    desk: &Arc<Desk>,
    listener: &UnixListener,
    clients: &Arc<Semaphore>,
    path: &Path,
    stop: &mut Stop,
) {
    let made = inode(path);
    loop {
        let accepted = tokio::select! {
            () = stop.requested() => return,
            () = sleep(RECHECK) => {
                if inode(path) != made {
                    info!(event = "control-renewed");
                    return;
                }
                continue;
            }
            accepted = next(clients, listener) => accepted,
        };
        let Ok((stream, permit)) = accepted else {
            // No file descriptors are left; a hot loop would not free any.
            sleep(REQUEST_TIME).await;
            continue;
        };
        let desk = Arc::clone(desk);
        tokio::spawn(async move {
            let permit = Arc::new(permit);
            // A client that disconnects or sends nothing needs no answer.
            let _ = converse(&desk, stream, &permit).await;
        });
    }
}

type Permit = tokio::sync::OwnedSemaphorePermit;

async fn next(
    clients: &Arc<Semaphore>,
    listener: &UnixListener,
) -> io::Result<(UnixStream, Permit)> {
    let permit = Arc::clone(clients).acquire_owned().await.map_err(io::Error::other)?;
    Ok((listener.accept().await?.0, permit))
}

/// Answers clients that connected before the socket lost its name, so that a reload of the station does
/// not cut off their requests.
///
/// # Errors
/// Any I/O error at the listener or at a connection.
fn answer_those_who_wait(
    desk: &Arc<Desk>,
    listener: UnixListener,
    clients: &Arc<Semaphore>,
) -> io::Result<()> {
    let listener = listener.into_std()?;
    while let Ok((stream, _)) = listener.accept() {
        stream.set_nonblocking(true)?;
        let stream = UnixStream::from_std(stream)?;
        let (desk, clients) = (Arc::clone(desk), Arc::clone(clients));
        tokio::spawn(async move {
            let Ok(permit) = clients.acquire_owned().await else { return };
            // A client that disconnects or sends nothing needs no answer.
            let _ = converse(&desk, stream, &Arc::new(permit)).await;
        });
    }
    Ok(())
}

/// Handles one request and its answer. The permit is also held until the journal has been read, so that
/// impatient clients cannot pile up queries.
async fn converse(desk: &Arc<Desk>, stream: UnixStream, permit: &Arc<Permit>) -> io::Result<()> {
    let (reading, mut writing) = stream.into_split();
    let mut line = Vec::new();
    let mut reading = BufReader::new(reading.take(REQUEST_MOST));
    timeout(REQUEST_TIME, reading.read_until(b'\n', &mut line)).await??;
    let (desk, kept) = (Arc::clone(desk), Arc::clone(permit));
    let answered = spawn_blocking(move || {
        let _kept = kept;
        match serde_json::from_slice::<Request>(&line) {
            Ok(request) => answer(&desk, &request),
            Err(error) => {
                let message = format!("the request cannot be read: {error}");
                Answer::Fault(Fault::new(FaultKind::Request, "request-malformed", message))
            }
        }
    });
    let answer = timeout(ANSWER_TIME, answered).await?.unwrap_or_else(|panic| {
        let message = format!("the answer was interrupted: {panic}");
        Answer::Fault(Fault::new(FaultKind::Failed, "panic", message))
    });
    let mut line = serde_json::to_vec(&answer)?;
    line.push(b'\n');
    timeout(ANSWER_TIME, writing.write_all(&line)).await??;
    writing.shutdown().await
}

fn inode(path: &Path) -> Option<u64> {
    fs::symlink_metadata(path).ok().map(|metadata| metadata.ino())
}
