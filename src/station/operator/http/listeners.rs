//! The listeners of the endpoints. They belong to the process and outlive a reload: while workers
//! change, clients wait in the kernel, and no other program on this machine can take the address.

use std::collections::BTreeMap;
use std::io;
use std::net::SocketAddr;
use std::sync::{Mutex, OnceLock, PoisonError};

use listenfd::ListenFd;
use rustix::io::{FdFlags, fcntl_setfd};
use tokio::net::TcpListener;

use crate::config::Config;

/// The endpoint through which a client comes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Way {
    /// From this machine: may read, and may decide with the token.
    Local,
    /// From the local network: may read.
    Network,
}

impl Way {
    /// Its word in the log.
    pub fn word(self) -> &'static str {
        match self {
            Way::Local => "local",
            Way::Network => "network",
        }
    }
}

/// The listeners that the station itself has opened.
#[derive(Debug, Default)]
pub struct Listeners(Mutex<BTreeMap<Way, Held>>);

#[derive(Debug)]
struct Held {
    /// The configured address; its port may be 0.
    wanted: SocketAddr,
    listener: std::net::TcpListener,
}

impl Listeners {
    /// An endpoint's listener and its address; `None` if no such endpoint is configured.
    ///
    /// # Errors
    /// If the address is not available.
    pub fn take(&self, config: &Config, way: Way) -> io::Result<Option<(TcpListener, SocketAddr)>> {
        let wanted = match way {
            Way::Local => config.status.listen,
            Way::Network => config.page.network,
        };
        let listener = match given(config, way)? {
            Some(given) => Some(given),
            None => self.held(way, wanted)?,
        };
        let Some(listener) = listener else { return Ok(None) };
        listener.set_nonblocking(true)?;
        let listener = TcpListener::from_std(listener)?;
        let address = listener.local_addr()?;
        Ok(Some((listener, address)))
    }

    /// The listener at this address, opened if necessary; any other of this endpoint is closed.
    fn held(
        &self,
        way: Way,
        wanted: Option<SocketAddr>,
    ) -> io::Result<Option<std::net::TcpListener>> {
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(wanted) = wanted else {
            all.remove(&way);
            return Ok(None);
        };
        if let Some(known) = all.get(&way).filter(|known| known.wanted == wanted) {
            return known.listener.try_clone().map(Some);
        }
        all.remove(&way);
        let listener = std::net::TcpListener::bind(wanted)?;
        let listens = listener.try_clone()?;
        all.insert(way, Held { wanted, listener });
        Ok(Some(listens))
    }
}

/// The sockets that the service manager has passed to this process.
static PASSED: OnceLock<Vec<std::net::TcpListener>> = OnceLock::new();

/// The passed socket that belongs to this endpoint, if any. An address that other machines can reach
/// must be the configured one, so that it was chosen on purpose.
fn given(config: &Config, way: Way) -> io::Result<Option<std::net::TcpListener>> {
    let passed = PASSED.get_or_init(|| {
        let mut passed = ListenFd::from_env();
        (0..passed.len()).filter_map(|at| passed.take_tcp_listener(at).ok().flatten()).collect()
    });
    for listener in passed {
        // Measuring child processes must not inherit it.
        fcntl_setfd(listener, FdFlags::CLOEXEC)?;
        let address = listener.local_addr()?;
        let its_way = match address.ip().is_loopback() {
            true => Way::Local,
            false if config.page.network == Some(address) => Way::Network,
            false => {
                let message = "the socket unit listens on an address that other machines can \
                               reach, but page.network is a different address";
                return Err(io::Error::new(io::ErrorKind::AddrNotAvailable, message));
            }
        };
        if its_way == way {
            return listener.try_clone().map(Some);
        }
    }
    Ok(None)
}
