//! Requests about messages of a framed link.

use crate::line::{hex, Answer, Words};
use crate::nodes::LONGEST;
use icd::wire::link::{Link, Verdict};
use icd::wire::stream::{
    self, encode, encode_packet, encode_request, Decoder, Event, Sender, Values,
};
use icd::wire::{Direction, Error};
use std::fmt::Write;

pub const SEQUENCES: usize = 64;

fn direction(words: &mut Words) -> Direction {
    match words.word() {
        "0" => Direction::Telecommand,
        _ => Direction::Telemetry,
    }
}

pub fn stream_encode(link: &'static Link, words: &mut Words) -> Answer {
    let direction = match words.word() {
        "0" => Some(Direction::Telecommand),
        "1" => Some(Direction::Telemetry),
        _ => None, // the packet that requests telemetry
    };
    let (id, data) = (words.number(), words.octets());
    let values = chosen_values(words);
    exactly(|out| match direction {
        Some(direction) => encode(link, direction, id, &data, &values, out),
        None => encode_request(link, id, &values, out),
    })
}

pub fn stream_encode_packet(link: &'static Link, words: &mut Words) -> Answer {
    let direction = direction(words);
    let (packet, id) = (words.number(), words.number());
    let values = chosen_values(words);
    exactly(|out| encode_packet(link, direction, packet, id, &values, out))
}

fn chosen_values(words: &mut Words) -> Values {
    let mut values = Values::default();
    for place in [
        &mut values.sequence,
        &mut values.source,
        &mut values.destination,
        &mut values.kind,
        &mut values.flags,
        &mut values.time,
        &mut values.status,
        &mut values.reason,
    ] {
        *place = words.maybe();
    }
    values
}

fn exactly(encoded: impl Fn(&mut [u8]) -> Result<usize, Error>) -> Answer {
    let mut out = vec![0; 2 * LONGEST + 300];
    let size = encoded(&mut out)?;
    // It takes just as many bytes as it says.
    let mut exact = vec![0; size];
    encoded(&mut exact)?;
    match encoded(exact.get_mut(1..).unwrap_or(&mut [])) {
        Err(Error::Length { expected, .. }) if expected == size => {
            Ok(format!(" bytes={}", hex(&out[..size])))
        }
        _ => Ok(" room=0".into()),
    }
}

pub fn stream_events(link: &'static Link, words: &mut Words) -> Answer {
    let (direction, limit) = (direction(words), words.number());
    let mut decoder = Decoder::<LONGEST, SEQUENCES>::with_limit(link, direction, limit)?;
    let mut answer = String::new();
    while words.more() {
        decoder.feed(&words.octets(), |event| answer += &shown(&event));
    }
    let (discarded, pending) = (decoder.discarded(), decoder.pending());
    Ok(format!(
        "{answer} ok discarded={discarded} pending={pending}"
    ))
}

pub fn stream_respond(link: &'static Link, words: &mut Words) -> Answer {
    let verdicts = [
        Verdict::Ack,
        Verdict::Reply,
        Verdict::Nak,
        Verdict::Busy,
        Verdict::Progress,
    ];
    let verdict = verdicts[words.number::<usize>()];
    let (has_reason, reason) = (words.flag(), words.maybe());
    let (reason, data) = (reason.filter(|_| has_reason), words.octets());
    let mut sender = Sender::<(), SEQUENCES>::with_direction(link, Direction::Telemetry)?;
    sender.values = chosen_values(words);
    let mut decoder =
        Decoder::<LONGEST, SEQUENCES>::with_limit(link, Direction::Telecommand, link.longest)?;
    let mut answer = String::new();
    while words.more() {
        decoder.feed(&words.octets(), |event| {
            let mut buffer = vec![0; LONGEST.max(data.len())];
            buffer[..data.len()].copy_from_slice(&data);
            let mut response = stream::Answer {
                verdict,
                reason,
                buffer: &mut buffer,
                length: data.len(),
            };
            let has_id = !matches!(
                event,
                Event::Packet { .. }
                    | Event::Gap { .. }
                    | Event::Length { id: None, .. }
                    | Event::Overrun
                    | Event::Framing
            );
            if has_id {
                let mut out = vec![0; 2 * LONGEST + 300];
                let text = match sender.respond(&event, &mut response, &mut out) {
                    Ok(size) => format!("bytes={}", hex(&out[..size])),
                    Err(Error::Length { .. }) => "error=length".into(),
                    Err(Error::Range { .. }) => "error=range".into(),
                    Err(_) => "error=unsupported".into(),
                };
                let _ = write!(answer, " response {text}");
            }
        });
    }
    Ok(answer)
}

fn shown(event: &Event<'_>) -> String {
    match *event {
        Event::Message {
            id, data, values, ..
        } => {
            format!(" message id={id} bytes={}{}", hex(data), chosen(values))
        }
        Event::Request { id, values, .. } => format!(" request id={id}{}", chosen(values)),
        Event::Packet {
            packet,
            id,
            data,
            values,
        } => {
            let bytes = hex(data);
            format!(
                " packet packet={packet} id={id} bytes={bytes}{}",
                chosen(values)
            )
        }
        Event::Gap { id, missing } => format!(" gap id={id} missing={missing}"),
        Event::Checksum { id, .. } => format!(" checksum id={id}"),
        Event::Length { id: Some(id), .. } => format!(" length id={id}"),
        Event::Length { id: None, .. } => " length".into(),
        Event::UnknownId { id, .. } => format!(" unknown_id id={id}"),
        Event::Overrun => " overrun".into(),
        Event::Framing => " framing".into(),
        _ => " other".into(),
    }
}

pub fn chosen(values: &Values) -> String {
    let values = [
        ("sequence", values.sequence),
        ("source", values.source),
        ("destination", values.destination),
        ("type", values.kind),
        ("flags", values.flags),
        ("time", values.time),
        ("status", values.status),
        ("reason", values.reason),
    ];
    let mut row = String::new();
    for (name, value) in values {
        if let Some(value) = value {
            let _ = write!(row, " {name}={value}");
        }
    }
    row
}
