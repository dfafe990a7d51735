//! The fixed format of IGES files: lines of 80 columns in five sections (IGES 5.3, chapter 2).

use crate::header;

/// Columns for parameters in a line; the rest points back to the entity.
const PARAMETER_COLUMNS: usize = 64;

/// Columns for text in a line of the start and global sections.
const TEXT_COLUMNS: usize = 72;

/// Columns for the number of a line, behind the letter of its section.
const NUMBER_COLUMNS: usize = 7;

/// The number of an entity's first line in the directory; always odd.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pointer(usize);

impl Pointer {
    /// As a parameter.
    pub fn parameter(self) -> String {
        self.0.to_string()
    }
}

/// An entity type as the directory describes it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Entity {
    number: u32,
    form: u32,
    /// Four pairs of digits: visibility; dependence on another entity (01: physically dependent); use
    /// (05: a curve in a surface's parameters); hierarchy (which entity sets its display attributes).
    status: &'static str,
    /// Up to 8 characters.
    label: &'static str,
}

impl Entity {
    /// 128, rational B-spline surface, independent.
    pub const SURFACE: Entity = Entity::new(128, 0, "00000000", "TUBE");
    /// 128, as part of a face.
    pub const SURFACE_OF_FACE: Entity = Entity::new(128, 0, "00010000", "TUBE");
    /// 126, rational B-spline curve.
    pub const CURVE: Entity = Entity::new(126, 0, "00010000", "EDGE");
    /// 110, line, between two parameter pairs of a surface.
    pub const SIDE: Entity = Entity::new(110, 0, "00010500", "SIDE");
    /// 116, point.
    pub const POINT: Entity = Entity::new(116, 0, "00010000", "PLACE");
    /// 123, direction.
    pub const DIRECTION: Entity = Entity::new(123, 0, "00010200", "WAY");
    /// 190, plane surface, with a reference direction.
    pub const PLANE: Entity = Entity::new(190, 1, "00010000", "PLANE");
    /// 502, list of vertices.
    pub const VERTICES: Entity = Entity::new(502, 1, "00010001", "VERTICES");
    /// 504, list of edges.
    pub const EDGES: Entity = Entity::new(504, 1, "00010001", "EDGES");
    /// 508, loop of a face.
    pub const LOOP: Entity = Entity::new(508, 1, "00010000", "LOOP");
    /// 510, face.
    pub const FACE: Entity = Entity::new(510, 1, "00010000", "FACE");
    /// 514, closed shell.
    pub const SHELL: Entity = Entity::new(514, 1, "00010000", "SHELL");
    /// 186, manifold solid B-rep.
    pub const SOLID: Entity = Entity::new(186, 0, "00000000", "SOLID");

    const fn new(number: u32, form: u32, status: &'static str, label: &'static str) -> Entity {
        Entity { number, form, status, label }
    }
}

/// The entities of a file. An entity can only point to earlier ones, so no pointer dangles.
#[derive(Debug, Clone, Default)]
pub struct Entities {
    /// Lines without section letter and line number.
    directory: Vec<String>,
    parameters: Vec<String>,
}

impl Entities {
    /// Adds an entity with its parameters; its own number is not among them.
    pub fn add(&mut self, entity: &Entity, parameters: Vec<String>) -> Pointer {
        let pointer = Pointer(self.directory.len() + 1);
        let all = std::iter::once(entity.number.to_string()).chain(parameters);
        let lines = wrapped(all, PARAMETER_COLUMNS);
        let Entity { number, form, status, label } = entity;
        let (first, count) = (self.parameters.len() + 1, lines.len());
        // No structure, line font, level, view, matrix or label display; no weight, no colour.
        self.directory.extend([
            format!("{number:8}{first:8}{0:8}{0:8}{0:8}{0:8}{0:8}{0:8}{status:8}", 0),
            format!("{number:8}{0:8}{0:8}{count:8}{form:8}{0:8}{0:8}{label:>8}{1:8}", "", 0),
        ]);
        let back = pointer.0;
        let padded = |line: String| format!("{line:PARAMETER_COLUMNS$} {back:7}");
        self.parameters.extend(lines.into_iter().map(padded));
        pointer
    }

    /// The whole file: `start` is for human readers, `global` holds the parameters of the global
    /// section.
    pub fn into_file(self, start: &str, global: &[String]) -> Vec<u8> {
        let start = vec![plain(start).chars().take(TEXT_COLUMNS).collect()];
        let global = wrapped(global.iter().cloned(), TEXT_COLUMNS);
        let counts = [start.len(), global.len(), self.directory.len(), self.parameters.len()];
        let [s, g, d, p] = counts;
        let end = vec![format!("S{s:7}G{g:7}D{d:7}P{p:7}")];
        let sections = [start, global, self.directory, self.parameters, end];
        let mut text = String::new();
        for (letter, lines) in "SGDPT".chars().zip(sections) {
            for (number, line) in (1..).zip(lines) {
                text.push_str(&format!("{line:TEXT_COLUMNS$}{letter}{number:NUMBER_COLUMNS$}\n"));
            }
        }
        text.into_bytes()
    }
}

/// Parameters, separated by commas and ended by a semicolon, in lines that end between parameters.
/// Only a text may be longer than a line; it continues on the next one.
fn wrapped(parameters: impl Iterator<Item = String>, columns: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    let mut parameters = parameters.peekable();
    while let Some(mut parameter) = parameters.next() {
        parameter.push(if parameters.peek().is_some() { ',' } else { ';' });
        let last = lines.len() - 1;
        if parameter.len() <= columns - lines[last].len() {
            lines[last].push_str(&parameter);
            continue;
        }
        if parameter.len() <= columns {
            lines.push(parameter);
            continue;
        }
        for character in parameter.chars() {
            if lines[lines.len() - 1].len() == columns {
                lines.push(String::new());
            }
            let last = lines.len() - 1;
            lines[last].push(character);
        }
    }
    lines
}

/// A real in the notation of IGES: the exponent letter D means double precision. `value` must be finite.
pub fn real(value: f64) -> String {
    header::real(value, 'D')
}

/// A text with its length before it: `8Hleft leg`. IGES is ASCII: other characters are written as `?`.
pub fn hollerith(text: &str) -> String {
    let text = plain(text);
    if text.is_empty() { text } else { format!("{}H{text}", text.len()) }
}

fn plain(text: &str) -> String {
    text.chars().map(|c| if matches!(c, ' '..='~') { c } else { '?' }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reals_have_a_point_and_read_back_as_they_were() {
        let written = [0.0, 1.0, -2.5, 1e-4, 1e-7, -1.25e-9, 1e16].map(real);
        assert_eq!(written, ["0.0", "1.0", "-2.5", "0.0001", "1.D-7", "-1.25D-9", "1.D16"]);
        let third = -100.0 / 3.0;
        assert_eq!(real(third).parse::<f64>(), Ok(third));
    }

    #[test]
    fn no_text_can_end_its_parameter() {
        assert_eq!(hollerith("left leg"), "8Hleft leg");
        assert_eq!(hollerith("a,b;\n"), "5Ha,b;?");
        assert_eq!(hollerith("Fuß"), "3HFu?");
        assert_eq!(hollerith(""), "", "a text that is not said is left out");
    }

    #[test]
    fn lines_end_between_parameters_and_only_a_long_text_goes_on() {
        let words = ["12345", "678", "9", "abcdefghijkl", "m"].map(str::to_owned);
        let lines = wrapped(words.into_iter(), 10);
        assert_eq!(lines, ["12345,678,", "9,abcdefgh", "ijkl,m;"]);
    }
}
