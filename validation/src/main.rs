//! Predicts tosses: each line of standard input is a request in JSON, and each line of standard output its answer.
//!
//! One program serves both mechanisms, so that the program that identifies constants can ask it as it asks other simulators.

mod request;
mod toss;

use std::io::{BufRead, Write};

hodograph::mechanism!("models/cube.mech");
hodograph::mechanism!("models/elbow.mech");

fn main() -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    for line in std::io::stdin().lock().lines() {
        let answer = match serde_json::from_str(&line?) {
            Ok(request) => request::answer(&request),
            Err(error) => request::Answer::refused(format!("not a request: {error}")),
        };
        serde_json::to_writer(&mut out, &answer)?;
        out.write_all(b"\n")?;
        out.flush()?;
    }
    Ok(())
}
