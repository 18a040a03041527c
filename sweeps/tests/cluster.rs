//! The same query on the three engines: embedded, Ballista in one process, and a scheduler with two executors
//! as processes of their own, of which one is killed half-way.

mod common;

use std::io::{BufRead, BufReader};
use std::net::TcpListener;
use std::path::Path;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

use common::{collisions, digest, succeeds, tool};

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

fn cluster(home: &Path) -> (String, Process, Vec<Process>) {
    let scheduler = format!("127.0.0.1:{}", free_port());
    let first = start(home, &["scheduler", "--listen", &scheduler, "--patience", "6"], "listens");
    let begun = Instant::now();
    while std::net::TcpStream::connect(&scheduler).is_err() {
        assert!(begun.elapsed() < Duration::from_secs(60), "the scheduler does not listen");
        std::thread::sleep(Duration::from_millis(50));
    }
    let executors = [0, 1].map(|index| {
        let listen = format!("127.0.0.1:{}", free_port());
        let work = format!("work-{index}");
        let arguments =
            ["executor", "--scheduler", &scheduler, "--listen", &listen, "--cores", "1", "--work", &work];
        start(home, &arguments, "works for")
    });
    (scheduler, first, executors.into())
}

#[test]
fn three_engines_give_the_same_bits() {
    let home = tempfile::tempdir().unwrap();
    let sql = collisions(200_000);
    let embedded = succeeds(home.path(), &["run", "--sql", &sql]);
    let in_process = succeeds(home.path(), &["run", "--in-process", "--sql", &sql]);
    assert_eq!(digest(&in_process), digest(&embedded));
    let (scheduler, _first, _executors) = cluster(home.path());
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
    let (scheduler, _first, mut executors) = cluster(home.path());
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

/// How many files there are under a directory.
fn files(directory: &Path) -> usize {
    let Ok(entries) = std::fs::read_dir(directory) else { return 0 };
    entries.flatten().map(|entry| if entry.path().is_dir() { files(&entry.path()) } else { 1 }).sum()
}
