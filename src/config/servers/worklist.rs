//! `[patient.worklist]`: the worklist of a hospital system.

use std::time::Duration;

use gaiter_dicom::dimse::Titles;
use gaiter_flow::worklist::WorklistFilter;

use super::dicom::title;
use super::{APPLICATION, ENCRYPTIONS, TlsKeys, host_and_port, set_without, tls, tls_of_line};
use crate::config::parse::{self, Absent, Found, Reader, What, or_none};
use crate::store::Peer;
use crate::store::dicom::DimseServer;

/// `[patient.worklist]`: a server that states who is expected today (DICOM Modality Worklist).
#[derive(Debug, Clone)]
pub struct WorklistConfig {
    /// Where it is, and who asks whom.
    pub server: DimseServer,
    /// The station's AE title, under which it asks, and its modality: entries are planned for these.
    pub filter: WorklistFilter,
    /// How often the server is asked.
    pub every: Duration,
}

/// The longest modality, characters (VR CS).
const MODALITY_MOST: usize = 16;

const TLS: TlsKeys = [
    "patient.worklist.authorities",
    "patient.worklist.certificate",
    "patient.worklist.certificate_key",
];

/// Reads the keys of `[patient.worklist]`. Without an address the section is off.
pub(in crate::config) fn worklist(reader: &mut Reader) -> Option<WorklistConfig> {
    use Absent::Default;
    let key = "patient.worklist.address";
    let address = reader.text(key, Default(""), or_none(host_and_port));
    let called = reader.text("patient.worklist.server_ae_title", Default(""), or_none(title));
    let calling = reader.value("patient.worklist.ae_title", APPLICATION, title)?;
    let modality = reader.value("patient.worklist.modality", "", or_none(modality))?;
    let every = reader.value("patient.worklist.every", "1m", parse::duration_in("10s"..="1h"))?;
    let words = parse::word(ENCRYPTIONS);
    let encryption = reader.value("patient.worklist.encryption", "tls", words)?;
    let tls = tls(reader, TLS);
    let limit =
        reader.value("patient.worklist.timeout", "10s", parse::duration_in("1s"..="20s"))?;
    let Found { value: (host, port), at } = address.and_then(parse::if_set)?;
    let called = called?.value;
    if called.is_none() {
        reader.note(at, key, set_without("patient.worklist.server_ae_title"));
    }
    let tls = tls_of_line(reader, TLS, tls?, encryption);
    let peer = Peer { host, port, tls, limit };
    let filter = WorklistFilter { station: calling.as_str().to_owned(), modality };
    let server = DimseServer { peer, titles: Titles { calling, called: called? } };
    Some(WorklistConfig { server, filter, every })
}

/// A code string such as `OSS`.
fn modality(text: &str) -> Result<String, What> {
    let is_plain = |byte: u8| byte.is_ascii_uppercase() || byte.is_ascii_digit() || byte == b'_';
    if text.len() <= MODALITY_MOST && text.bytes().all(is_plain) {
        return Ok(text.to_owned());
    }
    Err(What::not_a(text, "a valid modality", "capitals, digits and _: \"OSS\""))
}
