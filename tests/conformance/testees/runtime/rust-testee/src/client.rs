//! Scripts for the client: what happens at which time, and what it does then.

use crate::ask::{any, byte, bytes_of, flag, mappings, number, octets, text, BYTE};
use crate::json::{hex, Json};
use crate::nodes::LONGEST;
use crate::subject::Refusal;
use crate::wire::{can_packet, explained, list, packet_of};
use icd::wire::{Bus, Client, Error, Event, Link, Reason, Request, Settings, Started};

pub fn bus(request: &Json) -> Result<Bus, Refusal> {
    match text(request, "bus")? {
        "uart" => Ok(Bus::Uart),
        "i2c" => Ok(Bus::I2c),
        "can" => Ok(Bus::Can),
        _ => Err(Refusal::Request),
    }
}

pub fn answer(link: &'static Link, request: &Json) -> Result<String, Refusal> {
    let bus = bus(request)?;
    let checked = flag(request, "crc")?;
    let address = number(request, "address", 0, BYTE, Some(0))?;
    let address = u8::try_from(address).map_err(|_| Refusal::Request)?;
    let settings = settings(link, request)?;
    let client = match bus {
        Bus::Uart => Client::<LONGEST>::uart(link)?,
        Bus::I2c => Client::i2c(link)?,
        Bus::Can => Client::can(link, address)?,
    };
    let client = if checked {
        client.with_checksums()
    } else {
        client
    };
    let mut client = client.with_settings(settings);
    let mut steps = Vec::new();
    for row in mappings(request, "script")? {
        steps.push(step(link, &mut client, bus, row)?);
    }
    Ok(format!("\"steps\": {}", list(steps)))
}

fn settings(link: &Link, request: &Json) -> Result<Settings, Refusal> {
    let nothing = Json::Map(Vec::new());
    let given = match request.get("settings") {
        None => &nothing,
        Some(given @ Json::Map(_)) => given,
        Some(_) => return Err(Refusal::Request),
    };
    let usual = &link.client;
    let time = |key, usual| number(given, key, 1, u32::MAX, Some(usual));
    let retries = number(given, "retries", 0, BYTE, Some(usual.retries.into()))?;
    Ok(Settings {
        reply_timeout_ms: time("reply_timeout", usual.reply_timeout_ms)?,
        retries: u8::try_from(retries).map_err(|_| Refusal::Request)?,
        poll_interval_ms: time("poll_interval", usual.poll_interval_ms)?,
        poll_timeout_ms: time("poll_timeout", usual.poll_timeout_ms)?,
    })
}

fn step(
    link: &Link,
    client: &mut Client<LONGEST>,
    bus: Bus,
    turn: &Json,
) -> Result<String, Refusal> {
    let now = any(turn, "at")?;
    let mut events = Vec::new();
    let mut error = String::new();
    let on_event = |event: Event<'_>| events.push(shown(&event));
    if turn.get("telecommand").is_some() {
        let (id, data) = (byte(turn, "telecommand")?, octets(turn, "bytes")?);
        let mut request = Request::telecommand(id, &data);
        request.repeat = flag(turn, "repeat")?;
        error = started(client.start(now, &request), id, on_event);
    } else if turn.get("telemetry").is_some() {
        let id = byte(turn, "telemetry")?;
        error = started(client.start(now, &Request::telemetry(id)), id, on_event);
    } else if let Some(given) = turn.get("receive") {
        match (bus, given) {
            (Bus::Uart, _) => client.received(now, &bytes_of(given)?, on_event),
            (Bus::I2c, Json::Null) => client.transferred(now, None, on_event),
            (Bus::I2c, _) => client.transferred(now, Some(&bytes_of(given)?), on_event),
            (Bus::Can, Json::Map(_)) => client.packet(now, &packet_of(given)?, on_event),
            (Bus::Can, _) => return Err(Refusal::Request),
        }
    } else if flag(turn, "cancel")? {
        client.cancel();
    } else {
        client.tick(now, on_event);
    }
    let out = list(output(link, client, bus));
    let deadline = client
        .deadline()
        .map_or_else(|| "null".into(), |at| at.to_string());
    let events = list(events);
    Ok(format!(
        "{{{error}\"out\": {out}, \"events\": {events}, \"deadline\": {deadline}}}"
    ))
}

/// The error as a key of the step, if there is one.
fn started(result: Result<Started, Error>, id: u8, mut on_event: impl FnMut(Event<'_>)) -> String {
    match result {
        Ok(Started::Waiting) => String::new(),
        Ok(Started::Done) => {
            let (attempts, data, nodes) = (1, &[], &[]);
            on_event(Event::Done {
                id,
                attempts,
                data,
                nodes,
            });
            String::new()
        }
        Err(error) => format!("{}, ", explained(&error)),
    }
}

/// All output, a message at a time.
fn output(link: &Link, client: &mut Client<LONGEST>, bus: Bus) -> Vec<String> {
    let mut found = Vec::new();
    match bus {
        Bus::Uart => {
            let start = link.framing.map(|framing| [framing.escape, framing.start]);
            let mut messages: Vec<Vec<u8>> = Vec::new();
            while let Some(piece) = client.output() {
                let begins = start.map_or(true, |start| piece.starts_with(&start));
                match messages.last_mut() {
                    Some(message) if !begins => message.extend_from_slice(piece),
                    _ => messages.push(piece.to_vec()),
                }
            }
            found.extend(
                messages
                    .iter()
                    .map(|message| format!("\"{}\"", hex(message))),
            );
        }
        Bus::Can => {
            while let Some(packet) = client.output_packet() {
                found.push(can_packet(&packet));
            }
        }
        Bus::I2c => {
            while let Some(one) = client.output_transaction() {
                let (write, read) = (hex(one.write), one.read);
                found.push(format!("{{\"write\": \"{write}\", \"read\": {read}}}"));
            }
        }
    }
    found
}

fn shown(event: &Event<'_>) -> String {
    let maybe = |number: Option<u32>| number.map_or_else(|| "null".into(), |n| n.to_string());
    let (name, more) = match event {
        Event::Done {
            id, attempts, data, ..
        } => {
            let bytes = hex(data);
            let more = format!(", \"id\": {id}, \"attempts\": {attempts}, \"bytes\": \"{bytes}\"");
            ("done", more)
        }
        Event::Refused {
            id,
            attempts,
            code,
            reason,
            parameter,
        } => {
            let reason = reason.map_or("null", |reason| match reason {
                Reason::NoError => "\"none\"",
                Reason::UnknownId => "\"unknown_id\"",
                Reason::Length => "\"length\"",
                Reason::Parameter => "\"parameter\"",
                Reason::Checksum => "\"checksum\"",
            });
            let (code, parameter) = (maybe(*code), maybe(*parameter));
            let what =
                format!("\"code\": {code}, \"reason\": {reason}, \"parameter\": {parameter}");
            (
                "refused",
                format!(", \"id\": {id}, \"attempts\": {attempts}, {what}"),
            )
        }
        Event::Timeout { id, attempts } => (
            "timeout",
            format!(", \"id\": {id}, \"attempts\": {attempts}"),
        ),
        Event::Malformed { id } => ("malformed", format!(", \"id\": {id}")),
        Event::Packet { number, data } => {
            let bytes = hex(data);
            (
                "packet",
                format!(", \"number\": {number}, \"bytes\": \"{bytes}\""),
            )
        }
        Event::Log { message } => ("log", format!(", \"bytes\": \"{}\"", hex(message))),
        Event::Stray { id, data } => {
            let id = id.and_then(|id| u8::try_from(id).ok());
            let id = id.map_or_else(String::new, |id| hex(&[id]));
            ("stray", format!(", \"bytes\": \"{id}{}\"", hex(data)))
        }
        Event::UnexpectedStart => ("unexpected_start", String::new()),
        Event::ProtocolError => ("protocol_error", String::new()),
        Event::Overrun => ("overrun", String::new()),
        Event::Empty => ("empty", String::new()),
        Event::Duplicate { id } => ("duplicate", format!(", \"id\": {id}")),
        Event::Incomplete { id } => ("incomplete", format!(", \"id\": {id}")),
        Event::Busy { id } => ("busy", format!(", \"id\": {id}")),
        Event::UnknownType { id } => ("unknown_type", format!(", \"id\": {id}")),
        _ => ("other", String::new()),
    };
    format!("{{\"event\": \"{name}\"{more}}}")
}
