//! `[store.gdt]` and `[patient.orders]`: practice software with GDT.

use std::path::PathBuf;
use std::time::Duration;

use gaiter_flow::{Mask, OrdersWhen};
use gaiter_record::gdt::rules::FileName;
use gaiter_record::gdt::{GdtRules, Product, Reference};

use super::parse::{self, Absent, Found, Reader, What, is_bare};
use super::words::Words;
use crate::store::gdt::Attached;

/// `[store.gdt]`: practice software that is notified of every named record.
#[derive(Debug, Clone)]
pub struct GdtStoreConfig {
    /// The exchange folder.
    pub path: PathBuf,
    /// How results are written.
    pub rules: GdtRules,
    /// How result files are named.
    pub file_name: FileName,
    /// Files of the record that are attached to each result.
    pub attach: Vec<Attached>,
    /// How a result refers to its attachments.
    pub attach_as: Reference,
    /// The exchange folder as the practice software sees it; empty if it is as the station sees it.
    pub attach_root: String,
}

/// `[patient.orders]`: where orders from practice software arrive.
#[derive(Debug, Clone)]
pub struct OrdersConfig {
    /// The folder.
    pub path: PathBuf,
    pub files: Mask,
    /// When they arrive, relative to the press.
    pub when: OrdersWhen,
    /// What happens to an order after it is read.
    pub after: AfterOrder,
    /// Lengths are not checked.
    pub lenient: bool,
    /// A file unchanged this long is complete; the folder is looked through as often.
    pub quiet: Duration,
    /// An order older than this no longer names a patient.
    pub max_age: Duration,
}

/// What happens to an order after it is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AfterOrder {
    Delete,
    /// It stays in the folder, and the station remembers it.
    Keep,
}

const PROFILES: Words<Product> = &[
    ("default", Product::Default),
    ("medistar", Product::Medistar),
    ("turbomed", Product::Turbomed),
    ("tomedo", Product::Tomedo),
    ("format-first", Product::FormatFirst),
];

const REFERENCES: Words<Reference> =
    &[("full", Reference::Full), ("relative", Reference::Relative), ("name", Reference::Name)];

const AFTERS: Words<AfterOrder> = &[("delete", AfterOrder::Delete), ("keep", AfterOrder::Keep)];

/// `patient.orders.when`
const WHENS: Words<OrdersWhen> =
    &[("before-press", OrdersWhen::BeforePress), ("after-press", OrdersWhen::AfterPress)];

/// The folder as written, and the settings of its section. Without a folder the section is off.
type Section<T> = (Option<Found<PathBuf>>, Option<T>);

/// Reads the keys of `[store.gdt]`. The practice software is known without a folder, too: it also writes
/// orders.
pub(super) fn store(reader: &mut Reader) -> Option<(Product, Section<GdtStoreConfig>)> {
    use Absent::Default;
    let path = reader.text("store.gdt.path", Default(""), parse::or_none(parse::full_path));
    let path = path.and_then(parse::if_set);
    let product = reader.value("store.gdt.profile", "default", parse::word(PROFILES))?;
    let receiver = reader.value("store.gdt.receiver", "PRAX_EDV", short_name)?;
    let sender = reader.value("store.gdt.sender", "LEGSCAN1", short_name)?;
    let procedure = reader.value("store.gdt.procedure", "ALLG00", short_name)?;
    let key = "store.gdt.file_name";
    let file_name = reader.text(key, Default(""), |text| Ok(text.to_owned()));
    let attach = reader.list("store.gdt.attach", Default(""), attached);
    let (attach_as, attach_root) = reader.value("store.gdt.attach_as", "full", reference)?;

    let file_name = file_name.and_then(|found| {
        let text = Some(found.value.as_str()).filter(|text| !text.is_empty());
        let name = FileName::new(text.unwrap_or(product.file_name()), &receiver, &sender);
        if name.is_none() {
            let what = "a valid name of a file that GDT exchanges";
            let hint = "write \"{receiver}{sender}.GDT\" or \"{receiver}{sender}.{counter}\"";
            reader.note(found.at, key, What::not_a(&found.value, what, hint));
        }
        name
    });
    let config = path.as_ref().zip(file_name).map(|(path, file_name)| GdtStoreConfig {
        path: path.value.clone(),
        rules: GdtRules {
            receiver,
            sender,
            version: product.version().to_owned(),
            charset: product.charset(),
            procedure,
            attachment_fields: product.attachment_fields(),
        },
        file_name,
        attach: attach.into_iter().map(|found| found.value).collect(),
        attach_as,
        attach_root,
    });
    Some((product, (path, config)))
}

/// Reads the keys of `[patient.orders]`.
pub(super) fn orders(reader: &mut Reader) -> Option<Section<OrdersConfig>> {
    let path = parse::or_none(parse::full_path);
    let path = reader.text("patient.orders.path", Absent::Default(""), path);
    let path = path.and_then(parse::if_set);
    let files = reader.value("patient.orders.files", "*.gdt", mask)?;
    let when = reader.value("patient.orders.when", "before-press", parse::word(WHENS))?;
    let after = reader.value("patient.orders.after", "delete", parse::word(AFTERS))?;
    let lenient = reader.flag("patient.orders.lenient", "false");
    let quiet = reader.value("patient.orders.quiet", "1s", parse::duration_in("50ms"..="1m"))?;
    let max_age =
        reader.value("patient.orders.max_age", "12h", parse::duration_in("1m"..="168h"))?;
    let config = path.as_ref().map(|path| {
        let path = path.value.clone();
        OrdersConfig { path, files, when, after, lenient, quiet, max_age }
    });
    Some((path, config))
}

/// Short names of programs and examinations: only what every character set and file system accepts.
fn short_name(text: &str) -> Result<String, What> {
    let plain = text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-');
    if plain && (1..=8).contains(&text.len()) {
        return Ok(text.into());
    }
    Err(What::not_a(
        text,
        "a valid short name of GDT",
        "1 to 8 letters (a-z, A-Z), digits, - and _",
    ))
}

/// The bare name of a file, or that of a folder before it.
fn attached(text: &str) -> Result<Attached, What> {
    let (folder, name) = match text.split_once('/') {
        Some((folder, name)) => (Some(folder), name),
        None => (None, text),
    };
    if is_bare(name) && folder.is_none_or(is_bare) {
        return Ok(Attached { folder: folder.unwrap_or_default().into(), name: name.into() });
    }
    let hint = "letters, digits, -, _ and ., as in \"legs.svg\" or \"legs/legs.svg\"";
    Err(What::not_a(text, "a valid name of a file", hint))
}

/// A word of [`REFERENCES`], or the path of the exchange folder as the practice software sees it.
fn reference(text: &str) -> Result<(Reference, String), What> {
    if !text.contains(['/', '\\']) {
        return parse::word(REFERENCES)(text).map(|reference| (reference, String::new()));
    }
    if text.contains(char::is_control) {
        return Err(parse::control_in_path(text));
    }
    Ok((Reference::Full, text.into()))
}

fn mask(text: &str) -> Result<Mask, What> {
    let hint = "a file name in which * stands for anything and ? for one character: \"*.gdt\"";
    Mask::new(text).ok_or_else(|| What::not_a(text, "a valid mask of file names", hint))
}
