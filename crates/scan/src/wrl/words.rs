//! The words and brackets of a VRML text. Commas are white space; `#` begins a comment.

/// The tokens of a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Token<'a> {
    /// `{`
    Open,
    /// `}`
    Close,
    /// `[`
    ListOpen,
    /// `]`
    ListClose,
    /// A text in quotes.
    Quoted,
    /// A name, a keyword or a number.
    Word(&'a [u8]),
}

/// Reads tokens one after the other.
#[derive(Debug, Clone)]
pub(super) struct Words<'a> {
    bytes: &'a [u8],
    at: usize,
    /// Whether there is only a comma between the last token and the one before it.
    pub is_glued: bool,
    /// The offset up to which lines have been counted; `line` is the line there.
    counted: usize,
    line: usize,
}

impl<'a> Words<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Words<'a> {
        Words { bytes, at: 0, is_glued: false, counted: 0, line: 1 }
    }

    /// The current 1-based line.
    pub(super) fn line(&mut self) -> usize {
        let passed = &self.bytes[self.counted..self.at];
        let after = &self.bytes[self.counted + usize::from(!passed.is_empty())..];
        // A CR LF counts once, at its LF.
        let ends = passed
            .iter()
            .zip(after.iter().chain([&0]))
            .filter(|(byte, next)| **byte == b'\n' || (**byte == b'\r' && **next != b'\n'));
        self.line += ends.count();
        self.counted = self.at;
        self.line
    }

    /// The next token; `None` at the end of the text.
    pub(super) fn next(&mut self) -> Option<Token<'a>> {
        self.pass_white_space();
        let start = self.at;
        let token = match self.bytes.get(start)? {
            b'{' => Token::Open,
            b'}' => Token::Close,
            b'[' => Token::ListOpen,
            b']' => Token::ListClose,
            b'"' => {
                self.pass_quoted();
                return Some(Token::Quoted);
            }
            _ => {
                let rest = &self.bytes[start..];
                let length = rest.iter().position(|&b| ends_word(b)).unwrap_or(rest.len());
                self.at += length;
                return Some(Token::Word(&rest[..length]));
            }
        };
        self.at += 1;
        Some(token)
    }

    /// Whether the next token opens a node.
    pub(super) fn opens(&self) -> bool {
        self.clone().next() == Some(Token::Open)
    }

    fn pass_white_space(&mut self) {
        let start = self.at;
        while let Some(&byte) = self.bytes.get(self.at) {
            if byte == b'#' {
                let rest = &self.bytes[self.at..];
                let length = rest.iter().position(|&b| b == b'\n' || b == b'\r');
                self.at += length.unwrap_or(rest.len());
            } else if byte == b',' || is_white(byte) {
                self.at += 1;
            } else {
                break;
            }
        }
        self.is_glued = &self.bytes[start..self.at] == b",";
    }

    /// Skips a text in quotes; an unclosed one reaches to the end.
    fn pass_quoted(&mut self) {
        self.at += 1;
        while let Some(&byte) = self.bytes.get(self.at) {
            self.at += if byte == b'\\' { 2 } else { 1 };
            if byte == b'"' {
                return;
            }
        }
        self.at = self.bytes.len();
    }
}

fn is_white(byte: u8) -> bool {
    byte.is_ascii_whitespace() || byte == 0x0b || byte == 0x1a
}

fn ends_word(byte: u8) -> bool {
    is_white(byte) || matches!(byte, b',' | b'{' | b'}' | b'[' | b']' | b'"' | b'#')
}

/// Whether every `{` and `[` is closed, and the text ends after a node, or after a complete line
/// that follows one.
pub(super) fn is_closed(bytes: &[u8]) -> bool {
    let mut words = Words::new(bytes);
    let (mut depth, mut closed_any, mut last) = (0usize, false, None);
    while let Some(token) = words.next() {
        match token {
            Token::Open | Token::ListOpen => depth += 1,
            // Surplus closing brackets are a different fault, which the reader reports.
            Token::Close | Token::ListClose => depth = depth.saturating_sub(1),
            _ => {}
        }
        closed_any |= token == Token::Close;
        last = Some(token);
    }
    let ends_a_line = bytes.ends_with(b"\n") || bytes.ends_with(b"\r");
    depth == 0 && closed_any && (last == Some(Token::Close) || ends_a_line)
}
