//! The clear text of STEP files, ISO 10303-21: numbered instances, reals, lists, strings.

use std::fmt;

use crate::header;

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

    /// Adds an instance of a kind that has only a list of numbers, such as a point.
    pub fn add_numbers(&mut self, kind: &str, numbers: &[f64]) -> Id {
        self.add(&format!("{kind}('',{})", list(numbers.iter().copied().map(real))))
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

/// A real in the notation of STEP. `value` must be finite.
pub fn real(value: f64) -> String {
    header::real(value, 'E')
}

/// A list in parentheses.
pub fn list(items: impl IntoIterator<Item = impl ToString>) -> String {
    let items: Vec<String> = items.into_iter().map(|item| item.to_string()).collect();
    format!("({})", items.join(","))
}

/// A list of lists, one per line, because some readers limit the length of a line.
pub fn lines(lists: impl IntoIterator<Item = String>) -> String {
    let lists: Vec<String> = lists.into_iter().collect();
    format!("({})", lists.join(",\n"))
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
    fn lists_have_commas_between_their_items_and_one_line_each() {
        assert_eq!(list(Vec::<usize>::new()), "()");
        assert_eq!(list([Id(1), Id(23)]), "(#1,#23)");
        assert_eq!(
            lines([[1.0, 0.5], [1e-9, 2.0]].map(|row| list(row.map(real)))),
            "((1.0,0.5),\n(1.E-9,2.0))"
        );
        let mut file = Instances::default();
        assert_eq!(file.add("A()"), Id(1));
        file.add_numbers("DIRECTION", &[1.0, 0.0, -0.5]);
        assert_eq!(file.text, "#1=A();\n#2=DIRECTION('',(1.0,0.0,-0.5));\n");
    }

    #[test]
    fn no_text_can_end_its_string() {
        assert_eq!(text("left leg"), "'left leg'");
        assert_eq!(text("');\n\\"), r"''');\X2\000A\X0\\\'");
        assert_eq!(text("Fuß 🦵"), r"'Fu\X2\00DF\X0\ \X4\0001F9B5\X0\'");
    }
}
