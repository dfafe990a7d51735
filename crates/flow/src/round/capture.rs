//! What a capture is, and the rules for it.

use std::collections::BTreeSet;
use std::time::Duration;

use gaiter_record::{ImagingRequest, Source, SourceKind};
use serde::{Deserialize, Serialize};

use crate::export::writing::Appeared;
use crate::orders::OrdersWhen;

/// Times and habits that control captures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rules {
    /// Rounds are opened by presses; without a button, by naming the patient.
    pub by_press: bool,
    /// How long to wait for the export of a press.
    pub window: Duration,
    /// How long after its window a late export is still accepted; it is then held.
    pub late: Duration,
    /// How long a patient's name waits for its press, or without a button for its export.
    pub name_lasts: Duration,
    /// When orders arrive.
    pub orders: OrdersWhen,
}

impl Rules {
    /// How long after a press its export may still arrive.
    pub(super) fn awaited(&self) -> Duration {
        self.window + self.late
    }

    /// How long to wait for the export of a capture that was opened so.
    pub(super) fn lasts(&self, by: Opener) -> Duration {
        match by {
            Opener::Press => self.window,
            Opener::Name => self.name_lasts,
        }
    }
}

/// The patient named for the next scan.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Named {
    /// The id, accepted as valid.
    pub id: String,
    pub by: SourceKind,
    /// The request of the worklist that was chosen with the patient, or found by the id. It decides nothing here.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub request: Option<ImagingRequest>,
    /// The patient's entry of the worklist was chosen: nobody typed the id. It decides nothing here.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub is_chosen: bool,
}

impl Named {
    /// A patient who was named without a request.
    pub fn new(id: impl Into<String>, by: SourceKind) -> Named {
        Named { id: id.into(), by, request: None, is_chosen: false }
    }

    /// The source that named the patient, as a record has it.
    pub fn source(&self) -> Source {
        let source = Source::from_kind(self.by).with_request(self.request.clone());
        if self.is_chosen { source.chosen() } else { source }
    }

    /// Keeps that the same patient was chosen before, with the request if there is no other since.
    pub(super) fn keep_choice_of(&mut self, before: &Named) {
        if before.id != self.id {
            return;
        }
        self.is_chosen |= before.is_chosen;
        if self.request.is_none() {
            self.request.clone_from(&before.request);
        }
    }
}

/// These patients, each once, as first named; without a request where several may be meant, and chosen only if each
/// time.
pub(super) fn distinct<'a>(all: impl IntoIterator<Item = &'a Named>) -> Vec<Named> {
    let mut found: Vec<Named> = Vec::new();
    for named in all {
        match found.iter_mut().find(|known| known.id == named.id) {
            Some(known) => {
                known.is_chosen &= named.is_chosen;
                if known.request != named.request {
                    known.request = None;
                }
            }
            None => found.push(named.clone()),
        }
    }
    found
}

/// The time in which the export of a press is expected. All times are since the machine's start.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Capture {
    /// Its number in the journal.
    pub number: i64,
    /// When the button was pressed, or the patient named.
    pub opened: Duration,
    /// The end of its window.
    pub until: Duration,
    /// What opened it.
    pub by: Opener,
    /// The patient who was named for the scan.
    pub patient: Option<Named>,
    /// Other patients whose scan it may be.
    pub others: Vec<Named>,
    /// The state of the wait for its export.
    pub state: CaptureState,
    /// The export that answered it was refused, and another is expected.
    pub is_refused: bool,
    /// Why its export could be another patient's, apart from what other captures show.
    pub doubt: Option<Doubt>,
}

impl Capture {
    /// Every patient whom it names.
    pub fn named(&self) -> impl Iterator<Item = &Named> {
        self.patient.iter().chain(&self.others)
    }

    pub(super) fn is_of(&self, id: &str) -> bool {
        let is_sure = self.doubt.is_none() && self.others.is_empty();
        is_sure && self.patient.as_ref().is_some_and(|patient| patient.id == id)
    }

    /// Whether it waits for its export, within its window.
    pub fn is_open(&self) -> bool {
        self.state == CaptureState::Open
    }

    /// Whether its export has not arrived.
    pub fn is_waiting(&self) -> bool {
        matches!(self.state, CaptureState::Open | CaptureState::Expired)
    }

    /// Whether it names exactly these patients.
    pub(super) fn is_of_all(&self, whose: &[Named]) -> bool {
        let ours: BTreeSet<&str> = self.named().map(|named| named.id.as_str()).collect();
        ours == whose.iter().map(|named| named.id.as_str()).collect()
    }

    /// The same without its request, if one of these captures names its patient with another: it is not known which of
    /// them an export answers.
    pub(super) fn with_certain_request(mut self, all: &[&Capture]) -> Capture {
        if let Some(patient) = &mut self.patient {
            let mut named = all.iter().flat_map(|capture| capture.named());
            if named.any(|other| other.id == patient.id && other.request != patient.request) {
                patient.request = None;
            }
        }
        self
    }

    pub(super) fn is_unnamed(&self) -> bool {
        self.patient.is_none() && self.others.is_empty()
    }

    /// Another patient may be meant, too.
    pub fn may_also_be(&mut self, named: &Named) {
        if self.named().all(|known| known.id != named.id) {
            self.others.push(named.clone());
        }
        self.doubt.get_or_insert(Doubt::Shared);
    }

    /// The capture after a restart of the machine, if its export may still arrive: it was opened before
    /// the restart, so the operator must decide whose an export now is. `age` is how long ago it was
    /// opened by the wall clock; `None` if that clock has gone back.
    pub fn carried_over(
        self,
        age: Option<Duration>,
        late: Duration,
        now: Duration,
    ) -> Option<Capture> {
        let lasts = self.until.saturating_sub(self.opened);
        let may_come = age.is_none_or(|age| age <= lasts + late);
        may_come.then(|| Capture {
            opened: Duration::ZERO,
            until: now + lasts,
            state: if self.is_open() { CaptureState::Expired } else { self.state },
            doubt: self.doubt.or(Some(Doubt::Unheard)),
            ..self
        })
    }

    /// Whether an export that appeared then may be its own, or where that was taken, another one of it.
    pub(super) fn may_have(&self, export: Appeared, late: Duration) -> bool {
        let began = export.absent.unwrap_or(Duration::ZERO);
        self.opened < export.seen && began.max(self.opened) <= self.until + late
    }
}

/// What is known about the content of an export before it is judged.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ExportContent {
    /// When it was written.
    pub began: Appeared,
    /// When the other contents appeared that were written beside it and are not taken
    /// ([`crate::Settling::others`]).
    pub others: Vec<Appeared>,
    /// The scan arrived before, with these bytes or this geometry, or in another format.
    pub is_known: bool,
    /// Its format shows that it was cut short.
    pub is_cut_short: bool,
    /// It begins with an earlier scan, of one of these patients or of nobody.
    pub completes: Option<Vec<Named>>,
}

gaiter_record::word_enum! {
    /// Why an export that may be a capture's is held; its word is the code of the finding.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
    #[serde(rename_all = "snake_case")]
    pub enum Why {
        /// It could belong to captures of different patients.
        Ambiguous => "capture-ambiguous",
        /// Another content lay beside it since the press.
        Beside => "capture-beside",
        /// It may have been written before the press.
        Unclear => "capture-unclear",
        /// It arrived after the window of the press it must belong to.
        Late => "export-late",
        /// The station could not receive presses for a while, and a missed one may have made this export.
        Unheard => "press-unheard",
        /// An attempt to name a patient before it could not be read.
        Unread => "name-unread",
        /// The order that names its patient repeats an earlier one, with a newer time.
        Repeated => "order-repeated",
    }
}

/// Why the export of a capture could be another patient's.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Doubt {
    /// An export that could have been its own was held, or more than one patient was named.
    Shared,
    /// An order and a press without a name crossed: each may belong to the other, or to the next one.
    Crossed,
    /// A press may have been missed.
    Unheard,
    /// An attempt to name a patient could not be read.
    Unread,
    /// An order arrived again with the same words.
    Repeated,
}

impl Doubt {
    /// Why its export is held.
    pub const fn why(self) -> Why {
        match self {
            Doubt::Shared | Doubt::Crossed => Why::Ambiguous,
            Doubt::Unheard => Why::Unheard,
            Doubt::Unread => Why::Unread,
            Doubt::Repeated => Why::Repeated,
        }
    }
}

gaiter_record::word_enum! {
    /// What opened a capture.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
    pub enum Opener as serde {
        /// The button.
        Press => "press",
        /// The patient's name, where there is no button.
        Name => "name",
    }
}

gaiter_record::word_enum! {
    /// The states of a capture that has not ended, with their words in the journal.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
    #[serde(rename_all = "snake_case")]
    pub enum CaptureState {
        /// The station waits for its export.
        Open => "open",
        /// Its window is over.
        Expired => "expired",
        /// Its export is being measured.
        Taken => "answered",
        /// An export that may be its own is held.
        Held => "held",
    }
}
