//! Tests of the import: attributes of URDF that are not read, mistakes of the XML, and long names.

use super::tests_of_formats::{accepted, has};
use super::{Imported, Options, import};

const LINKS: &str = "<link name=\"base\"/>\n<link name=\"arm\"><inertial><origin xyz=\"0 0 1\"/><mass value=\"2\"/>\
                     <inertia ixx=\"0.1\" ixy=\"0\" ixz=\"0\" iyy=\"0.1\" iyz=\"0\" izz=\"0.02\"/></inertial></link>\n";

fn robot(more: &str) -> String {
    format!(
        "<robot name=\"r\">\n{LINKS}<joint name=\"hip\" type=\"revolute\"><parent link=\"base\"/><child link=\"arm\"/>{more}\
         </joint>\n</robot>"
    )
}

fn read(source: &str) -> Imported {
    import(source, "r.urdf", &Options::default()).unwrap_or_else(|problems| panic!("{problems:?}"))
}

fn refused(source: &str) -> String {
    import(source, "r.urdf", &Options::default()).unwrap_err().join("\n")
}

/// An attribute that is not read is told like an element: a misspelt one would count as zero silently.
#[test]
fn attributes_of_urdf_that_are_not_read_are_told() {
    let joint = "<origin xzy=\"0 0 .5\" rpyy=\"1 0 0\"/><dynamics dampng=\"3\"/><limit effort=\"1\"/>";
    let source = robot(joint)
        .replace("<mass ", "<mass unit=\"kg\" ")
        .replace("</inertial>", "<extra/></inertial>")
        .replace("<robot ", "<robot xmlns:x=\"y\" x:name=\"z\" ")
        .replace(
            "</link>",
            "<collision><geometry><sphere radius=\"1\" colour=\"red\"/></geometry></collision></link>",
        );
    let notes = read(&source).notes.join("\n");
    for told in [
        "r.urdf:4:83: ignored attribute `xzy` of <origin>",
        "r.urdf:4:96: ignored attribute `rpyy` of <origin>",
        "ignored attribute `dampng` of <dynamics>",
        "ignored attribute `unit` of <mass>",
        "ignored attribute `colour` of <sphere>",
        "ignored attribute `name` of <robot>",
        "ignored <extra> of an inertial",
        "ignored <limit> of a joint",
    ] {
        assert!(notes.contains(told), "{told}\n{notes}");
    }
    assert!(!read(&robot("<origin xyz=\"0 0 1\"/>")).notes.join("\n").contains("ignored"));
    let solid = "<collision><origin/><origin/><geometry><sphere radius=\"1\"/></geometry></collision></inertial></link>";
    let twice = robot("").replace(
        "</inertial></link>",
        &solid.replace("</inertial>", "").replace("<coll", "</inertial><coll"),
    );
    assert!(
        refused(&twice).contains("a second <origin> of <collision> of link `arm`: keep one"),
        "{}",
        refused(&twice)
    );
}

/// A document type is read over; entities are not expanded.
#[test]
fn document_types_are_allowed_without_entities() {
    let with = |kind: &str| format!("<?xml version=\"1.0\"?>\n{kind}\n{}", robot(""));
    for kind in [
        "<!DOCTYPE robot>",
        "<!DOCTYPE robot SYSTEM \"robot.dtd\">",
        "<!DOCTYPE robot [<!ELEMENT link ANY>]>",
    ] {
        assert_eq!(read(&with(kind)).model, read(&robot("")).model);
    }
    for entity in ["<!ENTITY a \"b\">", "<!ENTITY a SYSTEM \"/etc/passwd\">", "<!ENTITY % a \"b\">"] {
        let said = refused(&with(&format!("<!DOCTYPE robot [\n {entity}]>")));
        assert_eq!(
            said,
            "r.urdf:3:2: entities are not read: write in the place of each what it stands for, and remove the <!DOCTYPE ..>"
        );
    }
}

/// A mistake of the XML is told at its place, with its cause and its cure.
#[test]
fn mistakes_of_the_xml_have_their_places() {
    let whole = robot("");
    let prefixed = refused(&whole.replace("</robot>", "<sensor:camera name=\"x\"/></robot>"));
    assert!(prefixed.starts_with("r.urdf:5:"), "{prefixed}");
    assert!(
        prefixed.contains(
            "the prefix `sensor` has no meaning: remove what bears it, or state `xmlns:sensor=\"..\"`"
        ),
        "{prefixed}"
    );
    let end = whole.find("\n</robot>").unwrap();
    for (cut, place) in [(whole.find(" value").unwrap(), "r.urdf:3:54"), (end, "r.urdf:4:")] {
        let said = refused(&whole[..cut]);
        assert!(said.starts_with(place) && said.contains("the file ends within an element"), "{said}");
    }
    let crossed = refused("<robot>\n<link></robot>");
    assert_eq!(crossed, "r.urdf:2:7: this is not XML: expected 'link' tag, not 'robot'");
}

/// Long names are shortened to distinct ones, so that the names formed from them are allowed.
#[test]
fn long_names_are_shortened() {
    let long = "a".repeat(120);
    let hung = robot("<axis xyz=\"0 0 1\"/>").replace("revolute", "prismatic");
    let source = hung.replace("\"arm\"", &format!("\"{long}1\"")).replace("\"hip\"", &format!("\"{long}2\""));
    let source = source.replace("\"r\"", &format!("\"{long}3\""));
    let contacts = vec![format!("{long}1")];
    let imported = import(&source, "r.urdf", &Options { contacts, ..Options::default() }).unwrap();
    accepted(&imported.model);
    let short = "a".repeat(70);
    has(&imported.model, &format!("q_{short}_n2: m,"));
    let notes = imported.notes.join("\n");
    for (end, name) in [("1", short.clone()), ("2", format!("{short}_n2"))] {
        let told = format!("`{long}{end}` is called `{name}`, because names are at most 80 letters long");
        assert!(notes.contains(&told), "{notes}");
    }
}
