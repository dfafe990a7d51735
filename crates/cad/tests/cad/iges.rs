//! IGES files of a tube, of the solid within it and of their mirror images, read back by the few
//! rules of IGES 5.3.
#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;

use gaiter_cad::{End, FileHeader, Shape, iges};
use gaiter_spline::Surface;
use nalgebra::Vector3;
use support::tubes::{dented, tube};

use crate::HEADER;

/// What a solid is made of, in the order in which it may be written.
const KINDS: [(usize, usize); 11] = [
    (110, 4),
    (116, 2),
    (123, 4),
    (126, 3),
    (128, 1),
    (186, 1),
    (190, 2),
    (502, 1),
    (504, 1),
    (508, 3),
    (510, 3),
];

fn file(surface: &Surface, shape: Shape) -> String {
    String::from_utf8(iges::write(surface, shape, &HEADER).unwrap()).unwrap()
}

/// The lines of a section without letter and number, in the order of the file.
fn section(text: &str, letter: char) -> Vec<&str> {
    text.lines().filter(|line| line.as_bytes()[72] == letter as u8).map(|l| &l[..72]).collect()
}

/// A field of 8 columns of a directory line; blank is 0.
fn field(line: &str, place: usize) -> usize {
    line[8 * place..8 * (place + 1)].trim().parse().unwrap_or(0)
}

/// An entity: number, form, status and parameters, its own number not among them.
#[derive(Debug)]
struct Found {
    number: usize,
    form: usize,
    status: String,
    parameters: Vec<f64>,
}

impl Found {
    /// A parameter that is a whole number.
    fn at(&self, place: usize) -> usize {
        self.parameters[place] as usize
    }
}

/// The entities by the number of their first line.
fn entities(text: &str) -> BTreeMap<usize, Found> {
    let parameters = section(text, 'P');
    let entity = |(index, pair): (usize, &[&str])| {
        let (number, first, count) = (field(pair[0], 0), field(pair[0], 1), field(pair[1], 3));
        assert_eq!(field(pair[1], 0), number);
        let lines = &parameters[first - 1..first - 1 + count];
        let back = |line: &&str| line[64..].trim().parse::<usize>() == Ok(2 * index + 1);
        assert!(lines.iter().all(back), "a line of parameters belongs to another entity");
        let said: String = lines.iter().map(|line| line[..64].trim_end()).collect();
        let said = said.strip_suffix(';').unwrap().replace('D', "e");
        let mut numbers = said.split(',').map(|word| word.parse::<f64>().unwrap());
        assert_eq!(numbers.next(), Some(number as f64));
        let (form, status) = (field(pair[1], 4), pair[0][64..].to_owned());
        (2 * index + 1, Found { number, form, status, parameters: numbers.collect() })
    };
    section(text, 'D').chunks(2).enumerate().map(entity).collect()
}

fn of_number(entities: &BTreeMap<usize, Found>, number: usize) -> Vec<&Found> {
    entities.values().filter(|entity| entity.number == number).collect()
}

#[test]
fn every_line_has_80_columns_its_letter_and_its_number_and_the_last_one_counts_them() {
    for (turn, shape) in [(1.0, Shape::Tube), (-1.0, Shape::Solid)] {
        let text = file(&tube(turn).0, shape);
        assert!(text.is_ascii() && text.ends_with('\n'));
        let mut counts = [0; 5];
        let mut latest = 0;
        for line in text.lines() {
            assert_eq!(line.len(), 80, "{line}");
            let letter = "SGDPT".find(&line[72..73]).unwrap();
            assert!(letter >= latest, "sections are out of order");
            latest = letter;
            counts[letter] += 1;
            assert_eq!(line[73..].trim().parse(), Ok(counts[letter]), "{line}");
        }
        let [s, g, d, p, t] = counts;
        assert_eq!(t, 1);
        let said = format!("S{s:7}G{g:7}D{d:7}P{p:7}");
        assert_eq!(section(&text, 'T')[0].trim_end(), said);
        assert_eq!(d % 2, 0);
    }
}

#[test]
fn the_global_section_says_millimetres_and_version_5_3_and_nobody_s_name() {
    let text = file(&tube(1.0).0, Shape::Tube);
    let said: String = section(&text, 'G').concat();
    let said = said.trim_end().strip_suffix(';').unwrap();
    // The first parameter is the comma itself.
    let words: Vec<&str> =
        said.strip_prefix("1H,,").unwrap().split(',').map(str::trim_start).collect();
    let version = concat!("gaiter ", env!("CARGO_PKG_VERSION"));
    let system = format!("{}H{version}", version.len());
    assert_eq!(words[..5], ["1H;", "8Hleft leg", "9Hleft.step", &system, &system]);
    assert_eq!(words[5..10], ["32", "38", "6", "308", "15"]);
    assert_eq!(words[10..14], ["8Hleft leg", "1.0", "2", "2HMM"]);
    let largest: f64 = words[18].parse().unwrap();
    let points = tube(1.0).0;
    let coordinates = points.control_points().iter().flat_map(|p| p.iter().map(|x| x.abs()));
    assert_eq!(largest, coordinates.fold(0.0, f64::max));
    assert_eq!(words[19..23], ["", "", "11", "0"]);
    assert_eq!((words.len(), words[16], words[23]), (24, words[23], "15H19700101.000000"));
}

#[test]
fn a_tube_is_one_entity_128_whose_numbers_read_back_as_they_were() {
    for turn in [1.0, -1.0] {
        let surface = tube(turn).0;
        let entities = entities(&file(&surface, Shape::Tube));
        assert_eq!(entities.len(), 1);
        let found = &entities[&1];
        assert_eq!((found.number, found.form, &*found.status), (128, 0, "00000000"));
        // 10 rows of 12 + 3 control points: last indices, degrees, open, closed, polynomial, twice
        // not periodic.
        assert_eq!(found.parameters[..9], [9.0, 14.0, 3.0, 3.0, 0.0, 1.0, 1.0, 0.0, 0.0]);
        let (around, points) = surface.clamped_around();
        let along = surface.along().knots();
        let mut rest = found.parameters[9..].iter().copied();
        assert_eq!(rest.by_ref().take(14).collect::<Vec<_>>(), along);
        assert_eq!(rest.by_ref().take(19).collect::<Vec<_>>(), around);
        assert!(rest.by_ref().take(150).all(|weight| weight == 1.0));
        let coordinates: Vec<f64> = rest.by_ref().take(450).collect();
        for (place, xyz) in coordinates.chunks(3).enumerate() {
            // The first index runs fastest.
            let (row, column) = (place % 10, place / 10);
            assert_eq!(xyz, points[15 * row + column].coords.as_slice());
        }
        assert_eq!(rest.collect::<Vec<_>>(), [0.0, 1.0, 0.0, 1.0]);
    }
}

#[test]
fn a_solid_holds_each_kind_as_often_as_it_must_and_only_points_backwards() {
    let entities = entities(&file(&tube(1.0).0, Shape::Solid));
    let mut counts = BTreeMap::new();
    entities.values().for_each(|entity| *counts.entry(entity.number).or_insert(0) += 1);
    let expected: BTreeMap<usize, usize> = KINDS.into_iter().chain([(514, 1)]).collect();
    assert_eq!(counts, expected);
    for (own, entity) in &entities {
        let pointers: Vec<usize> = match entity.number {
            186 => vec![entity.at(0)],
            190 => vec![entity.at(0), entity.at(1), entity.at(2)],
            504 => (0..3).flat_map(|i| [1, 2, 4].map(|j| entity.at(5 * i + j))).collect(),
            510 => vec![entity.at(0), entity.at(3)],
            514 => [1, 3, 5].map(|i| entity.at(i)).to_vec(),
            _ => Vec::new(),
        };
        assert!(pointers.iter().all(|to| to < own && entities.contains_key(to)), "{entity:?}");
        // The solid alone stands for itself.
        assert_eq!(&entity.status[2..4] == "00", entity.number == 186, "{entity:?}");
    }
}

/// The sides of a loop: edge, whether along its own way, and the line in the surface's parameters.
fn sides(round: &Found) -> Vec<(usize, bool, Option<usize>)> {
    let mut at = 1;
    let mut sides = Vec::new();
    for _ in 0..round.at(0) {
        assert_eq!(round.at(at), 0, "an edge and not a vertex");
        let curves = round.at(at + 4);
        sides.push((
            round.at(at + 2),
            round.at(at + 3) == 1,
            (curves == 1).then(|| round.at(at + 6)),
        ));
        at += 5 + 2 * curves;
    }
    assert_eq!(at, round.parameters.len());
    sides
}

#[test]
fn faces_of_a_solid_run_along_their_edges_in_opposite_ways_seen_from_outside() {
    for turn in [1.0, -1.0] {
        let entities = entities(&file(&tube(turn).0, Shape::Solid));
        let shell = of_number(&entities, 514)[0];
        assert_eq!((shell.at(0), shell.form), (3, 1));
        let mut ways: BTreeMap<usize, Vec<bool>> = BTreeMap::new();
        let mut senses = Vec::new();
        for face in 0..3 {
            let (place, outward) = (shell.at(1 + 2 * face), shell.at(2 + 2 * face) == 1);
            let found = &entities[&place];
            senses.push((entities[&found.at(0)].number, outward));
            for (edge, own_way, _) in sides(&entities[&found.at(3)]) {
                ways.entry(edge).or_default().push(own_way == outward);
            }
        }
        // The tube's own normal is outward in the mirror image alone.
        assert_eq!(senses, [(128, turn < 0.0), (190, true), (190, true)]);
        assert_eq!(ways.len(), 3);
        assert!(ways.values().all(|ways| ways.len() == 2 && ways[0] != ways[1]), "{ways:?}");
    }
}

#[test]
fn each_edge_lies_on_its_surface_where_its_line_in_the_parameters_says() {
    let surface = tube(-1.0).0;
    let entities = entities(&file(&surface, Shape::Solid));
    let edges = of_number(&entities, 504)[0];
    let vertices = &of_number(&entities, 502)[0].parameters[1..];
    let vertex = |number: usize| Vector3::from_column_slice(&vertices[3 * (number - 1)..][..3]);
    let tube = of_number(&entities, 508).into_iter().find(|round| round.at(0) == 4).unwrap();
    for (edge, own_way, line) in sides(tube) {
        let ends = [edges.at(5 * (edge - 1) + 3), edges.at(5 * (edge - 1) + 5)].map(vertex);
        let [from, to] = if own_way { ends } else { [ends[1], ends[0]] };
        let line = &entities[&line.unwrap()].parameters;
        // Every edge runs in the direction of u or of v; a rim begins where it ends.
        assert_eq!(own_way, line[3] + line[4] > line[0] + line[1], "edge {edge}");
        for (place, uv) in [(from, &line[..2]), (to, &line[3..5])] {
            assert!((surface.point(uv[0], uv[1]).coords - place).norm() < 1e-9, "{uv:?}");
        }
    }
}

#[test]
fn planes_face_out_of_the_tube_and_hold_the_rims() {
    let (surface, axis) = tube(1.0);
    let entities = entities(&file(&surface, Shape::Solid));
    let way = (axis(1.0, 0.0) - axis(0.0, 0.0)).normalize();
    let rims: Vec<&Found> =
        of_number(&entities, 126).into_iter().filter(|curve| curve.at(2) == 1).collect();
    let planes = of_number(&entities, 190);
    for ((plane, rim), sense) in planes.into_iter().zip(rims).zip([-1.0, 1.0]) {
        let vector = |i: usize| Vector3::from_column_slice(&entities[&plane.at(i)].parameters[..3]);
        let (place, outward) = (vector(0), vector(1));
        assert!((outward.dot(&way) - sense).abs() < 1e-9);
        // 14 last index, degree, 4 flags; 19 knots; 15 weights.
        let points = &rim.parameters[6 + 19 + 15..][..45];
        for point in points.chunks(3) {
            let off = (Vector3::from_column_slice(point) - place).dot(&outward);
            assert!(off.abs() < 1e-6, "{off}");
        }
        assert_eq!(rim.parameters[87..], *outward.as_slice());
    }
}

#[test]
fn a_solid_has_plane_ends_or_a_reason() {
    let (surface, axis) = tube(1.0);
    let bent = dented(&surface, 3, (axis(1.0, 0.0) - axis(0.0, 0.0)) * 1e-5);
    let fault = iges::write(&bent, Shape::Solid, &HEADER).unwrap_err();
    assert_eq!(fault.end, End::First);
    assert!(iges::write(&bent, Shape::Tube, &HEADER).is_ok());
}

#[test]
fn the_same_surface_gives_the_same_bytes_and_a_name_cannot_break_them() {
    assert_eq!(file(&tube(1.0).0, Shape::Solid), file(&tube(1.0).0, Shape::Solid));
    let name = "a,b;\n\u{fc}".repeat(30);
    let header = FileHeader { file_name: &name, product: &name };
    let text = String::from_utf8(iges::write(&tube(1.0).0, Shape::Tube, &header).unwrap()).unwrap();
    assert!(text.lines().all(|line| line.len() == 80));
    assert_eq!(entities(&text).len(), 1);
}
