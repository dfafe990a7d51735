//! MLLP: a message in a frame, and the answer in one (HL7, Transport Specification: MLLP, release 1).

use std::io;

use tokio::io::{AsyncReadExt, AsyncWriteExt};

use crate::flow::server::hl7::Way;
use crate::flow::server::{Endpoint, TlsFiles};
use crate::store::http::{HttpFault, blocking, stream};
use crate::store::server::ServerFault;

/// The byte before a message.
const START: u8 = 0x0b;

/// The bytes behind a message.
const END: [u8; 2] = [0x1c, b'\r'];

/// The longest answer, bytes: an acknowledgement has some hundreds.
const ANSWER_MOST: usize = 256 * 1024;

/// Opens a connection and closes it again.
pub(super) fn open(way: &Way) -> Result<(), ServerFault> {
    let Way::Mllp { host, port, tls, limit } = way else { return Ok(()) };
    let endpoint = endpoint(host, *port, tls.as_ref());
    let trusted = tls.clone().unwrap_or_default();
    blocking(*limit, async {
        let mut opened = stream(&endpoint, None, &trusted).await?;
        // The connection is closed as it was opened, whatever the receiver makes of that.
        let _ = opened.shutdown().await;
        Ok(())
    })?;
    Ok(())
}

/// Sends a message and returns the answer without its frame.
pub(super) fn exchange(way: &Way, message: &[u8]) -> Result<Vec<u8>, ServerFault> {
    let Way::Mllp { host, port, tls, limit } = way else { return Ok(Vec::new()) };
    let endpoint = endpoint(host, *port, tls.as_ref());
    let trusted = tls.clone().unwrap_or_default();
    let framed = [&[START], message, &END].concat();
    let answer = blocking(*limit, async {
        let failed = |source: io::Error| HttpFault::Connect { host: endpoint.authority(), source };
        let mut stream = stream(&endpoint, None, &trusted).await?;
        stream.write_all(&framed).await.map_err(failed)?;
        stream.flush().await.map_err(failed)?;
        let (mut answer, mut part) = (Vec::new(), [0; 4096]);
        while !answer.ends_with(&END) {
            if answer.len() > ANSWER_MOST {
                return Err(HttpFault::TooLong { most: ANSWER_MOST });
            }
            match stream.read(&mut part).await.map_err(failed)? {
                0 => return Err(failed(io::ErrorKind::UnexpectedEof.into())),
                count => answer.extend_from_slice(&part[..count]),
            }
        }
        Ok(answer)
    })?;
    let begin = answer.iter().position(|byte| *byte == START).map_or(0, |at| at + 1);
    Ok(answer[begin..answer.len() - END.len()].to_vec())
}

fn endpoint(host: &str, port: u16, tls: Option<&TlsFiles>) -> Endpoint {
    Endpoint { host: host.to_owned(), port, is_encrypted: tls.is_some() }
}
