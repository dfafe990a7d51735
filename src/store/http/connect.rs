//! The way to a server: directly or through a proxy, with TLS unless it is this machine.

use std::io;
use std::pin::Pin;
use std::task::{Context, Poll};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use tokio::io::{AsyncRead, AsyncReadExt, AsyncWrite, AsyncWriteExt, ReadBuf};
use tokio::net::TcpStream;
use tokio_rustls::TlsConnector;
use tokio_rustls::client::TlsStream;
use tokio_rustls::rustls::pki_types::ServerName;

use super::fault::HttpFault;
use super::tls::trust;
use crate::flow::server::{Endpoint, EndpointFault, Proxy, TlsFiles};
use crate::store::secret;

/// The longest answer of a proxy before the connection is through, bytes.
const PROXY_MOST: usize = 8192;

/// A connection, encrypted or not.
#[derive(Debug)]
pub enum Stream {
    /// To this machine.
    Plain(TcpStream),
    /// To another one.
    Encrypted(Box<TlsStream<TcpStream>>),
}

/// Opens a connection.
///
/// # Errors
/// See [`HttpFault`].
pub async fn stream(
    endpoint: &Endpoint,
    proxy: Option<&Proxy>,
    tls: &TlsFiles,
) -> Result<Stream, HttpFault> {
    let tcp = match proxy {
        None => tcp(endpoint).await?,
        Some(proxy) => through(proxy, endpoint).await?,
    };
    match endpoint.is_encrypted {
        false => Ok(Stream::Plain(tcp)),
        true => {
            let name = endpoint.name();
            let of_server = ServerName::try_from(name.to_owned());
            let of_server = of_server.map_err(|_| EndpointFault::Address)?;
            let connected = TlsConnector::from(trust(tls)?).connect(of_server, tcp).await;
            let refused = |source| HttpFault::Tls { host: name.to_owned(), source };
            Ok(Stream::Encrypted(Box::new(connected.map_err(refused)?)))
        }
    }
}

async fn tcp(endpoint: &Endpoint) -> Result<TcpStream, HttpFault> {
    let connected = TcpStream::connect((endpoint.name(), endpoint.port)).await;
    let stream =
        connected.map_err(|source| HttpFault::Connect { host: endpoint.authority(), source })?;
    // A request is written at once.
    let _ = stream.set_nodelay(true);
    Ok(stream)
}

/// A connection that a proxy lets through.
async fn through(proxy: &Proxy, endpoint: &Endpoint) -> Result<TcpStream, HttpFault> {
    let mut stream = tcp(&proxy.endpoint).await?;
    let failed = |source| HttpFault::Connect { host: proxy.endpoint.authority(), source };
    let Endpoint { host, port, .. } = endpoint;
    let user = match &proxy.user {
        None => String::new(),
        Some((user, password)) => {
            let user = STANDARD.encode(format!("{user}:{}", secret::read(password)?));
            format!("Proxy-Authorization: Basic {user}\r\n")
        }
    };
    let asked = format!("CONNECT {host}:{port} HTTP/1.1\r\nHost: {host}:{port}\r\n{user}\r\n");
    stream.write_all(asked.as_bytes()).await.map_err(failed)?;
    let mut head = Vec::new();
    while !head.ends_with(b"\r\n\r\n") {
        if head.len() == PROXY_MOST {
            return Err(HttpFault::Proxy("more than a proxy's answer".to_owned()));
        }
        head.push(stream.read_u8().await.map_err(failed)?);
    }
    let head = String::from_utf8_lossy(&head);
    let status = head.lines().next().unwrap_or_default();
    match status.split(' ').nth(1) {
        Some(code) if code.starts_with('2') => Ok(stream),
        _ => Err(HttpFault::Proxy(status.chars().filter(|of| !of.is_control()).take(80).collect())),
    }
}

impl AsyncRead for Stream {
    fn poll_read(
        self: Pin<&mut Self>,
        context: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        match self.get_mut() {
            Stream::Plain(stream) => Pin::new(stream).poll_read(context, buffer),
            Stream::Encrypted(stream) => Pin::new(stream).poll_read(context, buffer),
        }
    }
}

impl AsyncWrite for Stream {
    fn poll_write(
        self: Pin<&mut Self>,
        context: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<io::Result<usize>> {
        match self.get_mut() {
            Stream::Plain(stream) => Pin::new(stream).poll_write(context, bytes),
            Stream::Encrypted(stream) => Pin::new(stream).poll_write(context, bytes),
        }
    }

    fn poll_flush(self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        match self.get_mut() {
            Stream::Plain(stream) => Pin::new(stream).poll_flush(context),
            Stream::Encrypted(stream) => Pin::new(stream).poll_flush(context),
        }
    }

    fn poll_shutdown(self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        match self.get_mut() {
            Stream::Plain(stream) => Pin::new(stream).poll_shutdown(context),
            Stream::Encrypted(stream) => Pin::new(stream).poll_shutdown(context),
        }
    }
}
