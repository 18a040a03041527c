//! Tests of the import of MJCF: what classes inherit, springs, and statements that contradict each other.
//! Numbers are those of MuJoCo 4.0.0.

use super::tests_of_formats::{ARM, accepted, has, imported, mjcf, refused};
use super::{Options, import};

/// A kind of actuator inherits from the innermost class that has defaults of this kind or of `general`.
#[test]
fn actuators_inherit_from_their_own_kind() {
    // the gain, and the force per unit of the coordinate and of the speed
    let law = |defaults: &str, actuator: &str| {
        let class = if defaults.contains("class") { "class=\"k\"" } else { "" };
        let actuator = format!("<actuator><{actuator} name=\"m\" joint=\"hip\" {class}/></actuator>");
        let (model, _) = imported(&mjcf(ARM, &format!("<default>{defaults}</default>{actuator}")), "m.xml");
        accepted(&model);
        let value = |name: &str, usual: f64| {
            let line = model.lines().find_map(|line| line.trim().strip_prefix(name));
            line.map_or(usual, |line| line.split(" = ").nth(1).unwrap().trim_matches(',').parse().unwrap())
        };
        [value("gain_m:", 1.0), value("kq_m:", 0.0), value("ku_m:", 0.0)]
    };
    let [position, velocity, both] =
        ["<position kp=\"100\"/>", "<velocity kv=\"9\"/>", "<position kp=\"100\"/><velocity kv=\"9\"/>"];
    assert_eq!(law(both, "position kp=\"2\""), [2.0, -2.0, 0.0]);
    assert_eq!(law(position, "velocity"), [1.0, 0.0, -1.0]);
    assert_eq!(law(both, "position"), [1.0, -1.0, 0.0]);
    assert_eq!(law(both, "general"), [9.0, 0.0, -9.0]);
    assert_eq!(law(position, "general gainprm=\"2\""), [2.0, -100.0, 0.0]);
    assert_eq!(law(velocity, "velocity"), [9.0, 0.0, -9.0]);
    // what all kinds have in common comes from `general`
    let general = "<general biastype=\"affine\" gainprm=\"7\" biasprm=\"0 -2 -3\"/>";
    assert_eq!(law(general, "position"), [7.0, -7.0, -3.0]);
    assert_eq!(law(general, "velocity"), [7.0, 0.0, -7.0]);
    assert_eq!(law(&format!("{velocity}<general gear=\"1\"/>"), "position"), [9.0, -9.0, -9.0]);
    assert_eq!(law("<general gainprm=\"5\"/><motor/>", "position"), [1.0, -1.0, 0.0]);
    // an inner class does not hide the kinds of the outer one that it has not itself
    let inner = |own: &str| format!("<position kp=\"8\" kv=\"2\"/><default class=\"k\">{own}</default>");
    assert_eq!(law(&inner("<velocity/>"), "position"), [8.0, -8.0, -2.0]);
    assert_eq!(law(&inner("<velocity/>"), "velocity"), [1.0, 0.0, -1.0]);
    assert_eq!(law(&inner("<position kv=\"3\"/>"), "position"), [8.0, -8.0, -3.0]);
    assert_eq!(law(&inner("<general gainprm=\"3\"/>"), "velocity"), [3.0, 0.0, -3.0]);
    assert_eq!(law("<muscle/>", "position"), [1.0, -1.0, 0.0]);
}

/// A servo with a time constant has a state of its own, which a model has not.
#[test]
fn servos_with_dynamics_are_refused() {
    let servo = |defaults: &str, attributes: &str| {
        let position = format!("<position name=\"m\" joint=\"hip\" {attributes}/>");
        mjcf(ARM, &format!("<default>{defaults}</default><actuator>{position}</actuator>"))
    };
    for source in [servo("", "timeconst=\"0.1\""), servo("<position timeconst=\"0.1\"/>", "")] {
        let said = refused(&source, "m.xml");
        assert!(
            said.contains("a `position` without `timeconst`") && said.contains("state its force"),
            "{said}"
        );
    }
    let (_, notes) = imported(&servo("<position timeconst=\"0.1\"/>", "timeconst=\"0\""), "m.xml");
    assert!(notes.is_empty(), "{notes}");
    assert!(
        refused(&servo("", "dampratio=\"1\""), "m.xml").contains("`dampratio` is not imported: state `kv`")
    );
    let both = refused(&servo("", "dampratio=\"1\" kv=\"1\""), "m.xml");
    assert!(both.contains("state one of `kv` and `dampratio`"), "{both}");
}

/// An element's own orientation takes the place of that of its class in any form, and its own sizes those
/// that it states.
#[test]
fn elements_override_their_classes_in_any_form() {
    let of = |class: &str, own: &str| {
        let defaults = format!("<default><default class=\"k\"><geom {class}/></default></default>");
        let body = format!(
            "<body name=\"arm\"><joint name=\"hip\"/><geom class=\"k\" pos=\"0.3 0 0\" {own}/></body>"
        );
        imported(&mjcf(&body, &defaults), "m.xml").0
    };
    let solid = "type=\"box\" size=\"0.1 0.2 0.3\"";
    let turned = of("", &format!("{solid} euler=\"90 0 0\""));
    accepted(&turned);
    has(&turned, "arm_shape_axes = arm_axes.rotate(x, pi/2);");
    for class in ["quat=\"1 0 1 0\"", "zaxis=\"1 1 1\"", "euler=\"10 20 30\""] {
        assert_eq!(turned, of(class, &format!("{solid} euler=\"90 0 0\"")), "{class}");
        let quaternion = format!("{solid} quat=\"1 1 0 0\"");
        assert_eq!(of("", &quaternion), of(class, &quaternion), "{class}");
    }
    assert_eq!(
        of("type=\"capsule\" size=\"0.1 0.2\"", "size=\"0.3\""),
        of("", "type=\"capsule\" size=\"0.3 0.2\"")
    );
    assert_eq!(of(solid, "size=\"0.4 0.5\""), of("", "type=\"box\" size=\"0.4 0.5 0.3\""));
}

/// A box or ellipsoid between two points is as wide as deep.
#[test]
fn boxes_and_ellipsoids_lie_between_two_points() {
    let of = |kind: &str, more: &str| {
        let geom = format!("<geom type=\"{kind}\" size=\"0.3 0.9\" fromto=\"0 0 1 0 0 5\" {more}/>");
        mjcf(&format!("<body name=\"arm\"><joint name=\"hip\"/>{geom}</body>"), "")
    };
    let (model, _) = imported(&of("box", ""), "m.xml");
    accepted(&model);
    has(&model, "sz_arm_shape: m = 3,");
    for (name, length) in [("a", "0.6"), ("b", "0.6"), ("c", "4")] {
        has(&model, &format!("{name}_arm_shape: m = {length},"));
    }
    has(&model, "m_arm: kg = 1440,");
    has(&imported(&of("ellipsoid", ""), "m.xml").0, "c_arm_shape: m = 2,");
    let said = refused(&of("sphere", ""), "m.xml");
    assert!(said.contains("`fromto` is for capsules, cylinders, boxes and ellipsoids"), "{said}");
    let said = refused(&of("box", "pos=\"1 0 0\""), "m.xml");
    assert!(said.contains("it has both `pos` and `fromto`: keep one"), "{said}");
}

/// Springs of joints store energy: they are loads of their own, also in moving bodies.
#[test]
fn springs_of_mjcf_store_energy() {
    let body = |name: &str, joint: &str, inner: &str| {
        format!("<body name=\"{name}\"><joint name=\"j{name}\" {joint}/><geom size=\"0.1\"/>{inner}</body>")
    };
    let hinge = "axis=\"0 -1 0\" stiffness=\"3\" springref=\"180\"";
    let slide = "type=\"slide\" axis=\"1 0 0\" stiffness=\"20\"";
    let at_rest = format!("{slide} springref=\"0.5\" damping=\"1\"");
    let chain = body("a", slide, &body("b", hinge, &body("c", &at_rest, "")));
    let (model, notes) = imported(&mjcf(&chain, ""), "m.xml");
    accepted(&model);
    has(&model, "ja_anchor = O - l_ja*N.x;");
    has(&model, "l_ja: m = 100,");
    has(&model, "spring a_origin to ja_anchor: { stiffness: s_ja, length: l_ja };");
    has(&model, "torsion b_axes from N about -b_axes.y: { angle: q_jb, rest: q0_jb, stiffness: s_jb };");
    has(&model, "jc_anchor = a_origin - l_jc*b_axes.x;");
    has(&model, "spring c_origin to jc_anchor: { stiffness: s_jc, length: l_jc + q0_jc };");
    has(&model, "force on c_origin from a_origin: (-d_jc*u_jc)*b_axes.x;");
    // gravity and the three springs
    let source = hodograph_generator::source::Source::file("imported.mech", &model);
    let loads = hodograph_generator::check::check(&source).mechanism.unwrap().loads;
    assert_eq!(loads.iter().filter(|load| load.potential).count(), 4, "{model}");
    let told = "the spring of joint `ja` is a long one along its axis, so that it stores energy: it is exact while the \
                coordinate is above -100 m";
    assert!(notes.contains(told), "{notes}");
    let (model, _) = imported(&mjcf(&body("a", &slide.replace("1 0 0", "0 -1 0"), ""), ""), "m.xml");
    accepted(&model);
    has(&model, "ja_anchor = O + l_ja*N.y;");
    let two = body("a", hinge, &body("b", hinge, ""));
    let (model, _) = imported(&mjcf(&two, ""), "m.xml");
    accepted(&model);
    has(&model, "torsion b_axes from a_axes about -b_axes.y: { angle: q_jb, rest: q0_jb, stiffness: s_jb };");
}

#[test]
fn inertias_of_mjcf_are_stated_once() {
    let with = |inertials: &str| ARM.replace("<geom", &format!("{inertials}<geom"));
    let inertial = |more: &str| format!("<inertial pos=\"0 0 0\" mass=\"1\" {more}/>");
    let diagonal = inertial("diaginertia=\"1 1 1\"");
    let said = refused(&mjcf(&with(&diagonal.repeat(2)), ""), "m.xml");
    assert!(said.contains("<inertial>: a second <inertial> of body `arm`: keep one"), "{said}");
    let full = inertial("fullinertia=\"1 1 1 0 0 0\" euler=\"0 0 10\"");
    let said = refused(&mjcf(&with(&full), ""), "m.xml");
    assert!(said.contains("`fullinertia` is along the axes of the body"), "{said}");
    let (model, _) = imported(&mjcf(&with(&inertial("fullinertia=\"1 2 2 0 0 0\"")), ""), "m.xml");
    has(&model, "Iyy_arm: kg*m^2 = 2,");
}

#[test]
fn deep_defaults_are_refused() {
    let nested = |count: usize| {
        let open: String = (0..count).map(|k| format!("<default class=\"c{k}\">")).collect();
        format!("<default>{open}{}</default>", "</default>".repeat(count))
    };
    imported(&mjcf(ARM, &nested(150)), "m.xml");
    let said = refused(&mjcf(ARM, &nested(20_000)), "m.xml");
    assert!(said.contains("m.xml:5:") && said.contains("defaults are nested more than 200 deep"), "{said}");
}

/// The centre of a shape may be a point that does not move: that of a hinge in the world.
#[test]
fn shapes_may_be_at_a_hinge_in_the_world() {
    let geoms = "<geom size=\"0.1\"/><geom size=\"0.1\" pos=\"0.01 0 1\"/>";
    let body = format!("<body name=\"arm\"><joint name=\"hip\" axis=\"0 1 0\"/>{geoms}</body>");
    let (model, _) = imported(&mjcf(&body, ""), "m.xml");
    has(&model, "arm_shape { of: arm, at: O, sphere: r_arm_shape },");
    accepted(&model);
    // a shape that does not move with its body is refused still
    let fixed = model.replace("at: O + ", "at: O + r_arm_shape*N.z + ");
    let source = hodograph_generator::source::Source::file("imported.mech", &fixed);
    assert!(hodograph_generator::check::check(&source).has_errors(), "{fixed}");
}

/// The contact of a body is at its own origin, not at that of its joint.
#[test]
fn contacts_are_at_the_origins_of_bodies() {
    let body = ARM.replace("name=\"hip\"", "name=\"hip\" pos=\"0.5 0 0\"");
    let options = Options { contacts: vec!["arm".to_owned()], ..Options::default() };
    let model = import(&mjcf(&body, ""), "m.xml", &options).unwrap().model;
    accepted(&model);
    has(
        &model,
        "contact_arm { point: arm_frame_origin of arm, normal: N.z, gap: dot(position(arm_frame_origin), N.z) },",
    );
}
