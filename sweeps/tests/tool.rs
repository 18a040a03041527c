//! The tool: what it writes, how it goes on after an interruption, and what it says about mistakes.

use std::fs;

use crate::common::{collisions, digest, fails, run, succeeds, tool};

const ROW_BY_ROW: &str = "SELECT i, two_sleds_collide(named_struct('mu', uniform(i, 0, 0), 'e', 0.5, 'law', 'poisson')) AS c FROM rows(20000)";

#[test]
fn a_query_file_gives_a_summary_a_digest_and_files() {
    let home = tempfile::tempdir().unwrap();
    fs::write(home.path().join("query.sql"), collisions(20_000)).unwrap();
    let shown = succeeds(home.path(), &["run", "query.sql"]);
    assert!(shown.contains("| 0.25 | 4000") && shown.contains("rows/s and core"), "{shown}");
    let parquet = succeeds(home.path(), &["run", "query.sql", "--out", "a.parquet", "--cores", "1"]);
    let csv = succeeds(home.path(), &["run", "query.sql", "--out", "a.csv"]);
    assert_eq!(digest(&parquet), digest(&shown));
    assert_eq!(digest(&csv), digest(&shown));
    assert!(succeeds(home.path(), &["verify", "a.parquet"]).contains("as stated"));
    let text = fs::read_to_string(home.path().join("a.csv")).unwrap();
    assert_eq!(text.lines().next(), Some("mu,collisions,solved,checksum,energy"));
    assert_eq!(text.lines().count(), 6);
    let note = fs::read_to_string(home.path().join("a.csv.digest")).unwrap();
    assert!(note.contains("hodograph.rows: 5") && note.contains("two_sleds_collide"), "{note}");
    // what was written is a table of the next query
    let again = succeeds(home.path(), &["run", "--sql", "SELECT sum(solved) AS all_solved FROM 'a.parquet'"]);
    assert!(again.contains("20000"), "{again}");
}

#[test]
fn a_damaged_file_is_found_out() {
    let home = tempfile::tempdir().unwrap();
    succeeds(home.path(), &["run", "--sql", "SELECT i FROM rows(1000)", "--out", "a.parquet"]);
    let path = home.path().join("a.parquet");
    let mut bytes = fs::read(&path).unwrap();
    let middle = bytes.len() / 4;
    bytes[middle] ^= 0x55;
    fs::write(&path, bytes).unwrap();
    fails(home.path(), &["verify", "a.parquet"], 1);
}

#[test]
fn the_short_form_is_a_query() {
    let home = tempfile::tempdir().unwrap();
    let arguments = ["run", "--model", "two_sleds", "--vary", "mu=0:2:5", "--sample", "5e3"];
    let shown = succeeds(home.path(), &arguments);
    let sql = succeeds(home.path(), &[&arguments[..], &["--show-sql"]].concat());
    fs::write(home.path().join("same.sql"), &sql).unwrap();
    assert_eq!(digest(&succeeds(home.path(), &["run", "same.sql"])), digest(&shown));
    // in parts, merged: the same answer
    let parts = succeeds(home.path(), &[&arguments[..], &["--parts", "3", "--out", "p.parquet"]].concat());
    assert_eq!(digest(&parts), digest(&shown));
}

#[test]
fn an_interrupted_sweep_goes_on() {
    let home = tempfile::tempdir().unwrap();
    let whole = succeeds(home.path(), &["run", "--sql", ROW_BY_ROW]);
    let arguments = ["run", "--sql", ROW_BY_ROW, "--parts", "4", "--out", "rows"];
    let first = succeeds(home.path(), &arguments);
    assert_eq!(digest(&first), digest(&whole));
    // as if it had been interrupted in the third part, and the last had never been begun
    let kept = home.path().join("rows/part-000000.parquet");
    let before = fs::metadata(&kept).unwrap().modified().unwrap();
    fs::remove_file(home.path().join("rows/part-000002.parquet")).unwrap();
    fs::write(home.path().join("rows/part-000002.parquet.partial"), "half").unwrap();
    fs::remove_file(home.path().join("rows/part-000003.parquet")).unwrap();
    let second = run(home.path(), &arguments);
    assert!(second.status.success());
    let said = String::from_utf8_lossy(&second.stderr);
    assert_eq!(said.matches("10000 rows were done before").count(), 1, "{said}");
    assert_eq!(said.matches("were done before").count(), 1, "{said}");
    assert_eq!(digest(&String::from_utf8_lossy(&second.stdout)), digest(&whole));
    assert_eq!(fs::metadata(&kept).unwrap().modified().unwrap(), before);
    // another query does not take its parts
    let other = ROW_BY_ROW.replace("0.5", "0.6");
    assert!(
        fails(home.path(), &["run", "--sql", &other, "--parts", "4", "--out", "rows"], 2)
            .contains("parts of another sweep")
    );
}

/// A sweep goes on with the files that it began with: one that holds something else meanwhile is refused, whether the query
/// reads it itself or a statement before it does. One that was only touched is the same.
#[test]
fn a_sweep_goes_on_with_the_files_that_it_began_with() {
    let home = tempfile::tempdir().unwrap();
    let data = home.path().join("data.csv");
    let direct = "SELECT i, (SELECT sum(a) FROM 'data.csv') AS s FROM rows(100)";
    let before =
        "CREATE TABLE d AS SELECT * FROM 'data.csv'; SELECT i, (SELECT sum(a) FROM d) AS s FROM rows(100)";
    for (place, sql) in [direct, before].into_iter().enumerate() {
        fs::write(&data, "a\n1\n2\n").unwrap();
        let out = format!("rows-{place}.parquet");
        fs::write(home.path().join("merge.sql"), "SELECT sum(s) AS s FROM parts").unwrap();
        let arguments = ["run", "--sql", sql, "--parts", "4", "--merge", "merge.sql", "--out", &out];
        let first = succeeds(home.path(), &arguments);
        fs::remove_file(home.path().join(format!("{out}.parts/part-000002.parquet"))).unwrap();
        fs::write(&data, "a\n1\n2\n").unwrap();
        assert_eq!(digest(&succeeds(home.path(), &arguments)), digest(&first));
        fs::remove_file(home.path().join(format!("{out}.parts/part-000002.parquet"))).unwrap();
        fs::write(&data, "a\n1\n3\n").unwrap();
        let said = fails(home.path(), &arguments, 2);
        assert!(said.contains("content of a file that it reads"), "{said}");
    }
}

#[test]
fn parts_of_a_query_over_several_rows_need_a_merge() {
    let home = tempfile::tempdir().unwrap();
    let sql = "SELECT count(*) AS n FROM rows(1000)";
    let said = fails(home.path(), &["run", "--sql", sql, "--parts", "4", "--out", "n.parquet"], 2);
    assert!(said.contains("give --merge"), "{said}");
    assert_eq!(fs::read_dir(home.path()).unwrap().count(), 0);
    fs::write(home.path().join("merge.sql"), "SELECT sum(n) AS n FROM parts").unwrap();
    let shown = succeeds(
        home.path(),
        &["run", "--sql", sql, "--parts", "4", "--out", "n.parquet", "--merge", "merge.sql"],
    );
    assert!(shown.contains("| 1000 |"), "{shown}");
}

#[test]
fn mistakes_are_told_with_their_cause() {
    let home = tempfile::tempdir().unwrap();
    let sql = |sql: &str| ["run".to_owned(), "--sql".to_owned(), sql.to_owned()];
    let cases = [
        ("SELECT speed FROM rows(3)", 2, "speed"),
        ("SELECT hodograph(i) FROM rows(3)", 2, "hodograph"),
        ("SELECT * FROM 'missing.parquet'", 2, "missing.parquet"),
        ("SELECT * FROM rows(-3)", 2, "not negative"),
        ("SELEC i FROM rows(3)", 2, "SELEC"),
        ("", 2, "empty"),
        ("CREATE TABLE t AS SELECT 1", 2, "last statement must be a query"),
        ("COPY (SELECT 1) TO 'x.csv'", 2, "must be a query"),
        ("SELECT sobol(i, 300, 0) FROM rows(3)", 2, "dimensions 0 to 255"),
        ("SELECT histogram(1.0, 2.0, 1.0, 5)", 1, "low must be less than high"),
    ];
    for (text, status, wanted) in cases {
        let said = fails(home.path(), &sql(text).each_ref().map(String::as_str), status);
        assert!(said.contains(wanted), "{text}: {said}");
    }
    let cases: [(&[&str], &str); 9] = [
        (&["run", "none.sql"], "cannot read none.sql"),
        (&["run"], "give a query"),
        (&["run", "--model", "three_sleds", "--sample", "10"], "there is no model `three_sleds`"),
        (&["run", "--model", "none.mech", "--sample", "10"], "cannot read none.mech"),
        (&["run", "--model", "two_sleds", "--vary", "q9=0:1:2", "--sample", "10"], "field `q9`"),
        (
            &["run", "--model", "two_sleds", "--vary", "mu=0:1:20", "--sample", "10"],
            "less than the 20 points",
        ),
        (&["run", "--sql", "SELECT 1", "--out", "x.json"], ".parquet or .csv"),
        (&["run", "--sql", "SELECT 1", "--out", "no/x.csv"], "there is no directory no"),
        (&["run", "--sql", "SELECT 1", "--out", "/dev/full"], ".parquet or .csv"),
    ];
    for (arguments, wanted) in cases {
        let said = fails(home.path(), arguments, 2);
        assert!(said.contains(wanted), "{arguments:?}: {said}");
    }
    let said = fails(home.path(), &["run", "--sql", "SELECT 1", "--cluster", "127.0.0.1:1"], 1);
    assert!(said.contains("127.0.0.1:1 cannot be reached"), "{said}");
    let said = fails(home.path(), &["executor", "--scheduler", "127.0.0.1:1", "--listen", "127.0.0.1:0"], 1);
    assert!(said.contains("127.0.0.1:1"), "{said}");
    assert_eq!(fs::read_dir(home.path()).unwrap().count(), 0);
}

/// Whoever reads the output may stop, as `head` does: no panic, and no error.
#[test]
fn output_that_nobody_reads_ends_in_silence() {
    let home = tempfile::tempdir().unwrap();
    let query = ["run", "--quiet", "--sql", "SELECT i FROM rows(3)"];
    succeeds(home.path(), &[&query[..], &["--out", "a.parquet"]].concat());
    let commands: [&[&str]; 4] = [
        &["run", "--model", "two_sleds", "--sample", "10", "--show-sql"],
        &["functions"],
        &["verify", "a.parquet"],
        &query,
    ];
    for arguments in commands {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let output = tool().args(arguments).current_dir(home.path()).stdout(writer).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!((output.status.code(), said.as_str()), (Some(0), ""), "{arguments:?}");
    }
    // the status of verify speaks of all files, read or not
    fs::write(home.path().join("b.parquet"), "damaged").unwrap();
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let verify = ["verify", "a.parquet", "b.parquet"];
    let output = tool().args(verify).current_dir(home.path()).stdout(writer).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
}

/// A contact that no row can have is a mistake of the query, not an answer of its rows.
#[test]
fn a_contact_that_is_none_is_refused_when_planning() {
    let home = tempfile::tempdir().unwrap();
    let wanted =
        "chaplygin_sleigh_collide needs the field `contact`: the model has the contacts post, slanted";
    let short = ["run", "--model", "chaplygin_sleigh", "--sample", "1e4"];
    let said = fails(home.path(), &short, 2);
    assert!(said.contains(wanted), "{said}");
    let call = "chaplygin_sleigh_collide(named_struct('mu', 0.5, 'e', 0.5, 'law', 'newton'))";
    let said = fails(home.path(), &["run", "--sql", &format!("SELECT {call} AS c FROM rows(10)")], 2);
    assert!(said.contains(wanted), "{said}");

    let wanted = "chaplygin_sleigh_collide: there is no contact `wall`: there are: post, slanted";
    let said = fails(home.path(), &[&short[..], &["--set", "contact=wall"]].concat(), 2);
    assert!(said.contains(wanted), "{said}");
    let call = call.replace("'newton'", "'newton', 'contact', 'wall'");
    let places = [
        format!("SELECT {call} AS c FROM rows(10)"),
        format!(
            "SELECT i FROM rows(10) WHERE i < (SELECT count(*) FROM rows(9) WHERE {call}['kind'] = 'ok')"
        ),
        format!("CREATE VIEW hits AS SELECT {call} AS c FROM rows(10); SELECT c FROM hits"),
        format!("CREATE TABLE hits AS SELECT {call} AS c FROM rows(10); SELECT c FROM hits"),
    ];
    for sql in &places {
        let said = fails(home.path(), &["run", "--sql", sql], 2);
        assert!(said.contains(wanted), "{sql}: {said}");
    }
    let said = fails(home.path(), &["run", "--in-process", "--sql", &places[0]], 2);
    assert!(said.contains(wanted), "{said}");
    // the same calls with a contact of the model are answered
    let shown = succeeds(home.path(), &[&short[..], &["--set", "contact=slanted"]].concat());
    assert!(shown.contains("digest of the answer"), "{shown}");
    succeeds(home.path(), &["run", "--sql", &places[0].replace("wall", "post")]);
}

/// A disk that is full, as a limit on the size of files.
#[cfg(unix)]
#[test]
fn a_full_disk_leaves_nothing() {
    let home = tempfile::tempdir().unwrap();
    for out in ["a.parquet", "a.csv"] {
        let script = "trap '' XFSZ; ulimit -f 8; exec \"$0\" \"$@\"";
        let output = std::process::Command::new("bash")
            .args(["-c", script])
            .arg(tool().get_program())
            .args(["run", "--quiet", "--sql", "SELECT uniform(i, 0, 0) AS x FROM rows(100000)", "--out", out])
            .current_dir(home.path())
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1), "{said}");
        assert!(said.contains(&format!("cannot write {out}")), "{said}");
        assert_eq!(fs::read_dir(home.path()).unwrap().count(), 0, "{out}");
    }
}

/// A disk that is full: a file system of 64 kB in memory. Where the system lets nobody mount one, the test
/// says so. Of a sweep in parts the note stays that says which sweep it is.
#[cfg(target_os = "linux")]
#[test]
fn a_full_file_system_leaves_nothing() {
    let home = tempfile::tempdir().unwrap();
    fs::create_dir(home.path().join("disk")).unwrap();
    let on_small_disk = |script: &str, arguments: &[&str]| {
        let script = format!("mount -t tmpfs -o size=64k none disk && cd disk && {{ {script}; }}");
        std::process::Command::new("unshare")
            .args(["-Urm", "bash", "-c", &script])
            .arg(tool().get_program())
            .args(arguments)
            .current_dir(home.path())
            .output()
    };
    if !on_small_disk("true", &[]).is_ok_and(|output| output.status.success()) {
        eprintln!("skipped: this system lets nobody mount a file system");
        return;
    }
    let sql = "SELECT i, uniform(i, 0, 0) AS x FROM rows(100000)";
    for (out, parts) in [("a.parquet", None), ("a.csv", None), ("rows", Some("2"))] {
        let mut arguments = vec!["run", "--quiet", "--sql", sql, "--out", out];
        parts.iter().for_each(|parts| arguments.extend(["--parts", parts]));
        let output =
            on_small_disk(r#""$0" "$@"; code=$?; find . -type f ! -name sweep.txt; exit $code"#, &arguments)
                .unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1), "{said}");
        assert!(said.contains("cannot write") && said.contains("No space left"), "{said}");
        assert_eq!(String::from_utf8_lossy(&output.stdout), "", "{out}");
    }
}

/// A user's own model: its functions bear the name of its file.
#[test]
fn a_model_of_the_user_has_functions() {
    let home = tempfile::tempdir().unwrap();
    let models = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/");
    for end in ["mech", "derivation"] {
        fs::copy(format!("{models}two_sleds.{end}"), home.path().join(format!("mine.{end}"))).unwrap();
    }
    let sql = "SELECT outcome_hash(mine_energy(named_struct('q3', q3))) = outcome_hash(two_sleds_energy(named_struct('q3', q3))) AS same
               FROM (SELECT uniform(i, 0, 0) AS q3 FROM rows(10)) WHERE i IS NOT NULL";
    let sql = sql.replace(" WHERE i IS NOT NULL", "");
    let shown = succeeds(home.path(), &["run", "--model", "mine.mech", "--sql", &sql]);
    assert!(shown.matches("true").count() == 10, "{shown}");
    let described = succeeds(home.path(), &["functions", "--model", "mine.mech", "mine_collide"]);
    assert!(
        described.contains("mu, e, law, contact, time, q1") && described.contains("after_u6 Float64"),
        "{described}"
    );
    let said = fails(home.path(), &["run", "--sql", &sql], 2);
    assert!(said.contains("mine_energy"), "{said}");
    fs::write(home.path().join("mine.derivation"), "nonsense").unwrap();
    let said = fails(home.path(), &["run", "--model", "mine.mech", "--sql", &sql], 2);
    assert!(said.contains("damaged"), "{said}");
}

#[test]
fn memory_does_not_grow_with_rows() {
    let home = tempfile::tempdir().unwrap();
    let peak = |rows: u64| -> f64 {
        let sql = format!(
            "SELECT count(*) AS n, checksum(outcome_hash(uniform(i, 0, 0))) AS sum FROM rows({rows})"
        );
        let shown = succeeds(home.path(), &["run", "--cores", "2", "--sql", &sql]);
        let line =
            shown.lines().find(|line| line.starts_with("at most")).unwrap_or("at most 0 MB").to_owned();
        line.split_whitespace().nth(2).unwrap().parse().unwrap()
    };
    let (small, great) = (peak(4_200_000), peak(42_000_000));
    assert!(great < 1.5 * small + 20.0, "{small} MB, {great} MB");
}
