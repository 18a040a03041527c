//! The language server: what `hodograph-language` answers, in the Language Server Protocol.
//!
//! ```text
//! wire     messages on standard input and output; what is none is answered and passed over
//! convert  places and kinds, as the protocol counts and calls them
//! uri      paths of files
//! jobs     commands that run beside the server: derive, explain, simulate
//! lenses   what stands above the name of a mechanism
//! answers  requests about a document
//! session  documents, and the order of the protocol
//! ```
//!
//! Files are small: each change is answered by reading all of the text anew. Changes that arrive while a text is
//! being read are taken together.

mod answers;
mod convert;
mod documents;
mod jobs;
mod lenses;
mod rename;
mod session;
mod texts;
mod uri;
mod wire;

use std::sync::mpsc;

use crate::stop::{Outcome, Stop};
use session::Session;
use wire::Incoming;

/// Messages that wait: a client that sends more is not read until they are answered.
const WAITING: usize = 1024;

/// What the server acts upon.
enum Event {
    Incoming(Incoming),
    Finished(jobs::Finished),
    End,
}

/// Serves until the client says `exit` or closes the connection.
///
/// # Errors
///
/// [`Stop::Fault`] if the standard input cannot be read or the client cannot be written to.
pub fn serve() -> Outcome {
    let (events, received) = mpsc::sync_channel(WAITING);
    let reader = events.clone();
    std::thread::spawn(move || {
        let mut input = std::io::BufReader::with_capacity(1 << 16, std::io::stdin());
        while let Ok(Some(incoming)) = wire::read(&mut input) {
            if reader.send(Event::Incoming(incoming)).is_err() {
                return;
            }
        }
        let _ = reader.send(Event::End);
    });
    let finished = move |job| drop(events.send(Event::Finished(job)));
    let mut session = Session::new(std::sync::Arc::new(finished));
    let mut output = std::io::BufWriter::new(std::io::stdout().lock());
    let fault = |error: std::io::Error| Stop::Fault(format!("standard output: {error}"));
    while let Ok(event) = received.recv() {
        let mut next = Some(event);
        // all that waits, before texts are read anew
        while let Some(event) = next {
            match event {
                Event::Incoming(incoming) => session.receive(incoming),
                Event::Finished(job) => session.finished(job),
                Event::End => session.end(),
            }
            next = received.try_recv().ok();
        }
        session.settle();
        for message in session.outgoing() {
            wire::write(&mut output, &message).map_err(fault)?;
        }
        match session.ended() {
            None => {}
            Some(true) => return Ok(()),
            Some(false) => return Err(Stop::Reported),
        }
    }
    Ok(())
}
