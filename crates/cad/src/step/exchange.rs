//! The clear text of STEP files, ISO 10303-21: numbered instances, reals, lists, strings.

use std::fmt::{self, Write};

/// The number of an instance; displayed as a reference, `#12`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Id(usize);

impl fmt::Display for Id {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "#{}", self.0)
    }
}

/// What can be in a list. It is appended to the text, because a file has tens of thousands of them and a
/// text of its own for each takes longer than its digits.
pub trait Item {
    /// Appends its notation.
    fn push(self, text: &mut String);
}

impl Item for Id {
    fn push(self, text: &mut String) {
        // Writing to memory never fails, here and below.
        let _ = write!(text, "{self}");
    }
}

impl Item for usize {
    fn push(self, text: &mut String) {
        let _ = write!(text, "{self}");
    }
}

/// A real with its mandatory decimal point, in the fewest digits that read back as it was. It must be
/// finite.
impl Item for f64 {
    fn push(self, text: &mut String) {
        let from = text.len();
        let _ = write!(text, "{self:?}");
        if let Some(exponent) = text[from..].find('e') {
            let point = if text[from..].contains('.') { "" } else { "." };
            text.replace_range(from + exponent..=from + exponent, &format!("{point}E"));
        }
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
        self.add_with(|text| text.push_str(instance))
    }

    /// Adds an instance of a kind that has only a list of numbers, such as a point.
    pub fn add_numbers(&mut self, kind: &str, numbers: &[f64]) -> Id {
        self.add_with(|text| {
            text.push_str(kind);
            text.push_str("('',");
            push_list(text, numbers.iter().copied());
            text.push(')');
        })
    }

    fn add_with(&mut self, push: impl FnOnce(&mut String)) -> Id {
        self.count += 1;
        let id = Id(self.count);
        id.push(&mut self.text);
        self.text.push('=');
        push(&mut self.text);
        self.text.push_str(";\n");
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

/// A list in parentheses.
pub fn list<T: Item>(items: impl IntoIterator<Item = T>) -> String {
    let mut text = String::new();
    push_list(&mut text, items);
    text
}

fn push_list<T: Item>(text: &mut String, items: impl IntoIterator<Item = T>) {
    text.push('(');
    for (index, item) in items.into_iter().enumerate() {
        if index > 0 {
            text.push(',');
        }
        item.push(text);
    }
    text.push(')');
}

/// A list of lists, one per line, because some readers limit the length of a line.
pub fn lines<T: Item, L: IntoIterator<Item = T>>(lists: impl IntoIterator<Item = L>) -> String {
    let mut text = String::from("(");
    for (index, list) in lists.into_iter().enumerate() {
        if index > 0 {
            text.push_str(",\n");
        }
        push_list(&mut text, list);
    }
    text.push(')');
    text
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

    fn real(value: f64) -> String {
        let mut text = String::new();
        value.push(&mut text);
        text
    }

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
        assert_eq!(list::<usize>([]), "()");
        assert_eq!(list([Id(1), Id(23)]), "(#1,#23)");
        assert_eq!(lines([[1.0, 0.5], [1e-9, 2.0]]), "((1.0,0.5),\n(1.E-9,2.0))");
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
