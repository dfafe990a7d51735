//! An association: what both sides agree on, and messages in it, one after the other.

use std::collections::VecDeque;
use std::io::{Read, Write};

use dicom_core::Tag;
use dicom_dictionary_std::{tags, uids};
use dicom_object::InMemDicomObject;
use dicom_ul::pdu::{
    AbortRQSource, AssociationAC, AssociationRJ, AssociationRQ, PDU_HEADER_SIZE, PDV_HEADER_SIZE,
    PDataValue, PDataValueType, Pdu, PresentationContextProposed, UserVariableItem, read_pdu,
    write_pdu,
};

use super::reading::read;
use super::{DimseFault, Titles};
use crate::dataset::{Dataset, Syntax};
use crate::study::uid;
use crate::{DicomObject, EncodeFault, MAKER};

/// The version of the protocol (PS3.8, 9.3.2).
const PROTOCOL: u16 = 1;

/// What an association is about: DICOM (PS3.7, A.2.1).
const APPLICATION: &str = "1.2.840.10008.3.1.1.1";

/// The longest packet (PDU) that is read or sent, bytes: what most servers take without being asked.
const PACKET_MOST: u32 = 16 << 10;

// Types of packets: that accept, reject and abort an association (PS3.8, 9.3.3, 9.3.4, 9.3.8).
const ACCEPTS: u8 = 0x02;
const REJECTS: u8 = 0x03;
const ABORTS: u8 = 0x07;

/// Where the items of a packet that accepts begin, bytes.
const ITEMS_FROM: usize = 74;

/// The type of an item of it that says whether a context is accepted (PS3.8, 9.3.3.2).
const CONTEXT_RESULT: u8 = 0x21;

/// One command or data set of an answer, bytes: an entry of a worklist has some thousands.
const MESSAGE_MOST: usize = 64 << 10;

/// All answers of an association together, bytes. An object of a study has up to some four hundred with the command
/// before it, which is less than a million for [`super::LISTED_MOST`]; a worklist of 300 entries has about as many. All
/// of them are held at a time, and an element that is read takes a multiple of its bytes.
pub(super) const ANSWERS_MOST: usize = 2 << 20;

// Commands (PS3.7, E.1).
const C_STORE: u16 = 0x0001;
const C_FIND: u16 = 0x0020;
const C_ECHO: u16 = 0x0030;

/// What the command of an answer has besides.
const IS_ANSWER: u16 = 0x8000;

/// The message is a command alone.
const NO_DATA: u16 = 0x0101;

/// The message is a command with a data set: any other number.
const WITH_DATA: u16 = 0x0001;

/// The priority of all messages: medium.
const PRIORITY: u16 = 0;

/// Done.
const SUCCESS: u16 = 0x0000;

/// An answer of several; with the second, the server knows not every key of the query.
const PENDING: [u16; 2] = [0xff00, 0xff01];

/// The server does not know the kind of object.
const CLASS_NOT_SUPPORTED: u64 = 0x0122;

/// Results of contexts that will last: the server does not know the class, or none of the transfer syntaxes
/// (PS3.8, 9.3.3.2).
const NOT_SUPPORTED: [u8; 2] = [3, 4];

/// The result of a context that is refused for no reason, or that the server says nothing of.
const NO_REASON: u8 = 2;

/// A kind of object or service that both sides know.
#[derive(Debug, Clone, Copy)]
struct Context {
    id: u8,
    class: &'static str,
    syntax: Syntax,
}

/// What a server answers.
#[derive(Debug)]
struct Answer {
    status: u16,
    data: Option<Vec<u8>>,
}

/// An association over a connection.
#[derive(Debug)]
pub(super) struct Association<S> {
    stream: S,
    contexts: Vec<Context>,
    /// The classes that the server refuses, each with its result.
    refused: Vec<(&'static str, u8)>,
    /// Bytes of a message that one packet holds.
    part_most: usize,
    /// Messages that were sent.
    sent: u16,
    /// Parts of messages that were received and not looked at yet.
    received: VecDeque<PDataValue>,
    /// Bytes of answers that were received.
    bytes: usize,
}

impl<S: Read + Write> Association<S> {
    /// Asks for an association for these kinds of objects or services. The server may accept only some of them.
    pub fn open(
        stream: S,
        titles: &Titles,
        classes: &[&'static str],
    ) -> Result<Association<S>, DimseFault> {
        // Ids of contexts are odd.
        let ids = (1..=u8::MAX).step_by(2);
        let proposed: Vec<(u8, &'static str)> = ids.zip(classes.iter().copied()).collect();
        let mut association = Association {
            stream,
            contexts: Vec::new(),
            refused: Vec::new(),
            part_most: 0,
            sent: 0,
            received: VecDeque::new(),
            bytes: 0,
        };
        send(&mut association.stream, &request(titles, &proposed))?;
        let (answer, refused) = without_refused(packet(&mut association.stream)?);
        let accepted = match parsed(&answer)? {
            Pdu::AssociationAC(accepted) => accepted,
            Pdu::AssociationRJ(AssociationRJ { source, .. }) => {
                return Err(DimseFault::Rejected { why: source });
            }
            Pdu::AbortRQ { .. } => return Err(DimseFault::Aborted),
            _ => return Err(DimseFault::Unexpected),
        };
        association.part_most = part_most(&accepted)?;
        association.contexts = contexts(&accepted, &proposed);
        let result = |id| refused.iter().find(|(of, _)| *of == id).map(|(_, result)| *result);
        let refused = proposed.into_iter().filter_map(|(id, class)| Some((class, result(id)?)));
        association.refused = refused.collect();
        Ok(association)
    }

    /// C-ECHO.
    pub fn echo(&mut self) -> Result<(), DimseFault> {
        let context = self.context(uids::VERIFICATION)?;
        self.ask(context, C_ECHO, Dataset::new(), None)?;
        match self.answer(C_ECHO)?.status {
            SUCCESS => Ok(()),
            status => Err(DimseFault::Status { status }),
        }
    }

    /// C-STORE. Returns the reason of a server that does not store the object. One that accepts nothing at all is not
    /// set up for the station yet, which is no matter of the object.
    pub fn store(&mut self, object: &DicomObject) -> Result<Option<u64>, DimseFault> {
        let context = match self.context(object.class().uid()) {
            Err(DimseFault::NotAccepted { result, .. })
                if NOT_SUPPORTED.contains(&result) && !self.contexts.is_empty() =>
            {
                return Ok(Some(CLASS_NOT_SUPPORTED));
            }
            context => context?,
        };
        let data = context.syntax.encoded(object.dataset())?;
        let own = Dataset::new()
            .value(tags::PRIORITY, PRIORITY)
            .text(tags::AFFECTED_SOP_INSTANCE_UID, object.uid());
        self.ask(context, C_STORE, own, Some(&data))?;
        match self.answer(C_STORE)?.status {
            // With a remark: it is stored (PS3.4, B.2.3; PS3.7, annex C).
            SUCCESS | 0x0001 | 0x0107 | 0x0116 | 0xb000..=0xbfff => Ok(None),
            status => Ok(Some(u64::from(status))),
        }
    }

    /// C-FIND, with up to so many answers. One that cannot be read leaves the others as they are.
    pub fn find(
        &mut self,
        class: &'static str,
        query: &InMemDicomObject,
        most: usize,
    ) -> Result<Vec<Result<InMemDicomObject, DimseFault>>, DimseFault> {
        let context = self.context(class)?;
        let data = context.syntax.encoded(query)?;
        self.ask(context, C_FIND, Dataset::new().value(tags::PRIORITY, PRIORITY), Some(&data))?;
        let mut found = Vec::new();
        loop {
            let Answer { status, data } = self.answer(C_FIND)?;
            match data {
                _ if status == SUCCESS => return Ok(found),
                _ if !PENDING.contains(&status) => return Err(DimseFault::Status { status }),
                None => return Err(DimseFault::Unexpected),
                Some(_) if found.len() == most => return Err(DimseFault::TooMany { most }),
                Some(data) => found.push(read(context.syntax, &data)),
            }
        }
    }

    fn context(&self, class: &'static str) -> Result<Context, DimseFault> {
        if let Some(context) = self.contexts.iter().find(|of| of.class == class) {
            return Ok(*context);
        }
        let refused = self.refused.iter().find(|(of, _)| *of == class);
        let result = refused.map_or(NO_REASON, |(_, result)| *result);
        Err(DimseFault::NotAccepted { class, result })
    }

    /// Sends a command with what it has besides, and a data set.
    fn ask(
        &mut self,
        context: Context,
        command: u16,
        own: Dataset,
        data: Option<&[u8]>,
    ) -> Result<(), DimseFault> {
        self.sent = self.sent.wrapping_add(1);
        let data_set = if data.is_some() { WITH_DATA } else { NO_DATA };
        let Dataset(command) = Dataset::new()
            .text(tags::AFFECTED_SOP_CLASS_UID, context.class)
            .value(tags::COMMAND_FIELD, command)
            .value(tags::MESSAGE_ID, self.sent)
            .value(tags::COMMAND_DATA_SET_TYPE, data_set)
            .and(own);
        let command = InMemDicomObject::command_from_element_iter(command);
        let command = Syntax::ImplicitLittleEndian.encoded(&command)?;
        let parts = [(PDataValueType::Command, Some(&command[..])), (PDataValueType::Data, data)];
        for (kind, bytes) in parts {
            let mut parts = bytes.unwrap_or_default().chunks(self.part_most).peekable();
            while let Some(part) = parts.next() {
                let value = PDataValue {
                    presentation_context_id: context.id,
                    value_type: kind.clone(),
                    is_last: parts.peek().is_none(),
                    data: part.to_vec(),
                };
                send(&mut self.stream, &Pdu::PData { data: vec![value] })?;
            }
        }
        Ok(())
    }

    /// The next answer to a command.
    fn answer(&mut self, command: u16) -> Result<Answer, DimseFault> {
        let told = self.message(PDataValueType::Command)?;
        let told = read(Syntax::ImplicitLittleEndian, &told)?;
        if number(&told, tags::COMMAND_FIELD)? != command | IS_ANSWER {
            return Err(DimseFault::Unexpected);
        }
        let status = number(&told, tags::STATUS)?;
        let data = match number(&told, tags::COMMAND_DATA_SET_TYPE)? {
            NO_DATA => None,
            _ => Some(self.message(PDataValueType::Data)?),
        };
        Ok(Answer { status, data })
    }

    /// The command or data set that comes next, from all its parts.
    fn message(&mut self, kind: PDataValueType) -> Result<Vec<u8>, DimseFault> {
        let mut message = Vec::new();
        loop {
            let Some(part) = self.received.pop_front() else {
                match parsed(&packet(&mut self.stream)?)? {
                    Pdu::PData { data } => self.received.extend(data),
                    Pdu::AbortRQ { .. } => return Err(DimseFault::Aborted),
                    _ => return Err(DimseFault::Unexpected),
                }
                continue;
            };
            if part.value_type != kind {
                return Err(DimseFault::Unexpected);
            }
            // An empty part counts, too.
            self.bytes += PDV_HEADER_SIZE as usize + part.data.len();
            message.extend(part.data);
            for (bytes, most) in [(message.len(), MESSAGE_MOST), (self.bytes, ANSWERS_MOST)] {
                if bytes > most {
                    return Err(DimseFault::TooLong { bytes, most });
                }
            }
            if part.is_last {
                return Ok(message);
            }
        }
    }
}

/// Ends an association in which every request was answered, and waits for the answer to that. Faults change nothing.
pub fn release<S: Read + Write>(mut stream: S) {
    let _ = send(&mut stream, &Pdu::ReleaseRQ).and_then(|()| packet(&mut stream));
}

/// Ends the association of a connection after a fault.
pub fn abort<S: Write>(mut stream: S) {
    let _ = send(&mut stream, &Pdu::AbortRQ { source: AbortRQSource::ServiceUser });
}

fn send(stream: &mut impl Write, packet: &Pdu) -> Result<(), DimseFault> {
    let mut bytes = Vec::new();
    write_pdu(&mut bytes, packet).map_err(EncodeFault::new)?;
    stream.write_all(&bytes)?;
    Ok(stream.flush()?)
}

/// The bytes of the next packet.
fn packet(stream: &mut impl Read) -> Result<Vec<u8>, DimseFault> {
    let mut packet = vec![0; PDU_HEADER_SIZE as usize];
    stream.read_exact(&mut packet)?;
    let length = u32::from_be_bytes([packet[2], packet[3], packet[4], packet[5]]);
    if length > PACKET_MOST {
        return Err(DimseFault::TooLong { bytes: length as usize, most: PACKET_MOST as usize });
    }
    packet.resize((PDU_HEADER_SIZE + length) as usize, 0);
    stream.read_exact(&mut packet[PDU_HEADER_SIZE as usize..])?;
    Ok(packet)
}

/// What the bytes of a packet are. The reader of packets refuses reasons that are not in the standard; an association
/// that ends for one of these has ended, too.
fn parsed(packet: &[u8]) -> Result<Pdu, DimseFault> {
    match (read_pdu(packet, PACKET_MOST, true), packet) {
        (Ok(Some(packet)), _) => Ok(packet),
        (Ok(None), _) => Err(DimseFault::Cut),
        (Err(_), [REJECTS, _, _, _, _, _, _, _, source, reason, ..]) => {
            Err(DimseFault::RejectedFor { source_code: *source, reason: *reason })
        }
        (Err(_), [ABORTS, ..]) => Err(DimseFault::Aborted),
        (Err(_), _) => Err(DimseFault::Unreadable),
    }
}

/// A packet without the contexts that it refuses, and the id and result of each of these: with them some servers name
/// no transfer syntax, which has no meaning there (PS3.8, 9.3.3.2) and which the reader of packets insists on.
fn without_refused(packet: Vec<u8>) -> (Vec<u8>, Vec<(u8, u8)>) {
    let mut refused = Vec::new();
    let (Some(&ACCEPTS), Some((head, mut items))) =
        (packet.first(), packet.split_at_checked(ITEMS_FROM))
    else {
        return (packet, refused);
    };
    let mut kept = head.to_vec();
    while let Some((item, rest)) = first_item(items) {
        match item {
            // Type, a byte, length of two bytes, id, a byte, result.
            [CONTEXT_RESULT, _, _, _, id, _, result, ..] if *result != 0 => {
                refused.push((*id, *result));
            }
            _ => kept.extend_from_slice(item),
        }
        items = rest;
    }
    // The reader of packets judges what remains.
    kept.extend_from_slice(items);
    let length = kept.len() as u32 - PDU_HEADER_SIZE;
    kept[2..6].copy_from_slice(&length.to_be_bytes());
    (kept, refused)
}

/// The first item of a packet with its head, and what follows.
fn first_item(items: &[u8]) -> Option<(&[u8], &[u8])> {
    let (&[_, _, high, low], _) = items.split_first_chunk::<4>()?;
    items.split_at_checked(4 + usize::from(u16::from_be_bytes([high, low])))
}

/// The request for an association.
fn request(titles: &Titles, proposed: &[(u8, &'static str)]) -> Pdu {
    let contexts = proposed.iter().map(|(id, class)| PresentationContextProposed {
        id: *id,
        abstract_syntax: (*class).to_owned(),
        transfer_syntaxes: Syntax::ALL.map(|syntax| syntax.uid().to_owned()).to_vec(),
    });
    Pdu::AssociationRQ(AssociationRQ {
        protocol_version: PROTOCOL,
        calling_ae_title: titles.calling.as_str().to_owned(),
        called_ae_title: titles.called.as_str().to_owned(),
        application_context_name: APPLICATION.to_owned(),
        presentation_contexts: contexts.collect(),
        user_variables: vec![
            UserVariableItem::MaxLength(PACKET_MOST),
            UserVariableItem::ImplementationClassUID(uid(MAKER)),
        ],
    })
}

/// How many bytes of a message the server takes in a packet.
fn part_most(accepted: &AssociationAC) -> Result<usize, DimseFault> {
    let told = accepted.user_variables.iter().find_map(|of| match of {
        // 0 for any.
        UserVariableItem::MaxLength(most) if *most > 0 => Some(*most),
        _ => None,
    });
    let most = told.unwrap_or(PACKET_MOST).min(PACKET_MOST);
    // Parts have even lengths (PS3.7, annex F).
    let part = most.checked_sub(PDV_HEADER_SIZE).map(|part| part & !1).filter(|part| *part > 0);
    part.map(|part| part as usize).ok_or(DimseFault::Unexpected)
}

/// What the server accepts of what was proposed.
fn contexts(accepted: &AssociationAC, proposed: &[(u8, &'static str)]) -> Vec<Context> {
    accepted
        .presentation_contexts
        .iter()
        .filter_map(|of| {
            let (id, class) = *proposed.iter().find(|(id, _)| *id == of.id)?;
            let syntax = of.transfer_syntax.trim_end_matches('\0');
            let syntax = Syntax::ALL.into_iter().find(|known| known.uid() == syntax)?;
            Some(Context { id, class, syntax })
        })
        .collect()
}

/// A number of a command.
fn number(command: &InMemDicomObject, tag: Tag) -> Result<u16, DimseFault> {
    let number = command.get(tag).and_then(|of| of.to_int().ok());
    number.ok_or(DimseFault::Missing(tag))
}
