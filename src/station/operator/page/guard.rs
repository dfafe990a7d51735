//! Admits requests that name this endpoint as their host, and from the network only reads. A page of
//! another site whose name points to this machine (DNS rebinding) names that host and is refused.

use std::net::{IpAddr, SocketAddr};
use std::sync::Arc;

use axum::extract::{Request, State};
use axum::http::{HeaderMap, HeaderValue, Method, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

use super::endpoint::HttpEndpoint;
use crate::station::operator::http::listeners::Way;

/// What a page of this station may do: show what comes from here, and nothing else.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; \
                      connect-src 'self'; base-uri 'none'; form-action 'none'; \
                      frame-ancestors 'none'";

/// Admits a request or answers why not, and sets the headers of every answer.
pub async fn guard(
    State(endpoint): State<Arc<HttpEndpoint>>,
    request: Request,
    next: Next,
) -> Response {
    let mut response = match refusal(&endpoint, &request) {
        Some(refused) => refused,
        None => next.run(request).await,
    };
    let headers = response.headers_mut();
    for (name, value) in [
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::REFERRER_POLICY, "no-referrer"),
        (header::CACHE_CONTROL, "no-store"),
        (header::HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
    ] {
        headers.insert(name, HeaderValue::from_static(value));
    }
    let policy = headers.entry(header::CONTENT_SECURITY_POLICY);
    policy.or_insert(HeaderValue::from_static(POLICY));
    response
}

fn refusal(endpoint: &HttpEndpoint, request: &Request) -> Option<Response> {
    // No browser reaches the control socket, and whom it lets in may do everything.
    let address = endpoint.address?;
    if !host(request.headers()).is_some_and(|host| names(host, address)) {
        let sentence = format!("this is http://{address}/; no other host name is accepted\n");
        return Some((StatusCode::MISDIRECTED_REQUEST, sentence).into_response());
    }
    let reads = [Method::GET, Method::HEAD].contains(request.method());
    (endpoint.way == Way::Network && !reads).then(|| {
        let sentence = "no decisions over the network, because without TLS the token could be \
                        intercepted; open the page on the station itself\n";
        (StatusCode::FORBIDDEN, sentence).into_response()
    })
}

/// The host that a request names.
pub fn host(headers: &HeaderMap) -> Option<&str> {
    headers.get(header::HOST).and_then(|host| host.to_str().ok())
}

/// Whether a host, with or without a port, is the one at this address. Only addresses and `localhost`
/// count: any other name could be made to point here.
fn names(host: &str, address: SocketAddr) -> bool {
    let (name, port) = match host.rsplit_once(':') {
        // The colons of an IPv6 address without a port are inside brackets.
        Some((name, port)) if !port.ends_with(']') => (name, Some(port)),
        _ => (host, None),
    };
    let is_port = port.is_none_or(|port| port.parse() == Ok(address.port()));
    let name = name.trim_start_matches('[').trim_end_matches(']');
    let is_name = match name.parse::<IpAddr>() {
        Ok(ip) => ip == address.ip() || address.ip().is_unspecified(),
        Err(_) => address.ip().is_loopback() && name.eq_ignore_ascii_case("localhost"),
    };
    is_port && is_name
}

/// Whether a request comes from a page of this same endpoint.
pub fn is_own(headers: &HeaderMap) -> bool {
    let origin = headers.get(header::ORIGIN).and_then(|origin| origin.to_str().ok());
    let origin = origin.and_then(|origin| origin.strip_prefix("http://"));
    origin.is_some() && origin == host(headers)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_door_s_own_address_is_a_host() {
        let local = "127.0.0.1:9184".parse().unwrap();
        for host in ["127.0.0.1:9184", "127.0.0.1", "localhost:9184", "LocalHost"] {
            assert!(names(host, local), "{host}");
        }
        for host in [
            "",
            "evil.example",
            "evil.example:9184",
            "127.0.0.1:80",
            "127.0.0.2:9184",
            "localhost.",
        ] {
            assert!(!names(host, local), "{host}");
        }
        let six = "[::1]:9184".parse().unwrap();
        assert!(names("[::1]:9184", six) && names("[::1]", six) && !names("[::2]:9184", six));
        let network = "192.168.1.20:9180".parse().unwrap();
        assert!(names("192.168.1.20:9180", network) && !names("localhost:9180", network));
        let any = "0.0.0.0:9180".parse().unwrap();
        assert!(names("192.168.1.20:9180", any) && !names("booth.example:9180", any));
    }

    #[test]
    fn a_decision_comes_from_the_door_s_own_page() {
        let own = |origin: Option<&str>| {
            let host = [(header::HOST, "127.0.0.1:9184")].into_iter();
            let pairs = host.chain(origin.map(|origin| (header::ORIGIN, origin)));
            is_own(&pairs.map(|(name, value)| (name, value.parse().unwrap())).collect())
        };
        assert!(own(Some("http://127.0.0.1:9184")));
        for wrong in
            ["null", "http://evil.example", "https://127.0.0.1:9184", "http://localhost:9184"]
        {
            assert!(!own(Some(wrong)), "{wrong}");
        }
        assert!(!own(None));
    }
}
