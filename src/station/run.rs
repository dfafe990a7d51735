//! Running the station: generations of workers over one state folder, and the loop that names every
//! reason for which a generation ends.

use std::future::Future;
use std::sync::Arc;
use std::time::Duration;

use tokio::sync::mpsc::{self, UnboundedSender};
use tokio::task::spawn_blocking;
use tokio::time::{interval, sleep, timeout};
use tracing::{error, info, warn};

use super::assembly::Station;
use super::error::{StationError, chain};
use super::event::{Observer, StationEvent};
use super::lasting::{Lasting, take_state_dir};
use super::stop::Stopper;
use super::workers::Workers;
use super::{jitter, service};
use crate::config::Config;
use crate::flow::backoff;
use crate::flow::confinement::Confine;

/// How long the first looks are waited for before the station calls itself ready: a share that
/// does not answer must not keep the other folders' station from starting.
const FIRST_LOOKS: Duration = Duration::from_secs(10);

/// How long work in hand may take after a stop was asked for. What it cuts off is taken up at the
/// next start. `TimeoutStopSec` of the unit is longer.
const GRACE: Duration = Duration::from_secs(20);

/// How long answers that are being given may take then.
const ENDPOINTS_CLOSE: Duration = Duration::from_secs(10);

/// How often the workers' beats are looked at where no watchdog asks for more.
const PULSE: Duration = Duration::from_secs(5);

/// A worker whose last beat is older has hung: each beats every few seconds, whatever it waits for.
const HUNG: Duration = Duration::from_secs(30);

/// A generation that lived so long was a sound one: a journal that is ruined after it is rebuilt as
/// if it were the first time. Others wait longer each time, for each ruin is kept.
const SOUND: Duration = Duration::from_secs(600);

/// What came of reading the configuration again: a new one, or what is wrong with it.
pub type Reload = Result<Box<Config>, String>;

/// What those who started the station ask of it.
#[derive(Debug)]
pub struct Orders<S> {
    /// Ends when the station is to stop.
    pub stop: S,
    /// A configuration, read again; dropped where nobody ever reloads.
    pub reload: mpsc::Receiver<Reload>,
}

impl<S> Orders<S> {
    /// Orders that only ever ask to stop.
    pub fn stop_only(stop: S) -> Orders<S> {
        Orders { stop, reload: mpsc::channel(1).1 }
    }
}

/// Why a generation of workers ended.
enum Turn {
    /// The station is to stop.
    Stop,
    /// It is to go on with this configuration.
    Reload(Box<Config>),
    /// The journal is to be rebuilt.
    Ruin,
}

/// Runs the station until it is asked to stop, or until it cannot go on. `observer` is told what
/// happens.
///
/// A blocking step on a share that does not answer cannot be cut off: the owner of the runtime
/// shuts it down without waiting (`Runtime::shutdown_background`).
///
/// # Errors
/// See [`StationError`]; the journal makes it harmless to start again.
pub async fn run(
    config: Config,
    mut orders: Orders<impl Future<Output = ()>>,
    observer: Option<UnboundedSender<StationEvent>>,
) -> Result<(), StationError> {
    let observer = Observer::new(observer);
    let state_dir = config.station.state_dir.clone();
    let lock = spawn_blocking(move || take_state_dir(&state_dir)).await;
    let lock = lock.map_err(StationError::Start)??;
    let mut config = config;
    let mut first_start = lock.first_start;
    let (mut ruins, mut first_generation) = (0, true);
    let lasting = Arc::new(Lasting::default());
    let stop = orders.stop;
    tokio::pin!(stop);
    let ended = loop {
        take_exports(&lasting, &config, first_generation).await?;
        first_generation = false;
        let (next, shared) = (config.clone(), (observer.clone(), Arc::clone(&lasting)));
        let open = spawn_blocking(move || Station::open(next, shared, first_start));
        let station = Arc::new(open.await.map_err(StationError::Start)??);
        first_start = false;
        let began = station.now();
        match generation(&station, &mut stop, &mut orders.reload).await {
            Ok(Turn::Stop) => break Ok(()),
            Ok(Turn::Reload(next)) => config = *next,
            Ok(Turn::Ruin) => {
                let ruined = Arc::clone(&station);
                let given_up = spawn_blocking(move || ruined.give_up_journal());
                if let Err(error) = given_up.await.map_err(StationError::Start)? {
                    warn!(event = "journal-failed", error = chain(&error));
                }
                ruins = if station.now() - began >= SOUND { 1 } else { ruins + 1 };
                if pause(backoff::pause(ruins, jitter::unit()), &mut stop).await {
                    break Ok(());
                }
            }
            Err(error) => break Err(error),
        }
    };
    info!(event = "station-ended", failed = ended.is_err());
    ended
}

/// Takes the export folders for this process. At its start another station that keeps one ends it;
/// later that is told, and the other folders are worked.
async fn take_exports(
    lasting: &Arc<Lasting>,
    config: &Config,
    is_start: bool,
) -> Result<(), StationError> {
    let folders = config.scanner.export_dirs.clone();
    lasting.export_locks.keep_only(&folders);
    if !is_start {
        return Ok(());
    }
    let lasting = Arc::clone(lasting);
    let asked = spawn_blocking(move || lasting.export_locks.kept_by_another(&folders));
    // A share that does not answer keeps the station from nothing.
    match timeout(FIRST_LOOKS, asked).await {
        Ok(Ok(Some(path))) => Err(StationError::ExportTaken { path }),
        _ => Ok(()),
    }
}

/// Waits until the journal is to be rebuilt; says whether the station is to stop instead.
async fn pause(length: Duration, stop: &mut (impl Future<Output = ()> + Unpin)) -> bool {
    info!(event = "journal-rebuild-waits", seconds = length.as_secs());
    let length = sleep(length);
    tokio::pin!(length);
    let mut pulse = interval(pulse());
    loop {
        tokio::select! {
            () = &mut *stop => return true,
            () = &mut length => return false,
            // There is nothing that could hang.
            _ = pulse.tick() => service::tell_alive(),
        }
    }
}

/// One generation of workers, from their start to their end.
async fn generation(
    station: &Arc<Station>,
    stop: &mut (impl Future<Output = ()> + Unpin),
    reload: &mut mpsc::Receiver<Reload>,
) -> Result<Turn, StationError> {
    let (stopper, asked) = Stopper::new();
    let (mut workers, looked) = Workers::start(station, &asked);
    let ready = async {
        if timeout(FIRST_LOOKS, first_looks(looked)).await.is_err() {
            warn!(event = "first-look-outstanding");
        }
        tell_ready(station);
    };
    let turn = {
        tokio::pin!(ready);
        let mut is_ready = false;
        let mut pulse = interval(pulse());
        loop {
            tokio::select! {
                () = &mut *stop => break Ok(Turn::Stop),
                () = &mut ready, if !is_ready => is_ready = true,
                Some(next) = reload.recv() => if let Some(config) = reloaded(station, next) {
                    break Ok(Turn::Reload(config));
                },
                () = station.ruin.notified() => {
                    error!(event = "journal-ruined");
                    break Ok(Turn::Ruin);
                }
                ended = workers.one_ended() => break Err(ended),
                _ = pulse.tick() => feel_pulse(&workers),
            }
        }
    };
    if matches!(turn, Ok(Turn::Stop) | Err(_)) {
        service::tell_stopping();
    }
    info!(event = "station-stopping");
    stopper.request();
    let rest = timeout(GRACE, workers.rest()).await;
    if rest.is_err() {
        warn!(event = "stop-grace-over");
    }
    // Until here people and monitors are answered.
    let endpoints = timeout(ENDPOINTS_CLOSE, workers.close_endpoints()).await;
    let rest = if matches!(rest, Ok(Ok(()))) { endpoints } else { rest };
    match (turn, rest) {
        (Ok(_), Ok(Err(error))) => Err(error),
        // What still works could meet the next generation over the same scan.
        (Ok(Turn::Reload(_) | Turn::Ruin), Err(_)) => Err(StationError::Stuck),
        (turn, _) => turn,
    }
}

/// Ends when every intake has looked once: each drops its sender after its first look.
async fn first_looks(mut looked: mpsc::Receiver<()>) {
    while looked.recv().await.is_some() {}
}

/// All or nothing: the configuration to go on with; none where the present one stays.
fn reloaded(station: &Station, reload: Reload) -> Option<Box<Config>> {
    service::tell_reloading();
    let refused = match reload {
        Ok(next) => {
            let (now, then) = (&station.config.station, &next.station);
            let is_same_station = now.state_dir == then.state_dir && now.id == then.id;
            let confinement = station.board.facts().confinement;
            let is_confined = match confinement {
                Some(found) => found.suffices(next.measure.confine),
                None => next.measure.confine == Confine::WherePossible,
            };
            match (is_same_station, is_confined) {
                (true, true) => {
                    info!(event = "configuration-reloaded");
                    return Some(next);
                }
                (false, _) => "station.id and station.state_dir change only by a restart",
                (true, false) => {
                    "measure.confine is \"required\", and this machine cannot confine: gaiter check \
                     says what it lacks"
                }
            }
            .to_owned()
        }
        Err(faults) => faults,
    };
    // The text of a fault may quote what stands in the file; people ask for it.
    warn!(event = "configuration-refused");
    station.board.note(|facts| facts.refused_reload = Some(refused));
    service::tell_ready();
    None
}

/// How often the service manager's watchdog is fed: at half its time.
fn pulse() -> Duration {
    sd_notify::watchdog_enabled().map_or(PULSE, |time| (time / 2).min(PULSE))
}

/// The watchdog is fed while every worker turns, and by nothing else.
fn feel_pulse(workers: &Workers) {
    match workers.hung(HUNG) {
        Some(worker) => error!(event = "worker-hangs", %worker),
        None => service::tell_alive(),
    }
}

fn tell_ready(station: &Station) {
    info!(event = "station-ready");
    service::tell_ready();
    station.observer.tell(StationEvent::Ready);
}
