//! What a file says about itself.

/// The program that wrote the file.
pub const SYSTEM: &str = concat!("gaiter ", env!("CARGO_PKG_VERSION"));

/// What a file says about itself. Files leave the house: nothing here may name a patient.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct FileHeader<'a> {
    /// The file's own name, such as `left.step`.
    pub file_name: &'a str,
    /// What a CAD system shows in its tree, such as `left leg`.
    pub product: &'a str,
}
