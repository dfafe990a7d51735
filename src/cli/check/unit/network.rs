//! Whether the system service may reach the servers that the configuration names. It has no network unless a
//! drop-in opens what is needed.

use std::fs;
use std::net::{IpAddr, ToSocketAddrs};

use gaiter_https::{Endpoint, Secret};

use super::super::row::{Row, Verdict};
use super::Unit;
use crate::config::Config;
#[cfg(feature = "dicom")]
use crate::store::dicom::DicomServer;
use crate::store::fhir::FhirAccess;

/// The port of which nothing but the host's address is asked.
const ANY_PORT: u16 = 0;

/// The file that names the name servers.
const RESOLVER: &str = "/etc/resolv.conf";

/// A row for each server that the service cannot reach.
pub(super) fn rows(unit: &Unit<'_>, config: &Config) -> Vec<Row> {
    let servers = hosts(config).into_iter().filter_map(|host| {
        let addresses = addresses(&host);
        let why = closed(unit, &addresses)?;
        let named: Vec<String> = addresses.iter().map(IpAddr::to_string).collect();
        let detail = format!(
            "cannot be reached by gaiter.service ({why}): copy /usr/share/gaiter/gaiter-network.conf to \
             /etc/systemd/system/gaiter.service.d/ if it is not there, write IPAddressAllow={} in it, then \
             systemctl daemon-reload and systemctl restart gaiter",
            named.join(" ")
        );
        Some(Row::at("service", host, Verdict::Fail, detail))
    });
    servers.collect()
}

/// A row for each credential that the files of the service do not give it.
pub(super) fn credentials(files: &str, config: &Config) -> Vec<Row> {
    let missing = named(config).into_iter().filter(|name| !given(files).contains(name));
    let rows = missing.map(|name| {
        let detail = format!(
            "not given to gaiter.service: write LoadCredential={name}:FILE in \
             /etc/systemd/system/gaiter.service.d/gaiter-network.conf, then systemctl daemon-reload and \
             systemctl restart gaiter"
        );
        Row::at("service", format!("credential {name}"), Verdict::Fail, detail)
    });
    rows.collect()
}

/// The hosts that the station connects to.
fn hosts(config: &Config) -> Vec<String> {
    let mut hosts = Vec::new();
    if let Some(fhir) = &config.store.fhir {
        let server = &fhir.server;
        let token = match &server.access {
            FhirAccess::Smart(smart) => smart.token_address.as_deref().and_then(host_of),
            _ => None,
        };
        match &server.proxy {
            Some(proxy) => hosts.push(proxy.endpoint.name().to_owned()),
            None => hosts.extend(host_of(&server.base).into_iter().chain(token)),
        }
    }
    #[cfg(feature = "dicom")]
    {
        hosts.extend(config.store.dicom.iter().filter_map(|of| match &of.server {
            DicomServer::Web { base, .. } => host_of(base),
            DicomServer::Dimse(server) => Some(server.peer.name().to_owned()),
        }));
        hosts.extend(config.patient.worklist.iter().map(|of| of.server.peer.name().to_owned()));
    }
    if let Some(archive) = &config.store.archive {
        hosts.extend(host_of(&archive.place.bucket.address));
    }
    let receiver = config.store.hl7.as_ref().and_then(|hl7| hl7.way.receiver());
    hosts.extend(receiver.map(|receiver| receiver.name().to_owned()));
    hosts.dedup();
    hosts
}

fn host_of(address: &str) -> Option<String> {
    Some(Endpoint::from_uri(&address.parse().ok()?).ok()?.name().to_owned())
}

/// The addresses of a host, and those of the name servers if it is a name.
fn addresses(host: &str) -> Vec<IpAddr> {
    if let Ok(address) = host.parse() {
        return vec![address];
    }
    let found = (host, ANY_PORT).to_socket_addrs().into_iter().flatten().map(|of| of.ip());
    let resolver = fs::read_to_string(RESOLVER).unwrap_or_default();
    let mut all: Vec<IpAddr> = found.chain(name_servers(&resolver)).collect();
    all.sort_unstable();
    all.dedup();
    all
}

fn name_servers(resolver: &str) -> Vec<IpAddr> {
    let lines = resolver.lines().filter_map(|line| line.strip_prefix("nameserver"));
    lines.filter_map(|address| address.trim().parse().ok()).collect()
}

/// Which setting keeps the service from an address; `None` if it may reach them all.
fn closed(unit: &Unit<'_>, addresses: &[IpAddr]) -> Option<&'static str> {
    if unit.get("PrivateNetwork") == "yes" {
        return Some("PrivateNetwork");
    }
    let families = unit.get("RestrictAddressFamilies");
    let may_use = |family: &str| match families.strip_prefix('~') {
        Some(denied) => !denied.split_whitespace().any(|of| of == family),
        None => families.is_empty() || families.split_whitespace().any(|of| of == family),
    };
    let family = |address: &IpAddr| if address.is_ipv4() { "AF_INET" } else { "AF_INET6" };
    if addresses.iter().any(|address| !may_use(family(address))) {
        return Some("RestrictAddressFamilies");
    }
    // An address of the one list is let through, whatever is in the other (systemd.resource-control(5)).
    let is_in = |list: &str, address: &IpAddr| {
        unit.get(list).split_whitespace().any(|range| is_within(address, range))
    };
    let is_denied =
        |address: &&IpAddr| !is_in("IPAddressAllow", address) && is_in("IPAddressDeny", address);
    addresses.iter().find(is_denied).map(|_| "IPAddressDeny")
}

/// Whether an address is within a range such as `10.1.0.0/16`.
fn is_within(address: &IpAddr, range: &str) -> bool {
    let (base, bits) = range.split_once('/').map_or((range, None), |(of, bits)| (of, Some(bits)));
    let Ok(base) = base.parse::<IpAddr>() else { return false };
    let (of_address, of_base, width) = match (address, base) {
        (IpAddr::V4(a), IpAddr::V4(b)) => (u128::from(a.to_bits()), u128::from(b.to_bits()), 32),
        (IpAddr::V6(a), IpAddr::V6(b)) => (a.to_bits(), b.to_bits(), 128),
        _ => return false,
    };
    let bits: u32 = bits.and_then(|bits| bits.parse().ok()).unwrap_or(width);
    let is_free = width.saturating_sub(bits);
    // A shift by all 128 bits leaves nothing to differ.
    (of_address ^ of_base).checked_shr(is_free).unwrap_or(0) == 0
}

/// The credentials that the configuration names.
fn named(config: &Config) -> Vec<&str> {
    let fhir = config.store.fhir.as_ref().map(|fhir| fhir.server.secrets()).unwrap_or_default();
    let hl7 = config.store.hl7.as_ref().and_then(|hl7| hl7.way.receiver()?.secret());
    let archive = config.store.archive.as_ref();
    let archive = archive.map(|archive| archive.place.secrets()).unwrap_or_default();
    let secrets = fhir.into_iter().chain(hl7).chain(archive);
    #[cfg(feature = "dicom")]
    let secrets = secrets
        .chain(config.store.dicom.iter().flat_map(|of| of.server.secrets()))
        .chain(config.patient.worklist.iter().filter_map(|of| of.server.peer.secret()));
    let named = secrets.filter_map(|secret| match secret {
        Secret::Credential(name) => Some(name.as_str()),
        Secret::File(_) => None,
    });
    named.collect()
}

/// The credentials that the lines of a unit give. An empty line takes back those above it (systemd.exec(5)).
fn given(files: &str) -> Vec<&str> {
    let mut given = Vec::new();
    for (key, value) in files.lines().filter_map(|line| line.split_once('=')) {
        match (key.trim(), value.trim()) {
            ("LoadCredential" | "LoadCredentialEncrypted" | "SetCredential", "") => given.clear(),
            ("LoadCredential" | "LoadCredentialEncrypted" | "SetCredential", value) => {
                given.extend(value.split(':').next());
            }
            _ => {}
        }
    }
    given
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHIPPED: &str = "PrivateNetwork=yes\nRestrictAddressFamilies=AF_UNIX\n\
        IPAddressAllow=127.0.0.0/8 ::1/128\nIPAddressDeny=::/0 0.0.0.0/0\n";

    fn why(shown: &str, addresses: &[&str]) -> Option<&'static str> {
        let addresses: Vec<IpAddr> = addresses.iter().map(|of| of.parse().unwrap()).collect();
        closed(&Unit::new(shown), &addresses)
    }

    #[test]
    fn the_shipped_service_reaches_nothing_and_with_the_drop_in_what_is_named() {
        for address in ["127.0.0.1", "10.1.2.3", "fd00::7"] {
            assert_eq!(why(SHIPPED, &[address]), Some("PrivateNetwork"), "{address}");
        }
        let half = SHIPPED.replace("=yes", "=no");
        assert_eq!(why(&half, &["127.0.0.1"]), Some("RestrictAddressFamilies"));
        let opened = half.replace("AF_UNIX", "AF_INET6 AF_UNIX AF_INET");
        assert_eq!(why(&opened, &["127.0.0.1", "::1"]), None);
        assert_eq!(why(&opened, &["10.1.2.3"]), Some("IPAddressDeny"));
        let named = opened.replace("::1/128", "::1/128 10.1.2.3/32 10.1.2.53/32");
        assert_eq!(why(&named, &["10.1.2.3", "10.1.2.53"]), None);
        assert_eq!(why(&named, &["10.1.2.3", "10.1.2.4"]), Some("IPAddressDeny"));
        assert_eq!(why(&named, &["fd00::7"]), Some("IPAddressDeny"));
    }

    #[test]
    fn a_service_without_limits_reaches_everything() {
        assert_eq!(why("PrivateNetwork=no\nRestrictAddressFamilies=\n", &["10.1.2.3"]), None);
        assert_eq!(why("RestrictAddressFamilies=~AF_PACKET AF_INET6\n", &["10.1.2.3"]), None);
        let denied = why("RestrictAddressFamilies=~AF_PACKET AF_INET6\n", &["fd00::7"]);
        assert_eq!(denied, Some("RestrictAddressFamilies"));
    }

    #[test]
    fn a_range_holds_the_addresses_of_its_first_bits() {
        let of = |address: &str, range: &str| is_within(&address.parse().unwrap(), range);
        assert!(of("10.1.255.3", "10.1.0.0/16") && !of("10.2.0.0", "10.1.0.0/16"));
        assert!(of("203.0.113.9", "0.0.0.0/0") && of("fd00::1", "::/0"));
        assert!(!of("10.1.2.3", "::/0") && !of("10.1.2.3", "any"));
        assert!(of("10.1.2.3", "10.1.2.3") && !of("10.1.2.2", "10.1.2.3/32"));
    }

    #[test]
    fn name_servers_are_those_of_the_resolver() {
        let text =
            "# made by hand\nsearch clinic.example\nnameserver 10.1.2.53\nnameserver\tfd00::53\n";
        let expected: [IpAddr; 2] = ["10.1.2.53".parse().unwrap(), "fd00::53".parse().unwrap()];
        assert_eq!(name_servers(text), expected);
    }

    #[test]
    fn credentials_are_those_of_the_lines_that_hold() {
        let files = "# /usr/lib/systemd/system/gaiter.service\n[Service]\nExecStart=/usr/bin/gaiter run\n\
            LoadCredential=old:/x\nLoadCredential=\n\n# drop-in\nLoadCredential=fhir:/etc/gaiter/fhir.key\n\
            LoadCredentialEncrypted = hl7\n#LoadCredential=no:/x\n";
        assert_eq!(given(files), ["fhir", "hl7"]);
    }
}
