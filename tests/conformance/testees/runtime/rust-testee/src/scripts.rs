//! Scripts for the client: what happens at which time, and what it does then.

use crate::line::{hex, Answer, Refusal, Words};
use crate::nodes::LONGEST;
use crate::wire::{bus, explained, packet, shown_packet};
use icd::wire::{Bus, Client, Error, Event, Link, NodeEvent, Reason, Request, Settings, Started};
use std::fmt::Write;

pub fn client(link: &'static Link, words: &mut Words) -> Answer {
    let (bus, checked, address) = (bus(words), words.flag(), words.number());
    let usual = &link.client;
    let settings = Settings {
        reply_timeout_ms: words.maybe().unwrap_or(usual.reply_timeout_ms),
        retries: words.maybe().unwrap_or(usual.retries),
        poll_interval_ms: words.maybe().unwrap_or(usual.poll_interval_ms),
        poll_timeout_ms: words.maybe().unwrap_or(usual.poll_timeout_ms),
        late_ms: words.maybe().unwrap_or(usual.late_ms),
        ..*usual
    };
    let client = match bus {
        Bus::Uart => Client::<(), LONGEST>::uart(link)?,
        Bus::I2c => Client::i2c(link)?,
        Bus::Can => Client::can(link, address)?,
    };
    let client = if checked {
        client.with_checksums()
    } else {
        client
    };
    let mut client = client.with_settings(settings);
    let mut answer = String::new();
    while words.more() {
        answer += " step";
        happen(&mut client, words, &mut answer)?;
        output(&mut client, bus, &mut answer);
        if let Some(deadline) = client.deadline() {
            let _ = write!(answer, " until deadline={deadline}");
        }
    }
    Ok(answer)
}

fn happen(
    client: &mut Client<(), LONGEST>,
    words: &mut Words,
    answer: &mut String,
) -> Result<(), Refusal> {
    let (now, action) = (words.number(), words.word());
    let on_event = |event: NodeEvent<'_, ()>| *answer += &shown(&event);
    match action {
        "telecommand" => {
            let (id, repeat, data) = (words.number(), words.flag(), words.octets());
            let mut request = Request::telecommand(id, &data);
            request.repeat = repeat;
            let started = client.start(now, &request);
            *answer += &begun(started, id);
        }
        "telemetry" => {
            let id = words.number();
            let started = client.start(now, &Request::telemetry(id));
            *answer += &begun(started, id);
        }
        "received" => client.received(now, &words.octets(), on_event),
        "transferred" => client.transferred(now, Some(&words.octets()), on_event),
        "failed" => client.transferred(now, None, on_event),
        "packet" => client.packet(now, &packet(words)?, on_event),
        "cancel" => client.cancel(),
        _ => client.tick(now, on_event),
    }
    Ok(())
}

fn begun(started: Result<Started, Error>, id: u8) -> String {
    match started {
        Ok(Started::Waiting) => String::new(),
        Ok(Started::Sent) => format!(" sent id={id} attempts=1"),
        Err(error) => format!(" error error={}", explained(&error)),
    }
}

fn output(client: &mut Client<(), LONGEST>, bus: Bus, answer: &mut String) {
    match bus {
        Bus::Uart => {
            while let Some(piece) = client.output() {
                let _ = write!(answer, " stream bytes={}", hex(piece));
            }
        }
        Bus::Can => {
            while let Some(packet) = client.output_packet() {
                *answer += &shown_packet("frame", &packet);
            }
        }
        Bus::I2c => {
            while let Some(one) = client.output_transaction() {
                let _ = write!(
                    answer,
                    " transfer write={} read={}",
                    hex(one.write),
                    one.read
                );
            }
        }
    }
}

fn shown(event: &Event<'_>) -> String {
    let of = |name: &str, id: &u32| format!(" {name} id={id}");
    match event {
        Event::Done {
            id, attempts, data, ..
        } => format!(" done id={id} attempts={attempts} bytes={}", hex(data)),
        Event::Refused {
            id,
            attempts,
            code,
            reason,
            parameter,
        } => {
            let known = |key: &str, number: &Option<u32>| {
                number.map_or_else(String::new, |number| format!(" {key}={number}"))
            };
            let (code, parameter) = (known("code", code), known("parameter", parameter));
            let reason = reason.map_or("", |reason| match reason {
                Reason::NoError => " reason=none",
                Reason::UnknownId => " reason=unknown_id",
                Reason::Length => " reason=length",
                Reason::Parameter => " reason=parameter",
                Reason::Checksum => " reason=checksum",
            });
            format!(" refused id={id} attempts={attempts}{code}{reason}{parameter}")
        }
        Event::Sent { id, attempts } => format!(" sent id={id} attempts={attempts}"),
        Event::Timeout { id, attempts } => format!(" timeout id={id} attempts={attempts}"),
        Event::Arrived { id, data } => format!(" arrived id={id} bytes={}", hex(data)),
        Event::Log { message } => format!(" log bytes={}", hex(message)),
        Event::Late { id, data } => format!(" late id={id} bytes={}", hex(data)),
        Event::Stray { id, data } => {
            let id = id.map_or_else(String::new, |id| format!(" id={id}"));
            format!(" stray{id} bytes={}", hex(data))
        }
        Event::UnexpectedStart => " unexpected_start".into(),
        Event::ProtocolError => " protocol_error".into(),
        Event::Overrun => " overrun".into(),
        Event::Empty => " empty".into(),
        Event::Malformed { id } => of("malformed", id),
        Event::Length { id } => of("length", id),
        Event::Checksum { id } => of("checksum", id),
        Event::Unchecked { id } => of("unchecked", id),
        Event::Duplicate { id } => of("duplicate", id),
        Event::Incomplete { id } => of("incomplete", id),
        Event::Busy { id } => of("busy", id),
        Event::UnknownType { id } => of("unknown_type", id),
        _ => " other".into(),
    }
}
