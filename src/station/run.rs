//! Running the station: its workers, and the loop that names every end of a worker.

use std::collections::BTreeMap;
use std::future::Future;
use std::sync::Arc;
use std::time::Duration;

use sd_notify::NotifyState;
use tokio::sync::mpsc::{self, UnboundedSender};
use tokio::task::{Id, JoinError, JoinSet, spawn_blocking};
use tokio::time::timeout;
use tracing::{info, warn};

use super::assembly::Station;
use super::error::{StationError, Worker};
use super::event::{Observer, StationEvent};
use super::stop::{Stop, Stopper};
use super::{control, delivery, http, intake};
use crate::config::Config;

/// How long the first looks are waited for before the station calls itself ready: a share that
/// does not answer must not keep the other folders' station from starting.
const FIRST_LOOKS: Duration = Duration::from_secs(10);

/// How long work in hand may take after a stop was asked for. What it cuts off is taken up at the
/// next start. `TimeoutStopSec` of the unit is longer.
const GRACE: Duration = Duration::from_secs(20);

/// Runs the station until `stop` ends, or until it cannot go on. `observer` is told what happens.
///
/// A blocking step on a share that does not answer cannot be cut off: whoever owns the runtime
/// shuts it down without waiting (`Runtime::shutdown_background`).
///
/// # Errors
/// See [`StationError`]; the journal makes it harmless to start again.
pub async fn run(
    config: Config,
    stop: impl Future<Output = ()>,
    observer: Option<UnboundedSender<StationEvent>>,
) -> Result<(), StationError> {
    let open = spawn_blocking(move || Station::open(config, Observer::new(observer)));
    let station = Arc::new(open.await.map_err(StationError::Start)??);
    let (stopper, asked) = Stopper::new();
    let (workers, looked) = Workers::start(&station, &asked);
    let ready = async {
        if timeout(FIRST_LOOKS, first_looks(looked)).await.is_err() {
            warn!(event = "first-look-outstanding");
        }
        tell_ready(&station);
    };
    let ended = workers.supervise(&stopper, stop, ready).await;
    info!(event = "station-ended", failed = ended.is_err());
    ended
}

/// Ends when every intake has looked once: each drops its sender after its first look.
async fn first_looks(mut looked: mpsc::Receiver<()>) {
    while looked.recv().await.is_some() {}
}

fn tell_ready(station: &Station) {
    info!(event = "station-ready");
    tell_systemd(NotifyState::Ready);
    station.observer.tell(StationEvent::Ready);
}

/// Tells the service manager, if there is one; without one this is nothing.
fn tell_systemd(state: NotifyState<'_>) {
    if let Err(error) = sd_notify::notify(&[state]) {
        warn!(event = "notify-failed", %error);
    }
}

/// The workers and who is who.
struct Workers {
    tasks: JoinSet<Result<(), JoinError>>,
    names: BTreeMap<Id, Worker>,
}

impl Workers {
    fn start(station: &Arc<Station>, stop: &Stop) -> (Workers, mpsc::Receiver<()>) {
        let mut workers = Workers { tasks: JoinSet::new(), names: BTreeMap::new() };
        let (looked, first_looks) = mpsc::channel(1);
        for (folder, path) in station.config.scanner.export_dirs.iter().enumerate() {
            let (station, stop) = (Arc::clone(station), stop.clone());
            let task = intake::worker(station, folder, path.clone(), stop, looked.clone());
            workers.spawn(Worker::Intake { folder }, task);
        }
        workers.spawn(Worker::Delivery, delivery::worker(Arc::clone(station), stop.clone()));
        workers.spawn(Worker::Http, http::worker(Arc::clone(station), stop.clone()));
        workers.spawn(Worker::Control, control::worker(Arc::clone(station), stop.clone()));
        (workers, first_looks)
    }

    fn spawn(
        &mut self,
        worker: Worker,
        task: impl Future<Output = Result<(), JoinError>> + Send + 'static,
    ) {
        let id = self.tasks.spawn(task).id();
        self.names.insert(id, worker);
    }

    /// Waits for the stop or the first failure, then for all workers to end.
    async fn supervise(
        mut self,
        stopper: &Stopper,
        stop: impl Future<Output = ()>,
        ready: impl Future<Output = ()>,
    ) -> Result<(), StationError> {
        let mut failure = Ok(());
        let mut is_ready = false;
        tokio::pin!(stop, ready);
        while !stopper.is_requested() {
            tokio::select! {
                () = &mut stop => stopper.request(),
                () = &mut ready, if !is_ready => is_ready = true,
                Some(ended) = self.tasks.join_next_with_id() => {
                    failure = self.judge(ended, stopper);
                    stopper.request();
                }
            }
        }
        tell_systemd(NotifyState::Stopping);
        info!(event = "station-stopping");
        let rest = async {
            while let Some(ended) = self.tasks.join_next_with_id().await {
                let ended = self.judge(ended, stopper);
                if failure.is_ok() {
                    failure = ended;
                }
            }
        };
        if timeout(GRACE, rest).await.is_err() {
            warn!(event = "stop-grace-over");
        }
        failure
    }

    /// Every end of a worker has a name.
    fn judge(
        &self,
        ended: Result<(Id, Result<(), JoinError>), JoinError>,
        stopper: &Stopper,
    ) -> Result<(), StationError> {
        let id = match &ended {
            Ok((id, _)) => *id,
            Err(panic) => panic.id(),
        };
        let worker = self.names.get(&id).copied().unwrap_or(Worker::Delivery);
        match ended {
            Err(source) => Err(StationError::WorkerPanicked { worker, source }),
            Ok((_, Err(source))) => Err(StationError::WorkerFailed { worker, source }),
            Ok((_, Ok(()))) if !stopper.is_requested() => {
                Err(StationError::WorkerStopped { worker })
            }
            Ok((_, Ok(()))) => Ok(()),
        }
    }
}
