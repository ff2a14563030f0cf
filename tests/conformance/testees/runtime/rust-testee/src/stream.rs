//! Requests about messages of a framed link.

use crate::line::{hex, Answer, Words};
use crate::nodes::LONGEST;
use crate::wire::explained;
use icd::wire::link::Link;
use icd::wire::stream::{
    encode, encode_packet, encode_request, Client, Decoder, Event, NodeEvent, Request, Values,
};
use icd::wire::{Direction, Error, Settings};
use std::fmt::Write;

const SEQUENCES: usize = 64;

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

fn shown(event: &Event<'_>) -> String {
    match *event {
        Event::Message { id, data, values } => {
            format!(" message id={id} bytes={}{}", hex(data), chosen(values))
        }
        Event::Request { id, values } => format!(" request id={id}{}", chosen(values)),
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
        Event::Checksum { id } => format!(" checksum id={id}"),
        Event::Length { id: Some(id) } => format!(" length id={id}"),
        Event::Length { id: None } => " length".into(),
        Event::UnknownId { id } => format!(" unknown_id id={id}"),
        Event::Overrun => " overrun".into(),
        Event::Framing => " framing".into(),
        Event::Done {
            id,
            attempts,
            reply,
            packet,
            data,
            ..
        } => {
            let bytes = hex(data);
            let reply = match packet {
                Some(_) => String::new(), // not telemetry
                None => format!(" reply={reply}"),
            };
            format!(" done id={id} attempts={attempts}{reply} bytes={bytes}")
        }
        Event::Sent { id, attempts, .. } => format!(" sent id={id} attempts={attempts}"),
        Event::Refused {
            id, attempts, code, ..
        } => format!(" refused id={id} attempts={attempts}{}", coded(code)),
        Event::Busy {
            id, attempts, code, ..
        } => format!(" busy id={id} attempts={attempts}{}", coded(code)),
        Event::Timeout { id, attempts, .. } => format!(" timeout id={id} attempts={attempts}"),
        Event::Progress { id, data, .. } => format!(" progress id={id} bytes={}", hex(data)),
        Event::Reply {
            id, reply, data, ..
        } => format!(" reply id={id} reply={reply} bytes={}", hex(data)),
        Event::Late { id, data, .. } => format!(" late id={id} bytes={}", hex(data)),
        Event::Stray { id, data, .. } => format!(" stray id={id} bytes={}", hex(data)),
        _ => " other".into(),
    }
}

fn chosen(values: &Values) -> String {
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

fn coded(code: Option<u32>) -> String {
    code.map_or_else(String::new, |code| format!(" code={code}"))
}

pub fn stream_client(link: &'static Link, words: &mut Words) -> Answer {
    match words.number() {
        1 => scripted::<1>(link, words),
        2 => scripted::<2>(link, words),
        _ => scripted::<3>(link, words),
    }
}

fn scripted<const R: usize>(link: &'static Link, words: &mut Words) -> Answer {
    let settings = Settings {
        reply_timeout_ms: words.maybe().unwrap_or(link.client.reply_timeout_ms),
        retries: words.maybe().unwrap_or(link.client.retries),
        late_ms: words.maybe().unwrap_or(link.client.late_ms),
        busy_pause_ms: words.maybe().unwrap_or(link.client.busy_pause_ms),
        gap_ms: words.maybe().unwrap_or(link.client.gap_ms),
        in_flight: words.maybe().unwrap_or(link.client.in_flight),
        progress_for_ms: words.maybe().unwrap_or(link.client.progress_for_ms),
        ..link.client
    };
    let client = Client::<(), LONGEST, SEQUENCES, R>::new(link)?;
    let mut client = client.with_settings(settings);
    let mut answer = String::new();
    let mut room = vec![0; 2 * LONGEST + 8];
    while words.more() {
        let (now, takes) = (words.number(), words.flag());
        answer += " step";
        happen(&mut client, now, words, &mut answer);
        if takes {
            while let Some(bytes) = client.output(&mut room)? {
                let _ = write!(answer, " stream bytes={}", hex(bytes));
            }
        }
        if let Some(deadline) = client.deadline() {
            let _ = write!(answer, " until deadline={deadline}");
        }
    }
    Ok(answer)
}

fn happen<const R: usize>(
    client: &mut Client<(), LONGEST, SEQUENCES, R>,
    now: u32,
    words: &mut Words,
    answer: &mut String,
) {
    let on_event = |event: NodeEvent<'_, ()>| *answer += &shown(&event);
    match words.word() {
        "telecommand" => {
            let (id, repeat, is_named) = (words.number(), words.flag(), words.flag());
            let reply: Option<u32> = words.maybe().filter(|_| is_named);
            let data = words.octets();
            let request = Request {
                repeat,
                reply,
                ..Request::telecommand(id, &data)
            };
            *answer += &begun(client.start(now, &request));
        }
        "telemetry" => {
            let id = words.number();
            *answer += &begun(client.start(now, &Request::telemetry(id)));
        }
        "received" => client.received(now, &words.octets(), on_event),
        "cancel" => match words.word() {
            "telecommand" => client.cancel_request(Direction::Telecommand, words.number()),
            "telemetry" => client.cancel_request(Direction::Telemetry, words.number()),
            _ => client.cancel(),
        },
        _ => client.tick(now, on_event),
    }
}

fn begun(started: Result<(), Error>) -> String {
    match started {
        Ok(()) => String::new(),
        Err(error) => format!(" error error={}", explained(&error)),
    }
}
