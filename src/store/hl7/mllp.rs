//! MLLP: a message in a frame, and the answer in one (HL7, Transport Specification: MLLP, release 1).

use std::io::{self, Read, Write};

use gaiter_https::HttpFault;

use crate::store::Peer;
use crate::store::connection::Connection;

/// The byte before a message.
const START: u8 = 0x0b;

/// The bytes behind a message.
const END: [u8; 2] = [0x1c, b'\r'];

/// The longest answer, bytes: an acknowledgement has some hundreds.
const ANSWER_MOST: usize = 256 * 1024;

/// Sends a message on a connection to a receiver and returns the answer without its frame.
pub(super) fn exchange(
    receiver: &Peer,
    mut connection: Connection,
    message: &[u8],
) -> Result<Vec<u8>, HttpFault> {
    let framed = [&[START][..], message, &END[..]].concat();
    let sent = connection.write_all(&framed).and_then(|()| connection.flush());
    let answer = sent.and_then(|()| read_answer(&mut connection));
    let answer = answer.map_err(|source| receiver.fault(source))?;
    connection.close();
    answer.ok_or(HttpFault::TooLong { most: ANSWER_MOST })
}

/// Reads up to the end of the first frame; `None` if the answer is too long.
fn read_answer(stream: &mut impl Read) -> io::Result<Option<Vec<u8>>> {
    let (mut answer, mut part) = (Vec::new(), [0; 4096]);
    while answer.len() <= ANSWER_MOST {
        // The end may be cut between two reads.
        let from = answer.len().saturating_sub(1);
        match stream.read(&mut part)? {
            0 => return Err(io::ErrorKind::UnexpectedEof.into()),
            count => answer.extend_from_slice(&part[..count]),
        }
        if let Some(at) = answer[from..].windows(END.len()).position(|two| two == END) {
            answer.truncate(from + at);
            let begin = answer.iter().position(|byte| *byte == START).map_or(0, |at| at + 1);
            return Ok(Some(answer.split_off(begin)));
        }
    }
    Ok(None)
}
