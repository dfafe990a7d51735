//! The workers of one generation, and who is who.

use std::collections::BTreeMap;
use std::future::Future;
use std::sync::Arc;
use std::time::Duration;

use tokio::sync::mpsc;
use tokio::task::{Id, JoinError, JoinSet};

use super::assembly::Station;
use super::beat::Beat;
use super::booth::{self, orders, trigger};
use super::custody::housekeeping;
use super::delivery::{self, preview};
use super::error::{StationError, Worker};
use super::intake;
use super::operator::{control, http};
use super::stop::{Stop, Stopper};

/// The workers, their names and their beats.
pub struct Workers {
    tasks: JoinSet<Result<(), JoinError>>,
    /// Those who answer people and monitors: they go on until the others have ended.
    endpoints: JoinSet<Result<(), JoinError>>,
    doors_stopper: Stopper,
    names: BTreeMap<Id, Worker>,
    beats: Vec<(Worker, Beat)>,
}

impl Workers {
    /// Starts the workers of a station. The receiver ends when every intake has looked once.
    pub fn start(station: &Arc<Station>, stop: &Stop) -> (Workers, mpsc::Receiver<()>) {
        let (doors_stopper, doors_stop) = Stopper::new();
        let mut workers = Workers {
            tasks: JoinSet::new(),
            endpoints: JoinSet::new(),
            doors_stopper,
            names: BTreeMap::new(),
            beats: Vec::new(),
        };
        let (looked, first_looks) = mpsc::channel(1);
        for (folder, path) in station.config.scanner.export_dirs.iter().enumerate() {
            let (worker, stop) = (Worker::Intake { folder }, stop.clone());
            let (beat, station) = (workers.beat(worker), Arc::clone(station));
            let task = intake::worker(station, folder, path.clone(), beat, stop, looked.clone());
            workers.spawn(worker, task);
        }
        if let Some(config) = station.config.patient.orders.clone() {
            let beat = workers.beat(Worker::Orders);
            let task = orders::worker(Arc::clone(station), config, beat, stop.clone());
            workers.spawn(Worker::Orders, task);
        }
        let beat = workers.beat(Worker::Delivery);
        workers.spawn(Worker::Delivery, delivery::worker(Arc::clone(station), beat, stop.clone()));
        let beat = workers.beat(Worker::Preview);
        workers.spawn(Worker::Preview, preview::worker(Arc::clone(station), beat, stop.clone()));
        let beat = workers.beat(Worker::Housekeeping);
        let task = housekeeping::worker(Arc::clone(station), beat, stop.clone());
        workers.spawn(Worker::Housekeeping, task);
        let beat = workers.beat(Worker::Booth);
        workers.spawn(Worker::Booth, booth::worker(Arc::clone(station), beat, stop.clone()));
        for port in trigger::of_config(&station.config.trigger) {
            let worker = Worker::Trigger { port: port.name };
            let beat = workers.beat(worker);
            workers.spawn(worker, trigger::worker(Arc::clone(station), port, beat, stop.clone()));
        }
        // These wait for people and monitors, and have no beat: nothing hangs on them.
        let http = http::worker(Arc::clone(station), doors_stop.clone());
        let id = workers.endpoints.spawn(http).id();
        workers.names.insert(id, Worker::Http);
        let control = control::worker(Arc::clone(station), doors_stop);
        let id = workers.endpoints.spawn(control).id();
        workers.names.insert(id, Worker::Control);
        (workers, first_looks)
    }

    fn beat(&mut self, worker: Worker) -> Beat {
        let beat = Beat::default();
        self.beats.push((worker, beat.clone()));
        beat
    }

    fn spawn(
        &mut self,
        worker: Worker,
        task: impl Future<Output = Result<(), JoinError>> + Send + 'static,
    ) {
        let id = self.tasks.spawn(task).id();
        self.names.insert(id, worker);
    }

    /// The worker whose last beat is older than it may be, if any.
    pub fn hung(&self, most: Duration) -> Option<Worker> {
        let hung = self.beats.iter().find(|(_, beat)| beat.age() > most);
        hung.map(|(worker, _)| *worker)
    }

    /// Ends when a worker does, although nobody asked it to.
    pub async fn one_ended(&mut self) -> StationError {
        let ended = tokio::select! {
            Some(ended) = self.tasks.join_next_with_id() => Some(ended),
            Some(ended) = self.endpoints.join_next_with_id() => Some(ended),
            else => None,
        };
        match ended {
            Some(ended) => {
                let worker = self.who(&ended);
                judge(worker, ended).err().unwrap_or(StationError::WorkerStopped { worker })
            }
            None => StationError::WorkerStopped { worker: Worker::Delivery },
        }
    }

    /// Ends when all workers have ended, as they were asked to, but for the endpoints.
    ///
    /// # Errors
    /// The first failure among them.
    pub async fn rest(&mut self) -> Result<(), StationError> {
        let mut rest = Ok(());
        while let Some(ended) = self.tasks.join_next_with_id().await {
            let ended = judge(self.who(&ended), ended);
            rest = rest.and(ended);
        }
        rest
    }

    /// Closes the endpoints; ends when they are closed.
    ///
    /// # Errors
    /// The first failure among them.
    pub async fn close_endpoints(&mut self) -> Result<(), StationError> {
        self.doors_stopper.request();
        let mut rest = Ok(());
        while let Some(ended) = self.endpoints.join_next_with_id().await {
            let ended = judge(self.who(&ended), ended);
            rest = rest.and(ended);
        }
        rest
    }

    fn who(&self, ended: &Result<(Id, Result<(), JoinError>), JoinError>) -> Worker {
        let id = match ended {
            Ok((id, _)) => *id,
            Err(panic) => panic.id(),
        };
        self.names.get(&id).copied().unwrap_or(Worker::Delivery)
    }
}

/// Every end of a worker has a name.
fn judge(
    worker: Worker,
    ended: Result<(Id, Result<(), JoinError>), JoinError>,
) -> Result<(), StationError> {
    match ended {
        Err(source) => Err(StationError::WorkerPanicked { worker, source }),
        Ok((_, Err(source))) => Err(StationError::WorkerFailed { worker, source }),
        Ok((_, Ok(()))) => Ok(()),
    }
}
