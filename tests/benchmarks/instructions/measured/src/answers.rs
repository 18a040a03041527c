//! What answers cost by value and in place: each routine of the benchmark of generated code in three functions. One has
//! the answer in memory of the caller, one returns it, and one takes it out of its `Result` by `?` and assigns it.

/// A call of a method with arguments in parentheses, and perhaps another one.
macro_rules! called {
    ($this:ident $name:ident ($arguments_q:ident) $out:ident) => {
        $this.$name($arguments_q, $out)
    };
    ($this:ident $name:ident ($arguments_q:ident $arguments_u:ident) $out:ident) => {
        $this.$name($arguments_q, $arguments_u, $out)
    };
    ($this:ident $name:ident ($arguments_q:ident $arguments_u:ident $arguments_a:ident) $out:ident) => {
        $this.$name($arguments_q, $arguments_u, $arguments_a, $out)
    };
    ($this:ident $name:ident ($arguments_q:ident)) => {
        $this.$name($arguments_q)
    };
    ($this:ident $name:ident ($arguments_q:ident $arguments_u:ident)) => {
        $this.$name($arguments_q, $arguments_u)
    };
    ($this:ident $name:ident ($arguments_q:ident $arguments_u:ident $arguments_a:ident)) => {
        $this.$name($arguments_q, $arguments_u, $arguments_a)
    };
}

/// Three functions for each routine, and what calls them.
macro_rules! routines {
    ($m:ident $q:ident $u:ident $a:ident: $($in_place:ident $by_value:ident $assigned:ident $answer:ty, $method:ident $into:ident($arguments:tt);)*) => {
        $(
            #[inline(never)]
            #[allow(unused_variables, reason = "not every routine takes all")]
            fn $in_place($m: &Model, ($q, $u, $a): &State, out: &mut $answer) -> Result<(), StateError> {
                black_box((module_path!(), stringify!($in_place)));
                called!($m $into $arguments out)
            }
            #[inline(never)]
            #[allow(unused_variables, reason = "not every routine takes all")]
            fn $by_value($m: &Model, ($q, $u, $a): &State) -> Result<$answer, StateError> {
                black_box((module_path!(), stringify!($by_value)));
                called!($m $method $arguments)
            }
            #[inline(never)]
            #[allow(unused_variables, reason = "not every routine takes all")]
            fn $assigned($m: &Model, ($q, $u, $a): &State, out: &mut $answer) -> Result<(), StateError> {
                black_box((module_path!(), stringify!($assigned)));
                *out = called!($m $method $arguments)?;
                Ok(())
            }
        )*

        /// Every function once.
        pub fn run() {
            let (m, state) = prepared();
            $(
                let answer = $by_value(&m, &state);
                let mut out = *answer.as_ref().expect("a regular state");
                black_box(&answer);
                let _ = black_box($in_place(&m, &state, &mut out));
                let _ = black_box($assigned(&m, &state, &mut out));
            )*
        }

        /// Prints nanoseconds of a call of each. The functions take turns.
        pub fn times() {
            let (m, state) = prepared();
            $(
                let mut out = $by_value(&m, &state).expect("a regular state");
                let mut least = [f64::INFINITY; 3];
                for _ in 0..ROUNDS {
                    let mut turn = |which: usize, call: &mut dyn FnMut()| {
                        let start = Instant::now();
                        (0..CALLS).for_each(|_| call());
                        least[which] = least[which].min(start.elapsed().as_secs_f64() * 1e9 / CALLS as f64);
                    };
                    turn(0, &mut || { let _ = black_box($in_place(black_box(&m), black_box(&state), black_box(&mut out))); });
                    turn(1, &mut || { black_box(&$by_value(black_box(&m), black_box(&state))); });
                    turn(2, &mut || { let _ = black_box($assigned(black_box(&m), black_box(&state), black_box(&mut out))); });
                }
                let [in_place, by_value, assigned] = least;
                let module = module_path!().rsplit("::").next().unwrap_or_default();
                println!("{module} {} {in_place:.2} {by_value:.2} {assigned:.2}", stringify!($in_place));
            )*
        }
    };
}

/// The functions of a module, in a module of their own.
macro_rules! answers {
    ($($answers:ident $module:ident $type:ident $speeds:literal $contact:ident $contact_into:ident;)*) => {
        $(mod $answers {
            use std::hint::black_box;
            use std::time::Instant;

            use hodograph::nalgebra::SMatrix;
            use hodograph::{ReducedMatrix, StateError};
            use hodograph_models::$module::*;

            /// How often all is called to measure time; the fastest counts.
            const ROUNDS: usize = 2000;
            /// Calls between two looks at the clock.
            const CALLS: usize = 200;

            type Model = $type<f64>;
            type State = (Coordinates<f64>, Speeds<f64>, Speeds<f64>);

            /// The state in which all is measured.
            fn prepared() -> (Model, State) {
                let mut at = <[f64; $speeds]>::from(Speeds::<f64>::default());
                at.iter_mut().zip(1..).for_each(|(u, i)| *u += 0.3 * f64::from(i).sin());
                (black_box(Model::default()), black_box((Coordinates::default(), Speeds::from(at), Speeds::from(at))))
            }

            routines! { m q u a:
                accelerations accelerations_by_value accelerations_assigned Speeds<f64>, accelerations accelerations_into((q u));
                inverse_dynamics inverse_dynamics_by_value inverse_dynamics_assigned SMatrix<f64, $speeds, 1>, inverse_dynamics inverse_dynamics_into((q u a));
                contact_matrices contact_matrices_by_value contact_matrices_assigned (SMatrix<f64, 3, $speeds>, ReducedMatrix<f64>), $contact $contact_into((q));
                mass_matrix mass_matrix_by_value mass_matrix_assigned SMatrix<f64, $speeds, $speeds>, mass_matrix mass_matrix_into((q));
                accelerations_derivatives accelerations_derivatives_by_value accelerations_derivatives_assigned Derivatives<f64>, accelerations_derivatives accelerations_derivatives_into((q u));
                inverse_dynamics_derivatives inverse_dynamics_derivatives_by_value inverse_dynamics_derivatives_assigned Derivatives<f64>, inverse_dynamics_derivatives inverse_dynamics_derivatives_into((q u a));
                linearise linearise_by_value linearise_assigned Linearisation<f64>, linearise linearise_into((q u));
            }
        })*

        /// Every function of every module once.
        fn run_answers() {
            $($answers::run();)*
        }

        /// The times of all.
        fn times_of_answers() {
            $($answers::times();)*
        }
    };
}
