//! Faults of a file that people write have a place in it.

use gaiter_sizes::DocumentFault;
use proptest::prelude::*;

/// Every fault has a place in the text, and nothing of the text leaves its line.
pub fn placed(text: &str, faults: &[DocumentFault]) -> Result<(), TestCaseError> {
    prop_assert!(!faults.is_empty());
    let lines = text.matches('\n').count() + 1;
    for fault in faults {
        prop_assert!((1..=lines).contains(&fault.line) && fault.column >= 1, "{fault}");
        let said = fault.to_string();
        prop_assert!(!said.contains(['\u{1b}', '\n', '\u{202e}']), "{said:?}");
    }
    Ok(())
}
