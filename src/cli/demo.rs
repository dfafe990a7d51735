//! `gaiter demo`: a real station, a simulated button and scanner, four exports, two records.
//!
//! The scans were recorded and are compressed into the binary. One of the four exports is aborted
//! half-way and one shows no body: these two must not lead to a record.

mod exports;

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use gaiter_record::Record;
use gaiter_sizes::Garment;
use serde_json::json;
use tokio::runtime::Runtime;
use tokio::sync::mpsc::{UnboundedReceiver, unbounded_channel};
use tokio::sync::oneshot;
use tokio::time::timeout;

use super::args::DemoArgs;
use super::terminal::progress::Progress;
use super::terminal::{self, screen, table};
use super::{Exit, complain, config_at, print};
use crate::config::Config;
use crate::station::demo::{self, SimulatedButton};
use crate::station::{self, Orders, StationEvent};
use exports::{DemoExport, exports};

/// The folder for everything the demo makes, below the working folder.
const FOLDER: &str = "demo";

/// Marks a folder as made by the demo, so that the next demo may clear it.
const MARK: &str = ".made-by-gaiter-demo";

/// The folders of a station.
const PARTS: [&str; 3] = ["export", "state", "records"];

/// The files that a demo leaves beside them.
const FILES: [&str; 2] = ["station.toml", MARK];

/// If nothing happens for this long, the demo has failed.
const PATIENCE: Duration = Duration::from_secs(45);

/// The time from the press to the first byte of its export. A real scanner takes longer.
const SCANNING: Duration = Duration::from_millis(500);

/// Why the demo could not be shown.
#[derive(Debug, thiserror::Error)]
enum DemoFault {
    /// A folder named `demo` exists that no demo made.
    #[error("{} exists and is not of an earlier demo; move it away or work elsewhere", .0.display())]
    NotOurs(PathBuf),
    /// Somebody put a file of their own into the folder of an earlier demo.
    #[error("{} is not of the demo, which would replace its folder; move it away first", .0.display())]
    Foreign(PathBuf),
    /// A file could not be read or written.
    #[error("{0}")]
    Io(#[from] io::Error),
    /// The station ended unexpectedly.
    #[error("the station ended: {0}")]
    Station(#[from] station::StationError),
    /// The station's events are not the expected ones.
    #[error("{0}")]
    Unexpected(String),
}

/// Shows the station at work. Succeeds only if exactly the complete scans led to records.
pub fn demo(args: &DemoArgs) -> Result<Exit, Exit> {
    let button = SimulatedButton::new();
    if let Err(error) = &button {
        // The station works without a button.
        complain(format_args!("gaiter demo: no button is available: {error}"));
    }
    let mut button = button.ok();
    let config = config_at(&prepare(button.as_ref()).map_err(|fault| failed(&fault))?)?;
    let shown = Runtime::new().map_err(DemoFault::from).and_then(|runtime| {
        let shown = runtime.block_on(show(config, button.take(), args.json));
        runtime.shutdown_background();
        shown
    });
    shown.map(|()| Exit::Done).map_err(|fault| failed(&fault))
}

fn failed(fault: &DemoFault) -> Exit {
    complain(format_args!("gaiter demo: {fault}"));
    match fault {
        DemoFault::NotOurs(_) | DemoFault::Foreign(_) | DemoFault::Io(_) => Exit::Io,
        DemoFault::Station(_) | DemoFault::Unexpected(_) => Exit::Internal,
    }
}

/// Makes a fresh folder with a configuration in it and returns the configuration's path.
fn prepare(button: Option<&SimulatedButton>) -> Result<PathBuf, DemoFault> {
    let folder = std::env::current_dir()?.join(FOLDER);
    if folder.exists() {
        if !folder.join(MARK).exists() {
            return Err(DemoFault::NotOurs(folder));
        }
        for entry in fs::read_dir(&folder)? {
            let entry = entry?;
            if !PARTS.iter().chain(&FILES).any(|own| entry.file_name() == *own) {
                return Err(DemoFault::Foreign(entry.path()));
            }
        }
        fs::remove_dir_all(&folder)?;
    }
    for part in PARTS {
        fs::create_dir_all(folder.join(part))?;
    }
    fs::write(folder.join(MARK), "")?;
    let path = folder.join("station.toml");
    let place = |part: &str| toml::Value::from(folder.join(part).to_string_lossy().as_ref());
    let trigger = button.map_or(String::new(), |button| {
        let port = toml::Value::from(button.port().to_string_lossy().as_ref());
        format!("[trigger.serial]\nport = {port}\ntokens = [\"{}\"]\n", demo::PRESS)
    });
    fs::write(
        &path,
        format!(
            "[station]\nid = \"demo\"\nstate_dir = {}\n\n\
             [scanner]\nexport_dirs = [{}]\nquiet = \"1s\"\nrescan = \"2s\"\nshort_wait = \"4s\"\n\
             file_name = '^(?<patient>P?[0-9]+)_'\n\n\
             [store.folder]\npath = {}\n\n{trigger}",
            place("state"),
            place("export"),
            place("records")
        ),
    )?;
    Ok(path)
}

/// Runs the station, lets the scanner export, and shows the results.
async fn show(
    config: Config,
    button: Option<SimulatedButton>,
    json: bool,
) -> Result<(), DemoFault> {
    let export_dir = config.scanner.export_dirs[0].clone();
    let state_dir = config.station.state_dir.clone();
    let (sender, mut events) = unbounded_channel();
    let (stop, stopped) = oneshot::channel::<()>();
    let asked = async {
        // A dropped sender ends the station too.
        let _ = stopped.await;
    };
    let station = tokio::spawn(station::run(config, Orders::stop_only(asked), Some(sender)));
    let button = Arc::new(Mutex::new(button));
    let exports = exports(&export_dir)?;
    let printer = DemoPrinter::new(exports.len(), json);
    let records = exports.iter().filter(|export| export.is_whole).count();
    let refusals = exports.len() - records;
    for export in exports {
        scan(export, Arc::clone(&button), printer.clone());
    }
    let watched = timeout(PATIENCE, watch(&mut events, records, refusals, &printer)).await;
    drop(printer);
    drop(stop);
    let ended = station.await.map_err(io::Error::other)?;
    let seen = match (watched, ended) {
        (Ok(seen), Ok(())) => seen?,
        (_, Err(error)) => return Err(error.into()),
        (Err(_), Ok(())) => {
            let waited = PATIENCE.as_secs();
            return Err(DemoFault::Unexpected(format!("not all scans were done in {waited} s")));
        }
    };
    if json { objects(&seen, &state_dir) } else { summary(&seen, &state_dir) }
}

/// Presses the button and lets the scanner export one scan in the background, and prints both.
fn scan(
    DemoExport { export, after, .. }: DemoExport,
    button: Arc<Mutex<Option<SimulatedButton>>>,
    printer: DemoPrinter,
) {
    tokio::spawn(async move {
        tokio::time::sleep(after).await;
        press(&button, &printer);
        tokio::time::sleep(SCANNING).await;
        let name = name_of(&export.path);
        printer.print(&format!("scanner  exports {name}"));
        match demo::write(export).await {
            Ok(()) => printer.print(&format!("scanner  has exported {name}")),
            Err(error) => complain(format_args!("scanner: {error}")),
        }
    });
}

fn press(button: &Mutex<Option<SimulatedButton>>, printer: &DemoPrinter) {
    let mut button = button.lock().unwrap_or_else(PoisonError::into_inner);
    let Some(button) = button.as_mut() else { return };
    match button.press() {
        Ok(()) => printer.print("operator presses the button"),
        Err(error) => complain(format_args!("button: {error}")),
    }
}

/// The results of the station.
#[derive(Default)]
struct Seen {
    records: Vec<PathBuf>,
    refusals: usize,
}

/// Follows the station's events until every scan has its result: so many records and so many refusals.
async fn watch(
    events: &mut UnboundedReceiver<StationEvent>,
    records: usize,
    refusals: usize,
    printer: &DemoPrinter,
) -> Result<Seen, DemoFault> {
    let mut seen = Seen::default();
    while seen.records.len() < records || seen.refusals < refusals {
        let Some(event) = events.recv().await else {
            return Err(DemoFault::Unexpected("the station ended early".to_owned()));
        };
        printer.print(&line(&event));
        match event {
            StationEvent::Delivered { folder, .. } => seen.records.push(folder),
            StationEvent::Refused { .. } => seen.refusals += 1,
            _ => continue,
        }
        printer.progress.advance();
    }
    if seen.records.len() > records || seen.refusals > refusals {
        let message = format!("{} records and {} refusals", seen.records.len(), seen.refusals);
        return Err(DemoFault::Unexpected(message));
    }
    Ok(seen)
}

/// An event in words.
fn line(event: &StationEvent) -> String {
    match event {
        StationEvent::Ready => "station  is ready".to_owned(),
        StationEvent::AwaitsRest { file } => {
            format!("station  waits for the rest of {}", file.to_string_lossy())
        }
        StationEvent::Pressed => "station  heard the button".to_owned(),
        StationEvent::NoExport => "station  got no export after a press".to_owned(),
        StationEvent::Spooled { file, scan } => {
            format!("station  has saved {} as {scan}", file.to_string_lossy())
        }
        StationEvent::Refused { code, message } => {
            format!("station  made no record [{code}] {message}")
        }
        StationEvent::Delivered { scan, .. } => format!("station  delivered {scan}"),
        StationEvent::Held { scan } => format!("station  holds {scan}"),
        StationEvent::PutOff { scan, code } => format!("station  tries {scan} again [{code}]"),
    }
}

fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// Prints what happens, with the seconds since the start.
#[derive(Clone)]
struct DemoPrinter {
    began: Instant,
    progress: Arc<Progress>,
    /// Whether standard output is for a program, so that nothing is printed.
    is_silent: bool,
}

impl DemoPrinter {
    fn new(scans: usize, is_silent: bool) -> DemoPrinter {
        let progress = Arc::new(Progress::new(scans, "scans"));
        DemoPrinter { began: Instant::now(), progress, is_silent }
    }

    fn print(&self, line: &str) {
        if self.is_silent {
            return;
        }
        let seconds = self.began.elapsed().as_secs_f64();
        // A reader that has gone away needs no more output. The demo still runs to its end.
        let _ = self.progress.aside(|| print(format_args!("{seconds:5.1} s  {line}\n")));
    }
}

/// Reads every record, sorted by folder.
fn records(seen: &Seen) -> Result<Vec<(&PathBuf, Record)>, DemoFault> {
    let mut folders: Vec<&PathBuf> = seen.records.iter().collect();
    folders.sort();
    let read = |folder: &PathBuf| fs::read(folder.join("record.json"));
    let parse = |json: Vec<u8>| serde_json::from_slice(&json).map_err(io::Error::other);
    let records = folders.into_iter().map(|folder| Ok((folder, parse(read(folder)?)?)));
    records.collect()
}

/// Prints the measures of every record and the paths of all results.
fn summary(seen: &Seen, state_dir: &Path) -> Result<(), DemoFault> {
    let records = records(seen)?;
    for (folder, record) in &records {
        let patient = record.patient.as_ref().map_or("unassigned", |patient| &patient.id);
        let table = table::render(record, &Garment::default(), screen::columns());
        terminal::print_painted(format_args!(
            "\npatient {patient}: {}\n{table}\n",
            folder.display()
        ))?;
    }
    print(format_args!(
        "\n{} scans measured; {} could not be measured and led to no record; the reasons are \
         in\n{}\n",
        records.len(),
        seen.refusals,
        state_dir.join("quarantine").display()
    ))?;
    Ok(())
}

/// Prints the same as JSON, for programs.
fn objects(seen: &Seen, state_dir: &Path) -> Result<(), DemoFault> {
    let records = records(seen)?.into_iter();
    let records = records.map(|(folder, record)| json!({ "folder": folder, "record": record }));
    let all = json!({
        "records": records.collect::<Vec<_>>(),
        "refused": seen.refusals,
        "quarantine": state_dir.join("quarantine"),
    });
    Ok(print(format_args!("{all}\n"))?)
}
