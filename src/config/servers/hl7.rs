//! `[store.hl7]`: a receiver of HL7 v2.

use std::path::PathBuf;

use gaiter_record::hl7::{Charset, PdfForm};

use super::{APPLICATION, ENCRYPTIONS, TlsKeys, host_and_port, line, no_effect, tls, tls_of_line};
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

/// Keys that have an effect over a connection only.
const FOR_MLLP: [&str; 5] = ["store.hl7.encryption", TLS[0], TLS[1], TLS[2], "store.hl7.timeout"];

/// The folder as written, and the settings of the section, if it is not off.
type Section = (Option<Found<PathBuf>>, Option<Hl7StoreConfig>);

/// Reads the keys of `[store.hl7]`. Without an address and a folder the section is off.
pub(in crate::config) fn hl7(reader: &mut Reader) -> Option<Section> {
    let address = reader.text("store.hl7.address", Absent::Default(""), or_none(host_and_port));
    let path = reader.text("store.hl7.path", Absent::Default(""), or_none(parse::full_path));
    let path = path.and_then(parse::if_set);
    let way = way(reader, address, path.as_ref());
    let application = reader.value("store.hl7.application", APPLICATION, line)?;
    let facility = reader.value("store.hl7.facility", "", line)?;
    let to_application = reader.value("store.hl7.receiving_application", "", line)?;
    let to_facility = reader.value("store.hl7.receiving_facility", "", line)?;
    let processing =
        reader.value("store.hl7.processing", "production", parse::word(PROCESSINGS))?;
    let version = reader.value("store.hl7.version", "2.5", parse::word(VERSIONS))?;
    let authority = reader.value("store.hl7.authority", "", line)?;
    let pdf = reader.value("store.hl7.pdf", "media-type", parse::word(PDFS))?;
    let charset = reader.value("store.hl7.charset", "utf-8", parse::word(CHARSETS))?;
    let config = way.map(|way| Hl7StoreConfig {
        way,
        sender: [application, facility],
        receiver: [to_application, to_facility],
        processing,
        version: version.to_owned(),
        authority,
        pdf,
        charset,
    });
    Some((path, config))
}

/// The one way that is configured, if its address is right.
fn way(
    reader: &mut Reader,
    address: Option<Found<Option<(String, u16)>>>,
    path: Option<&Found<PathBuf>>,
) -> Option<Hl7Way> {
    let encryption = reader.value("store.hl7.encryption", "tls", parse::word(ENCRYPTIONS))?;
    let tls = tls(reader, TLS);
    let limit = reader.value("store.hl7.timeout", "30s", parse::duration_in("1s"..="50s"))?;
    // A wrong address is noted; keys of a connection may well have an effect then.
    match (address?.value, path) {
        (None, None) => None,
        (Some((host, port)), None) => {
            let tls = tls_of_line(reader, TLS, tls?, encryption);
            Some(Hl7Way::Mllp(Peer { host, port, tls, limit }))
        }
        (None, Some(folder)) => {
            reader.note_unread(&FOR_MLLP, || no_effect("with files in a folder"));
            Some(Hl7Way::Files(folder.value.clone()))
        }
        (Some(_), Some(Found { at, .. })) => {
            let what = What::own("is set together with store.hl7.address", "remove one of the two");
            reader.note(at.clone(), "store.hl7.path", what);
            None
        }
    }
}
