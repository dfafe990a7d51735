//! Today's worklist, for who decides on the page. It has names and birth dates, so it is in no snapshot: whoever asks
//! shows the token each time, as for a decision, and a kiosk and the network never get it.

use std::sync::Arc;

use axum::body::to_bytes;
use axum::extract::{Request, State};
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use gaiter_flow::worklist::WorklistEntry;
use gaiter_record::shown;
use serde::{Deserialize, Serialize};

use super::ask::{json, refusal};
use super::endpoint::HttpEndpoint;

/// The longest question, bytes.
const MOST: usize = 1024;

/// What a page asks.
#[derive(Debug, Default, Deserialize)]
struct WorklistQuestion {
    /// It was just opened: the server is to be asked again soon.
    #[serde(default)]
    anew: bool,
}

#[derive(Serialize)]
struct WorklistShown {
    /// `null` while the server has given no answer for today.
    entries: Option<Vec<WorklistEntryShown>>,
}

/// An entry on the page, with nothing hidden in what tells one from another.
#[derive(Serialize)]
struct WorklistEntryShown {
    /// As it is sent back when it is chosen.
    key: String,
    patient: String,
    name: String,
    /// `1950-01-02`
    born: Option<String>,
    /// `09:30`
    time: Option<String>,
    procedure: String,
    accession_number: Option<String>,
}

impl From<WorklistEntry> for WorklistEntryShown {
    fn from(entry: WorklistEntry) -> WorklistEntryShown {
        let time = entry.scheduled.time;
        WorklistEntryShown {
            key: entry.key(),
            patient: shown::id(&entry.patient),
            name: shown::id(&entry.person.name),
            born: entry.person.birth_date.map(|date| date.to_string()),
            time: time.map(|time| format!("{:02}:{:02}", time.hour(), time.minute())),
            procedure: entry.procedure,
            accession_number: entry.request.and_then(|request| request.accession_number),
        }
    }
}

/// The entries of today.
pub async fn worklist(State(endpoint): State<Arc<HttpEndpoint>>, request: Request) -> Response {
    if let Some(refused) = refusal(&endpoint, request.headers()) {
        return refused;
    }
    if !endpoint.desk.core.config.page.ids.to(true) {
        return StatusCode::FORBIDDEN.into_response();
    }
    let Ok(body) = to_bytes(request.into_body(), MOST).await else {
        return StatusCode::PAYLOAD_TOO_LARGE.into_response();
    };
    // A question that cannot be read asks for nothing more than the entries.
    let question: WorklistQuestion = serde_json::from_slice(&body).unwrap_or_default();
    if question.anew {
        endpoint.desk.booth.wish_worklist();
    }
    let entries = endpoint.desk.booth.listed();
    let entries = entries.map(|all| all.into_iter().map(WorklistEntryShown::from).collect());
    json(&WorklistShown { entries })
}
