//! Runs code that belongs to one scan, so that a panic affects only that scan.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// The result of `job`, or the message of its panic. The job changes nothing that outlives it, so
/// nothing half-changed is visible after a panic.
pub fn caught<T>(job: impl FnOnce() -> T) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(job)).map_err(|panic| said(panic.as_ref()))
}

fn said(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    let text = text.or_else(|| panic.downcast_ref::<String>().cloned());
    text.unwrap_or_else(|| "a panic that says nothing".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_ends_the_job_and_not_the_caller() {
        assert_eq!(caught(|| 1), Ok(1));
        assert_eq!(caught(|| -> u8 { panic!("index 7") }), Err("index 7".to_owned()));
        let said = caught(|| -> u8 { panic!("row {} of {}", 7, 3) });
        assert_eq!(said, Err("row 7 of 3".to_owned()));
    }
}
