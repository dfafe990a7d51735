//! SMART Backend Services: a signed statement of the station for a token (HL7, SMART App Launch 2, Backend
//! Services).

use std::time::Duration;

use base64::Engine;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;
use hyper::Method;
use hyper::header::{ACCEPT, CONTENT_TYPE, HeaderValue};
use jiff::Timestamp;
use ring::rand::{SecureRandom, SystemRandom};
use ring::signature::{
    ECDSA_P384_SHA384_FIXED_SIGNING, EcdsaKeyPair, RSA_PKCS1_SHA384, RsaKeyPair,
};
use serde_json::{Value, json};
use tokio_rustls::rustls::pki_types::PrivatePkcs8KeyDer;
use tokio_rustls::rustls::pki_types::pem::PemObject;

use crate::flow::server::fhir::SmartAccess;
use crate::record::fhir::outcome::in_a_line;
use crate::record::hex;
use crate::store::http::{HttpClient, HttpRequest};
use crate::store::secret;
use crate::store::server::ServerFault;

/// How long a statement holds: five minutes at most, by the specification.
const STATEMENT_S: i64 = 240;

/// How long a token holds whose end the server does not tell: short enough that it is renewed in time.
const LASTS_USUALLY: Duration = Duration::from_secs(120);

/// The kind of the statement.
const KIND: &str = "urn:ietf:params:oauth:client-assertion-type:jwt-bearer";

/// Asks for a token. Returns it and how long it holds.
pub(super) fn token(
    client: &HttpClient,
    smart: &SmartAccess,
    base: &str,
) -> Result<(String, Duration), ServerFault> {
    let address = match &smart.token_address {
        Some(address) => address.clone(),
        None => discovered(client, base)?,
    };
    let statement = statement(smart, &address, Timestamp::now())?;
    let fields = [
        ("grant_type", "client_credentials"),
        ("scope", &smart.scope),
        ("client_assertion_type", KIND),
        ("client_assertion", &statement),
    ];
    let answer = json_of(client, Method::POST, &address, form(&fields).into_bytes())?;
    let value = answer["access_token"].as_str().filter(|token| !token.is_empty());
    let Some(value) = value else {
        return Err(no_token("the answer holds none"));
    };
    let lasts = answer["expires_in"].as_u64().map_or(LASTS_USUALLY, Duration::from_secs);
    Ok((value.to_owned(), lasts))
}

/// Where the server gives tokens.
fn discovered(client: &HttpClient, base: &str) -> Result<String, ServerFault> {
    let address = format!("{base}/.well-known/smart-configuration");
    let configuration = json_of(client, Method::GET, &address, Vec::new())?;
    let told = configuration["token_endpoint"].as_str();
    told.map(str::to_owned).ok_or_else(|| {
        no_token("the server does not say where tokens are given (.well-known/smart-configuration)")
    })
}

fn json_of(
    client: &HttpClient,
    method: Method,
    address: &str,
    body: Vec<u8>,
) -> Result<Value, ServerFault> {
    let uri = address.parse().map_err(|_| no_token("the address for tokens is none"))?;
    let form = HeaderValue::from_static("application/x-www-form-urlencoded");
    let json = HeaderValue::from_static("application/json");
    let headers = match method == Method::POST {
        true => vec![(ACCEPT, json), (CONTENT_TYPE, form)],
        false => vec![(ACCEPT, json)],
    };
    let answer = client.send(HttpRequest { method, uri, headers, body })?;
    let json: Value = serde_json::from_slice(&answer.body).unwrap_or_default();
    if answer.is_success() {
        return Ok(json);
    }
    // OAuth tells an error by a code and a sentence (RFC 6749, 5.2).
    let told = [&json["error"], &json["error_description"]].map(|part| part.as_str());
    let told: Vec<&str> = told.into_iter().flatten().collect();
    Err(no_token(&format!("{}: {}", answer.status, in_a_line(&told.join(", "), &[]))))
}

fn no_token(why: &str) -> ServerFault {
    ServerFault::NoToken(why.to_owned())
}

/// The signed statement (RFC 7523) for an address at this time.
fn statement(smart: &SmartAccess, address: &str, now: Timestamp) -> Result<String, ServerFault> {
    let pem = secret::read(&smart.key)?;
    let wrong = || no_token("the key is no private key of P-384 or RSA as PKCS#8 (PEM)");
    let key = PrivatePkcs8KeyDer::from_pem_slice(pem.as_bytes()).map_err(|_| wrong())?;
    let der = key.secret_pkcs8_der();
    let random = SystemRandom::new();
    let mut number = [0; 16];
    random.fill(&mut number).map_err(|_| no_token("the machine has no random numbers"))?;
    let ec = EcdsaKeyPair::from_pkcs8(&ECDSA_P384_SHA384_FIXED_SIGNING, der, &random);
    let algorithm = if ec.is_ok() { "ES384" } else { "RS384" };
    let mut head = json!({ "alg": algorithm, "typ": "JWT" });
    if !smart.key_id.is_empty() {
        head["kid"] = smart.key_id.clone().into();
    }
    let claims = json!({
        "iss": smart.client, "sub": smart.client, "aud": address, "jti": hex(&number),
        "iat": now.as_second(), "exp": now.as_second() + STATEMENT_S,
    });
    let part = |json: &Value| URL_SAFE_NO_PAD.encode(json.to_string());
    let signed = format!("{}.{}", part(&head), part(&claims));
    let failed = |_| no_token("the statement cannot be signed");
    let signature = match ec {
        Ok(key) => key.sign(&random, signed.as_bytes()).map_err(failed)?.as_ref().to_vec(),
        Err(_) => {
            let key = RsaKeyPair::from_pkcs8(der).map_err(|_| wrong())?;
            let mut signature = vec![0; key.public().modulus_len()];
            key.sign(&RSA_PKCS1_SHA384, &random, signed.as_bytes(), &mut signature)
                .map_err(failed)?;
            signature
        }
    };
    Ok(format!("{signed}.{}", URL_SAFE_NO_PAD.encode(signature)))
}

/// Fields as a form (application/x-www-form-urlencoded).
fn form(fields: &[(&str, &str)]) -> String {
    let escaped = |text: &str| {
        let byte = |byte: u8| match byte {
            b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' | b'-' | b'.' | b'_' | b'*' => {
                char::from(byte).to_string()
            }
            byte => format!("%{byte:02X}"),
        };
        text.bytes().map(byte).collect::<String>()
    };
    let field = |(name, text): &(&str, &str)| format!("{name}={}", escaped(text));
    fields.iter().map(field).collect::<Vec<_>>().join("&")
}
