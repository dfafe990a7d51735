//! STL, OBJ and glTF files of a tube and of the solid within it, read back.
#![allow(clippy::unwrap_used)]

use std::collections::BTreeSet;

use gaiter_cad::{CadFault, FileFormat, FileHeader, FileKind, Shape, mesh};
use gaiter_scan::{Format, read};
use gaiter_spline::{Ends, Facets, facets};
use nalgebra::{Point3, Vector3};
use support::tubes::tube;

use crate::HEADER;

const TOLERANCE_MM: f64 = 0.1;

fn made(turn: f64, ends: Ends) -> Facets {
    facets(&tube(turn).0, TOLERANCE_MM, ends).unwrap()
}

fn word(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap())
}

fn float(bytes: &[u8], at: usize) -> f32 {
    f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap())
}

fn vector(bytes: &[u8], at: usize) -> [f32; 3] {
    [0, 4, 8].map(|axis| float(bytes, at + axis))
}

fn to_f32(point: &Point3<f64>) -> [f32; 3] {
    [point.x, point.y, point.z].map(|mm| mm as f32)
}

#[test]
fn stl_is_a_header_a_count_and_50_bytes_a_triangle_with_its_outward_normal() {
    for (turn, ends) in [(1.0, Ends::Open), (-1.0, Ends::Fans)] {
        let made = made(turn, ends);
        let file = mesh::stl(&made, &HEADER);
        assert_eq!(file.len(), 84 + 50 * made.triangles.len());
        assert!(!file.starts_with(b"solid"), "readers would take it for text");
        let head = std::str::from_utf8(&file[..80]).unwrap().trim_end();
        assert_eq!(head, concat!("gaiter ", env!("CARGO_PKG_VERSION"), ", left leg, mm"));
        assert_eq!(word(&file, 80) as usize, made.triangles.len());
        for (index, triangle) in made.triangles.iter().enumerate() {
            let at = 84 + 50 * index;
            let corners = made.places(triangle);
            for (corner, place) in corners.iter().enumerate() {
                assert_eq!(vector(&file, at + 12 * (corner + 1)), to_f32(place));
            }
            let normal = Vector3::from(vector(&file, at).map(f64::from));
            let own = made.normals[triangle[0].normal as usize];
            assert!((normal.norm() - 1.0).abs() < 1e-6 && normal.dot(&own) > 0.95);
            assert_eq!(file[at + 48..at + 50], [0, 0]);
        }
    }
}

#[test]
fn gaiter_reads_its_own_meshes_as_it_wrote_them() {
    for ends in [Ends::Open, Ends::Fans] {
        let made = made(1.0, ends);
        let obj = read(&mesh::obj(&made, &HEADER), Format::Obj).unwrap();
        let stl = read(&mesh::stl(&made, &HEADER), Format::Stl).unwrap();
        for scan in [&obj, &stl] {
            // As many points as there are: the seam and the rims are one.
            assert_eq!(scan.points.len(), made.points.len());
            assert_eq!(scan.triangles.len(), made.triangles.len());
        }
        for (found, expected) in obj.triangles.iter().zip(&made.triangles) {
            let found = found.map(|corner| obj.points[corner as usize]);
            for (found, expected) in found.iter().zip(made.places(expected)) {
                assert!((found - expected).norm() < 1e-6, "{found} {expected}");
            }
        }
    }
}

#[test]
fn obj_has_a_normal_for_every_corner_counted_from_1() {
    let made = made(-1.0, Ends::Fans);
    let text = String::from_utf8(mesh::obj(&made, &HEADER)).unwrap();
    let lines = |start: &str| text.lines().filter(|line| line.starts_with(start)).count();
    assert_eq!(lines("v "), made.points.len());
    assert_eq!(lines("vn "), made.normals.len());
    assert_eq!(lines("f "), made.triangles.len());
    assert!(text.starts_with(concat!(
        "# gaiter ",
        env!("CARGO_PKG_VERSION"),
        ", mm\no left_leg\nv "
    )));
    let face = text.lines().filter_map(|line| line.strip_prefix("f "));
    for (face, triangle) in face.zip(&made.triangles) {
        let said = triangle.map(|c| format!("{}//{}", c.point + 1, c.normal + 1)).join(" ");
        assert_eq!(face, said);
    }
}

/// A GLB file as the `gltf` crate reads it, which also checks it against the schema.
fn gltf(file: &[u8]) -> (gltf::Document, Vec<u8>) {
    let read = gltf::Gltf::from_slice(file).unwrap();
    (read.document, read.blob.unwrap())
}

#[test]
fn glb_has_two_aligned_chunks_that_fill_it() {
    let file = mesh::glb(&made(1.0, Ends::Fans), &HEADER);
    assert_eq!(&file[..4], b"glTF");
    assert_eq!((word(&file, 4), word(&file, 8) as usize), (2, file.len()));
    let json = word(&file, 12) as usize;
    assert_eq!((json % 4, &file[16..20]), (0, b"JSON".as_slice()));
    let binary = word(&file, 20 + json) as usize;
    assert_eq!((binary % 4, &file[24 + json..28 + json]), (0, b"BIN\0".as_slice()));
    assert_eq!(28 + json + binary, file.len());
    let text = &file[20..20 + json];
    let value: serde_json::Value = serde_json::from_slice(text).unwrap();
    assert_eq!(value["buffers"][0]["byteLength"], binary);
    assert_eq!(value["asset"]["version"], "2.0");
    assert_eq!(value["nodes"][0]["name"], "left leg");
}

#[test]
fn glb_accessors_lie_in_the_buffer_and_say_the_least_and_the_most() {
    for ends in [Ends::Open, Ends::Fans] {
        let file = mesh::glb(&made(1.0, ends), &HEADER);
        let (document, blob) = gltf(&file);
        let mut end = 0;
        for accessor in document.accessors() {
            let view = accessor.view().unwrap();
            assert_eq!((view.offset(), view.stride(), view.offset() % 4), (end, None, 0));
            assert_eq!(accessor.count() * accessor.size(), view.length());
            end += view.length();
        }
        assert_eq!(end, blob.len());
        let points = document.accessors().next().unwrap();
        let places = (0..points.count()).map(|i| vector(&blob, 12 * i));
        for axis in 0..3 {
            let along = || places.clone().map(|place| f64::from(place[axis]));
            let bound = |value: Option<serde_json::Value>| value.unwrap()[axis].as_f64();
            assert_eq!(bound(points.min()), along().reduce(f64::min));
            assert_eq!(bound(points.max()), along().reduce(f64::max));
        }
    }
}

#[test]
fn glb_stands_on_its_floor_in_metres_and_looks_at_the_viewer() {
    let made = made(1.0, Ends::Fans);
    let file = mesh::glb(&made, &HEADER);
    let (document, blob) = gltf(&file);
    let primitive = document.meshes().next().unwrap().primitives().next().unwrap();
    let reader = primitive.reader(|_| Some(&blob));
    let places: Vec<[f32; 3]> = reader.read_positions().unwrap().collect();
    let normals: Vec<[f32; 3]> = reader.read_normals().unwrap().collect();
    let indices: Vec<u32> = reader.read_indices().unwrap().into_u32().collect();
    assert_eq!(indices.len(), 3 * made.triangles.len());
    for (index, corner) in indices.iter().zip(made.triangles.iter().flatten()) {
        let (place, normal) = (places[*index as usize], normals[*index as usize]);
        let back = |[x, y, z]: [f32; 3]| Vector3::new(x, -z, y).map(f64::from);
        assert!((back(place) * 1e3 - made.points[corner.point as usize].coords).norm() < 1e-4);
        assert!((back(normal) - made.normals[corner.normal as usize].into_inner()).norm() < 1e-6);
    }
    // Each corner once, and the rims twice, since lid and tube have normals of their own there.
    let rims =
        made.triangles.iter().flatten().filter(|c| c.normal as usize >= made.points.len() - 2);
    let rims: BTreeSet<_> = rims.collect();
    assert_eq!(places.len(), made.points.len() - 2 + rims.len());
}

#[test]
fn no_name_can_break_a_mesh_and_the_same_surface_gives_the_same_bytes() {
    let name = "l\"e\\f\nt\u{1f9b5}\u{fc} solid, \u{7f}".repeat(9);
    let header = FileHeader { file_name: &name, product: &name };
    let made = made(1.0, Ends::Open);
    assert_eq!(
        read(&mesh::stl(&made, &header), Format::Stl).unwrap().triangles.len(),
        made.triangles.len()
    );
    assert_eq!(
        read(&mesh::obj(&made, &header), Format::Obj).unwrap().triangles.len(),
        made.triangles.len()
    );
    let file = mesh::glb(&made, &header);
    let json = word(&file, 12) as usize;
    let value: serde_json::Value = serde_json::from_slice(&file[20..20 + json]).unwrap();
    assert_eq!(value["nodes"][0]["name"], name);
    for write in [mesh::stl, mesh::obj, mesh::glb] {
        assert_eq!(write(&made, &HEADER), write(&made.clone(), &HEADER));
    }
}

#[test]
fn a_mesh_that_would_be_too_fine_is_a_fault_with_a_code() {
    let kind = FileKind { format: FileFormat::Stl, shape: Shape::Tube };
    let fault = kind.bytes(&tube(1.0).0, 1e-9, &HEADER).unwrap_err();
    assert!(matches!(fault, CadFault::Tessellation(_)), "{fault}");
    assert_eq!(fault.code(), "mesh-not-made");
}
