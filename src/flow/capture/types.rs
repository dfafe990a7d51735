//! What a capture is, and what rules it.

use std::collections::BTreeSet;
use std::time::Duration;

use serde::{Deserialize, Serialize};

use super::Why;
use crate::flow::orders_when::OrdersWhen;
use crate::flow::writing::Appeared;
use crate::record::SourceKind;

/// Times and habits that rule captures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rules {
    /// Captures are opened by presses; without a button, by naming the patient.
    pub by_press: bool,
    /// How long the export of a press is awaited.
    pub window: Duration,
    /// How long after its window an export may still come, and is held.
    pub late: Duration,
    /// How long a patient's name waits for its press, or without a button for its export.
    pub name_lasts: Duration,
    /// When orders come.
    pub orders: OrdersWhen,
}

impl Rules {
    /// How long after a press its export may still come.
    pub(super) fn awaited(&self) -> Duration {
        self.window + self.late
    }
}

/// The patient whom somebody named for the next scan.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Named {
    /// The id, allowed as one.
    pub id: String,
    /// Who named it.
    pub by: SourceKind,
}

/// The time in which the export of a press is awaited. All times are since the machine's start.
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
    /// Whose scan it is said to be.
    pub patient: Option<Named>,
    /// Who else it may be.
    pub others: Vec<Named>,
    /// Why its export is still to come.
    pub state: CaptureState,
    /// The export that answered it was refused, and another is awaited.
    pub is_refused: bool,
    /// Why its export could be another's, besides what other captures show.
    pub doubt: Option<Doubt>,
}

impl Capture {
    /// Everybody whom it names.
    pub fn named(&self) -> impl Iterator<Item = &Named> {
        self.patient.iter().chain(&self.others)
    }

    pub(super) fn is_of(&self, id: &str) -> bool {
        let is_sure = self.doubt.is_none() && self.others.is_empty();
        is_sure && self.patient.as_ref().is_some_and(|patient| patient.id == id)
    }

    /// Whether it names these and nobody else.
    pub(super) fn is_of_all(&self, whose: &[Named]) -> bool {
        let ours: BTreeSet<&str> = self.named().map(|named| named.id.as_str()).collect();
        ours == whose.iter().map(|named| named.id.as_str()).collect()
    }

    pub(super) fn is_unnamed(&self) -> bool {
        self.patient.is_none() && self.others.is_empty()
    }

    /// Somebody else may be meant, too.
    pub fn may_also_be(&mut self, named: &Named) {
        if self.named().all(|known| known.id != named.id) {
            self.others.push(named.clone());
        }
        self.doubt.get_or_insert(Doubt::Shared);
    }

    /// The same after the machine has started anew, where its export may still come: it was opened before
    /// that, and whose an export is now is for a person to say. `age` is what the clock on the wall says
    /// has passed since it was opened; none where that clock has gone back.
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
            state: CaptureState::Expired,
            doubt: self.doubt.or(Some(Doubt::Unheard)),
            ..self
        })
    }

    /// Whether an export that appeared then may be its own.
    pub(super) fn may_have(&self, export: Appeared, late: Duration) -> bool {
        let began = export.absent.unwrap_or(Duration::ZERO);
        self.opened < export.seen && began.max(self.opened) <= self.until + late
    }
}

/// What is known of the content of an export before it is judged.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Content {
    /// When it was written.
    pub began: Appeared,
    /// The scan came in before, with these bytes or this geometry.
    pub is_known: bool,
    /// Its format shows that it was cut short.
    pub is_cut_short: bool,
    /// It begins with a scan that came in before, of one of these patients, or of nobody.
    pub completes: Option<Vec<Named>>,
}

/// Why the export of a capture could be another patient's.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Doubt {
    /// An export that could have been its own was held, or more than one patient was named.
    Shared,
    /// An order and a press without a name crossed: either may belong to the other, or to the next.
    Crossed,
    /// A press may have gone unheard.
    Unheard,
    /// Somebody tried to name a patient, and it could not be read.
    Unread,
    /// An order came again with the same words.
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

/// What opened a capture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Opener {
    /// The button.
    Press,
    /// The patient's name, where there is no button.
    Name,
}

/// The states of a capture whose export has not come.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CaptureState {
    /// Its export is awaited.
    Open,
    /// Its window is over.
    Expired,
}
