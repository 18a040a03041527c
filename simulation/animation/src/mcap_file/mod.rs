//! Writes a motion as an MCAP file for robot viewers (Foxglove, Lichtblick, Rerun).
//!
//! [`bytes`] makes the file from an [`Animation`]: frames as `foxglove.FrameTransforms`, points, lines and arrows as `foxglove.SceneUpdate`,
//! events as `foxglove.Log`, and curves as objects of numbers. Messages are JSON, each topic with its JSON
//! schema.

mod messages;
mod scene;
mod schemas;
mod transforms;

use std::collections::BTreeMap;
use std::io::Cursor;

use mcap::records::MessageHeader;
use mcap::{McapResult, WriteOptions, Writer};
use serde::Serialize;
use serde_json::{Map, Value, json};

use self::messages::{Log, Time, xyz};
use self::scene::Scene;
use crate::{Animation, Series};

/// The largest time, s: times of the file are unsigned, and those of its messages have 32 bits for seconds.
pub const LAST: f64 = u32::MAX as f64;

/// The level of a `foxglove.Log` for information.
const INFO: u8 = 2;

/// The bytes of the file. `more` holds curves at the same times in addition to those of the animation. The
/// same motion gives the same bytes.
///
/// # Errors
///
/// More topics than the format can number.
pub fn bytes(shown: &Animation, more: &[Series]) -> McapResult<Vec<u8>> {
    let mut file = File::new()?;
    let topics = Topics::new(&mut file, shown, more)?;
    let scene = Scene::new(shown);
    let mut events = shown.events.iter().peekable();
    for (moment, &time) in shown.times.iter().enumerate() {
        // A recording contains only the states after events.
        if shown.before.binary_search(&moment).is_ok() {
            continue;
        }
        file.write(topics.transforms, time, &transforms::at(shown, moment))?;
        file.write(topics.mechanism, time, &scene.mechanism(moment))?;
        file.write(topics.names, time, &scene.names(moment))?;
        if let Some(channel) = topics.force_arrows {
            file.write(channel, time, &scene.forces(moment))?;
        }
        if let Some(channel) = topics.forces {
            file.write(channel, time, &forces(shown, moment))?;
        }
        for (channel, curves) in &topics.curves {
            let number = |curve: &&Series| Some((curve.name.clone(), known(*curve.values.get(moment)?)?));
            let values: Map<String, Value> = curves.iter().filter_map(number).collect();
            file.write(*channel, time, &values)?;
        }
        // A moment is recorded after each event, at its time.
        while let Some(event) = events.next_if(|event| event.time <= time) {
            file.write(topics.events, event.time, &log(event))?;
            if event.impulse.is_some() {
                file.write(topics.impulse_arrows, event.time, &scene.impulse(event))?;
            }
        }
    }
    file.finish()
}

/// A number of JSON; `None` if it is not finite.
fn known(number: f64) -> Option<Value> {
    serde_json::Number::from_f64(number + 0.0).map(Value::Number)
}

/// The vectors of the contact forces along N.x, N.y, N.z, N; zero for open contacts.
fn forces(shown: &Animation, moment: usize) -> Map<String, Value> {
    let of = |force: &crate::Force| json!(xyz(force.force[moment].unwrap_or([0.0; 3])));
    shown.forces.iter().map(|force| (force.name.clone(), of(force))).collect()
}

/// An event in words.
fn log(event: &crate::Happening) -> Log<'_> {
    let place = if event.contact.is_empty() { String::new() } else { format!(", {}", event.contact) };
    let impulse = event
        .impulse
        .map_or(String::new(), |[x, y, z]| format!(": impulse {x} N.x + {y} N.y + {z} N.z, N s"));
    Log {
        timestamp: Time::of(event.time),
        level: INFO,
        message: format!("{}{place}{impulse}", event.label),
        name: &event.contact,
        file: "",
        line: 0,
    }
}

/// The indices of the channels.
struct Topics<'a> {
    transforms: u16,
    mechanism: u16,
    names: u16,
    force_arrows: Option<u16>,
    impulse_arrows: u16,
    forces: Option<u16>,
    events: u16,
    curves: Vec<(u16, Vec<&'a Series>)>,
}

impl<'a> Topics<'a> {
    fn new(file: &mut File, shown: &'a Animation, more: &'a [Series]) -> McapResult<Self> {
        let mut panels: Vec<(&str, Vec<&Series>)> = Vec::new();
        for curve in more.iter().chain(&shown.series) {
            match panels.iter_mut().find(|(panel, _)| *panel == curve.panel) {
                Some((_, curves)) => curves.push(curve),
                None => panels.push((&curve.panel, vec![curve])),
            }
        }
        let scene = schemas::scene();
        let touching = !shown.forces.is_empty();
        Ok(Topics {
            transforms: file.topic("/tf", "foxglove.FrameTransforms", &schemas::transforms())?,
            mechanism: file.topic("/mechanism", "foxglove.SceneUpdate", &scene)?,
            names: file.topic("/names", "foxglove.SceneUpdate", &scene)?,
            force_arrows: match touching {
                true => Some(file.topic("/contact_force_arrows", "foxglove.SceneUpdate", &scene)?),
                false => None,
            },
            impulse_arrows: file.topic("/impulse_arrows", "foxglove.SceneUpdate", &scene)?,
            forces: match touching {
                true => {
                    let names = shown.forces.iter().map(|force| force.name.as_str());
                    Some(file.topic("/contact_force", "hodograph.contact_force", &schemas::vectors(names))?)
                }
                false => None,
            },
            events: file.topic("/events", "foxglove.Log", &schemas::log())?,
            curves: panels
                .into_iter()
                .map(|(panel, curves)| {
                    let word = panel.replace(' ', "_");
                    let of = curves.iter().map(|curve| (curve.name.as_str(), curve.unit.as_str()));
                    let schema = schemas::numbers(of);
                    Ok((file.topic(&format!("/{word}"), &format!("hodograph.{word}"), &schema)?, curves))
                })
                .collect::<McapResult<_>>()?,
        })
    }
}

/// A file that grows in memory.
struct File {
    writer: Writer<Cursor<Vec<u8>>>,
    sequence: u32,
}

impl File {
    fn new() -> McapResult<Self> {
        let options = WriteOptions::new().library(concat!("hodograph ", env!("CARGO_PKG_VERSION")));
        Ok(File { writer: options.create(Cursor::new(Vec::new()))?, sequence: 0 })
    }

    fn topic(&mut self, topic: &str, name: &str, schema: &Value) -> McapResult<u16> {
        let id = self.writer.add_schema(name, "jsonschema", schema.to_string().as_bytes())?;
        self.writer.add_channel(id, topic, "json", &BTreeMap::new())
    }

    fn write(&mut self, channel_id: u16, time: f64, message: &impl Serialize) -> McapResult<()> {
        let at = messages::nanoseconds(time);
        let header = MessageHeader { channel_id, sequence: self.sequence, log_time: at, publish_time: at };
        self.sequence = self.sequence.wrapping_add(1);
        let data = serde_json::to_vec(message).map_err(|error| std::io::Error::other(error.to_string()))?;
        self.writer.write_to_known_channel(&header, &data)
    }

    fn finish(mut self) -> McapResult<Vec<u8>> {
        self.writer.finish()?;
        Ok(self.writer.into_inner().into_inner())
    }
}
