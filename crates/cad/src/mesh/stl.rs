//! Binary STL: the format for printers and most mesh programs. Millimetres by convention, because
//! the format has no unit.

use gaiter_spline::Facets;

use crate::header::{FileHeader, SYSTEM};

/// Bytes before the triangle count.
const HEADER_BYTES: usize = 80;

/// Bytes per triangle: a normal, three points, two bytes of attributes.
const TRIANGLE_BYTES: usize = 50;

/// The triangles as an STL file.
pub fn write(facets: &Facets, header: &FileHeader) -> Vec<u8> {
    // A header that began with `solid` would mark a text file. The format does not define its encoding.
    let head = format!("{SYSTEM}, {}, mm", header.product);
    let mut head: Vec<u8> =
        head.bytes().map(|b| if b.is_ascii_graphic() { b } else { b' ' }).collect();
    head.resize(HEADER_BYTES, b' ');
    let mut file = head;
    file.reserve(4 + TRIANGLE_BYTES * facets.triangles.len());
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
