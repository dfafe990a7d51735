//! `report.pdf`: the same bytes for the same record, every page with words, ids that cannot be taken
//! for others, records that lack what others have.

#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;
use std::io::Read;
use std::sync::LazyLock;

use gaiter_language::Language;
use gaiter_record::picture::figures;
use gaiter_record::report::{self, Print, ReportContent};
use gaiter_record::shape::ShapeFigures;
use gaiter_record::{Patient, Record, Source, SourceKind};
use gaiter_sizes::Garment;
use support::records::measured;

static RECORD: LazyLock<&Record> = LazyLock::new(|| &measured("f_average_clean").1);

const LANGUAGES: [Language; 2] = [Language::En, Language::De];

/// What a PDF of this program says, page by page: only what such a file needs is read.
pub struct Paper {
    /// Every object's bytes between `obj` and `endobj`, by number; streams unpacked behind them.
    objects: BTreeMap<u32, (String, Vec<u8>)>,
}

impl Paper {
    pub fn read(bytes: &[u8]) -> Paper {
        let mut objects = BTreeMap::new();
        for start in places(bytes, b" 0 obj\n") {
            let digits = bytes[..start].iter().rev().take_while(|byte| byte.is_ascii_digit());
            let digits: Vec<u8> = digits.copied().collect();
            let number: String = digits.iter().rev().map(|byte| char::from(*byte)).collect();
            let body = &bytes[start + 7..];
            let end = places(body, b"endobj").next().unwrap();
            let stream = places(&body[..end], b"\nstream\n").next();
            let unpacked = stream.map(|at| {
                let mut unpacked = Vec::new();
                flate2::read::ZlibDecoder::new(&body[at + 8..]).read_to_end(&mut unpacked).unwrap();
                unpacked
            });
            let head = String::from_utf8_lossy(&body[..stream.unwrap_or(end)]).into_owned();
            objects.insert(number.parse().unwrap(), (head, unpacked.unwrap_or_default()));
        }
        Paper { objects }
    }

    /// The number behind a key.
    fn referred(head: &str, key: &str) -> Option<u32> {
        head.split(key).nth(1)?.split_whitespace().next()?.parse().ok()
    }

    /// What the glyphs of a page's font mean, by its name on the page.
    fn letters(&self, page: &str, font: &str) -> BTreeMap<u16, char> {
        let font = Paper::referred(page, font).unwrap();
        let map = Paper::referred(&self.objects[&font].0, "/ToUnicode").unwrap();
        let map = String::from_utf8(self.objects[&map].1.clone()).unwrap();
        let pair = |line: &str| {
            let (glyph, letter) = line.strip_prefix('<')?.split_once("> <")?;
            let number = |text: &str| u16::from_str_radix(text.trim_end_matches('>'), 16).ok();
            Some((number(glyph)?, char::from_u32(number(letter)?.into())?))
        };
        map.lines().filter(|line| line.len() == 13).filter_map(pair).collect()
    }

    /// The words of every page, in the order in which they are drawn, each on a line.
    pub fn pages(&self) -> Vec<String> {
        let is_page = |head: &str| head.contains("/Type /Page\n");
        let pages = self.objects.values().filter(|(head, _)| is_page(head));
        pages.map(|(head, _)| self.words(head)).collect()
    }

    fn words(&self, page: &str) -> String {
        let content = &self.objects[&Paper::referred(page, "/Contents").unwrap()].1;
        let fonts = ["/R", "/B"].map(|name| self.letters(page, &format!("{name} ")));
        let mut words = String::new();
        let mut font = 0;
        let mut rest = content.as_slice();
        while let Some(end) = rest.iter().position(|byte| *byte == b'\n') {
            if rest.starts_with(b"/R ") || rest.starts_with(b"/B ") {
                font = usize::from(rest[1] == b'B');
            }
            if rest[0] == b'(' || rest[0] == b'<' && rest[1] != b'<' {
                let (string, length) = string(rest);
                for glyph in string.chunks_exact(2) {
                    words.push(fonts[font][&u16::from_be_bytes([glyph[0], glyph[1]])]);
                }
                words.push('\n');
                rest = &rest[length..];
                continue;
            }
            rest = &rest[end + 1..];
        }
        words
    }
}

/// A string of a PDF and how long it is there: `(…)` with its escapes, or `<…>` of hexadecimal digits.
fn string(bytes: &[u8]) -> (Vec<u8>, usize) {
    if bytes[0] == b'<' {
        let end = bytes.iter().position(|byte| *byte == b'>').unwrap();
        let digits = std::str::from_utf8(&bytes[1..end]).unwrap();
        let byte = |at: usize| u8::from_str_radix(&digits[at..at + 2], 16).unwrap();
        return ((0..digits.len()).step_by(2).map(byte).collect(), end + 1);
    }
    let (mut string, mut at, mut depth) = (Vec::new(), 1, 1);
    loop {
        match bytes[at] {
            b'\\' => {
                at += 1;
                string.push(match bytes[at] {
                    b'n' => b'\n',
                    b'r' => b'\r',
                    b't' => b'\t',
                    b'b' => 8,
                    b'f' => 12,
                    b'0'..=b'7' => {
                        let digits = std::str::from_utf8(&bytes[at..at + 3]).unwrap();
                        at += 2;
                        u8::from_str_radix(digits, 8).unwrap()
                    }
                    other => other,
                });
            }
            b'(' => {
                depth += 1;
                string.push(b'(');
            }
            b')' if depth == 1 => return (string, at + 1),
            b')' => {
                depth -= 1;
                string.push(b')');
            }
            other => string.push(other),
        }
        at += 1;
    }
}

fn places<'a>(bytes: &'a [u8], what: &'a [u8]) -> impl Iterator<Item = usize> + 'a {
    let found = bytes.windows(what.len()).enumerate().filter(move |(_, at)| *at == what);
    found.map(|(at, _)| at)
}

fn paper(record: &Record, language: Language) -> Vec<u8> {
    printed(record, language, Print { has_appendix: true, ..Print::default() })
}

fn printed(record: &Record, language: Language, print: Print) -> Vec<u8> {
    let content = ReportContent::from_record(record, language, &Garment::default());
    report::paper(&content.document(record, &figures::all(record, language)), print).unwrap()
}

/// The words of a paper on all its pages, lines joined.
fn said(record: &Record, language: Language) -> Vec<String> {
    Paper::read(&paper(record, language)).pages()
}

fn with_id(id: &str) -> Record {
    let sources = vec![Source::from_kind(SourceKind::FileName)];
    Record { patient: Some(Patient { id: id.to_owned(), sources }), ..RECORD.clone() }
}

#[test]
fn the_same_record_gives_the_same_bytes_and_they_are_small() {
    for language in LANGUAGES {
        let bytes = paper(&RECORD, language);
        assert!(bytes.starts_with(b"%PDF-1.7"));
        assert_eq!(bytes, paper(&RECORD, language));
        assert!(bytes.len() < 500_000, "{} bytes", bytes.len());
    }
}

#[test]
fn every_page_says_whose_it_is_and_which_of_how_many() {
    for (language, words) in LANGUAGES.into_iter().zip([["Page", "of"], ["Seite", "von"]]) {
        let pages = said(&with_id("P4711"), language);
        assert!(pages.len() > 3, "{} pages", pages.len());
        for (index, page) in pages.iter().enumerate() {
            let number = format!("{} {} {} {}", words[0], index + 1, words[1], pages.len());
            assert!(page.contains(&number) && page.contains("P4711"), "{page}");
        }
    }
}

#[test]
fn every_figure_of_the_landmarks_stands_there_with_the_record_s_digits() {
    for language in LANGUAGES {
        let words = said(&RECORD, language).concat();
        for leg in &RECORD.legs {
            for landmark in leg.landmarks.values() {
                let figures = [
                    Some(landmark.height_mm),
                    Some(landmark.along_axis_mm),
                    landmark.surface_length_mm,
                    Some(landmark.girth_tape_mm),
                    Some(landmark.girth_contour_mm),
                    landmark.height_sd_mm,
                    landmark.girth_sd_mm,
                ];
                for figure in figures.into_iter().flatten() {
                    let digits = serde_json::to_string(&figure).unwrap();
                    assert!(words.lines().any(|line| line == digits), "{digits} in {words}");
                }
            }
        }
    }
}

#[test]
fn hostile_ids_stand_whole_on_the_first_page_and_never_as_other_letters() {
    let without_breaks = |page: &str| page.replace('\n', "");
    let digits = "0123456789".repeat(50);
    for (id, shown) in [
        ("<script>alert('\"')</script>", "<script>alert('\"')</script>"),
        ("שלום1", "[U+05E9][U+05DC][U+05D5][U+05DD]1"),
        ("1\u{202E}32", "1[U+202E]32"),
        ("漢\u{301}e", "[U+6F22][U+0301]e"),
        (digits.as_str(), digits.as_str()),
    ] {
        let pages = said(&with_id(id), Language::De);
        assert!(without_breaks(&pages[0]).contains(shown), "{id}: {}", pages[0]);
        let is_told = |page: &String| {
            let page = without_breaks(page);
            page.contains(shown) || page.contains("… (ganz auf Seite 1)")
        };
        assert!(pages.iter().all(is_told), "{id}");
    }
}

#[test]
fn records_without_legs_levels_or_shapes_have_a_paper_too() {
    let no_legs = Record { legs: Vec::new(), differences: None, ..RECORD.clone() };
    let mut bare = RECORD.clone();
    bare.legs.truncate(1);
    bare.differences = None;
    for leg in &mut bare.legs {
        leg.landmarks.clear();
        leg.estimates.clear();
        leg.sections.clear();
        leg.shape = ShapeFigures::default();
    }
    for record in [no_legs, bare] {
        for language in LANGUAGES {
            let pages = said(&record, language);
            assert!(pages.iter().all(|page| page.lines().count() > 3));
        }
    }
}

#[test]
fn tables_that_go_over_pages_repeat_their_heads_and_lose_no_row() {
    let mut record = RECORD.clone();
    for leg in &mut record.legs {
        let slice = leg.volume.slices[3].clone();
        let slices = (0..100).map(|index| {
            let from_mm = 40.0 * f64::from(index);
            let ml = Some(1000.0 + f64::from(index));
            gaiter_record::chart::SliceFigures {
                from_mm,
                to_mm: from_mm + 40.0,
                ml,
                ..slice.clone()
            }
        });
        leg.volume.slices = slices.collect();
    }
    let pages = said(&record, Language::En);
    let with_head = pages.iter().filter(|page| page.contains("From–to (cm)")).count();
    assert!(with_head >= 2, "{with_head} pages");
    let words = pages.concat();
    for index in 0..100 {
        let row = format!("{}–{}\n", 4 * index, 4 * index + 4);
        assert!(words.contains(&row), "{row}");
    }
}

#[test]
fn figures_stand_at_their_own_leg_with_uncertainty_and_mark_and_every_note_says_what_to_do() {
    let mut record = RECORD.clone();
    for leg in &mut record.legs {
        let (times, doubt) = if leg.side == "left" { (2.0, "folds") } else { (1.0, "gap") };
        let c = leg.landmarks.get_mut("C").unwrap();
        (c.girth_tape_mm, c.height_mm) = (times * 200.0, times * 150.0);
        (c.girth_sd_mm, c.height_sd_mm) = (Some(times), Some(times * 3.0));
        c.doubts = vec![doubt.to_owned()];
        let e = leg.estimates.get_mut("E").unwrap();
        (e.girth_tape_mm, e.girth_sd_mm) = (times * 190.0, Some(times * 2.0));
        leg.landmarks.remove("G");
        leg.landmarks.get_mut("D").unwrap().girth_per_deg_mm = Some(0.9);
    }
    let words = said(&record, Language::En).concat();
    let heads = "Right leg\nLeft leg\nLevel\nc: girth\n(cm)\n";
    assert!(words.replace("\n\n", "\n").contains(heads), "{words}");
    let figures = "20.0 ± 0.2 ?\n15.0 ± 0.6 ?\n";
    assert!(words.contains(figures) && words.contains("40.0 ± 0.4 ?\n30.0 ± 1.2 ?\n"), "{words}");
    assert!(words.contains("Right leg – Skin partly not seen: C"), "{words}");
    assert!(words.contains("~19.0 ± 0.4\n") && words.contains("~38.0 ± 0.8\n"), "{words}");
    let words = words.replace('\n', " ");
    let content = ReportContent::from_record(&record, Language::En, &Garment::default());
    assert_eq!(content.verdict.parts[0].sentences, ["Measure by hand: right leg: C."]);
    assert!(words.contains("Measure by hand: right leg: C."), "{words}");
    let tilted = content.levels.tilted.unwrap();
    assert!(words.contains(&tilted), "{tilted:?} in {words}");
    assert!(content.notes.entries.len() >= 2);
    for note in &content.notes.entries {
        for text in [Some(&note.title), note.meaning.as_ref(), note.action.as_ref()] {
            assert!(words.contains(text.unwrap().as_str()), "{text:?} in {words}");
        }
    }
}

#[test]
fn without_the_appendix_the_paper_has_four_pages_at_most_and_no_table_in_mm() {
    for language in LANGUAGES {
        for paper in [report::Paper::A4, report::Paper::Letter] {
            let print = Print { paper, has_appendix: false };
            let pages = Paper::read(&printed(&RECORD, language, print)).pages();
            assert!(pages.len() <= 4, "{} pages on {paper:?}", pages.len());
            let appendix = language.text("report.pictures.appendix");
            assert!(pages.iter().all(|page| !page.contains(appendix)), "{pages:?}");
        }
    }
    assert!(said(&RECORD, Language::En).iter().any(|page| page.contains("Engineering figures")));
}

#[test]
fn a_letter_page_keeps_its_upper_edge_and_nothing_is_below_its_lower_one() {
    let print = Print { paper: report::Paper::Letter, has_appendix: true };
    let paper = Paper::read(&printed(&RECORD, Language::En, print));
    let pages = paper.objects.values().filter(|(head, _)| head.contains("/Type /Page\n"));
    let mut count = 0;
    for (head, _) in pages {
        let sides = head.split("/MediaBox [").nth(1).unwrap().split(']').next().unwrap();
        let sides: Vec<f64> = sides.split_whitespace().map(|side| side.parse().unwrap()).collect();
        assert!((sides[2] - sides[0] - 612.0).abs() < 0.02, "{sides:?}");
        assert!((sides[3] - sides[1] - 792.0).abs() < 0.02, "{sides:?}");
        let content = &paper.objects[&Paper::referred(head, "/Contents").unwrap()].1;
        let text = String::from_utf8_lossy(content);
        // Pictures have coordinates of their own, with y down.
        let lowest = text.lines().filter_map(|line| line.strip_suffix(" Tm"));
        let lowest = lowest.filter(|line| line.starts_with("1 0 0 1 "));
        let lowest = lowest.filter_map(|line| line.split_whitespace().nth(5)?.parse::<f64>().ok());
        assert!(lowest.fold(f64::MAX, f64::min) > sides[1] + 20.0, "text below the edge");
        count += 1;
    }
    assert!(count > 4);
}
