//! What is made of the orders in `fixtures/cases/gdt`: the patient or the reason, by a strict reader
//! and by a lenient one, as `NAME.gdt.expected` says.
//! `GAITER_RENEW=1 cargo test --test record gdt_orders::` writes them anew; read the difference.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::fs;

use gaiter_record::gdt::order::{ORDER_MOST, read};
use gaiter_record::gdt::{Charset, Order, OrderFault, message};
use proptest::prelude::*;
use support::cases;

fn told(read: Result<Order, OrderFault>) -> String {
    match read {
        Ok(Order { patient, request, procedure, receiver, sender }) => {
            let rest = [request, procedure, receiver, sender].map(Option::unwrap_or_default);
            format!("{patient} {}", rest.join(" | "))
        }
        Err(fault) => format!("{}: {fault}", fault.code()),
    }
}

#[test]
fn every_order_is_read_or_refused_as_it_is_written_beside_it() {
    let cases = cases::with_ending(&["fixtures/cases/gdt"], "gdt", 25);
    cases::are_as_expected(cases.iter().map(|path| {
        let bytes = fs::read(path).unwrap();
        let of = |lenient: bool| told(read(&bytes, Charset::Cp1252, lenient));
        let told = format!("strict:  {}\nlenient: {}\n", of(false), of(true));
        // Names are planted in all of them; none may come out, whatever is wrong.
        for name in ["Mü", "ßig", "Jürgen", "1960"] {
            assert!(!told.contains(name), "{}: {told}", path.display());
        }
        (path.with_extension("gdt.expected"), told)
    }));
}

#[test]
fn an_order_beyond_all_measure_is_not_looked_at() {
    let bytes = vec![b'0'; usize::try_from(ORDER_MOST).unwrap() + 1];
    let fault = read(&bytes, Charset::Cp1252, true).unwrap_err();
    assert_eq!(fault, OrderFault::TooLarge { bytes: ORDER_MOST + 1 });
}

/// An order with the byte order mark of UTF-8, which its first line and its total count or not.
fn marked(fields: &[(u16, String)], line_counts: bool, total_counts: bool) -> Vec<u8> {
    let plain = String::from_utf8(message(6302, Charset::Utf8, fields).unwrap()).unwrap();
    let length = if total_counts { plain.len() + 3 } else { plain.len() };
    let first = if line_counts { "016" } else { "013" };
    // The first line has 13 bytes, and the second 7 before its five digits.
    format!("\u{feff}{first}{}{length:05}{}", &plain[3..20], &plain[25..]).into_bytes()
}

/// Orders that are nearly right: one that is right, with a few bytes changed, gone or added.
fn nearly() -> impl Strategy<Value = Vec<u8>> {
    let change = (0..200_usize, any::<u8>(), 0..3_u8);
    prop::collection::vec(change, 0..6).prop_map(|changes| {
        let fields = [(9206, "3"), (3000, "4711"), (3101, "Test"), (8402, "ALLG00")];
        let fields = fields.map(|(field, content)| (field, content.to_owned()));
        let mut bytes = message(6302, Charset::Cp1252, &fields).unwrap();
        for (at, byte, how) in changes {
            let at = at % bytes.len();
            match how {
                0 => bytes[at] = byte,
                1 => drop(bytes.remove(at)),
                _ => bytes.insert(at, byte),
            }
        }
        bytes
    })
}

proptest! {
    #[test]
    fn no_bytes_make_the_reader_panic(
        bytes in prop::collection::vec(any::<u8>(), 0..600),
        nearly in nearly(),
        lenient: bool,
    ) {
        for charset in [Charset::Ascii, Charset::Cp437, Charset::Cp1252, Charset::Utf8] {
            for bytes in [&bytes, &nearly] {
                let (fault, order) = match read(bytes, charset, lenient) {
                    Ok(order) => (None, Some(order)),
                    Err(fault) => (Some(fault.to_string()), None),
                };
                prop_assert!(order.is_none_or(|order| !order.patient.is_empty()));
                prop_assert!(fault.is_none_or(|fault| !fault.contains("Test")));
            }
        }
    }

    #[test]
    fn what_is_written_is_read(id in "[A-Za-z0-9äöüÄÖÜ]{1,20}", request in "[A-Z0-9-]{0,10}") {
        for charset in [Charset::Cp437, Charset::Cp1252, Charset::Utf8] {
            let mut fields = vec![(3000, id.clone()), (8310, request.clone())];
            fields.extend(charset.number().map(|number| (9206, number.to_owned())));
            let bytes = message(6302, charset, &fields).unwrap();
            for lenient in [false, true] {
                let order = read(&bytes, charset, lenient).unwrap();
                prop_assert_eq!(&order.patient, &id);
                prop_assert_eq!(order.request.unwrap_or_default(), request.clone());
            }
        }
    }
    /// An order with the byte order mark of UTF-8 is the order without it, and a cut one is none.
    #[test]
    fn a_byte_order_mark_may_be_there_and_be_counted_or_not(
        id in "[A-Za-z0-9äöüÄÖÜ]{1,20}", named in prop::option::of("[1239]"),
        line_counts: bool, total_counts: bool, lenient: bool, cut in 1..40_usize,
    ) {
        let mut fields = vec![(3000, id.clone()), (8402, "ALLG00".to_owned())];
        fields.extend(named.map(|named| (9206, named)));
        let bytes = marked(&fields, line_counts, total_counts);
        for charset in [Charset::Ascii, Charset::Cp437, Charset::Cp1252, Charset::Utf8] {
            let order = read(&bytes, charset, lenient).unwrap();
            prop_assert_eq!(&order.patient, &id);
            prop_assert_eq!(order.procedure.as_deref(), Some("ALLG00"));
            // The last line may lack its end, and nothing more.
            let short = read(&bytes[..bytes.len() - cut], charset, false);
            prop_assert_eq!(short.is_ok(), cut == 2);
        }
    }

    /// Two bytes of UTF-16 say what it is.
    #[test]
    fn an_order_in_utf_16_is_refused_by_name(big_end: bool, lenient: bool) {
        let text = "\u{feff}01380006302\r\n014810000040\r\n01330004711\r\n".encode_utf16();
        let bytes: Vec<u8> = text
            .flat_map(|unit| if big_end { unit.to_be_bytes() } else { unit.to_le_bytes() })
            .collect();
        prop_assert_eq!(read(&bytes, Charset::Utf8, lenient), Err(OrderFault::Utf16));
    }
}
