//! Any bytes as what a server says: as packets of an association, or as the data set of an answer in either syntax.
#![no_main]

use std::io::{self, Cursor, Read, Write};

use dicom_ul::pdu::{
    AssociationAC, Pdu, PresentationContextResult, PresentationContextResultReason, write_pdu,
};
use gaiter_dicom::InMemDicomObject;
use gaiter_dicom::dimse::{AeTitle, Model, Titles, find};

/// Explicit and Implicit VR Little Endian.
const SYNTAXES: [&str; 2] = ["1.2.840.10008.1.2.1", "1.2.840.10008.1.2"];

// Kinds of parts (PS3.8, E.2).
const DATA: u8 = 0;
const COMMAND: u8 = 1;
const LAST: u8 = 2;

/// The longest part, bytes.
const PART_MOST: usize = 8192;

/// Answers that are asked for.
const ANSWERS: usize = 100;

/// A server that says this, whatever it hears.
struct Server(Cursor<Vec<u8>>);

impl Read for Server {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        self.0.read(bytes)
    }
}

impl Write for Server {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// The association is accepted with this syntax.
fn accepted(syntax: &str) -> Vec<u8> {
    let context = PresentationContextResult {
        id: 1,
        reason: PresentationContextResultReason::Acceptance,
        transfer_syntax: syntax.to_owned(),
    };
    let accepted = AssociationAC {
        protocol_version: 1,
        calling_ae_title: "GAITER".to_owned(),
        called_ae_title: "PACS".to_owned(),
        application_context_name: "1.2.840.10008.3.1.1.1".to_owned(),
        presentation_contexts: vec![context],
        user_variables: Vec::new(),
    };
    let mut packet = Vec::new();
    write_pdu(&mut packet, &Pdu::AssociationAC(accepted)).unwrap();
    packet
}

/// A packet with one part.
fn packet(kind: u8, part: &[u8]) -> Vec<u8> {
    let length = part.len() as u32;
    let lengths = [(length + 6).to_be_bytes(), (length + 2).to_be_bytes()].concat();
    [&[4, 0], &lengths[..], &[1, kind], part].concat()
}

/// An answer to C-FIND of this status; 0x0101 for one without a data set.
fn answer(status: u16, set: u16) -> Vec<u8> {
    let element = |number: u16, value: u16| {
        let [low, high] = number.to_le_bytes();
        let [a, b] = value.to_le_bytes();
        [0, 0, low, high, 2, 0, 0, 0, a, b]
    };
    let command = [element(0x0100, 0x8020), element(0x0800, set), element(0x0900, status)];
    packet(COMMAND | LAST, &command.concat())
}

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let Some((how, bytes)) = bytes.split_first() else { return };
    let mut says = accepted(SYNTAXES[usize::from(how & 1)]);
    if how & 2 == 0 {
        says.extend_from_slice(bytes);
    } else {
        says.extend(answer(0xff00, 1));
        for part in bytes.chunks(PART_MOST) {
            says.extend(packet(DATA, part));
        }
        says.extend(packet(DATA | LAST, &[]));
        says.extend(answer(0, 0x0101));
    }
    let title = |text: &str| AeTitle::new(text).unwrap();
    let titles = Titles { calling: title("GAITER"), called: title("PACS") };
    let query = InMemDicomObject::new_empty();
    let _ = find(Server(Cursor::new(says)), &titles, Model::Worklist, &query, ANSWERS);
});
