//! Wavefront OBJ with smooth normals: text that nearly every program reads. Millimetres by
//! convention, because the format has no unit.

use std::fmt::Write;

use crate::cad::header::{FileHeader, SYSTEM};
use crate::spline::Facets;

/// The triangles as an OBJ file; coordinates to a nanometre, normals to 1e-6.
pub fn write(facets: &Facets, header: &FileHeader) -> Vec<u8> {
    // An object's name is one word.
    let name: String =
        header.product.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    let mut text = format!("# {SYSTEM}, mm\no {name}\n");
    // Writing to a `String` cannot fail.
    for point in &facets.points {
        let _ = writeln!(text, "v {:.6} {:.6} {:.6}", point.x, point.y, point.z);
    }
    for normal in &facets.normals {
        let _ = writeln!(text, "vn {:.6} {:.6} {:.6}", normal.x, normal.y, normal.z);
    }
    for triangle in &facets.triangles {
        // Indices count from 1.
        let [a, b, c] = triangle.map(|corner| (corner.point + 1, corner.normal + 1));
        let _ = writeln!(text, "f {}//{} {}//{} {}//{}", a.0, a.1, b.0, b.1, c.0, c.1);
    }
    text.into_bytes()
}
