//! Every reference collision, to max(1e-12, 32 x condition x 2.2e-16), with the right path and number of
//! compressions.

use crate::common::{Case, reference_cases};
use hodograph::solve;

#[test]
fn every_reference_case_is_within_its_bound() {
    let cases = reference_cases();
    assert_eq!(cases.len(), 106);
    let mut worst = (0.0, String::new());
    for case in &cases {
        let Case { matrix, approach, surface, .. } = case;
        let hit = solve(matrix, approach, surface).unwrap_or_else(|e| panic!("{}: {e}", case.line));
        let (error, bound) = (case.error(&hit), case.bound());
        assert!(error <= bound, "error {error:e}, bound {bound:e}: {}", case.line);
        // On the boundary between two paths either is right.
        if case.family != "near_mu_c" && case.family != "straight" {
            assert_eq!(hit.path.phases().join("+"), case.path, "{}", case.line);
        }
        if let Some(n) = case.compressions {
            assert_eq!(u64::from(hit.compressions), n, "{}", case.line);
        }
        if error / bound > worst.0 {
            worst = (error / bound, case.line.clone());
        }
    }
    println!("worst error over bound: {:e} in {}", worst.0, worst.1);
}
