//! A receiver of HL7 v2 that is busy, full, dies, hangs or lies: nothing is lost, and a message that is sent again
//! has the same control id, by which receivers know it.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::net::TcpListener;
use std::time::{Duration, Instant};

use gaiter::store::hl7::Hl7Way;
use gaiter::store::{Peer, Rejection, StoreFault, TakeBack};
use gaiter_https::{Secret, TlsFiles};

use crate::fhir_house::{Deed, put, setback};
use crate::hl7_house::{LONG, SHORT, Sender, rules};
use crate::records::{PATIENT, SMALL};
use crate::server::{House, hl7, own_hl7};

/// How long a store that waits for [`SHORT`] may take, on a busy machine.
const SOON: Duration = Duration::from_secs(60);

#[test]
#[ignore = "needs Python with hl7apy, run by .ci/run"]
fn a_message_whose_answer_is_lost_is_sent_again_with_the_same_control_id() {
    let house = House::of_hl7();
    let (hasty, sender) = (house.sender(SHORT), house.sender(LONG));
    let mut taken = 0;
    for fault in [
        "cut-before",
        "cut-after",
        "hang-before",
        "hang-after",
        "half",
        "half-hang",
        "drip",
        "huge",
        "garbage",
        "other",
        "locked",
        "full",
    ] {
        house.becomes(fault);
        let began = Instant::now();
        // Only where no answer ends must the limit: a busy receiver may take a message late.
        let is_waited_for = fault.starts_with("hang") || ["half-hang", "drip"].contains(&fault);
        let store = if is_waited_for { &hasty.store } else { &sender.store };
        let told = setback(store, &SMALL);
        assert!(began.elapsed() < SOON, "{fault}: {told}");
        let port = house.server.port("plain").to_string();
        assert!(!told.replace(&port, "").contains(PATIENT), "{told}");
        // It may look at its mode late.
        house.said(&format!("strikes {fault}"));
        taken += usize::from(!fault.ends_with("before"));
        house.has_taken(taken, fault);
    }
    house.becomes("");
    assert!(!put(&sender.store, &SMALL).already_there);
    assert!(put(&sender.store, &SMALL).already_there);
    assert_eq!((house.messages().len(), house.controls().len()), (taken + 1, 1));
}

#[test]
#[ignore = "needs Python with hl7apy, run by .ci/run"]
fn a_take_back_whose_answer_is_lost_is_sent_again_with_the_same_control_id() {
    let house = House::of_hl7();
    let sender = house.sender(LONG);
    put(&sender.store, &SMALL);
    let withdraw = || sender.store.withdraw(&TakeBack::new(&SMALL.id, Some(PATIENT)));
    for fault in ["cut-after", "half", "full"] {
        house.becomes(fault);
        assert!(matches!(withdraw(), Err(StoreFault::Server(_))), "{fault}");
    }
    house.becomes("");
    withdraw().unwrap();
    withdraw().unwrap();
    assert_eq!((house.messages().len(), house.controls().len()), (5, 2));
}

#[test]
#[ignore = "needs Python with hl7apy, run by .ci/run"]
fn a_receiver_that_is_killed_gets_the_message_again_with_the_same_control_id() {
    let server = own_hl7();
    let sent: Deed<'_> = &|store| store.put(&SMALL.delivery()).map(drop);
    let withdrawn: Deed<'_> = &|store| store.withdraw(&TakeBack::new(&SMALL.id, Some(PATIENT)));
    for (fault, taken) in [("kill-before", 0), ("kill-after", 1), ("kill-half", 1)] {
        let house = House::new(server);
        let mut sender = house.sender(LONG);
        for (number, deed) in (1..).zip([sent, withdrawn]) {
            house.becomes(fault);
            assert!(matches!(deed(&sender.store), Err(StoreFault::Server(_))), "{fault}");
            house.becomes("");
            server.starts_again();
            sender = sender.by(house.way("plain", None, LONG), rules(&house.name));
            deed(&sender.store).unwrap();
            let found = (house.messages().len(), house.controls().len());
            assert_eq!(found, (number * (taken + 1), number), "{fault}");
        }
    }
}

#[test]
#[ignore = "needs Python with hl7apy, run by .ci/run"]
fn a_refused_message_waits_for_a_person_with_the_receivers_reason_and_without_the_patient() {
    let house = House::of_hl7();
    let sender = house.sender(LONG);
    for code in ["AE", "AR", "CE", "CR"] {
        house.becomes(code);
        match sender.store.put(&SMALL.delivery()) {
            Err(StoreFault::Permanent(Rejection::ReceiverRefused { code: found, why })) => {
                assert!(found == code && why.contains("has no open case"), "{found}: {why}");
                assert!(!why.contains(PATIENT), "{why}");
            }
            other => panic!("{code}: {other:?}"),
        }
    }
    house.becomes("");
    assert!(!put(&sender.store, &SMALL).already_there);
    assert_eq!(house.controls().len(), 1);
}

fn tls(own: Option<&str>) -> TlsFiles {
    let key = Secret::File(hl7().path("client.key"));
    let own = own.map(|name| (hl7().path(name), key));
    TlsFiles { authorities: Some(hl7().path("ca.pem")), own }
}

#[test]
#[ignore = "needs Python with hl7apy and openssl, run by .ci/run"]
fn an_encrypted_receiver_must_have_the_right_certificate_and_may_ask_for_one() {
    let house = House::of_hl7();
    let by = |way: &str, tls: TlsFiles, limit: Duration| {
        Sender::new(house.way(way, Some(tls), limit), rules(&house.name))
    };
    let refusal = |way: &str, tls: TlsFiles| setback(&by(way, tls, LONG).store, &SMALL);
    let told = refusal("tls", TlsFiles::default());
    assert!(told.contains("UnknownIssuer") || told.contains("no certificates"), "{told}");
    let told = refusal("expired", tls(None)).to_lowercase();
    assert!(told.contains("expired"), "{told}");
    // It takes the beginning of TLS for that of a message, and waits for its end.
    setback(&by("plain", tls(None), SHORT).store, &SMALL);
    refusal("mutual", tls(None));
    assert_eq!(house.messages().len(), 0, "nothing was sent to a receiver that is not trusted");
    put(&by("tls", tls(None), LONG).store, &SMALL);
    put(&by("mutual", tls(Some("client.pem")), LONG).store, &SMALL);
    assert_eq!((house.messages().len(), house.controls().len()), (2, 1));
}

#[test]
fn a_receiver_that_is_away_is_named_and_waited_for() {
    let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let (host, limit) = ("127.0.0.1".to_owned(), Duration::from_secs(2));
    let sender = Sender::new(Hl7Way::Mllp(Peer { host, port, tls: None, limit }), rules("KIS"));
    let store = &sender.store;
    assert_eq!(store.reach().unwrap_err().code(), "store-unavailable");
    let told = setback(store, &SMALL);
    assert!(told.contains(&port.to_string()), "{told}");
}
