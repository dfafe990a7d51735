//! `gaiter run`: the daemon; and `gaiter measure`, its measuring process.

use std::env;
use std::future::Future;
use std::io;
use std::path::PathBuf;

use tokio::runtime::Runtime;
use tokio::signal::unix::{SignalKind, signal};
use tokio::sync::mpsc;
use tokio::task::spawn_blocking;
use tracing_subscriber::filter::{LevelFilter, Targets};
use tracing_subscriber::layer::SubscriberExt;
use tracing_subscriber::util::SubscriberInitExt;
use tracing_subscriber::{fmt, registry};

use super::args::{MeasureArgs, RunArgs};
use super::{Exit, complain, config_at};
use crate::config::{self, ConfigError};
use crate::station::measure::child;
use crate::station::runtime::chain;
use crate::station::{self, Orders, Reload, StationError};
use crate::store::Access;

/// Beginnings of the targets that stay off, whatever the environment sets: notify logs file names, which may identify
/// patients, and the crates of dicom-rs log what a server has sent.
const SILENT: [&str; 2] = ["notify", "dicom_"];

/// The environment variable that sets what is logged.
const LOG_FILTER: &str = "RUST_LOG";

/// The log level if the environment sets none.
const LOG_LEVEL: LevelFilter = LevelFilter::INFO;

/// Runs the station until SIGTERM or SIGINT.
pub fn run(args: &RunArgs) -> Result<Exit, Exit> {
    let config = config_at(&args.config)?;
    log_to_stderr();
    Access::open_umask();
    let started = Runtime::new().and_then(|runtime| {
        let path = args.config.clone();
        let orders = runtime.block_on(async { Ok((asked_to_stop()?, asked_to_reload(path)?)) });
        orders.map(|orders: (_, _)| (runtime, orders))
    });
    let (runtime, (stop, reload)) = started.map_err(|error| {
        complain(format_args!("gaiter: cannot start: {error}"));
        Exit::Internal
    })?;
    let orders = Orders { stop, reload };
    let ended = runtime.block_on(station::run(config, orders, None));
    // A read from a share that does not answer cannot be interrupted and must not delay the end.
    runtime.shutdown_background();
    ended.map(|()| Exit::Done).map_err(|error| explain(&error))
}

/// Reads the scan on standard input and writes the answer to standard output.
pub fn measure(args: &MeasureArgs) -> Exit {
    match child::serve(args.hash.as_deref(), io::stdin().lock(), io::stdout().lock()) {
        Ok(()) => Exit::Done,
        Err(error) => {
            complain(format_args!("gaiter measure: {error}"));
            Exit::Internal
        }
    }
}

/// Resolves when the process is asked to stop: SIGTERM by the service manager, SIGINT by Ctrl-C.
fn asked_to_stop() -> io::Result<impl Future<Output = ()>> {
    let mut terminate = signal(SignalKind::terminate())?;
    let mut interrupt = signal(SignalKind::interrupt())?;
    Ok(async move {
        tokio::select! {
            _ = terminate.recv() => {}
            _ = interrupt.recv() => {}
        }
    })
}

/// Reads the configuration again on each SIGHUP, which `systemctl reload` sends, and passes it to the
/// station.
fn asked_to_reload(path: PathBuf) -> io::Result<mpsc::Receiver<Reload>> {
    let mut hangup = signal(SignalKind::hangup())?;
    let (sender, receiver) = mpsc::channel(1);
    tokio::spawn(async move {
        while hangup.recv().await.is_some() {
            let path = path.clone();
            let read = spawn_blocking(move || config::read(&path)).await;
            let reload = match read {
                Ok(Ok(config)) => Ok(Box::new(config)),
                Ok(Err(error)) => Err(faults(&error)),
                Err(error) => Err(error.to_string()),
            };
            if sender.send(reload).await.is_err() {
                break;
            }
        }
    });
    Ok(receiver)
}

/// Every fault of a configuration, one per line.
fn faults(error: &ConfigError) -> String {
    match error {
        ConfigError::Unreadable { source, .. } => format!("{error}: {source}"),
        ConfigError::Faults { faults, .. } => {
            faults.iter().map(|fault| format!("{fault:#}")).collect::<Vec<_>>().join("\n")
        }
    }
}

/// Log lines go to standard error, where the service manager collects them.
fn log_to_stderr() {
    let chosen = match env::var(LOG_FILTER).map(|text| text.parse::<Targets>()) {
        Ok(Ok(chosen)) => chosen,
        Ok(Err(error)) => {
            complain(format_args!("gaiter: {LOG_FILTER} is not used: {error}"));
            Targets::new().with_default(LOG_LEVEL)
        }
        Err(_) => Targets::new().with_default(LOG_LEVEL),
    };
    let silent = Targets::new()
        .with_default(LevelFilter::TRACE)
        .with_targets(SILENT.map(|target| (target, LevelFilter::OFF)));
    let lines = fmt::layer().with_writer(io::stderr).with_ansi(false).with_target(false);
    // An existing subscriber stays in place.
    let _ = registry().with(lines).with(chosen).with(silent).try_init();
}

/// Prints why the station ended, with the whole chain of causes, and returns the exit.
fn explain(error: &StationError) -> Exit {
    complain(format_args!("gaiter: {}", chain(error)));
    match error {
        StationError::State { .. }
        | StationError::StateOfAnother { .. }
        | StationError::Lock(_)
        | StationError::Journal { .. }
        | StationError::ExportTaken { .. }
        | StationError::Stuck => Exit::Io,
        // Not retried, because the station needs something that this machine does not have.
        StationError::Unconfined(_) => Exit::Config,
        _ => Exit::Internal,
    }
}
