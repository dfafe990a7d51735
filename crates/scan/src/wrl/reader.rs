//! Reads the nodes of a VRML text without a grammar for each node type: a word before `{` is a
//! node, and any other word that is not a number is a field name.

use std::collections::BTreeMap;

use nalgebra::{Matrix4, Point3};

use super::super::fault::{CutSign, ScanFault, cut_short, malformed};
use super::super::text::{Decimals, excerpt, whole};
use super::Version;
use super::placement::{self, Fields};
use super::scene::{DEPTH_MAX, Node, NodeId};
use super::words::{Token, Words};

/// Maximum number of nodes in a scene, and of uses of nodes. A scan has a dozen, an assembly of
/// parts some hundreds.
const NODES_MAX: usize = 10_000;

/// Numeric fields that place or choose something.
const FIELDS: [&str; 11] = [
    "translation",
    "rotation",
    "scale",
    "scaleFactor",
    "scaleOrientation",
    "center",
    "matrix",
    "whichChild",
    "whichChoice",
    "startIndex",
    "numPoints",
];

/// Maximum number of values in such a field: those of a matrix.
const FIELD_NUMBERS_MAX: usize = 16;

/// Reads the nodes of a text. The last one contains the others.
///
/// # Errors
/// The first fault, with its line.
pub(super) fn nodes(bytes: &[u8], version: Version) -> Result<Vec<Node>, ScanFault> {
    let mut reader = Reader {
        words: Words::new(bytes),
        version,
        nodes: Vec::new(),
        links: 0,
        carries: Vec::new(),
        names: BTreeMap::new(),
    };
    let Body { children, .. } = reader.body(b"", 0)?;
    let matrix = Box::new(Matrix4::identity());
    reader.keep(Node::Group { children, matrix, is_closed: true, choice: None })?;
    Ok(reader.nodes)
}

/// The contents between the brackets of a node.
#[derive(Default)]
struct Body {
    children: Vec<NodeId>,
    fields: Vec<(&'static str, Vec<f64>)>,
    points: Vec<Point3<f64>>,
    corners: Vec<i32>,
    /// Whether the corners of its faces, or of the faces after it, run clockwise as seen from outside.
    is_clockwise: bool,
}

struct Reader<'a> {
    words: Words<'a>,
    version: Version,
    nodes: Vec<Node>,
    /// How often nodes are contained in other nodes.
    links: usize,
    /// For each node, whether it carries points or contains a node that does.
    carries: Vec<bool>,
    /// Nodes by the names that `DEF` gives them.
    names: BTreeMap<&'a [u8], NodeId>,
}

impl<'a> Reader<'a> {
    fn fault(&mut self, what: impl Into<String>) -> ScanFault {
        malformed(self.words.line(), what)
    }

    fn keep(&mut self, node: Node) -> Result<NodeId, ScanFault> {
        if self.nodes.len() == NODES_MAX {
            return Err(self.fault(format!("more than {NODES_MAX} nodes; export one mesh")));
        }
        self.nodes.push(node);
        Ok(self.nodes.len() - 1)
    }

    fn word(&mut self) -> Result<&'a [u8], ScanFault> {
        match self.words.next() {
            Some(Token::Word(word)) => Ok(word),
            Some(_) => Err(self.fault("a name should stand here")),
            None => Err(no_end()),
        }
    }

    /// Reads the contents of a node, up to its closing bracket; at depth 0, the scene itself, up to
    /// the end.
    fn body(&mut self, kind: &[u8], depth: usize) -> Result<Body, ScanFault> {
        if depth > DEPTH_MAX {
            return Err(self.fault(format!("nodes nested deeper than {DEPTH_MAX}")));
        }
        let mut body = Body::default();
        let mut field: &[u8] = b"";
        let mut open_lists = 0usize;
        loop {
            let word = match self.words.next() {
                None if depth == 0 => return Ok(body),
                None => return Err(no_end()),
                Some(Token::Close) if depth > 0 && open_lists == 0 => return Ok(body),
                Some(Token::ListOpen) => {
                    open_lists += 1;
                    continue;
                }
                Some(Token::ListClose) if open_lists > 0 => {
                    open_lists -= 1;
                    continue;
                }
                Some(Token::Quoted) => continue,
                Some(Token::Word(word)) => word,
                Some(_) => return Err(self.fault("a bracket that does not fit")),
            };
            match (word, field, kind) {
                (b"PROTO" | b"EXTERNPROTO", ..) => {
                    return Err(self.fault("PROTO is not read; export a plain VRML mesh"));
                }
                (b"ROUTE", ..) => (0..3).try_for_each(|_| self.word().map(|_| ()))?,
                (b"NULL", ..) => {}
                (b"DEF", ..) => {
                    let name = self.word()?;
                    let kind = self.word()?;
                    let child = self.node(kind, depth)?;
                    self.names.insert(name, child);
                    self.adopt(&mut body, child, field)?;
                }
                (b"USE", ..) => {
                    let name = self.word()?;
                    let Some(&child) = self.names.get(name) else {
                        let name = excerpt(name);
                        return Err(self.fault(format!("\"{name}\" is used but not defined")));
                    };
                    self.adopt(&mut body, child, field)?;
                }
                (_, b"point", b"Coordinate" | b"Coordinate3") if begins_number(word) => {
                    body.points = self.points(word)?;
                }
                (_, b"coordIndex", b"IndexedFaceSet") if begins_number(word) => {
                    body.corners = self.corners(word)?;
                }
                (b"TRUE" | b"FALSE", b"ccw", b"IndexedFaceSet") => {
                    body.is_clockwise = word == b"FALSE";
                }
                (
                    b"CLOCKWISE" | b"COUNTERCLOCKWISE" | b"UNKNOWN_ORDERING",
                    b"vertexOrdering",
                    b"ShapeHints",
                ) => body.is_clockwise = word == b"CLOCKWISE",
                _ if begins_number(word) => self.number(word, field, &mut body)?,
                _ if self.words.opens() => {
                    let child = self.node(word, depth)?;
                    self.adopt(&mut body, child, field)?;
                }
                _ => {
                    field = word;
                    body.fields.retain(|(name, _)| name.as_bytes() != word);
                }
            }
        }
    }

    fn adopt(&mut self, body: &mut Body, child: NodeId, field: &[u8]) -> Result<(), ScanFault> {
        self.links += 1;
        if self.links > NODES_MAX {
            return Err(self.fault(format!("more than {NODES_MAX} nodes; export one mesh")));
        }
        // The proxy of a Collision replaces the visible nodes in collision tests; it is not visible
        // itself.
        if field != b"proxy" {
            body.children.push(child);
        }
        Ok(())
    }

    /// A value of a field that places or chooses something; other fields are skipped.
    fn number(&mut self, word: &[u8], field: &[u8], body: &mut Body) -> Result<(), ScanFault> {
        let Some(name) = FIELDS.into_iter().find(|name| name.as_bytes() == field) else {
            return Ok(());
        };
        let value = Decimals::default().number(word, self.words.line())?;
        if body.fields.last().is_none_or(|(last, _)| *last != name) {
            body.fields.push((name, Vec::new()));
        }
        match body.fields.last_mut() {
            Some((_, numbers)) if numbers.len() < FIELD_NUMBERS_MAX => numbers.push(value),
            _ => return Err(self.fault(format!("more than {FIELD_NUMBERS_MAX} numbers"))),
        }
        Ok(())
    }

    /// The numbers of a list, given its first one, in groups of three: points.
    fn points(&mut self, first: &'a [u8]) -> Result<Vec<Point3<f64>>, ScanFault> {
        let mut found = Vec::new();
        let mut point = Point3::origin();
        let mut count = 0;
        // Whether each of the last four numbers follows a bare comma.
        let mut glued = [true; 4];
        let mut word = Some(first);
        while let Some(text) = word {
            glued = [glued[1], glued[2], glued[3], self.words.is_glued];
            if glued == [false, true, false, true] {
                let what = "two numbers joined by commas in turn: decimal commas? VRML has points";
                return Err(self.fault(what));
            }
            point[count % 3] = Decimals::default().number(text, self.words.line())?;
            count += 1;
            if count % 3 == 0 {
                found.push(point);
            }
            word = self.next_number();
        }
        if count % 3 != 0 {
            return Err(self.fault(format!("{count} numbers, which is no multiple of three")));
        }
        Ok(found)
    }

    /// The numbers of a list, given its first one: indices, with -1 between polygons.
    fn corners(&mut self, first: &'a [u8]) -> Result<Vec<i32>, ScanFault> {
        let mut found = Vec::new();
        let mut word = Some(first);
        while let Some(text) = word {
            let Some(index) = whole(text).filter(|index| *index >= -1) else {
                let text = excerpt(text);
                return Err(self.fault(format!("\"{text}\" is no index of a point")));
            };
            found.push(index);
            word = self.next_number();
        }
        Ok(found)
    }

    /// The next word, if it is a number.
    fn next_number(&mut self) -> Option<&'a [u8]> {
        let before = self.words.clone();
        match self.words.next() {
            Some(Token::Word(word)) if begins_number(word) => Some(word),
            _ => {
                self.words = before;
                None
            }
        }
    }

    /// Reads a node after the name of its type.
    fn node(&mut self, kind: &'a [u8], depth: usize) -> Result<NodeId, ScanFault> {
        if matches!(kind, b"Inline" | b"WWWInline") {
            return Err(self.fault("an Inline holds the scene in another file; export one file"));
        }
        let line = self.words.line();
        match self.words.next() {
            Some(Token::Open) => {}
            Some(_) => return Err(self.fault(format!("no \"{{\" after \"{}\"", excerpt(kind)))),
            None => return Err(no_end()),
        }
        let body = self.body(kind, depth + 1)?;
        let holds = body.children.iter().any(|&child| self.carries[child]);
        let node = self.meant(kind, body, line).map_err(|field| {
            malformed(line, format!("the field \"{field}\" of \"{}\" is wrong", excerpt(kind)))
        })?;
        let carries = match node {
            Node::Coordinates(_) | Node::Faces { .. } | Node::Points { .. } => true,
            Node::Group { .. } => holds,
            Node::Placement(_) | Node::Hints { .. } | Node::Other => false,
        };
        // The points of lines are not skin.
        if holds && !carries && kind != b"IndexedLineSet" {
            let what = format!("points within \"{}\", which gaiter does not know", excerpt(kind));
            return Err(malformed(line, what));
        }
        self.carries.push(carries);
        self.keep(node)
    }

    /// The node with these contents; otherwise the name of an invalid field.
    fn meant(&self, kind: &[u8], body: Body, line: usize) -> Result<Node, &'static str> {
        let is_two = self.version == Version::Two;
        let fields = Fields(&body.fields);
        let is_coordinates = |id: &&NodeId| matches!(self.nodes[**id], Node::Coordinates(_));
        let coordinates = body.children.iter().find(is_coordinates).copied();
        let number = |name, default: f64| fields.get(name, [default]).map(|[value]| value as i64);
        let (corners, is_clockwise) = (body.corners, body.is_clockwise);
        let children = body.children;
        let group = |is_closed: bool, choice: Option<i64>| -> Result<Node, &'static str> {
            let matrix = Box::new(placement::matrix(&fields)?);
            Ok(Node::Group { children, matrix, is_closed, choice })
        };
        match kind {
            b"IndexedFaceSet" => Ok(Node::Faces { coordinates, corners, is_clockwise, line }),
            b"PointSet" => Ok(Node::Points {
                coordinates,
                start: number("startIndex", 0.0)?,
                count: number("numPoints", -1.0)?,
                line,
            }),
            b"ShapeHints" if !is_two => Ok(Node::Hints { is_clockwise }),
            b"Coordinate" if is_two => Ok(Node::Coordinates(body.points)),
            b"Coordinate3" if !is_two => Ok(Node::Coordinates(body.points)),
            b"Group" | b"Anchor" | b"Billboard" | b"Collision" | b"Shape" | b"Transform"
                if is_two =>
            {
                group(true, None)
            }
            b"Separator" | b"TransformSeparator" | b"WWWAnchor" if !is_two => group(true, None),
            b"Group" => group(false, None),
            b"Switch" => {
                let chosen = number("whichChoice", number("whichChild", -1.0)? as f64)?;
                group(is_two, (chosen != ALL_CHILDREN).then_some(chosen))
            }
            b"LOD" => group(true, Some(0)),
            b"Transform" | b"Translation" | b"Rotation" | b"Scale" | b"MatrixTransform" => {
                Ok(Node::Placement(Box::new(placement::matrix(&fields)?)))
            }
            _ => Ok(Node::Other),
        }
    }
}

/// The choice of a VRML 1 `Switch` that selects all its children.
const ALL_CHILDREN: i64 = -3;

/// Whether a word begins like a number, or is a substitute that exporters write for a missing one.
fn begins_number(word: &[u8]) -> bool {
    let none: [&[u8]; 3] = [b"nan", b"inf", b"infinity"];
    none.iter().any(|none| word.eq_ignore_ascii_case(none))
        || word.first().is_some_and(|b| b.is_ascii_digit() || matches!(b, b'+' | b'-' | b'.'))
}

pub(super) fn no_end() -> ScanFault {
    cut_short(CutSign::NoEnd { mark: "the last \"}\"" })
}
