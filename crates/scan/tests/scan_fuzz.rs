//! Spoilt files by the ten thousand: whatever the bytes, a decoder answers with a scan that keeps
//! its promises or with a fault, and never takes more memory than it promises.
//!
//! The seed is fixed; `GAITER_FUZZ=N cargo test --test scan_fuzz` tries N spoilt copies of each
//! file. `fuzz/run` goes on from there with a fuzzer that sees which code it has reached.

#![allow(clippy::disallowed_methods, clippy::disallowed_types, clippy::panic, clippy::unwrap_used)]

use std::fs;
use std::sync::{Mutex, MutexGuard, PoisonError};

use gaiter_scan::{End, Format, Scan, ScanFault, completeness, reading};
use peak_alloc::PeakAlloc;
use support::recorded;
use support::writers::{MESHES, Writer};

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// Held by each test from its beginning to its end: the allocator counts for the whole process.
static ALONE: Mutex<()> = Mutex::new(());

fn alone() -> MutexGuard<'static, ()> {
    ALONE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What a decoder may take besides its input, bytes: so much, and so many times its result.
const MEMORY_FREE: usize = 16_000_000;
const MEMORY_SHARE: usize = 12;

/// Spoilt copies of each file, unless the environment says otherwise.
const COPIES: u64 = 500;

/// Decodes and holds the decoder to its promises, that of its memory included.
fn held(bytes: &[u8], format: Format, name: &str) -> Result<Scan, ScanFault> {
    MEMORY.reset_peak_usage();
    let before = MEMORY.current_usage();
    let reading = reading(bytes, format);
    let taken = MEMORY.peak_usage() - before;
    let complete = completeness(bytes, format);
    let mut size = 0;
    match &reading.scan {
        Ok(scan) => {
            let is_whole = complete.is_ok() == (reading.end == End::Whole);
            let is_cut_short = reading.end == End::CutShort;
            assert!(is_whole && !is_cut_short, "{name}: read although cut short: {complete:?}");
            assert!(scan.points.iter().flat_map(|p| p.iter()).all(|c| c.is_finite()), "{name}");
            let mut used = vec![false; scan.points.len()];
            for &[a, b, c] in &scan.triangles {
                assert!(a != b && b != c && c != a, "{name}");
                [a, b, c].iter().for_each(|&corner| used[corner as usize] = true);
            }
            assert!(scan.triangles.is_empty() || used.iter().all(|used| *used), "{name}");
            size = 24 * scan.points.len() + 12 * scan.triangles.len();
        }
        Err(fault) => {
            let said = fault.to_string();
            assert!(said.lines().count() == 1 && said.len() < 400, "{name}: {said}");
            assert!(complete.is_ok() || complete == Err(fault.clone()), "{name}: {said}");
        }
    }
    let allowed = MEMORY_FREE + MEMORY_SHARE * size;
    assert!(taken <= allowed, "{name}: {taken} bytes for a result of {size}");
    reading.scan
}

/// Numbers that look random and are the same for the same seed (splitmix64).
struct Chance(u64);

impl Chance {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    fn below(&mut self, end: usize) -> usize {
        (self.next() % end.max(1) as u64) as usize
    }
}

/// Pieces that decoders are likely to trip over.
const PIECES: [&[u8]; 24] = [
    b"nan",
    b"1e999",
    b"-1",
    b"4294967295",
    b"18446744073709551615",
    b"1,5",
    b",",
    b";",
    b"\\\n",
    b"\r",
    b"\n\n",
    b"#",
    b"\"",
    b"{",
    b"}",
    b"[",
    b"]",
    b"USE a ",
    b"DEF a Group { }",
    b"end_header\n",
    b"element face 3\n",
    b"property list char int vertex_index\n",
    b"\xff\xff\xff\xff",
    b"\0\0\0\0",
];

/// Spoils bytes in one of the ways in which files are spoilt.
fn spoil(bytes: &mut Vec<u8>, chance: &mut Chance) {
    let at = chance.below(bytes.len());
    let length = chance.below(40).min(bytes.len() - at);
    match chance.below(7) {
        0 if !bytes.is_empty() => bytes[at] ^= 1 << chance.below(8),
        1 if !bytes.is_empty() => bytes[at] = chance.next() as u8,
        2 => drop(bytes.drain(at..at + length)),
        3 => bytes.truncate(at),
        4 => {
            let again = bytes[at..at + length].to_vec();
            let to = chance.below(bytes.len());
            drop(bytes.splice(to..to, again));
        }
        5 => drop(bytes.splice(at..at, PIECES[chance.below(PIECES.len())].iter().copied())),
        _ => {
            let piece = PIECES[chance.below(PIECES.len())];
            let end = (at + piece.len()).min(bytes.len());
            drop(bytes.splice(at..end, piece.iter().copied()));
        }
    }
}

#[test]
fn a_spoilt_file_is_a_scan_or_a_fault_and_takes_little_memory() {
    let _alone = alone();
    let copies = std::env::var("GAITER_FUZZ").ok().and_then(|text| text.parse().ok());
    let root = support::root().join("fixtures/cases/scan");
    let mut chance = Chance(2022);
    let mut tried = 0;
    for folder in fs::read_dir(root).unwrap().map(|entry| entry.unwrap().path()) {
        for path in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            let name = path.to_str().unwrap();
            let Ok(format) = Format::of_file_name(name) else { continue };
            let whole = fs::read(&path).unwrap();
            for copy in 0..copies.unwrap_or(COPIES) {
                let mut bytes = whole.clone();
                (0..=chance.below(4)).for_each(|_| spoil(&mut bytes, &mut chance));
                let _ = held(&bytes, format, &format!("{name}, copy {copy}"));
                tried += 1;
            }
        }
    }
    assert!(tried > 1000 || copies.is_some(), "only {tried} files were tried");
}

#[test]
fn a_recorded_body_takes_the_memory_that_is_promised() {
    let _alone = alone();
    let body = recorded::scan("f_average_clean");
    for writer in MESHES.into_iter().chain([Writer::Xyz]) {
        let bytes = writer.write(&body);
        let found = held(&bytes, writer.format(), &format!("{writer:?}")).unwrap();
        assert_eq!(found.points.len(), body.points.len(), "{writer:?}");
    }
}

#[test]
fn a_long_list_of_faces_takes_no_more_for_each() {
    let _alone = alone();
    // Just more than a power of two, where a growing list is largest for what it holds.
    let faces = "f 1 2 3\n".repeat((1 << 18) + 1);
    let text = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{faces}");
    let found = held(text.as_bytes(), Format::Obj, "one face, many times").unwrap();
    assert_eq!(found.triangles.len(), (1 << 18) + 1);
}

#[test]
fn a_count_is_not_believed_before_the_bytes_are_there() {
    let _alone = alone();
    for count in ["4294967295", "18446744073709551615", "99999999999999999999999"] {
        let header = |encoding: &str| {
            let vertex = format!("element vertex {count}\nproperty float x\nproperty float y\n");
            let face = format!("element face {count}\nproperty list uint int vertex_indices\n");
            format!("ply\nformat {encoding} 1.0\n{vertex}property float z\n{face}end_header\n")
        };
        for encoding in ["ascii", "binary_little_endian", "binary_big_endian"] {
            let bytes = header(encoding) + "1 2 3\n4 5 6\n";
            held(bytes.as_bytes(), Format::Ply, encoding).unwrap_err();
        }
        let points = format!("{count}\n1 2 3\n");
        held(points.as_bytes(), Format::Xyz, "XYZ").unwrap_err();
        let index = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 {count}\nf -1 -2 -{count}\n");
        held(index.as_bytes(), Format::Obj, "OBJ").unwrap_err();
    }
    let triangles = [&[b' '; 80][..], &[0xff; 4], &[1; 500]].concat();
    held(&triangles, Format::Stl, "STL").unwrap_err();
    let list = b"ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty char x\n\
        property char y\nproperty char z\nelement face 1\nproperty list uint int vertex_indices\n\
        end_header\n\x01\x01\x01\xff\xff\xff\xff";
    held(list, Format::Ply, "list").unwrap_err();
}

#[test]
fn a_megabyte_made_to_fill_the_memory_does_not() {
    let _alone = alone();
    let ply = "ply\nformat ascii 1.0\n";
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let one = "#VRML V1.0 ascii\n";
    let two = "#VRML V2.0 utf8\nDEF a Coordinate { point 1 2 3 }\n";
    let hostile = [
        (Format::Obj, obj, "f 1 1 1\n", ""),
        (Format::Obj, obj, "f 1 2\n", ""),
        (Format::Obj, obj, "v \\\n", "\n"),
        (Format::Obj, &format!("{obj}f 1"), " 2 1", "\n"),
        (Format::Obj, obj, "f 1 2 3\n", ""),
        (Format::Obj, "f 1 2 3\n", "v 0 0 0\n", ""),
        (Format::Ply, ply, "element a 0\n", ""),
        (Format::Ply, ply, "comment\n", ""),
        (Format::Stl, "", "solid\nendsolid\n", ""),
        (Format::Wrl, two, "Group {", ""),
        (Format::Wrl, two, "Group { } ", "\n"),
        (Format::Wrl, two, "DEF b Group { } ", "\n"),
        (Format::Wrl, two, "USE a ", "\n"),
        (Format::Wrl, two, "PointSet { coord USE a } ", "\n"),
        (Format::Wrl, two, "[", ""),
        (Format::Wrl, &format!("{two}Transform {{ "), "translation 1 2 3 ", "}\n"),
        (Format::Wrl, &format!("{two}Transform {{ translation "), "1 ", "}\n"),
        (
            Format::Wrl,
            &format!("{two}Shape {{ geometry IndexedFaceSet {{ coordIndex "),
            "0 ",
            "}}\n",
        ),
        (Format::Wrl, one, "Coordinate3 { point 1 2 3 } PointSet { } ", "\n"),
        (Format::Wrl, one, "\"", ""),
        (Format::Xyz, "", "#\n", ""),
        (Format::Xyz, "1", " 1", "\n"),
        (Format::Xyz, "1;2;3", ";", "\n"),
    ];
    for (format, before, piece, after) in hostile {
        let name = format!("{format}: {piece:?}");
        let bytes = [before, &piece.repeat(1_000_000 / piece.len()), after].concat();
        let _ = held(bytes.as_bytes(), format, &name);
    }
}
