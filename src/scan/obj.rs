//! Wavefront OBJ.
use super::{Scan, ScanFault};
/// stub
pub fn read(_bytes: &[u8]) -> Result<Scan, ScanFault> {
    Err(ScanFault::Empty)
}
/// stub
pub fn completeness(_bytes: &[u8]) -> Result<(), ScanFault> {
    Ok(())
}
