//! An archive asked over DICOMweb: STOW-RS and QIDO-RS.

use std::time::Duration;

use gaiter_dicom::{DicomObject, Listed, Study, web};
use gaiter_https::{HttpsClient, TlsFiles};
use http::{Method, Response, StatusCode};

use super::answers::{self, Failed};
use super::unwritable;
use crate::store::server::ServerFault;
use crate::store::web::{asked, secret_words};
use crate::store::{HttpAccess, StoreFault};

/// The search for studies of a patient whom no archive knows.
const TRIAL_SEARCH: &str = "studies?PatientID=gaiter-check&limit=1";

/// An archive with DICOMweb.
#[derive(Debug)]
pub(super) struct WebArchive {
    /// Without a slash at its end.
    base: String,
    access: HttpAccess,
    client: HttpsClient,
}

impl WebArchive {
    pub fn new(base: String, access: HttpAccess, tls: TlsFiles, limit: Duration) -> WebArchive {
        WebArchive { base, access, client: HttpsClient::new(tls, None, limit) }
    }

    /// Whether it lets the station search. Whether it lets it store, the first record tells.
    pub fn reach(&self) -> Result<(), StoreFault> {
        let (answer, secret) = self.ask(Method::GET, TRIAL_SEARCH, None)?;
        let is_list = |body: &[u8]| web::is_list(body).then_some(());
        answers::found(&answer, Some(&without(&secret, "")), is_list, "studies")
    }

    /// What the server has of a study. With `repeats` a fault repeats what it says.
    pub fn listed(&self, study: &Study, repeats: bool) -> Result<Vec<Listed>, StoreFault> {
        let (answer, secret) = self.ask(Method::GET, &web::search(study), None)?;
        if answer.status() == StatusCode::NOT_FOUND {
            // Some archives answer so if they do not have the study. A server that is no archive, or one that is not
            // up yet, does so, too.
            return self.reach().map(|()| Vec::new());
        }
        let secret = without(&secret, study.patient());
        let kind = "objects with class, series and UID";
        answers::found(&answer, repeats.then_some(&secret[..]), web::listed, kind)
    }

    /// Sends an object. Whether the server has it, only a search tells. With `repeats` a fault repeats what it says.
    pub fn store(
        &self,
        object: &DicomObject,
        study: &Study,
        repeats: bool,
    ) -> Result<Option<Failed>, StoreFault> {
        let body = web::multipart(object).map_err(unwritable)?;
        let (answer, secret) = self.ask(Method::POST, "studies", Some(body))?;
        let secret = without(&secret, study.patient());
        answers::stored(&answer, repeats.then_some(&secret[..]))
    }

    /// Asks the server for a path below its base, with a body of this media type or without. Returns the answer, and
    /// the words that must get into no log.
    fn ask(
        &self,
        method: Method,
        path: &str,
        body: Option<(String, Vec<u8>)>,
    ) -> Result<(Response<Vec<u8>>, Vec<String>), ServerFault> {
        let address = format!("{}/{path}", self.base);
        let shown = self.access.authorization()?;
        let secret = shown.as_ref().map(secret_words).unwrap_or_default();
        Ok((asked(&self.client, method, &address, web::JSON, body, shown)?, secret))
    }
}

/// The words that must get into no log: those of the credentials, and the patient's id.
fn without<'w>(secret: &'w [String], patient: &'w str) -> Vec<&'w str> {
    secret.iter().map(String::as_str).chain([patient]).collect()
}
