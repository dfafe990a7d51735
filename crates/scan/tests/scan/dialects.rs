//! The decoders against one another: a body in every format, and in every dialect of it that exporters
//! write, gives the same points and triangles, wound the same way round, or is refused by name.

use std::f64::consts::TAU;

use gaiter_scan::{Format, Scan, completeness, read};
use nalgebra::Point3;
use proptest::prelude::*;
use support::chance::Chance;

/// A closed body of polygons, wound outwards.
struct Body {
    points: Vec<[f64; 3]>,
    polygons: Vec<Vec<usize>>,
}

impl Body {
    /// A tube with lids. Its coordinates are short in decimals and exact in single precision.
    fn drawn(chance: &mut Chance) -> Body {
        let (rings, around) = (2 + chance.below(3), 3 + chance.below(6));
        let mut points = Vec::new();
        for at in 0..rings * around {
            let angle = TAU * (at % around) as f64 / around as f64;
            let place = [10.0 * angle.cos(), 10.0 * angle.sin(), 7.0 * (at / around) as f64];
            points
                .push(place.map(|value| (64.0 * (value + chance.even(1.0))).round() / 64.0 + 0.0));
        }
        let bottom = (0..around).rev().collect();
        let top = ((rings - 1) * around..rings * around).collect();
        let mut polygons = vec![bottom, top];
        for lower in 0..(rings - 1) * around {
            let next = lower - lower % around + (lower + 1) % around;
            let [a, b, c, d] = [lower, next, next + around, lower + around];
            match chance.below(2) {
                0 => polygons.push(vec![a, b, c, d]),
                _ => polygons.extend([vec![a, b, c], vec![a, c, d]]),
            }
        }
        Body { points, polygons }
    }

    fn triangles(&self) -> Vec<[usize; 3]> {
        let fan = |of: &Vec<usize>| -> Vec<[usize; 3]> {
            of[1..].windows(2).map(|pair| [of[0], pair[0], pair[1]]).collect()
        };
        self.polygons.iter().flat_map(fan).collect()
    }

    fn scan(&self) -> Scan {
        let points = self.points.iter().map(|place| Point3::from(*place)).collect();
        let triangles = self.triangles().iter().map(|t| t.map(|corner| corner as u32)).collect();
        Scan { points, triangles }
    }
}

/// The triangles by their corners' places, whatever their order, each from its first corner on.
fn sorted(scan: &Scan) -> Vec<[[u64; 3]; 3]> {
    let place = |corner: u32| {
        let point = scan.points[corner as usize];
        [point.x, point.y, point.z].map(|value| (value + 0.0).to_bits())
    };
    let from_first = |triangle: &[u32; 3]| {
        let mut corners = triangle.map(place);
        let first = (0..3).min_by_key(|at| corners[*at]).unwrap_or_default();
        corners.rotate_left(first);
        corners
    };
    let mut found: Vec<_> = scan.triangles.iter().map(from_first).collect();
    found.sort_unstable();
    found
}

/// A body in a file.
struct Written {
    format: Format,
    bytes: Vec<u8>,
    /// Whether the dialect is one whose faces are refused by name.
    is_refused: bool,
}

const WRITERS: [fn(&Body, &mut Chance) -> Written; 5] = [obj, ply, stl_text, stl_binary, vrml];

fn one_of<'a>(of: &[&'a str], chance: &mut Chance) -> &'a str {
    of[chance.below(of.len())]
}

/// Whether something happens that happens once in `count` times.
fn once_in(count: usize, chance: &mut Chance) -> bool {
    chance.below(count) == 0
}

/// The lines with line ends of one kind, or of two kinds as after an edit by hand.
fn ended(lines: &[String], chance: &mut Chance) -> String {
    const ENDS: [&[&str]; 4] = [&["\n"], &["\r\n"], &["\r"], &["\r\n", "\n"]];
    let ends = ENDS[chance.below(ENDS.len())];
    lines.iter().map(|line| format!("{line}{}", one_of(ends, chance))).collect()
}

/// A number in one of the spellings of exporters.
fn number(value: f64, chance: &mut Chance) -> String {
    match chance.below(4) {
        0 => format!("{value:e}"),
        1 => format!("{value:.6}"),
        2 if value > 0.0 => format!("+{value}"),
        _ => value.to_string(),
    }
}

/// The three coordinates of each point.
fn coordinates(body: &Body, sign: &str, chance: &mut Chance) -> Vec<Vec<String>> {
    let words = |place: &[f64; 3]| -> Vec<String> {
        place.iter().map(|value| number(*value, chance).replace('.', sign)).collect()
    };
    body.points.iter().map(words).collect()
}

fn obj(body: &Body, chance: &mut Chance) -> Written {
    const OPENINGS: [&str; 10] = [
        "# by hand",
        "bevel off",
        "con 1 0 1 1 2 0 1 2",
        "call other.obj",
        "csh true",
        "res 1 1",
        "sp 1",
        "s off",
        "o C:\\legs\\",
        "vn 0 0 1",
    ];
    const COMMENTS: [&str; 5] = ["# C:\\", "g F", "usemtl V", "vt 0 0", ""];
    let is_refused = once_in(8, chance);
    let sign = one_of(&[".", ","], chance);
    let faces_first = once_in(4, chance);
    let form = chance.below(5);
    let mut statements: [Vec<Vec<String>>; 2] = [coordinates(body, sign, chance), Vec::new()];
    for point in &mut statements[0] {
        point.insert(0, "v".to_owned());
        if once_in(3, chance) {
            point.extend(["1", "0", "1"].map(str::to_owned));
        }
    }
    for polygon in &body.polygons {
        let keyword = if is_refused { "F" } else { one_of(&["f", "f", "fo"], chance) };
        let corner = |at: &usize| match form {
            0 if !faces_first => format!("-{}", body.points.len() - at),
            1 => format!("{}/1", at + 1),
            2 => format!("{}//1", at + 1),
            3 => format!("{}/1/1", at + 1),
            _ => (at + 1).to_string(),
        };
        let corners = polygon.iter().map(corner);
        statements[1].push(std::iter::once(keyword.to_owned()).chain(corners).collect());
    }
    if faces_first {
        statements.reverse();
    }
    let mut lines = vec![one_of(&OPENINGS, chance).to_owned()];
    for words in statements.iter().flatten() {
        if once_in(6, chance) {
            lines.push(one_of(&COMMENTS, chance).to_owned());
        }
        let mut line = one_of(&["", "", " ", "\t"], chance).to_owned();
        for (at, word) in words.iter().enumerate() {
            if at > 0 {
                line += one_of(&[" ", " ", "  ", "\t", " \\\n ", "\\\r\n"], chance);
            }
            line += word;
        }
        lines.push(line);
    }
    Written { format: Format::Obj, bytes: ended(&lines, chance).into_bytes(), is_refused }
}

/// The types of whole numbers in PLY, and their bytes.
const WHOLE: [(&str, usize); 12] = [
    ("char", 1),
    ("int8", 1),
    ("uchar", 1),
    ("uint8", 1),
    ("short", 2),
    ("int16", 2),
    ("ushort", 2),
    ("uint16", 2),
    ("int", 4),
    ("int32", 4),
    ("uint", 4),
    ("uint32", 4),
];

/// Those of other numbers.
const REAL: [(&str, usize); 4] = [("float", 4), ("float32", 4), ("double", 8), ("float64", 8)];

/// Writes an element of a PLY: its lines of the header, and its records.
type Element = fn(&Body, bool, &mut Vec<String>, &mut Records, &mut Chance);

/// The records of a PLY, as text or as bytes.
struct Records {
    encoding: &'static str,
    lines: Vec<String>,
    line: String,
    bytes: Vec<u8>,
}

impl Records {
    fn put(&mut self, text: &str, little_endian: &[u8]) {
        self.line += text;
        self.line += " ";
        match self.encoding {
            "binary_big_endian" => self.bytes.extend(little_endian.iter().rev()),
            _ => self.bytes.extend(little_endian),
        }
    }

    fn whole(&mut self, value: usize, bytes: usize) {
        self.put(&value.to_string(), &(value as u32).to_le_bytes()[..bytes]);
    }

    fn real(&mut self, value: f64, text: &str, bytes: usize) {
        match bytes {
            4 => self.put(text, &(value as f32).to_le_bytes()),
            _ => self.put(text, &value.to_le_bytes()),
        }
    }

    fn end(&mut self) {
        self.lines.push(std::mem::take(&mut self.line));
    }
}

fn ply(body: &Body, chance: &mut Chance) -> Written {
    const ENCODINGS: [&str; 3] = ["ascii", "binary_little_endian", "binary_big_endian"];
    let is_refused = once_in(8, chance);
    let encoding = ENCODINGS[chance.below(ENCODINGS.len())];
    let mut records =
        Records { encoding, lines: Vec::new(), line: String::new(), bytes: Vec::new() };
    let mut header = vec![
        one_of(&["ply", "ply", "PLY", "ply ", "Ply\t "], chance).to_owned(),
        format!("format {encoding} 1.0"),
    ];
    let mut elements: Vec<Element> = vec![vertices, faces];
    if once_in(4, chance) {
        elements.reverse();
    }
    if once_in(3, chance) {
        elements.insert(chance.below(3), cameras);
    }
    for element in elements {
        if once_in(3, chance) {
            header.push(
                one_of(&["comment element face 9", "obj_info x", "", "comment"], chance).to_owned(),
            );
        }
        element(body, is_refused, &mut header, &mut records, chance);
    }
    header.push("end_header".to_owned());
    let bytes = match encoding {
        "ascii" => ended(&[header, records.lines].concat(), chance).into_bytes(),
        _ => [ended(&header, chance).into_bytes(), records.bytes].concat(),
    };
    Written { format: Format::Ply, bytes, is_refused }
}

fn vertices(
    body: &Body,
    _: bool,
    header: &mut Vec<String>,
    records: &mut Records,
    chance: &mut Chance,
) {
    let [has_flags, has_views] = [(); 2].map(|()| once_in(3, chance));
    let (kind, bytes) = REAL[chance.below(REAL.len())];
    let sign = one_of(&[".", ","], chance);
    header.push(format!("element vertex {}", body.points.len()));
    header.extend(has_flags.then(|| "property uchar flags".to_owned()));
    header.extend(["z", "x"].map(|axis| format!("property {kind} {axis}")));
    header.extend(has_views.then(|| "property list uchar int views".to_owned()));
    header.push(format!("property {kind} y"));
    for (place, words) in body.points.iter().zip(coordinates(body, sign, chance)) {
        if has_flags {
            records.whole(7, 1);
        }
        for axis in [2, 0] {
            records.real(place[axis], &words[axis], bytes);
        }
        if has_views {
            records.whole(1, 1);
            records.whole(9, 4);
        }
        records.real(place[1], &words[1], bytes);
        records.end();
    }
}

fn faces(
    body: &Body,
    is_refused: bool,
    header: &mut Vec<String>,
    records: &mut Records,
    chance: &mut Chance,
) {
    let [has_flags, has_places] = [(); 2].map(|()| once_in(3, chance));
    let (count, count_bytes) = WHOLE[chance.below(WHOLE.len())];
    let (item, item_bytes) = WHOLE[chance.below(WHOLE.len())];
    let list = one_of(&["vertex_indices", "vertex_index"], chance);
    let name = one_of(&["faces", "polygon", "Face", "triangles"], chance);
    let name = if is_refused { name } else { "face" };
    header.push(format!("element {name} {}", body.polygons.len()));
    header.extend(has_flags.then(|| "property short flags".to_owned()));
    header.push(format!("property list {count} {item} {list}"));
    header.extend(has_places.then(|| "property list uchar float texcoord".to_owned()));
    for polygon in &body.polygons {
        if has_flags {
            records.whole(3, 2);
        }
        records.whole(polygon.len(), count_bytes);
        polygon.iter().for_each(|corner| records.whole(*corner, item_bytes));
        if has_places {
            records.whole(1, 1);
            records.real(0.5, "0.5", 4);
        }
        records.end();
    }
}

/// An element that is neither, and one of which there is none.
fn cameras(_: &Body, _: bool, header: &mut Vec<String>, records: &mut Records, _: &mut Chance) {
    let lines = [
        "element camera 1",
        "property double focus",
        "property list int float lens",
        "element polygon 0",
        "property list uchar int vertex_indices",
    ];
    header.extend(lines.map(str::to_owned));
    records.real(1.5, "1.5", 8);
    records.whole(1, 4);
    records.real(2.5, "2.5", 4);
    records.end();
}

/// The end of an STL statement, in one word or two.
fn stl_end(of: &str, chance: &mut Chance) -> String {
    format!("end{}{of}", one_of(&["", " ", "\t"], chance))
}

fn stl_text(body: &Body, chance: &mut Chance) -> Written {
    let indent = one_of(&["", "  ", "\t"], chance);
    let is_capital = once_in(4, chance);
    let sign = one_of(&[".", ","], chance);
    let places = coordinates(body, sign, chance);
    let mut lines = vec![one_of(&["solid", "solid a leg"], chance).to_owned()];
    for triangle in body.triangles() {
        lines.extend(["facet normal nan nan nan", "outer loop"].map(str::to_owned));
        lines.extend(triangle.map(|corner| format!("vertex {}", places[corner].join(" "))));
        lines.push(stl_end("loop", chance));
        lines.push(stl_end("facet", chance));
    }
    lines.push(stl_end("solid", chance));
    for line in &mut lines[1..] {
        line.insert_str(0, indent);
        if is_capital {
            line.make_ascii_uppercase();
        }
    }
    let bytes = ended(&lines, chance).into_bytes();
    Written { format: Format::Stl, bytes, is_refused: false }
}

fn stl_binary(body: &Body, chance: &mut Chance) -> Written {
    let mut bytes = one_of(&["solid", "COLOR=", "", "ply", "o leg"], chance).as_bytes().to_vec();
    bytes.resize(80, *chance.pick(&[b' ', 0]).unwrap_or(&0));
    bytes.extend((body.triangles().len() as u32).to_le_bytes());
    for triangle in body.triangles() {
        bytes.extend([0; 12]);
        for value in triangle.iter().flat_map(|corner| body.points[*corner]) {
            bytes.extend((value as f32).to_le_bytes());
        }
        bytes.extend((chance.below(1 << 16) as u16).to_le_bytes());
    }
    Written { format: Format::Stl, bytes, is_refused: false }
}

/// Two sets of faces, each written clockwise or not, of the same points.
fn vrml(body: &Body, chance: &mut Chance) -> Written {
    let is_one = once_in(2, chance);
    let blank = one_of(&[" ", ", ", "\n"], chance);
    let points: Vec<String> =
        coordinates(body, ".", chance).iter().map(|place| place.join(" ")).collect();
    let points = format!("point [ {} ]", points.join(", "));
    let mut lines = match is_one {
        true => vec![
            "#VRML V1.0 ascii".to_owned(),
            format!("Separator {{ Coordinate3 {{ {points} }}"),
            "Separator { ShapeHints { vertexOrdering CLOCKWISE } }".to_owned(),
        ],
        false => vec!["#VRML V2.0 utf8".to_owned()],
    };
    let (first, second) = body.polygons.split_at(1 + chance.below(body.polygons.len() - 1));
    for (number, polygons) in [first, second].into_iter().enumerate() {
        let is_clockwise = once_in(2, chance);
        let written = |polygon: &Vec<usize>| {
            let mut corners = polygon.clone();
            if is_clockwise {
                corners[1..].reverse();
            }
            corners.iter().map(usize::to_string).collect::<Vec<_>>().join(blank)
        };
        let corners: Vec<String> = polygons.iter().map(written).collect();
        let end = one_of(&["", ", -1"], chance);
        let corners = format!("coordIndex [ {}{end} ]", corners.join(&format!("{blank}-1{blank}")));
        let ordering = match (is_one, is_clockwise) {
            (true, true) => "CLOCKWISE",
            (true, false) => one_of(&["COUNTERCLOCKWISE", "UNKNOWN_ORDERING"], chance),
            (false, true) => "ccw FALSE",
            (false, false) => one_of(&["ccw TRUE", "solid FALSE", ""], chance),
        };
        if is_one {
            lines.push(format!("ShapeHints {{ shapeType SOLID vertexOrdering {ordering} }}"));
            lines.push(format!("IndexedFaceSet {{ {corners} }}"));
            continue;
        }
        let coordinates = match number {
            0 => format!("coord DEF p Coordinate {{ {points} }}"),
            _ => "coord USE p".to_owned(),
        };
        let mut fields = [ordering.to_owned(), coordinates, corners];
        fields.rotate_left(chance.below(3));
        let fields = fields.join(" ");
        lines.push(format!("Shape {{ geometry IndexedFaceSet {{ {fields} }} }}"));
    }
    lines.extend(is_one.then(|| "}".to_owned()));
    let bytes = ended(&lines, chance).into_bytes();
    Written { format: Format::Wrl, bytes, is_refused: false }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, cases: 400, ..Default::default() })]

    #[test]
    fn a_body_in_any_dialect_is_the_same_or_refused_by_name(seed in any::<u64>()) {
        let mut chance = Chance(seed);
        let body = Body::drawn(&mut chance);
        let expected = sorted(&body.scan());
        for write in WRITERS {
            let Written { format, bytes, is_refused } = write(&body, &mut chance);
            let text = String::from_utf8_lossy(&bytes);
            prop_assert_eq!(completeness(&bytes, format), Ok(()), "{}", text);
            match read(&bytes, format) {
                Ok(found) => {
                    prop_assert!(!is_refused, "{}", text);
                    prop_assert_eq!(found.points.len(), body.points.len(), "{}", text);
                    prop_assert_eq!(sorted(&found), expected.clone(), "{}", text);
                }
                Err(fault) => {
                    let is_named = is_refused && fault.code() == "scan-malformed";
                    prop_assert!(is_named, "{}: {}", fault, text);
                }
            }
        }
    }
}
