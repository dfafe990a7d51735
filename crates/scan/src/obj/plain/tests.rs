//! The fast way through plain lines makes of a file what a slow reader makes of it, and what the slow
//! way through all other lines makes of it.

use std::collections::BTreeMap;

use nalgebra::Point3;
use proptest::prelude::*;

use super::super::super::{Format, Scan, read};

/// Numbers as exporters write them.
const NUMBERS: [&str; 12] = [
    "0",
    "-0.0",
    "1.5",
    "+2.25",
    "-3e2",
    "4.5E-1",
    "1234.5678",
    "0.30000000000000004",
    "12345678901234567890.5",
    "1e-310",
    "-27.1404",
    "007",
];

/// Lines that an exporter may write, right and wrong; a line end comes after each.
const LINES: [&str; 49] = [
    "v 1.5 -2 3e-4",
    "v  +1.5\t2   .5 ",
    "v 5. 6 7 0.1 0.2 0.3",
    "v 1 2 3 255 0 0 ",
    "v 1 2 3 1",
    "v 1,5 2 3",
    "v 1,5,5 2 3",
    "v 1 2",
    "v 1 2 \\",
    "v",
    "v 1 nan 3",
    "v 1 2 x",
    "v 1 2 3e999",
    "v 1 2 3 \\",
    "v 1 2 3\\",
    "v 1 2 3 # point",
    "v 1 2 3 \u{fc}",
    "v 1\u{b}2 3",
    "v 1\u{b}2\u{b}3\u{b}4 5 6",
    "v\t1\u{c}2 3",
    "v 1\u{a0}2 3 4",
    "v 1\u{a0}2\u{a0}3 4",
    "vn 0 0 1",
    "vt 0.5 0.5",
    "f 1 2 3",
    "f  3 2 5 ",
    "f 1/1/1 4/4/4 5/5/5",
    "f 1//2 2//3 3//4",
    "f 4/ 2/7 1/-1",
    "f 1/1 2/\\",
    "f 1 2 3 4",
    "f 1 2 3 4 5 ",
    "f -1 -2 -3",
    "f 1 1 2",
    "f 2 2 2 2",
    "f 1 2",
    "f 1\t2\t3",
    "f 1 2 3 # face",
    "f 1 2 3\\",
    "f 1 2 \\",
    "f 0 1 2",
    "f 1 2 13",
    "f 00000001 2 3",
    "f 1 2 12345678",
    "f 1,2,3",
    "f : 2 3",
    "",
    "# comment\\",
    "o M\u{fc}ller",
];

/// Points and faces that use them all, between which the lines under test may stand.
const POINTS: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 1 1\nv 2 0 0\nv 0 2 0\nv 0 0 2\n\
    v 2 2 2\nv 3 0 0\nv 0 3 0\nv 0 0 3\n";
const FACES: &str = "f 1 2 3\nf 3 2 4\nf 4 2 5\nf 5 6 7\nf 8 9 10\nf 10 11 12\n";

/// A face of the latest points, so that those among the lines under test are used.
const LATEST: &str = "f -1 -2 -3 -4 -5 -6\n";

/// The same text in which no line is plain, because a blank stands before each.
fn slowed(text: &str) -> String {
    let lines = text.replace("\r\n", "\n").replace('\r', "\n");
    let slowed = format!(" {}", lines.replace('\n', "\n "));
    slowed.strip_suffix("\n ").map(|whole| format!("{whole}\n")).unwrap_or(slowed)
}

/// A point or a polygon in one of many spellings.
fn spelled(keyword: &str, words: &[String], spelling: u8) -> String {
    match spelling {
        0 => format!("{keyword} {}\r\n", words.join(" ")),
        1 => format!("{keyword}\t{} \t\n", words.join("  ")),
        2 => format!("{keyword} {} \\\n {}\n", words[0], words[1..].join(" ")),
        3 => format!("# comment\n\n  {keyword} {}\n", words.join(" ")),
        4 => format!("vn 0 0 1\n{keyword} {}\r", words.join("\t")),
        5 if keyword == "v" => format!("v {} 0.5 0.5 1\n", words.join(" ")),
        5 => format!("f {}/1/2\n", words.join("//3 ")),
        _ => format!("{keyword} {}\n", words.join(" ")),
    }
}

/// Puts the points in the order of their first use; each place is one point, and triangles that use a
/// point twice go.
fn expected(points: &[[&str; 3]], polygons: &[Vec<usize>]) -> Scan {
    let mut numbers = BTreeMap::new();
    let mut scan = Scan { points: Vec::new(), triangles: Vec::new() };
    let number_of = |at: usize| points[at].map(|word| word.parse::<f64>().unwrap());
    let place = |at: usize| number_of(at).map(|value| (value + 0.0).to_bits());
    let fans = polygons.iter().flat_map(|p| p[1..].windows(2).map(|w| [p[0], w[0], w[1]]));
    let differ = |[a, b, c]: [u64; 3]| a != b && b != c && c != a;
    // A point that only a triangle without area uses has its turn all the same: it is the first at
    // its place.
    let used: Vec<_> = fans.filter(|fan| differ(fan.map(|at| at as u64))).collect();
    let mut firsts = BTreeMap::new();
    for &at in used.iter().flatten() {
        firsts.entry(place(at)).or_insert_with(|| Point3::from(number_of(at)));
    }
    let kept = |fan: &&[usize; 3]| {
        let [a, b, c] = fan.map(place);
        a != b && b != c && c != a
    };
    let in_turn: Vec<_> = used.iter().flatten().map(|&at| place(at)).collect();
    let remaining: Vec<_> = used.iter().filter(kept).flatten().map(|&at| place(at)).collect();
    for place in in_turn.iter().filter(|place| remaining.contains(place)) {
        if !numbers.contains_key(place) {
            numbers.insert(*place, scan.points.len() as u32);
            scan.points.push(firsts[place]);
        }
    }
    scan.triangles =
        used.iter().filter(kept).map(|fan| fan.map(|at| numbers[&place(at)])).collect();
    scan
}

#[test]
fn a_word_that_is_no_number_is_named_in_whichever_piece_it_stands() {
    const POINTS_PER_PIECE: usize = 1792;
    for count in [POINTS_PER_PIECE + 1, POINTS_PER_PIECE + 2] {
        let faces: String =
            (3..=count).map(|at| format!("f {} {} {at}\n", at - 2, at - 1)).collect();
        for wrong in [1, 2, POINTS_PER_PIECE - 1, POINTS_PER_PIECE, POINTS_PER_PIECE + 1, count] {
            let point = |at| if at == wrong { "v x 0 0\n".into() } else { format!("v {at} 0 0\n") };
            let text = (1..=count).map(point).collect::<String>() + &faces;
            let said = read(text.as_bytes(), Format::Obj).unwrap_err().to_string();
            assert_eq!(said, format!("line {wrong}: \"x\" is not a number"));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn plain_lines_are_read_as_all_others_are(
        lines in prop::collection::vec((0..LINES.len(), 0..8_u8), 0..6),
        ends_open in any::<bool>(),
    ) {
        let mut texts = [String::from(POINTS), String::from(FACES)];
        for (line, spelling) in lines {
            let end = ["\n", "\r\n", "\r", "\n"][usize::from(spelling / 2)];
            texts[usize::from(spelling % 2)] += &format!("{}{end}", LINES[line]);
        }
        let mut text = texts.concat() + LATEST;
        if ends_open {
            text.pop();
        }
        let (fast, slow) = (read(text.as_bytes(), Format::Obj), read(slowed(&text).as_bytes(), Format::Obj));
        prop_assert_eq!(fast, slow, "{:?}", text);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn a_mesh_in_any_spelling_is_the_mesh(
        points in prop::collection::vec([0..12_usize, 0..12, 0..12], 3..1200),
        polygons in prop::collection::vec(prop::collection::vec(any::<prop::sample::Index>(), 3..6), 0..40),
        spellings in prop::collection::vec(0..40_u8, 50),
        has_commas in any::<bool>(),
        counts_back in any::<bool>(),
    ) {
        let count = points.len();
        let points: Vec<_> = points.into_iter().map(|point| point.map(|at| NUMBERS[at])).collect();
        let strip = (2..count).map(|at| vec![at - 2, at - 1, at]);
        let random = polygons.iter().map(|p| p.iter().map(|at| at.index(count)).collect());
        let polygons: Vec<Vec<usize>> = strip.chain(random).collect();
        let mut spellings = spellings.into_iter().cycle();
        let mut text = String::new();
        for point in &points {
            let sign = if has_commas { "," } else { "." };
            let words = point.map(|word| word.replace('.', sign));
            text += &spelled("v", &words, spellings.next().unwrap());
        }
        for (number, polygon) in polygons.iter().enumerate() {
            let back = counts_back && number % 2 == 0;
            let word = |&at: &usize| {
                if back { format!("-{}", count - at) } else { (at + 1).to_string() }
            };
            let words: Vec<_> = polygon.iter().map(word).collect();
            text += &spelled("f", &words, spellings.next().unwrap());
        }
        let expected = expected(&points, &polygons);
        prop_assume!(!expected.triangles.is_empty());
        let found = read(text.as_bytes(), Format::Obj).unwrap();
        let bits = |scan: &Scan| -> Vec<[u64; 3]> {
            scan.points.iter().map(|p| [p.x, p.y, p.z].map(f64::to_bits)).collect()
        };
        prop_assert_eq!(bits(&found), bits(&expected));
        prop_assert_eq!(found.triangles, expected.triangles);
    }
}
