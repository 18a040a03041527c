//! `cargo run --profile fuzz -p hodograph-fuzz --bin seeded -- [COUNT] [SEED]`: mutated models, token soups and
//! arbitrary bytes, the same for the same seed, on all cores. A failure names the seed of its input, which
//! `-- 1 SEED` prints and repeats.

use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use hodograph_fuzz::{Random, mutate, run, run_inline, soup};

/// The shipped models, or the malformed ones of the tests.
fn models(folder: &str) -> Vec<Vec<u8>> {
    let entries = std::fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)).expect("models");
    let mut paths: Vec<_> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    paths.retain(|path| path.extension().is_some_and(|e| e == "mech"));
    paths.sort();
    paths.iter().map(|path| std::fs::read(path).expect("a model")).filter(|text| !text.is_empty()).collect()
}

fn input(good: &[Vec<u8>], bad: &[Vec<u8>], seed: u64) -> Vec<u8> {
    let mut random = Random::new(seed);
    match random.below(10) {
        0 => soup(&mut random),
        1 => (0..random.below(300)).map(|_| random.bits() as u8).collect(),
        2 | 3 => mutate(bad, &mut random),
        _ => mutate(good, &mut random),
    }
}

fn main() {
    let mut arguments = std::env::args().skip(1).map(|text| text.parse::<u64>().expect("a number"));
    let count = arguments.next().unwrap_or(100_000);
    let first = arguments.next().unwrap_or(0);
    let (good, bad) = (models("../../models"), models("../tests/diagnostics"));
    let start = Instant::now();
    let next = AtomicU64::new(0);
    let slowest = AtomicU64::new(0);
    let accepted = AtomicU64::new(0);
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                loop {
                    let i = next.fetch_add(1, Ordering::Relaxed);
                    if i >= count {
                        break;
                    }
                    let seed = first + i;
                    let bytes = input(&good, &bad, seed);
                    if count == 1 {
                        println!("{}", String::from_utf8_lossy(&bytes));
                    }
                    let begun = Instant::now();
                    let result = std::panic::catch_unwind(|| {
                        run(&bytes);
                        if let Ok(text) = std::str::from_utf8(&bytes) {
                            run_inline(text);
                        }
                    });
                    if result.is_err() {
                        println!("seed {seed} fails:\n{}", String::from_utf8_lossy(&bytes));
                        std::process::exit(1);
                    }
                    let micros = begun.elapsed().as_micros() as u64;
                    if slowest.fetch_max(micros, Ordering::Relaxed) < micros && micros > 2_000_000 {
                        println!("seed {seed} took {} ms", micros / 1000);
                    }
                    if seed.is_multiple_of(16) {
                        let source = hodograph_generator::source::Source::bytes("x", bytes);
                        let ok = hodograph_generator::check::check(&source).mechanism.is_some();
                        accepted.fetch_add(u64::from(ok), Ordering::Relaxed);
                    }
                }
            });
        }
    });
    let seconds = start.elapsed().as_secs_f64();
    println!(
        "{count} runs in {seconds:.0} s, slowest {} ms, about {:.1} % accepted, no failure",
        slowest.load(Ordering::Relaxed) / 1000,
        1600.0 * accepted.load(Ordering::Relaxed) as f64 / count as f64
    );
}
