//! Any bytes as a scan of this format.
#![no_main]

mod held;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| held::held(bytes, gaiter_scan::Format::Obj));
