//! What a record becomes as HL7 v2: its segments, figures and signs, its correction and its withdrawal.

#![allow(clippy::unwrap_used)]

use gaiter_language::Language;
use gaiter_record::export::export_figures;
use gaiter_record::hl7::{Charset, Hl7Rules, PdfForm, control_id, observed, result, withdrawal};
use gaiter_record::{ImagingRequest, Patient, Record, Source, SourceKind};
use jiff::Timestamp;
use proptest::prelude::*;

use support::records::{hl7_rules, marked};

fn rules() -> Hl7Rules {
    hl7_rules("KIS")
}

/// A record with every mark, for this patient.
fn record_of(patient: &str) -> Record {
    let mut record = marked();
    record.station = Some("booth-1".to_owned());
    let sources = vec![Source::from_kind(SourceKind::Reader)];
    record.patient = Some(Patient { id: patient.to_owned(), sources });
    record
}

fn first_seen() -> Timestamp {
    "2026-11-26T19:21:02Z".parse().unwrap()
}

fn now() -> Timestamp {
    "2026-11-26T19:21:05Z".parse().unwrap()
}

fn control_of(record: &Record) -> String {
    control_id("booth-1", &record.scan.sha256, "4711", record.revision, false)
}

fn written(record: &Record, rules: &Hl7Rules) -> Vec<u8> {
    let control = control_of(record);
    result(&control, record, Some(b"%PDF-1.7"), &[], rules, first_seen(), now()).unwrap()
}

/// The fields of each segment.
fn fields(message: &[u8]) -> Vec<Vec<String>> {
    let text = String::from_utf8(message.to_vec()).unwrap();
    let segments = text.strip_suffix('\r').unwrap().split('\r');
    segments.map(|segment| segment.split('|').map(str::to_owned).collect()).collect()
}

fn segments_named<'a>(message: &'a [Vec<String>], name: &str) -> Vec<&'a Vec<String>> {
    message.iter().filter(|segment| segment[0] == name).collect()
}

/// The codes of the observations, in their order.
fn codes(message: &[Vec<String>]) -> Vec<String> {
    let observations = segments_named(message, "OBX").into_iter();
    observations.map(|obx| obx[3].split('^').next().unwrap().to_owned()).collect()
}

#[test]
fn head_patient_and_order_are_those_of_the_documented_message() {
    let record = record_of("4711");
    let text = String::from_utf8(written(&record, &rules())).unwrap();
    let segments: Vec<&str> = text.split('\r').collect();
    let control = control_of(&record);
    let filler = &record.scan.sha256[..20];
    assert_eq!(
        segments[0],
        format!(
            "MSH|^~\\&|GAITER|booth-1|KIS|House \\T\\ Co|20261126192105+0000||ORU^R01^ORU_R01|{control}|P|2.5\
             |||AL|NE||UNICODE UTF-8"
        )
    );
    assert_eq!(segments[1], "PID|1||4711^^^KIS^PI||^^^^^^U");
    assert_eq!(
        segments[2],
        format!(
            "OBR|1||{filler}^GAITER|LEGS^Leg measures for compression garments^99GTR|||20261126192102+0000\
             |||||||||||||||20261126192105+0000|||F"
        )
    );
    let c =
        "cC-R^Girth at C, right leg^99GTR|1|22.4|cm^cm^UCUM|||||F|||20261126192102+0000||||booth-1";
    let at = segments.iter().position(|of| of.ends_with(c)).unwrap();
    assert!(segments[at].starts_with("OBX|") && segments[at].contains("|NM|"), "{}", segments[at]);
    assert_eq!(segments[at + 1], "NTE|1|L|In doubt, check by hand: Skin partly not seen");
    assert_eq!(segments[at + 2], "NTE|2|L|In doubt, check by hand: never-heard-of");
    let b = segments.iter().position(|of| of.contains("|cB-R^")).unwrap();
    assert_eq!(segments[b + 1], "NTE|1|L|Set by hand");
    assert!(text.ends_with('\r'));
}

#[test]
fn a_result_holds_the_figures_that_go_out_in_their_order_then_verdict_and_pdf() {
    let record = record_of("4711");
    let message = fields(&written(&record, &rules()));
    let observations = segments_named(&message, "OBX");
    for (number, obx) in observations.iter().enumerate() {
        assert_eq!(obx[1], (number + 1).to_string());
        assert_eq!((obx[11].as_str(), obx[14].as_str()), ("F", "20261126192102+0000"));
    }
    let figures = export_figures(&record);
    assert!(figures.len() > 12);
    let told: Vec<&str> =
        observations.iter().map(|obx| obx[5].as_str()).take(figures.len()).collect();
    let expected: Vec<String> =
        figures.iter().map(|figure| serde_json::to_string(&figure.cm).unwrap()).collect();
    assert_eq!(told, expected);
    assert_eq!(codes(&message), observed(&record, true));
    let kinds: Vec<&str> = observations.iter().map(|obx| obx[2].as_str()).collect();
    let expected = [vec!["NM"; figures.len()], vec!["TX", "ED"]].concat();
    assert_eq!(kinds, expected);
    assert!(!observations[figures.len()][5].is_empty());
}

#[test]
fn the_pdf_is_sent_in_the_form_of_the_receiver_or_not_at_all() {
    let record = record_of("4711");
    let last = |pdf: PdfForm| {
        let message = fields(&written(&record, &Hl7Rules { pdf, ..rules() }));
        message.last().unwrap()[5].clone()
    };
    assert_eq!(last(PdfForm::MediaType), "^application^pdf^Base64^JVBERi0xLjc=");
    assert_eq!(last(PdfForm::Plain), "^PDF^^Base64^JVBERi0xLjc=");
    let without = fields(&written(&record, &Hl7Rules { pdf: PdfForm::None, ..rules() }));
    assert_eq!(codes(&without), observed(&record, false));
    let none = result("id", &record, None, &[], &rules(), first_seen(), now()).unwrap();
    assert_eq!(codes(&fields(&none)), observed(&record, false));
}

#[test]
fn a_message_that_is_sent_again_differs_in_its_time_alone() {
    let record = record_of("4711");
    let later = "2026-11-27T08:00:00Z".parse().unwrap();
    let [first, again] = [now(), later].map(|now| {
        let pdf = Some(&b"%PDF-1.7"[..]);
        let bytes = result("id", &record, pdf, &[], &rules(), first_seen(), now).unwrap();
        String::from_utf8(bytes).unwrap()
    });
    assert_ne!(first, again);
    assert_eq!(first.replace("20261126192105+0000", "20261127080000+0000"), again);
}

#[test]
fn a_control_id_is_that_of_one_message_alone_and_has_room() {
    let first = control_id("booth-1", "ab", "4711", 1, false);
    assert_eq!((first.len(), first.contains("4711")), (20, false));
    assert_eq!(first, control_id("booth-1", "ab", "4711", 1, false));
    for other in [
        control_id("booth-2", "ab", "4711", 1, false),
        control_id("booth-1", "ac", "4711", 1, false),
        control_id("booth-1", "ab", "4712", 1, false),
        control_id("booth-1", "ab", "4711", 2, false),
        control_id("booth-1", "ab", "4711", 1, true),
    ] {
        assert_ne!(first, other);
    }
}

#[test]
fn a_later_revision_is_a_correction_of_the_same_order() {
    let record = record_of("4711");
    let first = fields(&written(&record, &rules()));
    let later = fields(&written(&Record { revision: 2, ..record }, &rules()));
    assert!(segments_named(&later, "OBX").iter().all(|obx| obx[11] == "C"));
    assert_eq!(segments_named(&later, "OBR")[0][25], "C");
    assert_eq!(segments_named(&later, "OBR")[0][3], segments_named(&first, "OBR")[0][3]);
    assert_ne!(segments_named(&later, "MSH")[0][9], segments_named(&first, "MSH")[0][9]);
}

#[test]
fn what_a_correction_no_longer_holds_is_marked_as_wrong() {
    let record = Record { revision: 2, ..record_of("4711") };
    let gone = ["cC-R".to_owned(), "lY-L".to_owned()];
    let bytes = result("id", &record, None, &gone, &rules(), first_seen(), now()).unwrap();
    let message = fields(&bytes);
    let observations = segments_named(&message, "OBX");
    let (kept, wrong) = observations.split_at(observations.len() - gone.len());
    assert_eq!(codes(&message), [observed(&record, false), gone.to_vec()].concat());
    assert!(kept.iter().all(|obx| obx[11] == "C" && !obx[5].is_empty()));
    assert!(wrong.iter().all(|obx| obx[11] == "W" && obx[5].is_empty()));
    for (number, obx) in observations.iter().enumerate() {
        assert_eq!(obx[1], (number + 1).to_string());
    }
}

#[test]
fn a_withdrawal_marks_all_that_was_sent_as_wrong_and_has_no_value() {
    let record = record_of("4711");
    let first = fields(&written(&record, &rules()));
    let observed = observed(&record, true);
    let scan = &record.scan.sha256;
    let bytes = withdrawal("id", scan, "4711", &observed, &rules(), now());
    let withdrawn = fields(&bytes);
    assert_eq!(codes(&withdrawn), codes(&first));
    assert!(
        segments_named(&withdrawn, "OBX").iter().all(|obx| obx[11] == "W" && obx[5].is_empty())
    );
    let groups = |message: &[Vec<String>]| -> Vec<String> {
        segments_named(message, "OBX").into_iter().map(|obx| obx[4].clone()).collect()
    };
    assert_eq!(groups(&withdrawn), groups(&first));
    // Table 0123 has no W: the order's result is corrected.
    assert_eq!(segments_named(&withdrawn, "OBR")[0][25], "C");
    assert_eq!(segments_named(&withdrawn, "OBR")[0][3], segments_named(&first, "OBR")[0][3]);
    assert_eq!(segments_named(&withdrawn, "PID"), segments_named(&first, "PID"));
    assert_eq!(segments_named(&withdrawn, "MSH")[0][9], "id");
}

#[test]
fn the_station_is_told_except_in_the_version_that_has_no_place_for_it() {
    let record = record_of("4711");
    let observation = |version: &str| {
        let rules = Hl7Rules { version: version.to_owned(), ..rules() };
        segments_named(&fields(&written(&record, &rules)), "OBX")[0].clone()
    };
    assert_eq!(observation("2.4")[18], "booth-1");
    assert_eq!(observation("2.3.1").len(), 15);
}

#[test]
fn a_message_in_8859_1_is_so_but_for_a_patient_whose_id_it_cannot_write() {
    let latin = Hl7Rules { charset: Charset::Latin1, language: Language::De, ..rules() };
    let bytes = written(&record_of("4711"), &latin);
    assert!(String::from_utf8(bytes.clone()).is_err(), "umlauts are single bytes");
    let text: String = bytes.iter().copied().map(char::from).collect();
    assert!(text.contains("|8859/1\r") && text.contains("Höhe von C über dem Boden, rechtes Bein"));
    let message = fields(&written(&record_of("Ł1"), &latin));
    assert_eq!(message[0][17], "UNICODE UTF-8");
    assert_eq!(message[1][3], "Ł1^^^KIS^PI");
    let other = Hl7Rules { authority: "Łódź".to_owned(), ..latin };
    let bytes = written(&record_of("4711"), &other);
    let text: String = bytes.iter().copied().map(char::from).collect();
    assert!(
        text.contains("PID|1||4711^^^?ód?^PI|"),
        "a letter that the set lacks is a question mark"
    );
}

#[test]
fn a_record_without_a_patient_is_no_result() {
    let record = Record { patient: None, ..record_of("4711") };
    assert_eq!(result("id", &record, None, &[], &rules(), first_seen(), now()), None);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn no_name_of_the_house_changes_the_shape_of_a_message(
        names in prop::array::uniform4(".{0,30}"),
        authority in ".{0,30}",
        patient in ".{1,30}",
    ) {
        let [a, b, c, d] = names;
        let named = Hl7Rules { sender: [a, b], receiver: [c, d], authority, ..rules() };
        let shape = |message: &[u8]| -> Vec<usize> {
            let text = String::from_utf8(message.to_vec()).unwrap();
            let segments = text.split('\r');
            let parts = |segment: &str| segment.matches(['|', '^', '&', '~', '\n', '\u{b}']).count();
            segments.map(parts).collect()
        };
        let plain = Hl7Rules { receiver: ["KIS".to_owned(), "HOUSE".to_owned()], ..rules() };
        let expected = shape(&written(&record_of("4711"), &plain));
        prop_assert_eq!(shape(&written(&record_of(&patient), &named)), expected);
    }
}

#[test]
fn a_result_has_the_accession_number_of_the_request_that_it_answers() {
    let mut record = record_of("4711");
    let request = ImagingRequest::new("1.2.276.4242", "ACC|0815");
    let sources = vec![Source::from_kind(SourceKind::Reader).with_request(request)];
    record.patient = Some(Patient { id: "4711".to_owned(), sources });
    let message = fields(&written(&record, &rules()));
    let order = segments_named(&message, "OBR")[0];
    assert_eq!((order[18].as_str(), order[22].as_str()), ("ACC\\F\\0815", "20261126192105+0000"));
    assert_eq!(order[25], "F");
}
