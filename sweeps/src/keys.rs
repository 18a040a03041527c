//! The keys of a cluster: TLS on every connection, with certificates on both sides.
//!
//! A directory of keys holds `ca.pem`, the certificate of an authority, and `certificate.pem` with `key.pem`, a
//! certificate that this authority has signed for the name [`NAME`]. Every process of a cluster has the same
//! directory: to have it is to belong to the cluster. The name is fixed, so that machines may have any address.

use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use ballista_core::extension::EndpointOverrideFn;
use rcgen::{
    BasicConstraints, CertificateParams, DnType, ExtendedKeyUsagePurpose, IsCa, Issuer, KeyPair,
    KeyUsagePurpose,
};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tonic::transport::{Certificate, ClientTlsConfig, Endpoint, Identity, ServerTlsConfig};

use crate::failure::Failure;

/// The name for which certificates are made.
pub const NAME: &str = "hodograph-cluster";

/// The files of a directory of keys.
const FILES: [&str; 3] = ["ca.pem", "certificate.pem", "key.pem"];

/// The first byte of a TLS alert, with which a server with TLS answers what is not TLS.
const ALERT: u8 = 0x15;

/// The longest time to wait for an answer.
const PATIENCE: Duration = Duration::from_secs(10);

/// The keys of a cluster, as read from a directory.
#[derive(Clone)]
pub struct Keys {
    folder: PathBuf,
    authority: Certificate,
    identity: Identity,
}

impl fmt::Debug for Keys {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "Keys({})", self.folder.display())
    }
}

impl PartialEq for Keys {
    fn eq(&self, other: &Self) -> bool {
        self.folder == other.folder
    }
}

impl Eq for Keys {}

impl Keys {
    /// Reads a directory of keys.
    ///
    /// # Errors
    ///
    /// A file is missing, or its content is no certificate or key.
    pub fn read(folder: &Path) -> Result<Self, Failure> {
        let [authority, certificate, key] = FILES.map(|name| {
            let path = folder.join(name);
            std::fs::read(&path).map_err(|error| {
                Failure::Input(format!(
                    "--tls: cannot read {}: {error}. `hodograph-sweep keys {}` makes keys; every process of the cluster needs the same",
                    path.display(),
                    folder.display()
                ))
            })
        });
        let keys = Self {
            folder: folder.to_owned(),
            authority: Certificate::from_pem(authority?),
            identity: Identity::from_pem(certificate?, key?),
        };
        keys.endpoint(Endpoint::from_static("https://127.0.0.1"))?;
        Ok(keys)
    }

    /// What servers present, and demand of their clients.
    pub fn server(&self) -> ServerTlsConfig {
        ServerTlsConfig::new().identity(self.identity.clone()).client_ca_root(self.authority.clone())
    }

    /// The endpoint with the same address that is reached by TLS with these keys.
    ///
    /// # Errors
    ///
    /// The keys are damaged.
    pub fn endpoint(&self, plain: Endpoint) -> Result<Endpoint, Failure> {
        let damaged = |error: tonic::transport::Error| {
            Failure::Input(format!(
                "--tls {}: these are no usable keys: {}",
                self.folder.display(),
                cause(&error)
            ))
        };
        let authority = plain.uri().authority().map_or_else(String::new, ToString::to_string);
        let tls = ClientTlsConfig::new()
            .ca_certificate(self.authority.clone())
            .identity(self.identity.clone())
            .domain_name(NAME);
        Endpoint::from_shared(format!("https://{authority}"))
            .and_then(|endpoint| endpoint.tls_config(tls))
            .map(|endpoint| {
                endpoint
                    .connect_timeout(PATIENCE)
                    .tcp_nodelay(true)
                    .tcp_keepalive(Some(Duration::from_hours(1)))
                    .http2_keep_alive_interval(Duration::from_mins(5))
                    .keep_alive_timeout(Duration::from_secs(20))
                    .keep_alive_while_idle(true)
            })
            .map_err(damaged)
    }

    /// The same as a function, as the engine takes it for all its connections.
    pub fn endpoints(&self) -> EndpointOverrideFn {
        let keys = self.clone();
        Arc::new(move |plain| keys.endpoint(plain).map_err(Into::into))
    }
}

/// Checks that a scheduler answers at an address, with these keys or without any.
///
/// # Errors
///
/// Nothing listens there, or one side has keys and the other has none, or others.
pub async fn answers(address: &str, keys: Option<&Keys>) -> Result<(), Failure> {
    let unreachable = |why: String| {
        Failure::Engine(format!(
            "the scheduler at {address} cannot be reached: {why}. Start it with `hodograph-sweep scheduler`, and give --cluster its HOST:PORT"
        ))
    };
    let connecting = tokio::time::timeout(PATIENCE, tokio::net::TcpStream::connect(address));
    let mut stream = match connecting.await {
        Ok(Ok(stream)) => stream,
        Ok(Err(error)) => return Err(unreachable(error.to_string())),
        Err(_) => return Err(unreachable("no answer within 10 s".to_owned())),
    };
    let Some(keys) = keys else {
        // A server with TLS answers with an alert, one without with words.
        let mut first = [0_u8];
        let asked = async {
            stream.write_all(b"GET / HTTP/1.1\r\nHost: scheduler\r\nConnection: close\r\n\r\n").await?;
            stream.read(&mut first).await
        };
        return match tokio::time::timeout(PATIENCE, asked).await {
            Ok(Ok(_)) if first[0] == ALERT => Err(Failure::Engine(format!(
                "the scheduler at {address} takes part with keys only: give --tls the directory of the cluster's keys"
            ))),
            _ => Ok(()),
        };
    };
    let refused = |error: tonic::transport::Error| {
        Failure::Engine(format!(
            "the scheduler at {address} does not speak TLS with the keys of {}: {}. All processes of a cluster need the same keys, or none",
            keys.folder.display(),
            cause(&error)
        ))
    };
    let plain = Endpoint::from_shared(format!("http://{address}")).map_err(refused)?;
    keys.endpoint(plain)?.connect().await.map(drop).map_err(refused)
}

/// The first cause of an error, which says most.
fn cause(error: &dyn std::error::Error) -> String {
    let mut first = error;
    while let Some(source) = first.source() {
        first = source;
    }
    first.to_string()
}

/// Makes a directory with the keys of a cluster. Nobody can sign further certificates of its authority: that key
/// is not kept.
///
/// # Errors
///
/// The directory exists, or cannot be written.
pub fn make(folder: &Path) -> Result<(), Failure> {
    let engine = |error: rcgen::Error| Failure::Engine(format!("cannot make keys: {error}"));
    if folder.exists() {
        return Err(Failure::Input(format!(
            "{}: exists; keys are written into a new directory, so that none is lost",
            folder.display()
        )));
    }
    let mut authority = CertificateParams::new(Vec::new()).map_err(engine)?;
    authority.distinguished_name.push(DnType::CommonName, "authority of a cluster of hodograph-sweep");
    authority.is_ca = IsCa::Ca(BasicConstraints::Constrained(0));
    authority.key_usages = vec![KeyUsagePurpose::KeyCertSign];
    let authority_key = KeyPair::generate().map_err(engine)?;
    let authority_certificate = authority.self_signed(&authority_key).map_err(engine)?;
    let mut member = CertificateParams::new(vec![NAME.to_owned()]).map_err(engine)?;
    member.distinguished_name.push(DnType::CommonName, NAME);
    member.key_usages = vec![KeyUsagePurpose::DigitalSignature];
    member.extended_key_usages =
        vec![ExtendedKeyUsagePurpose::ServerAuth, ExtendedKeyUsagePurpose::ClientAuth];
    let key = KeyPair::generate().map_err(engine)?;
    let certificate = member.signed_by(&key, &Issuer::new(authority, authority_key)).map_err(engine)?;
    let contents = [authority_certificate.pem(), certificate.pem(), key.serialize_pem()];
    // a directory is there with all its files, or not at all
    let made = folder.with_extension(format!("{}.tmp", std::process::id()));
    let written = std::fs::create_dir_all(&made)
        .and_then(|()| FILES.iter().zip(&contents).try_for_each(|(name, text)| write(&made.join(name), text)))
        .and_then(|()| std::fs::rename(&made, folder));
    written.map_err(|error| {
        let _ = std::fs::remove_dir_all(&made);
        Failure::file(folder, "write", error)
    })
}

/// Writes a new file that only its owner can read.
fn write(path: &Path, text: &str) -> std::io::Result<()> {
    let mut options = std::fs::OpenOptions::new();
    options.write(true).create_new(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    std::io::Write::write_all(&mut options.open(path)?, text.as_bytes())
}
