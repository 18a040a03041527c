//! The search of docs/paper.md for collisions that gain energy under Poisson's hypothesis, whole: 40 000 starts,
//! 2.4 million collisions. It stands in this package because its tests are optimised: some seconds here are
//! minutes elsewhere.

#[path = "../../runtime/examples/energy.rs"]
#[allow(dead_code, reason = "the example measures more")]
mod energy;

const PAGE: &str = include_str!("../../docs/paper.md");

#[test]
fn the_whole_search_is_that_of_the_page() {
    let found = energy::search(40_000);
    assert!(found.solved > 2_390_000, "{found:?}");
    assert!(found.work < 0.0 && found.quotient < 1.0, "{found:?}");
    for shown in [format!("{:.1e}", found.work), format!("{:.5}", found.quotient)] {
        assert!(PAGE.contains(&shown), "{found:?}");
    }
}
