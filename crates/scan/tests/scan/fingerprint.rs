//! Law of fingerprints: a scan has the same in whatever dialect its file is written, and another scan has
//! another.

use gaiter_scan::{Format, Scan, read};
use nalgebra::Point3;
use proptest::prelude::*;
use support::writers::{MESHES, Writer};

/// What the fingerprint of a file is the hash of; `None` if nothing is read in it.
fn fingerprint(bytes: &[u8], format: Format) -> Option<Vec<u8>> {
    let mut found = Vec::new();
    read(bytes, format).ok()?.each_piece(|piece| found.extend_from_slice(piece));
    Some(found)
}

/// How a program writes OBJ.
#[derive(Debug, Clone)]
struct Dialect {
    before: &'static str,
    between: &'static str,
    after: &'static str,
    line_end: &'static str,
    /// Lines without geometry, and before which statement they stand.
    others: Vec<(usize, &'static str)>,
}

fn dialect() -> impl Strategy<Value = Dialect> {
    let before = prop::sample::select(vec!["", " ", "\t", " \t "]);
    let between = prop::sample::select(vec![" ", "\t", "   ", " \\\n", "\t\\\n\t"]);
    let after = prop::sample::select(vec!["", " ", "\t "]);
    let line_end = prop::sample::select(vec!["\n", "\r\n", "\r", "\n\n"]);
    let other = prop::sample::select(vec![
        "# 22.11.2026 09:15",
        "#\tv 9 9 9",
        "mtllib A\\B.mtl",
        "o of nobody",
        "vn 0 0 1",
        "s off",
        "",
    ]);
    let others = prop::collection::vec((0_usize..20, other), 0..6);
    (before, between, after, line_end, others).prop_map(
        |(before, between, after, line_end, others)| Dialect {
            before,
            between,
            after,
            line_end,
            others,
        },
    )
}

/// A fan of triangles around the first of these points.
fn written(points: &[[i32; 3]], dialect: &Dialect) -> Vec<u8> {
    let Dialect { before, between, after, line_end, others } = dialect;
    let points_words = points.iter().map(|point| ("v", *point));
    let faces = (2..points.len() as i32).map(|corner| ("f", [1, corner, corner + 1]));
    let mut text = String::new();
    for (number, (word, [a, b, c])) in points_words.chain(faces).enumerate() {
        for (_, other) in others.iter().filter(|(at, _)| *at == number) {
            text += &format!("{before}{other}{line_end}");
        }
        let numbers = [a, b, c].map(|number| number.to_string()).join(*between);
        text += &format!("{before}{word}{between}{numbers}{after}{line_end}");
    }
    text.into_bytes()
}

/// Points of which no two coincide.
fn points() -> impl Strategy<Value = Vec<[i32; 3]>> {
    let places = prop::collection::vec((-300..300, -300..300), 3..9);
    places.prop_map(|places| (0..).zip(places).map(|(z, (x, y))| [x, y, z]).collect())
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..Default::default() })]

    #[test]
    fn other_words_for_a_body_have_its_fingerprint_and_another_body_has_another(
        body in points(),
        place in any::<prop::sample::Index>(),
        by in 0..2,
        dialects in [dialect(), dialect()],
    ) {
        let mut other = body.clone();
        other[place.index(body.len())][0] += by;
        let [found, of_other] = [(&body, &dialects[0]), (&other, &dialects[1])]
            .map(|(points, dialect)| fingerprint(&written(points, dialect), Format::Obj));
        prop_assert!(found.is_some() && of_other.is_some());
        prop_assert_eq!(found == of_other, by == 0);
    }
}

#[test]
fn each_format_has_its_own_comments() {
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(Point3::from);
    let mesh = Scan { points: corners.to_vec(), triangles: vec![[0, 1, 2]] };
    let cloud = Scan { triangles: Vec::new(), ..mesh.clone() };
    for (writer, scan) in
        MESHES.map(|writer| (writer, &mesh)).into_iter().chain([(Writer::Xyz, &cloud)])
    {
        let bytes = writer.write(scan);
        let text = || String::from_utf8(bytes.clone()).unwrap();
        let line = bytes.iter().position(|byte| *byte == b'\n').map_or(0, |at| at + 1);
        let commented = match writer {
            Writer::Obj | Writer::Xyz => [b"# nine\n".as_slice(), &bytes].concat(),
            Writer::PlyText | Writer::PlyLittle | Writer::PlyBig => {
                [&bytes[..line], b"comment made at nine\nobj_info x\n", &bytes[line..]].concat()
            }
            Writer::StlText => text().replace("solid body", "solid nine").into_bytes(),
            Writer::StlBinary => [[b'a'; 80].as_slice(), &bytes[80..]].concat(),
            Writer::Vrml1 | Writer::Vrml2 => [&bytes[..line], b"# nine\n", &bytes[line..]].concat(),
        };
        assert_ne!(commented, bytes, "{writer:?}");
        let found = fingerprint(&bytes, writer.format());
        assert!(found.is_some(), "{writer:?}");
        assert_eq!(fingerprint(&commented, writer.format()), found, "{writer:?}");
        let mut moved = scan.clone();
        moved.points[2].z = 1.0;
        assert_ne!(fingerprint(&writer.write(&moved), writer.format()), found, "{writer:?}");
    }
}

#[test]
fn a_file_in_which_nothing_is_read_has_no_fingerprint() {
    for text in ["# nothing\nmtllib v.mtl\n", "v 0 0 0\nv 1 0 0\nf 1 2 9\n", "v 0 0 0\nv 1"] {
        assert_eq!(fingerprint(text.as_bytes(), Format::Obj), None, "{text}");
    }
}
