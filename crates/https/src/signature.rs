//! AWS Signature Version 4 in the header of a request, as all S3-compatible stores check it.

use gaiter_record::{hex, sha256};
use http::Method;
use jiff::Timestamp;
use ring::hmac;

/// The algorithm, by its name in the header.
const ALGORITHM: &str = "AWS4-HMAC-SHA256";

/// The name and value of a header that is signed; the name is in lower case.
pub(crate) type SignedHeader<'a> = (&'a str, &'a str);

/// Who signs, and for what.
#[derive(Clone, Copy)]
pub(crate) struct Signer<'a> {
    /// The id of the access key.
    pub key_id: &'a str,
    /// The access key.
    pub secret: &'a str,
    /// The region of the store.
    pub region: &'a str,
    /// The time of the request.
    pub at: Timestamp,
}

impl Signer<'_> {
    /// The time as the header `x-amz-date` has it.
    pub fn date(&self) -> String {
        self.at.strftime("%Y%m%dT%H%M%SZ").to_string()
    }

    /// The header `authorization`. Path and query are as they are sent; the headers are in the order of their names.
    pub fn authorization(
        &self,
        method: &Method,
        path: &str,
        query: &str,
        headers: &[SignedHeader<'_>],
        body_sha256: &str,
    ) -> String {
        let lines: String =
            headers.iter().map(|(name, value)| format!("{name}:{value}\n")).collect();
        let names: Vec<&str> = headers.iter().map(|(name, _)| *name).collect();
        let names = names.join(";");
        let canonical = format!("{method}\n{path}\n{query}\n{lines}\n{names}\n{body_sha256}");
        let date = self.date();
        let day = &date[..8];
        let scope = format!("{day}/{}/s3/aws4_request", self.region);
        let signed = format!("{ALGORITHM}\n{date}\n{scope}\n{}", sha256(canonical.as_bytes()));
        let mut key = format!("AWS4{}", self.secret).into_bytes();
        for part in [day, self.region, "s3", "aws4_request"] {
            key = hmac_sha256(&key, part);
        }
        let signature = hex(&hmac_sha256(&key, &signed));
        let key_id = self.key_id;
        format!(
            "{ALGORITHM} Credential={key_id}/{scope}, SignedHeaders={names}, Signature={signature}"
        )
    }
}

fn hmac_sha256(key: &[u8], text: &str) -> Vec<u8> {
    let key = hmac::Key::new(hmac::HMAC_SHA256, key);
    hmac::sign(&key, text.as_bytes()).as_ref().to_vec()
}

/// A part of a path, of a query or of a form with every byte escaped that is not plain (RFC 3986); `/` stays in paths.
pub fn escaped(text: &str, is_path: bool) -> String {
    let mut escaped = String::with_capacity(text.len());
    for byte in text.bytes() {
        let is_plain = byte.is_ascii_alphanumeric() || b"-._~".contains(&byte);
        match is_plain || is_path && byte == b'/' {
            true => escaped.push(char::from(byte)),
            false => escaped.push_str(&format!("%{byte:02X}")),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The examples of "Signature Calculations for the Authorization Header" in the reference of Amazon S3.
    #[test]
    fn the_signatures_are_those_of_the_reference() {
        let signer = Signer {
            key_id: "AKIAIOSFODNN7EXAMPLE",
            secret: "wJalrXUtnFEMI/K7MDENG/bPxRfiCYEXAMPLEKEY",
            region: "us-east-1",
            at: "2013-05-24T00:00:00Z".parse().unwrap(),
        };
        let (empty, date) = (sha256(b""), signer.date());
        assert_eq!(date, "20130524T000000Z");
        let host = ("host", "examplebucket.s3.amazonaws.com");
        let own = [("x-amz-content-sha256", empty.as_str()), ("x-amz-date", date.as_str())];
        let signature = |path: &str, query: &str, headers: &[SignedHeader<'_>]| {
            let header = signer.authorization(&Method::GET, path, query, headers, &empty);
            header.rsplit_once("Signature=").unwrap().1.to_owned()
        };
        assert_eq!(
            signature("/test.txt", "", &[host, ("range", "bytes=0-9"), own[0], own[1]]),
            "f0e8bdb87c964420e857bd35b5d6ed310bd44f0170aba48dd91039c6036bdb41"
        );
        assert_eq!(
            signature("/", "max-keys=2&prefix=J", &[host, own[0], own[1]]),
            "34b48302e7b5fa45bde8084f4b7868a86f0a534bc59db6670ed5711ef69dc6f7"
        );
    }

    #[test]
    fn what_is_not_plain_is_escaped() {
        assert_eq!(escaped("result/0.1.0+ab/x", true), "result/0.1.0%2Bab/x");
        assert_eq!(escaped("inbox/ä b", false), "inbox%2F%C3%A4%20b");
    }
}
