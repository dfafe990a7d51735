//! [`Scan`] → [`Extraction`]: the paper's method (Wang, Wu, Li 2022), a stage per file.

#![deny(clippy::disallowed_methods, clippy::disallowed_types)]

pub mod axis;
pub mod body;
mod cluster;
mod hull;
pub mod method;
pub mod polynomial;
pub mod section;
pub mod segment;
mod shell;
pub mod slice;
pub mod stance;

use crate::scan::{Format, ScanFault};
pub use method::Method;

/// What one scan gave: the legs that could be measured and what must be known about them.
#[derive(Debug, Clone)]
pub struct Extraction {}

/// Why a whole scan cannot be measured.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// The bytes are no scan.
    #[error(transparent)]
    Scan(#[from] ScanFault),
}

impl Refusal {
    /// The stable code of this refusal, for `reason.json` and programs.
    pub fn code(&self) -> &'static str {
        match self {
            Refusal::Scan(fault) => fault.code(),
        }
    }
}

/// Measures both legs in the bytes of one export.
///
/// # Errors
/// A [`Refusal`] where nothing at all can be measured; a leg or level that cannot be measured is a
/// finding in the extraction, not an error.
pub fn extract(bytes: &[u8], format: Format, method: &Method) -> Result<Extraction, Refusal> {
    let _ = method;
    crate::scan::read(bytes, format)?;
    Ok(Extraction {})
}
