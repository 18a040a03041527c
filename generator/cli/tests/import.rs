//! `hodograph import`: imported robots against another program's numbers, and against the balance of power.
#![cfg(feature = "derive")]

use std::path::Path;

use crate::common::{ALL_JOINTS, data, difference, hodograph, number, numbers, root};
use serde_json::{Map, Value, json};

/// Imports a URDF into a folder and derives it.
fn imported(urdf: &str, name: &str, more: &[&str], folder: &Path) -> String {
    let run = hodograph(&[&["import", urdf], more].concat(), "");
    assert_eq!(run.code, 0, "{name}: {}", run.stderr);
    let model = folder.join(format!("{name}.mech")).display().to_string();
    std::fs::write(&model, run.stdout).unwrap();
    for command in ["check", "derive"] {
        let run = hodograph(&[command, &model], "");
        assert_eq!(run.code, 0, "{name}: {}{}", run.stdout, run.stderr);
    }
    model
}

fn eval(model: &str, state: &Value) -> Value {
    let run = hodograph(&["eval", model, "--state", "-"], &state.to_string());
    assert_eq!(run.code, 0, "{model}: {}{}", run.stdout, run.stderr);
    run.line()
}

/// A state of `expected.json`: coordinates, speeds, inputs, and the speeds in the order of the file.
fn state(joints: &[&str], state: &Value) -> (Value, Value, Value, Vec<String>) {
    let (q, v, tau) = (numbers(&state["q"]), numbers(&state["v"]), numbers(&state["tau"]));
    let mut maps = [Map::new(), Map::new(), Map::new()];
    let (mut at, mut speeds) = (0, Vec::new());
    for joint in joints {
        let suffixes: &[&str] = match *joint {
            "universe" => continue,
            "root_joint" => {
                for (place, part) in ["x", "y", "z", "e1", "e2", "e3", "e0"].iter().enumerate() {
                    maps[0].insert(format!("q_base_{part}"), json!(q[place]));
                }
                at = 1;
                &["base_x", "base_y", "base_z", "base_rx", "base_ry", "base_rz"]
            }
            name => {
                maps[0].insert(format!("q_{name}"), json!(q[at + speeds.len()]));
                &[name]
            }
        };
        for suffix in suffixes {
            maps[1].insert(format!("u_{suffix}"), json!(v[speeds.len()]));
            maps[2].insert(format!("tau_{suffix}"), json!(tau[speeds.len()]));
            speeds.push(format!("u_{suffix}"));
        }
    }
    let [q, u, inputs] = maps.map(Value::Object);
    (q, u, inputs, speeds)
}

#[test]
fn robots_agree_with_another_program() {
    let folder = tempfile::tempdir().unwrap();
    let expected: Value = serde_json::from_str(&data("peers/expected.json")).unwrap();
    for (name, robot) in expected.as_object().unwrap() {
        let urdf = root().join(format!("tests/data/peers/{name}.urdf"));
        if !urdf.exists() {
            continue; // a robot too long to be kept here
        }
        let model = imported(&urdf.display().to_string(), name, &["--contact", "ee"], folder.path());
        let joints: Vec<&str> =
            robot["joints"].as_array().unwrap().iter().map(|j| j.as_str().unwrap()).collect();
        for reference in robot["states"].as_array().unwrap() {
            let (q, u, inputs, speeds) = state(&joints, reference);
            let driven = eval(&model, &json!({"q": q, "u": u, "inputs": inputs}));
            let free = eval(&model, &json!({"q": q, "u": u}));
            let order: Vec<usize> = speeds
                .iter()
                .map(|name| {
                    driven["speeds"].as_array().unwrap().iter().position(|other| other == name).unwrap()
                })
                .collect();
            let check = |what: &str, found: &[f64], expected: &str| {
                let error = difference(found, &numbers(&reference[expected]), 0.0);
                assert!(error <= 1e-10, "{name} {what}: {error:e}");
            };
            let row =
                |values: &Value| -> Vec<f64> { order.iter().map(|&place| number(&values[place])).collect() };
            let mass: Vec<Vec<f64>> = order.iter().map(|&place| row(&driven["mass_matrix"][place])).collect();
            check("mass matrix", &mass.concat(), "M");
            let udot: Vec<f64> = speeds.iter().map(|name| number(&driven["udot"][name])).collect();
            check("forward dynamics", &udot, "forward_dynamics");
            let a = numbers(&reference["a"]);
            let inverse: Vec<f64> = mass
                .iter()
                .zip(row(&free["forcing"]))
                .map(|(row, force)| row.iter().zip(&a).map(|(m, a)| m * a).sum::<f64>() - force)
                .collect();
            check("inverse dynamics", &inverse, "inverse_dynamics");
            // From n, t, s to the axes of the world.
            let contact = &driven["contacts"]["contact_ee"];
            let axes = ["normal", "tangent", "binormal"].map(|axis| numbers(&contact[axis]));
            let partials: Vec<Vec<f64>> = contact["V"].as_array().unwrap().iter().map(&row).collect();
            let m = numbers(&contact["reduced"]);
            let m = [[m[0], m[1], m[2]], [m[1], m[3], m[4]], [m[2], m[4], m[5]]];
            let (mut jacobian, mut reduced) = (Vec::new(), Vec::new());
            for i in 0..3 {
                let along = (0..3).map(|k| partials[k].iter().map(|partial| axes[k][i] * partial).collect());
                let row: Vec<f64> = along
                    .reduce(|a: Vec<f64>, b: Vec<f64>| a.iter().zip(&b).map(|(a, b)| a + b).collect())
                    .unwrap();
                jacobian.extend(row);
                for j in 0..3 {
                    let terms = (0..9).map(|k| axes[k / 3][i] * m[k / 3][k % 3] * axes[k % 3][j]);
                    reduced.push(terms.sum());
                }
            }
            check("Jacobian", &jacobian, "J");
            check("contact matrix", &reduced, "contact_matrix");
        }
    }
}

/// A machine with all joints, geoms and actuators of MJCF that are imported.
#[test]
fn a_machine_of_mjcf_agrees_with_mujoco() {
    let folder = tempfile::tempdir().unwrap();
    let machine = root().join("tests/data/imports/machine.xml").display().to_string();
    let model = imported(&machine, "machine", &[], folder.path());
    let expected: Value = serde_json::from_str(&data("imports/expected.json")).unwrap();
    for state in expected["states"].as_array().unwrap() {
        let answer = eval(&model, &json!({"q": state["q"], "u": state["u"], "inputs": state["inputs"]}));
        let speeds = state["udot"].as_object().unwrap();
        assert_eq!(speeds.len(), answer["udot"].as_object().unwrap().len());
        for (name, expected) in speeds {
            let (found, expected) = (number(&answer["udot"][name]), number(expected));
            assert!((found - expected).abs() < 1e-10 * (1.0 + expected.abs()), "{name}: {found} {expected}");
        }
    }
}

/// The same arm in URDF, and in SDF with all links and joints in axes of the model.
#[test]
fn an_arm_of_sdf_is_that_of_urdf() {
    let folder = tempfile::tempdir().unwrap();
    let inertia = [("ixx", 0.3), ("ixy", 0.01), ("ixz", -0.02), ("iyy", 0.2), ("iyz", 0.03), ("izz", 0.15)];
    let attributes: Vec<String> = inertia.iter().map(|(name, value)| format!("{name}=\"{value}\"")).collect();
    let elements: Vec<String> =
        inertia.iter().map(|(name, value)| format!("<{name}>{value}</{name}>")).collect();
    let urdf_link = |name: &str| {
        format!(
            "<link name=\"{name}\"><inertial><origin xyz=\"0.1 0.2 0.3\" rpy=\"0.3 -0.2 0.5\"/><mass value=\"2\"/>\
             <inertia {}/></inertial></link>",
            attributes.join(" ")
        )
    };
    let sdf_link = |name: &str, pose: &str| {
        format!(
            "<link name=\"{name}\"><pose>{pose}</pose><inertial><pose>0.1 0.2 0.3 0.3 -0.2 0.5</pose><mass>2</mass>\
             <inertia>{}</inertia></inertial></link>",
            elements.join("")
        )
    };
    // quarter turns: the places in the model are those of the chain, by hand
    let urdf = format!(
        "<robot name=\"arm\"><link name=\"base\"/>{}{}\
         <joint name=\"hip\" type=\"revolute\"><parent link=\"base\"/><child link=\"upper\"/>\
         <origin xyz=\"0.5 0 1\" rpy=\"0 0 1.5707963267948966\"/><axis xyz=\"0 0.6 0.8\"/><dynamics damping=\"0.7\"/></joint>\
         <joint name=\"slide\" type=\"prismatic\"><parent link=\"upper\"/><child link=\"fore\"/>\
         <origin xyz=\"0.4 0.2 0\" rpy=\"1.5707963267948966 0 0\"/><axis xyz=\"1 0 0\"/></joint></robot>",
        urdf_link("upper"),
        urdf_link("fore")
    );
    // the hip's x is the model's y, its y the model's -x; slide is at (0.5, 0, 1) + 0.4 y - 0.2 x
    let sdf = format!(
        "<sdf version=\"1.9\"><world name=\"w\"><gravity>0 0 -9.80665</gravity><model name=\"arm\"><link name=\"base\"><inertial/></link>{}{}\
         <joint name=\"weld\" type=\"fixed\"><parent>world</parent><child>base</child></joint>\
         <joint name=\"hip\" type=\"revolute\"><parent>base</parent><child>upper</child>\
         <axis><xyz expressed_in=\"__model__\">-0.6 0 0.8</xyz><dynamics><damping>0.7</damping></dynamics></axis></joint>\
         <joint name=\"slide\" type=\"prismatic\"><pose relative_to=\"upper\">0 0 0 0 0 0</pose><parent>upper</parent>\
         <child>fore</child><axis><xyz>1 0 0</xyz></axis></joint></model></world></sdf>",
        sdf_link("upper", "0.5 0 1 0 0 1.5707963267948966"),
        sdf_link("fore", "0.3 0.4 1 1.5707963267948966 0 1.5707963267948966"),
    );
    let answers = [("arm.urdf", urdf), ("arm.sdf", sdf)].map(|(name, text)| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        let model = imported(&path.display().to_string(), &name.replace('.', "_"), &[], folder.path());
        eval(
            &model,
            &json!({"q": {"q_hip": 0.4, "q_slide": -0.3}, "u": {"u_hip": 0.9, "u_slide": -0.7},
                "inputs": {"tau_hip": 1.5, "tau_slide": -2.5}}),
        )
    });
    for speed in ["u_hip", "u_slide"] {
        let [one, other] = [0, 1].map(|i: usize| number(&answers[i]["udot"][speed]));
        assert!((one - other).abs() < 1e-12 * (1.0 + one.abs()), "{speed}: {one} {other}");
    }
    let energies = [0, 1].map(|i: usize| number(&answers[i]["kinetic_energy"]));
    assert!((energies[0] - energies[1]).abs() < 1e-13 && energies[0] > 0.1, "{energies:?}");
}

/// A state moved along its rates for a time.
fn moved(state: &Value, answer: &Value, time: f64) -> Value {
    let shift = |values: &Value, rates: &Value| -> Value {
        let shifted = values
            .as_object()
            .unwrap()
            .iter()
            .map(|(name, value)| (name.clone(), json!(number(value) + time * number(&rates[name]))));
        Value::Object(shifted.collect())
    };
    let mut q = shift(&state["q"], &answer["qdot"]);
    for joint in ["base", "f"] {
        let names = ["e0", "e1", "e2", "e3"].map(|part| format!("q_{joint}_{part}"));
        let norm = names.iter().map(|name| number(&q[name]).powi(2)).sum::<f64>().sqrt();
        names.iter().for_each(|name| q[name] = json!(number(&q[name]) / norm));
    }
    json!({"q": q, "u": shift(&state["u"], &answer["udot"]), "inputs": state["inputs"], "parameters": state["parameters"]})
}

#[test]
fn the_power_of_the_inputs_is_the_rate_of_the_kinetic_energy() {
    let folder = tempfile::tempdir().unwrap();
    let urdf = folder.path().join("all.urdf");
    std::fs::write(&urdf, ALL_JOINTS).unwrap();
    let model = imported(&urdf.display().to_string(), "all_joints", &["--contact", "hook"], folder.path());
    let first = eval(&model, &json!({}));
    let mut seed = 0.37f64;
    let mut next = || {
        seed = (seed * 1997.0 + 0.123).fract();
        json!(2.0 * seed - 1.0)
    };
    let mut q: Map<String, Value> =
        first["q"].as_object().unwrap().keys().map(|name| (name.clone(), next())).collect();
    for joint in ["base", "f"] {
        for (part, value) in ["e0", "e1", "e2", "e3"].iter().zip([0.1, -0.5, 0.7, 0.5]) {
            q.insert(format!("q_{joint}_{part}"), json!(value));
        }
    }
    let speeds: Vec<&str> =
        first["speeds"].as_array().unwrap().iter().map(|name| name.as_str().unwrap()).collect();
    assert_eq!(speeds.len(), 6 + 1 + 3 + 6 + 1);
    let u: Map<String, Value> = speeds.iter().map(|&name| (name.to_owned(), next())).collect();
    let inputs: Map<String, Value> =
        speeds.iter().map(|name| (name.replacen("u_", "tau_", 1), next())).collect();
    let power: f64 =
        speeds.iter().map(|&name| number(&u[name]) * number(&inputs[&name.replacen("u_", "tau_", 1)])).sum();
    let state = json!({"q": q, "u": u, "inputs": inputs, "parameters": {"g": 0}});
    let answer = eval(&model, &state);
    let energy = |time: f64| number(&eval(&model, &moved(&state, &answer, time))["kinetic_energy"]);
    let h = 1e-4;
    let rate = (8.0 * (energy(h) - energy(-h)) - (energy(2.0 * h) - energy(-2.0 * h))) / (12.0 * h);
    assert!((rate - power).abs() < 1e-7 * number(&answer["kinetic_energy"]).max(1.0), "{rate} {power}");
}

/// Products of inertia that are zero stay zero, and the moments are those of the file, in the optimised tool too.
#[test]
fn moments_of_inertia_are_those_of_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("leg.urdf").display().to_string();
    let robot = "<robot name=\"leg\"><link name=\"base\"/><link name=\"leg\"><inertial><mass value=\"1\"/>\
        <inertia ixx=\"1\" iyy=\"2\" izz=\"2.5\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>\
        <joint name=\"hip\" type=\"revolute\"><parent link=\"base\"/><child link=\"leg\"/></joint></robot>";
    std::fs::write(&path, robot).unwrap();
    let run = hodograph(&["import", &path], "");
    assert_eq!(run.code, 0, "{}", run.stderr);
    for entry in ["Ixx_leg: kg*m^2 = 1,", "Iyy_leg: kg*m^2 = 2,", "Izz_leg: kg*m^2 = 2.5,"] {
        assert!(run.stdout.contains(entry), "{}", run.stdout);
    }
    assert!(run.stdout.contains("inertia: [Ixx_leg, Iyy_leg, Izz_leg]"), "{}", run.stdout);
}

#[test]
fn what_cannot_be_imported_is_said_with_its_place() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("r.urdf");
    std::fs::write(
        &path,
        ALL_JOINTS.replace("0.6 0 -0.8", "1 0 1").replace("link=\"hook\"", "link=\"hock\""),
    )
    .unwrap();
    let run = hodograph(&["import", &path.display().to_string()], "");
    assert_eq!(run.code, 1);
    assert!(run.stdout.is_empty());
    assert!(
        run.stderr.contains("r.urdf:11:1: joint `a`: its axis `1 0 1` has length 1.414"),
        "{}",
        run.stderr
    );
    assert!(run.stderr.contains("unknown link `hock`: did you mean `hook`?"), "{}", run.stderr);
    assert_eq!(hodograph(&["import", "no.urdf"], "").code, 2);
    std::fs::write(&path, b"<robot name=\"\xff\"/>").unwrap();
    let run = hodograph(&["import", &path.display().to_string()], "");
    assert_eq!((run.code, run.stderr.contains("not UTF-8 at byte 13")), (1, true), "{}", run.stderr);
}
