//! Scans written in every format that gaiter reads, every digit kept.

// Each test crate uses its own part.
#![allow(clippy::unwrap_used)]

use std::fmt::Write;

use gaiter_scan::{Format, Scan};

/// How a scan is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Writer {
    Obj,
    PlyText,
    PlyLittle,
    PlyBig,
    StlText,
    StlBinary,
    Vrml1,
    Vrml2,
    Xyz,
}

/// All writers of meshes; XYZ has points only.
pub const MESHES: [Writer; 8] = [
    Writer::Obj,
    Writer::PlyText,
    Writer::PlyLittle,
    Writer::PlyBig,
    Writer::StlText,
    Writer::StlBinary,
    Writer::Vrml1,
    Writer::Vrml2,
];

impl Writer {
    pub fn format(self) -> Format {
        match self {
            Writer::Obj => Format::Obj,
            Writer::PlyText | Writer::PlyLittle | Writer::PlyBig => Format::Ply,
            Writer::StlText | Writer::StlBinary => Format::Stl,
            Writer::Vrml1 | Writer::Vrml2 => Format::Wrl,
            Writer::Xyz => Format::Xyz,
        }
    }

    pub fn write(self, scan: &Scan) -> Vec<u8> {
        match self {
            Writer::Obj => obj(scan),
            Writer::PlyText => ply_text(scan).into_bytes(),
            Writer::PlyLittle => ply_binary(scan, false),
            Writer::PlyBig => ply_binary(scan, true),
            Writer::StlText => stl_text(scan).into_bytes(),
            Writer::StlBinary => stl_binary(scan),
            Writer::Vrml1 => vrml(scan, true).into_bytes(),
            Writer::Vrml2 => vrml(scan, false).into_bytes(),
            Writer::Xyz => lines(scan, "", " ", "\n").into_bytes(),
        }
    }
}

/// The points, a line each.
fn lines(scan: &Scan, before: &str, between: &str, after: &str) -> String {
    let mut text = String::new();
    for p in &scan.points {
        write!(text, "{before}{}{between}{}{between}{}{after}", p.x, p.y, p.z).unwrap();
    }
    text
}

/// A scan as Wavefront OBJ.
pub fn obj(scan: &Scan) -> Vec<u8> {
    let mut text = lines(scan, "v ", " ", "\n");
    for [a, b, c] in &scan.triangles {
        writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1).unwrap();
    }
    text.into_bytes()
}

/// A scan as binary PLY, which is written and read in less time than OBJ: for tests of what is measured on it.
pub fn ply(scan: &Scan) -> Vec<u8> {
    Writer::PlyLittle.write(scan)
}

fn ply_header(scan: &Scan, encoding: &str) -> String {
    let mut text = format!("ply\nformat {encoding} 1.0\nelement vertex {}\n", scan.points.len());
    text += "property double x\nproperty double y\nproperty double z\n";
    if !scan.triangles.is_empty() {
        writeln!(text, "element face {}", scan.triangles.len()).unwrap();
        text += "property list uchar int vertex_indices\n";
    }
    text + "end_header\n"
}

fn ply_text(scan: &Scan) -> String {
    let mut text = ply_header(scan, "ascii") + &lines(scan, "", " ", "\n");
    for [a, b, c] in &scan.triangles {
        writeln!(text, "3 {a} {b} {c}").unwrap();
    }
    text
}

fn ply_binary(scan: &Scan, is_big: bool) -> Vec<u8> {
    let encoding = if is_big { "binary_big_endian" } else { "binary_little_endian" };
    let mut bytes = ply_header(scan, encoding).into_bytes();
    for value in scan.points.iter().flat_map(|p| [p.x, p.y, p.z]) {
        bytes.extend(if is_big { value.to_be_bytes() } else { value.to_le_bytes() });
    }
    for triangle in &scan.triangles {
        bytes.push(3);
        for corner in triangle {
            bytes.extend(if is_big { corner.to_be_bytes() } else { corner.to_le_bytes() });
        }
    }
    bytes
}

fn stl_text(scan: &Scan) -> String {
    let mut text = "solid body\n".to_owned();
    for triangle in &scan.triangles {
        text += "facet normal 0 0 0\nouter loop\n";
        for corner in triangle {
            let p = scan.points[*corner as usize];
            writeln!(text, "vertex {} {} {}", p.x, p.y, p.z).unwrap();
        }
        text += "endloop\nendfacet\n";
    }
    text + "endsolid body\n"
}

/// Rounds coordinates to single precision, as the format does.
fn stl_binary(scan: &Scan) -> Vec<u8> {
    let mut bytes = b"solid as many exporters say".to_vec();
    bytes.resize(80, b' ');
    bytes.extend((scan.triangles.len() as u32).to_le_bytes());
    for triangle in &scan.triangles {
        bytes.extend([0; 12]);
        for corner in triangle {
            let p = scan.points[*corner as usize];
            bytes.extend([p.x, p.y, p.z].map(|value| (value as f32).to_le_bytes()).as_flattened());
        }
        bytes.extend([0; 2]);
    }
    bytes
}

fn vrml(scan: &Scan, is_one: bool) -> String {
    let points = lines(scan, "", " ", ",\n");
    let mut corners = String::new();
    for [a, b, c] in &scan.triangles {
        write!(corners, "{a},{b},{c},-1,").unwrap();
    }
    let set = if corners.is_empty() {
        if is_one { "PointSet { }".to_owned() } else { "PointSet { coord USE p }".to_owned() }
    } else if is_one {
        format!("IndexedFaceSet {{ coordIndex [ {corners} ] }}")
    } else {
        format!("IndexedFaceSet {{ coord USE p coordIndex [ {corners} ] }}")
    };
    if is_one {
        format!("#VRML V1.0 ascii\nSeparator {{ Coordinate3 {{ point [ {points} ] }} {set} }}\n")
    } else {
        let defined = format!("DEF p Coordinate {{ point [ {points} ] }}");
        format!("#VRML V2.0 utf8\nShape {{ geometry {} }}\n", set.replace("USE p", &defined))
    }
}
