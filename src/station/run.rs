//! Runs the station: generations of workers over one state folder, and the loop that handles every
//! reason for which a generation ends.

use std::sync::Arc;
use std::time::Duration;

use gaiter_flow::backoff;
use gaiter_flow::confinement::Confine;
use jiff::Zoned;
use sd_notify::NotifyState;
use tokio::sync::mpsc::{self, UnboundedSender};
use tokio::task::spawn_blocking;
use tokio::time::{interval, sleep, timeout};
use tracing::{error, info, warn};

use super::assembly::Station;
use super::core::{Core, journal_file};
use super::error::StationError;
use super::event::{Observer, StationEvent};
use super::operator::http::listeners::Way;
use super::rebuild;
use super::runtime::{Stopper, chain, random_unit};
use super::service;
use super::state_dir::take_state_dir;
use super::workers::{ProcessResources, Workers};
use crate::config::Config;

/// How long to wait for the first looks before the station reports that it is ready: a share that does
/// not answer must not keep the station from starting with its other folders.
const FIRST_LOOKS: Duration = Duration::from_secs(10);

/// How long running work may take after a stop was requested. The next start resumes what is cut off.
/// `TimeoutStopSec` of the unit is longer. A step at a server may take longer still: it is cut off at a stop, which does
/// no harm because it can be made again, and waited for before a reload.
const GRACE: Duration = Duration::from_secs(20);

/// How long answers that are being given may take after that.
const ENDPOINTS_CLOSE: Duration = Duration::from_secs(10);

/// Interval between checks of the workers' heartbeats, unless a watchdog needs more.
const HEARTBEAT_CHECK: Duration = Duration::from_secs(5);

/// A worker whose last heartbeat is older hangs: each sends one every few seconds, even while it waits.
const HUNG: Duration = Duration::from_secs(30);

/// A generation that lived this long was a good one: if its journal becomes corrupt, the rebuild waits
/// as for the first time. Other rebuilds wait longer each time, because each corrupt journal is kept.
const SOUND: Duration = Duration::from_secs(600);

/// The result of reading the configuration again: a new one, or what is wrong with it.
pub type Reload = Result<Box<Config>, String>;

/// What the code that started the station can request.
#[derive(Debug)]
pub struct Orders<S> {
    /// Completes when the station is to stop.
    pub stop: S,
    /// A configuration that was read again; closed if there are no reloads.
    pub reload: mpsc::Receiver<Reload>,
}

impl<S> Orders<S> {
    /// Orders that can only request a stop.
    pub fn stop_only(stop: S) -> Orders<S> {
        Orders { stop, reload: mpsc::channel(1).1 }
    }
}

/// Why a generation of workers ended.
enum GenerationEnd {
    /// The station is to stop.
    Stop,
    /// It is to continue with this configuration.
    Reload(Box<Config>),
    /// The journal is to be rebuilt.
    RebuildJournal,
}

/// Runs the station until it is asked to stop or cannot continue. `observer` receives its events.
///
/// A blocking step on a share that does not answer cannot be cancelled: the owner of the runtime shuts
/// it down without waiting (`Runtime::shutdown_background`).
///
/// # Errors
/// See [`StationError`]; the journal makes it safe to start again.
pub async fn run(
    config: Config,
    mut orders: Orders<impl Future<Output = ()>>,
    observer: Option<UnboundedSender<StationEvent>>,
) -> Result<(), StationError> {
    let observer = Observer(observer);
    let state_dir = config.station.state_dir.clone();
    let lock = spawn_blocking(move || take_state_dir(&state_dir)).await;
    let lock = lock.map_err(StationError::Start)??;
    let mut config = config;
    let mut first_start = lock.first_start;
    let (mut ruins, mut first_generation) = (0, true);
    let resources = ProcessResources::default();
    // From now on verbs wait for the station. If this fails, its worker reports it and tries again.
    let _ = resources.listeners.open(&config, Way::Control).await;
    let stop = orders.stop;
    tokio::pin!(stop);
    let ended = loop {
        take_exports(&resources, &config, first_generation).await?;
        first_generation = false;
        let (next, observer) = (config.clone(), observer.clone());
        let open = spawn_blocking(move || Station::open(next, observer, first_start));
        let station = open.await.map_err(StationError::Start)??;
        first_start = false;
        let began = station.core.now();
        match generation(&station, &resources, &mut stop, &mut orders.reload).await {
            Ok(GenerationEnd::Stop) => break Ok(()),
            Ok(GenerationEnd::Reload(next)) => config = *next,
            Ok(GenerationEnd::RebuildJournal) => {
                let core = Arc::clone(&station.core);
                // It proved corrupt in use: opened again it may look intact.
                let given_up = spawn_blocking(move || {
                    rebuild::give_up(&journal_file(&core.config), core.custody.journal())
                });
                if let Err(error) = given_up.await.map_err(StationError::Start)? {
                    warn!(event = "journal-failed", error = chain(&error));
                }
                ruins = if station.core.now() - began >= SOUND { 1 } else { ruins + 1 };
                let length = backoff::pause(ruins, random_unit());
                info!(event = "journal-rebuild-waits", seconds = length.as_secs());
                if unless_stopped(sleep(length), &mut stop).await.is_none() {
                    break Ok(());
                }
            }
            Err(error) => break Err(error),
        }
    };
    info!(event = "station-ended", failed = ended.is_err());
    ended
}

/// Takes the export folders for this process. At its start it fails if another station keeps one. Later
/// that is only reported, and the other folders are used.
async fn take_exports(
    resources: &ProcessResources,
    config: &Config,
    is_start: bool,
) -> Result<(), StationError> {
    let folders = config.scanner.export_dirs.clone();
    resources.export_locks.keep_only(&folders);
    if !is_start {
        return Ok(());
    }
    let export_locks = Arc::clone(&resources.export_locks);
    let asked = spawn_blocking(move || export_locks.kept_by_another(&folders));
    // A share that does not answer does not prevent the start.
    match timeout(FIRST_LOOKS, asked).await {
        Ok(Ok(Some(path))) => Err(StationError::ExportTaken { path }),
        _ => Ok(()),
    }
}

/// The result of a wait that has an end; `None` if the station is to stop instead. The watchdog is fed meanwhile:
/// nothing that is waited for could hang.
async fn unless_stopped<T>(
    wait: impl Future<Output = T>,
    stop: &mut (impl Future<Output = ()> + Unpin),
) -> Option<T> {
    tokio::pin!(wait);
    let mut watchdog = interval(watchdog_interval());
    loop {
        tokio::select! {
            () = &mut *stop => return None,
            done = &mut wait => return Some(done),
            _ = watchdog.tick() => service::notify(&[NotifyState::Watchdog]),
        }
    }
}

/// One generation of workers, from their start to their end.
async fn generation(
    station: &Station,
    resources: &ProcessResources,
    stop: &mut (impl Future<Output = ()> + Unpin),
    reload: &mut mpsc::Receiver<Reload>,
) -> Result<GenerationEnd, StationError> {
    let today = Zoned::now().date();
    // Reports still show them, with a note.
    for table in station.core.config.tables.iter().filter(|table| table.is_expired(today)) {
        warn!(event = "size-table-expired", table = table.id);
    }
    let (stopper, asked) = Stopper::new();
    let (mut workers, mut looked) = Workers::start(station, resources, &asked);
    let ready = async {
        if timeout(FIRST_LOOKS, looked.recv()).await.is_err() {
            warn!(event = "first-look-outstanding");
        }
        info!(event = "station-ready");
        service::notify(&[NotifyState::Ready]);
        station.core.observer.notify(StationEvent::Ready);
    };
    let turn = {
        tokio::pin!(ready);
        let mut is_ready = false;
        let mut watchdog = interval(watchdog_interval());
        loop {
            tokio::select! {
                () = &mut *stop => break Ok(GenerationEnd::Stop),
                () = &mut ready, if !is_ready => is_ready = true,
                Some(next) = reload.recv() => if let Some(config) = reloaded(&station.core, next) {
                    break Ok(GenerationEnd::Reload(config));
                },
                () = station.core.anew.notified() => {
                    break Ok(GenerationEnd::Reload(Box::new(station.core.config.clone())));
                }
                () = station.core.ruin.notified() => {
                    error!(event = "journal-ruined");
                    break Ok(GenerationEnd::RebuildJournal);
                }
                ended = workers.one_ended() => break Err(ended),
                // The watchdog is fed only while no worker hangs.
                _ = watchdog.tick() => match workers.hung(HUNG) {
                    Some(worker) => error!(event = "worker-hangs", %worker),
                    None => service::notify(&[NotifyState::Watchdog]),
                },
            }
        }
    };
    wind_up(turn, station, &mut workers, &stopper, stop).await
}

/// Ends the workers of a generation, for this reason. Returns why it has ended.
async fn wind_up(
    turn: Result<GenerationEnd, StationError>,
    station: &Station,
    workers: &mut Workers,
    stopper: &Stopper,
    stop: &mut (impl Future<Output = ()> + Unpin),
) -> Result<GenerationEnd, StationError> {
    let turn = match turn {
        Ok(next @ (GenerationEnd::Reload(_) | GenerationEnd::RebuildJournal)) => {
            if matches!(next, GenerationEnd::RebuildJournal) {
                // Nobody may work with that journal any longer.
                stopper.request();
            }
            deliveries_over(station, workers, stop).await.map(|stops| match stops {
                true => GenerationEnd::Stop,
                false => next,
            })
        }
        turn => turn,
    };
    if matches!(turn, Ok(GenerationEnd::Stop) | Err(_)) {
        service::notify(&[NotifyState::Stopping]);
    }
    info!(event = "station-stopping");
    stopper.request();
    let rest = timeout(GRACE, workers.rest()).await;
    if rest.is_err() {
        warn!(event = "stop-grace-over");
    }
    // Until here the endpoints answer people and monitors.
    let endpoints = timeout(ENDPOINTS_CLOSE, workers.close_endpoints()).await;
    let rest = if matches!(rest, Ok(Ok(()))) { endpoints } else { rest };
    match (turn, rest) {
        (Ok(_), Ok(Err(error))) => Err(error),
        // Work that still runs could meet the next generation on the same scan.
        (Ok(GenerationEnd::Reload(_) | GenerationEnd::RebuildJournal), Err(_)) => {
            Err(StationError::Stuck)
        }
        (turn, _) => turn,
    }
}

/// Ends the delivery before the next generation, and waits as long as a step at a server may take: one that runs on
/// could meet the next generation on the same record. The booth's input is handled meanwhile, and files are taken
/// in. Returns whether the station is to stop instead.
async fn deliveries_over(
    station: &Station,
    workers: &mut Workers,
    stop: &mut (impl Future<Output = ()> + Unpin),
) -> Result<bool, StationError> {
    let servers = station.core.stores.iter().filter(|store| store.is_server());
    let longest = servers.map(|store| store.step_most()).max().unwrap_or_default();
    match unless_stopped(timeout(longest, workers.end_delivery()), stop).await {
        // What is not over by then has the grace of all work.
        Some(ended) => ended.unwrap_or(Ok(())).map(|()| false),
        None => Ok(true),
    }
}

/// The configuration to continue with, accepted as a whole; `None` if the present one stays.
fn reloaded(core: &Core, reload: Reload) -> Option<Box<Config>> {
    service::notify_reloading();
    let refused = match reload {
        Ok(next) => match only_with_restart(core, &next) {
            None => {
                info!(event = "configuration-reloaded");
                return Some(next);
            }
            Some(why) => why.to_owned(),
        },
        Err(faults) => faults,
    };
    // The text may quote what is in the file, so it is not logged; operators can ask for it.
    warn!(event = "configuration-refused");
    core.board.note(|facts| facts.refused_reload = Some(refused));
    service::notify(&[NotifyState::Ready]);
    None
}

/// Why a running station cannot take this configuration over.
fn only_with_restart(core: &Core, next: &Config) -> Option<&'static str> {
    let (now, then) = (&core.config.station, &next.station);
    let is_confined = match core.board.facts().confinement {
        Some(found) => found.suffices(next.measure.confine),
        None => next.measure.confine == Confine::WherePossible,
    };
    if now.state_dir != then.state_dir || now.id != then.id {
        Some("station.id and station.state_dir can only change with a restart")
    } else if !is_confined {
        Some(
            "measure.confine is \"required\", and this machine cannot confine processes: \
             gaiter check shows what is missing",
        )
    } else {
        None
    }
}

/// How often the service manager's watchdog is fed: at half its interval.
fn watchdog_interval() -> Duration {
    sd_notify::watchdog_enabled().map_or(HEARTBEAT_CHECK, |time| (time / 2).min(HEARTBEAT_CHECK))
}
