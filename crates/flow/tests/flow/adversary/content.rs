//! What lies in export files: bodies as bytes. A body is of one patient, which only the model knows;
//! the decisions see bytes, as the station does.

use std::rc::Rc;
use std::time::Duration;

use gaiter_flow::Fingerprint;
use gaiter_flow::export::writing::END_BYTES;

/// The comment at the head of an export, bytes: the same length whatever it says.
const HEADER_BYTES: usize = 48;

/// An export as it is when it is whole.
#[derive(Debug)]
pub struct Whole {
    /// Tells its bytes from all others.
    id: u64,
    /// Whose body it is, by its place in the model's list.
    pub body: usize,
    /// Its format shows where it was cut off.
    pub tells_its_end: bool,
    bytes: Vec<u8>,
}

/// The id of a content, as a hash is: equal for equal bytes.
pub type Scan = (u64, usize);

/// The beginning of an export, or all of it.
#[derive(Debug, Clone)]
pub struct Content {
    /// What it is the beginning of.
    pub whole: Rc<Whole>,
    length: usize,
}

impl Whole {
    /// The export of a body with a comment, `length` bytes.
    pub fn new(body: usize, comment: u64, length: usize, tells_its_end: bool) -> Rc<Whole> {
        let mut bytes = format!("# exported {comment:036}\n").into_bytes();
        bytes.resize(HEADER_BYTES, b'#');
        // A linear congruential generator: two bodies differ within their first points.
        let mut draw = (body as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        while bytes.len() < length {
            draw = draw.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            bytes.extend(draw.to_le_bytes());
        }
        bytes.truncate(length);
        let id = ((body as u64) << 16) + comment;
        Rc::new(Whole { id, body, tells_its_end, bytes })
    }

    /// All of it, bytes.
    pub fn length(&self) -> usize {
        self.bytes.len()
    }
}

impl Content {
    /// The first `length` bytes of an export.
    pub fn new(whole: &Rc<Whole>, length: usize) -> Content {
        Content { whole: Rc::clone(whole), length: length.min(whole.length()) }
    }

    pub fn length(&self) -> usize {
        self.length
    }

    pub fn bytes(&self) -> &[u8] {
        &self.whole.bytes[..self.length]
    }

    pub fn is_whole(&self) -> bool {
        self.length == self.whole.length()
    }

    /// Whether its format shows that more is to come.
    pub fn awaits_rest(&self) -> bool {
        !self.is_whole() && self.whole.tells_its_end
    }

    pub fn scan(&self) -> Scan {
        (self.whole.id, self.length)
    }

    /// What its coordinates are known by, whatever its comment says; '' where it has none.
    pub fn geometry(&self) -> String {
        match self.length > HEADER_BYTES {
            true => format!("{}:{}", self.whole.body, self.length - HEADER_BYTES),
            false => String::new(),
        }
    }

    /// What a look reads of it: the ends of the part that was there when it was listed.
    pub fn mark(&self, began: Duration, ended: Duration, listed: u64) -> Option<Fingerprint> {
        let part = self.bytes().get(..usize::try_from(listed).ok()?)?;
        let end = part.len().min(END_BYTES);
        Some(Fingerprint::new(began, ended, listed, &part[..end], &part[part.len() - end..]))
    }
}
