//! The program that valgrind executes: runs every method, or the one named, once over every collision of a
//! set; or selects modes of closed contacts. With `times`, by itself: the time of every method over that of
//! the exact solver.

fn main() {
    let mut arguments = std::env::args().skip(1);
    let set = arguments.next().unwrap_or_default();
    let only = arguments.next();
    if set == "modes" {
        for row in hodograph_benchmark_impacts::modes::ROWS {
            hodograph_benchmark_impacts::modes::contacts(row).iter().for_each(row.2);
        }
        return;
    }
    if set == "times" {
        hodograph_benchmark_impacts::times::print(&["nine", "random"]);
        return;
    }
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
