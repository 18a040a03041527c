//! What valgrind executes: every method once over every collision of a set.

fn main() {
    let set = std::env::args().nth(1).unwrap_or_default();
    let cases = hodograph_benchmark_impacts::set(&set);
    for (_, _, method) in hodograph_benchmark_impacts::METHODS {
        for case in &cases {
            let _ = std::hint::black_box(method(std::hint::black_box(case)));
        }
    }
}
