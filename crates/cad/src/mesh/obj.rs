//! Wavefront OBJ with smooth normals: text that nearly every program reads. Millimetres by
//! convention, because the format has no unit.

use std::fmt::Write;

use gaiter_spline::Facets;

use crate::header::{FileHeader, SYSTEM};

/// Decimals of a coordinate: a nanometre, and 1e-6 of a normal.
const PLACES: usize = 6;

/// Length of most lines, bytes, so that the text rarely has to grow.
const LINE_BYTES: usize = 36;

/// The triangles as an OBJ file; coordinates to a nanometre, normals to 1e-6.
pub fn write(facets: &Facets, header: &FileHeader) -> Vec<u8> {
    // An object's name is one word.
    let name: String =
        header.product.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    let mut text = format!("# {SYSTEM}, mm\no {name}\n");
    text.reserve(
        LINE_BYTES * (facets.points.len() + facets.normals.len() + facets.triangles.len()),
    );
    for point in &facets.points {
        push_line(&mut text, "v", [point.x, point.y, point.z]);
    }
    for normal in &facets.normals {
        push_line(&mut text, "vn", [normal.x, normal.y, normal.z]);
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

fn push_line(text: &mut String, kind: &str, xyz: [f64; 3]) {
    text.push_str(kind);
    for value in xyz {
        let _ = write!(text, " {value:.PLACES$}");
    }
    text.push('\n');
}
