//! What the page asks: questions and answers are JSON texts, so that a page in a browser, node and a test of
//! this machine ask the same functions.
//!
//! | `ask` | answer |
//! | --- | --- |
//! | `check` | what is wrong with a model, with fixes; the colours of its words |
//! | `complete`, `hover`, `rename`, `definition`, `outline` | what an editor asks of a place |
//! | `format` | the text in the one style |
//! | `describe` | the quantities of the model, for sliders |
//! | `move` | the motion |
//! | `hodograph` | the course of a collision |
//! | `equations` | the equations of a model with a derivation, as a page |
//!
//! A model is asked of as `text`, with its `name` and the `files` that it may import. Places in texts are counted
//! as JavaScript counts them, in units of UTF-16.

mod answer;
mod collision;
mod describe;
mod exports;
mod language;
mod model;
mod motion;
mod places;
mod texts;

use answer::object;
use serde_json::Value;

/// Says how far a motion is (s); the answer is whether to go on.
pub type GoOn<'a> = &'a dyn Fn(f64) -> bool;

/// Largest question, in bytes: models of some thousand lines with their derivations.
const MOST: usize = 16 << 20;

/// Answers a question.
pub fn answer(question: &str, go_on: GoOn<'_>) -> String {
    let fault = |text: String| object!({ "fault": text });
    if question.len() > MOST {
        return fault(format!("the question has {} bytes: {MOST} is the most", question.len())).to_string();
    }
    let answer = match serde_json::from_str::<Value>(question) {
        Ok(question) => ask(&question, go_on).unwrap_or_else(fault),
        Err(error) => fault(format!("the question is no JSON: {error}")),
    };
    answer.to_string()
}

fn ask(question: &Value, go_on: GoOn<'_>) -> Result<Value, String> {
    let texts = || texts::Texts::of(question);
    let at = || question["at"].as_u64().unwrap_or(0) as u32;
    Ok(match question["ask"].as_str().unwrap_or("") {
        "check" => language::check(&texts()?),
        "complete" => language::complete(&texts()?, at()),
        "hover" => language::hover(&texts()?, at()),
        "rename" => language::rename(&texts()?, at(), question["new"].as_str().unwrap_or("")),
        "definition" => language::definition(&texts()?, at()),
        "outline" => language::outline(&texts()?),
        "format" => language::format(&texts()?),
        "describe" => describe::describe(&model::read(&texts()?.source())?),
        "move" => motion::motion(&texts()?.source(), question, go_on)?,
        "hodograph" => collision::course(question)?,
        "equations" => model::equations(&texts()?.source(), question["derivation"].as_str().unwrap_or(""))?,
        other => return Err(format!("nothing is known of `{other}`")),
    })
}
