//! The same query on the three engines: embedded, Ballista in one process, and a scheduler with two executors
//! as processes of their own, of which one is killed half-way.

use std::io::{BufRead, BufReader};
use std::net::TcpListener;
use std::path::Path;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

use tonic::transport::{Certificate, ClientTlsConfig, Endpoint, Identity};

use crate::common::{collisions, digest, fails, run, succeeds, tool};

/// A process that ends with the test.
struct Process(Child);

impl Drop for Process {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Two neighbouring ports of which nobody makes use.
fn free_port() -> u16 {
    (0..100)
        .find_map(|_| {
            let port = TcpListener::bind("127.0.0.1:0").ok()?.local_addr().ok()?.port();
            TcpListener::bind(("127.0.0.1", port.checked_add(1)?)).ok().map(|_| port)
        })
        .expect("no free port")
}

fn start(home: &Path, arguments: &[&str], ready: &str) -> Process {
    let mut child = tool()
        .args(arguments)
        .current_dir(home)
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let mut line = String::new();
    BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
    assert!(line.contains(ready), "{line}");
    Process(child)
}

fn cluster(home: &Path, files: &[&str]) -> (String, Process, Vec<Process>) {
    let (scheduler, first, executors, _) = cluster_with(home, files, &[]);
    (scheduler, first, executors)
}

/// The address of the scheduler, its process, those of two executors, and the address of one of them; `keys` are
/// arguments of all three.
fn cluster_with(home: &Path, files: &[&str], keys: &[&str]) -> (String, Process, Vec<Process>, String) {
    let scheduler = format!("127.0.0.1:{}", free_port());
    let arguments = [&["scheduler", "--listen", &scheduler, "--patience", "6"], files, keys].concat();
    let first = start(home, &arguments, "listens");
    let begun = Instant::now();
    while std::net::TcpStream::connect(&scheduler).is_err() {
        assert!(begun.elapsed() < Duration::from_secs(60), "the scheduler does not listen");
        std::thread::sleep(Duration::from_millis(50));
    }
    let mut offered = String::new();
    let executors = [0, 1].map(|index| {
        let listen = format!("127.0.0.1:{}", free_port());
        let work = format!("work-{index}");
        let arguments =
            ["executor", "--scheduler", &scheduler, "--listen", &listen, "--cores", "1", "--work", &work];
        offered.clone_from(&listen);
        start(home, &[&arguments[..], keys].concat(), "works for")
    });
    (scheduler, first, executors.into(), offered)
}

#[test]
fn three_engines_give_the_same_bits() {
    let home = tempfile::tempdir().unwrap();
    let sql = collisions(200_000);
    let embedded = succeeds(home.path(), &["run", "--sql", &sql]);
    let in_process = succeeds(home.path(), &["run", "--in-process", "--sql", &sql]);
    assert_eq!(digest(&in_process), digest(&embedded));
    let (scheduler, _first, _executors) = cluster(home.path(), &[]);
    let distributed = succeeds(home.path(), &["run", "--cluster", &scheduler, "--sql", &sql]);
    assert_eq!(digest(&distributed), digest(&embedded));
    // rows through Parquet, a model that the executors have not, and parts
    let models = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/two_sleds.");
    for end in ["mech", "derivation"] {
        std::fs::copy(format!("{models}{end}"), home.path().join(format!("mine.{end}"))).unwrap();
    }
    let mine = sql.replace("two_sleds_collide", "mine_collide");
    let with_mine =
        succeeds(home.path(), &["run", "--cluster", &scheduler, "--model", "mine.mech", "--sql", &mine]);
    assert_eq!(digest(&with_mine), digest(&embedded));
    let short = ["run", "--model", "two_sleds", "--vary", "mu=0:2:3", "--sample", "2e5"];
    let alone = succeeds(home.path(), &short);
    let parts = ["--cluster", &scheduler, "--parts", "3", "--out", "parts.parquet"];
    assert_eq!(digest(&succeeds(home.path(), &[&short[..], &parts].concat())), digest(&alone));
}

#[test]
fn an_executor_killed_half_way_loses_nothing() {
    let home = tempfile::tempdir().unwrap();
    let rows =
        std::env::var("HODOGRAPH_SWEEP_ROWS").ok().and_then(|rows| rows.parse().ok()).unwrap_or(1_000_000);
    let sql = collisions(rows);
    let embedded = succeeds(home.path(), &["run", "--quiet", "--sql", &sql]);
    let (scheduler, _first, mut executors) = cluster(home.path(), &[]);
    let asked = tool()
        .args(["run", "--quiet", "--cluster", &scheduler, "--sql", &sql])
        .current_dir(home.path())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // it has finished a task, so its results are lost with it, and works on another
    let work = home.path().join("work-0");
    let begun = Instant::now();
    while files(&work) == 0 {
        assert!(begun.elapsed() < Duration::from_secs(120), "the executor gets no work");
        std::thread::sleep(Duration::from_millis(20));
    }
    let mut asked = asked;
    assert!(asked.try_wait().unwrap().is_none(), "the query was done before the executor could be killed");
    executors[0].0.kill().unwrap();
    let output = asked.wait_with_output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(digest(&String::from_utf8_lossy(&output.stdout)), digest(&embedded));
    let _ = std::fs::remove_dir_all(work);
}

/// Clients read the files of named directories only, whatever statement asks for them.
#[test]
fn clients_read_named_files_only() {
    let home = tempfile::tempdir().unwrap();
    for folder in ["open", "closed"] {
        std::fs::create_dir(home.path().join(folder)).unwrap();
        std::fs::write(home.path().join(folder).join("data.csv"), "a\n1\n2\n").unwrap();
    }
    let (scheduler, _first, _executors) = cluster(home.path(), &["--files", "open"]);
    let ask = |sql: &str| run(home.path(), &["run", "--quiet", "--cluster", &scheduler, "--sql", sql]);
    let query = |path: &str| format!("SELECT sum(a) AS s FROM '{path}'");
    let own = succeeds(home.path(), &["run", "--quiet", "--sql", &query("open/data.csv")]);
    let allowed = ask(&query("open/data.csv"));
    assert!(allowed.status.success(), "{}", String::from_utf8_lossy(&allowed.stderr));
    assert_eq!(digest(&String::from_utf8_lossy(&allowed.stdout)), digest(&own));
    let external = "CREATE EXTERNAL TABLE t (a VARCHAR) STORED AS CSV LOCATION '/etc/passwd' OPTIONS ('format.has_header' 'false');
        SELECT * FROM t";
    let inside = format!("SELECT i FROM rows(3) WHERE i IN ({})", query("closed/data.csv"));
    for sql in [external, &query("closed/data.csv"), &query("open/../closed/data.csv"), &inside] {
        let refused = ask(sql);
        let said = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert!(!refused.status.success() && said.contains("does not let clients read"), "{sql}: {said}");
        assert!(!String::from_utf8_lossy(&refused.stdout).contains("root"), "{sql}");
    }
    let said = fails(home.path(), &["scheduler", "--files", "nowhere"], 1);
    assert!(said.contains("nowhere"), "{said}");
}

/// With keys every connection is encrypted, and a cluster serves nobody who has not the same.
#[test]
fn a_cluster_with_keys_serves_their_owners_only() {
    let home = tempfile::tempdir().unwrap();
    for folder in ["mine", "others"] {
        succeeds(home.path(), &["keys", folder]);
    }
    assert!(fails(home.path(), &["keys", "mine"], 2).contains("exists"));
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let mode = std::fs::metadata(home.path().join("mine/key.pem")).unwrap().permissions().mode();
        assert_eq!(mode & 0o77, 0, "others may read the key");
    }
    let sql = collisions(20_000);
    let embedded = succeeds(home.path(), &["run", "--sql", &sql]);
    let (scheduler, _first, executors, offered) = cluster_with(home.path(), &[], &["--tls", "mine"]);
    let ask = ["run", "--cluster", &scheduler, "--sql", &sql];
    let answer = succeeds(home.path(), &[&ask[..], &["--tls", "mine"]].concat());
    assert_eq!(digest(&answer), digest(&embedded));
    // neither queries nor executors without keys, or with others
    let join = ["executor", "--scheduler", &scheduler, "--listen", "127.0.0.1:1"];
    for arguments in [&ask[..], &join] {
        assert!(fails(home.path(), arguments, 1).contains("give --tls"));
        let others = fails(home.path(), &[arguments, &["--tls", "others"]].concat(), 1);
        assert!(others.contains("need the same keys"), "{others}");
    }
    let missing = fails(home.path(), &[&ask[..], &["--tls", "nowhere"]].concat(), 2);
    assert!(missing.contains("hodograph-sweep keys nowhere"), "{missing}");
    std::fs::write(home.path().join("others/key.pem"), "no key").unwrap();
    let damaged = fails(home.path(), &[&ask[..], &["--tls", "others"]].concat(), 2);
    assert!(damaged.contains("no usable keys"), "{damaged}");
    // Who knows the authority alone, without a key of his own, gets nothing from scheduler and executor.
    let authority = std::fs::read(home.path().join("mine/ca.pem")).unwrap();
    let refused = |address: &str, identity: bool| {
        let mut tls = ClientTlsConfig::new()
            .ca_certificate(Certificate::from_pem(&authority))
            .domain_name(hodograph_sweeps::keys::NAME);
        if identity {
            let read = |name: &str| std::fs::read(home.path().join("mine").join(name)).unwrap();
            tls = tls.identity(Identity::from_pem(read("certificate.pem"), read("key.pem")));
        }
        let endpoint = Endpoint::from_shared(format!("https://{address}")).unwrap().tls_config(tls).unwrap();
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
        runtime.block_on(async move {
            let Ok(channel) = endpoint.connect().await else { return true };
            // A service that is not there answers so; a connection that is refused does not answer.
            let mut client = tonic::client::Grpc::new(channel);
            if client.ready().await.is_err() {
                return true;
            }
            let path = http::uri::PathAndQuery::from_static("/nothing/Nothing");
            let codec = tonic_prost::ProstCodec::<(), ()>::default();
            let answer = client.unary(tonic::Request::new(()), path, codec).await;
            answer.err().map(|status| status.code()) != Some(tonic::Code::Unimplemented)
        })
    };
    for address in [&scheduler, &offered] {
        assert!(!refused(address, true), "{address} does not serve the keys of its cluster");
        assert!(refused(address, false), "{address} serves without a certificate of the client");
    }
    drop(executors);
    // a scheduler without keys is not taken for one with them
    let (open, _second, _executors) = cluster(home.path(), &[]);
    let plain = fails(home.path(), &["run", "--cluster", &open, "--tls", "mine", "--sql", &sql], 1);
    assert!(plain.contains("does not speak TLS"), "{plain}");
}

/// An executor whose directory nobody named takes it away when it ends.
#[cfg(unix)]
#[test]
fn an_executor_leaves_nothing_in_the_temporary_directory() {
    let home = tempfile::tempdir().unwrap();
    let scheduler = format!("127.0.0.1:{}", free_port());
    let _first = start(home.path(), &["scheduler", "--listen", &scheduler], "listens");
    while std::net::TcpStream::connect(&scheduler).is_err() {
        std::thread::sleep(Duration::from_millis(50));
    }
    let temporary = home.path().join("temporary");
    std::fs::create_dir(&temporary).unwrap();
    let listen = format!("127.0.0.1:{}", free_port());
    let mut executor = tool()
        .args(["executor", "--scheduler", &scheduler, "--listen", &listen, "--cores", "1"])
        .env("TMPDIR", &temporary)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let entries = || std::fs::read_dir(&temporary).unwrap().count();
    let begun = Instant::now();
    while entries() == 0 {
        assert!(begun.elapsed() < Duration::from_secs(60), "the executor makes no directory");
        std::thread::sleep(Duration::from_millis(20));
    }
    let sql = collisions(20_000);
    succeeds(home.path(), &["run", "--quiet", "--cluster", &scheduler, "--sql", &sql]);
    let killed = std::process::Command::new("kill").args(["-TERM", &executor.id().to_string()]).status();
    assert!(killed.unwrap().success());
    executor.wait().unwrap();
    assert_eq!(entries(), 0);
}

/// How many files there are under a directory.
fn files(directory: &Path) -> usize {
    let Ok(entries) = std::fs::read_dir(directory) else { return 0 };
    entries.flatten().map(|entry| if entry.path().is_dir() { files(&entry.path()) } else { 1 }).sum()
}
