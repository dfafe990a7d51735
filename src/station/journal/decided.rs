//! Which decisions of operators the journal has applied, and how it applies the others.

use gaiter_flow::decision::Ruling;
use gaiter_flow::patient::identity::SAME_SCAN_OTHER_PATIENT;
use gaiter_flow::{DeliveryState, DeliveryStep, ScanId, ScanStep};
use gaiter_record::Patient;
use serde_json::json;

use super::acts::{belongs_to, close, deliveries_in, for_whom, make_again};
use super::row::{run, value};
use super::scans::{needs_decision, set_state, state_of};
use super::{Due, Event, Journal, JournalError, history, withdrawal};

impl Journal {
    /// The number of the last decision about a scan that this journal has applied; 0 for none.
    pub fn last_decision(&self, scan: &ScanId) -> Result<usize, JournalError> {
        let last = "SELECT coalesce(max(json_extract(detail, '$.decision')), 0) FROM history
                    WHERE scan = ?1";
        let number: i64 = value(&self.connection(), last, [scan.as_str()])?;
        Ok(usize::try_from(number).unwrap_or(0))
    }

    /// Carries out decisions about a scan that this journal does not know, because of a crash between
    /// the decision and the journal or because the journal was rebuilt.
    pub fn carried_out(
        &self,
        scan: &ScanId,
        ruling: &Ruling,
        patients: &[Patient],
        stores: &[&str],
        number: usize,
    ) -> Result<(), JournalError> {
        self.change(|transaction| {
            if ruling.is_exclusive {
                belongs_to(transaction, scan, patients, stores)?;
            } else {
                for patient in patients {
                    let held = deliveries_in(transaction, scan, DeliveryState::Held)?;
                    let theirs: Vec<Due> =
                        held.into_iter().filter(|due| due.patient_cell() == patient.id).collect();
                    if !theirs.is_empty() {
                        make_again(transaction, scan, &theirs, DeliveryStep::Release)?;
                    }
                    for_whom(transaction, scan, Some(patient), stores)?;
                }
                withdrawal::apply(transaction, scan)?;
            }
            if ruling.is_given_up {
                close(transaction, scan)?;
            }
            let detail = json!({ "patients": ruling.patients, "decision": number });
            history::append(transaction, Some(scan), Event::CarriedOut, &detail)
        })
    }

    /// Records that retention deletes the bytes of a refused scan: they are not lost, and the scan needs
    /// no further decision.
    pub fn let_go_of(&self, scan: &ScanId) -> Result<(), JournalError> {
        self.change(|transaction| {
            let closed = "UPDATE scans SET closed = 'let-go' WHERE sha256 = ?1 AND closed IS NULL";
            run(transaction, closed, [scan.as_str()])?;
            history::append(transaction, Some(scan), Event::LetGo, &json!({}))
        })
    }

    /// Reports whether retention deleted the bytes of a scan and nothing has happened to it since.
    pub fn was_let_go(&self, scan: &ScanId) -> Result<bool, JournalError> {
        let last = self.history(scan)?.pop();
        Ok(last.is_some_and(|last| last.event == Event::LetGo.word()))
    }

    /// Records that the lost bytes of a refused scan came in again. Its deliveries are made if they are
    /// for one patient; otherwise they are held.
    pub fn taken_again(&self, scan: &ScanId) -> Result<(), JournalError> {
        self.change(|transaction| {
            let refused = deliveries_in(transaction, scan, DeliveryState::Refused)?;
            let mut ids: Vec<&str> = refused.iter().map(Due::patient_cell).collect();
            ids.dedup();
            if ids.len() == 1 {
                make_again(transaction, scan, &refused, DeliveryStep::Retry)?;
            } else {
                transaction.execute(
                    "UPDATE deliveries SET state = 'held', code = ?2, next_at = NULL
                     WHERE sha256 = ?1 AND state = 'refused'",
                    [scan.as_str(), SAME_SCAN_OTHER_PATIENT],
                )?;
                needs_decision(transaction, scan)?;
                let open = state_of(transaction, scan)?.after(ScanStep::Reopen)?;
                set_state(transaction, scan, open.after(ScanStep::Finish)?)?;
            }
            let detail = json!({ "patients": ids });
            history::append(transaction, Some(scan), Event::TakenAgain, &detail)
        })
    }
}
