//! `[store.hl7]`: a receiver of HL7 v2.

use std::path::PathBuf;

use gaiter_record::hl7::{Charset, PdfForm};

use super::{APPLICATION, ENCRYPTIONS, TlsKeys, host_and_port, line, tls, tls_of_line};
use crate::config::parse::{self, Absent, Found, Reader, What, or_none};
use crate::config::words::Words;
use crate::store::Peer;
use crate::store::hl7::Hl7Way;

/// `[store.hl7]`: a receiver of HL7 v2 that gets every named record.
#[derive(Debug, Clone)]
pub struct Hl7StoreConfig {
    /// How messages get there.
    pub way: Hl7Way,
    /// Application and facility that send; an empty facility stands for the station's name.
    pub sender: [String; 2],
    /// Application and facility that receive.
    pub receiver: [String; 2],
    /// `P` for production, `T` for training.
    pub processing: char,
    pub version: String,
    /// Who assigns the patients' ids.
    pub authority: String,
    /// How the PDF is sent.
    pub pdf: PdfForm,
    pub charset: Charset,
}

/// `store.hl7.processing`
const PROCESSINGS: Words<char> = &[("production", 'P'), ("training", 'T')];

/// `store.hl7.version`
const VERSIONS: Words<&str> = &[("2.3.1", "2.3.1"), ("2.4", "2.4"), ("2.5", "2.5"), ("2.6", "2.6")];

/// `store.hl7.pdf`
const PDFS: Words<PdfForm> =
    &[("media-type", PdfForm::MediaType), ("plain", PdfForm::Plain), ("none", PdfForm::None)];

/// `store.hl7.charset`
const CHARSETS: Words<Charset> = &[("utf-8", Charset::Utf8), ("8859-1", Charset::Latin1)];

const TLS: TlsKeys =
    ["store.hl7.authorities", "store.hl7.certificate", "store.hl7.certificate_key"];

/// The folder as written, and the settings of the section; `Some(None)` if it is off.
type Section = (Option<Found<PathBuf>>, Option<Option<Hl7StoreConfig>>);

/// Reads the keys of `[store.hl7]`. Without an address and a folder the section is off.
pub(in crate::config) fn hl7(reader: &mut Reader) -> Section {
    use Absent::Default;
    let address = reader.text("store.hl7.address", Default(""), or_none(host_and_port));
    let path = reader.text("store.hl7.path", Default(""), parse::or_none(parse::full_path));
    let folder = path.clone().and_then(parse::if_set);
    let way = way(reader, address, path);
    (folder, settings(reader, way))
}

/// The one way that is configured; `Some(None)` for none.
fn way(
    reader: &mut Reader,
    address: Option<Found<Option<(String, u16)>>>,
    path: Option<Found<Option<PathBuf>>>,
) -> Option<Option<Hl7Way>> {
    use Absent::Default;
    let encryption = reader.text("store.hl7.encryption", Default("tls"), parse::word(ENCRYPTIONS));
    let tls = tls(reader, TLS);
    let limit = reader.text("store.hl7.timeout", Default("30s"), parse::duration_in("1s"..="50s"));
    let (path, is_encrypted, tls, limit) = (path?, encryption?.value, tls?, limit?.value);
    match (address?.value, path.value) {
        (None, None) => Some(None),
        (Some((host, port)), None) => {
            let tls = tls_of_line(reader, TLS, tls, is_encrypted);
            Some(Some(Hl7Way::Mllp(Peer { host, port, tls, limit })))
        }
        (None, Some(folder)) => Some(Some(Hl7Way::Files(folder))),
        (Some(_), Some(_)) => {
            let what = What::own("is set together with store.hl7.address", "remove one of the two");
            reader.note(path.at, "store.hl7.path", what);
            None
        }
    }
}

fn settings(reader: &mut Reader, way: Option<Option<Hl7Way>>) -> Option<Option<Hl7StoreConfig>> {
    use Absent::Default;
    let application = reader.text("store.hl7.application", Default(APPLICATION), line);
    let facility = reader.text("store.hl7.facility", Default(""), line);
    let to_application = reader.text("store.hl7.receiving_application", Default(""), line);
    let to_facility = reader.text("store.hl7.receiving_facility", Default(""), line);
    let key = "store.hl7.processing";
    let processing = reader.text(key, Default("production"), parse::word(PROCESSINGS));
    let version = reader.text("store.hl7.version", Default("2.5"), parse::word(VERSIONS));
    let authority = reader.text("store.hl7.authority", Default(""), line);
    let pdf = reader.text("store.hl7.pdf", Default("media-type"), parse::word(PDFS));
    let charset = reader.text("store.hl7.charset", Default("utf-8"), parse::word(CHARSETS));
    let Some(way) = way? else { return Some(None) };
    Some(Some(Hl7StoreConfig {
        way,
        sender: [application?.value, facility?.value],
        receiver: [to_application?.value, to_facility?.value],
        processing: processing?.value,
        version: version?.value.to_owned(),
        authority: authority?.value,
        pdf: pdf?.value,
        charset: charset?.value,
    }))
}
