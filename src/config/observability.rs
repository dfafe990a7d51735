//! The keys of `[status]`: how the station is observed.

use std::net::SocketAddr;
use std::os::unix::ffi::OsStrExt;
use std::path::{Path, PathBuf};

use toml::de::DeTable;

use super::StatusConfig;
use super::parse::{self, Absent, Found, Reader, What};
use super::removed::REMOVED;

/// The name of the control socket in the state folder.
pub const CONTROL_SOCKET: &str = "control.sock";

/// The longest path of a socket, bytes: the 108 of `sockaddr_un.sun_path` minus the final 0.
const SOCKET_PATH_MOST: usize = 107;

/// The keys of `[status]`.
pub(super) fn status(reader: &mut Reader) -> Option<StatusConfig> {
    let overdue = reader.value("status.overdue", "10m", parse::duration_in("1s"..="24h"))?;
    let listen = reader.value("status.listen", "off", loopback)?;
    Some(StatusConfig { overdue, listen })
}

/// Notes a state folder whose path is too long for the socket in it.
pub(super) fn control_socket(reader: &mut Reader, state_dir: Option<&Found<PathBuf>>) {
    let Some(state_dir) = state_dir else { return };
    let most = SOCKET_PATH_MOST - CONTROL_SOCKET.len() - 1;
    let length = state_dir.value.as_os_str().as_bytes().len();
    if length > most {
        let message =
            format!("has {length} bytes; the station's control socket in it allows {most}");
        let what = What::own(message, "choose a shorter path: \"/var/lib/gaiter\"");
        reader.note(state_dir.at.clone(), "station.state_dir", what);
    }
}

/// The control socket of the station with this state folder.
pub fn control_path(state_dir: &Path) -> PathBuf {
    state_dir.join(CONTROL_SOCKET)
}

/// The state folder that a text names, regardless of its other faults: a station that refused a changed
/// configuration continues with the old one, and must still be found.
pub fn state_dir(text: &str) -> Option<PathBuf> {
    let (root, _) = DeTable::parse_recoverable(text);
    let mut reader = Reader::new(text, root.get_ref(), &[], REMOVED);
    let required = Absent::Required("/var/lib/gaiter");
    reader.text("station.state_dir", required, parse::full_path).map(|found| found.value)
}

/// `"off"`, or an address that other machines cannot reach.
fn loopback(text: &str) -> Result<Option<SocketAddr>, What> {
    let hint = r#"write "off", or an address of this machine and a port: "127.0.0.1:9184""#;
    match parse::address_or_off(text, hint)? {
        Some(address) if !address.ip().is_loopback() => {
            let message = format!("\"{text}\" can be reached from other machines");
            let hint = r#"the address must be on this machine: "127.0.0.1:9184""#;
            Err(What::own(message, hint))
        }
        address => Ok(address),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_state_folder_is_found_in_a_file_with_faults() {
        let text = "[station]\nstate_dir = \"/s\"\ncolour = 1\n[scanner]\nquiet = \"2 sec\"\n[x";
        assert!(crate::config::load(text).is_err());
        assert_eq!(state_dir(text), Some(PathBuf::from("/s")));
        for none in ["", "[station]\n", "[station]\nstate_dir = 7\n", "state_dir = \"s\"\n"] {
            assert_eq!(state_dir(none), None, "{none}");
        }
    }

    #[test]
    fn only_addresses_of_this_machine_are_listened_on() {
        assert_eq!(loopback("off"), Ok(None));
        for text in ["127.0.0.1:9184", "127.8.8.8:1", "[::1]:9184", "127.0.0.1:0"] {
            assert_eq!(loopback(text), Ok(Some(text.parse().unwrap())), "{text}");
        }
        for text in ["0.0.0.0:9184", "[::]:9184", "192.168.1.4:9184", "[::ffff:10.0.0.1]:80"] {
            let message = format!("\"{text}\" can be reached from other machines");
            assert_eq!(loopback(text).unwrap_err().to_string(), message);
        }
        for text in ["", "on", "9184", ":9184", "127.0.0.1", "localhost:9184", "127.0.0.1:99999"] {
            let message = format!("\"{text}\" is not an address and port");
            assert_eq!(loopback(text).unwrap_err().to_string(), message);
        }
    }
}
