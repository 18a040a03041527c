//! Tests of the import of MJCF and SDF: the model that each element becomes, and the elements that are
//! refused, by name.

use super::{Options, import};

pub(super) fn imported(source: &str, file: &str) -> (String, String) {
    let imported =
        import(source, file, &Options::default()).unwrap_or_else(|problems| panic!("{problems:?}"));
    (imported.model, imported.notes.join("\n"))
}

pub(super) fn refused(source: &str, file: &str) -> String {
    import(source, file, &Options::default()).unwrap_err().join("\n")
}

pub(super) fn has(model: &str, line: &str) {
    assert!(model.lines().any(|other| other.trim() == line), "no line `{line}` in\n{model}");
}

/// Checks the model as `hodograph check` does.
pub(super) fn accepted(model: &str) {
    let source = hodograph_generator::source::Source::file("imported.mech", model);
    let checked = hodograph_generator::check::check(&source);
    let said = hodograph_generator::rendering::render(&checked.diagnostics, &source);
    assert!(checked.mechanism.is_some() && !checked.has_errors(), "{said}\n{model}");
}

pub(super) fn mjcf(world: &str, more: &str) -> String {
    format!("<mujoco model=\"m\">\n<worldbody>\n{world}\n</worldbody>\n{more}\n</mujoco>")
}

pub(super) const ARM: &str = "<body name=\"arm\" pos=\"0 0 1\"><joint name=\"hip\" axis=\"0 2 0\"/>\
                   <geom type=\"box\" size=\"0.5 0.5 0.5\" density=\"10\"/></body>";

#[test]
fn bodies_of_mjcf_become_links() {
    let motor = "<actuator><motor name=\"m\" joint=\"hip\" gear=\"3\"/></actuator>";
    let floor = "<geom type=\"plane\" size=\"1 1 1\"/>";
    let (model, notes) = imported(&mjcf(&format!("{floor}{ARM}"), motor), "m.xml");
    accepted(&model);
    has(&model, "arm_axes = N.rotate(y, q_hip);");
    has(&model, "m_arm: kg = 10,");
    has(&model, "torque on arm_axes: gear_m*ctrl_m*arm_axes.y;");
    has(&model, "ctrl_m: N*m = 0,");
    has(&model, "world_shape { at: O, plane: N.z },");
    has(&model, "g: m/s^2 = 9.81,");
    assert!(notes.starts_with("solids become shapes, but no contacts") && !notes.contains('\n'), "{notes}");
    // a joint without an actuator has no force
    let (model, _) = imported(&mjcf(ARM, ""), "m.xml");
    accepted(&model);
    assert!(!model.contains("torque") && !model.contains("inputs"), "{model}");
}

#[test]
fn a_joint_beside_the_origin_carries_a_frame_of_its_body() {
    let body = ARM.replace("name=\"hip\"", "name=\"hip\" pos=\"0.5 0 0\"");
    let (model, _) = imported(&mjcf(&body, ""), "m.xml");
    accepted(&model);
    has(&model, "arm_origin = O + ox_hip*N.x + oz_hip*N.z;");
    has(&model, "arm_frame_origin = arm_origin + ox_arm_frame*arm_axes.x;");
}

#[test]
fn free_bodies_start_at_their_poses() {
    let body =
        "<body name=\"b\" pos=\"0 2 1\" euler=\"90 0 0\"><freejoint name=\"f\"/><geom size=\"0.1\"/></body>";
    let (model, notes) = imported(&mjcf(body, ""), "m.xml");
    accepted(&model);
    has(&model, "q_f_y: m = 2,");
    has(&model, "q_f_e1: 1 = 0.7071067811865475,");
    assert!(notes.is_empty() && !model.contains("inputs"), "{notes}\n{model}");
}

/// Two bodies of one name are one mistake.
#[test]
fn a_name_of_two_bodies_is_told_once() {
    let body = |z: u32| {
        format!(
            "<body name=\"arm\" pos=\"0 0 {z}\"><joint name=\"j{z}\" type=\"hinge\"/><geom type=\"sphere\" size=\"0.1\"/></body>"
        )
    };
    let said = refused(&mjcf(&format!("{}{}", body(1), body(2)), ""), "m.xml");
    assert!(said.contains("a second link `arm`") && said.lines().count() == 1, "{said}");
}

#[test]
fn elements_of_mjcf_without_counterpart_are_reported() {
    let equality = "<equality><connect name=\"loop\" body1=\"arm\" anchor=\"0 0 0\"/></equality>";
    let tendon = "<tendon><spatial name=\"rope\"/></tendon>";
    let arm = |from: &str, to: &str| mjcf(&ARM.replace(from, to), "");
    let joint = |more: &str| arm("<joint ", &format!("<joint {more} "));
    let actuator = |text: &str| mjcf(ARM, &format!("<actuator>{text}</actuator>"));
    let cases = [
        (mjcf(ARM, equality), "m.xml:5:11: <equality> <connect> `loop` cannot be imported"),
        (mjcf(ARM, tendon), "<tendon> <spatial> `rope` cannot be imported"),
        (mjcf(ARM, "<include file=\"hand.xml\"/>"), "<include file=\"hand.xml\"> is not followed"),
        (mjcf("<composite/>", ""), "<composite> cannot be imported"),
        (joint("ref=\"3\""), "m.xml:3:30: <joint> `hip`: `ref` is not 0"),
        (joint("damping=\"-1\""), "`damping` is negative"),
        (joint("class=\"soft\""), "there is no <default class=\"soft\">"),
        (joint("type=\"screw\""), "`type` is `hinge`, `slide`, `ball` or `free`"),
        (arm("type=\"box\"", "type=\"box\" mass=\"-1\""), "`mass` is negative"),
        (arm("0 2 0", "0 0 0"), "its axis has length 0"),
        (arm("0 2 0", "0 2"), "`axis` has 2 numbers, not 3"),
        (arm("0 2 0", "0 nan 0"), "`axis=\"0 nan 0\"`: write finite numbers"),
        (arm("0.5 0.5 0.5", "0.5 0.5"), "a box has 3 positive numbers in `size`"),
        (
            arm("type=\"box\"", "type=\"mesh\" mesh=\"m\""),
            "its mass is that of a mesh: state the <inertial> of body `arm`",
        ),
        (arm("name=\"arm\"", "name=\"arm\" quat=\"0 0 0 0\""), "its orientation has a direction of length 0"),
        (arm("name=\"arm\"", "name=\"arm\" mocap=\"true\""), "motion is prescribed"),
        (arm("<joint ", "<freejoint/><joint "), "only a child of the world"),
        (
            actuator("<muscle name=\"biceps\" joint=\"hip\"/>"),
            "<muscle> `biceps`: a muscle cannot be imported",
        ),
        (
            actuator("<motor name=\"m\" joint=\"hop\"/>"),
            "it drives the unknown joint `hop`: did you mean `hip`?",
        ),
        (actuator("<motor name=\"m\" tendon=\"t\"/>"), "only actuators of a `joint`"),
        (actuator("<general name=\"m\" joint=\"hip\" dyntype=\"filter\"/>"), "only `dyntype` none"),
        ("<mujoco><compiler settotalmass=\"3\"/></mujoco>".to_owned(), "`settotalmass` changes masses"),
        ("<scene/>".to_owned(), "m.xml:1:1: this is not a robot description: its root is <scene>"),
    ];
    for (source, expected) in cases {
        let said = refused(&source, "m.xml");
        assert!(said.contains(expected), "{expected}\n{said}");
    }
    let noted = [
        (joint("armature=\"0.1\" range=\"0 1\""), "m.xml:3:30: ignored attribute `armature` of <joint>"),
        (joint("frictionloss=\"0.1\""), "ignored the friction of joint `hip`"),
        (mjcf(ARM, "<sensor/><asset/>"), "ignored <sensor>"),
    ];
    for (source, expected) in noted {
        let (_, notes) = imported(&source, "m.xml");
        assert!(notes.contains(expected), "{expected}\n{notes}");
    }
    let deep = mjcf(&format!("{}{}", "<body>".repeat(400), "</body>".repeat(400)), "");
    assert!(refused(&deep, "m.xml").contains("nested more than 200 deep"));
    let options = Options { floating: Some(true), ..Options::default() };
    let said = import(&mjcf(ARM, ""), "m.xml", &options).unwrap_err().join("\n");
    assert!(said.contains("--base is for URDF only: MJCF states itself"), "{said}");
}

/// `<flag>` switches forces off; a flag without a counterpart in a model is reported.
#[test]
fn flags_of_mjcf_switch_forces_off() {
    let arm = ARM.replace("<joint ", "<joint damping=\"2\" stiffness=\"3\" frictionloss=\"1\" ");
    let more = "<actuator><position name=\"m\" joint=\"hip\"/></actuator>";
    let loop_of = "<equality><connect name=\"loop\" body1=\"arm\" anchor=\"0 0 0\"/></equality>";
    let with = |flags: &str, more: &str| mjcf(&arm, &format!("<option><flag {flags}/></option>{more}"));
    let of = |flags: &str| imported(&with(flags, more), "m.xml");
    let (all, notes) = of("gravity=\"enable\" contact=\"disable\"");
    accepted(&all);
    has(&all, "torque on arm_axes: (ctrl_m + kq_m*q_hip - d_hip*u_hip)*arm_axes.y;");
    has(&all, "torsion arm_axes about arm_axes.y: { angle: q_hip, stiffness: s_hip };");
    assert!(notes.contains("m.xml:5:9: ignored attribute `contact` of <flag>"), "{notes}");
    let (none, _) = of("gravity=\"disable\"");
    accepted(&none);
    assert!(!none.contains("gravity") && none.contains("d_hip"), "{none}");
    for (flags, gone, kept) in [
        ("damper=\"disable\"", "d_hip", "s_hip"),
        ("spring=\"disable\"", "s_hip", "d_hip"),
        ("actuation=\"disable\"", "ctrl_m", "d_hip"),
    ] {
        let (model, _) = of(flags);
        accepted(&model);
        assert!(!model.contains(gone) && model.contains(kept), "{flags}\n{model}");
    }
    let (passive, notes) = of("passive=\"disable\" constraint=\"disable\"");
    assert!(!passive.contains("d_hip") && !passive.contains("s_hip"), "{passive}");
    assert!(!notes.contains("friction"), "{notes}");
    let (_, notes) = of("actuation=\"disable\"");
    assert!(notes.contains("ignored <actuator>, which is switched off"), "{notes}");
    let (_, notes) = imported(&with("equality=\"disable\"", loop_of), "m.xml");
    assert!(notes.contains("ignored <equality>, which is switched off"), "{notes}");
    assert!(refused(&with("gravity=\"off\"", more), "m.xml").contains("`gravity` is `enable` or `disable`"));
    let other = mjcf(ARM, "<option><flog/></option>");
    assert!(refused(&other, "m.xml").contains("<flog> cannot be imported"));
}

/// Each `<compiler>` changes what it states and nothing else.
#[test]
fn compilers_of_mjcf_add_up() {
    let stated = "<inertial pos=\"0 0 0\" mass=\"50\" diaginertia=\"9 9 9\"/><geom";
    let arm = ARM.replace("<geom", stated).replace("<joint", "<joint springref=\"180\" stiffness=\"1\"");
    let of = |compilers: &str| mjcf(&arm, compilers);
    let (model, _) =
        imported(&of("<compiler inertiafromgeom=\"true\"/><compiler angle=\"radian\"/>"), "m.xml");
    has(&model, "m_arm: kg = 10,");
    has(&model, "q0_hip: rad = 180,");
    let second = "<compiler inertiafromgeom=\"true\" angle=\"radian\"/><compiler inertiafromgeom=\"auto\" angle=\"degree\"/>";
    let (model, _) = imported(&of(second), "m.xml");
    has(&model, "m_arm: kg = 50,");
    has(&model, "q0_hip: rad = 3.141592653589793,");
    let said = refused(&of("<compiler inertiafromgeom=\"yes\"/>"), "m.xml");
    assert!(said.contains("`inertiafromgeom` is `true`, `false` or `auto`"), "{said}");
}

/// Defaults of one kind of actuator are those of all: each sets attributes of `general`.
#[test]
fn actuators_of_mjcf_share_their_defaults() {
    let of = |defaults: &str, actuator: &str| {
        let more = format!("<default>{defaults}</default><actuator>{actuator}</actuator>");
        imported(&mjcf(ARM, &more), "m.xml")
    };
    let motor = "<motor name=\"m\" joint=\"hip\"/>";
    let (model, notes) = of("<general gear=\"50\" ctrlrange=\"-1 1\"/>", motor);
    accepted(&model);
    has(&model, "gear_m: 1 = 50,");
    assert!(notes.contains("ignored attribute `ctrlrange` of <motor>"), "{notes}");
    // the last one holds, whatever its kind
    let (model, _) = of(
        "<motor gear=\"2\"/><default class=\"c\"><position gear=\"3\"/></default>",
        &motor.replace("name", "class=\"c\" name"),
    );
    has(&model, "gear_m: 1 = 3,");
    // a motor has a gain of one and no stiffness
    let (model, notes) = of("<position kp=\"7\" kv=\"2\"/>", motor);
    has(&model, "torque on arm_axes: ctrl_m*arm_axes.y;");
    assert!(notes.lines().count() == 0, "{notes}");
    // the gain of a servo is that of the defaults
    let position = "<position name=\"m\" joint=\"hip\"/>";
    let (model, notes) = of("<general gainprm=\"7\"/>", position);
    has(&model, "gain_m: N*m = 7,");
    has(&model, "kq_m: N*m/rad = -7,");
    assert!(notes.is_empty(), "{notes}");
    let (model, _) = of("<position kp=\"7\" kv=\"2\"/>", "<general name=\"m\" joint=\"hip\"/>");
    has(&model, "ku_m: N*m*s/rad = -2,");
    let (model, _) =
        of("<position kp=\"7\" dampratio=\"1\"/><adhesion ctrlrange=\"0 1\" gain=\"3\"/>", motor);
    has(&model, "torque on arm_axes: ctrl_m*arm_axes.y;");
    let general = "<general name=\"m\" joint=\"hip\"/>";
    let muscle = mjcf(ARM, &format!("<default><muscle/></default><actuator>{general}</actuator>"));
    assert!(refused(&muscle, "m.xml").contains("only `dyntype` none"));
}

/// Names that the import makes up keep clear of those of the file.
#[test]
fn made_up_names_of_mjcf_are_new() {
    let body = |name: &str, joints: &str, inner: &str| {
        format!(
            "<body {name} pos=\"0 0 1\">{joints}<geom type=\"box\" size=\"0.5 0.5 0.5\"/>{inner}</body>\n"
        )
    };
    let one = "<joint axis=\"0 1 0\"/>";
    let hip = "<joint name=\"hip\" axis=\"0 1 0\"/>";
    let (model, _) = imported(&mjcf(&body("name=\"hip\"", one, &body("name=\"leg\"", hip, "")), ""), "m.xml");
    accepted(&model);
    has(&model, "leg_axes = hip_axes.rotate(y, q_hip);");
    has(&model, "hip_axes = N.rotate(y, q_hip_n2);");
    // a link between two joints, frames, fixed and unnamed bodies
    let two = "<joint name=\"b\" axis=\"0 1 0\"/><joint name=\"c\" pos=\"0.1 0 0\" axis=\"1 0 0\"/>";
    let named = |name: &str| format!("<joint name=\"{name}\"/>");
    let world = [
        body("name=\"a\"", two, &body("name=\"a_b\"", &named("a_weld"), "")),
        body("", &named("body_1"), &body("name=\"body_1\"", &named("a_frame"), "")),
        body("name=\"a_frame\"", one, &body("name=\"d\"", "", &body("name=\"e\"", &named("d_weld"), ""))),
    ];
    let (model, _) = imported(&mjcf(&world.concat(), ""), "m.xml");
    accepted(&model);
    for name in ["b", "c", "a_weld", "body_1", "a_frame", "d_weld"] {
        has(&model, &format!("q_{name}: rad,"));
    }
}

/// A link with its mass centre half a metre above its origin.
pub(super) fn link(name: &str, pose: &str, more: &str) -> String {
    format!(
        "<link name=\"{name}\">{pose}<inertial><pose>0 0 0.5 0 0 0</pose><mass>2</mass><inertia><ixx>0.1</ixx>\
         <iyy>0.1</iyy><izz>0.02</izz></inertia></inertial>{more}</link>\n"
    )
}

pub(super) fn joint(name: &str, kind: &str, parent: &str, child: &str, more: &str) -> String {
    format!(
        "<joint name=\"{name}\" type=\"{kind}\"><parent>{parent}</parent><child>{child}</child>{more}</joint>\n"
    )
}

pub(super) fn sdf(body: &str) -> String {
    format!("<sdf version=\"1.11\"><model name=\"m\">\n{body}</model></sdf>")
}

#[test]
fn models_of_sdf_have_links_in_axes_of_their_choice() {
    let solid = "<collision name=\"c\"><geometry><capsule><radius>0.1</radius><length>1</length></capsule></geometry></collision>";
    let body = [
        link("base", "", ""),
        link("arm", "<pose relative_to=\"base\">0 0 1 0 0 0</pose>", solid),
        link("hand", "<pose relative_to=\"wrist\">0 0 0.25 0 0 0</pose>", ""),
        joint("weld", "fixed", "world", "base", ""),
        joint(
            "hip",
            "revolute",
            "base",
            "arm",
            "<axis><xyz>0 1 0</xyz><dynamics><damping>0.5</damping></dynamics></axis>",
        ),
        joint(
            "wrist",
            "prismatic",
            "arm",
            "hand",
            "<pose relative_to=\"arm\">0 0 1 0 0 0</pose><axis><xyz expressed_in=\"__model__\">0 0 3</xyz></axis>",
        )
    ]
    .concat();
    let (model, notes) = imported(&sdf(&body), "m.sdf");
    accepted(&model);
    has(&model, "arm_origin = O + oz_hip*N.z;");
    has(&model, "torque on arm_axes: (tau_hip - d_hip*u_hip)*arm_axes.y;");
    has(
        &model,
        "arm_shape { of: arm, at: arm_origin, capsule: [r_arm_shape, l_arm_shape], axis: arm_axes.z },",
    );
    has(&model, "wrist_point = arm_origin + oz_wrist*arm_axes.z;");
    has(&model, "hand_origin = wrist_point + q_wrist*arm_axes.z;");
    has(&model, "hand_frame_origin = hand_origin + oz_hand_frame*arm_axes.z;");
    assert!(notes.contains("ignored the inertia of link `base`"), "{notes}");
    // a link without a joint is free at its pose
    let (model, _) = imported(&sdf(&link("ball", "<pose>0 0 3 0 0 0</pose>", "")), "m.sdf");
    accepted(&model);
    has(&model, "q_ball_z: m = 3,");
}

/// What SDF leaves out has the format's own values: an axis along z, and a gravity of 9.8 m/s^2.
#[test]
fn models_of_sdf_have_the_defaults_of_the_format() {
    let body = [link("arm", "", ""), joint("hip", "revolute", "world", "arm", "")].concat();
    let (model, _) = imported(&sdf(&body), "m.sdf");
    accepted(&model);
    has(&model, "arm_axes = N.rotate(z, q_hip);");
    has(&model, "g: m/s^2 = 9.8,");
    let world = |gravity: &str| {
        sdf(&body)
            .replace("<model", &format!("<world name=\"w\">{gravity}<model"))
            .replace("</model>", "</model></world>")
    };
    has(&imported(&world(""), "m.sdf").0, "g: m/s^2 = 9.8,");
    has(&imported(&world("<gravity>0 0 -2</gravity>"), "m.sdf").0, "g: m/s^2 = 2,");
}

/// All of a static model is fixed, also what its joints would move.
#[test]
fn static_models_of_sdf_do_not_move() {
    let body = [
        "<static>true</static>",
        &link("a", "", ""),
        &link("b", "", ""),
        &joint("j", "revolute", "a", "b", ""),
    ]
    .concat();
    let said = refused(&sdf(&body), "m.sdf");
    assert!(said.contains("m.sdf:2:1: nothing moves: all of a static model is fixed"), "{said}");
    imported(&sdf(&body.replace("true", "false")), "m.sdf");
}

#[test]
fn elements_of_sdf_without_counterpart_are_reported() {
    let two = |more: &str| sdf(&[link("a", "", ""), link("b", "", ""), more.to_owned()].concat());
    let cases = [
        (two(&joint("j", "screw", "a", "b", "")), "m.sdf:4:1: <joint>: `j` has the type `screw`"),
        (two(&joint("j", "revolute", "a", "c", "")), "`c`"),
        (two("<include><uri>model://hand</uri></include>"), "<include> within the model is not followed"),
        (
            two(&joint("j", "revolute", "a", "b", "<pose>0 0 1</pose>")),
            "<pose> of joint `j`: `0 0 1` is not 6 finite numbers",
        ),
        (sdf(&link("a", "<pose relative_to=\"a\"/>", "")), "the pose of `a` is defined by itself"),
        (sdf(&link("a", "<pose relative_to=\"z\"/>", "")), "there is no frame, link or joint `z`"),
        ("<sdf><world/></sdf>".to_owned(), "there are 0 models"),
    ];
    for (source, expected) in cases {
        let said = refused(&source, "m.sdf");
        assert!(said.contains(expected), "{expected}\n{said}");
    }
    let mesh = "<collision name=\"c\"><geometry><mesh/></geometry></collision><visual name=\"v\"/>";
    let (_, notes) = imported(&sdf(&link("a", "", mesh)), "m.sdf");
    assert!(
        notes.contains("ignored <collision> of a mesh") && notes.contains("ignored <visual> of a link"),
        "{notes}"
    );
}
