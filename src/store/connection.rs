//! Connections to servers that do not speak HTTP. Each exchange has a connection of its own, and one limit for all of
//! it: a server that sends a byte a second is not waited for longer than one that sends none.

use std::io::{self, Read, Write};
use std::net::{IpAddr, SocketAddr, TcpStream, ToSocketAddrs};
use std::sync::mpsc;
use std::thread;
use std::time::{Duration, Instant};

use gaiter_https::{EndpointFault, HttpFault, Secret, TlsFiles, tls};
use rustls::pki_types::ServerName;
use rustls::{ClientConnection, StreamOwned};

/// A server that does not speak HTTP, and how it is reached.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Peer {
    /// Name or address; an address of IPv6 in brackets.
    pub host: String,
    pub port: u16,
    /// What is trusted; `None` for a connection that is not encrypted.
    pub tls: Option<TlsFiles>,
    /// For a whole exchange, from the search for the address to the last byte of the answer.
    pub limit: Duration,
}

impl Peer {
    /// The secret that connections need: the key of the station's certificate.
    pub fn secret(&self) -> Option<&Secret> {
        self.tls.as_ref()?.key()
    }

    /// The host without the brackets of an IPv6 address.
    pub fn name(&self) -> &str {
        self.host.trim_matches(['[', ']'])
    }

    /// Opens a connection and closes it again.
    pub(crate) fn open(&self) -> Result<(), HttpFault> {
        self.connected().map(Connection::close)
    }

    /// A connection, on which nothing was sent yet.
    pub(crate) fn connected(&self) -> Result<Connection, HttpFault> {
        let until = Instant::now() + self.limit;
        // Read first: without its certificates a connection is useless.
        let config = self.tls.as_ref().map(tls::trust).transpose()?;
        let stream = self.tcp(until)?;
        let stream = Timed { stream, until };
        let Some(config) = config else { return Ok(Connection::Plain(stream)) };
        let name = ServerName::try_from(self.name().to_owned());
        let name = name.map_err(|_| HttpFault::Address(EndpointFault::Address))?;
        let client = ClientConnection::new(config, name).map_err(io::Error::other);
        let client = client.map_err(|source| self.fault_in(source, Phase::Handshake))?;
        let mut stream = StreamOwned::new(client, stream);
        let shaken = stream.conn.complete_io(&mut stream.sock);
        shaken.map_err(|source| self.fault_in(source, Phase::Handshake))?;
        Ok(Connection::Encrypted(Box::new(stream)))
    }

    fn tcp(&self, until: Instant) -> Result<TcpStream, HttpFault> {
        let failed = |source| self.fault_in(source, Phase::Connect);
        let addresses = self.addresses(until)?;
        let mut last = io::Error::from(io::ErrorKind::AddrNotAvailable);
        for (at, address) in addresses.iter().enumerate() {
            // One that never answers leaves time for the next.
            let others = u32::try_from(addresses.len() - at).unwrap_or(u32::MAX);
            let share = left(until).map_err(failed)? / others;
            match TcpStream::connect_timeout(address, share) {
                Ok(stream) => {
                    // A message is written at once.
                    stream.set_nodelay(true).map_err(failed)?;
                    return Ok(stream);
                }
                Err(error) => last = error,
            }
        }
        Err(failed(last))
    }

    /// The addresses of the host. The system's resolver knows no limit, so a search that hangs is left behind.
    fn addresses(&self, until: Instant) -> Result<Vec<SocketAddr>, HttpFault> {
        if let Ok(address) = self.name().parse::<IpAddr>() {
            return Ok(vec![SocketAddr::new(address, self.port)]);
        }
        let failed = |source| self.fault_in(source, Phase::Connect);
        let (name, port) = (self.name().to_owned(), self.port);
        let (found, search) = mpsc::channel::<io::Result<Vec<SocketAddr>>>();
        let thread = thread::Builder::new().name("resolve".to_owned()).spawn(move || {
            let addresses = (name.as_str(), port).to_socket_addrs();
            // Fails if nobody waits for it any more.
            let _ = found.send(addresses.map(Iterator::collect));
        });
        thread.map_err(failed)?;
        let found = search.recv_timeout(left(until).map_err(failed)?);
        match found {
            Ok(Ok(addresses)) => Ok(addresses),
            Ok(Err(_)) | Err(_) => Err(HttpFault::UnknownHost { host: self.name().to_owned() }),
        }
    }

    /// What broke an exchange.
    pub(crate) fn fault(&self, source: io::Error) -> HttpFault {
        self.fault_in(source, Phase::Exchange)
    }

    fn fault_in(&self, source: io::Error, phase: Phase) -> HttpFault {
        let host = format!("{}:{}", self.host, self.port);
        match (source.kind(), phase) {
            (io::ErrorKind::TimedOut, _) => HttpFault::TimedOut { limit: self.limit },
            (_, Phase::Connect) => HttpFault::Connect { host, source },
            // How rustls reports an alert of the server, such as that it wants a certificate.
            (io::ErrorKind::InvalidData, _) | (_, Phase::Handshake) => {
                HttpFault::Tls { host, source }
            }
            (_, Phase::Exchange) => HttpFault::Broken { host, source },
        }
    }
}

/// How far an exchange has come.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Phase {
    Connect,
    Handshake,
    Exchange,
}

/// A connection to a server.
pub(crate) enum Connection {
    Plain(Timed),
    Encrypted(Box<StreamOwned<ClientConnection, Timed>>),
}

impl Connection {
    /// From now on nothing is waited for longer than this.
    #[cfg(feature = "dicom")]
    pub fn waits_at_most(&mut self, limit: Duration) {
        let stream = match self {
            Connection::Plain(stream) => stream,
            Connection::Encrypted(stream) => &mut stream.sock,
        };
        stream.until = Instant::now() + limit;
    }

    /// Closes the connection as the protocol requires, whatever the server does with that.
    pub fn close(self) {
        if let Connection::Encrypted(mut stream) = self {
            stream.conn.send_close_notify();
            let _ = stream.conn.write_tls(&mut stream.sock);
        }
    }
}

impl Read for Connection {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        match self {
            Connection::Plain(stream) => stream.read(bytes),
            Connection::Encrypted(stream) => stream.read(bytes),
        }
    }
}

impl Write for Connection {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Connection::Plain(stream) => stream.write(bytes),
            Connection::Encrypted(stream) => stream.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Connection::Plain(stream) => stream.flush(),
            Connection::Encrypted(stream) => stream.flush(),
        }
    }
}

/// A connection on which nothing is waited for beyond a point in time.
pub(crate) struct Timed {
    stream: TcpStream,
    until: Instant,
}

impl Read for Timed {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        self.stream.set_read_timeout(Some(left(self.until)?))?;
        self.stream.read(bytes).map_err(timed_out)
    }
}

impl Write for Timed {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.stream.set_write_timeout(Some(left(self.until)?))?;
        self.stream.write(bytes).map_err(timed_out)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.stream.flush()
    }
}

/// The time that is left.
fn left(until: Instant) -> io::Result<Duration> {
    match until.saturating_duration_since(Instant::now()) {
        Duration::ZERO => Err(io::ErrorKind::TimedOut.into()),
        left => Ok(left),
    }
}

/// A wait that has ended is reported by the system as one that would block.
fn timed_out(error: io::Error) -> io::Error {
    match error.kind() {
        io::ErrorKind::WouldBlock => io::ErrorKind::TimedOut.into(),
        _ => error,
    }
}
