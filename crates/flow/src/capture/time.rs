//! How captures and names end by time.

use std::time::Duration;

use super::super::settle::Sights;
use super::{Appeared, Capture, CaptureState, Captures, Passed};

impl Captures {
    /// Time has passed, and these are the sights of all export folders. A capture whose export may be
    /// among the files that have not settled does not expire. A capture whose export may be in a folder
    /// that was not looked at since then expires, but is not over.
    pub fn pass(&mut self, now: Duration, sights: &[Sights]) -> Passed {
        let mut passed = Passed { name_expired: self.drop_old_names(now), ..Passed::default() };
        for capture in self.waiting.iter_mut().filter(|c| c.state == CaptureState::Open) {
            let is_in_time =
                |file: &Appeared| capture.opened < file.seen && file.seen <= capture.until;
            let mut coming = sights.iter().flat_map(|folder| &folder.coming);
            if now > capture.until && !coming.any(is_in_time) {
                capture.state = CaptureState::Expired;
                // A refused one raises no alarm: the refusal was already reported.
                passed.expired.extend((!capture.is_refused).then_some(capture.number));
            }
        }
        self.measuring.retain(|measuring| now <= measuring.until);
        let late = self.rules.late;
        let over = |capture: &mut Capture| {
            let end = capture.until + late;
            let was_looked_at = |folder: &Sights| folder.looked.is_some_and(|looked| looked > end);
            let is_past = capture.state != CaptureState::Open && now > end;
            let mut files = sights.iter().flat_map(|at| at.coming.iter().chain(&at.beside));
            let may_come = |file: &Appeared| capture.may_have(*file, late);
            is_past && sights.iter().all(was_looked_at) && !files.any(may_come)
        };
        passed.over = self.waiting.extract_if(.., over).map(|capture| capture.number).collect();
        passed
    }
}
