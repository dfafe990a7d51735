//! Who is let in, and whom the station trusts.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::fs;
use std::path::Path;
use std::process::Command;

use gaiter::flow::server::fhir::{Access, FhirServer, SmartAccess};
use gaiter::flow::server::{Secret, TlsFiles};
use gaiter::store::{FhirStore, StoreFault};

use crate::fhir::{ONE, SCAN, counts, put, register, rules, server_at};
use crate::server::{Server, certificates};

fn with_access(server: &Server, access: Access) -> FhirStore {
    let server = FhirServer { access, ..server_at(server) };
    FhirStore::new(server, rules(&["report.pdf", "record.json"]))
}

fn fault(store: &FhirStore) -> String {
    match store.put(&SCAN.delivery()) {
        Err(StoreFault::Server(fault)) => fault.to_string(),
        other => panic!("{other:?}"),
    }
}

fn secret(server: &Server, text: &str) -> Secret {
    let path = server.path("secret");
    fs::write(&path, text).unwrap();
    Secret::File(path)
}

#[test]
#[ignore = "needs Medplum's FHIR router (npm --prefix tests/hospital ci), run by .ci/run"]
fn a_password_or_a_token_lets_in_and_is_read_anew_each_time() {
    for (access, of) in [("Basic Z2FpdGVyOnP2w6R8", None), ("Bearer abc.def", Some("abc.def"))] {
        let server = Server::fhir(false, |_| {});
        register(&server, "4711");
        let word = of.unwrap_or("s\u{f6}");
        let access = match of {
            Some(_) => access.to_owned(),
            None => {
                use base64::Engine;
                let pair =
                    base64::engine::general_purpose::STANDARD.encode(format!("gaiter:{word}"));
                format!("Basic {pair}")
            }
        };
        fs::write(server.path("access"), &access).unwrap();
        let place = secret(&server, "wrong\n");
        let kind = match of {
            Some(_) => Access::Bearer { token: place },
            None => Access::Basic { user: "gaiter".to_owned(), password: place },
        };
        let store = with_access(&server, kind);
        assert!(fault(&store).contains("(401): login"));
        secret(&server, &format!("{word}\n"));
        put(&store, &SCAN);
        fs::remove_file(server.path("secret")).unwrap();
        let told = fault(&store);
        assert!(told.contains("secret") && !told.contains(word), "{told}");
    }
}

/// A key of this kind, and its public half where the server looks for it.
fn key(folder: &Path, kind: &[&str]) {
    let openssl = |args: &[&str]| {
        let done = Command::new("openssl").args(args).current_dir(folder).output().unwrap();
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    };
    openssl(&[&["genpkey", "-out", "client.key.pem"], kind].concat());
    openssl(&["pkey", "-in", "client.key.pem", "-pubout", "-out", "client.pub.pem"]);
}

const KINDS: [&[&str]; 2] = [
    &["-algorithm", "EC", "-pkeyopt", "ec_paramgen_curve:P-384"],
    &["-algorithm", "RSA", "-pkeyopt", "rsa_keygen_bits:2048"],
];

#[test]
#[ignore = "needs Medplum's FHIR router and openssl, run by .ci/run"]
fn a_signed_statement_gets_a_token_which_is_renewed_before_and_after_its_end() {
    for kind in KINDS {
        let server = Server::fhir(false, |folder| key(folder, kind));
        register(&server, "4711");
        fs::write(server.path("access"), "smart").unwrap();
        let smart = SmartAccess {
            client: "gaiter".to_owned(),
            key: Secret::File(server.path("client.key.pem")),
            key_id: "one".to_owned(),
            scope: "system/*.cruds".to_owned(),
            token_address: None,
        };
        let store = with_access(&server, Access::Smart(smart.clone()));
        store.reach().unwrap();
        put(&store, &SCAN);
        let tokens =
            || server.log().iter().filter(|line| line.starts_with("POST /token 200")).count();
        assert_eq!(tokens(), 1, "one token for all requests");
        // The server forgets it: it is renewed once, and the request is made again.
        server.becomes("once-unauthorized");
        put(&store, &SCAN);
        assert_eq!(tokens(), 2);
        // A token that ends within seconds is never used at its end.
        fs::write(server.path("token-seconds"), "1").unwrap();
        server.becomes("once-unauthorized");
        put(&store, &SCAN);
        put(&store, &SCAN);
        assert!(tokens() > 3);
        assert_eq!(
            {
                fs::remove_file(server.path("access")).unwrap();
                counts(&server)
            },
            ONE
        );
        fs::write(server.path("access"), "smart").unwrap();
        let other = SmartAccess { client: "somebody".to_owned(), ..smart };
        let told = fault(&with_access(&server, Access::Smart(other)));
        assert!(told.contains("400: invalid_client, the statement does not hold"), "{told}");
    }
}

#[test]
#[ignore = "needs Medplum's FHIR router and openssl, run by .ci/run"]
fn only_a_server_whose_certificate_is_right_is_asked_and_its_own_is_shown_where_it_is_wanted() {
    let server = Server::fhir(true, |folder| {
        certificates(folder);
        fs::write(folder.join("asks-for-a-certificate"), "").unwrap();
    });
    let of = |tls: TlsFiles, base: String| {
        let server = FhirServer { base, tls, ..server_at(&server) };
        FhirStore::new(server, rules(&[]))
    };
    let address = server.address();
    let authorities = Some(server.path("ca.pem"));
    let own = Some((server.path("client.pem"), Secret::File(server.path("client.key"))));
    let right = TlsFiles { authorities: authorities.clone(), own: own.clone() };
    of(right.clone(), address.clone()).reach().unwrap();
    // The system does not know the house's authority.
    let unknown = TlsFiles { authorities: None, own: own.clone() };
    let told = of(unknown, address.clone()).reach().unwrap_err().to_string();
    assert!(told.contains("UnknownIssuer") || told.contains("no certificates"), "{told}");
    // Another name than the certificate's.
    let other = address.replace("localhost", "127.0.0.1");
    let told = of(right.clone(), other).reach().unwrap_err().to_string();
    assert!(told.contains("not valid for name") || told.contains("NotValidForName"), "{told}");
    // Without a certificate of its own the station is not let in.
    let bare = TlsFiles { authorities, own: None };
    let told = of(bare, address.clone()).reach().unwrap_err().to_string();
    assert!(told.contains("CertificateRequired") || told.contains("connection"), "{told}");
    // A certificate that ran out.
    let folder = server.folder.path();
    let key = server.path("client.key");
    fs::write(folder.join("broken.pem"), "-----BEGIN CERTIFICATE-----\nAAAA\n").unwrap();
    let broken = TlsFiles { authorities: Some(server.path("broken.pem")), own: None };
    let told = of(broken, address.clone()).reach().unwrap_err().to_string();
    assert!(told.contains("broken.pem"), "{told}");
    let swapped = TlsFiles {
        authorities: right.authorities,
        own: Some((server.path("server.pem"), Secret::File(key))),
    };
    let told = of(swapped, address).reach().unwrap_err().to_string();
    assert!(told.contains("server.pem"), "{told}");
}
