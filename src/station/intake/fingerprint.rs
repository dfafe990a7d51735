//! The fingerprint of an export: what tells that a scan is known, in whatever bytes it comes.

use std::sync::{Mutex, PoisonError};

use gaiter_flow::ScanId;
use gaiter_scan::{self as scan, Format};
use sha2::{Digest, Sha256};

use crate::station::runtime::caught::caught;

/// How fingerprints of this kind begin: none is taken for one of another kind.
const KIND: &str = "read-1:";

/// The longest export that has a fingerprint, bytes. Reading one of them takes at most twenty times as much
/// memory, in the station itself.
const LONGEST: usize = 32 << 20;

/// Held while an export is read here: two at once may take more memory than the unit allows.
static ALONE: Mutex<()> = Mutex::new(());

/// The fingerprint of the points and triangles that the scan's decoder reads in these bytes; `None` if it
/// reads none, or the export is too long: then only its bytes tell.
pub fn of(bytes: &[u8], format: Format) -> Option<String> {
    if bytes.len() > LONGEST {
        return None;
    }
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    // One thread, which ends: the cores are for scans that are being measured.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().ok()?;
    let scan = caught(|| pool.install(|| scan::read(bytes, format))).ok()?.ok()?;
    let mut digest = Sha256::new();
    scan.each_piece(|piece| digest.update(piece));
    Some(format!("{KIND}{}", ScanId::of_digest(digest.finalize().into())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_is_read_has_a_fingerprint() {
        let of = |text: &str| super::of(text.as_bytes(), Format::Obj);
        let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
        let found = of(triangle).unwrap();
        assert!(found.starts_with(KIND) && found.len() == KIND.len() + 64, "{found}");
        assert_eq!(of(&format!("# nine\r\n{triangle}")), Some(found.clone()));
        assert_ne!(of(&triangle.replacen("0 0 0", "0 0 1", 1)), Some(found));
        assert_eq!(of("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n"), None);
        assert_eq!(of(&triangle.repeat(LONGEST / triangle.len() + 1)), None);
    }
}
