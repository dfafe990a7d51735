//! The header of a file: its name, product and writer.

/// The program that wrote the file.
pub(crate) const SYSTEM: &str = concat!("gaiter ", env!("CARGO_PKG_VERSION"));

/// The header of a file. Files leave the house, so nothing here may name a patient.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct FileHeader<'a> {
    /// The file name, such as `left.step`.
    pub file_name: &'a str,
    /// What a CAD system shows in its tree, such as `left leg`.
    pub product: &'a str,
}
