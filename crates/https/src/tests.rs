//! The client against servers of a few lines: what they send, and what it makes of it.

use std::io::{self, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc;
use std::thread;
use std::time::{Duration, Instant};

use http::header::ACCEPT;
use http::{Method, Request, Response};
use rustls::pki_types::pem::PemObject;
use rustls::pki_types::{CertificateDer, PrivateKeyDer};
use rustls::server::WebPkiClientVerifier;
use rustls::{RootCertStore, ServerConfig, ServerConnection, StreamOwned};
use support::http_server::{answer, request_of, serve, serve_answers};

use super::tls::{TlsFault, trust};
use super::{
    ANSWER_MOST, Endpoint, EndpointFault, HttpFault, HttpsClient, Proxy, Secret, TlsFiles,
};

/// Far more than any of these exchanges takes.
const LONG: Duration = Duration::from_secs(30);

fn client(limit: Duration) -> HttpsClient {
    HttpsClient::new(TlsFiles::default(), None, limit)
}

fn get(address: &str) -> Request<Vec<u8>> {
    Request::get(address).header(ACCEPT, "application/fhir+json").body(Vec::new()).unwrap()
}

/// What the client makes of a server that sends these bytes and ends the connection.
fn asked(sent: &str) -> Result<Response<Vec<u8>>, HttpFault> {
    let (port, _requests) = serve_answers(vec![sent.to_owned()]);
    client(LONG).send(get(&format!("http://127.0.0.1:{port}/r4/Patient?identifier=4711")))
}

#[test]
fn a_request_is_sent_whole_and_an_answer_is_read_whatever_its_status_is() {
    let (port, requests) = serve_answers(vec![answer("422 Unprocessable", "{\"a\":1}")]);
    let mut request = get(&format!("http://127.0.0.1:{port}/r4"));
    *request.method_mut() = Method::POST;
    *request.body_mut() = b"{}".to_vec();
    let told = client(LONG).send(request).unwrap();
    assert_eq!((told.status().as_u16(), told.body().as_slice()), (422, &b"{\"a\":1}"[..]));
    let request = requests.try_iter().next().unwrap().to_ascii_lowercase();
    assert!(request.starts_with("post /r4 http/1.1\r\n"), "{request}");
    assert!(request.ends_with("\r\n\r\n{}"), "{request}");
    for line in [
        format!("host: 127.0.0.1:{port}"),
        "accept: application/fhir+json".to_owned(),
        format!("user-agent: gaiter/{}", env!("CARGO_PKG_VERSION")),
    ] {
        assert!(request.contains(&format!("\r\n{line}\r\n")), "{line}: {request}");
    }
    assert!(!request.contains("accept-encoding"), "{request}");
}

#[test]
fn a_redirect_is_not_followed() {
    let elsewhere = TcpListener::bind("127.0.0.1:0").unwrap();
    elsewhere.set_nonblocking(true).unwrap();
    let place = format!("http://{}/", elsewhere.local_addr().unwrap());
    for status in ["301 Moved", "302 Found", "307 Temporary", "308 Permanent"] {
        let head = format!("HTTP/1.1 {status}\r\nLocation: {place}\r\nContent-Length: 0\r\n\r\n");
        assert!(matches!(asked(&head), Err(HttpFault::Redirect)), "{status}");
    }
    assert_eq!(elsewhere.accept().unwrap_err().kind(), io::ErrorKind::WouldBlock);
}

#[test]
fn an_answer_that_is_too_long_is_given_up() {
    let port = serve(|mut stream| {
        request_of(&mut stream).unwrap();
        let _ = stream.write_all(b"HTTP/1.1 200 OK\r\nContent-Length: 104857600\r\n\r\n");
        // It continues until the client has gone.
        while stream.write_all(&[b' '; 65_536]).is_ok() {}
    });
    let fault = client(LONG).send(get(&format!("http://127.0.0.1:{port}/"))).unwrap_err();
    assert!(matches!(fault, HttpFault::TooLong { most } if most as u64 == ANSWER_MOST), "{fault}");
    let head = format!("HTTP/1.1 200 OK\r\nX: {}\r\n\r\n", "x".repeat(100_000));
    assert!(matches!(asked(&head), Err(HttpFault::TooLong { .. })));
}

#[test]
fn an_answer_of_half_its_length_is_none() {
    for sent in [
        "HTTP/1.1 200 OK\r\nContent-Length: 100\r\n\r\nhalf",
        "HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n4\r\nhalf\r\n",
        "HTTP/1.1 200 OK\r\nContent-Le",
        "",
    ] {
        let fault = asked(sent).unwrap_err();
        assert!(matches!(fault, HttpFault::Broken { .. }), "{sent}: {fault}");
    }
    let fault = asked("SSH-2.0-OpenSSH\r\n\r\n").unwrap_err();
    assert!(matches!(fault, HttpFault::NotHttp { .. }), "{fault}");
}

#[test]
fn a_server_that_hangs_or_drips_costs_no_more_than_the_limit() {
    let limit = Duration::from_millis(400);
    let hangs = serve(|mut stream| {
        request_of(&mut stream).unwrap();
        // Until the client goes.
        let _ = io::copy(&mut stream, &mut io::sink());
    });
    let drips = serve(|mut stream| {
        request_of(&mut stream).unwrap();
        let _ = stream.write_all(b"HTTP/1.1 200 OK\r\nContent-Length: 100000\r\n\r\n");
        // A byte whenever nothing has come for so long, until the client goes.
        stream.set_read_timeout(Some(Duration::from_millis(5))).unwrap();
        while stream.read(&mut [0]).is_err() && stream.write_all(b" ").is_ok() {}
    });
    for port in [hangs, drips] {
        let begin = Instant::now();
        let fault = client(limit).send(get(&format!("http://127.0.0.1:{port}/"))).unwrap_err();
        assert!(matches!(fault, HttpFault::TimedOut { .. }), "{fault}");
        assert!(begin.elapsed() >= limit && begin.elapsed() < LONG, "{:?}", begin.elapsed());
    }
}

#[test]
fn what_cannot_be_reached_and_what_must_not_be_asked_are_told_apart() {
    let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let fault = client(LONG).send(get(&format!("http://127.0.0.1:{port}/"))).unwrap_err();
    assert!(matches!(fault, HttpFault::Connect { .. }), "{fault}");
    let fault = client(LONG).send(get("http://fhir.clinic.example/r4")).unwrap_err();
    assert!(matches!(fault, HttpFault::Address(EndpointFault::NotEncrypted)), "{fault}");
}

#[test]
fn no_fault_tells_the_address_that_was_asked_for() {
    for sent in ["", "x\r\n\r\n", "HTTP/1.1 302 Found\r\nLocation: /\r\nContent-Length: 0\r\n\r\n"]
    {
        let fault = asked(sent).unwrap_err();
        for told in [fault.to_string(), format!("{fault:?}"), fault.cause().to_string()] {
            assert!(!told.contains("4711") && !told.contains("identifier"), "{told}");
        }
    }
}

#[test]
fn one_connection_is_used_for_requests_after_each_other() {
    let (sender, connections) = mpsc::channel();
    let port = serve(move |mut stream| {
        sender.send(()).unwrap();
        while request_of(&mut stream).is_ok() {
            stream.write_all(b"HTTP/1.1 200 OK\r\nContent-Length: 2\r\n\r\n{}").unwrap();
        }
    });
    let client = client(LONG);
    for _ in 0..3 {
        client.send(get(&format!("http://127.0.0.1:{port}/"))).unwrap();
    }
    assert_eq!(connections.try_iter().count(), 1);
}

/// A file of `fixtures/tls`: a certificate that stands for itself, or its key.
fn fixture(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/tls").join(name)
}

fn trusting(name: &str) -> TlsFiles {
    TlsFiles { authorities: Some(fixture(name)), own: None }
}

/// Serves one request over TLS with this certificate; a client's must be that of `client`. Returns the port.
fn serve_encrypted(name: &str, client: Option<&str>) -> u16 {
    let provider = Arc::new(rustls::crypto::ring::default_provider());
    let chain = |name: &str| vec![CertificateDer::from_pem_file(fixture(name)).unwrap()];
    let builder = ServerConfig::builder_with_provider(Arc::clone(&provider))
        .with_safe_default_protocol_versions()
        .unwrap();
    let builder = match client {
        None => builder.with_no_client_auth(),
        Some(name) => {
            let mut roots = RootCertStore::empty();
            roots.add_parsable_certificates(chain(name));
            let verifier = WebPkiClientVerifier::builder_with_provider(roots.into(), provider);
            builder.with_client_cert_verifier(verifier.build().unwrap())
        }
    };
    let key = PrivateKeyDer::from_pem_file(fixture(&name.replace(".pem", ".key"))).unwrap();
    let config = Arc::new(builder.with_single_cert(chain(name), key).unwrap());
    serve(move |stream| {
        let connection = ServerConnection::new(Arc::clone(&config)).unwrap();
        let mut stream = StreamOwned::new(connection, stream);
        if request_of(&mut stream).is_ok() {
            let _ = stream.write_all(answer("200 OK", "{}").as_bytes());
            stream.conn.send_close_notify();
            let _ = stream.flush();
        }
    })
}

fn asked_encrypted(port: u16, tls: TlsFiles) -> Result<Response<Vec<u8>>, HttpFault> {
    HttpsClient::new(tls, None, LONG).send(get(&format!("https://127.0.0.1:{port}/")))
}

#[test]
fn only_a_server_with_a_certificate_of_the_own_authority_and_name_is_trusted() {
    let told = asked_encrypted(serve_encrypted("localhost.pem", None), trusting("localhost.pem"));
    assert_eq!(told.unwrap().into_body(), b"{}");
    for (server, trusted, cause) in [
        ("localhost.pem", "other.pem", "is not from an authority that is trusted here"),
        ("other.pem", "other.pem", "is another host's"),
        ("expired.pem", "expired.pem", "has expired"),
    ] {
        let fault = asked_encrypted(serve_encrypted(server, None), trusting(trusted)).unwrap_err();
        assert!(matches!(fault, HttpFault::Tls { .. }), "{server}: {fault}");
        assert!(fault.cause().to_string().ends_with(cause), "{server}: {}", fault.cause());
    }
}

#[test]
fn the_station_shows_its_own_certificate() {
    let own = |name: &str| TlsFiles {
        own: Some((fixture(&format!("{name}.pem")), Secret::File(fixture(&format!("{name}.key"))))),
        ..trusting("localhost.pem")
    };
    let port = serve_encrypted("localhost.pem", Some("other.pem"));
    assert_eq!(asked_encrypted(port, own("other")).unwrap().status(), 200);
    let port = serve_encrypted("localhost.pem", Some("other.pem"));
    assert!(asked_encrypted(port, own("localhost")).is_err());
    let port = serve_encrypted("localhost.pem", Some("other.pem"));
    assert!(asked_encrypted(port, trusting("localhost.pem")).is_err());
}

#[test]
fn certificates_that_cannot_be_used_are_a_fault_before_anything_is_sent() {
    let (cert, key) = (fixture("localhost.pem"), fixture("localhost.key"));
    let of = |authorities: &str, cert: PathBuf, key: PathBuf| TlsFiles {
        authorities: Some(fixture(authorities)),
        own: Some((cert, Secret::File(key))),
    };
    assert!(trust(&of("localhost.pem", cert.clone(), key.clone())).is_ok());
    let fault = |files: &TlsFiles| {
        let sent = HttpsClient::new(files.clone(), None, LONG).send(get("https://127.0.0.1:1/"));
        assert!(matches!(sent, Err(HttpFault::Certificates(_))), "{sent:?}");
        trust(files).unwrap_err()
    };
    let no_authority = fault(&of("localhost.key", cert.clone(), key.clone()));
    assert!(matches!(no_authority, TlsFault::NoCertificate(_)), "{no_authority}");
    let no_file = fault(&of("missing.pem", cert.clone(), key.clone()));
    assert!(matches!(no_file, TlsFault::File { .. }), "{no_file}");
    let no_key = fault(&of("localhost.pem", cert.clone(), cert.clone()));
    assert!(matches!(no_key, TlsFault::NoKey(_)), "{no_key}");
    let other_key = fault(&of("localhost.pem", cert, fixture("other.key")));
    assert!(matches!(other_key, TlsFault::Own { .. }), "{other_key}");
}

#[test]
fn what_goes_through_a_proxy_is_encrypted_for_it() {
    let behind = serve_encrypted("localhost.pem", None);
    let (sender, requests) = mpsc::channel();
    let proxy = serve(move |mut stream| {
        let request = request_of(&mut stream).unwrap();
        let may = request.contains("Proxy-Authorization: Basic c3RhdGlvbjp3b3JkQCUgMQ==\r\n");
        sender.send(request).unwrap();
        if !may {
            let _ = stream.write_all(b"HTTP/1.1 407 No\r\nContent-Length: 0\r\n\r\n");
            return;
        }
        let mut server = TcpStream::connect(("127.0.0.1", behind)).unwrap();
        stream.write_all(b"HTTP/1.1 200 Connected\r\n\r\n").unwrap();
        let (mut from_server, mut to_client) =
            (server.try_clone().unwrap(), stream.try_clone().unwrap());
        thread::spawn(move || io::copy(&mut from_server, &mut to_client));
        let _ = io::copy(&mut stream, &mut server);
    });
    let dir = tempfile::tempdir().unwrap();
    let password = dir.path().join("password");
    std::fs::write(&password, "word@% 1\n").unwrap();
    let endpoint = Endpoint { host: "127.0.0.1".to_owned(), port: proxy, is_encrypted: false };
    let asked = |user: Option<(String, Secret)>| {
        let proxy = Proxy { endpoint: endpoint.clone(), user };
        let client = HttpsClient::new(trusting("localhost.pem"), Some(proxy), LONG);
        client.send(get("https://localhost:8443/r4"))
    };
    let user = Some(("station".to_owned(), Secret::File(password)));
    assert_eq!(asked(user).unwrap().into_body(), b"{}");
    assert!(requests.try_iter().next().unwrap().starts_with("CONNECT localhost:8443 HTTP/1.1\r\n"));
    assert!(matches!(asked(None), Err(HttpFault::Proxy(_))));
}
