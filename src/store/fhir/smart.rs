//! SMART Backend Services: a signed statement of the station for a token (HL7, SMART App Launch 2, Backend
//! Services).

use std::time::Duration;

use base64::Engine;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;
use gaiter_https::{EndpointFault, HttpFault, HttpsClient, escaped, secret};
use gaiter_record::fhir::outcome::in_a_line;
use gaiter_record::hex;
use http::header::{ACCEPT, CONTENT_TYPE};
use http::{Method, Request};
use jiff::Timestamp;
use ring::rand::{SecureRandom, SystemRandom};
use ring::signature::{
    ECDSA_P384_SHA384_FIXED_SIGNING, EcdsaKeyPair, RSA_PKCS1_SHA384, RsaKeyPair,
};
use rustls::pki_types::PrivatePkcs8KeyDer;
use rustls::pki_types::pem::PemObject;
use serde_json::{Value, json};

use super::server::SmartAccess;
use crate::store::server::{ServerFault, TokenFault};

/// How long a statement holds, s: five minutes at most, by the specification.
const STATEMENT_S: i64 = 240;

/// How long a token is valid if the server does not state its end: short enough that it is renewed in time.
const LASTS_USUALLY: Duration = Duration::from_secs(120);

/// A token is never used for longer.
const LASTS_MOST: Duration = Duration::from_secs(24 * 60 * 60);

/// The kind of the statement.
const KIND: &str = "urn:ietf:params:oauth:client-assertion-type:jwt-bearer";

/// Asks for a token. Returns it and how long it holds.
pub(super) fn token(
    client: &HttpsClient,
    smart: &SmartAccess,
    base: &str,
) -> Result<(String, Duration), ServerFault> {
    let address = match &smart.token_address {
        Some(address) => address.clone(),
        None => discovered(client, base)?,
    };
    let key = secret::read(&smart.key).map_err(HttpFault::from)?;
    let statement = statement(smart, &key, &address, Timestamp::now())?;
    let fields = [
        ("grant_type", "client_credentials"),
        ("scope", &smart.scope),
        ("client_assertion_type", KIND),
        ("client_assertion", &statement),
    ];
    let answer = asked(client, Method::POST, &address, form(&fields), &[&statement])?;
    let value = answer["access_token"].as_str().filter(|token| !token.is_empty());
    let value = value.ok_or(TokenFault::NotThere)?;
    let lasts = answer["expires_in"].as_u64().map_or(LASTS_USUALLY, Duration::from_secs);
    Ok((value.to_owned(), lasts.min(LASTS_MOST)))
}

/// Where the server gives tokens.
fn discovered(client: &HttpsClient, base: &str) -> Result<String, ServerFault> {
    let address = format!("{base}/.well-known/smart-configuration");
    let configuration = asked(client, Method::GET, &address, String::new(), &[])?;
    let place = configuration["token_endpoint"].as_str();
    Ok(place.map(str::to_owned).ok_or(TokenFault::NoPlace)?)
}

/// Sends a form, if it is not empty, and reads the answer as JSON.
fn asked(
    client: &HttpsClient,
    method: Method,
    address: &str,
    form: String,
    secret: &[&str],
) -> Result<Value, ServerFault> {
    let mut request =
        Request::builder().method(method).uri(address).header(ACCEPT, "application/json");
    if !form.is_empty() {
        request = request.header(CONTENT_TYPE, "application/x-www-form-urlencoded");
    }
    let request = request.body(form.into_bytes());
    let answer = client.send(request.map_err(|_| TokenFault::Place(EndpointFault::Address))?)?;
    let json: Value = serde_json::from_slice(answer.body()).unwrap_or_default();
    if answer.status().is_success() {
        return Ok(json);
    }
    // OAuth reports an error as a code and a sentence (RFC 6749, 5.2).
    let parts = [&json["error"], &json["error_description"]].map(|part| part.as_str());
    let parts: Vec<&str> = parts.into_iter().flatten().collect();
    let why = match parts.is_empty() {
        true => "it does not say why".to_owned(),
        false => in_a_line(&parts.join(", "), secret),
    };
    Err(TokenFault::Refused { status: answer.status().as_u16(), why }.into())
}

/// The statement (RFC 7523) for an address at this time, signed with a key (PKCS#8 as PEM).
fn statement(
    smart: &SmartAccess,
    pem: &str,
    address: &str,
    now: Timestamp,
) -> Result<String, TokenFault> {
    let key = PrivatePkcs8KeyDer::from_pem_slice(pem.as_bytes()).map_err(|_| TokenFault::Key)?;
    let random = SystemRandom::new();
    let mut number = [0; 16];
    random.fill(&mut number).map_err(|_| TokenFault::NotSigned)?;
    let claims = json!({
        "iss": smart.client, "sub": smart.client, "aud": address, "jti": hex(&number),
        "iat": now.as_second(), "exp": now.as_second() + STATEMENT_S,
    });
    let part = |json: &Value| URL_SAFE_NO_PAD.encode(json.to_string());
    let by = |algorithm: &str| {
        let mut head = json!({ "alg": algorithm, "typ": "JWT" });
        if !smart.key_id.is_empty() {
            head["kid"] = smart.key_id.clone().into();
        }
        format!("{}.{}", part(&head), part(&claims))
    };
    let (text, signature) = signed(key.secret_pkcs8_der(), &random, by)?;
    Ok(format!("{text}.{}", URL_SAFE_NO_PAD.encode(signature)))
}

/// Signs with a private key of PKCS#8 what `by` makes of the name of the algorithm (RFC 7518, 3.1). Returns both.
fn signed(
    key: &[u8],
    random: &SystemRandom,
    by: impl Fn(&str) -> String,
) -> Result<(String, Vec<u8>), TokenFault> {
    let not_signed = |_| TokenFault::NotSigned;
    if let Ok(key) = EcdsaKeyPair::from_pkcs8(&ECDSA_P384_SHA384_FIXED_SIGNING, key, random) {
        let text = by("ES384");
        let signature = key.sign(random, text.as_bytes()).map_err(not_signed)?;
        return Ok((text, signature.as_ref().to_vec()));
    }
    let key = RsaKeyPair::from_pkcs8(key).map_err(|_| TokenFault::Key)?;
    let text = by("RS384");
    let mut signature = vec![0; key.public().modulus_len()];
    key.sign(&RSA_PKCS1_SHA384, random, text.as_bytes(), &mut signature).map_err(not_signed)?;
    Ok((text, signature))
}

/// Fields as a form (application/x-www-form-urlencoded).
fn form(fields: &[(&str, &str)]) -> String {
    let field = |(name, text): &(&str, &str)| format!("{name}={}", escaped(text, false));
    fields.iter().map(field).collect::<Vec<_>>().join("&")
}

#[cfg(test)]
mod tests {
    use base64::engine::general_purpose::STANDARD;
    use ring::signature::{
        ECDSA_P384_SHA384_FIXED, KeyPair, RSA_PKCS1_2048_8192_SHA384, UnparsedPublicKey,
        VerificationAlgorithm,
    };

    use super::*;
    use gaiter_https::Secret;

    const ADDRESS: &str = "https://fhir.clinic.example/token";

    fn smart(key_id: &str) -> SmartAccess {
        SmartAccess {
            client: "gaiter-booth-1".to_owned(),
            key: Secret::Credential("unused".to_owned()),
            key_id: key_id.to_owned(),
            scope: "system/Patient.rs".to_owned(),
            token_address: None,
        }
    }

    fn pem(der: &[u8]) -> String {
        format!(
            "-----BEGIN PRIVATE KEY-----\n{}\n-----END PRIVATE KEY-----\n",
            STANDARD.encode(der)
        )
    }

    fn json_of(part: &str) -> Value {
        serde_json::from_slice(&URL_SAFE_NO_PAD.decode(part).unwrap()).unwrap()
    }

    /// Checks the signature and returns head and claims.
    fn checked(statement: &str, by: &'static dyn VerificationAlgorithm, key: &[u8]) -> [Value; 2] {
        let (signed, signature) = statement.rsplit_once('.').unwrap();
        let signature = URL_SAFE_NO_PAD.decode(signature).unwrap();
        UnparsedPublicKey::new(by, key).verify(signed.as_bytes(), &signature).unwrap();
        let (head, claims) = signed.split_once('.').unwrap();
        [json_of(head), json_of(claims)]
    }

    #[test]
    fn a_statement_is_signed_by_es384_and_names_client_place_and_a_short_time() {
        let random = SystemRandom::new();
        let der = EcdsaKeyPair::generate_pkcs8(&ECDSA_P384_SHA384_FIXED_SIGNING, &random).unwrap();
        let pair =
            EcdsaKeyPair::from_pkcs8(&ECDSA_P384_SHA384_FIXED_SIGNING, der.as_ref(), &random);
        let public = pair.unwrap().public_key().as_ref().to_vec();
        let now: Timestamp = "2026-11-21T09:15:00Z".parse().unwrap();
        let made = || statement(&smart("key-1"), &pem(der.as_ref()), ADDRESS, now).unwrap();
        let [head, claims] = checked(&made(), &ECDSA_P384_SHA384_FIXED, &public);
        assert_eq!(head, json!({ "alg": "ES384", "typ": "JWT", "kid": "key-1" }));
        for (claim, value) in
            [("iss", "gaiter-booth-1"), ("sub", "gaiter-booth-1"), ("aud", ADDRESS)]
        {
            assert_eq!(claims[claim], value);
        }
        assert_eq!(claims["iat"], now.as_second());
        let lasts_s = claims["exp"].as_i64().unwrap() - now.as_second();
        assert!((1..=300).contains(&lasts_s), "{lasts_s}");
        let [_, again] = checked(&made(), &ECDSA_P384_SHA384_FIXED, &public);
        assert_ne!(claims["jti"], again["jti"]);
    }

    #[test]
    fn an_rsa_key_signs_by_rs384() {
        let key = include_str!("../../../fixtures/tls/rsa.key");
        let made = statement(&smart(""), key, ADDRESS, Timestamp::UNIX_EPOCH).unwrap();
        let der = PrivatePkcs8KeyDer::from_pem_slice(key.as_bytes()).unwrap();
        let public = RsaKeyPair::from_pkcs8(der.secret_pkcs8_der()).unwrap();
        let public = public.public().as_ref().to_vec();
        let [head, _] = checked(&made, &RSA_PKCS1_2048_8192_SHA384, &public);
        assert_eq!(head, json!({ "alg": "RS384", "typ": "JWT" }));
    }

    #[test]
    fn what_is_no_key_to_sign_with_is_told_without_its_content() {
        let word = "c2VjcmV0";
        for text in ["", word, &pem(b"secret"), "-----BEGIN CERTIFICATE-----\nc2VjcmV0\n"] {
            let fault = statement(&smart(""), text, ADDRESS, Timestamp::UNIX_EPOCH).unwrap_err();
            assert_eq!(fault, TokenFault::Key);
            assert!(!fault.to_string().contains(word));
        }
    }

    #[test]
    fn a_form_is_escaped() {
        let fields = [("scope", "system/Patient.rs system/Device.crs"), ("x", "a&b=ü")];
        assert_eq!(
            form(&fields),
            "scope=system%2FPatient.rs%20system%2FDevice.crs&x=a%26b%3D%C3%BC"
        );
    }
}
