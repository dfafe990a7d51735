//! Whom a connection trusts: the system's roots or an own CA, and the station's own certificate.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use tokio_rustls::rustls::crypto::ring;
use tokio_rustls::rustls::pki_types::pem::{self, PemObject};
use tokio_rustls::rustls::pki_types::{CertificateDer, PrivateKeyDer};
use tokio_rustls::rustls::{self, ClientConfig, RootCertStore};

use crate::flow::server::TlsFiles;
use crate::store::secret::{self, SecretFault};

/// Why there is no safe connection at all.
#[derive(Debug, thiserror::Error)]
pub enum TlsFault {
    /// A file cannot be read as PEM.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        source: pem::Error,
    },
    /// The key is a credential that is not there.
    #[error(transparent)]
    Key(#[from] SecretFault),
    /// A file has no certificate, or one that cannot be understood.
    #[error("{}: it holds no certificate of an authority that can be used", .0.display())]
    NoAuthority(PathBuf),
    /// The system has no authorities.
    #[error("the system has no certificates of authorities (Debian: ca-certificates)")]
    NoSystemAuthorities,
    /// Certificate and key do not belong together, or cannot be used.
    #[error("{}: {source}", path.display())]
    Own {
        /// The certificate's file.
        path: PathBuf,
        /// Why.
        source: rustls::Error,
    },
    /// The cryptography of this build lacks the protocol.
    #[error("TLS cannot be used: {0}")]
    Protocol(rustls::Error),
}

/// What a connection trusts, and how the station shows who it is. Verification is never off.
///
/// # Errors
/// See [`TlsFault`].
pub(super) fn trust(files: &TlsFiles) -> Result<Arc<ClientConfig>, TlsFault> {
    let roots = match &files.authorities {
        Some(path) => authorities(path)?,
        None => of_the_system()?,
    };
    let provider = Arc::new(ring::default_provider());
    let builder = ClientConfig::builder_with_provider(provider)
        .with_safe_default_protocol_versions()
        .map_err(TlsFault::Protocol)?
        .with_root_certificates(roots);
    let config = match &files.own {
        None => builder.with_no_client_auth(),
        Some((certificate, key)) => {
            let chain = certificates(certificate)?;
            let path = secret::path(key)?;
            let read = PrivateKeyDer::from_pem_file(&path);
            let key = read.map_err(|source| TlsFault::File { path, source })?;
            let own = |source| TlsFault::Own { path: certificate.clone(), source };
            builder.with_client_auth_cert(chain, key).map_err(own)?
        }
    };
    Ok(Arc::new(config))
}

fn certificates(path: &Path) -> Result<Vec<CertificateDer<'static>>, TlsFault> {
    let file = |source| TlsFault::File { path: path.to_owned(), source };
    let read = CertificateDer::pem_file_iter(path).map_err(file)?;
    read.collect::<Result<_, _>>().map_err(file)
}

fn authorities(path: &Path) -> Result<RootCertStore, TlsFault> {
    let mut roots = RootCertStore::empty();
    let (added, ignored) = roots.add_parsable_certificates(certificates(path)?);
    match added > 0 && ignored == 0 {
        true => Ok(roots),
        false => Err(TlsFault::NoAuthority(path.to_owned())),
    }
}

/// The authorities of the system. Some that this build cannot use do not matter, as long as others are left.
fn of_the_system() -> Result<RootCertStore, TlsFault> {
    let mut roots = RootCertStore::empty();
    let (added, _) =
        roots.add_parsable_certificates(rustls_native_certs::load_native_certs().certs);
    if added == 0 { Err(TlsFault::NoSystemAuthorities) } else { Ok(roots) }
}
