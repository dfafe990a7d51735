//! A server of a worklist (DICOM, C-FIND), whose entries and manners change while it runs. What it sends is written by
//! hand (PS3.7, PS3.8; Implicit VR Little Endian), and not by what the station reads it with.

#![allow(clippy::unwrap_used)]

use std::io::{self, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;

use crate::station::PATIENCE;

/// The station that entries are planned for: the title of one that sets none.
const STATION: &str = "GAITER";

/// An answer of several, and the last one.
const PENDING: u16 = 0xff00;
const SUCCESS: u16 = 0x0000;

/// It cannot do what was asked: out of resources.
const REFUSED: u16 = 0xa700;

/// Whether a command is followed by data.
const WITH_DATA: u16 = 0x0001;
const NO_DATA: u16 = 0x0101;

/// An entry for the station and the day that ask for it.
#[derive(Debug, Clone, Copy, Default)]
pub struct Planned {
    pub patient: &'static str,
    /// As DICOM writes it: `Meier^Anna`.
    pub name: &'static str,
    /// `19500102`
    pub born: &'static str,
    pub study: &'static str,
    pub accession_number: &'static str,
}

/// What becomes of a question.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Manner {
    #[default]
    Answers,
    /// Connections end as soon as they are made.
    IsAway,
    /// Nothing is said, for as long as somebody waits for it.
    Hangs,
    /// It is refused, with this remark.
    Refuses(&'static str),
}

#[derive(Debug, Default)]
struct Told {
    entries: Vec<Planned>,
    manner: Manner,
    /// The days that it was asked for and has answered.
    days: Vec<String>,
}

/// A server at a port of this machine.
#[derive(Debug)]
pub struct WorklistServer {
    pub port: u16,
    told: Arc<Mutex<Told>>,
}

impl WorklistServer {
    pub fn new(entries: &[Planned]) -> WorklistServer {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let port = listener.local_addr().unwrap().port();
        let told = Arc::new(Mutex::new(Told { entries: entries.to_vec(), ..Told::default() }));
        let theirs = Arc::clone(&told);
        // It ends with the test.
        thread::spawn(move || {
            for stream in listener.incoming().flatten() {
                // Who breaks off gets no answer.
                let _ = serve(stream, &theirs);
            }
        });
        WorklistServer { port, told }
    }

    /// The section of a station that asks it.
    pub fn section(&self) -> String {
        let port = self.port;
        format!(
            "[patient.worklist]\naddress = \"127.0.0.1:{port}\"\nserver_ae_title = \"RIS\"\n\
             encryption = \"none\"\nevery = \"10s\"\n"
        )
    }

    /// From now on it has these entries.
    pub fn has(&self, entries: &[Planned]) {
        locked(&self.told).entries = entries.to_vec();
    }

    /// From now on no answer is made in another manner.
    pub fn is(&self, manner: Manner) {
        locked(&self.told).manner = manner;
    }

    /// The days that it has answered for, each once.
    pub fn days(&self) -> Vec<String> {
        let mut days = locked(&self.told).days.clone();
        days.dedup();
        days
    }
}

fn locked(told: &Mutex<Told>) -> MutexGuard<'_, Told> {
    told.lock().unwrap_or_else(PoisonError::into_inner)
}

/// One association.
fn serve(mut stream: TcpStream, told: &Mutex<Told>) -> io::Result<()> {
    let manner = locked(told).manner;
    if manner == Manner::IsAway {
        return Ok(());
    }
    stream.set_read_timeout(Some(PATIENCE))?;
    if manner == Manner::Hangs {
        return io::copy(&mut stream, &mut io::sink()).map(drop);
    }
    let mut query = Vec::new();
    loop {
        let (kind, body) = received(&mut stream)?;
        match kind {
            1 => stream.write_all(&accepts())?,
            4 if takes(&mut query, &body) => {
                let Some(answers) = answers(told, &query) else { return Ok(()) };
                stream.write_all(&answers)?;
            }
            4 => {}
            // Whoever ends the association: it is over.
            _ => return stream.write_all(&packet(6, &[0; 4])),
        }
    }
}

/// The next packet: its kind, and what is in it.
fn received(stream: &mut TcpStream) -> io::Result<(u8, Vec<u8>)> {
    let mut head = [0; 6];
    stream.read_exact(&mut head)?;
    let [kind, _, length @ ..] = head;
    let mut body = vec![0; u32::from_be_bytes(length) as usize];
    stream.read_exact(&mut body)?;
    Ok((kind, body))
}

/// Takes what a packet holds of a query; whether that is whole.
fn takes(query: &mut Vec<u8>, mut parts: &[u8]) -> bool {
    while let Some((length, rest)) = parts.split_first_chunk::<4>() {
        let length = u32::from_be_bytes(*length) as usize;
        let (part, after) = rest.split_at(length.min(rest.len()));
        // A context, and what it is: of a command, and the last of its parts.
        let [_, kind, bytes @ ..] = part else { return false };
        if kind & 1 == 0 {
            query.extend(bytes);
            if kind & 2 == 2 {
                return true;
            }
        }
        parts = after;
    }
    false
}

/// All that is answered to a query; none if the server is away or hangs by now.
fn answers(told: &Mutex<Told>, query: &[u8]) -> Option<Vec<u8>> {
    let mut told = locked(told);
    let (manner, day) = (told.manner, day_of(query));
    let mut answers = Vec::new();
    match manner {
        Manner::IsAway | Manner::Hangs => return None,
        Manner::Refuses(remark) => answers.extend(command(REFUSED, NO_DATA, remark)),
        Manner::Answers => {
            for entry in &told.entries {
                answers.extend(pending());
                answers.extend(part(2, &entry.written(&day)));
            }
            answers.extend(command(SUCCESS, NO_DATA, ""));
            told.days.push(day);
        }
    }
    Some(answers)
}

/// The day that a query asks for: Scheduled Procedure Step Start Date (0040,0002).
fn day_of(query: &[u8]) -> String {
    let head = b"\x40\0\x02\0\x08\0\0\0";
    let at = query.windows(head.len()).position(|part| part == head);
    let day = at.and_then(|at| query.get(at + head.len()..)?.get(..8));
    String::from_utf8_lossy(day.unwrap_or_default()).into_owned()
}

impl Planned {
    /// The entry as a data set, in the order of the tags.
    fn written(&self, day: &str) -> Vec<u8> {
        let step = [
            text((0x0008, 0x0060), "OSS"),
            text((0x0040, 0x0001), STATION),
            text((0x0040, 0x0002), day),
            text((0x0040, 0x0003), "093000"),
            text((0x0040, 0x0009), "1"),
        ];
        let entry = [
            text((0x0008, 0x0005), "ISO_IR 192"),
            text((0x0008, 0x0050), self.accession_number),
            text((0x0010, 0x0010), self.name),
            text((0x0010, 0x0020), self.patient),
            text((0x0010, 0x0030), self.born),
            text((0x0020, 0x000d), self.study),
            text((0x0032, 0x1060), "Beinvermessung"),
            element((0x0040, 0x0100), &element((0xfffe, 0xe000), &step.concat())),
        ];
        entry.concat()
    }
}

/// An element with a value that is as it is.
fn element((group, number): (u16, u16), value: &[u8]) -> Vec<u8> {
    let length = u32::try_from(value.len()).unwrap().to_le_bytes();
    [&group.to_le_bytes()[..], &number.to_le_bytes(), &length, value].concat()
}

/// An element with a text, which has an even length.
fn text(tag: (u16, u16), value: &str) -> Vec<u8> {
    let pad = if value.len() % 2 == 1 { " " } else { "" };
    element(tag, [value, pad].concat().as_bytes())
}

/// The command of an answer (C-FIND-RSP), with a remark (Error Comment) where there is one.
fn command(status: u16, data: u16, remark: &str) -> Vec<u8> {
    let numbers = [(0x0100, 0x8020), (0x0120, 1), (0x0800, data), (0x0900, status)];
    let numbers =
        numbers.map(|(number, value): (u16, u16)| element((0, number), &value.to_le_bytes()));
    let remark = if remark.is_empty() { Vec::new() } else { text((0, 0x0902), remark) };
    part(3, &[numbers.concat(), remark].concat())
}

/// The command of an answer that is followed by data.
pub fn pending() -> Vec<u8> {
    command(PENDING, WITH_DATA, "")
}

/// A part of a message; `kind` is 0 for data, 1 for a command, with 2 for its last part.
pub fn part(kind: u8, bytes: &[u8]) -> Vec<u8> {
    let length = u32::try_from(bytes.len() + 2).unwrap().to_be_bytes();
    packet(4, &[&length[..], &[1, kind], bytes].concat())
}

/// The server takes the first context, in Implicit VR Little Endian.
pub fn accepts() -> Vec<u8> {
    let syntax = item(0x40, b"1.2.840.10008.1.2");
    let body = [
        &[0, 1, 0, 0][..],
        b"RIS             LEGSCAN         ",
        &[0; 32],
        &item(0x10, b"1.2.840.10008.3.1.1.1"),
        &item(0x21, &[&[1, 0, 0, 0][..], &syntax].concat()),
        &item(0x50, &item(0x51, &[0, 0, 0x40, 0])),
    ];
    packet(2, &body.concat())
}

/// A packet (PS3.8, 9.3).
fn packet(kind: u8, body: &[u8]) -> Vec<u8> {
    let length = u32::try_from(body.len()).unwrap().to_be_bytes();
    [&[kind, 0][..], &length, body].concat()
}

/// An item of a packet that accepts an association.
fn item(kind: u8, body: &[u8]) -> Vec<u8> {
    let length = u16::try_from(body.len()).unwrap().to_be_bytes();
    [&[kind, 0][..], &length, body].concat()
}
