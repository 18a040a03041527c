//! The program that valgrind executes for editors: `typing NAME` types a word into a model and asks after each key
//! what an editor asks; without arguments it prints the models that are counted.

use hodograph_language::Document;

/// What is counted: shipped models of several sizes. They stand in the program, whatever the folder it runs in.
const COUNTED: [(&str, &str); 3] = [
    ("pendulum", include_str!("../../../../../playground/page/pendulum.mech")),
    ("whipple_bicycle", include_str!("../../../../../models/whipple_bicycle.mech")),
    ("arm_7dof", include_str!("../../../../../models/arm_7dof.mech")),
];
fn main() -> Result<(), String> {
    let Some(name) = std::env::args().nth(1) else {
        COUNTED.iter().for_each(|(name, _)| println!("{name}"));
        return Ok(());
    };
    let (_, text) = COUNTED.iter().find(|(known, _)| *known == name).ok_or("there is no such model")?;
    // at the end of the first comment, and into the last product
    let places = [(text.find('\n'), " again"), (text.rfind('*').map(|at| at + 1), "1*")];
    let mut said = 0;
    for (place, word) in places {
        let at = place.ok_or("the model has no such place")?;
        for keys in 1..=word.len() {
            said += press([&text[..at], &word[..keys], &text[at..]].concat());
        }
    }
    println!("{said} findings and colours");
    Ok(())
}

/// One key: the text is read anew, and its mistakes and colours are asked for. What is counted is this function, by
/// its name.
#[inline(never)]
fn press(text: String) -> usize {
    let document = Document::new(text);
    document.findings().len() + document.colours().len()
}
