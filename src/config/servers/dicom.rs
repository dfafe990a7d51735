//! `[store.dicom]`: an archive of images.

use gaiter_dicom::attachable;
use gaiter_dicom::dimse::{AeTitle, Titles};
use gaiter_https::Secret;

use super::{
    APPLICATION, ENCRYPTIONS, TlsKeys, address, file_name, host_and_port, keys_of_access, line,
    no_effect, secret, set_without, tls, tls_of_line, user,
};
use crate::config::parse::{self, Absent, Found, Reader, What, or_none};
use crate::config::words::Words;
use crate::store::dicom::{DicomServer, DimseServer};
use crate::store::{HttpAccess, Peer};

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

/// Where an archive is, and by its form how it is asked.
#[derive(Debug, Clone)]
enum Place {
    Web(String),
    Dimse(String, u16),
}

/// The keys for DICOMweb alone.
const FOR_WEB: [&str; 3] = ["store.dicom.access", "store.dicom.user", "store.dicom.secret"];

/// The keys for associations alone.
const FOR_DIMSE: [&str; 3] =
    ["store.dicom.server_ae_title", "store.dicom.ae_title", "store.dicom.encryption"];

const TLS: TlsKeys =
    ["store.dicom.authorities", "store.dicom.certificate", "store.dicom.certificate_key"];

/// The longest name of who assigns ids, characters (LO).
const ISSUER_MOST: usize = 64;

/// Reads the keys of `[store.dicom]`. Without an address the section is off.
pub(in crate::config) fn dicom(reader: &mut Reader) -> Option<DicomStoreConfig> {
    use Absent::Default;
    let place = reader.text("store.dicom.address", Default(""), or_none(place));
    let issuer = reader.value("store.dicom.issuer", "", issuer)?;
    let attach = reader.list("store.dicom.attach", Default("report.pdf"), attached);
    let names = reader.flag("store.dicom.names", "false");
    let kind = reader.text("store.dicom.access", Default("open"), parse::word(KINDS));
    let user = reader.text("store.dicom.user", Default(""), or_none(user));
    let secret = reader.text("store.dicom.secret", Default(""), or_none(secret));
    let called = reader.text("store.dicom.server_ae_title", Default(""), or_none(title));
    let calling = reader.value("store.dicom.ae_title", APPLICATION, title)?;
    let encryption = reader.value("store.dicom.encryption", "tls", parse::word(ENCRYPTIONS))?;
    let tls = tls(reader, TLS);
    let limit = reader.value("store.dicom.timeout", "30s", parse::duration_in("1s"..="50s"))?;
    let Found { value: place, at } = place.and_then(parse::if_set)?;
    let (kind, user, secret) = (kind?, user?.value, secret?.value);
    let (called, tls) = (called?.value, tls?);
    let server = match place {
        Place::Web(base) => {
            reader.note_unread(&FOR_DIMSE, || no_effect("over DICOMweb"));
            let access = access(reader, kind, user, secret)?;
            DicomServer::Web { base, access, tls, limit }
        }
        Place::Dimse(host, port) => {
            reader.note_unread(&FOR_WEB, || no_effect("by C-STORE"));
            if called.is_none() {
                let without = set_without("store.dicom.server_ae_title");
                reader.note(at, "store.dicom.address", without);
            }
            let titles = Titles { calling, called: called? };
            let tls = tls_of_line(reader, TLS, tls, encryption);
            let peer = Peer { host, port, tls, limit };
            DicomServer::Dimse(DimseServer { peer, titles })
        }
    };
    let attach = attach.into_iter().map(|found| found.value).collect();
    Some(DicomStoreConfig { server, issuer, attach, names })
}

/// The base address of DICOMweb, or host and port of a server that takes associations.
fn place(text: &str) -> Result<Place, What> {
    match text.contains("://") {
        true => address(text).map(Place::Web),
        false => host_and_port(text).map(|(host, port)| Place::Dimse(host, port)),
    }
}

/// How the station authenticates.
fn access(
    reader: &mut Reader,
    Found { value: kind, at }: Found<Kind>,
    user: Option<String>,
    secret: Option<Secret>,
) -> Option<HttpAccess> {
    let keys = [
        ("store.dicom.user", user.is_some(), kind == Kind::Basic),
        ("store.dicom.secret", secret.is_some(), kind != Kind::Open),
    ];
    keys_of_access(reader, at, "store.dicom.access", &keys);
    Some(match kind {
        Kind::Open => HttpAccess::Open,
        Kind::Basic => HttpAccess::Basic { user: user?, password: secret? },
        Kind::Bearer => HttpAccess::Bearer { token: secret? },
    })
}

/// The title of an application.
pub(super) fn title(text: &str) -> Result<AeTitle, What> {
    let hint = "write 1 to 16 letters, digits and signs of ASCII, as in \"ORTHANC\"";
    AeTitle::new(text).map_err(|_| What::not_a(text, "a valid AE title", hint))
}

/// Who assigns ids, as DICOM can write it.
fn issuer(text: &str) -> Result<String, What> {
    if text.contains('\\') || text.chars().count() > ISSUER_MOST {
        let hint = "write up to 64 characters without a backslash";
        return Err(What::not_a(text, "a valid name of who assigns ids", hint));
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
            Err(What::not_a(text, "a file that DICOM has an object for", hint))
        }
    }
}
