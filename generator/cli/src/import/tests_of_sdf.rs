//! Tests of the import of SDF: axes and poses of all versions, inertias of collisions, and what is told.

use super::tests_of_formats::{accepted, has, imported, joint, link, refused, sdf};
use super::{Options, import};

/// A file of this version.
fn of_version(version: &str, body: &str) -> String {
    sdf(body).replace(" version=\"1.11\"", version)
}

/// Until 1.4 an axis is along the axes of the model, in 1.5 and 1.6 if `use_parent_model_frame` says so.
#[test]
fn axes_of_old_versions_are_those_of_the_model() {
    let body = |more: &str| {
        let axis = format!("<axis><xyz>0 1 0</xyz>{more}</axis>");
        let turned = "<pose>0 0 0 1.5707963267948966 0 0</pose>";
        link("a", turned, "") + &*joint("j", "revolute", "world", "a", &axis)
    };
    let of = |version: &str, more: &str| {
        let (model, notes) = imported(&of_version(&format!(" version=\"{version}\""), &body(more)), "m.sdf");
        accepted(&model);
        (model, notes)
    };
    let (by_joint, by_model) = ("a_axes = j_base.rotate(y, q_j);", "a_axes = j_base.rotate(-z, q_j);");
    let stated = |value: &str| format!("<use_parent_model_frame>{value}</use_parent_model_frame>");
    for version in ["1.2", "1.4"] {
        has(&of(version, "").0, by_model);
    }
    for version in ["1.5", "1.6"] {
        has(&of(version, "").0, by_joint);
        has(&of(version, &stated("false")).0, by_joint);
        let (model, notes) = of(version, &stated("1"));
        has(&model, by_model);
        assert!(notes.is_empty(), "{notes}");
    }
    // later versions have `expressed_in`
    let (model, notes) = of("1.7", &stated("true"));
    has(&model, by_joint);
    assert!(notes.contains("ignored <use_parent_model_frame> of an axis"), "{notes}");
    for (version, said) in [
        ("", "m.sdf:1:1: <sdf> has no `version`: it is read as 1.12"),
        (" version=\"2.0\"", "the version `2.0` of SDF is unknown: it is read as 1.12"),
        (" version=\"1.13\"", "the version `1.13` of SDF is unknown"),
    ] {
        let (model, notes) = imported(&of_version(version, &body("")), "m.sdf");
        has(&model, by_joint);
        assert!(notes.contains(said), "{notes}");
    }
}

/// A world of SDF before 1.6 has its gravity in `<physics>`.
#[test]
fn gravity_is_where_the_version_has_it() {
    let body = link("a", "", "") + &*joint("j", "revolute", "world", "a", "");
    let with = |version: &str| {
        let physics = "<world name=\"w\"><physics><gravity>0 0 -3</gravity></physics><model";
        let source = of_version(version, &body).replace("<model", physics);
        imported(&source.replace("</model>", "</model></world>"), "m.sdf").0
    };
    has(&with(" version=\"1.4\""), "g: m/s^2 = 3,");
    has(&with(" version=\"1.6\""), "g: m/s^2 = 9.8,");
}

/// A solid of 1 m^3 at (0.5, 0, 0), without or with its density.
fn cube(density: &str) -> String {
    format!(
        "<collision name=\"c\"><pose>0.5 0 0 0 0 0</pose>{density}<geometry><box><size>1 1 1</size></box></geometry>\
         </collision>"
    )
}

#[test]
fn inertias_are_computed_from_collisions() {
    let of = |inertial: &str, collisions: &str| {
        let link = format!("<link name=\"a\">{inertial}{collisions}</link>\n");
        sdf(&(link + &*joint("j", "revolute", "world", "a", "<axis><xyz>0 1 0</xyz></axis>")))
    };
    let auto = "<inertial auto=\"true\"/>";
    let stated = cube("<density>300</density>");
    let (model, notes) = imported(&of(auto, &stated), "m.sdf");
    accepted(&model);
    has(&model, "m_a: kg = 300,");
    has(&model, "Iyy_a: kg*m^2 = 50,");
    has(&model, "cx_a: m = 0.5,");
    assert!(notes.is_empty(), "{notes}");
    has(&imported(&of(auto, &cube("")), "m.sdf").0, "m_a: kg = 1000,");
    let usual = "<inertial auto=\"1\"><density>20</density></inertial>";
    has(&imported(&of(usual, &cube("")), "m.sdf").0, "m_a: kg = 20,");
    has(&imported(&of(usual, &(cube("") + &*stated)), "m.sdf").0, "m_a: kg = 320,");
    let mesh = "<collision name=\"d\"><geometry><mesh/></geometry></collision>";
    for (source, said) in [
        (
            of(auto, ""),
            "m.sdf:2:16: <inertial> of link `a`: `auto` computes it from the collisions, but none has a volume",
        ),
        (
            of(auto, mesh),
            "<collision> of link `a`: the inertia of its shape cannot be computed: state <mass>",
        ),
        (of(auto, &cube("<density>0</density>")), "<density> of collision `c`: a density is positive"),
        (
            of("<inertial auto=\"true\"><mass>3</mass></inertial>", &cube("")),
            "`auto` computes this from the collisions",
        ),
        (of("<inertial auto=\"yes\"/>", &cube("")), "`auto` is `true` or `false`"),
    ] {
        let told = refused(&source, "m.sdf");
        assert!(told.contains(said) && told.lines().count() == 1, "{said}\n{told}");
    }
}

/// What is not read is told, attributes too; what stands twice is refused.
#[test]
fn nothing_of_sdf_is_dropped_silently() {
    let axis = "<axis xyz=\"1 0 0\"><xyz expresed_in=\"__model__\">0 1 0</xyz><dynamics><dampng>2</dampng></dynamics></axis>";
    let added = "</inertia><fluid_added_mass><xx>3</xx></fluid_added_mass>";
    let body = link("a", "", "").replace("</inertia>", added)
        + &*link("b", "<pose relative_too=\"a\" frame=\"a\">0 0 1 0 0 0</pose>", "")
        + &*joint("j", "revolute", "a", "b", axis);
    let (_, notes) = imported(&sdf(&body), "m.sdf");
    for told in [
        "m.sdf:3:22: ignored attribute `relative_too` of <pose>",
        "ignored attribute `frame` of <pose>",
        "ignored attribute `expresed_in` of <xyz>",
        "ignored attribute `xyz` of <axis>",
        "ignored <dampng> of a dynamics",
        "ignored <fluid_added_mass> of an inertial",
    ] {
        assert!(notes.contains(told), "{told}\n{notes}");
    }
    let pose = "<pose>0 0 0 0 0 0</pose>";
    let one = |pose: &str, more: &str| sdf(&link("a", pose, more));
    for (source, said) in [
        (one(&pose.repeat(2), ""), "m.sdf:2:40: <pose> of link `a`: a second one: keep one"),
        (one("", "<inertial/>"), "<inertial> of link `a`: a second one"),
        (one("", "").replace("<mass>", "<mass>3</mass><mass>"), "<mass> of link `a`: a second one"),
        (
            one("", &cube("").replace("<box>", "<sphere><radius>1</radius></sphere><box>")),
            "its <geometry> has several shapes: keep one",
        ),
        (
            one("", "").replace("<link", "<pose relative_to=\"f\">1 0 0 0 0 0</pose><link"),
            "the pose of a model is imported relative to the world only",
        ),
        (
            one("", "").replace("<model", "<world name=\"v\"/><world name=\"w\"/><model"),
            "a second <world>: keep one",
        ),
    ] {
        let told = refused(&source, "m.sdf");
        assert!(told.contains(said), "{said}\n{told}");
    }
}

/// The pose of a model is that of its placement frame; `frame` is the name that `relative_to` had until 1.6.
#[test]
fn poses_are_relative_to_what_the_version_names() {
    let body = "<pose>1 0 0 0 0 0</pose>".to_owned() + &*link("a", "<pose>0 0 3 0 0 0</pose>", "");
    let placed = sdf(&body).replace("name=\"m\"", "name=\"m\" placement_frame=\"a\"");
    let (model, notes) = imported(&placed, "m.sdf");
    has(&model, "q_a_x: m = 1,");
    has(&model, "q_a_z: m,");
    assert!(notes.is_empty(), "{notes}");
    let named =
        link("a", "<pose>0 0 3 0 0 0</pose>", "") + &*link("b", "<pose frame=\"a\">0 0 2 0 0 0</pose>", "");
    has(&imported(&of_version(" version=\"1.6\"", &named), "m.sdf").0, "q_b_z: m = 5,");
    has(&imported(&of_version(" version=\"1.7\"", &named), "m.sdf").0, "q_b_z: m = 2,");
}

#[test]
fn poses_may_be_turned_by_quaternions_and_degrees() {
    let of = |attributes: &str, numbers: &str| {
        let body = link("a", &format!("<pose {attributes}>{numbers}</pose>"), "");
        sdf(&(body + &*joint("j", "revolute", "world", "a", "")))
    };
    let turned = imported(&of("", "0 0 1 1.5707963267948966 0 0"), "m.sdf").0;
    accepted(&turned);
    has(&turned, "j_base = N.rotate(x, pi/2);");
    assert_eq!(turned, imported(&of("degrees=\"true\"", "0 0 1 90 0 0"), "m.sdf").0);
    assert_eq!(turned, imported(&of("rotation_format=\"quat_xyzw\"", "0 0 1 2 0 0 2"), "m.sdf").0);
    let quaternion = "rotation_format=\"quat_xyzw\"";
    for (source, said) in [
        (of(quaternion, "0 0 1 90 0 0"), "`0 0 1 90 0 0` is not 7 finite numbers"),
        (of(quaternion, "0 0 1 0 0 0 0"), "its quaternion is zero"),
        (of(&format!("{quaternion} degrees=\"1\""), "0 0 1 0 0 0 1"), "a quaternion has no `degrees`"),
        (of("rotation_format=\"rpy\"", "0 0 1 0 0 0"), "`rotation_format` is `euler_rpy` or `quat_xyzw`"),
        (of("relative_to=\"b\"", "0 0 1 0 0 0"), "there is no frame, link or joint `b`"),
        (of("relative_to=\"j\"", "0 0 1 0 0 0"), "is defined by itself: state one of these poses"),
    ] {
        // one mistake, one message
        let told = refused(&source, "m.sdf");
        assert!(told.contains(said) && told.lines().count() == 1, "{said}\n{told}");
    }
}

/// The ends of a joint may be frames: they stand for the links that they move with.
#[test]
fn joints_may_end_at_frames() {
    let frames = "<frame name=\"f\" attached_to=\"g\"><pose>0 0 1 0 0 0</pose></frame>\
                  <frame name=\"g\" attached_to=\"a\"/><frame name=\"h\" attached_to=\"b\"><pose>0 0 2 0 0 0</pose></frame>\n";
    let hung = joint("i", "revolute", "world", "a", "");
    let axis = "<axis><xyz>0 1 0</xyz></axis>";
    let by = |parent: &str, child: &str, pose: &str| {
        let body = [
            &link("a", "", ""),
            &link("b", "", ""),
            frames,
            &hung,
            &joint("j", "revolute", parent, child, &format!("{pose}{axis}")),
        ];
        let (model, notes) = imported(&sdf(&body.map(String::from).concat()), "m.sdf");
        accepted(&model);
        assert!(notes.is_empty(), "{notes}");
        model
    };
    let at_links = by("a", "b", "<pose>0 0 2 0 0 0</pose>");
    has(&at_links, "b_origin = O + oz_j*a_axes.z;");
    assert_eq!(at_links, by("f", "h", ""));
    assert_eq!(at_links, by("i", "h", ""));
}

/// Both ends of a joint are told where they name no link.
#[test]
fn joints_without_ends_are_told() {
    let of = |ends: &str| {
        let hinge = format!("<joint name=\"j\" type=\"revolute\">{ends}</joint>\n");
        refused(&sdf(&(link("a", "", "") + &*hinge)), "m.sdf")
    };
    let told = of("<parent link=\"world\"/><child>a</child>");
    let said =
        "m.sdf:3:33: <parent> of joint `j`: it names no link: write its name as text, <parent>world</parent>";
    assert_eq!(told, said);
    assert_eq!(of("<parent>world</parent>"), "m.sdf:3:1: joint `j`: it has no <child>: name its child link");
    let told = of("<parent>wurld</parent><child>a</child>");
    assert!(told.contains("`wurld`") && told.lines().count() == 1, "{told}");
    let told = of("<parent>a</parent><child>world</child>");
    assert!(told.contains("the world cannot be carried: exchange") && told.lines().count() == 1, "{told}");
    let lost = "<frame name=\"f\" attached_to=\"zz\"/>\n".to_owned() + &*joint("j", "revolute", "f", "a", "");
    let told = refused(&sdf(&(link("a", "", "") + &*lost)), "m.sdf");
    assert_eq!(told, "m.sdf:3:1: there is no frame, link or joint `zz`: there are: a, f, j");
    // two elements of one name are one mistake
    let twins = link("a", "", "") + &*joint("a", "revolute", "world", "a", "");
    assert_eq!(refused(&sdf(&twins), "m.sdf"), "m.sdf:3:1: a second `a`: rename one");
}

/// The contact of a link is at its own origin, not at that of its joint.
#[test]
fn contacts_are_at_the_origins_of_links() {
    let hung = "<pose>0.3 0 0.5 0 0 0</pose><axis><xyz>0 1 0</xyz></axis>";
    let body = link("a", "<pose>0 0 1 0 0 0</pose>", "") + &*joint("k", "revolute", "world", "a", hung);
    let options = Options { contacts: vec!["a".to_owned()], ..Options::default() };
    let model = import(&sdf(&body), "m.sdf", &options).unwrap().model;
    accepted(&model);
    has(&model, "a_frame_origin = a_origin + ox_a_frame*a_axes.x + oz_a_frame*a_axes.z;");
}

/// Springs of SDF are loads that store energy, as those of MJCF.
#[test]
fn springs_of_sdf_store_energy() {
    let dynamics =
        "<dynamics><spring_stiffness>4</spring_stiffness><spring_reference>0.5</spring_reference></dynamics>";
    let axis = format!("<axis><xyz>0 1 0</xyz>{dynamics}</axis>");
    let body = link("a", "", "") + &*joint("j", "revolute", "world", "a", &axis);
    let (model, _) = imported(&sdf(&body), "m.sdf");
    accepted(&model);
    has(&model, "torsion a_axes about a_axes.y: { angle: q_j, rest: q0_j, stiffness: s_j };");
    has(&model, "torque on a_axes: tau_j*a_axes.y;");
}
