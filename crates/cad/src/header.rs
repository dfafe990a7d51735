//! What the files of all formats have in common: the header, with name, product and writer, and the notation of reals.

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

/// A real with its mandatory decimal point, in the fewest digits that read back as it was, and with this letter before
/// an exponent. It must be finite.
pub(crate) fn real(value: f64, exponent_letter: char) -> String {
    let shortest = format!("{value:?}");
    match shortest.split_once('e') {
        None => shortest,
        Some((mantissa, exponent)) => {
            let point = if mantissa.contains('.') { "" } else { "." };
            format!("{mantissa}{point}{exponent_letter}{exponent}")
        }
    }
}
