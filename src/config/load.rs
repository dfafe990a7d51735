//! The text of `station.toml` → [`Config`], or all of its faults.

use std::path::{Path, PathBuf};

use gaiter_cad::Output;
use gaiter_flow::retention::Retention;
use gaiter_leg::Method;
use gaiter_leg::method::{B1, LevelChoices};
use gaiter_record::report::Print;
use gaiter_toml::What::Twice;
use toml::de::DeTable;

use super::parse::{self, Absent, Found, Reader, What};
use super::removed::REMOVED;
use super::visits;
use super::words::{
    ACCESSES, CONFINES, FACINGS, FILES, LANGUAGES, PAPERS, POSTURES, SCOPES, TAPES, UNITS, UPS,
    VOLUMES, WINDINGS, Words, faces_up_or_down,
};
use super::{
    Config, ConfigFault, FolderStoreConfig, MeasureConfig, PatientConfig, ScannerConfig,
    StationConfig, StoreConfig, capture, gdt, observability, page, phantom, servers, sizes,
    trigger, watch,
};

/// Reads the text of a configuration with the garments, size tables and mappings that it names.
///
/// # Errors
/// Every fault of the text and of these files, in the order of its lines.
pub fn load(text: &str) -> Result<Config, Vec<ConfigFault>> {
    let (root, errors) = DeTable::parse_recoverable(text);
    let mut reader = Reader::new(text, root.get_ref(), &errors, REMOVED);
    let config = config(&mut reader);
    let mut faults = reader.finish();
    match config {
        Some(config) if faults.is_empty() => Ok(config),
        _ => {
            faults.iter_mut().for_each(|fault| fault.file = "station.toml".into());
            Err(faults)
        }
    }
}

/// Reads all keys, each with what applies if it is absent.
pub(super) fn config(reader: &mut Reader) -> Option<Config> {
    use Absent::{Default, Nothing, Required};
    let id = reader.text("station.id", Required("booth-1"), parse::station_id);
    let state_dir = reader.text("station.state_dir", Required("/var/lib/gaiter"), parse::full_path);

    let disk_floor_bytes =
        reader.value("station.disk_floor", "1GB", parse::size_in("0B"..="1000GB"))?;

    let exports =
        reader.list("scanner.export_dirs", Required("/srv/scanner/export"), parse::full_path);
    let quiet = reader.value("scanner.quiet", "2s", parse::duration_in("50ms"..="10m"))?;
    let rescan = reader.value("scanner.rescan", "10s", parse::duration_in("50ms"..="1h"))?;
    let short_wait = reader.value("scanner.short_wait", "60s", parse::duration_in("0s"..="24h"))?;
    let max_scan_bytes =
        reader.value("scanner.max_scan", "200MB", parse::size_in("1kB"..="4GB"))?;
    let watch = watch::config(reader)?;
    let scope = reader.value("scanner.scope", "body", parse::word(SCOPES))?;
    let unit = reader.value("scanner.unit", "auto", parse::word(UNITS))?;
    let up = reader.text("scanner.up", Default("y"), parse::word(UPS));
    let facing = reader.text("scanner.facing", Default("auto"), parse::word(FACINGS));
    let winding = reader.value("scanner.winding", "outward", parse::word(WINDINGS))?;
    let posture = reader.value("scanner.posture", "both-legs", parse::word(POSTURES))?;
    let girth_error_mm =
        reader.value("scanner.girth_error", "1mm", parse::distance_in("0mm"..="20mm"))?;
    let example = Nothing("^(?<patient>P?[0-9]+)_");
    let file_name = reader.text("scanner.file_name", example, parse::file_name);

    let whose = capture::config(reader);
    let (orders_path, orders) = gdt::orders(reader)?;
    #[cfg(feature = "dicom")]
    let worklist = servers::worklist(reader);
    let trigger = trigger::config(reader);
    let patient = whose.as_ref().map(|(_, patient)| patient);
    let phantom = phantom::config(reader, patient);
    let tape = reader.value("method.tape", "shank", parse::word(TAPES))?;
    let at = reader.numbers("method.at", "10, 20, 30", parse::height_mm);
    let levels = level_choices(reader)?;
    let volume = reader.value("method.volume", "cones", parse::word(VOLUMES))?;
    let output = output(reader);
    let language = reader.value("report.language", "en", parse::word(LANGUAGES))?;
    let mut read_bytes = 0;
    let garments = sizes::garments(reader, &mut read_bytes);
    let paper = reader.value("report.paper", "A4", parse::word(PAPERS))?;
    let age_max = visits::age_max(reader)?;
    let tables = sizes::tables(reader, &mut read_bytes);
    let orders_of_records = sizes::orders(reader, &mut read_bytes);
    let visits = visits::config(reader);
    let measure = measure(reader)?;
    let store = reader.text("store.folder.path", Required("/srv/records"), parse::full_path);
    let access = reader.value("store.folder.mode", "private", parse::word(ACCESSES))?;
    let copy = reader.text("store.copy.path", Default(""), parse::or_none(parse::full_path));
    let copy = copy.and_then(parse::if_set);
    let (gdt_product, (gdt_path, gdt)) = gdt::store(reader)?;
    let fhir = servers::fhir(reader);
    let (hl7_path, hl7) = servers::hl7(reader)?;
    #[cfg(feature = "dicom")]
    let dicom = servers::dicom(reader);
    let archive = servers::archive(reader);
    let retention = retention(reader)?;
    let status = observability::status(reader)?;
    let page = page::config(reader)?;

    observability::control_socket(reader, state_dir.as_ref());
    twice(reader, "scanner.export_dirs", &exports, |folder| folder.display().to_string());
    let own = named([
        ("station.state_dir", &state_dir),
        ("store.folder.path", &store),
        ("store.copy.path", &copy),
    ]);
    let exchange = named([
        ("store.gdt.path", &gdt_path),
        ("store.hl7.path", &hl7_path),
        ("patient.orders.path", &orders_path),
    ]);
    folders_apart(reader, &own, &exports, &exchange);
    if let (Some(up), Some(facing)) = (&up, &facing)
        && faces_up_or_down(up.value, facing.value)
    {
        let (up, faces) = (spelt(UPS, up.value), spelt(FACINGS, facing.value));
        let message = format!("\"{faces}\" is along the up axis, scanner.up = \"{up}\"");
        let hint = "choose a horizontal axis, or \"auto\" to find it from the feet";
        reader.note(facing.at.clone(), "scanner.facing", What::own(message, hint));
    }

    let (capture, patient) = whose?;
    Some(Config {
        station: StationConfig { id: id?.value, state_dir: state_dir?.value, disk_floor_bytes },
        scanner: ScannerConfig {
            export_dirs: exports.into_iter().map(|folder| folder.value).collect(),
            quiet,
            rescan,
            short_wait,
            max_scan_bytes,
            watch,
            girth_error_mm,
            file_name: file_name.map(|found| found.value),
        },
        capture,
        patient: PatientConfig {
            orders,
            #[cfg(feature = "dicom")]
            worklist,
            ..patient
        },
        trigger: trigger?,
        phantom,
        method: Method {
            scope,
            unit,
            up: up?.value,
            facing: facing?.value,
            winding,
            posture,
            at_heights_mm: at.into_iter().map(|height| height.value).collect(),
            levels,
            volume,
            tape,
            ..Method::default()
        },
        output,
        language,
        garment: garments.usual?,
        garments: garments.all,
        tables,
        orders: orders_of_records,
        visits,
        age_max,
        print: Print { paper, ..Print::default() },
        measure,
        store: StoreConfig {
            folder: FolderStoreConfig { path: store?.value, access },
            copy: copy.map(|found| FolderStoreConfig { path: found.value, access }),
            gdt_product,
            gdt,
            fhir,
            hl7,
            #[cfg(feature = "dicom")]
            dicom,
            archive,
        },
        retention,
        status,
        page,
    })
}

/// The keys of `[method]` that define where levels are.
fn level_choices(reader: &mut Reader) -> Option<LevelChoices> {
    let b1 = reader.value("method.b1", "steepest", b1)?;
    let below = reader.value("method.g_below_crotch", "5cm", parse::length_in("2cm"..="10cm"))?;
    Some(LevelChoices { b1, g_below_crotch_mm: f64::from(below) })
}

/// `"steepest"`, or the distance of B1 above B.
fn b1(text: &str) -> Result<B1, What> {
    if text == B1::Steepest.word() {
        return Ok(B1::Steepest);
    }
    let hint = "write \"steepest\", or how far B1 is above B: \"8cm\"";
    parse::length(text).map_err(|_| What::not_a(text, "a valid place of B1", hint))?;
    let distance_mm = parse::length_in("2cm"..="20cm")(text)?;
    Ok(B1::AboveB { distance_mm: f64::from(distance_mm) })
}

fn spelt<T: PartialEq>(words: Words<T>, value: T) -> String {
    words.iter().filter(|(_, known)| *known == value).map(|(word, _)| *word).collect()
}

/// The keys of `[output]`.
fn output(reader: &mut Reader) -> Output {
    let files = reader.list("output.files", Absent::Default("step"), parse::word(FILES));
    twice(reader, "output.files", &files, |kind| spelt(FILES, *kind));
    Output { files: files.into_iter().map(|kind| kind.value).collect(), ..Output::default() }
}

/// The keys of `[measure]`.
fn measure(reader: &mut Reader) -> Option<MeasureConfig> {
    let memory_bytes = reader.value("measure.memory", "2GB", parse::size_in("256MB"..="64GB"))?;
    let wall = reader.value("measure.wall", "120s", parse::duration_in("1s"..="1h"))?;
    let confine = reader.value("measure.confine", "where-possible", parse::word(CONFINES))?;
    Some(MeasureConfig { memory_bytes, wall, confine })
}

/// The keys of `[retention]`.
fn retention(reader: &mut Reader) -> Option<Retention> {
    let spool = reader.value("retention.spool", "0s", parse::duration_in("0s"..="87600h"))?;
    let kept = parse::duration_or_off("24h"..="876000h");
    let quarantine = reader.value("retention.quarantine", "off", &kept)?;
    let journal = reader.value("retention.journal", "off", &kept)?;
    Some(Retention { spool, quarantine, journal })
}

fn twice<T: PartialEq>(
    reader: &mut Reader,
    key: &str,
    entries: &[Found<T>],
    spelt: impl Fn(&T) -> String,
) {
    for (i, entry) in entries.iter().enumerate() {
        if entries[..i].iter().any(|earlier| earlier.value == entry.value) {
            reader.note(entry.at.clone(), key, Twice(spelt(&entry.value)));
        }
    }
}

/// A folder and the key that names it.
type Named<'f> = (&'static str, &'f Found<PathBuf>);

/// Those of these folders that are configured.
fn named<'f>(folders: [(&'static str, &'f Option<Found<PathBuf>>); 3]) -> Vec<Named<'f>> {
    folders.into_iter().filter_map(|(key, folder)| Some((key, folder.as_ref()?))).collect()
}

/// Notes folders that overlap each other. Only exchange folders may overlap one another.
fn folders_apart(
    reader: &mut Reader,
    own: &[Named],
    exports: &[Found<PathBuf>],
    exchange: &[Named],
) {
    let exports: Vec<Named> =
        exports.iter().map(|export| ("scanner.export_dirs", export)).collect();
    for folder in own {
        exports.iter().for_each(|export| apart(reader, *folder, *export));
    }
    for (at, folder) in own.iter().enumerate() {
        own[..at].iter().for_each(|other| apart(reader, *folder, *other));
    }
    for folder in exchange {
        own.iter().chain(&exports).for_each(|other| apart(reader, *folder, *other));
    }
}

fn apart(reader: &mut Reader, a: Named, b: Named) {
    let Some(a_is_inner) = nested(&a.1.value, &b.1.value) else { return };
    let ((key, inner), (other_key, outer)) = if a_is_inner { (a, b) } else { (b, a) };
    let how = if inner.value == outer.value { "is also" } else { "lies inside" };
    let (inner_path, outer_path) = (inner.value.display(), outer.value.display());
    let message = format!("\"{inner_path}\" {how} {other_key} \"{outer_path}\"");
    let what = What::own(message, "exports, state and records need separate folders");
    reader.note(inner.at.clone(), key, what);
}

/// `Some(true)` if `a` is or lies inside `b`, `Some(false)` if `b` lies inside `a`, `None` otherwise.
pub fn nested(a: &Path, b: &Path) -> Option<bool> {
    if a.starts_with(b) {
        Some(true)
    } else if b.starts_with(a) {
        Some(false)
    } else {
        None
    }
}
