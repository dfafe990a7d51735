//! The control socket's server. Slow or flooding clients only delay other clients, for a
//! while, and never the station: so many at a time, so long a line, so much time for each.

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
use crate::station::assembly::Station;
use crate::station::stop::Stop;

/// So many connections are served at a time; further ones wait in the kernel.
const MOST_CLIENTS: usize = 8;

/// A request has come by then, or never will.
const REQUEST_TIME: Duration = Duration::from_secs(5);

/// An answer is found and taken by then.
const ANSWER_TIME: Duration = Duration::from_secs(30);

/// How often the socket's name is looked at: somebody may have removed it, and nobody could ask.
const RECHECK: Duration = Duration::from_secs(30);

/// The pause before the socket is tried again where it cannot be had.
const RETRY: Duration = Duration::from_secs(10);

/// For the station's user, and root.
const SOCKET_MODE: u32 = 0o600;

/// Serves the control socket until it is asked to stop, and removes it then.
///
/// # Errors
/// None; the type is that of all workers.
pub async fn worker(station: Arc<Station>, mut stop: Stop) -> Result<(), JoinError> {
    let path = control_path(&station.config.station.state_dir);
    let mut said = false;
    while !stop.is_requested() {
        match listen(&path) {
            Ok(listener) => {
                said = false;
                let clients = Arc::new(Semaphore::new(MOST_CLIENTS));
                serve(&station, &listener, &clients, &path, &mut stop).await;
                // Without its name nobody else finds it. At the next start it is made anew in any case.
                let _ = fs::remove_file(&path);
                let left = answer_those_who_wait(&station, listener, &clients);
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

/// Makes the socket in place of an old one; the state folder's lock proves that nobody serves it.
fn listen(path: &Path) -> io::Result<UnixListener> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
        _ => {}
    }
    let listener = UnixListener::bind(path)?;
    // Until here the state folder, for its owner only, keeps others out.
    fs::set_permissions(path, Permissions::from_mode(SOCKET_MODE))?;
    Ok(listener)
}

/// Serves until a stop is asked for or the socket's name is no longer that of this socket.
async fn serve(
    station: &Arc<Station>,
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
        let station = Arc::clone(station);
        tokio::spawn(async move {
            let permit = Arc::new(permit);
            // A client that goes away or says nothing has its answer already.
            let _ = converse(&station, stream, &permit).await;
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

/// Answers those who had connected before the socket lost its name: a question that is asked while the
/// station reloads is not cut off.
///
/// # Errors
/// Where the listener cannot be asked without waiting.
fn answer_those_who_wait(
    station: &Arc<Station>,
    listener: UnixListener,
    clients: &Arc<Semaphore>,
) -> io::Result<()> {
    let listener = listener.into_std()?;
    while let Ok((stream, _)) = listener.accept() {
        stream.set_nonblocking(true)?;
        let stream = UnixStream::from_std(stream)?;
        let (station, clients) = (Arc::clone(station), Arc::clone(clients));
        tokio::spawn(async move {
            let Ok(permit) = clients.acquire_owned().await else { return };
            // A client that goes away or says nothing has its answer already.
            let _ = converse(&station, stream, &Arc::new(permit)).await;
        });
    }
    Ok(())
}

/// One request, one answer. The permit is kept until the journal has been asked, too, so that
/// impatient clients cannot pile up questions to it.
async fn converse(
    station: &Arc<Station>,
    stream: UnixStream,
    permit: &Arc<Permit>,
) -> io::Result<()> {
    let (reading, mut writing) = stream.into_split();
    let mut line = Vec::new();
    let mut reading = BufReader::new(reading.take(REQUEST_MOST));
    timeout(REQUEST_TIME, reading.read_until(b'\n', &mut line)).await??;
    let (station, kept) = (Arc::clone(station), Arc::clone(permit));
    let answered = spawn_blocking(move || {
        let _kept = kept;
        match serde_json::from_slice::<Request>(&line) {
            Ok(request) => answer(&station, &request),
            Err(error) => {
                let message = format!("the request cannot be read: {error}");
                Answer::Fault(Fault::new(FaultKind::Request, "request-malformed", message))
            }
        }
    });
    let answer = timeout(ANSWER_TIME, answered).await?.unwrap_or_else(|panic| {
        let message = format!("the answer was cut off: {panic}");
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
