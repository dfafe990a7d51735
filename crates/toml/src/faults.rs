//! The faults of one text, as they are found.

use std::cell::RefCell;
use std::ops::Range;

use crate::fault::{Fault, Hint, What};
use crate::place::{Finding, fault};

/// The faults of one text, as they are found. All sections of the text note theirs here.
pub struct Faults<'t, W> {
    pub(crate) text: &'t str,
    pub(crate) found: RefCell<Vec<Finding<W>>>,
}

impl<'t, W: Hint> Faults<'t, W> {
    /// No faults so far.
    pub fn new(text: &'t str) -> Self {
        Faults { text, found: RefCell::default() }
    }

    /// Notes a fault at these bytes, once.
    pub fn note(&self, at: &Range<usize>, key: impl Into<String>, what: impl Into<W>) {
        let finding = Finding { at: at.clone(), key: key.into(), what: what.into() };
        let mut found = self.found.borrow_mut();
        if !found.contains(&finding) {
            found.push(finding);
        }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.found.borrow().is_empty()
    }

    /// All faults in the order of the text.
    pub fn in_order(self) -> Vec<Fault<W>> {
        let Faults { text, found } = self;
        let mut found = found.into_inner();
        found.sort_by_key(|finding| finding.at.start);
        found.into_iter().map(|finding| fault(text, finding)).collect()
    }
}

/// The text of a file.
///
/// # Errors
/// The first byte that is not UTF-8.
pub fn utf8<W: Hint>(bytes: &[u8]) -> Result<&str, Fault<W>> {
    str::from_utf8(bytes).map_err(|error| {
        // Nothing before the first wrong byte changes, so its place is the same in the repaired text.
        let mended = String::from_utf8_lossy(bytes);
        let wrong = error.valid_up_to();
        let at = wrong..wrong + '\u{fffd}'.len_utf8();
        fault(&mended, Finding { at, key: String::new(), what: What::NotUtf8.into() })
    })
}
