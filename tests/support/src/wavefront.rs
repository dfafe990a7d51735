//! Scans written as exports.

use gaiter_scan::Scan;

/// A scan written as Wavefront OBJ, every digit kept.
pub fn obj(scan: &Scan) -> Vec<u8> {
    let points = scan.points.iter().map(|p| format!("v {} {} {}\n", p.x, p.y, p.z));
    let corners = scan.triangles.iter().map(|t| t.map(|corner| corner + 1));
    let triangles = corners.map(|[a, b, c]| format!("f {a} {b} {c}\n"));
    points.chain(triangles).collect::<String>().into_bytes()
}
