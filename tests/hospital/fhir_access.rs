//! Who is let in, and whom the station trusts.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use gaiter::store::HttpAccess;
use gaiter::store::fhir::{FhirAccess, FhirServer, SmartAccess};
use gaiter_https::{Endpoint, Proxy, Secret, TlsFiles};

use crate::fhir_house::{ONE, Store, put, server_at, setback, store_of};
use crate::records::SMALL;
use crate::server::{House, fhir, openssl};

fn store_with(house: &House, access: FhirAccess) -> Store {
    store_of(FhirServer { access, ..server_at(house.base()) })
}

/// A secret that only the station can read.
fn secret(path: PathBuf, text: &str) -> Secret {
    fs::write(&path, text).unwrap();
    fs::set_permissions(&path, fs::Permissions::from_mode(0o600)).unwrap();
    Secret::File(path)
}

/// What the server asks for from now on.
fn asks_for(house: &House, access: &str) {
    fs::write(house.path("access"), access).unwrap();
}

/// What is there once everybody is let in.
fn counts(house: &House) -> [usize; 4] {
    fs::remove_file(house.path("access")).unwrap();
    house.counts()
}

#[test]
#[ignore = "needs Medplum's FHIR router (npm --prefix tests/hospital ci), run by .ci/run"]
fn a_password_or_a_token_lets_in_and_is_read_anew_each_time_and_never_told() {
    let (word, token) = ("s\u{f6}Geheim", "abc.def");
    let basic = format!("Basic {}", STANDARD.encode(format!("gaiter:{word}")));
    let bearer = format!("Bearer {token}");
    for (asked, shown) in [(basic, word), (bearer, token)] {
        let house = House::with_patient();
        asks_for(&house, &asked);
        let path = house.path("secret");
        let place = secret(path.clone(), "Falsch\n");
        let access = match shown == word {
            true => HttpAccess::Basic { user: "gaiter".to_owned(), password: place },
            false => HttpAccess::Bearer { token: place },
        };
        let store = store_with(&house, FhirAccess::Http(access));
        let told = setback(&store, &SMALL);
        assert!(told.contains("401") && !told.contains("Falsch"), "{told}");
        secret(path.clone(), &format!("{shown}\n"));
        put(&store, &SMALL);
        // What the server says of a fault may repeat what it was shown.
        house.becomes("403");
        let told = setback(&store, &SMALL);
        assert!(told.contains("403") && !told.contains(shown), "{told}");
        fs::remove_file(&path).unwrap();
        let told = setback(&store, &SMALL);
        assert!(told.contains("secret") && !told.contains(shown), "{told}");
        house.becomes("");
        assert_eq!(counts(&house), ONE);
    }
}

/// The kinds of keys, as openssl makes them.
const KINDS: [&str; 2] = [
    "-algorithm EC -pkeyopt ec_paramgen_curve:P-384",
    "-algorithm RSA -pkeyopt rsa_keygen_bits:2048",
];

/// A key of this kind, its public half where the server looks for it.
fn key(house: &House, kind: &str) -> Secret {
    let folder = house.path("");
    openssl(&folder, &format!("genpkey -out client.key.pem {kind}"));
    openssl(&folder, "pkey -in client.key.pem -pubout -out client.pub.pem");
    Secret::File(folder.join("client.key.pem"))
}

fn smart(key: Secret) -> SmartAccess {
    SmartAccess {
        client: "gaiter".to_owned(),
        key,
        key_id: "one".to_owned(),
        scope: "system/*.cruds".to_owned(),
        token_address: None,
    }
}

#[test]
#[ignore = "needs Medplum's FHIR router and openssl, run by .ci/run"]
fn a_signed_statement_gets_a_token_which_is_renewed_before_and_after_its_end() {
    for kind in KINDS {
        let house = House::with_patient();
        let smart = smart(key(&house, kind));
        asks_for(&house, "smart");
        let store = store_with(&house, FhirAccess::Smart(smart.clone()));
        store.reach().unwrap();
        put(&store, &SMALL);
        let given =
            || house.log().iter().filter(|line| line.starts_with("POST /token 200")).count();
        assert_eq!(given(), 1, "one token for all requests");
        // It has expired at the server: it is renewed, and the request is made again.
        house.becomes("401 1");
        put(&store, &SMALL);
        assert_eq!((given(), house.strikes()), (2, 1));
        // A server that takes no token is asked once more, not for ever.
        house.becomes("401");
        assert!(setback(&store, &SMALL).contains("401"));
        assert_eq!((given(), house.strikes()), (3, 3));
        house.becomes("");
        // A token of twelve seconds is renewed before its end, not at it.
        fs::write(house.path("token-seconds"), "12").unwrap();
        house.becomes("401 1");
        put(&store, &SMALL);
        let refused = || house.log().iter().filter(|line| line.ends_with(" 401")).count();
        let (before, refused_before) = (given(), refused());
        while given() == before {
            put(&store, &SMALL);
        }
        assert_eq!(refused(), refused_before);
        let other = SmartAccess { client: "somebody".to_owned(), ..smart };
        let told = setback(&store_with(&house, FhirAccess::Smart(other)), &SMALL);
        assert!(told.contains("invalid_client"), "{told}");
        assert_eq!(counts(&house), ONE);
    }
}

/// Certificates that trust the house's own authority, with the client's where it shows one.
fn tls(own: Option<&str>) -> TlsFiles {
    let key = Secret::File(fhir().path("client.key"));
    let own = own.map(|name| (fhir().path(name), key));
    TlsFiles { authorities: Some(fhir().path("ca.pem")), own }
}

fn store_by(base: String, tls: TlsFiles) -> Store {
    store_of(FhirServer { tls, ..server_at(base) })
}

/// Why a server is not asked, and that it was not.
#[track_caller]
fn refusal(house: &House, base: String, tls: TlsFiles) -> String {
    let before = house.log();
    let fault = store_by(base, tls).reach().unwrap_err();
    assert_eq!(house.log(), before, "{fault}");
    fault.to_string()
}

#[test]
#[ignore = "needs Medplum's FHIR router and openssl, run by .ci/run"]
fn only_a_server_whose_certificate_is_right_is_asked() {
    let house = House::with_patient();
    let base = house.base_by("https");
    put(&store_by(base.clone(), tls(None)), &SMALL);
    assert_eq!(house.counts(), ONE);
    // The system does not know the house's authority.
    let told = refusal(&house, base.clone(), TlsFiles::default());
    assert!(told.contains("UnknownIssuer") || told.contains("no certificates"), "{told}");
    // Another name than the certificate's.
    let other = base.replace("localhost", "127.0.0.1");
    let told = refusal(&house, other, tls(None));
    assert!(told.contains("not valid for name") || told.contains("NotValidForName"), "{told}");
    // A certificate that ran out.
    let told = refusal(&house, house.base_by("expired"), tls(None)).to_lowercase();
    assert!(told.contains("expired"), "{told}");
    // No certificate at all.
    let port = house.server.port("http");
    refusal(&house, format!("https://localhost:{port}/{}", house.name), tls(None));
    fs::write(house.path("broken.pem"), "-----BEGIN CERTIFICATE-----\nAAAA\n").unwrap();
    let broken = TlsFiles { authorities: Some(house.path("broken.pem")), own: None };
    let told = refusal(&house, base, broken);
    assert!(told.contains("broken.pem"), "{told}");
}

#[test]
#[ignore = "needs Medplum's FHIR router and openssl, run by .ci/run"]
fn the_stations_own_certificate_lets_it_in_where_one_is_asked_for() {
    let house = House::with_patient();
    let base = house.base_by("mutual");
    put(&store_by(base.clone(), tls(Some("client.pem"))), &SMALL);
    assert_eq!(house.counts(), ONE);
    refusal(&house, base.clone(), tls(None));
    // Another one's certificate does not fit the key.
    let told = refusal(&house, base, tls(Some("server.pem")));
    assert!(told.contains("server.pem"), "{told}");
}

#[test]
#[ignore = "needs Medplum's FHIR router and openssl, run by .ci/run"]
fn a_proxy_lets_the_connection_through_and_sees_nothing_of_it() {
    let house = House::with_patient();
    let (base, port) = (house.base_by("https"), house.server.port("proxy"));
    let shown = format!("Basic {}", STANDARD.encode("station:offen"));
    fs::write(fhir().path("proxy"), shown).unwrap();
    let by = |password: &str| {
        let password = secret(house.path("proxy-secret"), password);
        let endpoint = Endpoint { host: "127.0.0.1".to_owned(), port, is_encrypted: false };
        let proxy = Some(Proxy { endpoint, user: Some(("station".to_owned(), password)) });
        store_of(FhirServer { tls: tls(None), proxy, ..server_at(base.clone()) })
    };
    assert!(setback(&by("falsch"), &SMALL).contains("407"));
    put(&by("offen"), &SMALL);
    assert_eq!(house.counts(), ONE);
    let proxied = read(&fhir().path("proxied"));
    let server = format!("localhost:{}", house.server.port("https"));
    assert!(!proxied.is_empty() && proxied.lines().all(|line| line == server), "{proxied}");
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap()
}
