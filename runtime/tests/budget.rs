//! A budget of quadratures changes no bit of an answer, and is kept: the least budget that suffices is found
//! by trying, and every smaller one is refused.

use crate::common::random::{Draw, Random};
use hodograph::nalgebra::{Matrix3, Vector2, Vector3};
use hodograph::structure::{Balanced, Planar, solve_structured};
use hodograph::{
    Budgeted, ContactSurface, Impact, ImpactError, Law, ReducedMatrix, Scalar, Surface,
    impact_without_collision, solve,
};

type Answer<T> = Result<Impact<T>, ImpactError<T>>;

/// A contact of any rank, often with fast or slow slip, and steep friction.
fn contact(random: &mut Random) -> (ReducedMatrix<f64>, Vector3<f64>, Surface<f64>) {
    let rank = [3, 3, 3, 2, 1][random.below(5)];
    let b = Matrix3::from_fn(|_, j| if j < rank { random.number() } else { 0.0 });
    let slip = if random.below(3) == 0 { random.power(6.0) } else { 1.0 };
    let approach = Vector3::new(-1.0 - random.number(), slip * random.number(), slip * random.number());
    let surface = random.surface();
    let mu = if random.below(4) == 0 { random.logarithmic(5.0, 1e4) } else { surface.mu };
    (ReducedMatrix::from(b * b.transpose()), approach, Surface { mu, ..surface })
}

/// The least budget that suffices, having checked that it and larger ones give the bits of the answer without
/// one, and that smaller ones are refused.
fn least<T: Scalar>(solve: impl Fn(&Budgeted<T>) -> Answer<T>, free: &Answer<T>, surface: Surface<T>) -> u32 {
    let bits = |answer: &Answer<T>| format!("{answer:?}");
    let exceeds = |quadratures: u32| match solve(&surface.with_budget(quadratures)) {
        Err(ImpactError::BudgetExceeded { quadratures: made, normal_velocity }) => {
            assert_eq!(made, quadratures);
            assert!(normal_velocity.is_finite(), "{surface:?}");
            true
        }
        answer => {
            assert_eq!(bits(&answer), bits(free), "{surface:?} within {quadratures}");
            false
        }
    };
    let least = (0..4096).find(|&quadratures| !exceeds(quadratures)).expect("some budget suffices");
    for more in [least + 1, least + 7, 1000, u32::MAX - 1, u32::MAX] {
        assert!(!exceeds(more));
    }
    least
}

#[test]
fn an_answer_within_its_budget_has_the_bits_of_one_without() {
    let mut random = Random::new(16);
    let mut met = [0; 64];
    for _ in 0..1000 {
        let (matrix, approach, surface) = contact(&mut random);
        let free = solve(&matrix, &approach, &surface);
        let least = least(|surface| solve(&matrix, &approach, surface), &free, surface);
        met[least.min(63) as usize] += 1;
        let other = solve_structured::<Balanced, _>(&matrix, &approach, &surface);
        self::least(|surface| solve_structured::<Balanced, _>(&matrix, &approach, surface), &other, surface);
        let slip = Vector2::new(approach.y, approach.z);
        let jump = impact_without_collision(&matrix, &slip, &surface);
        self::least(|surface| impact_without_collision(&matrix, &slip, surface), &jump, surface);
    }
    // Some collisions take no quadrature, some one, some several: all ways were gone.
    assert!(met[0] > 10 && met[1] > 10 && met[2] > 10 && met[4..].iter().sum::<i32>() > 10, "{met:?}");
}

#[test]
fn singles_keep_their_budget() {
    let mut random = Random::new(32);
    for _ in 0..1000 {
        let (matrix, approach, surface) = contact(&mut random);
        let matrix = ReducedMatrix::<f32>::new(
            matrix.nn as f32,
            matrix.nt as f32,
            matrix.ns as f32,
            matrix.tt as f32,
            matrix.ts as f32,
            matrix.ss as f32,
        );
        let approach = approach.map(|x| x as f32);
        let surface = Surface { mu: surface.mu as f32, e: surface.e as f32, law: surface.law };
        let free = solve(&matrix, &approach, &surface);
        least(|surface| solve(&matrix, &approach, surface), &free, surface);
    }
}

#[test]
fn the_velocity_reached_lies_on_the_way() {
    let (matrix, approach, surface) = crate::common::two_sleds(0.6, Law::Stronge);
    let mut last = approach.x;
    for quadratures in 0.. {
        match solve(&matrix, &approach, &surface.with_budget(quadratures)) {
            Err(ImpactError::BudgetExceeded { normal_velocity, .. }) => {
                assert!(normal_velocity >= last, "{normal_velocity} after {last}");
                last = normal_velocity;
            }
            answer => {
                assert!(quadratures > 1 && answer.is_ok());
                break;
            }
        }
    }
    assert!(last > approach.x);
}

#[test]
fn closed_forms_need_no_quadrature() {
    let matrix = ReducedMatrix::new(1.0, 0.3, 0.0, 2.0, 0.0, 1.0);
    let approach = Vector3::new(-1.0, 0.5, 0.0);
    let surface = Surface { mu: 0.3, e: 0.5, law: Law::Stronge };
    let hit = solve_structured::<Planar, f64>(&matrix, &approach, &surface.with_budget(0));
    assert_eq!(hit, solve_structured::<Planar, f64>(&matrix, &approach, &surface));
    assert!(hit.is_ok());
}

#[test]
fn the_error_says_what_to_do_and_other_mistakes_come_first() {
    let (matrix, approach, surface) = crate::common::two_sleds(0.6, Law::Stronge);
    let error = solve(&matrix, &approach, &surface.with_budget(1)).unwrap_err();
    assert_eq!(error.kind(), "budget_exceeded");
    let text = error.to_string();
    assert!(text.contains("budget of 1 ") && text.contains("allow more"), "{text}");
    let surface = Surface { mu: -1.0, ..surface };
    let error = solve(&matrix, &approach, &surface.with_budget(0)).unwrap_err();
    assert_eq!(error.kind(), "negative_friction");
}

#[test]
fn a_reference_to_a_surface_is_a_surface() {
    let (matrix, approach, surface) = crate::common::two_sleds(0.6, Law::Stronge);
    let by_reference: &dyn ContactSurface<f64> = &surface;
    assert_eq!(by_reference.quadratures(), u32::MAX);
    assert_eq!(solve(&matrix, &approach, &&surface), solve(&matrix, &approach, &surface));
    assert_eq!(
        solve(&matrix, &approach, &&surface.with_budget(2)).is_ok(),
        solve(&matrix, &approach, &surface.with_budget(2)).is_ok()
    );
}

/// Slip that falls to 1e-14 of what it was, far from all other directions in which slip keeps its direction,
/// and slip that hardly stops before v_n is zero: few quadratures suffice, since stretches grow with the
/// distance from the zeros of q, and no trials are made where the end of the stretch lies before the event.
#[test]
fn slip_that_nearly_stops_takes_few_quadratures() {
    let cases: [([f64; 6], [f64; 3], f64, Law); 3] = [
        (
            [
                0.6227256753461732,
                -0.25021255108031937,
                -0.604343062423163,
                1.5859466382081537,
                0.5117500559729922,
                1.4122641313125892,
            ],
            [-1.3678993416540224, 0.786297936837681, 1.8091999579524949],
            0.027652896108600337,
            Law::Poisson,
        ),
        (
            [
                1.4297848574664593,
                -0.06457416621922873,
                -1.3909347628104893,
                0.6077218171940699,
                -0.2787854823827677,
                1.692569005584747,
            ],
            [-1.2796657947303969, 0.007678903589188715, 0.8180529132681993],
            0.17830434919009275,
            Law::Stronge,
        ),
        (
            [
                0.7489787477697148,
                -0.42632012206678965,
                0.014111780195597057,
                0.6038258649265799,
                -0.18521586729893366,
                0.08719036714508038,
            ],
            [-1.161788469766577, 0.5108223288538767, 0.05192939483641465],
            1.105799512449671,
            Law::Poisson,
        ),
    ];
    for (matrix, approach, mu, law) in cases {
        let surface = Surface { mu, e: 1.0, law };
        let (matrix, approach) = (ReducedMatrix::from(matrix), Vector3::from(approach));
        let free = solve(&matrix, &approach, &surface);
        assert!(free.is_ok());
        let least = least(|surface| solve(&matrix, &approach, surface), &free, surface);
        assert!((2..=12).contains(&least), "{surface:?}: {least}");
    }
}

/// Slip that stops where v_n vanishes, up to rounding: the end of compression is not sought before the end of
/// slip, which trials would approach without end.
#[test]
fn slip_that_stops_with_compression_takes_few_quadratures() {
    let cases = [
        (
            [
                1.2923097877146716,
                0.19421831235298725,
                -0.38632745689047,
                1.1496974160002793,
                -0.29839264233540064,
                0.16703773084977058,
            ],
            [-2.154349469371084, -0.069262572155111, 0.589439985387969],
            0.8782595694065094,
            0.0,
            Law::Stronge,
        ),
        (
            [
                0.562942806722802,
                0.2421493429008592,
                0.4526094522906732,
                0.15248938765768116,
                -0.02753768809441226,
                1.3857484830968048,
            ],
            [-1.0860854810555196, -0.67146958082391, 0.06615323817356966],
            0.872419685125351,
            1.0,
            Law::Stronge,
        ),
        // After compression, where v_n falls: the contact is wedged.
        (
            [
                0.7789470244791156,
                -0.84234428589673,
                0.40107134788519766,
                1.1007386640694665,
                -0.1803747552890524,
                0.5445900498250558,
            ],
            [-0.4710830439547191, -0.08565519905859487, -1.036692324146458],
            1.5720804571408267,
            1.0,
            Law::Stronge,
        ),
    ];
    for (matrix, approach, mu, e, law) in cases {
        let surface = Surface { mu, e, law };
        let (matrix, approach) = (ReducedMatrix::from(matrix), Vector3::from(approach));
        let free = solve(&matrix, &approach, &surface);
        assert!(matches!(free, Ok(_) | Err(ImpactError::Wedged { .. })), "{free:?}");
        let least = least(|surface| solve(&matrix, &approach, surface), &free, surface);
        assert!((1..=5).contains(&least), "{surface:?}: {least}");
    }
}
