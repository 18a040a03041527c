//! A cart with a chain of links: the mechanism of `tests/data/peers/cart5.urdf` with any number of links.

use std::fmt::Write;

/// The robot description of a cart with `links` links. Link i is 0.4 m + 0.02 m (i - 1) long with 0.5 kg +
/// 0.03 kg (i - 1) at its end.
pub fn urdf(links: usize) -> String {
    let length = |link: usize| 0.4 + 0.02 * (link as f64 - 1.0);
    let mut text = format!("<robot name=\"chain{links}\">\n<link name=\"base\"/>\n");
    for link in 0..=links {
        let (mass, at) =
            if link == 0 { (2.1, 0.0) } else { (0.5 + 0.03 * (link as f64 - 1.0), length(link)) };
        let origin = if link > 1 { length(link - 1) } else { 0.0 };
        let (joint, axis) = if link == 0 { ("prismatic", "0 1 0") } else { ("revolute", "1 0 0") };
        let parent = if link == 0 { "base".to_owned() } else { format!("l{}", link - 1) };
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "<link name=\"l{link}\"><inertial><origin xyz=\"0 0 {at}\"/><mass value=\"{mass}\"/>\
             <inertia ixx=\"0\" ixy=\"0\" ixz=\"0\" iyy=\"0\" iyz=\"0\" izz=\"0\"/></inertial></link>\n\
             <joint name=\"j{link}\" type=\"{joint}\"><origin xyz=\"0 0 {origin}\"/><parent link=\"{parent}\"/>\
             <child link=\"l{link}\"/><axis xyz=\"{axis}\"/>\
             <limit lower=\"-100\" upper=\"100\" effort=\"1000\" velocity=\"1000\"/></joint>"
        );
    }
    let _ = writeln!(
        text,
        "<link name=\"ee\"/><joint name=\"jee\" type=\"fixed\"><origin xyz=\"0 0 {}\"/><parent link=\"l{links}\"/>\
         <child link=\"ee\"/></joint>\n</robot>",
        length(links)
    );
    text
}
