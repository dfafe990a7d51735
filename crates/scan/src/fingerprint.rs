//! What identifies a scan: its points and triangles, whatever else its file says and however it says it.

use super::Scan;

/// How many points or triangles make a piece: so many that the calls cost nothing.
const PIECE: usize = 4096;

impl Scan {
    /// Gives `each` the number of points, the points and the triangles as bytes, in order and in pieces:
    /// what a fingerprint is the hash of. Scans are equal exactly if these bytes are.
    pub fn each_piece(&self, mut each: impl FnMut(&[u8])) {
        let mut piece = Vec::new();
        each(&(self.points.len() as u64).to_le_bytes());
        for points in self.points.chunks(PIECE) {
            piece.clear();
            for value in points.iter().flat_map(|point| point.iter()) {
                // The two zeros are one place.
                piece.extend_from_slice(&(value + 0.0).to_le_bytes());
            }
            each(&piece);
        }
        for triangles in self.triangles.chunks(PIECE) {
            piece.clear();
            for corner in triangles.as_flattened() {
                piece.extend_from_slice(&corner.to_le_bytes());
            }
            each(&piece);
        }
    }
}
