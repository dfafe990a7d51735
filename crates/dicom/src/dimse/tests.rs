//! A server of a few packets: what it is asked, and what is made of each answer.

use std::io::{self, Cursor};

use dicom_object::mem::InMemElement;
use dicom_ul::pdu::{
    AbortRQSource, AssociationAC, AssociationRJ, AssociationRJResult,
    AssociationRJServiceUserReason, AssociationRJSource, PDataValue, PDataValueType, Pdu,
    PresentationContextResult, PresentationContextResultReason, UserVariableItem, read_pdu,
    write_pdu,
};
use gaiter_record::ImagingRequest;
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::select;

use super::association::ANSWERS_MOST;
use super::*;
use crate::dataset::Syntax;
use crate::{DicomRules, withdrawal};

/// The longest packet that the server reads, bytes.
const READ_MOST: u32 = 4096;

/// What a server says, whatever it hears, and what it has heard.
struct Script {
    says: Cursor<Vec<u8>>,
    heard: Vec<u8>,
}

impl Script {
    fn new(packets: &[Pdu]) -> Script {
        let mut says = Vec::new();
        packets.iter().for_each(|packet| write_pdu(&mut says, packet).unwrap());
        Script { says: Cursor::new(says), heard: Vec::new() }
    }

    /// The commands and data sets that it has heard, each from all its parts.
    fn heard(&self) -> Vec<Vec<u8>> {
        let (mut messages, mut message) = (Vec::new(), Vec::new());
        for part in self.parts() {
            message.extend(part.data);
            if part.is_last {
                messages.push(std::mem::take(&mut message));
            }
        }
        messages
    }

    /// The parts of messages that it has heard.
    fn parts(&self) -> Vec<PDataValue> {
        let (mut rest, mut parts) = (&self.heard[..], Vec::new());
        while !rest.is_empty() {
            let length = 6 + u32::from_be_bytes(rest[2..6].try_into().unwrap()) as usize;
            assert!(length <= 6 + READ_MOST as usize);
            let packet = read_pdu(&rest[..length], 1 << 20, true).unwrap().unwrap();
            rest = &rest[length..];
            let Pdu::PData { data } = packet else { continue };
            parts.extend(data);
        }
        parts
    }
}

impl Read for Script {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        self.says.read(bytes)
    }
}

impl Write for Script {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.heard.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn titles() -> Titles {
    Titles { calling: AeTitle::new("GAITER").unwrap(), called: AeTitle::new("PACS").unwrap() }
}

/// The server takes these contexts.
fn accepts(ids: &[u8]) -> Pdu {
    let context = |id: &u8| PresentationContextResult {
        id: *id,
        reason: PresentationContextResultReason::Acceptance,
        transfer_syntax: Syntax::ExplicitLittleEndian.uid().to_owned(),
    };
    Pdu::AssociationAC(AssociationAC {
        protocol_version: 1,
        calling_ae_title: "GAITER".to_owned(),
        called_ae_title: "PACS".to_owned(),
        application_context_name: "1.2.840.10008.3.1.1.1".to_owned(),
        presentation_contexts: ids.iter().map(context).collect(),
        user_variables: vec![UserVariableItem::MaxLength(READ_MOST)],
    })
}

fn part(value_type: PDataValueType, data: Vec<u8>) -> PDataValue {
    PDataValue { presentation_context_id: 1, value_type, is_last: true, data }
}

/// An answer to a command, with a data set or without.
fn answer(command: u16, status: u16, set: Option<Dataset>) -> Pdu {
    let Dataset(told) = Dataset::new()
        .value(tags::COMMAND_FIELD, command | 0x8000)
        .value(tags::COMMAND_DATA_SET_TYPE, if set.is_some() { 1_u16 } else { 0x0101 })
        .value(tags::STATUS, status);
    let told = InMemDicomObject::command_from_element_iter(told);
    let told = Syntax::ImplicitLittleEndian.encoded(&told).unwrap();
    let set = set.map(|set| Syntax::ExplicitLittleEndian.encoded(&set.0).unwrap());
    let data = set.map(|set| part(PDataValueType::Data, set));
    Pdu::PData { data: [part(PDataValueType::Command, told)].into_iter().chain(data).collect() }
}

fn object() -> DicomObject {
    let study = Study::new("ab", "4711").unwrap();
    let series = study.series(crate::SopClass::Pdf, 0);
    let class = crate::SopClass::Pdf.uid().to_owned();
    let listed = [Listed { class, series, uid: "1.2".to_owned() }];
    let rules = DicomRules {
        issuer: "KIS".to_owned(),
        coding: "99GTR".to_owned(),
        language: Default::default(),
        attach: Vec::new(),
        names: false,
    };
    let now = "2026-11-27T08:00:00Z".parse().unwrap();
    withdrawal(&study, 1, &listed, "booth-1", &rules, now).unwrap()
}

fn echo(stream: impl Read + Write) -> Result<(), DimseFault> {
    Association::open(stream, &titles(), &[uids::VERIFICATION])?.echo()
}

fn search(packets: &[Pdu], most: usize) -> Result<Vec<InMemDicomObject>, DimseFault> {
    found(packets, most).map(|found| found.answers)
}

fn found(packets: &[Pdu], most: usize) -> Result<Found, DimseFault> {
    find(Script::new(packets), &titles(), Model::Worklist, &InMemDicomObject::new_empty(), most)
}

#[test]
fn an_object_is_sent_whole_and_what_the_server_says_decides_whether_it_is_stored() {
    for (status, reason) in [
        (0, None),
        (0xb000, None),
        (0x0107, None),
        (0x0111, None),
        (0xa700, Some(0xa700)),
        (0xc001, Some(0xc001)),
    ] {
        let mut server = Script::new(&[accepts(&[1]), answer(1, status, None)]);
        let refused = store(&mut server, &titles(), &object()).unwrap();
        assert_eq!(refused.map(|of| of.reason), reason, "{status:04X}");
        let heard = server.heard();
        let sent = Syntax::ExplicitLittleEndian.encoded(object().dataset()).unwrap();
        assert_eq!((heard.len(), &heard[1]), (2, &sent));
    }
}

/// The server takes these contexts, and refuses one for a reason; no transfer syntax follows.
fn refuses(ids: &[u8], id: u8, result: u8) -> Script {
    let mut server = Script::new(&[accepts(ids)]);
    let says = server.says.get_mut();
    says.extend([0x21, 0, 0, 4, id, 0, result, 0]);
    let length = says.len() as u32 - 6;
    says[2..6].copy_from_slice(&length.to_be_bytes());
    server
}

#[test]
fn an_object_whose_kind_the_server_does_not_know_is_not_stored_and_that_will_last() {
    for result in [3, 4] {
        let mut server = refuses(&[3], 1, result);
        let refused = store(&mut server, &titles(), &object()).unwrap().unwrap();
        assert_eq!(refused, NotStored { reason: 0x0122 });
        assert!(!refused.is_passing() && server.heard().is_empty());
    }
}

#[test]
fn a_server_that_refuses_a_kind_for_another_reason_or_everything_may_take_it_later() {
    for (mut server, expected) in [
        (refuses(&[3], 1, 1), 1),
        (refuses(&[3], 1, 2), 2),
        (refuses(&[3], 1, 9), 9),
        (refuses(&[], 1, 3), 3),
        (Script::new(&[accepts(&[3])]), 2),
    ] {
        let fault = store(&mut server, &titles(), &object()).unwrap_err();
        let DimseFault::NotAccepted { result, .. } = fault else { panic!("{fault}") };
        assert_eq!((result, server.heard().len()), (expected, 0));
    }
}

#[test]
fn a_refused_kind_needs_no_transfer_syntax() {
    let mut server = refuses(&[1], 3, 3);
    write_pdu(server.says.get_mut(), &answer(0x30, 0, None)).unwrap();
    let fault = reach(&mut server, &titles()).unwrap_err();
    let search = uids::STUDY_ROOT_QUERY_RETRIEVE_INFORMATION_MODEL_FIND;
    assert!(
        matches!(fault, DimseFault::NotAccepted { class, result: 3 } if class == search),
        "{fault}"
    );
}

#[test]
fn parts_have_even_lengths_also_for_a_server_that_takes_an_odd_one() {
    let Pdu::AssociationAC(mut accepted) = accepts(&[1]) else { panic!("it accepts") };
    accepted.user_variables = vec![UserVariableItem::MaxLength(127)];
    let mut server = Script::new(&[Pdu::AssociationAC(accepted), answer(1, 0, None)]);
    assert_eq!(store(&mut server, &titles(), &object()).unwrap(), None);
    let lengths: Vec<usize> = server.parts().iter().map(|part| part.data.len()).collect();
    assert!(lengths.len() > 4 && lengths.iter().all(|of| of % 2 == 0 && *of <= 120), "{lengths:?}");
}

#[test]
fn a_record_is_listed_by_its_own_series_whoever_else_has_objects_in_the_study() {
    let request = ImagingRequest::new("1.2.276.4711", "A1");
    let study = Study::new("ab", "4711").unwrap().answering(request.as_ref());
    let image = |uid: &str| {
        Dataset::new().text(tags::SOP_INSTANCE_UID, uid).text(tags::SOP_CLASS_UID, "1.9")
    };
    let (pending, done) = (|set| answer(0x20, 0xff00, Some(set)), answer(0x20, 0, None));
    let mut server = Script::new(&[
        accepts(&[1]),
        // It was withdrawn once, and has come back.
        pending(image("1.4")),
        done.clone(),
        pending(image("1.5")),
        pending(image("1.6")),
        done.clone(),
        done.clone(),
        done.clone(),
        pending(image("1.7")),
        done.clone(),
        done.clone(),
        done,
    ]);
    let found = listed(&mut server, &titles(), &study, 2).unwrap();
    let own = [vec![study.series(SopClass::Withdrawal, 0)], study.record_series(2)].concat();
    let found: Vec<_> = found.iter().map(|of| (of.series.as_str(), of.uid.as_str())).collect();
    let [mark, figures, again] = [0, 1, 4].map(|at| own[at].as_str());
    assert_eq!(found, [(mark, "1.4"), (figures, "1.5"), (figures, "1.6"), (again, "1.7")]);
    let queries = server.heard();
    let asked = |at: usize, tag| {
        text_of(&reading::read(Syntax::ExplicitLittleEndian, &queries[at]).unwrap(), tag)
    };
    // Marks, and twice figures, report and meshes; a message is a command and a data set.
    assert_eq!((own.len(), queries.len()), (7, 14));
    for (nth, series) in own.iter().enumerate() {
        let at = 2 * nth + 1;
        assert_eq!(asked(at, tags::QUERY_RETRIEVE_LEVEL).as_deref(), Some("IMAGE"));
        assert_eq!(asked(at, tags::SERIES_INSTANCE_UID).as_ref(), Some(series));
        assert_eq!(asked(at, tags::STUDY_INSTANCE_UID).as_deref(), Some("1.2.276.4711"));
    }
}

#[test]
fn answers_are_text_whatever_their_character_set_and_no_more_of_them_than_were_asked_for() {
    // U+00DC is DC in ISO 8859-1, and C3 9C in UTF-8.
    let name = |set: &str| {
        Dataset::new()
            .text(tags::SPECIFIC_CHARACTER_SET, set)
            .text(tags::PATIENT_NAME, "\u{dc}ber^A")
    };
    let packets = [
        accepts(&[1]),
        answer(0x20, 0xff00, Some(name("ISO_IR 100"))),
        answer(0x20, 0xff01, Some(name("ISO_IR 192"))),
        answer(0x20, 0, None),
    ];
    let found = search(&packets, 2).unwrap();
    let names: Vec<_> = found.iter().map(|of| text_of(of, tags::PATIENT_NAME).unwrap()).collect();
    assert_eq!(names, ["\u{dc}ber^A", "\u{dc}ber^A"]);
    assert!(matches!(search(&packets, 1), Err(DimseFault::TooMany { most: 1 })));
}

#[test]
fn an_answer_that_cannot_be_read_leaves_the_others_and_is_counted() {
    let of = |id: &str| answer(0x20, 0xff00, Some(Dataset::new().text(tags::PATIENT_ID, id)));
    let broken = |bytes: &[u8]| {
        let Pdu::PData { mut data } = of("4712") else { panic!("it is data") };
        data[1].data = bytes.to_vec();
        Pdu::PData { data }
    };
    let level = b"\x40\0\x00\x01SQ\0\0\xff\xff\xff\xff\xfe\xff\0\xe0\xff\xff\xff\xff";
    let packets = [
        accepts(&[1]),
        of("4711"),
        broken(b"\x10\0\x20\0LO\xff\xff4712"),
        broken(&level.repeat(9)),
        of("4713"),
        answer(0x20, 0, None),
    ];
    let Found { answers, unreadable } = found(&packets, 4).unwrap();
    let ids: Vec<_> = answers.iter().map(|of| text_of(of, tags::PATIENT_ID).unwrap()).collect();
    assert_eq!((ids, unreadable), (vec!["4711".to_owned(), "4713".to_owned()], 2));
    assert!(matches!(found(&packets, 3), Err(DimseFault::TooMany { most: 3 })));
}

#[test]
fn a_server_that_rejects_aborts_refuses_or_dies_is_told_apart() {
    let why = AssociationRJSource::ServiceUser(
        AssociationRJServiceUserReason::CallingAETitleNotRecognized,
    );
    let rejects = AssociationRJ { result: AssociationRJResult::Permanent, source: why };
    let aborts = Pdu::AbortRQ { source: AbortRQSource::ServiceUser };
    let fault = |packets: &[Pdu]| search(packets, 1).unwrap_err().to_string();
    let rejected = "the server rejects the association: calling AE title not recognized";
    assert_eq!(fault(&[Pdu::AssociationRJ(rejects)]), rejected);
    assert_eq!(fault(&[accepts(&[1]), aborts]), "the server aborts the association");
    let status = fault(&[accepts(&[1]), answer(0x20, 0xa700, None)]);
    assert_eq!(status, "the server answers with the status A700");
    let worklist = "the server does not accept the service 1.2.840.10008.5.1.4.31 (result 2)";
    assert_eq!(fault(&[accepts(&[])]), worklist);
    assert!(matches!(search(&[], 1), Err(DimseFault::Connection(_))));
    assert!(matches!(search(&[accepts(&[1])], 1), Err(DimseFault::Connection(_))));
    let other = answer(0x01, 0, None);
    assert!(matches!(search(&[accepts(&[1]), other], 1), Err(DimseFault::Unexpected)));
}

#[test]
fn an_end_for_a_reason_that_no_standard_has_is_an_end() {
    let end = |before: &[Pdu], packet: [u8; 10]| {
        let mut server = Script::new(before);
        server.says.get_mut().extend(packet);
        echo(&mut server).unwrap_err()
    };
    let told = end(&[], [3, 0, 0, 0, 0, 4, 0, 1, 2, 9]);
    assert!(told.is_an_end(), "{told}");
    let rejected = "the server rejects the association for the unknown reason 9 of the source 2";
    assert_eq!(told.to_string(), rejected);
    for before in [vec![], vec![accepts(&[1])]] {
        let told = end(&before, [7, 0, 0, 0, 0, 4, 0, 0, 2, 9]);
        assert!(matches!(told, DimseFault::Aborted), "{told}");
    }
}

#[test]
fn a_server_that_answers_and_lets_search_is_reached() {
    let answers = [accepts(&[1, 3]), answer(0x30, 0, None), answer(0x20, 0, None)];
    reach(Script::new(&answers), &titles()).unwrap();
    echo(Script::new(&answers)).unwrap();
    assert!(reach(Script::new(&[accepts(&[1]), answer(0x30, 0, None)]), &titles()).is_err());
}

#[test]
fn a_packet_longer_than_agreed_is_not_read() {
    let mut server = Script::new(&[accepts(&[1])]);
    server.says.get_mut().extend([4, 0, 0xff, 0xff, 0xff, 0xff]);
    let fault = echo(server).unwrap_err();
    assert!(matches!(fault, DimseFault::TooLong { bytes: 0xffff_ffff, .. }), "{fault}");
}

#[test]
fn an_element_that_claims_more_than_there_is_and_endless_nesting_are_not_read() {
    let read = |bytes: &[u8]| reading::read(Syntax::ExplicitLittleEndian, bytes);
    let claims = b"\x42\0\x11\0OB\0\0\xf0\xff\xff\x7fabcd";
    assert!(matches!(read(claims), Err(DimseFault::Cut)));
    let level = b"\x40\0\x00\x01SQ\0\0\xff\xff\xff\xff\xfe\xff\0\xe0\xff\xff\xff\xff";
    let fault = read(&level.repeat(10_000)).unwrap_err();
    assert!(matches!(fault, DimseFault::TooDeep { most: 8 }), "{fault}");
    let sent = Syntax::ExplicitLittleEndian.encoded(object().dataset()).unwrap();
    assert_eq!(read(&sent).unwrap().iter().count(), object().dataset().iter().count());
    for end in 1..sent.len() {
        // Between two elements the rest is whole.
        let _ = read(&sent[..end]);
    }
}

#[test]
fn answers_without_end_are_not_read_to_their_end() {
    let part = |is_last| PDataValue { is_last, ..part(PDataValueType::Command, vec![0; 4096]) };
    let endless = Pdu::PData { data: vec![part(false)] };
    let packets = [vec![accepts(&[1])], vec![endless; 20]].concat();
    let fault = search(&packets, 1).unwrap_err();
    assert!(matches!(fault, DimseFault::TooLong { most: 0x1_0000, .. }), "{fault}");

    let text = Dataset::new().text(tags::PATIENT_COMMENTS, "x".repeat(10_000));
    let one = answer(0x20, 0xff00, Some(text));
    let count = ANSWERS_MOST / 10_000 + 1;
    let packets = [vec![accepts(&[1])], vec![one; count]].concat();
    let fault = search(&packets, count).unwrap_err();
    assert!(matches!(fault, DimseFault::TooLong { most: ANSWERS_MOST, .. }), "{fault}");
}

/// As many elements, items and values as a data set has.
fn parts(set: &InMemDicomObject) -> usize {
    let of_element = |element: &InMemElement| match element.items() {
        Some(items) => items.iter().map(|item| 1 + parts(item)).sum::<usize>(),
        None => element.value().multiplicity() as usize,
    };
    set.iter().map(|element| 1 + of_element(element)).sum()
}

/// What data sets are made of, true or not: heads of elements in both syntaxes, items, delimiters, lengths, values.
fn piece() -> impl Strategy<Value = Vec<u8>> {
    const WORDS: &[&[u8]] = &[
        b"\x08\0\x05\0CS\x0a\0ISO_IR 192",
        b"\x10\0\x20\0LO\x04\0a\\b\\",
        b"\x10\0\x20\0\x04\0\0\0a\\b\\",
        b"\x40\0\x00\x01SQ\0\0\xff\xff\xff\xff",
        b"\x40\0\x00\x01\xff\xff\xff\xff",
        b"\x42\0\x11\0OB\0\0",
        b"\x09\0\x01\x10UN\0\0\xff\xff\xff\xff",
        b"\xe0\x7f\x10\0OW\0\0\xff\xff\xff\xff",
        b"\xfe\xff\0\xe0\xff\xff\xff\xff",
        b"\xfe\xff\0\xe0\x08\0\0\0",
        b"\xfe\xff\x0d\xe0\0\0\0\0",
        b"\xfe\xff\xdd\xe0\0\0\0\0",
    ];
    let length = (0..64_u32).prop_map(|length| length.to_le_bytes().to_vec());
    prop_oneof![
        4 => select(WORDS).prop_map(<[u8]>::to_vec),
        1 => length,
        1 => vec(any::<u8>(), 0..16),
    ]
}

proptest! {
    #[test]
    fn any_bytes_are_read_or_refused_and_what_is_read_has_no_more_parts_than_bytes(
        pieces in vec(piece(), 0..24),
        syntax in select(Syntax::ALL.to_vec()),
    ) {
        let bytes = pieces.concat();
        if let Ok(set) = reading::read(syntax, &bytes) {
            prop_assert!(parts(&set) <= bytes.len(), "{} of {}", parts(&set), bytes.len());
        }
    }

    #[test]
    fn any_packets_are_answers_or_faults(bytes in vec(any::<u8>(), 0..256), is_accepted: bool) {
        let before = if is_accepted { vec![accepts(&[1])] } else { Vec::new() };
        let mut server = Script::new(&before);
        server.says.get_mut().extend(bytes);
        let query = InMemDicomObject::new_empty();
        let _ = find(server, &titles(), Model::Worklist, &query, 10);
    }
}

#[test]
fn a_title_is_what_an_association_can_carry() {
    for text in ["GAITER", "A", "booth 1", "ABCDEFGHIJKLMNOP"] {
        assert_eq!(AeTitle::new(text).unwrap().as_str(), text);
    }
    for text in ["", " A", "A ", "ABCDEFGHIJKLMNOPQ", "A\\B", "\u{dc}", "A\n"] {
        assert_eq!(AeTitle::new(text), Err(TitleFault), "{text:?}");
    }
}
