//! What a record becomes as DICOM: its objects are read back from their files, and hold the figures of the sheet, the
//! files byte by byte, and UIDs that are the same whenever the record is sent.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::collections::BTreeSet;

use dicom_dictionary_std::tags;
use dicom_object::{InMemDicomObject, Tag};
use gaiter_dicom::web::multipart;
use gaiter_dicom::{
    DicomObject, DicomRules, Listed, Person, Sent, SopClass, Study, objects, withdrawal,
};
use gaiter_language::Language;
use gaiter_leg::Side;
use gaiter_record::export::{What, export_figures, taken};
use gaiter_record::{Acquired, AcquiredFrom, ImagingRequest, Record, RecordFile};
use jiff::civil::date;
use support::records::{dicom_rules, marked, measured};

const FILES: [&str; 4] = ["report.pdf", "left.stl", "right.obj", "record.json"];

/// The data set of an object, from its file.
fn dataset(object: &DicomObject) -> InMemDicomObject {
    let file = object.file().unwrap();
    let read = dicom_object::from_reader(&file[..]).unwrap();
    assert_eq!(read.meta().transfer_syntax().trim_end_matches('\0'), "1.2.840.10008.1.2.1");
    assert_eq!(read.meta().media_storage_sop_instance_uid().trim_end_matches('\0'), object.uid());
    read.into_inner()
}

fn text(set: &InMemDicomObject, tag: Tag) -> String {
    set.element(tag).unwrap().to_str().unwrap().into_owned()
}

fn items(set: &InMemDicomObject, tag: Tag) -> &[InMemDicomObject] {
    set.get(tag).map_or(&[], |of| of.items().unwrap())
}

/// The value of the code in a sequence of one.
fn code(set: &InMemDicomObject, tag: Tag) -> String {
    text(&items(set, tag)[0], tags::CODE_VALUE)
}

/// The items below an item of the content.
fn below(item: &InMemDicomObject) -> &[InMemDicomObject] {
    items(item, tags::CONTENT_SEQUENCE)
}

fn number(item: &InMemDicomObject) -> String {
    text(&items(item, tags::MEASURED_VALUE_SEQUENCE)[0], tags::NUMERIC_VALUE)
}

/// All codes of a data set, at any depth: scheme, value and meaning of each.
fn codes(set: &InMemDicomObject) -> Vec<[String; 3]> {
    let own = set.get(tags::CODE_VALUE).map(|_| {
        [tags::CODING_SCHEME_DESIGNATOR, tags::CODE_VALUE, tags::CODE_MEANING]
            .map(|tag| text(set, tag))
    });
    let nested = set.iter().filter_map(|of| of.items()).flatten().flat_map(codes);
    own.into_iter().chain(nested).collect()
}

fn study() -> Study {
    Study::new("ab", "4711").unwrap()
}

fn sent(record: &Record, turn: u32) -> Vec<DicomObject> {
    sent_into(&study(), record, turn)
}

fn sent_into(study: &Study, record: &Record, turn: u32) -> Vec<DicomObject> {
    let rules = dicom_rules(&["report.pdf", "left.stl", "right.obj", "right.stl"]);
    sent_by(&rules, study, record, turn)
}

fn sent_by(rules: &DicomRules, study: &Study, record: &Record, turn: u32) -> Vec<DicomObject> {
    let file =
        |name: &str| RecordFile { name: name.to_owned(), bytes: format!("of {name}").into_bytes() };
    let files = FILES.map(file);
    let first_seen = "2026-11-26T19:21:02Z".parse().unwrap();
    let sent = Sent { record, files: &files, first_seen, study, person: None, turn };
    objects(&sent, rules)
}

/// What a server shows of an object.
fn shown(of: &DicomObject) -> Listed {
    let set = dataset(of);
    let [class, series, uid] =
        [tags::SOP_CLASS_UID, tags::SERIES_INSTANCE_UID, tags::SOP_INSTANCE_UID]
            .map(|tag| text(&set, tag));
    Listed { class, series, uid }
}

fn uids(objects: &[DicomObject]) -> BTreeSet<String> {
    objects.iter().map(|of| of.uid().to_owned()).collect()
}

#[test]
fn a_record_is_its_figures_and_the_files_that_are_named_and_there() {
    let made = sent(&marked(), 0);
    let classes: Vec<SopClass> = made.iter().map(DicomObject::class).collect();
    assert_eq!(classes, [SopClass::Measurements, SopClass::Pdf, SopClass::Stl, SopClass::Obj]);
    for object in &made {
        let set = dataset(object);
        let told = [
            tags::SOP_CLASS_UID,
            tags::SOP_INSTANCE_UID,
            tags::PATIENT_ID,
            tags::STUDY_INSTANCE_UID,
        ]
        .map(|tag| text(&set, tag));
        assert_eq!(told, [object.class().uid(), object.uid(), "4711", &study().uid()]);
        assert_eq!(text(&set, tags::SPECIFIC_CHARACTER_SET), "ISO_IR 192");
        for nameless in [tags::PATIENT_NAME, tags::PATIENT_BIRTH_DATE, tags::PATIENT_SEX] {
            assert_eq!(text(&set, nameless), "");
        }
    }
}

#[test]
fn a_document_is_its_file_byte_by_byte_whose_length_is_told_before_the_padding() {
    for (object, name) in sent(&marked(), 0).iter().skip(1).zip(FILES) {
        let set = dataset(object);
        let length = set.element(tags::ENCAPSULATED_DOCUMENT_LENGTH).unwrap();
        let length: usize = length.to_int().unwrap();
        let document = set.element(tags::ENCAPSULATED_DOCUMENT).unwrap().to_bytes().unwrap();
        assert_eq!(document[..length], *format!("of {name}").as_bytes());
    }
}

#[test]
fn the_report_holds_every_figure_of_the_sheet_to_the_last_digit_with_side_level_error_and_doubts() {
    let record = marked();
    let set = dataset(&sent(&record, 0)[0]);
    let measurements = below(&set)
        .iter()
        .find(|of| code(of, tags::CONCEPT_NAME_CODE_SEQUENCE) == "126010")
        .unwrap();
    let mut told = Vec::new();
    for group in below(measurements) {
        let site = below(group)
            .iter()
            .find(|of| code(of, tags::CONCEPT_NAME_CODE_SEQUENCE) == "363698007")
            .unwrap();
        let side = match code(&below(site)[0], tags::CONCEPT_CODE_SEQUENCE).as_str() {
            "24028007" => Side::Right,
            "7771000" => Side::Left,
            other => panic!("{other}"),
        };
        for item in below(group).iter().filter(|of| text(of, tags::VALUE_TYPE) == "NUM") {
            let of_kind = |kind: &str| {
                below(item)
                    .iter()
                    .filter(|of| text(of, tags::VALUE_TYPE) == kind)
                    .collect::<Vec<_>>()
            };
            let codes: Vec<String> =
                of_kind("CODE").iter().map(|of| code(of, tags::CONCEPT_CODE_SEQUENCE)).collect();
            let sd_cm = of_kind("NUM").first().map(|of| number(of));
            let doubts = of_kind("TEXT").len();
            told.push((
                side,
                code(item, tags::CONCEPT_NAME_CODE_SEQUENCE),
                codes,
                number(item),
                sd_cm,
                doubts,
            ));
        }
    }
    let expected: Vec<_> = export_figures(&record)
        .iter()
        .map(|figure| {
            let name = match figure.what {
                What::Girth => "74551000",
                What::Height => "121207",
            };
            let level = figure.level.name().to_owned();
            let by_hand = figure.is_by_hand.then(|| "by-hand".to_owned());
            let codes: Vec<String> = [level].into_iter().chain(by_hand).collect();
            let sd_cm = figure.sd_cm.map(|sd_cm| sd_cm.to_string());
            let cm = format!("{:.1}", figure.cm);
            (figure.side, name.to_owned(), codes, cm, sd_cm, figure.doubts.len())
        })
        .collect();
    assert!(told.len() > 12);
    assert_eq!(told, expected);
}

#[test]
fn the_report_names_its_language_by_tag_and_in_words() {
    for (language, tag, meaning) in
        [(Language::En, "en", "English"), (Language::De, "de", "German")]
    {
        let rules = DicomRules { language, ..dicom_rules(&[]) };
        let found = codes(&dataset(&sent_by(&rules, &study(), &marked(), 0)[0]));
        let expected = ["RFC5646", tag, meaning].map(str::to_owned);
        assert!(found.contains(&expected), "{found:?}");
    }
}

#[test]
fn no_code_is_longer_than_its_representation_allows() {
    for record in [&marked(), &measured("m_average_clean").1] {
        for code in sent(record, 0).iter().flat_map(|object| codes(&dataset(object))) {
            let lengths = code.each_ref().map(|text| text.chars().count());
            let fits =
                lengths.into_iter().zip([16, 16, 64]).all(|(own, most)| (1..=most).contains(&own));
            assert!(fits, "{code:?}");
        }
    }
}

#[test]
fn the_same_record_is_the_same_objects_and_another_revision_or_turn_shares_none() {
    let record = marked();
    let files = || sent(&record, 0).iter().map(|of| of.file().unwrap()).collect::<Vec<_>>();
    assert!(files() == files());
    let first = uids(&sent(&record, 0));
    assert_eq!(first.len(), 4);
    let later = Record { revision: record.revision + 1, ..record.clone() };
    for others in [uids(&sent(&later, 0)), uids(&sent(&record, 1))] {
        assert!(first.is_disjoint(&others));
    }
}

#[test]
fn every_object_stands_in_the_study_of_the_request_that_the_scan_answers_with_its_number() {
    // Half past midnight by the clock at the scanner.
    let at = "2026-11-26T23:30:00Z".parse().unwrap();
    let acquired = Acquired { utc_offset_min: Some(60), ..Acquired::new(at, AcquiredFrom::Press) };
    let record = Record { acquired: Some(acquired), ..marked() };
    let answering =
        |number| study().answering(ImagingRequest::new("1.2.276.4711", number).as_ref());
    for (number, study) in [("ACC0815", answering("ACC0815")), ("", answering("")), ("", study())] {
        let made = sent_into(&study, &record, 0);
        let description = text(&dataset(&made[0]), tags::STUDY_DESCRIPTION);
        assert!(!description.is_empty());
        let listed: Vec<Listed> = made.iter().map(shown).collect();
        let now = "2026-11-27T08:00:00Z".parse().unwrap();
        let (of_scan, rules) = (study.clone().taken_at(taken(&record, now)), dicom_rules(&[]));
        let mark = withdrawal(&of_scan, 1, &listed, "booth-1", &rules, now).unwrap();
        for object in made.iter().chain([&mark]) {
            let set = dataset(object);
            assert_eq!(text(&set, tags::STUDY_INSTANCE_UID), study.uid());
            assert_eq!(text(&set, tags::ACCESSION_NUMBER), number);
            let when = [tags::STUDY_DATE, tags::STUDY_TIME, tags::TIMEZONE_OFFSET_FROM_UTC];
            assert_eq!(when.map(|tag| text(&set, tag)), ["20261127", "003000", "+0100"]);
            assert_eq!(text(&set, tags::STUDY_DESCRIPTION), description);
        }
        assert_eq!(text(&dataset(&mark), tags::CONTENT_TIME), "090000");
        // The report alone answers a request.
        let requests: Vec<_> = made
            .iter()
            .flat_map(|of| items(&dataset(of), tags::REFERENCED_REQUEST_SEQUENCE).to_vec())
            .map(|of| [tags::STUDY_INSTANCE_UID, tags::ACCESSION_NUMBER].map(|tag| text(&of, tag)))
            .collect();
        let is_theirs = study.uid() == "1.2.276.4711";
        let expected = is_theirs.then(|| [study.uid(), number.to_owned()]);
        assert_eq!(requests, expected.into_iter().collect::<Vec<_>>());
    }
    let elsewhere = uids(&sent_into(&answering("ACC0815"), &record, 0));
    assert!(uids(&sent(&record, 0)).is_disjoint(&elsewhere));
}

#[test]
fn objects_say_who_the_patient_is_only_where_the_rules_allow_it() {
    let (record, study) = (marked(), study());
    let person = Person { name: "Grünwald^Jörg", birth_date: Some(date(1950, 1, 2)), sex: "M" };
    let files = [RecordFile { name: "report.pdf".to_owned(), bytes: b"%PDF-1.7".to_vec() }];
    let first_seen = "2026-11-26T19:21:02Z".parse().unwrap();
    for (names, expected) in [(true, ["Grünwald^Jörg", "19500102", "M"]), (false, [""; 3])] {
        let rules = DicomRules { names, ..dicom_rules(&["report.pdf"]) };
        let sent = Sent {
            record: &record,
            files: &files,
            first_seen,
            study: &study,
            person: Some(person),
            turn: 0,
        };
        assert!(!format!("{sent:?}").contains("Jörg"), "logs get no names");
        let made = objects(&sent, &rules);
        for object in &made {
            let set = dataset(object);
            let told = [tags::PATIENT_NAME, tags::PATIENT_BIRTH_DATE, tags::PATIENT_SEX]
                .map(|tag| text(&set, tag));
            assert_eq!(told, expected);
        }
        let nameless = objects(&Sent { person: None, ..sent }, &rules);
        assert_eq!(uids(&made), uids(&nameless), "a name makes no other object");
    }
}

#[test]
fn objects_of_others_in_the_study_neither_count_nor_are_withdrawn() {
    let study = study().answering(ImagingRequest::new("1.2.276.4711", "A1").as_ref());
    let other = |class: SopClass, uid: &str| Listed {
        class: class.uid().to_owned(),
        series: "1.2.3".to_owned(),
        uid: uid.to_owned(),
    };
    let others = [other(SopClass::Withdrawal, "1.2.3.1"), other(SopClass::Pdf, "1.2.3.2")];
    let (rules, now) = (dicom_rules(&[]), "2026-11-27T08:00:00Z".parse().unwrap());
    assert!(withdrawal(&study, 1, &others, "booth-1", &rules, now).is_none());
    let made = sent_into(&study, &marked(), 0);
    // Another scan of the patient answers the same request.
    let request = ImagingRequest::new("1.2.276.4711", "A1");
    let second = Study::new("ac", "4711").unwrap().answering(request.as_ref());
    let second = sent_into(&second, &marked(), 0);
    let ours = made.iter().map(shown);
    let listed: Vec<Listed> =
        others.into_iter().chain(second.iter().map(shown)).chain(ours).collect();
    assert!(!study.shows_withdrawal(&listed));
    let own: BTreeSet<String> =
        study.shown(1, &listed).into_iter().map(|of| of.uid.clone()).collect();
    assert_eq!(own, uids(&made));
}

#[test]
fn a_withdrawal_names_what_is_shown_once_and_what_appears_later_with_it() {
    let late: Vec<Listed> = sent(&marked(), 1).iter().map(shown).collect();
    let mut listed: Vec<Listed> = sent(&marked(), 0).iter().map(shown).collect();
    let rules = dicom_rules(&[]);
    let now = "2026-11-27T08:00:00Z".parse().unwrap();
    let withdrawal =
        |turns, listed: &[Listed]| withdrawal(&study(), turns, listed, "booth-1", &rules, now);
    let withdrawn = withdrawal(2, &listed).unwrap();
    let set = dataset(&withdrawn);
    assert_eq!(
        (
            code(&set, tags::CONCEPT_NAME_CODE_SEQUENCE).as_str(),
            text(&set, tags::MODALITY).as_str()
        ),
        ("113038", "KO")
    );
    let named: BTreeSet<String> = below(&set)
        .iter()
        .map(|item| {
            text(&items(item, tags::REFERENCED_SOP_SEQUENCE)[0], tags::REFERENCED_SOP_INSTANCE_UID)
        })
        .collect();
    assert_eq!(named, uids(&sent(&marked(), 0)));
    listed.push(shown(&withdrawn));
    listed.reverse();
    assert!(withdrawal(2, &listed).is_none());
    listed.extend(late);
    assert!(withdrawal(1, &listed).is_none(), "of the first turn nothing is new");
    let again = withdrawal(2, &listed).unwrap();
    assert_ne!(again.uid(), withdrawn.uid());
    listed.push(shown(&again));
    assert!(withdrawal(2, &listed).is_none());
}

#[test]
fn a_request_holds_an_object_as_its_file() {
    for object in sent(&marked(), 0) {
        let (media_type, body) = multipart(&object).unwrap();
        let boundary = media_type.rsplit_once("boundary=").unwrap().1;
        let head = format!("--{boundary}\r\nContent-Type: application/dicom\r\n\r\n");
        let end = format!("\r\n--{boundary}--\r\n");
        let expected = [head.as_bytes(), &object.file().unwrap(), end.as_bytes()].concat();
        assert!(media_type.starts_with("multipart/related; type=\"application/dicom\"; "));
        assert_eq!(body, expected);
    }
}
