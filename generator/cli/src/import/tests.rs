//! Tests of the import: small robots, and descriptions that are refused.

use super::{Options, import};

fn robot(body: &str) -> String {
    format!("<robot name=\"two\">\n{body}\n</robot>")
}

fn link(name: &str) -> &'static str {
    let text = format!(
        "<link name=\"{name}\"><inertial><origin xyz=\"0 0 0.5\"/><mass value=\"2\"/>\
         <inertia ixx=\"0.1\" ixy=\"0\" ixz=\"0\" iyy=\"0.1\" iyz=\"0\" izz=\"0.02\"/></inertial></link>\n"
    );
    text.leak()
}

fn joint(name: &str, kind: &str, parent: &str, child: &str, more: &str) -> &'static str {
    let text = format!(
        "<joint name=\"{name}\" type=\"{kind}\"><parent link=\"{parent}\"/><child link=\"{child}\"/>{more}</joint>\n"
    );
    text.leak()
}

/// The problems of a robot, all of them.
fn refused(body: &str) -> String {
    import(&robot(body), "r.urdf", &Options::default()).unwrap_err().join("\n")
}

fn model(body: &str, options: &Options) -> (String, String) {
    let imported = import(&robot(body), "r.urdf", options).unwrap();
    (imported.model, imported.notes.join("\n"))
}

fn has(model: &str, line: &str) {
    assert!(model.lines().any(|other| other.trim() == line), "no line `{line}` in\n{model}");
}

#[test]
fn joints_become_frames_points_and_loads() {
    let axis = "<origin xyz=\"0 0 0.25\" rpy=\"1.5707963267948966 0 0\"/><axis xyz=\"0 -1 0\"/>";
    let body = "<link name=\"base\"/>".to_owned()
        + link("arm")
        + link("hand")
        + joint("hip-1", "revolute", "base", "arm", &format!("{axis}<dynamics damping=\"0.5\"/>"))
        + joint("slide", "prismatic", "arm", "hand", "<axis xyz=\"1 0 0\"/>");
    let (model, notes) = model(&body, &Options { contacts: vec!["hand".into()], ..Options::default() });
    has(&model, "hip_1_base = N.rotate(x, pi/2);");
    has(&model, "arm_axes = hip_1_base.rotate(-y, q_hip_1);");
    has(&model, "arm_origin = O + oz_hip_1*N.z;");
    has(&model, "arm_centre = arm_origin + cz_arm*arm_axes.z;");
    has(&model, "hand_origin = arm_origin + q_slide*arm_axes.x;");
    has(&model, "torque on arm_axes: -(tau_hip_1 - d_hip_1*u_hip_1)*arm_axes.y;");
    has(&model, "force on hand_origin from arm_origin: tau_slide*arm_axes.x;");
    has(
        &model,
        "arm { frame: arm_axes, centre: arm_centre, mass: m_arm, inertia: [Ixx_arm, Iyy_arm, Izz_arm] },",
    );
    has(
        &model,
        "contact_hand { point: hand_origin of hand, normal: N.z, gap: dot(position(hand_origin), N.z) },",
    );
    assert!(notes.contains("root link `base` has no inertia"), "{notes}");
}

#[test]
fn a_base_with_inertia_is_free() {
    let body = link("trunk").to_owned()
        + link("tail")
        + joint("j", "continuous", "trunk", "tail", "<axis xyz=\"0.6 0 0.8\"/>");
    let (free, _) = model(&body, &Options::default());
    has(&free, "trunk_axes = N.quaternion(q_base_e0, q_base_e1, q_base_e2, q_base_e3);");
    has(&free, "trunk_origin = u_base_x*trunk_axes.x + u_base_y*trunk_axes.y + u_base_z*trunk_axes.z;");
    has(&free, "tail_axes = trunk_axes.rotate([0.6, 0, 0.8], q_j);");
    let (fixed, notes) = model(&body, &Options { floating: Some(false), ..Options::default() });
    assert!(!fixed.contains("quaternion"), "{fixed}");
    assert!(notes.contains("ignored the inertia of link `trunk`"), "{notes}");
}

#[test]
fn fixed_links_become_one_body() {
    let body = link("base").to_owned()
        + link("tool")
        + joint("weld", "fixed", "base", "tool", "<origin xyz=\"0 0 1\" rpy=\"3.141592653589793 0 0\"/>");
    let (model, _) = model(&body, &Options::default());
    // Two equal links end to end: the mass centre is midway between their centres.
    has(&model, "m_base: kg = 4,");
    has(&model, "cz_base: m = 0.5,");
    has(&model, "Ixx_base: kg*m^2 = 0.2,");
    has(&model, "tool_axes = base_axes.rotate(x, pi);");
}

/// An origin may be turned by a quaternion, of any length, whose scalar part is the last.
#[test]
fn an_origin_is_turned_by_a_quaternion() {
    let with = |origin: &str| {
        let body = link("base").to_owned() + link("arm") + joint("j", "revolute", "base", "arm", origin);
        model(&body, &Options::default()).0
    };
    for (quaternion, rpy) in [
        ("0 0 0 2", "0 0 0"),
        ("1 0 0 1", "1.5707963267948966 0 0"),
        ("-0.6 0 0 -0.8", "1.2870022175865687 0 0"),
    ] {
        let turned = with(&format!("<origin xyz=\"0 0 1\" quat_xyzw=\"{quaternion}\"/>"));
        assert_eq!(turned, with(&format!("<origin xyz=\"0 0 1\" rpy=\"{rpy}\"/>")));
    }
}

#[test]
fn odd_inertias_of_fixed_or_unused_links_do_not_matter() {
    let speck = "<link name=\"speck\"><inertial><mass value=\"0\"/><inertia ixx=\"1e-6\" ixy=\"0\" ixz=\"0\" iyy=\"0\" \
                 iyz=\"0\" izz=\"0\"/></inertial><visual><geometry><mesh/></geometry></visual></link>\n";
    let body = "<material name=\"m\"><texture/></material><link name=\"base\"/>".to_owned()
        + link("arm")
        + speck
        + joint("j", "revolute", "base", "arm", "")
        + joint("k", "fixed", "arm", "speck", "");
    let (model, notes) = model(&body, &Options::default());
    has(&model, "m_arm: kg = 2,");
    has(&model, "Ixx_arm: kg*m^2 = 0.100001,");
    assert!(
        notes.contains("r.urdf:2:1: ignored <material>") && notes.contains("ignored <visual> of a link"),
        "{notes}"
    );
    let alone = refused(&body.replace("\"fixed\"", "\"revolute\""));
    assert!(alone.contains("link `speck`: its mass is 0, but its inertia is not"), "{alone}");
}

#[test]
fn mistakes_are_reported_with_their_place() {
    let two = |name: &str| "<link name=\"base\"/>\n".to_owned() + link("arm") + name;
    let cases = [
        (two(joint("j", "revolute", "base", "arms", "")), "unknown link `arms`: did you mean `arm`?"),
        (two(joint("j", "revolute", "base", "arm", "<axis xyz=\"0 0 2\"/>")), "length 2, not 1"),
        (two(joint("j", "revolute", "base", "arm", "<axis xyz=\"0 0 0\"/>")), "give its direction"),
        (
            two(joint("j", "revolute", "base", "arm", "<mimic joint=\"k\"/>")),
            "r.urdf:4:1: joint `j`: it mimics the unknown joint `k`",
        ),
        (two(joint("j", "fixed", "base", "arm", "")), "nothing moves"),
        (two(""), "link `arm` has no parent joint"),
        (
            two(&(joint("a", "revolute", "base", "arm", "").to_owned()
                + joint("b", "revolute", "arm", "base", ""))),
            "the links form a cycle",
        ),
        (
            two(&(joint("a", "revolute", "base", "arm", "").to_owned()
                + joint("b", "revolute", "base", "arm", ""))),
            "which joint `a` (r.urdf:4:1) carries already",
        ),
        (
            "<link name=\"base\"/><link name=\"arm\"/>".to_owned()
                + joint("a", "revolute", "base", "arm", ""),
            "link `arm` moves, but neither it nor what is fixed to it has a mass",
        ),
        (link("a").to_owned() + link("a"), "a second link `a`; the first is at r.urdf:2:1"),
        (
            two("").replace("value=\"2\"", "value=\"-2\"") + joint("j", "revolute", "base", "arm", ""),
            "its mass is -2",
        ),
        (
            two("").replace("izz=\"0.02\"", "izz=\"9\"") + joint("j", "revolute", "base", "arm", ""),
            "no body has",
        ),
        (two("").replace("<mass value=\"2\"/>", ""), "has no <mass>"),
        ("<link name=\"a\">".to_owned(), "this is not XML"),
        (
            two("").replace("value=\"2\"", "value=\"two\""),
            "r.urdf:3:57: `value=\"two\"` of <mass> of link `arm`: this is not a number",
        ),
        (
            two("").replace("ixx=\"0.1\"", "ixx=\"nan\""),
            "`ixx=\"nan\"` of <inertia> of link `arm`: this number is not finite",
        ),
        (two("").replace("izz=\"0.02\"", ""), "<inertia> of link `arm` has no attribute `izz`"),
        (
            two("").replace("0 0 0.5", "0 0"),
            "`xyz=\"0 0\"` of <origin> of link `arm`: write three finite numbers",
        ),
        (
            two(joint("j", "screw", "base", "arm", "")),
            "r.urdf:4:17: `type=\"screw\"` of joint `j`: there is no such type of joint; URDF has fixed",
        ),
        (
            two(joint("j", "revolute", "base", "arm", "<origin rpy=\"0 0 right\"/>")),
            "`rpy=\"0 0 right\"` of <origin> of joint `j`: write three finite numbers",
        ),
        (
            two(joint("j", "revolute", "base", "arm", "<origin rpy=\"0 0 0\" quat_xyzw=\"0 0 0 1\"/>")),
            "`quat_xyzw=\"0 0 0 1\"` of <origin> of joint `j`: there is an `rpy` too: keep one",
        ),
        (
            two(joint("j", "revolute", "base", "arm", "<origin quat_xyzw=\"0 0 0 0\"/>")),
            "write four finite numbers, not all zero, the scalar part last",
        ),
        (two(joint("j", "revolute", "base", "arm", "<axis/>")), "<axis> of joint `j` has no attribute `xyz`"),
        (two(joint("j", "revolute", "base", "arm", "<dynamics damping=\"low\"/>")), "`damping=\"low\"`"),
        (
            two(joint("j", "revolute", "base", "arm", "<parent link=\"arm\"/>")),
            "a second <parent> of joint `j`",
        ),
        (two("<joint name=\"j\" type=\"fixed\"><child link=\"arm\"/></joint>"), "joint `j` has no <parent>"),
        (two("<joint type=\"fixed\"/>"), "this <joint> has no name"),
        (
            two(&(joint("j", "revolute", "base", "arm", "").to_owned()
                + joint("j", "fixed", "arm", "base", ""))),
            "a second joint `j`",
        ),
        (String::new(), "there is no link"),
    ];
    for (body, message) in cases {
        let problems = refused(&body);
        assert!(problems.contains(message), "`{message}` not in\n{problems}");
        assert!(problems.starts_with("r.urdf"), "{problems}");
    }
    // One mistake, one message.
    let negative = two("").replace("value=\"2\"", "value=\"-1\"") + joint("j", "revolute", "base", "arm", "");
    assert_eq!(refused(&negative), "r.urdf:3:1: link `arm`: its mass is -1: give a positive one");
    let empty = import("", "r.urdf", &Options::default()).unwrap_err().join("\n");
    assert!(empty.starts_with("r.urdf:1:1: this is not XML"), "{empty}");
    let other = import("<scene/>", "r.urdf", &Options::default()).unwrap_err().join("\n");
    assert!(other.contains("its root is <scene>"), "{other}");
}

#[test]
fn names_that_clash_are_changed() {
    let body = "<link name=\"N\"/>".to_owned()
        + link("for")
        + link("q_a")
        + joint("a", "revolute", "N", "for", "")
        + joint("a.b", "planar", "for", "q_a", "<axis xyz=\"0 0 1\"/>");
    let (model, notes) = model(&body, &Options::default());
    has(&model, "q_a: rad,");
    assert!(notes.contains("`q_a` is called `q_a_n2`"), "{notes}");
    assert!(model.contains("for_n2 { frame: for_axes"), "{model}");
    has(&model, "q_a_origin = O + q_a_b_x*for_axes.x + q_a_b_y*for_axes.y;");
}

#[test]
fn large_and_deep_files_are_read_or_refused() {
    let numbered = |count: usize, line: &dyn Fn(usize) -> String| (0..count).map(line).collect::<String>();
    let links = numbered(3000, &|k| link(&format!("l{k}")).to_owned());
    let joints = numbered(2999, &|k| {
        joint(&format!("j{k}"), "revolute", &format!("l{k}"), &format!("l{}", k + 1), "").to_owned()
    });
    let (long, _) = model(&(links + joints.as_str()), &Options::default());
    assert!(long.contains("q_j2998: rad,"));
    let deep = "<a>".repeat(100_000) + "</a>".repeat(100_000).as_str();
    let _ = import(&robot(&deep), "r.urdf", &Options::default());
    let bomb = "<!DOCTYPE r [<!ENTITY a \"aaaa\"><!ENTITY b \"&a;&a;&a;\">]><robot name=\"&b;\"/>";
    assert!(import(bomb, "r.urdf", &Options::default()).is_err());
    let heavy = "<link name=\"base\"/>".to_owned()
        + link("arm").replace("\"0.1\"", "\"1e308\"").replace("value=\"2\"", "value=\"1e308\"").as_str()
        + link("tool").replace("value=\"2\"", "value=\"1e308\"").as_str()
        + joint("j", "revolute", "base", "arm", "")
        + joint("w", "fixed", "arm", "tool", "");
    assert!(refused(&heavy).contains("too large a number"), "{}", refused(&heavy));
}

/// Boxes, cylinders and spheres of `<collision>` become shapes of the body of their link, in a model that is
/// accepted. The others are reported by name.
#[test]
fn collision_geometry_becomes_shapes() {
    let solid = |origin: &str, geometry: &str| {
        format!("<collision>{origin}<geometry>{geometry}</geometry></collision>")
    };
    let with = |name: &str, more: &str| link(name).replace("</link>", &format!("{more}</link>"));
    let lying = "<origin xyz=\"0 0 0.5\" rpy=\"1.5707963267948966 0 0\"/>";
    let arm = [
        solid(lying, "<cylinder radius=\"0.05\" length=\"1\"/>"),
        solid("", "<mesh filename=\"arm.stl\"/>"),
        solid("", "<sphere radius=\"-1\"/>"),
    ];
    let tool = solid("<origin xyz=\"0.1 0 0\"/>", "<sphere radius=\"0.02\"/>");
    let base = solid("", "<box size=\"1 2 0.1\"/>");
    let body = [
        format!("<link name=\"base\">{base}</link>\n"),
        with("arm", &arm.concat()),
        format!("<link name=\"tool\">{tool}</link>\n"),
        joint("hip", "revolute", "base", "arm", "").to_owned(),
        joint("grip", "fixed", "arm", "tool", "<origin xyz=\"0 0 1\"/>").to_owned(),
    ];
    let body = body.concat();
    let (model, notes) = model(&body, &Options::default());
    has(&model, "base_shape { at: O, box: [a_base_shape, b_base_shape, c_base_shape], axes: N },");
    has(&model, "arm_shape_axes = arm_axes.rotate(x, pi/2);");
    has(
        &model,
        "arm_shape { of: arm, at: O + sz_arm_shape*arm_axes.z, cylinder: [r_arm_shape, l_arm_shape], axis: arm_shape_axes.z },",
    );
    has(&model, "tool_shape { of: arm, at: tool_origin + sx_tool_shape*arm_axes.x, sphere: r_tool_shape },");
    assert!(
        notes.contains("ignored <collision> of link `arm`: a mesh cannot be a shape of a model"),
        "{notes}"
    );
    assert!(notes.contains("ignored <collision> of link `arm`: `radius` must be positive"), "{notes}");
    let source = hodograph_generator::source::Source::file("two.mech", model.as_str());
    let checked = hodograph_generator::check::check(&source);
    let said = hodograph_generator::rendering::render(&checked.diagnostics, &source);
    let mechanism = checked.mechanism.unwrap_or_else(|| panic!("{said}\n{model}"));
    assert_eq!(mechanism.shapes.len(), 3);
}

/// The coordinate of a joint that mimics another is a multiple of the other's.
#[test]
fn joints_mimic_others() {
    let mimic = "<mimic joint=\"left\" multiplier=\"-2\" offset=\"0.1\"/>";
    let body = "<link name=\"base\"/>".to_owned()
        + link("right_finger")
        + link("left_finger")
        + joint("right", "prismatic", "base", "right_finger", mimic)
        + joint("left", "revolute", "base", "left_finger", "");
    let (model, notes) = model(&body, &Options::default());
    has(&model, "k_right: m/rad = -2,");
    has(&model, "right_finger_origin = O + (k_right*q_left + q0_right)*N.x;");
    has(&model, "force on right_finger_origin: tau_right*N.x;");
    assert!(!model.contains(" u_right") && !notes.contains("mimic"), "{model}\n{notes}");
    let source = hodograph_generator::source::Source::file("two.mech", model.as_str());
    let checked = hodograph_generator::check::check(&source);
    assert!(
        !checked.has_errors(),
        "{}",
        hodograph_generator::rendering::render(&checked.diagnostics, &source)
    );
    let both = body.replace("type=\"revolute\">", "type=\"revolute\"><mimic joint=\"right\"/>");
    assert!(refused(&both).contains("mimics `right`, which mimics another"), "{}", refused(&both));
}

/// Links in another order than that of the tree keep their own solids.
#[test]
fn shapes_belong_to_their_links_in_any_order() {
    let ball = "<collision><geometry><sphere radius=\"0.2\"/></geometry></collision></link>";
    let body = link("hand").replace("</link>", ball)
        + link("arm")
        + "<link name=\"base\"/>"
        + joint("wrist", "revolute", "arm", "hand", "")
        + joint("hip", "revolute", "base", "arm", "");
    let (model, _) = model(&body, &Options::default());
    has(&model, "hand_shape { of: hand, at: O, sphere: r_hand_shape },");
}

/// The model as `hodograph check` sees it.
fn accepted(model: &str) {
    let source = hodograph_generator::source::Source::file("two.mech", model);
    let checked = hodograph_generator::check::check(&source);
    let said = hodograph_generator::rendering::render(&checked.diagnostics, &source);
    assert!(checked.mechanism.is_some() && !checked.has_errors(), "{said}\n{model}");
}

/// The names of coordinates and speeds are documented: that of the mechanism gives way, and a speed is numbered
/// like its coordinate.
#[test]
fn coordinates_and_their_speeds_keep_their_names() {
    let one = "<link name=\"base\"/>".to_owned() + link("leg");
    let body = one.clone() + joint("hip", "revolute", "base", "leg", "");
    let named = robot(&body).replace("\"two\"", "\"q hip\"");
    let imported = import(&named, "r.urdf", &Options::default()).unwrap();
    accepted(&imported.model);
    has(&imported.model, "q_hip: rad,");
    has(&imported.model, "mechanism QHip_n2;");
    assert!(imported.notes.join("\n").contains("`QHip` is called `QHip_n2`"), "{:?}", imported.notes);
    // a quaternion of one joint and the coordinate of another
    let body = one
        + link("foot")
        + joint("hip", "floating", "base", "leg", "")
        + joint("hip_e0", "revolute", "leg", "foot", "");
    let (model, _) = model(&body, &Options::default());
    accepted(&model);
    has(&model, "q_hip_e0_n2: rad,");
    has(&model, "u_hip_e0_n2: rad/s,");
}

/// Line breaks in names do not break the comments of the model.
#[test]
fn names_of_several_lines_stand_in_comments_of_one() {
    let body = "<link name=\"base\"/>".to_owned()
        + link("ha&#10;nd")
        + link("tip&#13;")
        + joint(
            "ya&#10;w",
            "prismatic",
            "base",
            "ha&#10;nd",
            "<axis xyz=\"0 0 1\"/><dynamics damping=\"1\"/>",
        )
        + joint("w", "fixed", "ha&#10;nd", "tip&#13;", "");
    let options = Options { contacts: vec!["ha\nnd".into()], ..Options::default() };
    let (model, _) = model(&body, &options);
    accepted(&model);
    has(&model, "/// mass of link `ha nd` with `tip `");
    has(&model, "/// damping of joint `ya w`");
    has(&model, "/// the origin of link `ha nd` strikes the plane through O across N.z");
}

/// An inertia counts beside any other of the robot; what only rounding can have left is told.
#[test]
fn small_inertias_count_beside_large_ones() {
    let inertia = |name: &str, mass: &str, at: &str, moments: [&str; 3]| {
        let [xx, yy, zz] = moments;
        format!(
            "<link name=\"{name}\"><inertial><origin xyz=\"{at}\"/><mass value=\"{mass}\"/><inertia ixx=\"{xx}\" \
             ixy=\"0\" ixz=\"0\" iyy=\"{yy}\" iyz=\"0\" izz=\"{zz}\"/></inertial></link>\n"
        )
    };
    let ship = |arm: String| {
        "<link name=\"base\"/>".to_owned()
            + inertia("hull", "1e7", "0 0 0", ["1e10"; 3]).as_str()
            + arm.as_str()
            + joint("yaw", "revolute", "base", "hull", "<axis xyz=\"0 0 1\"/>")
            + joint("spin", "revolute", "hull", "arm", "")
    };
    let (kept, notes) = model(&ship(inertia("arm", "0.5", "0 0 0", ["5e-3"; 3])), &Options::default());
    has(&kept, "Ixx_arm: kg*m^2 = 0.005,");
    assert!(!kept.contains("particles") && !notes.contains("rounding"), "{notes}\n{kept}");
    for (at, moments) in [("0 0 1", ["1e-17"; 3]), ("0 0 0", ["1e-17", "0", "0"])] {
        let (model, notes) = model(&ship(inertia("arm", "0.5", at, moments)), &Options::default());
        assert!(model.contains("particles"), "{model}");
        assert!(notes.contains("the inertia of link `arm` is so small that only rounding"), "{notes}");
    }
}
