//! `[patient.worklist]`: the worklist of a hospital system.

use std::time::Duration;

use gaiter_flow::worklist::WorklistFilter;
use gaiter_https::TlsFiles;

use super::{TlsKeys, host_and_port, tls};
use crate::config::fault::What;
use crate::config::parse::{self, Absent, Reader, not_a, or_none};
use crate::config::words::Words;

/// `[patient.worklist]`: a server that states who is expected today (DICOM Modality Worklist).
#[derive(Debug, Clone)]
pub struct WorklistConfig {
    pub host: String,
    pub port: u16,
    /// Certificates; `None` without encryption.
    pub tls: Option<TlsFiles>,
    /// The server's AE title.
    pub server: String,
    /// The station's AE title and modality: it asks under this title, and entries are planned for it.
    pub filter: WorklistFilter,
    /// How often the server is asked.
    pub every: Duration,
    /// How long each answer of the server may take.
    pub limit: Duration,
}

/// The longest AE title, characters (PS3.5, VR AE).
const TITLE_MOST: usize = 16;

/// The longest modality, characters (VR CS).
const MODALITY_MOST: usize = 16;

/// `patient.worklist.encryption`
const ENCRYPTIONS: Words<bool> = &[("tls", true), ("none", false)];

const TLS: TlsKeys = TlsKeys {
    authorities: "patient.worklist.authorities",
    certificate: "patient.worklist.certificate",
    key: "patient.worklist.certificate_key",
};

/// Reads the keys of `[patient.worklist]`. Without an address the section is off.
pub(in crate::config) fn worklist(reader: &mut Reader) -> Option<Option<WorklistConfig>> {
    use Absent::Default;
    let key = "patient.worklist.address";
    let address = reader.text(key, Default(""), or_none(host_and_port));
    let server = reader.text("patient.worklist.server", Default(""), or_none(title));
    let own = reader.text("patient.worklist.title", Default("GAITER"), title);
    let modality = reader.text("patient.worklist.modality", Default(""), or_none(modality));
    let every =
        reader.text("patient.worklist.every", Default("1m"), parse::duration_in("10s"..="1h"));
    let words = parse::word(ENCRYPTIONS);
    let encryption = reader.text("patient.worklist.encryption", Default("tls"), words);
    let tls = tls(reader, &TLS);
    let limit =
        reader.text("patient.worklist.timeout", Default("10s"), parse::duration_in("1s"..="20s"));
    let address = address?;
    let Some((host, port)) = address.value else { return Some(None) };
    let server = server?.value;
    if server.is_none() {
        reader.note(address.at, key, What::Without("patient.worklist.server"));
    }
    let tls = tls?;
    Some(Some(WorklistConfig {
        host,
        port,
        tls: encryption?.value.then_some(tls),
        server: server?,
        filter: WorklistFilter { station: own?.value, modality: modality?.value },
        every: every?.value,
        limit: limit?.value,
    }))
}

/// An AE title: printable ASCII without \, with no space at an end.
fn title(text: &str) -> Result<String, What> {
    let is_plain = |byte: u8| (b' '..=b'~').contains(&byte) && byte != b'\\';
    if !text.is_empty()
        && text.len() <= TITLE_MOST
        && text.trim() == text
        && text.bytes().all(is_plain)
    {
        return Ok(text.to_owned());
    }
    Err(not_a(text, "a valid AE title", "1 to 16 characters without umlauts and \\: \"GAITER\""))
}

/// A code string such as `OSS`.
fn modality(text: &str) -> Result<String, What> {
    let is_plain = |byte: u8| byte.is_ascii_uppercase() || byte.is_ascii_digit() || byte == b'_';
    if text.len() <= MODALITY_MOST && text.bytes().all(is_plain) {
        return Ok(text.to_owned());
    }
    Err(not_a(text, "a valid modality", "capitals, digits and _: \"OSS\""))
}
