//! The listeners of the endpoints. They belong to the process and outlive a reload: while workers
//! change, clients are told so, and no other program on this machine can take the address.

use std::collections::BTreeMap;
use std::io;
use std::net::SocketAddr;
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

use listenfd::ListenFd;
use rustix::io::{FdFlags, fcntl_setfd};
use tokio::net::TcpListener;
use tokio::task::JoinHandle;

use crate::config::Config;
use crate::station::runtime::stop::{Stop, Stopper};

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

/// The listeners that the station itself has opened, and who answers at them between two generations.
#[derive(Debug, Default)]
pub struct Listeners {
    held: Mutex<BTreeMap<Way, Held>>,
    changeovers: Mutex<BTreeMap<Way, Changeover>>,
}

/// The task that answers during a changeover.
#[derive(Debug)]
struct Changeover {
    stopper: Stopper,
    task: JoinHandle<()>,
}

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
    pub async fn take(
        &self,
        config: &Config,
        way: Way,
    ) -> io::Result<Option<(TcpListener, SocketAddr)>> {
        let wanted = match way {
            Way::Local => config.status.listen,
            Way::Network => config.page.network,
        };
        let listener = match given(config, way)? {
            Some(given) => Some(given),
            None => {
                if !self.is_held(way, wanted) {
                    // Another address may need the port of the last one.
                    self.end_changeover(way).await;
                }
                self.held(way, wanted)?
            }
        };
        let Some(listener) = listener else { return Ok(None) };
        listener.set_nonblocking(true)?;
        let listener = TcpListener::from_std(listener)?;
        let address = listener.local_addr()?;
        Ok(Some((listener, address)))
    }

    /// Begins a changeover. `answers` runs until its request to stop.
    pub fn begin_changeover<F>(&self, way: Way, answers: impl FnOnce(Stop) -> F)
    where
        F: Future<Output = ()> + Send + 'static,
    {
        let (stopper, stop) = Stopper::new();
        let task = tokio::spawn(answers(stop));
        self.changeovers().insert(way, Changeover { stopper, task });
    }

    /// Ends a changeover, if there is one. Its listener is closed on return.
    pub async fn end_changeover(&self, way: Way) {
        let ended = self.changeovers().remove(&way);
        if let Some(Changeover { stopper, task }) = ended {
            stopper.request();
            // A panic has closed the listener, too.
            let _ = task.await;
        }
    }

    fn changeovers(&self) -> MutexGuard<'_, BTreeMap<Way, Changeover>> {
        self.changeovers.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn is_held(&self, way: Way, wanted: Option<SocketAddr>) -> bool {
        let all = self.held.lock().unwrap_or_else(PoisonError::into_inner);
        wanted.is_some() && all.get(&way).map(|known| known.wanted) == wanted
    }

    /// The listener at this address, opened if necessary; any other of this endpoint is closed.
    fn held(
        &self,
        way: Way,
        wanted: Option<SocketAddr>,
    ) -> io::Result<Option<std::net::TcpListener>> {
        let mut all = self.held.lock().unwrap_or_else(PoisonError::into_inner);
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
