//! Messages on a stream. What is no message is reported, and the next one is looked for.

use std::io::{self, BufRead, Read, Write};

use lsp_server::Message;

/// A message has at most this many bytes: a text may have 4 MiB, each byte of it written as six.
const MAX_BYTES: u64 = 64 << 20;
/// A line of a header has at most this many bytes.
const MAX_LINE: u64 = 4096;

/// What was read.
#[derive(Debug)]
pub enum Incoming {
    /// a message
    Message(Message),
    /// what is none: why
    Malformed(String),
}

/// Reads the next message; nothing at the end of the stream.
pub fn read(input: &mut impl BufRead) -> io::Result<Option<Incoming>> {
    let mut length: Option<u64> = None;
    let mut strange = false;
    loop {
        let mut line = Vec::new();
        if input.by_ref().take(MAX_LINE).read_until(b'\n', &mut line)? == 0 {
            return Ok(None);
        }
        let line = String::from_utf8_lossy(&line);
        let line = line.trim_end();
        if line.is_empty() {
            match length {
                Some(length) => return body(input, length).map(Some),
                // blank lines between messages
                None if !strange => continue,
                None => return malformed("a header without `Content-Length`"),
            }
        }
        let name = line.split(':').next().unwrap_or_default();
        if name.eq_ignore_ascii_case("content-length") {
            length = line.split_once(':').and_then(|(_, value)| value.trim().parse().ok());
            if length.is_none() {
                return malformed("`Content-Length` is no number");
            }
        } else if !name.eq_ignore_ascii_case("content-type") {
            // the header may begin behind it
            strange = true;
        }
    }
}

fn malformed(why: &str) -> io::Result<Option<Incoming>> {
    Ok(Some(Incoming::Malformed(why.to_owned())))
}

fn body(input: &mut impl BufRead, length: u64) -> io::Result<Incoming> {
    if length > MAX_BYTES {
        io::copy(&mut input.take(length), &mut io::sink())?;
        return Ok(Incoming::Malformed(format!("a message of {length} bytes is too long")));
    }
    let mut bytes = Vec::new();
    input.take(length).read_to_end(&mut bytes)?;
    let read = match std::str::from_utf8(&bytes) {
        Ok(text) => serde_json::from_str(text).map_err(|error| error.to_string()),
        Err(error) => Err(error.to_string()),
    };
    Ok(match read {
        Ok(message) => Incoming::Message(message),
        Err(why) => Incoming::Malformed(format!("what was sent is no message: {why}")),
    })
}

/// Writes a message.
pub fn write(output: &mut impl Write, message: &serde_json::Value) -> io::Result<()> {
    let text = message.to_string();
    write!(output, "Content-Length: {}\r\n\r\n{text}", text.len())?;
    output.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(bytes: &[u8]) -> Vec<Result<String, String>> {
        let mut input = bytes;
        let mut out = Vec::new();
        while let Ok(Some(incoming)) = read(&mut input) {
            out.push(match incoming {
                Incoming::Message(Message::Notification(notification)) => Ok(notification.method),
                Incoming::Message(other) => Ok(format!("{other:?}")),
                Incoming::Malformed(why) => Err(why),
            });
        }
        out
    }

    #[test]
    fn after_nonsense_the_next_message_is_read() {
        let message = "Content-Length: 33\r\n\r\n{\"jsonrpc\":\"2.0\",\"method\":\"exit\"}";
        let exit = Ok("exit".to_owned());
        assert_eq!(all(message.as_bytes()), std::slice::from_ref(&exit));
        for nonsense in [
            "hello\r\n\r\n",
            "Content-Length: x\r\n",
            "Content-Length: 5\r\n\r\nhello",
            "Content-Length: 4\r\n\r\nnull",
            "Content-Length: 3\r\n\r\n\u{3c0}\"",
            "Content-Length: -1\r\n",
        ] {
            let found = all(format!("{nonsense}{message}").as_bytes());
            assert_eq!(found.last(), Some(&exit), "{nonsense}: {found:?}");
            assert!(found.len() == 2 && found[0].is_err(), "{nonsense}: {found:?}");
        }
        // a long line that is no header
        let found = all([&vec![b'x'; 100_000][..], b"\r\n\r\n", message.as_bytes()].concat().as_slice());
        assert_eq!(found.last(), Some(&exit));
        // the end within a message
        assert!(all(&message.as_bytes()[..40]).iter().all(Result::is_err));
        assert!(all(b"Content-Length: 99999999999\r\n\r\nx").iter().all(Result::is_err));
    }
}
