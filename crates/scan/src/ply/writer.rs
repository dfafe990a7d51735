//! A scan as a binary PLY file, from which it is read back bit by bit.

use super::super::Scan;

impl Scan {
    /// The bytes of a little-endian PLY file: coordinates as doubles, no normals, colours or comments.
    pub fn to_ply(&self) -> Vec<u8> {
        let mut bytes = format!(
            "ply\nformat binary_little_endian 1.0\n\
             element vertex {}\nproperty double x\nproperty double y\nproperty double z\n\
             element face {}\nproperty list uchar uint vertex_indices\nend_header\n",
            self.points.len(),
            self.triangles.len()
        )
        .into_bytes();
        for value in self.points.iter().flat_map(|point| point.iter()) {
            bytes.extend_from_slice(&value.to_le_bytes());
        }
        for triangle in &self.triangles {
            bytes.push(3);
            triangle.iter().for_each(|corner| bytes.extend_from_slice(&corner.to_le_bytes()));
        }
        bytes
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Point3;

    use super::*;
    use crate::{Format, read};

    #[test]
    fn a_scan_is_read_back_bit_by_bit() {
        let points: Vec<Point3<f64>> =
            [[0.1 + 0.2, -0.0, 1e-300], [1.0 / 3.0, 2e9, -7.25], [f64::MAX, 0.0, f64::EPSILON]]
                .map(Point3::from)
                .to_vec();
        for triangles in [vec![], vec![[2, 0, 1]]] {
            let scan = Scan { points: points.clone(), triangles };
            let found = read(&scan.to_ply(), Format::Ply).unwrap();
            let bits = |scan: &Scan| -> Vec<u64> {
                scan.points.iter().flat_map(|point| point.iter().map(|v| v.to_bits())).collect()
            };
            assert_eq!((bits(&found), &found.triangles), (bits(&scan), &scan.triangles));
        }
    }
}
