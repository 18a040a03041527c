//! Parts, repetitions and imports: what they expand to, what they see, how mistakes in them are said, and
//! that expanding ends.

use hodograph_generator::artifact::model_hash;
use hodograph_generator::check::check;
use hodograph_generator::diagnostics::codes::{self, Code};
use hodograph_generator::expand::Inline;
use hodograph_generator::format::{format, plain};
use hodograph_generator::rendering::render;
use hodograph_generator::source::Source;
use hodograph_random::Random;

pub fn source(text: &str) -> Source {
    Source::file("model.mech", text)
}

/// The codes of what is found in a model.
fn found(text: &str) -> Vec<Code> {
    let mut codes: Vec<Code> = check(&source(text)).diagnostics.iter().map(|found| found.code).collect();
    codes.dedup();
    codes
}

/// A model with parts means what the same model written out by hand means: it has the same hash, so that the
/// same derivation belongs to both, and the same values.
fn assert_same(parts: &str, by_hand: &str) {
    let (parts, by_hand) = (source(parts), source(by_hand));
    let checked = [&parts, &by_hand].map(|source| {
        let checked = check(source);
        let said = render(&checked.diagnostics, source);
        let mechanism = checked.mechanism.unwrap_or_else(|| panic!("{said}"));
        let values =
            |list: &[hodograph_generator::model::mechanism::Variable]| -> Vec<(String, Option<f64>)> {
                list.iter().map(|quantity| (quantity.name.clone(), quantity.value)).collect()
            };
        (values(&mechanism.parameters), values(&mechanism.coordinates), values(&mechanism.speeds))
    });
    assert_eq!(model_hash(&parts), model_hash(&by_hand), "{}", plain(&parts));
    assert_eq!(checked[0], checked[1]);
    // the text that is shown is a model with the same meaning
    let shown = source(&plain(&parts));
    assert_eq!(model_hash(&parts), model_hash(&shown));
    assert_eq!(format(&shown).unwrap(), shown.text().unwrap());
}

pub const LINK: &str = "part Link(hinge: point, base: frame, length: m = 0.5) {
    parameters { shared rho: kg/m, damping: N*m*s = 0.1 }
    coordinates { q: rad = 0.1 }
    speeds { u: rad/s }
    definitions { mass = rho*length; }
    frames { B = base.rotate(z, q); }
    points {
        G = hinge - length/2*B.y;
        tip of B = hinge - length*B.y;
    }
    bodies { Rod { frame: B, centre: G, mass: mass, inertia: [mass*length^2/12, 0, mass*length^2/12] } }
    loads { torque on B from base: -damping*u*B.z; }
}
";

#[test]
fn a_chain_is_what_it_is_by_hand() {
    let parts = format!(
        "mechanism Chain;\ncount n = 3;\n{LINK}parameters {{ rho: kg/m = 2, g: m/s^2 = 9.81 }}\nloads {{ gravity: -g*N.y; }}
         use Link as link[1](hinge: O, base: N, q: 0.3);
         for i in 2..n {{ use Link as link[i](hinge: link[i-1].tip, base: link[i - 1].B, length: 0.5/i); }}"
    );
    let by_hand = "mechanism Chain;
        parameters {
            rho: kg/m = 2, g: m/s^2 = 9.81,
            fixed link_1_length: m = 0.5,
            fixed link_2_length: m = 0.5/2,
            fixed link_3_length: m = 0.5/3,
            link_1_damping: N*m*s = 0.1, link_2_damping: N*m*s = 0.1, link_3_damping: N*m*s = 0.1,
        }
        coordinates { link_1_q: rad = 0.3, link_2_q: rad = 0.1, link_3_q: rad = 0.1, }
        speeds { link_1_u: rad/s, link_2_u: rad/s, link_3_u: rad/s, }
        definitions {
            link_1_mass = rho*link_1_length;
            link_2_mass = rho*link_2_length;
            link_3_mass = rho*link_3_length;
        }
        frames {
            link_1_B = N.rotate(z, link_1_q);
            link_2_B = link_1_B.rotate(z, link_2_q);
            link_3_B = link_2_B.rotate(z, link_3_q);
        }
        points {
            link_1_G = O - link_1_length/2*link_1_B.y;
            link_1_tip of link_1_B = O - link_1_length*link_1_B.y;
            link_2_G = link_1_tip - link_2_length/2*link_2_B.y;
            link_2_tip of link_2_B = link_1_tip - link_2_length*link_2_B.y;
            link_3_G = link_2_tip - link_3_length/2*link_3_B.y;
            link_3_tip of link_3_B = link_2_tip - link_3_length*link_3_B.y;
        }
        bodies {
            link_1_Rod { frame: link_1_B, centre: link_1_G, mass: link_1_mass,
                inertia: [link_1_mass*link_1_length^2/12, 0, link_1_mass*link_1_length^2/12] },
            link_2_Rod { frame: link_2_B, centre: link_2_G, mass: link_2_mass,
                inertia: [link_2_mass*link_2_length^2/12, 0, link_2_mass*link_2_length^2/12] },
            link_3_Rod { frame: link_3_B, centre: link_3_G, mass: link_3_mass,
                inertia: [link_3_mass*link_3_length^2/12, 0, link_3_mass*link_3_length^2/12] },
        }
        loads {
            gravity: -g*N.y;
            torque on link_1_B from N: -link_1_damping*link_1_u*link_1_B.z;
            torque on link_2_B from link_1_B: -link_2_damping*link_2_u*link_2_B.z;
            torque on link_3_B from link_2_B: -link_3_damping*link_3_u*link_3_B.z;
        }";
    assert_same(&parts, by_hand);
}

#[test]
fn arguments_of_every_kind_and_parts_in_parts_are_what_they_are_by_hand() {
    let parts = "mechanism Two;
        /// a foot
        part Foot(ankle: point of Shank, side: 1 = +1, k: N/m) {
            parameters { w: m = 0.05, fixed h: m = 0.01 }
            inputs { shared F: N, push: N = 1 }
            points { sole of Shank = ankle + side*w*N.x - h*N.y; }
            loads { force on sole of Shank: (F + push)*N.y - k*w*N.x; }
            contacts { floor { point: sole of Shank, normal: N.y, gap: dot(position(sole), N.y) } }
        }
        part Leg(at: point of Trunk, frame_of_trunk: frame, body: body, feet: count = 2, first: count) {
            use Foot as foot[first](ankle: at of Trunk, k: 30);
            for i in first+1..first+feet-1 {
                points { extra[i] = at + i*reach*frame_of_trunk.x; }
                use Foot as foot[i](ankle: extra[i] of body, side: -1/2, k: stiffness*i, w: reach, push: F2);
            }
            parameters { reach: m = 0.2, shared stiffness: N/m }
            inputs { F2: N = 3 }
        }
        parameters { m: kg = 1, stiffness: N/m = 7, l: m = 1 }
        inputs { F: N = 2 }
        coordinates { x: m = 1, y: m = 1, q: rad }
        speeds { ux: m/s, uy: m/s, u: rad/s }
        frames { B = N.rotate(z, q); }
        points { G = O + x*N.x + y*N.y; }
        bodies { Trunk { frame: B, centre: G, mass: m, inertia: [m*l^2, m*l^2, m*l^2] } }
        kinematics { d(x)/dt = ux; d(y)/dt = uy; d(q)/dt = u; }
        use Leg as leg(at: G - l*B.x of Trunk, frame_of_trunk: B.rotate(z, 0.2), body: Trunk, first: 3, reach: l/3);";
    let by_hand = "mechanism Two;
        parameters {
            m: kg = 1, stiffness: N/m = 7, l: m = 1,
            fixed leg_foot_3_k: N/m = 30,
            leg_foot_3_w: m = 0.05, fixed leg_foot_3_h: m = 0.01,
            fixed leg_foot_4_h: m = 0.01,
        }
        inputs { F: N = 2, leg_F2: N = 3, leg_foot_3_push: N = 1, }
        coordinates { x: m = 1, y: m = 1, q: rad }
        speeds { ux: m/s, uy: m/s, u: rad/s }
        definitions {
            leg_foot_4_k: N/m = stiffness*4;
            leg_reach: m = l/3;
            leg_foot_4_w: m = leg_reach;
            leg_foot_4_push: N = leg_F2;
        }
        frames { B = N.rotate(z, q); leg_frame_of_trunk = B.rotate(z, 0.2); }
        points {
            G = O + x*N.x + y*N.y;
            leg_at of Trunk = G - l*B.x;
            leg_foot_3_sole of Trunk = leg_at + 1*leg_foot_3_w*N.x - leg_foot_3_h*N.y;
            leg_extra_4 = leg_at + 4*leg_reach*leg_frame_of_trunk.x;
            leg_foot_4_sole of Trunk = leg_extra_4 + (-1/2)*leg_foot_4_w*N.x - leg_foot_4_h*N.y;
        }
        bodies { Trunk { frame: B, centre: G, mass: m, inertia: [m*l^2, m*l^2, m*l^2] } }
        loads {
            force on leg_foot_3_sole of Trunk: (F + leg_foot_3_push)*N.y - leg_foot_3_k*leg_foot_3_w*N.x;
            force on leg_foot_4_sole of Trunk: (F + leg_foot_4_push)*N.y - leg_foot_4_k*leg_foot_4_w*N.x;
        }
        kinematics { d(x)/dt = ux; d(y)/dt = uy; d(q)/dt = u; }
        contacts {
            leg_foot_3_floor { point: leg_foot_3_sole of Trunk, normal: N.y, gap: dot(position(leg_foot_3_sole), N.y) },
            leg_foot_4_floor { point: leg_foot_4_sole of Trunk, normal: N.y, gap: dot(position(leg_foot_4_sole), N.y) },
        }";
    assert_same(&parts.replace(" of Shank: (F", ": (F"), &by_hand.replace(" of Trunk: (F", ": (F"));
}

#[test]
fn words_of_the_grammar_are_no_names_of_a_part() {
    // coordinates called like axes, fields, functions and units keep out of each other's way
    let parts = "mechanism Words;
        part P(point: point) {
            parameters { m: kg = 1, mass: m = 2, s: 1 = 1 }
            coordinates { x: rad, normal: rad }
            speeds { ux: rad/s, of: rad/s }
            frames { frame = N.rotate(x, x); z = frame.rotate(-z, normal + sin(x)*0); }
            points { centre of z = point + mass*s*z.x; }
            particles { in { point: centre, mass: m } }
            kinematics { d(x)/dt = ux; d(normal)/dt = of; }
            contacts { gap { point: centre, normal: N.y, gap: none, surface: { mu: 0.3, law: stronge } } }
        }
        use P as a(point: O);"
        .replace(" in {", " on {");
    let by_hand = "mechanism Words;
        parameters { a_m: kg = 1, a_mass: m = 2, a_s: 1 = 1, }
        coordinates { a_x: rad, a_normal: rad, }
        speeds { a_ux: rad/s, a_of: rad/s, }
        frames { a_frame = N.rotate(x, a_x); a_z = a_frame.rotate(-z, a_normal + sin(a_x)*0); }
        points { a_centre of a_z = O + a_mass*a_s*a_z.x; }
        particles { a_on { point: a_centre, mass: a_m }, }
        kinematics { d(a_x)/dt = a_ux; d(a_normal)/dt = a_of; }
        contacts { a_gap { point: a_centre, normal: N.y, gap: none, surface: { mu: 0.3, law: stronge } }, }";
    assert_same(&parts, by_hand);
}

#[test]
fn shapes_and_their_contacts_belong_to_parts() {
    let parts = "mechanism Feet;
        part Foot(at: point, floor: point, y: 1 = 2) {
            parameters { m: kg = 1, r: m = 0.1, h: m = 0.02, k: rad/m = 3 }
            coordinates { x: m = touching(sole_2, 0.3) }
            speeds { ux: m/s }
            points { P = at + x*N.z; }
            bodies { Ball { frame: N, centre: P, mass: m, inertia: [m*r^2, m*r^2, m*r^2] } }
            shapes {
                Ends { of: Ball, capsule: [r, y*r], axis: N.x, colour: teal },
                Ground { at: floor, half_space: N.z },
                Waves { at: floor - h*N.z, surface: h*sin(k*x)*cos(k*y) },
                Post { at: floor, implicit: x^2 + y*z - h^2 },
                Cube { of: Ball, box: [r, r, r] },
            }
            contacts { sole { Ends on Ground, surface: { mu: 0.4 } }, bumps { Cube on Waves } }
            kinematics { d(x)/dt = ux; }
        }
        parameters { l: m = 1 }
        points { side = O + l*N.x; }
        use Foot as left(at: O, floor: O);
        use Foot as right(at: side, floor: side, y: 3);"
        .replace("kinematics { d(x)/dt = ux; }", "")
        .replace("contacts {", "kinematics { d(x)/dt = ux; } contacts {");
    let one = |foot: &str, at: &str, y: &str| -> Vec<String> {
        [
            "A_m: kg = 1, A_r: m = 0.1, A_h: m = 0.02, A_k: rad/m = 3,",
            "A_x: m = touching(A_sole_2, 0.3),",
            "A_ux: m/s,",
            "A_P = AT + A_x*N.z;",
            "A_Ball { frame: N, centre: A_P, mass: A_m, inertia: [A_m*A_r^2, A_m*A_r^2, A_m*A_r^2] },",
            "A_Ends { of: A_Ball, capsule: [A_r, Y*A_r], axis: N.x, colour: teal },
             A_Ground { at: AT, half_space: N.z },
             A_Waves { at: AT - A_h*N.z, surface: A_h*sin(A_k*x)*cos(A_k*y) },
             A_Post { at: AT, implicit: x^2 + y*z - A_h^2 },
             A_Cube { of: A_Ball, box: [A_r, A_r, A_r] },",
            "d(A_x)/dt = A_ux;",
            "A_sole { A_Ends on A_Ground, surface: { mu: 0.4 } }, A_bumps { A_Cube on A_Waves },",
        ]
        .iter()
        .map(|text| text.replace("AT", at).replace('Y', y).replace("A_", &format!("{foot}_")))
        .collect()
    };
    let (left, right) = (one("left", "O", "2"), one("right", "side", "3"));
    let words =
        ["parameters", "coordinates", "speeds", "points", "bodies", "shapes", "kinematics", "contacts"];
    let own = ["l: m = 1,", "", "", "side = O + l*N.x;", "", "", "", ""];
    let sections: String = (0..words.len())
        .map(|i| format!("{} {{ {} {} {} }}\n", words[i], own[i], left[i], right[i]))
        .collect();
    assert_same(&parts, &format!("mechanism Feet; {sections}"));
}

/// A part of one particle whose force names something; the mechanism has `k`, `c`, `P` and `F`.
fn seen(inside: &str, force: &str) -> Vec<Code> {
    found(
        &format!(
            "mechanism Seen;
        part Drop(from: point) {{
            {inside}
            coordinates {{ q: m }}
            speeds {{ u: m/s }}
            points {{ at = from + q*N.x; }}
            particles {{ Ball {{ point: at, mass: 1*{{mass}} }} }}
            loads {{ force on at: {force}*N.x; }}
        }}
        parameters {{ k: N = 1, m: kg = 1 }}
        inputs {{ F: N }}
        coordinates {{ y: m }}
        speeds {{ uy: m/s }}
        definitions {{ c = 2*k; }}
        points {{ P = O + y*N.y; }}
        particles {{ Own {{ point: P, mass: m }} }}
        loads {{ force on P: (c + k + F)*N.y; }}
        kinematics {{ d(y)/dt = uy; }}
        use Drop as drop(from: P);"
        )
        .replace("1*{mass}", "w"),
    )
}

#[test]
fn a_part_sees_what_it_declares_is_given_or_shares() {
    let weight = "parameters { w: kg = 1 }";
    assert_eq!(seen(weight, "w*(q + u/u*q)/q"), vec![codes::DIMENSION], "what it declares is seen");
    for outer in ["k", "F", "c", "(k*uy/uy)"] {
        assert_eq!(seen(weight, outer), vec![codes::OUTER_NAME], "{outer}");
    }
    assert_eq!(seen("parameters { w: kg = 1, shared k: N }", "k"), vec![]);
    assert_eq!(seen("parameters { w: kg = 1, k: N = 3 }", "k"), vec![], "its own k is another");
    assert_eq!(seen("parameters { w: kg = 1 } inputs { shared F: N }", "F"), vec![]);
    // a definition of the mechanism is no parameter
    assert_eq!(seen("parameters { w: kg = 1, shared c: N }", "c"), vec![codes::OUTER_NAME]);
    // what nobody declares is unknown, as everywhere
    assert_eq!(seen(weight, "zeta"), vec![codes::UNKNOWN_NAME]);
    // nor does the mechanism see into a part without its name
    assert_eq!(seen("parameters { w: kg = 1, k: N = 1 }", "drop_k"), vec![codes::OUTER_NAME]);
}

#[test]
fn own_names_do_not_meet_those_of_other_instances() {
    let text = "mechanism Two;
        part Drop(from: point) {
            parameters { m: kg = 1 }
            coordinates { q: m }
            speeds { u: m/s }
            points { at = from + q*N.x; }
            particles { Ball { point: at, mass: m } }
        }
        use Drop as a(from: O, m: 3);
        use Drop as b(from: a.at, q: 2);";
    let mechanism = check(&source(text)).mechanism.unwrap();
    let of = |list: &[hodograph_generator::model::mechanism::Variable]| -> Vec<(String, f64)> {
        list.iter().map(|quantity| (quantity.name.clone(), quantity.value.unwrap_or(0.0))).collect()
    };
    assert_eq!(of(&mechanism.parameters), [("a_m".to_owned(), 3.0), ("b_m".to_owned(), 1.0)]);
    assert_eq!(of(&mechanism.coordinates), [("a_q".to_owned(), 0.0), ("b_q".to_owned(), 2.0)]);
}

#[test]
fn an_empty_range_repeats_nothing() {
    let text = |n: &str| {
        format!(
            "mechanism Chain; count n = {n}; {LINK} parameters {{ rho: kg/m = 2 }} use Link as link[1](hinge: O, base: N); \
             for i in 2..n {{ use Link as link[i](hinge: link[i-1].tip, base: link[i-1].B); }}"
        )
    };
    let speeds = |n: &str| check(&source(&text(n))).mechanism.unwrap().speeds.len();
    assert_eq!([speeds("1"), speeds("2"), speeds("0"), speeds("2*4-1")], [1, 2, 1, 7]);
}

/// Parts that use each other, at random: some know each other in a circle, some are not there.
fn nested(random: &mut Random) -> String {
    let parts = 1 + random.below(6);
    let mut text = format!("mechanism M;\ncount n = {};\n", random.below(4));
    for part in 0..parts {
        text.push_str(&format!(
            "part P{part}(a: point of A, b: frame, n: count = {}, v: m = 1) {{\n",
            random.below(3)
        ));
        if random.below(3) > 0 {
            text.push_str("parameters { m: kg = 1 } coordinates { q: m } speeds { u: m/s }\n");
            text.push_str("points { P = a + (q + v)*b.x; } particles { B { point: P, mass: m } }\n");
        }
        for inner in 0..random.below(3) {
            let other = if random.below(12) == 0 { random.below(parts + 1) } else { random.below(part + 1) };
            if other == part && random.below(8) > 0 {
                continue;
            }
            match random.below(3) {
                0 => text.push_str(&format!("use P{other} as x{inner}(a: a of A, b: b);\n")),
                1 => text.push_str(&format!(
                    "for i in {}..n {{ use P{other} as y{inner}[i](a: a of b, b: b, n: n - i, v: v*i); }}\n",
                    random.below(3)
                )),
                _ => text.push_str(&format!(
                    "use P{other} as z{inner}(a: a + 2*v*b.y of A, b: b.rotate(z, 0.1), n: 1);\n"
                )),
            }
        }
        text.push_str("}\n");
    }
    text.push_str(
        "parameters { m: kg = 1 }\ncoordinates { q: m }\nspeeds { u: m/s }\npoints { P = O + q*N.x; }\n",
    );
    text.push_str(&format!(
        "particles {{ B {{ point: P, mass: m }} }}\nuse P{} as top(a: P of N, b: N);\n",
        parts - 1
    ));
    text
}

#[test]
fn random_nesting_ends_in_a_model_or_in_messages() {
    let mut random = Random::new(7);
    let (mut sound, mut instances) = (0, 0);
    for _ in 0..200 {
        let text = nested(&mut random);
        let source = source(&text);
        let checked = check(&source);
        let said = render(&checked.diagnostics, &source);
        if let Some(mechanism) = checked.mechanism {
            sound += 1;
            instances += mechanism.coordinates.len();
            assert_eq!(model_hash(&source), model_hash(&self::source(&plain(&source))), "{text}");
        } else {
            assert!(!checked.diagnostics.is_empty(), "{text}");
        }
        assert!(!said.contains("P0_"), "{said}");
    }
    assert!(sound > 20 && instances > 100, "{sound} {instances}");
}

#[test]
fn mutated_parts_end_in_a_model_or_in_messages() {
    let model = format!(
        "mechanism Chain;\ncount n = 3;\n{LINK}part Two(top: point of A) {{ use Link as a(hinge: top, base: A); \
         for i in 1..2 {{ points {{ E[i] = a.tip + i*a.length*N.x; }} use Link as b[i](hinge: E[i], base: a.B); }} }}\n\
         parameters {{ rho: kg/m = 2 }}\nuse Two as two(top: O of N);\n\
         for i in 2..n {{ use Link as link[i](hinge: two.b[i-1].tip, base: N, damping: 2*i); }}\n"
    );
    assert_eq!(found(&model), vec![], "{}", render(&check(&source(&model)).diagnostics, &source(&model)));
    let words: Vec<&str> =
        model.split_inclusive([' ', '(', ')', '[', ']', ';', ',', ':', '{', '}', '.']).collect();
    let mut random = Random::new(11);
    for _ in 0..300 {
        let mut words = words.clone();
        for _ in 0..1 + random.below(3) {
            let (at, other) = (random.below(words.len()), random.below(words.len()));
            match random.below(4) {
                0 => drop(words.remove(at)),
                1 => words.swap(at, other),
                2 => words[at] = words[other],
                _ => words.insert(at, words[other]),
            }
        }
        let text = words.concat();
        let file = source(&text);
        let checked = check(&file);
        assert!(checked.mechanism.is_some() || !checked.diagnostics.is_empty(), "{text}");
        let _ = (render(&checked.diagnostics, &file), plain(&file), model_hash(&file));
        // as tokens of Rust
        let Ok(stream) = text.parse::<proc_macro2::TokenStream>() else { continue };
        let inline = Inline::new("here", stream);
        let said = |found: &hodograph_generator::check::Checked| -> Vec<(Code, String)> {
            found.diagnostics.iter().map(|found| (found.code, found.message.clone())).collect()
        };
        let found = check(&inline.source);
        assert_eq!(said(&checked), said(&found), "{text}");
        found.diagnostics.iter().for_each(|found| {
            assert!(inline.rust_spans(found.primary.span).is_some());
            let _ = found.compiler_text(&inline.source);
        });
        if let Ok(laid_out) = format(&file) {
            assert_eq!(format(&source(&laid_out)).unwrap(), laid_out, "{text}");
        }
    }
}

#[test]
fn expanding_is_bounded() {
    // each of these would write out more than a machine holds
    let doubling = |inner: &str| {
        let levels: String = (1..60)
            .map(|i| format!("part P{i}() {{ use P{} as a; use P{} as b; }}\n", i - 1, i - 1))
            .collect();
        format!("mechanism M;\npart P0() {{ {inner} }}\n{levels}use P59 as all;\n")
    };
    let loops = |depth: usize| {
        let open: String = (0..depth).map(|i| format!("for i{i} in 1..1000 {{ ")).collect();
        format!("mechanism M;\n{open}{}", "}".repeat(depth))
    };
    let long = format!(
        "mechanism M;\npart P() {{ definitions {{ {} }} }}\nfor i in 1..9000 {{ use P as p[i](); }}\n",
        (0..200).map(|i| format!("d{i} = {i};")).collect::<String>()
    );
    let deep: String = (1..2000).map(|i| format!("part P{i}() {{ use P{} as a; }}\n", i - 1)).collect();
    let deep = format!("mechanism M;\npart P0() {{ }}\n{deep}use P1999 as all;\n");
    for (text, code) in [
        (doubling(""), codes::REPETITION),
        (doubling("parameters { m: kg }"), codes::REPETITION),
        (loops(2), codes::REPETITION),
        (loops(9), codes::REPETITION),
        (loops(500), codes::TOO_DEEP),
        (long, codes::REPETITION),
        (deep, codes::TOO_DEEP),
        ("mechanism M;\nfor i in 1..9007199254740991 { }".to_owned(), codes::REPETITION),
        ("mechanism M;\nfor i in -9007199254740991..9007199254740991 { }".to_owned(), codes::REPETITION),
    ] {
        let found = found(&text);
        assert!(found.contains(&code), "{found:?} {}", &text[..text.len().min(300)]);
    }
}
