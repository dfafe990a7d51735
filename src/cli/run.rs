//! `gaiter run`: the daemon.

use std::future::Future;
use std::io;

use tokio::runtime::Runtime;
use tokio::signal::unix::{SignalKind, signal};
use tracing_subscriber::EnvFilter;

use super::args::RunArgs;
use super::{Exit, complain, explain_config};
use crate::config::{self, LogFormat};
use crate::station::error::chain;
use crate::station::{self, StationError};

/// What is logged where the environment says nothing else.
const LOG_LEVEL: &str = "info";

/// Runs the station until SIGTERM or SIGINT.
pub fn run(args: &RunArgs) -> Exit {
    let config = match config::read(&args.config) {
        Ok(config) => config,
        Err(error) => return explain_config(&error),
    };
    log_to_stderr(config.log.format);
    let started = Runtime::new().and_then(|runtime| {
        let stop = runtime.block_on(async { asked_to_stop() })?;
        Ok((runtime, stop))
    });
    let (runtime, stop) = match started {
        Ok(started) => started,
        Err(error) => {
            complain(format_args!("gaiter: cannot start: {error}"));
            return Exit::Internal;
        }
    };
    let ended = runtime.block_on(station::run(config, stop, None));
    // A read from a share that does not answer cannot be cut off, and must not hold up the end.
    runtime.shutdown_background();
    ended.map_or_else(|error| explain(&error), |()| Exit::Done)
}

/// Ends when the process is asked to: SIGTERM by the service manager, SIGINT by Ctrl-C.
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

/// Log lines go to standard error, where the service manager collects them; `RUST_LOG` chooses.
fn log_to_stderr(format: LogFormat) {
    let filter = EnvFilter::try_from_default_env().unwrap_or_else(|_| EnvFilter::new(LOG_LEVEL));
    let lines = tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_writer(io::stderr)
        .with_ansi(false)
        .with_target(false);
    // Whoever set a subscriber before keeps it.
    let _ = match format {
        LogFormat::Text => lines.try_init(),
        LogFormat::Json => lines.json().flatten_event(true).try_init(),
    };
}

/// Tells why the station ended, every cause of it.
fn explain(error: &StationError) -> Exit {
    complain(format_args!("gaiter: {}", chain(error)));
    match error {
        StationError::State { .. } | StationError::Lock(_) | StationError::Journal { .. } => {
            Exit::Io
        }
        _ => Exit::Internal,
    }
}
