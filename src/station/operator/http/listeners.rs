//! The addresses at which the station listens, and its control socket. They belong to the process and outlive
//! a reload: while workers change, clients get a notice or wait, and no other program on this machine can
//! take an address.

use std::collections::BTreeMap;
use std::fs::{self, Permissions};
use std::io;
use std::net::SocketAddr;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use listenfd::ListenFd;
use rustix::io::{FdFlags, fcntl_setfd};
use tokio::net::{TcpListener, UnixListener};
use tokio::sync::{Mutex, watch};
use tokio::task::JoinHandle;

use super::serve::{Answers, accept};
use crate::config::{Config, control_path};
use crate::store::durable;

/// The control socket is for the station's user and root only.
const SOCKET_MODE: u32 = 0o600;

gaiter_leg::word_enum! {
    /// The endpoint through which a client comes.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
    pub enum Way {
        /// From this machine: may read, and may decide with the token.
        Local => "local",
        /// From the local network: may read.
        Network => "network",
        /// By the control socket, as the station's user or root: may do what the verbs do.
        Control => "control",
    }
}

/// The endpoints that are open.
#[derive(Debug, Default)]
pub struct Listeners(Mutex<BTreeMap<Way, Listening>>);

/// An endpoint that is open.
#[derive(Debug, Clone)]
pub struct Opened {
    /// Its address; `None` for the control socket.
    pub address: Option<SocketAddr>,
    pub answers: watch::Sender<Answers>,
}

/// Where an endpoint is wanted.
#[derive(Debug, PartialEq)]
enum ListenAddress {
    /// An address; if it is not the service manager's, its port may be 0.
    Tcp(SocketAddr),
    Socket(PathBuf),
}

#[derive(Debug)]
struct Listening {
    place: ListenAddress,
    opened: Opened,
    task: JoinHandle<()>,
}

impl Listeners {
    /// Opens an endpoint, unless it is open already; any other of this way is closed. `None` if no such
    /// endpoint is configured.
    ///
    /// # Errors
    /// If its place is not available.
    pub async fn open(&self, config: &Config, way: Way) -> io::Result<Option<Opened>> {
        let mut all = self.0.lock().await;
        let last = all.remove(&way);
        let passed = if way == Way::Control { None } else { passed(config, way)? };
        let place = match (way, passed) {
            (Way::Control, _) => {
                Some(ListenAddress::Socket(control_path(&config.station.state_dir)))
            }
            (_, Some(passed)) => Some(ListenAddress::Tcp(passed.local_addr()?)),
            (Way::Local, None) => config.status.listen.map(ListenAddress::Tcp),
            (Way::Network, None) => config.page.network.map(ListenAddress::Tcp),
        };
        let listening = match (last, place) {
            (Some(last), Some(place)) if last.place == place => last,
            (last, place) => {
                if let Some(last) = last {
                    last.close().await;
                }
                let Some(place) = place else { return Ok(None) };
                Listening::begin(place, passed, Answers::none(config.language))?
            }
        };
        let opened = listening.opened.clone();
        all.insert(way, listening);
        Ok(Some(opened))
    }
}

impl Listening {
    fn begin(
        place: ListenAddress,
        passed: Option<&std::net::TcpListener>,
        answers: Answers,
    ) -> io::Result<Listening> {
        let (answers, asked) = watch::channel(answers);
        let (address, task) = match &place {
            ListenAddress::Socket(path) => {
                let listener = control_socket(path)?;
                (None, tokio::spawn(accept(listener, asked)))
            }
            ListenAddress::Tcp(address) => {
                let listener = match passed {
                    Some(passed) => passed.try_clone()?,
                    None => std::net::TcpListener::bind(address)?,
                };
                listener.set_nonblocking(true)?;
                let listener = TcpListener::from_std(listener)?;
                let address = listener.local_addr()?;
                (Some(address), tokio::spawn(accept(listener, asked)))
            }
        };
        Ok(Listening { place, opened: Opened { address, answers }, task })
    }

    /// Closes it before another one needs its port.
    async fn close(mut self) {
        self.task.abort();
        let _ = (&mut self.task).await;
    }
}

impl Drop for Listening {
    fn drop(&mut self) {
        self.task.abort();
        if let ListenAddress::Socket(path) = &self.place {
            // The next start creates it again in any case.
            let _ = fs::remove_file(path);
        }
    }
}

/// Creates the control socket in place of an old one; the state folder's lock proves that no one serves
/// it.
fn control_socket(path: &Path) -> io::Result<UnixListener> {
    durable::remove_file(path)?;
    let listener = UnixListener::bind(path)?;
    // Until now, the state folder kept others out because only its owner can enter it.
    fs::set_permissions(path, Permissions::from_mode(SOCKET_MODE))?;
    Ok(listener)
}

/// The sockets that the service manager has passed to this process.
static PASSED: OnceLock<Vec<std::net::TcpListener>> = OnceLock::new();

/// The passed socket that belongs to this endpoint, if any. An address that other machines can reach
/// must be the configured one, so that it was chosen on purpose.
fn passed(config: &Config, way: Way) -> io::Result<Option<&'static std::net::TcpListener>> {
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
            return Ok(Some(listener));
        }
    }
    Ok(None)
}
