//! Contents that were seen and are gone before they were taken: the booth is told before anything else is
//! taken, then the operator.

use std::sync::Arc;

use gaiter_flow::Appeared;
use gaiter_flow::settle::Gone;
use tokio::task::{JoinError, spawn_blocking};

use super::Intake;

impl Intake {
    /// Tells of contents that are gone, but for those that the journal knows.
    pub(super) async fn lose(&mut self, gone: Vec<Gone>) -> Result<(), JoinError> {
        if gone.is_empty() {
            return Ok(());
        }
        let booth = Arc::clone(&self.booth);
        let lost = spawn_blocking(move || {
            let journal = booth.core().custody.journal();
            let is_known = |of: &Gone| journal.was_sighted(&of.path, of.stamp).unwrap_or(false);
            let lost: Vec<Gone> = gone.into_iter().filter(|content| !is_known(content)).collect();
            let appeared: Vec<Appeared> = lost.iter().map(|content| content.appeared).collect();
            booth.gone(&appeared);
            lost
        });
        self.notes.gone(lost.await?);
        Ok(())
    }
}
