//! Laws of the decoders: the same body is the same scan in whatever format it is written; a file
//! cut anywhere is refused or has a part of it; quick looks and readings agree.

#![allow(clippy::unwrap_used, clippy::panic)]

use gaiter_scan::{CutSign, Format, Scan, ScanFault, completeness, read};
use nalgebra::Point3;
use proptest::prelude::*;
use support::recorded;
use support::writers::{MESHES, Writer};

/// A cube whose triangles use its points in their order, so that no reader has to reorder them.
fn cube() -> Scan {
    let corner = |i: u32| Point3::from([i, i >> 1, i >> 2].map(|bit| f64::from(bit & 1)));
    let quads =
        [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
    let in_order = [0, 1, 3, 2, 4, 5, 7, 6];
    let number = |corner: u32| in_order.iter().position(|&c| c == corner).unwrap() as u32;
    let halves = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    Scan {
        points: in_order.map(corner).to_vec(),
        triangles: halves.map(|half| half.map(number)).collect(),
    }
}

/// The scan with its points in the order in which its triangles use them.
fn in_order_of_use(scan: &Scan) -> Scan {
    let mut numbers = vec![None; scan.points.len()];
    let mut points = Vec::new();
    let mut renumbered = |corner: u32| {
        *numbers[corner as usize].get_or_insert_with(|| {
            points.push(scan.points[corner as usize]);
            points.len() as u32 - 1
        })
    };
    let triangles = scan.triangles.iter().map(|t| t.map(&mut renumbered)).collect();
    Scan { points, triangles }
}

#[test]
fn the_same_cube_is_the_same_scan_in_every_format() {
    let cube = cube();
    for writer in MESHES {
        assert_eq!(read(&writer.write(&cube), writer.format()).as_ref(), Ok(&cube), "{writer:?}");
    }
    let points = Scan { points: cube.points, triangles: vec![] };
    let with_points = MESHES.into_iter().filter(|writer| writer.format() != Format::Stl);
    for writer in with_points.chain([Writer::Xyz]) {
        let read = read(&writer.write(&points), writer.format());
        assert_eq!(read.as_ref(), Ok(&points), "{writer:?}");
    }
}

#[test]
fn a_recorded_body_is_the_same_scan_in_every_format() {
    let body = in_order_of_use(&recorded::scan("f_average_clean"));
    let rounded = |scan: &Scan| Scan {
        points: scan.points.iter().map(|p| p.map(|v| f64::from(v as f32))).collect(),
        triangles: scan.triangles.clone(),
    };
    for writer in MESHES {
        let expected = if writer == Writer::StlBinary { rounded(&body) } else { body.clone() };
        let found = read(&writer.write(&body), writer.format()).unwrap();
        assert!(found == expected, "{writer:?}: {} points", found.points.len());
    }
    let found = read(&Writer::Xyz.write(&body), Format::Xyz).unwrap();
    assert!(found.points == body.points && found.triangles.is_empty());
}

#[test]
fn a_file_under_another_ending_is_told_what_it_looks_like() {
    let formats = [Format::Obj, Format::Ply, Format::Stl, Format::Wrl, Format::Xyz];
    for writer in MESHES.into_iter().chain([Writer::Xyz]) {
        let bytes = writer.write(&cube());
        for format in formats.into_iter().filter(|format| *format != writer.format()) {
            let fault = read(&bytes, format).unwrap_err();
            assert_eq!(fault.code(), "scan-not-this-format", "{writer:?} as {format}");
            let says = format!("the content looks like {}, not {format};", writer.format());
            assert!(fault.to_string().starts_with(&says), "{fault}");
            assert_eq!(completeness(&bytes, format), Ok(()), "waiting does not mend the name");
        }
    }
}

#[test]
fn a_body_cut_in_half_is_awaited_and_says_how_much_is_there() {
    let body = recorded::scan("f_average_clean");
    for writer in MESHES {
        let bytes = writer.write(&body);
        let half = &bytes[..bytes.len() / 2];
        let fault = completeness(half, writer.format()).unwrap_err();
        assert!(fault.may_be_mended_by_waiting(), "{writer:?}: {fault}");
        assert_eq!(read(half, writer.format()), Err(fault.clone()), "{writer:?}");
        let of = match writer {
            Writer::PlyText | Writer::PlyLittle | Writer::PlyBig => "faces",
            Writer::StlBinary => "of 112156 triangles",
            _ => continue,
        };
        assert!(fault.to_string().contains(of), "{fault}");
    }
    let counted = format!("{}\n", body.points.len()).into_bytes();
    let points = [counted, Writer::Xyz.write(&body)].concat();
    let line_end = points[..100_000].iter().rposition(|&byte| byte == b'\n').unwrap();
    let what = CutSign::Missing {
        what: "points",
        has: points[..line_end].iter().filter(|&&byte| byte == b'\n').count(),
        of: 56234,
    };
    assert_eq!(completeness(&points[..=line_end], Format::Xyz), Err(ScanFault::CutShort { what }));
}

#[test]
fn a_file_reserved_at_its_full_size_and_not_filled_to_its_end_is_awaited() {
    let body = recorded::scan("f_average_clean");
    let cloud = Scan { points: body.points.clone(), triangles: vec![] };
    let clouds = [Writer::Obj, Writer::PlyText, Writer::PlyLittle, Writer::PlyBig, Writer::Xyz];
    let writings = MESHES.map(|writer| (writer, &body)).into_iter();
    for (writer, scan) in writings.chain(clouds.map(|writer| (writer, &cloud))) {
        let bytes = writer.write(scan);
        assert_eq!(completeness(&bytes, writer.format()), Ok(()), "{writer:?}");
        for filled in [0, 1, 60, 4096, bytes.len() / 2, bytes.len() - 600] {
            let mut reserved = vec![0; bytes.len()];
            reserved[..filled].copy_from_slice(&bytes[..filled]);
            let waits = completeness(&reserved, writer.format())
                .is_err_and(|fault| fault.may_be_mended_by_waiting());
            assert!(waits, "{writer:?} of {} triangles, {filled} bytes", scan.triangles.len());
        }
    }
}

#[test]
fn a_text_with_a_block_that_is_not_written_yet_is_awaited_and_a_stray_zero_is_not() {
    for writer in MESHES.into_iter().chain([Writer::Xyz]) {
        let mut bytes = writer.write(&recorded::scan("f_average_clean"));
        if matches!(writer, Writer::PlyLittle | Writer::PlyBig | Writer::StlBinary) {
            continue;
        }
        let middle = bytes.len() / 2;
        bytes[middle] = 0;
        let waits = |bytes: &[u8]| {
            completeness(bytes, writer.format())
                .is_err_and(|fault| fault.may_be_mended_by_waiting())
        };
        // Text that is none could still be a binary STL, whose number of triangles is missing.
        assert!(!waits(&bytes) || writer == Writer::StlText, "{writer:?}");
        bytes[middle..middle + 4096].fill(0);
        assert!(waits(&bytes), "{writer:?}");
    }
}

/// Meshes of a few points on a coarse grid, so that many coincide and many triangles are none.
fn meshes() -> impl Strategy<Value = Scan> {
    let points = prop::collection::vec(prop::array::uniform3(-2..3_i32), 3..12);
    points.prop_flat_map(|points| {
        let corner = 0..points.len() as u32;
        let triangles = prop::collection::vec(prop::array::uniform3(corner), 1..20);
        let points: Vec<_> =
            points.iter().map(|p| Point3::from(p.map(|v| 0.25 * f64::from(v)))).collect();
        triangles.prop_map(move |triangles| Scan { points: points.clone(), triangles })
    })
}

/// The corners of every triangle, whatever the numbers of the points.
fn corners(scan: &Scan) -> Vec<[Point3<f64>; 3]> {
    scan.triangles.iter().map(|t| t.map(|corner| scan.points[corner as usize])).collect()
}

fn is_proper([a, b, c]: &[Point3<f64>; 3]) -> bool {
    a != b && b != c && c != a
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, cases: 300, ..Default::default() })]

    #[test]
    fn every_writer_s_mesh_comes_back_welded(mesh in meshes()) {
        let mut expected = corners(&mesh);
        expected.retain(is_proper);
        prop_assume!(!expected.is_empty());
        for writer in MESHES {
            let bytes = writer.write(&mesh);
            // A point that no face uses is a sign of a cut face list in OBJ, and zeros at the end
            // are one of a file that was reserved and not yet written.
            let ends_in_zeros = corners(&mesh).last().is_some_and(|t| *t == [Point3::origin(); 3]);
            let Ok(found) = read(&bytes, writer.format()) else {
                prop_assert!(writer == Writer::Obj || ends_in_zeros, "{:?}", writer);
                continue;
            };
            prop_assert_eq!(corners(&found), expected.clone(), "{:?}", writer);
            let mut places: Vec<_> = found.points.iter().map(|p| [p.x, p.y, p.z].map(|v| (4.0 * v) as i32)).collect();
            places.sort_unstable();
            let count = places.len();
            places.dedup();
            prop_assert_eq!(places.len(), count, "{:?}: two points at one place", writer);
        }
    }

    #[test]
    fn every_point_comes_back_to_its_last_digit(
        points in prop::collection::vec(prop::array::uniform3(prop::num::f64::NORMAL | prop::num::f64::ZERO), 1..20)
    ) {
        let scan = Scan { points: points.into_iter().map(Point3::from).collect(), triangles: vec![] };
        for writer in [Writer::Obj, Writer::PlyText, Writer::PlyLittle, Writer::PlyBig, Writer::Vrml2, Writer::Xyz] {
            let found = read(&writer.write(&scan), writer.format());
            prop_assert_eq!(found.as_ref(), Ok(&scan), "{:?}", writer);
        }
    }

    #[test]
    fn a_cut_mesh_is_refused_or_has_a_part_of_the_triangles(mesh in meshes(), share in 0.0..1.0_f64) {
        let all = corners(&mesh);
        for writer in MESHES {
            let bytes = writer.write(&mesh);
            let part = &bytes[..(share * bytes.len() as f64) as usize];
            if let Ok(found) = read(part, writer.format()) {
                prop_assert!(corners(&found).iter().all(|triangle| all.contains(triangle)), "{:?}", writer);
            }
        }
    }
}
