//! Reads lines of JSON, one after the other, up to a maximum length.

use std::io::{self, BufRead};

use crate::stop::{Outcome, Stop};

/// Reads the next line; `Some(false)` if it was too long to store, `None` at the end. `name` is the input's
/// name in messages.
pub fn read_line(
    input: &mut impl BufRead,
    line: &mut Vec<u8>,
    longest: usize,
    name: &str,
) -> Outcome<Option<bool>> {
    line.clear();
    let (mut any, mut complete) = (false, true);
    loop {
        let chunk = match input.fill_buf() {
            Ok(chunk) => chunk,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            Err(error) => return Err(Stop::Fault(format!("cannot read {name}: {error}"))),
        };
        if chunk.is_empty() {
            return Ok(any.then_some(complete));
        }
        any = true;
        let end = chunk.iter().position(|&byte| byte == b'\n');
        let piece = &chunk[..end.unwrap_or(chunk.len())];
        complete = complete && line.len() + piece.len() <= longest;
        if complete {
            line.extend_from_slice(piece);
        }
        let used = end.map_or(chunk.len(), |end| end + 1);
        input.consume(used);
        if end.is_some() {
            return Ok(Some(complete));
        }
    }
}
