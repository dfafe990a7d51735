//! The workers of one generation, and their names.

use std::sync::Arc;
use std::time::Duration;

use tokio::sync::mpsc;
use tokio::task::{JoinError, JoinSet};

use super::assembly::Station;
use super::booth::{self, orders, trigger};
use super::delivery::{self, preview};
use super::error::{StationError, Worker};
use super::fleet;
use super::housekeeping;
use super::intake::export_locks::ExportLocks;
use super::intake::{self, ExportDir};
use super::operator::http;
use super::operator::http::listeners::Listeners;
use super::runtime::{Heartbeat, Stop, Stopper};

/// What belongs to the process and outlives a reload: its export folders, the addresses on which it listens
/// and the control socket. No other process gets them while workers change.
#[derive(Debug, Default)]
pub struct ProcessResources {
    /// The addresses of the page's endpoints, and the control socket.
    pub listeners: Arc<Listeners>,
    /// The export folders.
    pub export_locks: Arc<ExportLocks>,
}

/// Workers that run. Each ends with its name, however it ends.
type Tasks = JoinSet<Result<Worker, StationError>>;

/// The workers and their heartbeats.
pub struct Workers {
    tasks: Tasks,
    /// The delivery: it may be ended while the others continue.
    delivery: Tasks,
    delivery_stopper: Stopper,
    /// The workers that answer people and monitors: they continue until the others have ended.
    endpoints: Tasks,
    endpoints_stopper: Stopper,
    beats: Vec<(Worker, Heartbeat)>,
}

impl Workers {
    /// Starts the workers of a station. The receiver closes when every intake has looked once.
    pub fn start(
        station: &Station,
        resources: &ProcessResources,
        stop: &Stop,
    ) -> (Workers, mpsc::Receiver<()>) {
        let (endpoints_stopper, endpoints_stop) = Stopper::new();
        let (delivery_stopper, delivery_stop) = Stopper::new();
        let mut workers = Workers {
            tasks: JoinSet::new(),
            delivery: JoinSet::new(),
            delivery_stopper,
            endpoints: JoinSet::new(),
            endpoints_stopper,
            beats: Vec::new(),
        };
        let first_looks = workers.start_intakes(station, resources, stop);
        workers.start_booth(station, stop);
        let Station { core, booth, previews, .. } = station;
        let beat = workers.beat_of(Worker::Delivery);
        let task = delivery::worker(Arc::clone(booth), beat, delivery_stop);
        spawn(&mut workers.delivery, Worker::Delivery, task);
        let task =
            |beat| preview::worker(Arc::clone(booth), Arc::clone(previews), beat, stop.clone());
        workers.start_one(Worker::Preview, task);
        let task = |beat| housekeeping::worker(Arc::clone(core), beat, stop.clone());
        workers.start_one(Worker::Housekeeping, task);
        if let Some(archive) = &core.config.store.archive {
            let place = archive.place.clone();
            let task = |beat| fleet::worker(Arc::clone(core), place, beat, stop.clone());
            workers.start_one(Worker::Fleet, task);
        }
        // They wait for people and monitors and have no heartbeat: nothing depends on them.
        let (desk, listeners) = (Arc::clone(&station.desk), Arc::clone(&resources.listeners));
        let task = http::worker(desk, listeners, endpoints_stop);
        spawn(&mut workers.endpoints, Worker::Http, task);
        (workers, first_looks)
    }

    fn start_intakes(
        &mut self,
        station: &Station,
        resources: &ProcessResources,
        stop: &Stop,
    ) -> mpsc::Receiver<()> {
        let (looked, first_looks) = mpsc::channel(1);
        let export_dirs = station.core.config.scanner.export_dirs.iter().cloned().enumerate();
        for (place, folder) in export_dirs {
            let (booth, locks) = (Arc::clone(&station.booth), Arc::clone(&resources.export_locks));
            let (dir, stop, looked) = (ExportDir { place, folder }, stop.clone(), looked.clone());
            let task = |beat| intake::worker(booth, locks, dir, beat, stop, looked);
            self.start_one(Worker::Intake { folder: place }, task);
        }
        first_looks
    }

    /// Starts the workers for orders, worklist, captures and light, and for the ports of buttons and readers.
    fn start_booth(&mut self, station: &Station, stop: &Stop) {
        let Station { core, booth, .. } = station;
        if let Some(config) = core.config.patient.orders.clone() {
            let task = |beat| orders::worker(Arc::clone(booth), config, beat, stop.clone());
            self.start_one(Worker::Orders, task);
        }
        #[cfg(feature = "dicom")]
        if let Some(config) = core.config.patient.worklist.clone() {
            let task =
                |beat| booth::worklist::worker(Arc::clone(booth), config, beat, stop.clone());
            self.start_one(Worker::Worklist, task);
        }
        let task = |beat| booth::worker(Arc::clone(booth), beat, stop.clone());
        self.start_one(Worker::Booth, task);
        for port in trigger::of_config(&core.config.trigger) {
            let worker = Worker::Trigger { port: port.name };
            let task = |beat| trigger::worker(Arc::clone(booth), port, beat, stop.clone());
            self.start_one(worker, task);
        }
    }

    fn start_one<T>(&mut self, worker: Worker, task: impl FnOnce(Heartbeat) -> T)
    where
        T: Future<Output = Result<(), JoinError>> + Send + 'static,
    {
        let beat = self.beat_of(worker);
        spawn(&mut self.tasks, worker, task(beat));
    }

    fn beat_of(&mut self, worker: Worker) -> Heartbeat {
        let beat = Heartbeat::default();
        self.beats.push((worker, beat.clone()));
        beat
    }

    /// The worker whose last heartbeat is older than `most`, if any.
    pub fn hung(&self, most: Duration) -> Option<Worker> {
        let hung = self.beats.iter().find(|(_, beat)| beat.age() > most);
        hung.map(|(worker, _)| *worker)
    }

    /// Completes when a worker ends without being asked to.
    pub async fn one_ended(&mut self) -> StationError {
        let ended = tokio::select! {
            Some(ended) = next_end(&mut self.tasks) => ended,
            Some(ended) = next_end(&mut self.delivery) => ended,
            Some(ended) = next_end(&mut self.endpoints) => ended,
            else => Ok(Worker::Delivery),
        };
        match ended {
            Ok(worker) => StationError::WorkerStopped { worker },
            Err(error) => error,
        }
    }

    /// Ends the delivery; completes when all that it has in hand is over.
    ///
    /// # Errors
    /// Its failure.
    pub async fn end_delivery(&mut self) -> Result<(), StationError> {
        self.delivery_stopper.request();
        all_ended(&mut self.delivery).await
    }

    /// Completes when all workers except the endpoints have ended, as requested.
    ///
    /// # Errors
    /// The first failure among them.
    pub async fn rest(&mut self) -> Result<(), StationError> {
        let delivery = self.end_delivery().await;
        let others = all_ended(&mut self.tasks).await;
        delivery.and(others)
    }

    /// Closes the endpoints; completes when they are closed.
    ///
    /// # Errors
    /// The first failure among them.
    pub async fn close_endpoints(&mut self) -> Result<(), StationError> {
        self.endpoints_stopper.request();
        all_ended(&mut self.endpoints).await
    }
}

/// Starts a worker as a task within a task: the outer one outlives its panic and names it, and the inner one ends when
/// the outer one is dropped.
fn spawn(
    tasks: &mut Tasks,
    worker: Worker,
    task: impl Future<Output = Result<(), JoinError>> + Send + 'static,
) {
    tasks.spawn(async move {
        let mut within = JoinSet::new();
        within.spawn(task);
        let ended = within.join_next().await.map_or(Ok(()), Result::flatten);
        ended.map(|()| worker).map_err(|source| StationError::WorkerPanicked { worker, source })
    });
}

/// How the next of these workers has ended; `None` once all have.
async fn next_end(tasks: &mut Tasks) -> Option<Result<Worker, StationError>> {
    tasks.join_next().await.and_then(Result::ok)
}

/// Completes when all of these have ended.
async fn all_ended(tasks: &mut Tasks) -> Result<(), StationError> {
    let mut all = Ok(());
    while let Some(ended) = next_end(tasks).await {
        all = all.and(ended.map(|_| ()));
    }
    all
}
