//! An archive of images of a test's own: stores that send to it, and what it has.

#![allow(clippy::unwrap_used)]

use std::fs;
use std::time::Duration;

use gaiter::store::dicom::{DicomServer, DimseServer};
use gaiter::store::{DicomStore, HttpAccess, Peer};
use gaiter_dicom::DicomRules;
use gaiter_dicom::dimse::{AeTitle, Titles};
use gaiter_https::TlsFiles;
use gaiter_record::RecordFile;
use support::records::dicom_rules;

use crate::fhir_house::Store;
use crate::records::Scan;
use crate::server::House;

/// An STL file without a triangle.
const NO_TRIANGLES: [u8; 84] = [0; 84];

/// How an archive is asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Way {
    Web,
    Dimse,
}

impl Way {
    pub const ALL: [Way; 2] = [Way::Web, Way::Dimse];
}

pub fn rules() -> DicomRules {
    DicomRules { issuer: "KIS".to_owned(), ..dicom_rules(&["report.pdf", "left.stl"]) }
}

/// A scan whose record has a mesh, too.
pub fn with_mesh(scan: &Scan) -> Scan {
    let mut scan = scan.with(scan.record.clone(), &[]);
    scan.files.push(RecordFile { name: "left.stl".to_owned(), bytes: NO_TRIANGLES.to_vec() });
    scan
}

/// A store that sends to an archive.
pub fn store_at(server: DicomServer) -> Store {
    Box::new(DicomStore::new(server, rules(), "booth-1"))
}

/// An archive of this title that takes associations.
pub fn dimse_server(peer: Peer, called: &str) -> DicomServer {
    let title = |text: &str| AeTitle::new(text).unwrap();
    let titles = Titles { calling: title("GAITER"), called: title(called) };
    DicomServer::Dimse(DimseServer { peer, titles })
}

/// A port of this machine that is not encrypted.
pub fn plain_peer(port: u16, limit: Duration) -> Peer {
    Peer { host: "127.0.0.1".to_owned(), port, tls: None, limit }
}

/// The keys of `[store.dicom]` for associations that are not encrypted. Two objects are sent of a record.
pub fn dimse_section(port: u16, called: &str) -> String {
    format!(
        "[store.dicom]\naddress = \"127.0.0.1:{port}\"\nserver_ae_title = \"{called}\"\n\
         encryption = \"none\"\nattach = [\"report.pdf\"]\n"
    )
}

impl House {
    /// A store that sends to it.
    pub fn images(&self, way: Way, limit: Duration) -> Store {
        store_at(match way {
            Way::Web => DicomServer::Web {
                base: format!(
                    "http://127.0.0.1:{}/{}/dicom-web",
                    self.server.port("http"),
                    self.name
                ),
                access: HttpAccess::Open,
                tls: TlsFiles::default(),
                limit,
            },
            Way::Dimse => dimse_server(plain_peer(self.server.port("dimse"), limit), &self.name),
        })
    }

    /// How many objects it has. Every one that was sent could be read.
    #[track_caller]
    pub fn image_count(&self) -> usize {
        let faults = fs::read_to_string(self.server.path("faults")).unwrap_or_default();
        let own = format!("{} ", self.name);
        let faults: Vec<&str> = faults.lines().filter(|line| line.starts_with(&own)).collect();
        assert!(faults.is_empty(), "{faults:?}");
        let entries = fs::read_dir(self.path("objects")).into_iter().flatten();
        let names = entries.map(|entry| entry.unwrap().path());
        names.filter(|name| name.extension().is_some_and(|of| of == "dcm")).count()
    }
}
