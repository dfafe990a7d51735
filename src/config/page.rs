//! The keys of `[page]`: who may read the operator's page, and whether it shows patients' ids.

use std::net::SocketAddr;

use gaiter_flow::page::IdsShown;

use super::parse::{self, Reader, What};
use super::words::IDS_SHOWN;

/// `[page]`: who may read the operator's page, and what it shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PageConfig {
    /// Address at which others on the local network may read the page and nothing else; `None` if off.
    pub network: Option<SocketAddr>,
    /// To whom patients' ids are shown.
    pub ids: IdsShown,
}

/// Reads the keys.
pub(super) fn config(reader: &mut Reader) -> Option<PageConfig> {
    let network = reader.value("page.network", "off", reachable)?;
    let ids = reader.value("page.patient_ids", "operator", parse::word(IDS_SHOWN))?;
    Some(PageConfig { network, ids })
}

/// `"off"`, or an address that other machines can reach.
fn reachable(text: &str) -> Result<Option<SocketAddr>, What> {
    let hint = r#"write "off", or this machine's address on the local network and a port: "192.168.1.20:9180""#;
    match parse::address_or_off(text, hint)? {
        Some(address) if address.ip().is_loopback() => {
            let message = format!("\"{text}\" cannot be reached from other machines");
            Err(What::own(message, hint))
        }
        address => Ok(address),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_network_s_address_is_one_that_others_can_reach() {
        assert_eq!(reachable("off"), Ok(None));
        for text in ["192.168.1.20:9180", "0.0.0.0:9180", "[fd00::1]:9180"] {
            assert_eq!(reachable(text), Ok(Some(text.parse().unwrap())), "{text}");
        }
        for text in ["127.0.0.1:9180", "[::1]:9180"] {
            let message = format!("\"{text}\" cannot be reached from other machines");
            assert_eq!(reachable(text).unwrap_err().to_string(), message);
        }
        for text in ["", "on", "192.168.1.20", "booth:9180"] {
            let message = format!("\"{text}\" is not an address and port");
            assert_eq!(reachable(text).unwrap_err().to_string(), message);
        }
    }
}
