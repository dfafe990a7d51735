//! An archive of images (DICOMweb) that keeps what it is sent, or refuses it with a remark that names the patient.

use std::io::Write;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use serde_json::{Value, json};
use support::http_server::{answer, request_of, serve};
use support::stow::SentObject;

#[derive(Debug, Default)]
struct Told {
    is_keeping: bool,
    refused: Vec<SentObject>,
    kept: Vec<SentObject>,
}

/// An archive at a port of this machine.
#[derive(Debug)]
pub struct ImageArchive {
    port: u16,
    told: Arc<Mutex<Told>>,
}

impl ImageArchive {
    /// It refuses for now.
    pub fn that_refuses() -> ImageArchive {
        let told = Arc::<Mutex<Told>>::default();
        let theirs = Arc::clone(&told);
        let port = serve(move |mut stream| {
            // A connection without a request gets no answer.
            let Ok(request) = request_of(&mut stream) else { return };
            let answer = locked(&theirs).answer_to(&request);
            let _ = stream.write_all(answer.as_bytes());
        });
        ImageArchive { port, told }
    }

    /// The section of a station that sends to it, with the names that the worklist tells.
    pub fn section(&self) -> String {
        let port = self.port;
        format!("[store.dicom]\naddress = \"http://127.0.0.1:{port}/dicom-web\"\nnames = true\n")
    }

    /// From now on it keeps what it is sent.
    pub fn keeps(&self) {
        locked(&self.told).is_keeping = true;
    }

    /// What it has refused.
    pub fn refused(&self) -> Vec<SentObject> {
        locked(&self.told).refused.clone()
    }

    /// What it has.
    pub fn kept(&self) -> Vec<SentObject> {
        locked(&self.told).kept.clone()
    }
}

fn locked(told: &Mutex<Told>) -> MutexGuard<'_, Told> {
    told.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Told {
    /// Every search shows all that it has.
    fn answer_to(&mut self, request: &str) -> String {
        if request.starts_with("GET ") {
            let shown: Vec<Value> = self.kept.iter().map(SentObject::shown).collect();
            return answer("200 OK", &json!(shown).to_string());
        }
        let objects = SentObject::all(request);
        if self.is_keeping {
            self.kept.extend(objects);
            return answer("200 OK", "{}");
        }
        let names: Vec<&str> = objects.iter().map(|object| object.name.as_str()).collect();
        let remark = format!("no order of {}", names.join(", "));
        self.refused.extend(objects);
        answer("503 Service Unavailable", &remark)
    }
}
