//! `[store.dicom]`: an archive of images.

use gaiter_dicom::attachable;
use gaiter_dicom::dimse::{AeTitle, Titles};

use super::{TlsKeys, address, file_name, host_and_port, line, secret, tls, user};
use crate::config::fault::What;
use crate::config::parse::{self, Absent, Found, Reader, not_a, or_none};
use crate::config::words::Words;
use crate::store::dicom::{DicomAccess, DicomServer, DicomWay, DimseServer};

/// `[store.dicom]`: an archive of images that gets every named record.
#[derive(Debug, Clone)]
pub struct DicomStoreConfig {
    /// Where it is and how it is asked.
    pub server: DicomServer,
    /// Who assigns the patients' ids; empty for nobody.
    pub issuer: String,
    /// Files of the record that are sent with it.
    pub attach: Vec<String>,
    /// Whether it gets names as the worklist told them.
    pub names: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Open,
    Basic,
    Bearer,
}

/// `store.dicom.access`
const KINDS: Words<Kind> =
    &[("open", Kind::Open), ("basic", Kind::Basic), ("bearer", Kind::Bearer)];

/// `store.dicom.encryption`
const ENCRYPTIONS: Words<bool> = &[("tls", true), ("none", false)];

/// Where an archive is, and by its form how it is asked.
#[derive(Debug, Clone)]
enum Place {
    Web(String),
    Dimse(String, u16),
}

const TLS: TlsKeys = TlsKeys {
    authorities: "store.dicom.authorities",
    certificate: "store.dicom.certificate",
    key: "store.dicom.certificate_key",
};

/// The longest name of who assigns ids, characters (LO).
const ISSUER_MOST: usize = 64;

/// Reads the keys of `[store.dicom]`. Without an address the section is off.
pub(in crate::config) fn dicom(reader: &mut Reader) -> Option<Option<DicomStoreConfig>> {
    use Absent::Default;
    let place = reader.text("store.dicom.address", Default(""), or_none(place));
    let issuer = reader.text("store.dicom.issuer", Default(""), issuer);
    let attach = reader.list("store.dicom.attach", Default("report.pdf"), attached);
    let names = reader.flag("store.dicom.names", "false");
    let access = access(reader);
    let titles = titles(reader);
    let encryption =
        reader.text("store.dicom.encryption", Default("tls"), parse::word(ENCRYPTIONS));
    let tls = tls(reader, &TLS);
    let limit =
        reader.text("store.dicom.timeout", Default("30s"), parse::duration_in("1s"..="50s"));
    let Found { value: Some(place), at } = place? else { return Some(None) };
    let (access, (calling, called), encryption, tls) = (access?, titles?, encryption?.value, tls?);
    let way = match (place, called, access) {
        (Place::Web(base), None, access) => Ok(DicomWay::Web { base, access, tls }),
        (Place::Dimse(host, port), Some(called), DicomAccess::Open) => {
            let (titles, tls) = (Titles { calling, called }, encryption.then_some(tls));
            Ok(DicomWay::Dimse(DimseServer { host, port, titles, tls }))
        }
        (Place::Web(_), Some(_), _) => Err(What::Together("store.dicom.server_ae_title")),
        (Place::Dimse(..), None, _) => Err(What::Without("store.dicom.server_ae_title")),
        (Place::Dimse(..), Some(_), _) => Err(What::Together("store.dicom.access")),
    };
    let way = way.map_err(|what| reader.note(at, "store.dicom.address", what)).ok()?;
    let server = DicomServer { way, limit: limit?.value };
    Some(Some(DicomStoreConfig {
        server,
        issuer: issuer?.value,
        attach: attach.into_iter().map(|found| found.value).collect(),
        names: names?.value,
    }))
}

/// The base address of DICOMweb, or host and port of a server that takes associations.
fn place(text: &str) -> Result<Place, What> {
    match text.contains("://") {
        true => address(text).map(Place::Web),
        false => host_and_port(text).map(|(host, port)| Place::Dimse(host, port)),
    }
}

/// The titles of the station and of the server, which has one only if associations are asked for.
fn titles(reader: &mut Reader) -> Option<(AeTitle, Option<AeTitle>)> {
    use Absent::Default;
    let called = reader.text("store.dicom.server_ae_title", Default(""), or_none(title));
    let calling = reader.text("store.dicom.ae_title", Default("GAITER"), title);
    Some((calling?.value, called?.value))
}

/// The title of an application.
pub(super) fn title(text: &str) -> Result<AeTitle, What> {
    let hint = "write 1 to 16 letters, digits and signs of ASCII, as in \"ORTHANC\"";
    AeTitle::new(text).map_err(|_| not_a(text, "a valid AE title", hint))
}

/// How the station authenticates.
fn access(reader: &mut Reader) -> Option<DicomAccess> {
    use Absent::Default;
    let kind = reader.text("store.dicom.access", Default("open"), parse::word(KINDS));
    let user = reader.text("store.dicom.user", Default(""), or_none(user));
    let secret = reader.text("store.dicom.secret", Default(""), or_none(secret));
    let Found { value: kind, at } = kind?;
    let (user, secret) = (user?.value, secret?.value);
    // All missing keys are reported at once.
    let of_user = ("store.dicom.user", user.is_some());
    let of_secret = ("store.dicom.secret", secret.is_some());
    let needed = match kind {
        Kind::Open => Vec::new(),
        Kind::Basic => vec![of_user, of_secret],
        Kind::Bearer => vec![of_secret],
    };
    for (key, _) in needed.into_iter().filter(|(_, has)| !has) {
        reader.note(at.clone(), "store.dicom.access", What::Without(key));
    }
    Some(match kind {
        Kind::Open => DicomAccess::Open,
        Kind::Basic => DicomAccess::Basic { user: user?, password: secret? },
        Kind::Bearer => DicomAccess::Bearer { token: secret? },
    })
}

/// Who assigns ids, as DICOM can write it.
fn issuer(text: &str) -> Result<String, What> {
    if text.contains('\\') || text.chars().count() > ISSUER_MOST {
        let hint = "write up to 64 characters without a backslash";
        return Err(not_a(text, "a valid name of who assigns ids", hint));
    }
    line(text)
}

/// A file that there is an object for.
fn attached(text: &str) -> Result<String, What> {
    let name = file_name(text)?;
    match attachable(&name) {
        true => Ok(name),
        false => {
            let hint = "write files that end in .pdf, .stl or .obj, as in \"report.pdf\"";
            Err(not_a(text, "a file that DICOM has an object for", hint))
        }
    }
}
