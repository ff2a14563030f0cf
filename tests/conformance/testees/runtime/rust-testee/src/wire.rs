//! Requests about how the messages travel.

use crate::ask::{any, byte, flag, hex_rows, mappings, number, octets, text, BYTE};
use crate::json::{hex, quoted, Json};
use crate::logs;
use crate::nodes::{LINKS, LONGEST, NODES};
use crate::subject::Refusal;
use icd::wire::uart::{Decoder, Kind};
use icd::wire::{can, crc16, crc8, i2c, identify, uart, Error, Link};

const SENDERS: usize = 16;

impl From<Error> for Refusal {
    fn from(error: Error) -> Self {
        Self::Answer(explained(&error))
    }
}

pub fn explained(error: &Error) -> String {
    match error {
        Error::Unsupported => "\"error\": \"unsupported\"".into(),
        Error::UnknownId { .. } => "\"error\": \"unknown-id\"".into(),
        Error::Busy => "\"error\": \"busy\"".into(),
        Error::Length { expected, actual } => {
            format!("\"error\": \"length\", \"expected\": {expected}, \"actual\": {actual}")
        }
        Error::TooLong { most, actual } => {
            format!("\"error\": \"too-long\", \"expected\": {most}, \"actual\": {actual}")
        }
        Error::Checksum { expected, actual } => {
            format!("\"error\": \"checksum\", \"expected\": {expected}, \"actual\": {actual}")
        }
        Error::Range { field } => format!("\"error\": \"range\", \"field\": {}", quoted(field)),
        _ => "\"error\": \"other\"".into(),
    }
}

/// A range error of which nobody wants to know the field.
pub fn unnamed(error: Error) -> Refusal {
    match error {
        Error::Range { .. } => Refusal::Answer("\"error\": \"range\"".into()),
        other => other.into(),
    }
}

/// The answer to a request.
pub fn answer(op: &str, request: &Json) -> Result<String, Refusal> {
    let answer: fn(&'static Link, &Json) -> Result<String, Refusal> = match op {
        "crc8" => |link, request| {
            Ok(format!(
                "\"crc\": {}",
                crc8(link, &octets(request, "bytes")?)?
            ))
        },
        "crc16" => |link, request| {
            let crc = crc16(link, &octets(request, "bytes")?)?;
            Ok(format!("\"crc\": {crc}"))
        },
        "uart_encode" => uart_encode,
        "uart_decode" => uart_decode,
        "uart_events" => uart_events,
        "can_split" => can_split,
        "can_join" => can_join,
        "i2c_request" => i2c_request,
        "i2c_reply" => i2c_reply,
        "log_decode" => logs::log_decode,
        "log_encode" => logs::log_encode,
        "log_message_decode" => logs::log_message_decode,
        "log_message_encode" => logs::log_message_encode,
        "dos_time" => logs::dos_time,
        "hole_map" => logs::hole_map,
        "index_decode" => logs::index_decode,
        "index_encode" => logs::index_encode,
        "identify" => identity,
        "client" => crate::client::answer,
        "file" => crate::file::answer,
        _ => return Err(Refusal::Request),
    };
    answer(link(request)?, request)
}

/// That of the node that is named; without a name, of the last node that has one.
fn link(request: &Json) -> Result<&'static Link, Refusal> {
    let found = if request.get("node").is_some() {
        let name = text(request, "node")?;
        if !NODES.iter().any(|node| node.name == name) {
            return Err(Refusal::UnknownNode);
        }
        LINKS.iter().find(|link| link.node == name)
    } else {
        LINKS.last()
    };
    Ok(*found.ok_or(Error::Unsupported)?)
}

pub fn list(rows: impl IntoIterator<Item = String>) -> String {
    format!("[{}]", rows.into_iter().collect::<Vec<_>>().join(", "))
}

fn uart_encode(link: &'static Link, request: &Json) -> Result<String, Refusal> {
    let message = octets(request, "bytes")?;
    let mut out = vec![0; message.len() * 2 + 4];
    let size = uart::encode(link, &message, &mut out)?;
    Ok(format!("\"bytes\": \"{}\"", hex(&out[..size])))
}

fn uart_decode(link: &'static Link, request: &Json) -> Result<String, Refusal> {
    let stream = octets(request, "bytes")?;
    let mut decoder = Decoder::<LONGEST>::with_limit(link, link.longest)?;
    let mut frames = Vec::new();
    decoder.feed(&stream, |event| {
        if let uart::Event::Message(message) = event {
            frames.push(format!("\"{}\"", hex(message)));
        }
    });
    Ok(format!("\"frames\": {}", list(frames)))
}

fn uart_events(link: &'static Link, request: &Json) -> Result<String, Refusal> {
    let longest = u32::try_from(link.longest).map_err(|_| Refusal::Request)?;
    let limit = number(request, "limit", 1, longest, Some(longest))?;
    let chunks = hex_rows(request, "chunks")?;
    let limit = usize::try_from(limit).map_err(|_| Refusal::Request)?;
    let mut decoder = Decoder::<LONGEST>::with_limit(link, limit)?;
    let mut events = Vec::new();
    for chunk in chunks {
        decoder.feed(&chunk, |event| events.push(uart_event(link, event)));
    }
    Ok(format!(
        "\"events\": {}, \"discarded\": {}, \"pending\": {}",
        list(events),
        decoder.discarded(),
        decoder.pending()
    ))
}

fn uart_event(link: &Link, event: uart::Event<'_>) -> String {
    let name = match event {
        uart::Event::Message(message) => {
            let kind = match uart::kind(link, message) {
                Kind::Reply => "reply",
                Kind::Acknowledge => "acknowledge",
                Kind::Packet => "packet",
                Kind::Log => "log",
                Kind::Other => "other",
            };
            let bytes = hex(message);
            return format!(
                "{{\"event\": \"message\", \"kind\": \"{kind}\", \"bytes\": \"{bytes}\"}}"
            );
        }
        uart::Event::UnexpectedStart => "unexpected_start",
        uart::Event::ProtocolError => "protocol_error",
        uart::Event::Overrun => "overrun",
        uart::Event::Empty => "empty",
    };
    format!("{{\"event\": \"{name}\"}}")
}

const KINDS: [(&str, can::Kind); 6] = [
    ("telecommand", can::Kind::Telecommand),
    ("acknowledge", can::Kind::Acknowledge),
    ("refusal", can::Kind::Refusal),
    ("request", can::Kind::Request),
    ("reply", can::Kind::Reply),
    ("request_refusal", can::Kind::RequestRefusal),
];

fn can_split(link: &'static Link, request: &Json) -> Result<String, Refusal> {
    let (kind, data) = (text(request, "kind")?, octets(request, "bytes")?);
    let kind = KINDS.iter().find(|(name, _)| *name == kind);
    let (_, kind) = *kind.ok_or(Refusal::Request)?;
    let part = |key| number(request, key, 0, BYTE, None);
    let message = can::Message {
        kind,
        id: part("id")?,
        source: part("source")?,
        destination: part("destination")?,
        data: &data,
    };
    let packets = can::Splitter::new(link, &message)?;
    Ok(format!(
        "\"packets\": {}",
        list(packets.map(|packet| can_packet(&packet)))
    ))
}

pub fn can_packet(packet: &can::Packet) -> String {
    format!(
        "{{\"id\": {}, \"bytes\": \"{}\"}}",
        packet.id,
        hex(packet.data())
    )
}

/// A packet in a request.
pub fn packet_of(row: &Json) -> Result<can::Packet, Refusal> {
    let id = number(row, "id", 0, (1 << 29) - 1, None)?;
    can::Packet::new(id, &octets(row, "bytes")?).ok_or(Refusal::Request)
}

fn can_join(link: &'static Link, request: &Json) -> Result<String, Refusal> {
    let address = match request.get("address") {
        Some(_) => Some(number(request, "address", 0, BYTE, None)?),
        None => None,
    };
    let senders = number(request, "senders", 1, 16, Some(4))?;
    let mut packets = Vec::new();
    for row in mappings(request, "packets")? {
        packets.push((packet_of(row)?, number(row, "at", 0, u32::MAX, Some(0))?));
    }
    let senders = usize::try_from(senders).map_err(|_| Refusal::Request)?;
    let mut joiner = can::Joiner::<LONGEST, SENDERS>::with_senders(link, address, senders)?;
    let mut events = Vec::new();
    for (packet, at) in packets {
        joiner.feed(at, &packet, |event| events.push(can_event(event)));
    }
    if request.get("end").is_some() {
        joiner.expire(any(request, "end")?, |event| events.push(can_event(event)));
    }
    Ok(format!("\"events\": {}", list(events)))
}

fn can_event(event: can::Event<'_>) -> String {
    let (name, id, source, more) = match event {
        can::Event::Message(message) => {
            let kind = KINDS.iter().find(|(_, kind)| *kind == message.kind);
            let more = format!(
                ", \"kind\": \"{}\", \"destination\": {}, \"bytes\": \"{}\"",
                kind.map_or("", |(name, _)| name),
                message.destination,
                hex(message.data)
            );
            ("message", message.id, message.source, more)
        }
        can::Event::Incomplete {
            id,
            source,
            missing,
        } => (
            "incomplete",
            id,
            source,
            format!(", \"missing\": {missing}"),
        ),
        can::Event::Duplicate { id, source } => ("duplicate", id, source, String::new()),
        can::Event::Malformed { id, source } => ("malformed", id, source, String::new()),
        can::Event::Busy { id, source } => ("busy", id, source, String::new()),
        can::Event::UnknownType { id, source } => ("unknown_type", id, source, String::new()),
    };
    format!("{{\"event\": \"{name}\", \"id\": {id}, \"source\": {source}{more}}}")
}

fn i2c_request(link: &'static Link, request: &Json) -> Result<String, Refusal> {
    let (kind, id, checked) = (
        text(request, "kind")?,
        byte(request, "id")?,
        flag(request, "crc")?,
    );
    if kind == "telemetry" {
        let read = i2c::read_length(link, id, checked)?;
        return Ok(format!("\"write\": \"{}\", \"read\": {read}", hex(&[id])));
    }
    if kind != "telecommand" {
        return Err(Refusal::Request);
    }
    let data = octets(request, "bytes")?;
    let mut out = vec![0; data.len() + 8];
    let size = i2c::write(link, id, &data, checked, &mut out)?;
    Ok(format!("\"write\": \"{}\", \"read\": 0", hex(&out[..size])))
}

fn i2c_reply(link: &'static Link, request: &Json) -> Result<String, Refusal> {
    let (id, data) = (byte(request, "id")?, octets(request, "bytes")?);
    let frame = i2c::reply(link, id, &data, flag(request, "crc")?)?;
    Ok(format!("\"bytes\": \"{}\"", hex(frame)))
}

fn identity(link: &'static Link, request: &Json) -> Result<String, Refusal> {
    let found = identify(link, &octets(request, "bytes")?)?;
    Ok(format!(
        "\"node_type\": {}, \"interface_version\": {}, \"matches\": {}",
        found.node_type, found.interface_version, found.matches
    ))
}
