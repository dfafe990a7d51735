//! The fingerprint of a scan: what tells that it is known, in whatever bytes it comes.

use gaiter_flow::ScanId;
use gaiter_scan::Scan;
use sha2::{Digest, Sha256};

/// How fingerprints of this kind begin: none is taken for one of another kind.
const KIND: &str = "read-1:";

/// The fingerprint of the points and triangles that were read.
pub fn fingerprint(scan: &Scan) -> String {
    let mut digest = Sha256::new();
    scan.each_piece(|piece| digest.update(piece));
    format!("{KIND}{}", ScanId::of_digest(digest.finalize().into()))
}

#[cfg(test)]
mod tests {
    use gaiter_scan::{Format, read};

    use super::*;

    #[test]
    fn what_is_read_is_one_scan_however_it_is_written() {
        let of = |text: &str| fingerprint(&read(text.as_bytes(), Format::Obj).unwrap());
        let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
        let found = of(triangle);
        assert!(found.starts_with(KIND) && found.len() == KIND.len() + 64, "{found}");
        assert_eq!(of(&format!("# nine\r\n{triangle}")), found);
        assert_ne!(of(&triangle.replacen("0 0 0", "0 0 1", 1)), found);
    }
}
