//! When a certificate ends (RFC 5280, 4.1). The library that verifies certificates does not report it.

use jiff::Timestamp;
use jiff::civil::DateTime;
use jiff::tz::TimeZone;

/// The tag of the version, which a certificate of the first version does not have.
const VERSION: u8 = 0xa0;

/// The tag of a time whose year has two digits.
const UTC_TIME: u8 = 0x17;

/// Of a length, the sign that it stands in the bytes that follow.
const LONG: u8 = 0x80;

/// An element of DER, and what follows it.
struct Element<'a> {
    tag: u8,
    content: &'a [u8],
    rest: &'a [u8],
}

impl Element<'_> {
    fn first(der: &[u8]) -> Option<Element<'_>> {
        let (&tag, der) = der.split_first()?;
        let (&length, der) = der.split_first()?;
        let (length, der) = match length < LONG {
            true => (usize::from(length), der),
            false => {
                let (digits, der) = der.split_at_checked(usize::from(length - LONG))?;
                let add =
                    |sum: usize, digit: &u8| sum.checked_mul(256)?.checked_add(usize::from(*digit));
                (digits.iter().try_fold(0, add)?, der)
            }
        };
        let (content, rest) = der.split_at_checked(length)?;
        Some(Element { tag, content, rest })
    }
}

/// When a certificate (DER) ends; `None` if its validity is not well-formed.
pub(super) fn not_after(certificate: &[u8]) -> Option<Timestamp> {
    let signed = Element::first(Element::first(certificate)?.content)?.content;
    let first = Element::first(signed)?;
    let mut rest = if first.tag == VERSION { first.rest } else { signed };
    // Serial number, algorithm and issuer.
    for _ in 0..3 {
        rest = Element::first(rest)?.rest;
    }
    let not_before = Element::first(Element::first(rest)?.content)?;
    let end = Element::first(not_before.rest)?;
    let text = str::from_utf8(end.content).ok()?;
    let century = match (end.tag == UTC_TIME, text.get(..2)?) {
        (false, _) => "",
        (true, year) if year < "50" => "20",
        (true, _) => "19",
    };
    let at = DateTime::strptime("%Y%m%d%H%M%SZ", format!("{century}{text}")).ok()?;
    Some(at.to_zoned(TimeZone::UTC).ok()?.timestamp())
}

#[cfg(test)]
mod tests {
    use rustls::pki_types::CertificateDer;
    use rustls::pki_types::pem::PemObject;

    use super::*;

    fn certificate(name: &str) -> CertificateDer<'static> {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/tls");
        let pem = std::fs::read(format!("{folder}/{name}.pem")).unwrap();
        CertificateDer::from_pem_slice(&pem).unwrap()
    }

    #[test]
    fn the_end_of_a_certificate_is_read_before_and_after_2050() {
        for (name, end) in
            [("expired", "2021-01-01T00:00:00Z"), ("localhost", "2120-01-01T00:00:00Z")]
        {
            assert_eq!(not_after(&certificate(name)), Some(end.parse().unwrap()), "{name}");
        }
    }

    #[test]
    fn a_certificate_that_is_cut_short_anywhere_has_no_end_and_does_no_harm() {
        let whole = certificate("localhost");
        for length in 0..whole.len() {
            assert_eq!(not_after(&whole[..length]), None, "{length}");
        }
        assert_eq!(not_after(&[0x30, 0xff, 0xff]), None);
    }
}
