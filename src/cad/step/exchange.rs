//! The clear text of STEP files, ISO 10303-21: numbered instances, reals, lists, strings.

use std::fmt;

/// The number of an instance; displayed as a reference, `#12`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Id(usize);

impl fmt::Display for Id {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "#{}", self.0)
    }
}

/// The instances of a file, numbered from 1 in the order in which they are added. An instance can
/// only refer to earlier ones, so no reference dangles.
#[derive(Debug, Clone, Default)]
pub struct Instances {
    text: String,
    count: usize,
}

impl Instances {
    /// Adds one instance, without number and semicolon: `VERTEX_POINT('',#1)`.
    pub fn add(&mut self, instance: &str) -> Id {
        self.count += 1;
        let id = Id(self.count);
        self.text.push_str(&format!("{id}={instance};\n"));
        id
    }

    /// The whole file: `header` is the lines between HEADER and ENDSEC.
    pub fn into_file(self, header: &str) -> Vec<u8> {
        let data = self.text;
        format!(
            "ISO-10303-21;\nHEADER;\n{header}ENDSEC;\nDATA;\n{data}ENDSEC;\nEND-ISO-10303-21;\n"
        )
        .into_bytes()
    }
}

/// A real with its mandatory decimal point, in the fewest digits that read back as `value`.
/// `value` must be finite.
pub fn real(value: f64) -> String {
    let shortest = format!("{value:?}");
    match shortest.split_once('e') {
        None => shortest,
        Some((mantissa, exponent)) if mantissa.contains('.') => format!("{mantissa}E{exponent}"),
        Some((mantissa, exponent)) => format!("{mantissa}.E{exponent}"),
    }
}

/// A list in parentheses.
pub fn list<T: ToString>(items: impl IntoIterator<Item = T>) -> String {
    let items: Vec<String> = items.into_iter().map(|item| item.to_string()).collect();
    format!("({})", items.join(","))
}

/// A list of lists, one per line, because some readers limit the length of a line.
pub fn lines(lists: impl IntoIterator<Item = String>) -> String {
    format!("({})", lists.into_iter().collect::<Vec<_>>().join(",\n"))
}

/// `.T.` or `.F.`.
pub fn logical(value: bool) -> &'static str {
    if value { ".T." } else { ".F." }
}

/// A string in quotes. Quotes and backslashes are doubled; characters other than printable ASCII
/// become a control directive, so that no text can end the string or break the line.
pub fn text(value: &str) -> String {
    let mut quoted = String::from("'");
    for character in value.chars() {
        match (character, u32::from(character)) {
            ('\'', _) => quoted.push_str("''"),
            ('\\', _) => quoted.push_str("\\\\"),
            (' '..='~', _) => quoted.push(character),
            (_, code @ ..=0xffff) => quoted.push_str(&format!("\\X2\\{code:04X}\\X0\\")),
            (_, code) => quoted.push_str(&format!("\\X4\\{code:08X}\\X0\\")),
        }
    }
    quoted.push('\'');
    quoted
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reals_have_a_point_and_read_back_as_they_were() {
        let written = [0.0, 1.0, -2.5, 1e-4, 1e-7, -1.25e-9, 1e16, 744.5].map(real);
        let expected = ["0.0", "1.0", "-2.5", "0.0001", "1.E-7", "-1.25E-9", "1.E16", "744.5"];
        assert_eq!(written, expected);
        let third = -100.0 / 3.0;
        assert_eq!(real(third).parse::<f64>(), Ok(third));
    }

    #[test]
    fn no_text_can_end_its_string() {
        assert_eq!(text("left leg"), "'left leg'");
        assert_eq!(text("');\n\\"), r"''');\X2\000A\X0\\\'");
        assert_eq!(text("Fuß 🦵"), r"'Fu\X2\00DF\X0\ \X4\0001F9B5\X0\'");
    }
}
