//! Requests about messages in an envelope.

use crate::line::{hex, Answer, Words};
use crate::nodes::LONGEST;
use icd::wire::link::{EnvelopeRole, Link, Stream};
use icd::wire::stream::{encode, Decoder, Event, Values};
use icd::wire::{Direction, Error};
use std::fmt::Write;

const SEQUENCES: usize = 64;

fn direction(words: &mut Words) -> Direction {
    match words.word() {
        "0" => Direction::Telecommand,
        _ => Direction::Telemetry,
    }
}

pub fn stream_encode(link: &'static Link, words: &mut Words) -> Answer {
    let direction = direction(words);
    let (id, data) = (words.number(), words.octets());
    let mut values = Values::new(link, direction);
    for place in [
        &mut values.sequence,
        &mut values.source,
        &mut values.destination,
        &mut values.kind,
        &mut values.flags,
        &mut values.time,
    ] {
        *place = words.maybe().unwrap_or(*place);
    }
    let mut out = vec![0; data.len() * 2 + 300];
    let size = encode(link, direction, id, &data, &values, &mut out)?;
    // It takes just as many bytes as it says.
    let mut exact = vec![0; size];
    encode(link, direction, id, &data, &values, &mut exact)?;
    let short = exact.get_mut(1..).unwrap_or(&mut []);
    match encode(link, direction, id, &data, &values, short) {
        Err(Error::Length { expected, .. }) if expected == size => {
            Ok(format!(" bytes={}", hex(&out[..size])))
        }
        _ => Ok(" room=0".into()),
    }
}

pub fn stream_events(link: &'static Link, words: &mut Words) -> Answer {
    let (direction, limit) = (direction(words), words.number());
    let form = link.stream.as_ref().ok_or(Error::Unsupported)?;
    let mut decoder = Decoder::<LONGEST, SEQUENCES>::with_limit(link, direction, limit)?;
    let mut answer = String::new();
    while words.more() {
        decoder.feed(&words.octets(), |event| answer += &shown(form, &event));
    }
    let (discarded, pending) = (decoder.discarded(), decoder.pending());
    Ok(format!(
        "{answer} ok discarded={discarded} pending={pending}"
    ))
}

fn shown(form: &Stream, event: &Event<'_>) -> String {
    match *event {
        Event::Message { id, data, values } => {
            let mut row = format!(" message id={id} bytes={}", hex(data));
            for field in form.fields {
                let (name, value) = match field.role {
                    EnvelopeRole::Sequence => ("sequence", values.sequence),
                    EnvelopeRole::Source => ("source", values.source),
                    EnvelopeRole::Destination => ("destination", values.destination),
                    EnvelopeRole::Type => ("type", values.kind),
                    EnvelopeRole::Flags => ("flags", values.flags),
                    EnvelopeRole::Time => ("time", values.time),
                    _ => continue,
                };
                let _ = write!(row, " {name}={value}");
            }
            row
        }
        Event::Gap { id, missing } => format!(" gap id={id} missing={missing}"),
        Event::Checksum { id } => format!(" checksum id={id}"),
        Event::Length { id: Some(id) } => format!(" length id={id}"),
        Event::Length { id: None } => " length".into(),
        Event::UnknownId { id } => format!(" unknown_id id={id}"),
        Event::Overrun => " overrun".into(),
        Event::Framing => " framing".into(),
        _ => " other".into(),
    }
}
