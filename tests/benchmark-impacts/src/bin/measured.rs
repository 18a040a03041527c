//! What valgrind executes: every method, or the one named, once over every collision of a set.

fn main() {
    let mut arguments = std::env::args().skip(1);
    let set = arguments.next().unwrap_or_default();
    let only = arguments.next();
    let cases = hodograph_benchmark_impacts::set(&set);
    for (_, name, method) in hodograph_benchmark_impacts::METHODS {
        if only.as_deref().is_some_and(|only| only != *name) {
            continue;
        }
        for case in &cases {
            let _ = std::hint::black_box(method(std::hint::black_box(case)));
        }
    }
}
