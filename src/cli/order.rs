//! `gaiter order`: an order from a record, as a table, as JSON, or by a mapping.

mod check;
mod open;

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use gaiter_language::Language;
use gaiter_record::order::{
    BYTES_MAX, LastFault, Order, OrderFile, OrderRef, RefFault, ReorderFault, mapped, mapped_name,
    read,
};
use gaiter_record::schema::NOT_VOUCHED;
use gaiter_record::{Record, RecordFile, SUMS};
use gaiter_sizes::{Garment, Mapping};
use jiff::Zoned;

use super::args::{GarmentArgs, OrderArgs, OrderOf, OrderVerb, Repeat};
use super::{
    Exit, complain, config_if_any, exit_of_printing, failed, print, print_to, report,
    report_choice, terminal_safe,
};

/// Checks mappings, or writes an order.
pub fn order(args: &OrderArgs) -> Result<Exit, Exit> {
    match &args.verb {
        Some(OrderVerb::Check(args)) => Ok(check::check(args)),
        None => ordered(&args.of),
    }
}

/// Why there is no order.
#[derive(Debug, thiserror::Error)]
enum OrderVerbFault {
    /// The reference cannot be used.
    #[error("--ref {0}")]
    Ref(#[from] RefFault),
    /// The last order cannot be read.
    #[error("{}: {source}", terminal_safe(path.display()))]
    Unreadable { path: PathBuf, source: io::Error },
    /// It is none.
    #[error("{}: {}", terminal_safe(path.display()), terminal_safe(source))]
    Last { path: PathBuf, source: LastFault },
    /// It cannot be repeated for this record.
    #[error("{}: {}", terminal_safe(path.display()), terminal_safe(source))]
    Reorder { path: PathBuf, source: ReorderFault },
    /// The order cannot be written as JSON.
    #[error("the order cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
}

impl From<&OrderVerbFault> for Exit {
    fn from(fault: &OrderVerbFault) -> Exit {
        match fault {
            OrderVerbFault::Ref(_) => Exit::Usage,
            OrderVerbFault::Unreadable { source, .. } => Exit::from(source),
            OrderVerbFault::Last { .. } | OrderVerbFault::Reorder { .. } => Exit::Unmeasurable,
            OrderVerbFault::Json(_) => Exit::Internal,
        }
    }
}

/// Writes or prints the order, and prints what is open.
fn ordered(args: &OrderOf) -> Result<Exit, Exit> {
    // clap asks for a record where no other verb is named, and for a last order where one is repeated.
    let path = args.record.as_ref().ok_or(Exit::Usage)?;
    let config = config_if_any(&args.config)?;
    let (choice, garments) = report_choice(config.as_ref());
    let language = args.language.unwrap_or(choice.language);
    let mapping = args.mapping.as_deref().map(check::mapping).transpose()?;
    let last = args.last.as_deref().map(last_order).transpose();
    let last = last.map_err(|fault| failed(&fault))?;
    let last = args.last.as_deref().zip(last);
    let named = named(args, last.as_ref().map(|(_, order)| order));
    let garment = named.chosen(&garments, &choice.garment)?;
    let record = report::record_at(path).map_err(|fault| failed(&fault))?;
    if record.has_finding(NOT_VOUCHED) {
        let name = terminal_safe(path.display());
        let message =
            language.filled("ordering.not_vouched", &[("record", &name), ("sums", &SUMS)]);
        complain(format_args!("gaiter: {message}"));
    }
    let order = order_from_args(args, &record, &garment, last, choice.sizes.scanner_girth_mm);
    let order = order.map_err(|fault| failed(&fault))?.on(Zoned::now().date(), choice.age_max);
    let files = files(&order, mapping.as_ref(), &record, language)
        .map_err(|fault| failed(&OrderVerbFault::from(fault)))?;
    open::lines(&order, language).iter().for_each(|line| complain(format_args!("gaiter: {line}")));
    let printed = match &args.out {
        Some(out) => {
            let paths = report::placed(&files, out, args.force);
            let paths = paths.map_err(|fault| failed(&fault))?;
            print(report::written(&paths, args.json))
        }
        None => {
            let name = OrderFile::Json.word();
            let is_asked = |file: &&RecordFile| (file.name == name) == args.json;
            // The JSON is there, and another file: first the exact table.
            let file = files.iter().find(is_asked).ok_or(Exit::Internal)?;
            print_to(io::stdout().lock(), &file.bytes)
        }
    };
    Ok(exit_of_printing("the order", printed))
}

/// The order of the command line.
fn order_from_args(
    args: &OrderOf,
    record: &Record,
    garment: &Garment,
    last: Option<(&Path, Order)>,
    scanner_girth_mm: f64,
) -> Result<Order, OrderVerbFault> {
    let order_ref =
        args.order_ref.as_deref().map(|text| OrderRef::new(text, record)).transpose()?;
    let order_ref = order_ref.as_ref();
    let Some((path, last)) = last else {
        return Ok(Order::from_record(record, garment, order_ref, scanner_girth_mm));
    };
    let again = match args.reorder {
        Some(Repeat::Exact) => Order::exact(&last, record, garment, order_ref),
        _ => Order::with_changes(&last, record, garment, order_ref, scanner_girth_mm),
    };
    again.map_err(|source| OrderVerbFault::Reorder { path: path.to_owned(), source })
}

/// The files of the order: the mapping's that was asked for, else the tables for programs and for people, and the
/// JSON from which it can be repeated.
fn files(
    order: &Order,
    mapping: Option<&Mapping>,
    record: &Record,
    language: Language,
) -> Result<Vec<RecordFile>, serde_json::Error> {
    let own = |kind: OrderFile| kind.of(order, language);
    let Some(mapping) = mapping else {
        return OrderFile::ALL.into_iter().map(own).collect();
    };
    let patient = record.patient.as_ref().map(|patient| patient.id.as_str());
    let name = mapped_name(order, mapping);
    Ok(vec![RecordFile { name, bytes: mapped(order, mapping, patient) }, own(OrderFile::Json)?])
}

/// The last order. Its length is looked at first: a scan in the wrong place is not read whole.
fn last_order(path: &Path) -> Result<Order, OrderVerbFault> {
    let unreadable = |source| OrderVerbFault::Unreadable { path: path.to_owned(), source };
    let file = File::open(path).map_err(unreadable)?;
    let mut bytes = Vec::new();
    file.take(BYTES_MAX as u64 + 1).read_to_end(&mut bytes).map_err(unreadable)?;
    read(&bytes).map_err(|source| OrderVerbFault::Last { path: path.to_owned(), source })
}

/// The garment that the command line names, else that of the last order.
fn named(args: &OrderOf, last: Option<&Order>) -> GarmentArgs {
    let mut named = args.garment.clone();
    if let (GarmentArgs { garment: None, garment_file: None }, Some(last)) = (&named, last) {
        named.garment = Some(last.garment.name.clone());
    }
    named
}
