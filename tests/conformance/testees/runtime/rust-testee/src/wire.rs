//! Requests about how the messages travel.

use crate::line::{counted, hex, ranged, Answer, Refusal, Words};
use crate::nodes::{link, LONGEST};
use crate::{logs, procedures, scripts, stream};
use icd::wire::files::{IndexEntries, IndexEntry};
use icd::wire::uart::{Decoder, Kind};
use icd::wire::{can, checksum, i2c, identify, uart, Bus, DosTime, Error, Link};
use std::fmt::Write;

const SENDERS: usize = 16;

impl From<Error> for Refusal {
    fn from(error: Error) -> Self {
        Self(explained(&error))
    }
}

pub fn explained(error: &Error) -> String {
    match error {
        Error::Unsupported => "unsupported".into(),
        Error::UnknownId { .. } => "unknown-id".into(),
        Error::Busy => "busy".into(),
        Error::Length { expected, actual } => counted("length", *expected, *actual),
        Error::TooLong { most, actual } => counted("too-long", *most, *actual),
        Error::Checksum { expected, actual } => {
            format!("checksum expected={expected} actual={actual}")
        }
        Error::Range { field, .. } => ranged(field),
        _ => "other".into(),
    }
}

/// The answer to a request.
pub fn answer(op: &str, words: &mut Words) -> Answer {
    let answer: fn(&'static Link, &mut Words) -> Answer = match op {
        "checksum" => checksum_of,
        "uart_encode" => uart_encode,
        "uart_events" => uart_events,
        "can_split" => can_split,
        "can_join" => can_join,
        "i2c_read" => i2c_read,
        "i2c_write" => i2c_write,
        "i2c_reply" => i2c_reply,
        "log_decode" => logs::log_decode,
        "log_encode" => logs::log_encode,
        "log_message_decode" => logs::log_message_decode,
        "log_message_encode" => logs::log_message_encode,
        "dos_time_unpack" => dos_time_unpack,
        "dos_time_pack" => dos_time_pack,
        "index_decode" => index_decode,
        "index_encode" => index_encode,
        "identify" => identity,
        "link_data" => |link, _| Ok(link_data(link)),
        "client" => scripts::client,
        "stream_encode" => stream::stream_encode,
        "stream_encode_packet" => stream::stream_encode_packet,
        "stream_events" => stream::stream_events,
        "stream_respond" => stream::stream_respond,
        "stream_client" => scripts::stream_client,
        "procedure" => return procedures::procedure(words.number(), words),
        _ => return Err(Refusal("request".into())),
    };
    answer(link(words.number()).ok_or(Error::Unsupported)?, words)
}

pub fn bus(words: &mut Words) -> Bus {
    match words.word() {
        "uart" => Bus::Uart,
        "i2c" => Bus::I2c,
        _ => Bus::Can,
    }
}

fn checksum_of(link: &'static Link, words: &mut Words) -> Answer {
    let name = String::from_utf8(words.octets()).unwrap();
    let value = checksum(link, &name, &words.octets())?;
    Ok(format!(" crc={value}"))
}

fn link_data(link: &'static Link) -> String {
    let text = |number: Option<u32>| number.map_or(String::new(), |known| known.to_string());
    format!(
        " boot_ms={} log_file_type={} index_file_type={}",
        text(link.boot_ms),
        text(link.log_file.and_then(|form| form.file_type).map(u32::from)),
        text(link.index.and_then(|form| form.file_type).map(u32::from)),
    )
}

fn uart_encode(link: &'static Link, words: &mut Words) -> Answer {
    let message = words.octets();
    let mut out = vec![0; message.len() * 2 + 4];
    let size = uart::encode(link, &message, &mut out)?;
    Ok(format!(" bytes={}", hex(&out[..size])))
}

fn uart_events(link: &'static Link, words: &mut Words) -> Answer {
    let mut decoder = Decoder::<LONGEST>::with_limit(link, words.number())?;
    let mut answer = String::new();
    while words.more() {
        decoder.feed(&words.octets(), |event| answer += &uart_event(link, event));
    }
    let (discarded, pending) = (decoder.discarded(), decoder.pending());
    Ok(format!(
        "{answer} ok discarded={discarded} pending={pending}"
    ))
}

fn uart_event(link: &Link, event: uart::Event<'_>) -> String {
    match event {
        uart::Event::Message(message) => {
            let kind = match uart::kind(link, message) {
                Kind::Reply => "reply",
                Kind::Acknowledge => "acknowledge",
                Kind::Packet => "packet",
                Kind::Log => "log",
                Kind::Other => "other",
            };
            format!(" message kind={kind} bytes={}", hex(message))
        }
        uart::Event::UnexpectedStart => " unexpected_start".into(),
        uart::Event::ProtocolError => " protocol_error".into(),
        uart::Event::Overrun => " overrun".into(),
        uart::Event::Empty => " empty".into(),
    }
}

const KINDS: [(&str, can::Kind); 6] = [
    ("telecommand", can::Kind::Telecommand),
    ("acknowledge", can::Kind::Acknowledge),
    ("refusal", can::Kind::Refusal),
    ("request", can::Kind::Request),
    ("reply", can::Kind::Reply),
    ("request_refusal", can::Kind::RequestRefusal),
];

fn can_split(link: &'static Link, words: &mut Words) -> Answer {
    let name = words.word();
    let kind = KINDS.iter().find(|(one, _)| *one == name);
    let (_, kind) = *kind.ok_or_else(|| Refusal("request".into()))?;
    let (id, source, destination) = (words.number(), words.number(), words.number());
    let data = &words.octets();
    let message = can::Message {
        kind,
        id,
        source,
        destination,
        data,
    };
    let packets = can::Splitter::new(link, &message)?;
    Ok(packets.map(|one| shown_packet("packet", &one)).collect())
}

pub fn shown_packet(row: &str, packet: &can::Packet) -> String {
    format!(" {row} id={} bytes={}", packet.id, hex(packet.data()))
}

/// A packet in a request.
pub fn packet(words: &mut Words) -> Result<can::Packet, Refusal> {
    let id = words.number();
    can::Packet::new(id, &words.octets()).ok_or_else(|| Refusal("request".into()))
}

fn can_join(link: &'static Link, words: &mut Words) -> Answer {
    let (address, senders, end) = (words.maybe(), words.number(), words.maybe::<u32>());
    let mut joiner = can::Joiner::<LONGEST, SENDERS>::with_senders(link, address, senders)?;
    let mut answer = String::new();
    while words.more() {
        let at = words.number();
        joiner.feed(at, &packet(words)?, |event| answer += &can_event(event));
    }
    if let Some(end) = end {
        joiner.expire(end, |event| answer += &can_event(event));
    }
    Ok(answer)
}

fn can_event(event: can::Event<'_>) -> String {
    let (name, id, source, more) = match event {
        can::Event::Message(message) => {
            let kind = KINDS.iter().find(|(_, kind)| *kind == message.kind);
            let kind = kind.map_or("", |(name, _)| name);
            let (to, bytes) = (message.destination, hex(message.data));
            let more = format!(" kind={kind} destination={to} bytes={bytes}");
            ("message", message.id, message.source, more)
        }
        can::Event::Incomplete {
            id,
            source,
            missing,
        } => ("incomplete", id, source, format!(" missing={missing}")),
        can::Event::Duplicate { id, source } => ("duplicate", id, source, String::new()),
        can::Event::Malformed { id, source } => ("malformed", id, source, String::new()),
        can::Event::Busy { id, source } => ("busy", id, source, String::new()),
        can::Event::UnknownType { id, source } => ("unknown_type", id, source, String::new()),
    };
    format!(" {name} id={id} source={source}{more}")
}

fn i2c_read(link: &'static Link, words: &mut Words) -> Answer {
    let read = i2c::read_length(link, words.number(), words.flag())?;
    Ok(format!(" read={read}"))
}

fn i2c_write(link: &'static Link, words: &mut Words) -> Answer {
    let (id, checked, data) = (words.number(), words.flag(), words.octets());
    let mut out = vec![0; data.len() + 8];
    let size = i2c::write(link, id, &data, checked, &mut out)?;
    Ok(format!(" write={}", hex(&out[..size])))
}

fn i2c_reply(link: &'static Link, words: &mut Words) -> Answer {
    let (id, checked, data) = (words.number(), words.flag(), words.octets());
    Ok(format!(
        " bytes={}",
        hex(i2c::reply(link, id, &data, checked)?)
    ))
}

fn dos_time_unpack(link: &'static Link, words: &mut Words) -> Answer {
    let time = DosTime::unpack(link, words.number())?;
    let (year, month, day) = (time.year, time.month, time.day);
    let (hour, minute, second) = (time.hour, time.minute, time.second);
    let date = format!(" year={year} month={month} day={day}");
    let valid = u8::from(time.is_valid());
    Ok(format!(
        "{date} hour={hour} minute={minute} second={second} valid={valid}"
    ))
}

fn dos_time_pack(link: &'static Link, words: &mut Words) -> Answer {
    let time = DosTime {
        year: words.number(),
        month: words.number(),
        day: words.number(),
        hour: words.number(),
        minute: words.number(),
        second: words.number(),
    };
    Ok(format!(" value={}", time.pack(link)?))
}

fn index_decode(link: &'static Link, words: &mut Words) -> Answer {
    let bytes = words.octets();
    let entries = IndexEntries::new(link, &bytes)?;
    let mut answer = format!(" truncated={}", entries.truncated());
    for one in entries {
        let (kind, counter, checksum) = (one.kind, one.counter, one.checksum);
        let (size, time, meta) = (one.size, one.time, hex(one.meta));
        let _ = write!(
            answer,
            " entry type={kind} counter={counter} checksum={checksum}"
        );
        let _ = write!(answer, " size={size} time={time} meta={meta}");
    }
    Ok(answer)
}

fn index_encode(link: &'static Link, words: &mut Words) -> Answer {
    let mut answer = String::from(" bytes=");
    let mut out = vec![0; 4096];
    while words.more() {
        let entry = IndexEntry {
            kind: words.number(),
            counter: words.number(),
            checksum: words.number(),
            size: words.number(),
            time: words.number(),
            meta: &words.octets(),
        };
        let size = entry.encode(link, &mut out)?;
        answer += &hex(&out[..size]);
    }
    Ok(answer)
}

fn identity(link: &'static Link, words: &mut Words) -> Answer {
    let found = identify(link, &words.octets())?;
    let (number, version) = (found.node_type, found.interface_version);
    let matches = u8::from(found.matches);
    Ok(format!(
        " node_type={number} interface_version={version} matches={matches}"
    ))
}
