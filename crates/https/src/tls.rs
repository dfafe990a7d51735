//! Whom a connection trusts: the system's authorities or an own one, and the station's own certificate.
//! Verification is never off.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use jiff::Timestamp;
use rustls::crypto::CryptoProvider;
use rustls::pki_types::pem::PemObject;
use rustls::pki_types::{CertificateDer, PrivateKeyDer};
use rustls::{ClientConfig, RootCertStore};
use ureq::tls::{Certificate, ClientCert, PrivateKey, RootCerts, TlsConfig};

use super::endpoint::{Secret, TlsFiles};
use super::secret::{self, SecretFault};
use super::validity;

/// Why there is no safe connection at all.
#[derive(Debug, thiserror::Error)]
pub enum TlsFault {
    /// A file of certificates cannot be read.
    #[error("{}: {source}", path.display())]
    File { path: PathBuf, source: io::Error },
    /// A file has no certificate, or one that cannot be understood.
    #[error("{}: it holds no certificate (PEM) that can be used", .0.display())]
    NoCertificate(PathBuf),
    /// The system has no authorities.
    #[error("the system has no certificates of authorities (Debian: ca-certificates)")]
    NoSystemAuthorities,
    /// The key cannot be read.
    #[error(transparent)]
    Secret(#[from] SecretFault),
    /// The key is none.
    #[error("{0}: it holds no private key (PEM)")]
    NoKey(Secret),
    /// Certificate and key do not belong together, or cannot be used.
    #[error("{}: {source}", path.display())]
    Own {
        /// The certificate's file.
        path: PathBuf,
        source: rustls::Error,
    },
    /// The cryptography of this build lacks the protocol.
    #[error("TLS cannot be used: {0}")]
    Protocol(rustls::Error),
}

/// What the files hold.
struct Certificates {
    roots: Vec<CertificateDer<'static>>,
    /// The station's certificate, those between it and the authority, and its key (PEM).
    own: Option<(Vec<CertificateDer<'static>>, String)>,
}

/// What a connection trusts, and how the station shows who it is.
///
/// # Errors
/// See [`TlsFault`].
pub fn trust(files: &TlsFiles) -> Result<Arc<ClientConfig>, TlsFault> {
    Ok(Arc::new(config(files, &read(files)?)?))
}

/// When the first certificate of a file ends; `None` if its validity is not well-formed.
///
/// # Errors
/// If the file cannot be read, or holds no certificate.
pub fn holds_until(path: &Path) -> Result<Option<Timestamp>, TlsFault> {
    let first = certificates(path)?.into_iter().next();
    Ok(first.and_then(|first| validity::not_after(&first)))
}

/// What a connection of the HTTPS client trusts.
pub(super) fn of_client(files: &TlsFiles) -> Result<TlsConfig, TlsFault> {
    let read = read(files)?;
    // The client panics on a certificate that does not fit its key; here that is a fault.
    config(files, &read)?;
    let roots: Vec<Certificate<'static>> = read.roots.iter().map(of_der).collect();
    let mut own = None;
    if let (Some((_, secret)), Some((chain, pem))) = (&files.own, &read.own) {
        let chain: Vec<Certificate<'static>> = chain.iter().map(of_der).collect();
        let key = PrivateKey::from_pem(pem.as_bytes());
        let key = key.map_err(|_| TlsFault::NoKey(secret.clone()))?;
        own = Some(ClientCert::new_with_certs(&chain, key));
    }
    let config = TlsConfig::builder().root_certs(RootCerts::new_with_certs(&roots));
    Ok(config.client_cert(own).unversioned_rustls_crypto_provider(provider()).build())
}

fn of_der(der: &CertificateDer<'static>) -> Certificate<'static> {
    Certificate::from_der(der).to_owned()
}

fn provider() -> Arc<CryptoProvider> {
    Arc::new(rustls::crypto::ring::default_provider())
}

fn read(files: &TlsFiles) -> Result<Certificates, TlsFault> {
    let roots = match &files.authorities {
        Some(path) => certificates(path)?,
        None => rustls_native_certs::load_native_certs().certs,
    };
    let mut own = None;
    if let Some((path, secret)) = &files.own {
        own = Some((certificates(path)?, secret::read(secret)?));
    }
    Ok(Certificates { roots, own })
}

/// The certificates of a file, in its order; at least one.
fn certificates(path: &Path) -> Result<Vec<CertificateDer<'static>>, TlsFault> {
    let pem = fs::read(path).map_err(|source| TlsFault::File { path: path.to_owned(), source })?;
    let read: Result<Vec<CertificateDer<'static>>, _> =
        CertificateDer::pem_slice_iter(&pem).collect();
    match read {
        Ok(read) if !read.is_empty() => Ok(read),
        _ => Err(TlsFault::NoCertificate(path.to_owned())),
    }
}

fn config(files: &TlsFiles, read: &Certificates) -> Result<ClientConfig, TlsFault> {
    let mut roots = RootCertStore::empty();
    let (added, ignored) = roots.add_parsable_certificates(read.roots.iter().cloned());
    match &files.authorities {
        Some(path) if added == 0 || ignored > 0 => {
            return Err(TlsFault::NoCertificate(path.clone()));
        }
        // Some of the system's that this build cannot use do not matter, as long as others are left.
        None if added == 0 => return Err(TlsFault::NoSystemAuthorities),
        _ => {}
    }
    let builder = ClientConfig::builder_with_provider(provider())
        .with_safe_default_protocol_versions()
        .map_err(TlsFault::Protocol)?
        .with_root_certificates(roots);
    let (Some((path, secret)), Some((chain, pem))) = (&files.own, &read.own) else {
        return Ok(builder.with_no_client_auth());
    };
    let key = PrivateKeyDer::from_pem_slice(pem.as_bytes());
    let key = key.map_err(|_| TlsFault::NoKey(secret.clone()))?;
    let own = |source| TlsFault::Own { path: path.clone(), source };
    builder.with_client_auth_cert(chain.clone(), key).map_err(own)
}
