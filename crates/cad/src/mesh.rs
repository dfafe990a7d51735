//! Triangles → mesh files: STL, OBJ and binary glTF.
//!
//! The triangles come from [`gaiter_spline::facets`]; this module only writes them. Numbers are
//! rounded to each format's precision, the same way for every triangle that shares a point, so a
//! closed mesh stays closed.

use std::collections::BTreeMap;
use std::fmt::Write;

use gaiter_spline::{Corner, Facets};

use super::header::{FileHeader, SYSTEM};

/// Bytes of an STL file before the triangle count.
const STL_HEADER_BYTES: usize = 80;

/// Bytes per triangle of an STL file: a normal, three points, two bytes of attributes.
const STL_TRIANGLE_BYTES: usize = 50;

/// The triangles as a binary STL file, the format for printers and most mesh programs. Millimetres by convention,
/// because the format has no unit.
pub fn stl(facets: &Facets, header: &FileHeader) -> Vec<u8> {
    // A header that began with `solid` would mark a text file. The format does not define its encoding.
    let head = format!("{SYSTEM}, {}, mm", header.product);
    let mut head: Vec<u8> =
        head.bytes().map(|b| if b.is_ascii_graphic() { b } else { b' ' }).collect();
    head.resize(STL_HEADER_BYTES, b' ');
    let mut file = head;
    file.reserve(4 + STL_TRIANGLE_BYTES * facets.triangles.len());
    file.extend((facets.triangles.len() as u32).to_le_bytes());
    for triangle in &facets.triangles {
        let [a, b, c] = facets.places(triangle);
        let normal = (b - a).cross(&(c - a));
        let normal = normal.try_normalize(f64::MIN_POSITIVE).unwrap_or_default();
        for vector in [normal, a.coords, b.coords, c.coords] {
            file.extend(vector.iter().flat_map(|value| (*value as f32).to_le_bytes()));
        }
        file.extend([0; 2]);
    }
    file
}

/// Decimals of a coordinate in an OBJ file: a nanometre, and 1e-6 of a normal.
const OBJ_DECIMALS: usize = 6;

/// Length of most lines of an OBJ file, bytes, so that the text rarely has to grow.
const OBJ_LINE_BYTES: usize = 36;

/// The triangles as a Wavefront OBJ file with smooth normals, text that nearly every program reads; coordinates to a
/// nanometre, normals to 1e-6. Millimetres by convention, because the format has no unit.
pub fn obj(facets: &Facets, header: &FileHeader) -> Vec<u8> {
    // An object's name is one word.
    let name: String =
        header.product.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    let mut text = format!("# {SYSTEM}, mm\no {name}\n");
    text.reserve(
        OBJ_LINE_BYTES * (facets.points.len() + facets.normals.len() + facets.triangles.len()),
    );
    for point in &facets.points {
        push_obj_line(&mut text, "v", [point.x, point.y, point.z]);
    }
    for normal in &facets.normals {
        push_obj_line(&mut text, "vn", [normal.x, normal.y, normal.z]);
    }
    for triangle in &facets.triangles {
        text.push('f');
        for corner in triangle {
            // Indices count from 1. Writing to memory never fails.
            let (point, normal) = (u64::from(corner.point) + 1, u64::from(corner.normal) + 1);
            let _ = write!(text, " {point}//{normal}");
        }
        text.push('\n');
    }
    text.into_bytes()
}

fn push_obj_line(text: &mut String, kind: &str, xyz: [f64; 3]) {
    text.push_str(kind);
    for value in xyz {
        let _ = write!(text, " {value:.OBJ_DECIMALS$}");
    }
    text.push('\n');
}

/// Codes of component types and targets in glTF 2.0 (sections 3.6.2 and 5.11).
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// Metres in a millimetre.
const METRES: f64 = 1e-3;

/// The triangles as a binary glTF 2.0 file, the format for web pages, tablets and office programs. Metres with y up and
/// the front towards +z, as the format demands: a body that stands on its floor and faces the viewer.
pub fn glb(facets: &Facets, header: &FileHeader) -> Vec<u8> {
    let (corners, indices) = vertices(facets);
    let point = |corner: &Corner| {
        turned(facets.points[corner.point as usize].coords.into()).map(|mm| (mm * METRES) as f32)
    };
    let normal = |corner: &Corner| {
        turned(facets.normals[corner.normal as usize].into_inner().into()).map(|part| part as f32)
    };
    let points: Vec<[f32; 3]> = corners.iter().map(point).collect();
    let normals: Vec<[f32; 3]> = corners.iter().map(normal).collect();
    let json = gltf_json(header, &points, indices.len());
    let floats = points.iter().chain(&normals).flatten().flat_map(|value| value.to_le_bytes());
    let numbers = indices.iter().flat_map(|index| index.to_le_bytes());
    // Every value has four bytes, so the buffer needs no padding.
    let buffer: Vec<u8> = floats.chain(numbers).collect();
    glb_container(json, &buffer)
}

/// From z up and the toes along −y to y up and the toes along +z.
fn turned([x, y, z]: [f64; 3]) -> [f64; 3] {
    [x, z, -y]
}

/// The corners of all triangles, each once, in the order of first use, and three indices into them for each triangle: glTF
/// has one index for point and normal together.
fn vertices(facets: &Facets) -> (Vec<Corner>, Vec<u32>) {
    let mut known = BTreeMap::new();
    let mut corners = Vec::new();
    let place = |corner: &Corner| {
        *known.entry(*corner).or_insert_with(|| {
            corners.push(*corner);
            corners.len() as u32 - 1
        })
    };
    let indices = facets.triangles.iter().flatten().map(place).collect();
    (corners, indices)
}

/// The JSON for the buffer: one mesh of one part, lit from both sides because a tube shows its inside.
fn gltf_json(header: &FileHeader, points: &[[f32; 3]], indices: usize) -> String {
    let name = json_text(header.product);
    let count = points.len();
    let bytes = 12 * count;
    let (normals, numbers, all) = (bytes, 2 * bytes, 2 * bytes + 4 * indices);
    let bound = |better: fn(f32, f32) -> f32| {
        let fold = |axis: usize| points.iter().map(|point| point[axis]).reduce(better);
        // The float is written as the equal double, so that it reads back unchanged.
        let [x, y, z] = [0, 1, 2].map(|axis| f64::from(fold(axis).unwrap_or_default()));
        format!("[{x:?},{y:?},{z:?}]")
    };
    let (min, max) = (bound(f32::min), bound(f32::max));
    let view = |from: usize, length: usize, target: u32| {
        format!(r#"{{"buffer":0,"byteOffset":{from},"byteLength":{length},"target":{target}}}"#)
    };
    let views = [
        view(0, bytes, ARRAY_BUFFER),
        view(normals, bytes, ARRAY_BUFFER),
        view(numbers, 4 * indices, ELEMENT_ARRAY_BUFFER),
    ];
    let accessor = |view: usize, component: u32, count: usize, rest: &str| {
        format!(
            r#"{{"bufferView":{view},"componentType":{component},"count":{count},"type":{rest}}}"#
        )
    };
    let accessors = [
        accessor(0, FLOAT, count, &format!(r#""VEC3","min":{min},"max":{max}"#)),
        accessor(1, FLOAT, count, r#""VEC3""#),
        accessor(2, UNSIGNED_INT, indices, r#""SCALAR""#),
    ];
    let (views, accessors) = (views.join(","), accessors.join(","));
    let generator = json_text(SYSTEM);
    format!(
        concat!(
            r#"{{"asset":{{"version":"2.0","generator":{generator}}},"scene":0,"#,
            r#""scenes":[{{"nodes":[0]}}],"nodes":[{{"name":{name},"mesh":0}}],"#,
            r#""meshes":[{{"name":{name},"primitives":[{{"attributes":"#,
            r#"{{"POSITION":0,"NORMAL":1}},"indices":2,"material":0}}]}}],"#,
            r#""materials":[{{"doubleSided":true,"#,
            r#""pbrMetallicRoughness":{{"metallicFactor":0.0}}}}],"#,
            r#""accessors":[{accessors}],"bufferViews":[{views}],"#,
            r#""buffers":[{{"byteLength":{all}}}]}}"#
        ),
        generator = generator,
        name = name,
        accessors = accessors,
        views = views,
        all = all
    )
}

/// A text in quotes; quotes, backslashes and non-printable or non-ASCII characters become `\uXXXX`.
fn json_text(value: &str) -> String {
    let plain = |c: char| matches!(c, ' '..='~') && c != '"' && c != '\\';
    let mut units = [0; 2];
    let quoted: String = value
        .chars()
        .map(|c| {
            let escaped = |unit: &u16| format!("\\u{unit:04x}");
            if plain(c) {
                c.to_string()
            } else {
                c.encode_utf16(&mut units).iter().map(escaped).collect()
            }
        })
        .collect();
    format!("\"{quoted}\"")
}

/// Header, JSON chunk padded with spaces, binary chunk: glTF 2.0, 4.4.
fn glb_container(mut json: String, buffer: &[u8]) -> Vec<u8> {
    while !json.len().is_multiple_of(4) {
        json.push(' ');
    }
    let length = 12 + 8 + json.len() + 8 + buffer.len();
    let mut file = Vec::with_capacity(length);
    file.extend(b"glTF");
    for word in [2, length as u32, json.len() as u32] {
        file.extend(word.to_le_bytes());
    }
    file.extend(b"JSON");
    file.extend(json.as_bytes());
    file.extend((buffer.len() as u32).to_le_bytes());
    file.extend(b"BIN\0");
    file.extend(buffer);
    file
}
