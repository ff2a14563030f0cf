//! Scripts for the client: what happens at which time, and what it does then.

use crate::line::{hex, Answer, Refusal, Words};
use crate::nodes::LONGEST;
use crate::stream::{chosen, SEQUENCES};
use crate::wire::{bus, explained, packet, shown_packet};
use icd::wire::{
    can, i2c, stream, uart, Bus, ByteLine, Client, Direction, Error, Event, Line, Link, NodeEvent,
    Request, Settings,
};
use std::fmt::Write;

type Hear<'a> = &'a mut dyn FnMut(NodeEvent<'_, ()>);

/// What a client does on its line.
trait Tested {
    /// What the client has to send.
    fn sent(&mut self) -> Result<String, Refusal>;

    /// What arrives: `received`, `packet`, `transferred` or `failed`.
    fn arrives(
        &mut self,
        now: u32,
        action: &str,
        words: &mut Words,
        hear: Hear,
    ) -> Result<(), Refusal>;
}

fn sent_bytes<L: ByteLine, const R: usize>(client: &mut Client<(), L, R>) -> Answer {
    let (mut sent, mut room) = (String::new(), vec![0; 2 * LONGEST + 8]);
    while let Some(bytes) = client.output(&mut room)? {
        let _ = write!(sent, " stream bytes={}", hex(bytes));
    }
    Ok(sent)
}

impl<const R: usize> Tested for Client<(), uart::Line<LONGEST>, R> {
    fn sent(&mut self) -> Result<String, Refusal> {
        sent_bytes(self)
    }

    fn arrives(&mut self, now: u32, _: &str, words: &mut Words, hear: Hear) -> Result<(), Refusal> {
        self.received(now, &words.octets(), hear);
        Ok(())
    }
}

impl<const R: usize> Tested for Client<(), stream::Line<LONGEST, SEQUENCES>, R> {
    fn sent(&mut self) -> Result<String, Refusal> {
        sent_bytes(self)
    }

    fn arrives(&mut self, now: u32, _: &str, words: &mut Words, hear: Hear) -> Result<(), Refusal> {
        self.received(now, &words.octets(), hear);
        Ok(())
    }
}

impl<const R: usize> Tested for Client<(), can::Line<LONGEST>, R> {
    fn sent(&mut self) -> Result<String, Refusal> {
        let mut sent = String::new();
        while let Some(packet) = self.output_packet() {
            sent += &shown_packet("frame", &packet);
        }
        Ok(sent)
    }

    fn arrives(&mut self, now: u32, _: &str, words: &mut Words, hear: Hear) -> Result<(), Refusal> {
        self.packet(now, &packet(words)?, hear);
        Ok(())
    }
}

impl<const R: usize> Tested for Client<(), i2c::Line<LONGEST>, R> {
    fn sent(&mut self) -> Result<String, Refusal> {
        let mut sent = String::new();
        while let Some(one) = self.output_transaction() {
            let (write, read) = (hex(one.write), one.read);
            let _ = write!(sent, " transfer write={write} read={read}");
        }
        Ok(sent)
    }

    fn arrives(
        &mut self,
        now: u32,
        action: &str,
        words: &mut Words,
        hear: Hear,
    ) -> Result<(), Refusal> {
        let bytes = (action == "transferred").then(|| words.octets());
        self.transferred(now, bytes.as_deref(), hear);
        Ok(())
    }
}

/// A client on a bus, of one request at a time.
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
    match bus {
        Bus::Uart => {
            let client = Client::<(), uart::Line<LONGEST>, 1>::uart(link)?;
            let client = if checked {
                client.with_checksums()
            } else {
                client
            };
            on_bus(client.with_settings(settings), bus, words)
        }
        Bus::I2c => {
            let client = Client::<(), i2c::Line<LONGEST>, 1>::i2c(link)?;
            let client = if checked {
                client.with_checksums()
            } else {
                client
            };
            on_bus(client.with_settings(settings), bus, words)
        }
        Bus::Can => {
            let client = Client::<(), can::Line<LONGEST>, 1>::can(link, address)?;
            let client = if checked {
                client.with_checksums()
            } else {
                client
            };
            on_bus(client.with_settings(settings), bus, words)
        }
    }
}

fn on_bus<L: Line>(mut client: Client<(), L, 1>, bus: Bus, words: &mut Words) -> Answer
where
    Client<(), L, 1>: Tested,
{
    let mut answer = String::new();
    while words.more() {
        let (now, action) = (words.number(), words.word());
        answer += " step";
        let mut sent = String::new();
        if matches!(action, "received" | "packet") {
            // What a time-out sends again is sent before this arrives.
            client.tick(now, |event| answer += &shown(&event, Some(bus)));
            sent = client.sent()?;
        }
        happen(&mut client, now, action, words, Some(bus), &mut answer)?;
        sent += &client.sent()?;
        answer += &sent;
        if !sent.is_empty() && client.deadline() == Some(now) {
            // Nothing responds to it.
            client.tick(now, |event| answer += &shown(&event, Some(bus)));
        }
        if let Some(deadline) = client.deadline() {
            let _ = write!(answer, " until deadline={deadline}");
        }
    }
    Ok(answer)
}

/// A client of a framed link.
pub fn stream_client(link: &'static Link, words: &mut Words) -> Answer {
    match words.number() {
        1 => framed::<1>(link, words),
        2 => framed::<2>(link, words),
        _ => framed::<3>(link, words),
    }
}

fn framed<const R: usize>(link: &'static Link, words: &mut Words) -> Answer {
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
    let client = Client::<(), stream::Line<LONGEST, SEQUENCES>, R>::new(link)?;
    let mut client = client.with_settings(settings);
    let mut answer = String::new();
    while words.more() {
        let (now, takes, action) = (words.number(), words.flag(), words.word());
        answer += " step";
        happen(&mut client, now, action, words, None, &mut answer)?;
        if takes {
            answer += &client.sent()?;
        }
        if let Some(deadline) = client.deadline() {
            let _ = write!(answer, " until deadline={deadline}");
        }
    }
    Ok(answer)
}

/// Does what a script says. `bus`: None on a framed link.
fn happen<L: Line, const R: usize>(
    client: &mut Client<(), L, R>,
    now: u32,
    action: &str,
    words: &mut Words,
    bus: Option<Bus>,
    answer: &mut String,
) -> Result<(), Refusal>
where
    Client<(), L, R>: Tested,
{
    let mut hear = |event: NodeEvent<'_, ()>| *answer += &shown(&event, bus);
    match action {
        "telecommand" => {
            let (id, repeat) = (words.number(), words.flag());
            let is_named = bus.is_none() && words.flag();
            let reply = if bus.is_none() { words.maybe() } else { None };
            let data = words.octets();
            let request = Request {
                repeat,
                reply: reply.filter(|_| is_named),
                ..Request::telecommand(id, &data)
            };
            *answer += &begun(client.start(now, &request));
        }
        "telemetry" => {
            let request = Request::telemetry(words.number());
            *answer += &begun(client.start(now, &request));
        }
        "cancel" if bus.is_some() => client.cancel(),
        "cancel" => match words.word() {
            "telecommand" => client.cancel_request(Direction::Telecommand, words.number()),
            "telemetry" => client.cancel_request(Direction::Telemetry, words.number()),
            _ => client.cancel(),
        },
        "received" | "packet" | "transferred" | "failed" => {
            client.arrives(now, action, words, &mut hear)?;
        }
        _ => client.tick(now, hear),
    }
    Ok(())
}

fn begun(started: Result<(), Error>) -> String {
    match started {
        Ok(()) => String::new(),
        Err(error) => format!(" error error={}", explained(&error)),
    }
}

fn known(key: &str, number: Option<u32>) -> String {
    number.map_or_else(String::new, |number| format!(" {key}={number}"))
}

/// What the vectors say of an event. `bus`: None on a framed link.
fn shown(event: &Event<'_>, bus: Option<Bus>) -> String {
    let of = |name: &str, id: u32| format!(" {name} id={id}");
    match *event {
        Event::Done {
            id,
            attempts,
            reply,
            packet,
            data,
            ..
        } => {
            let is_named = bus.is_none() && packet.is_none();
            let reply = known("reply", Some(reply).filter(|_| is_named));
            format!(
                " done id={id} attempts={attempts}{reply} bytes={}",
                hex(data)
            )
        }
        Event::Refused {
            id,
            attempts,
            code,
            may_be_damaged,
            detail,
            ..
        } => {
            let (code, detail) = (known("code", code), known("parameter", detail));
            let damaged = if may_be_damaged {
                " may_be_damaged=1"
            } else {
                ""
            };
            format!(" refused id={id} attempts={attempts}{code}{detail}{damaged}")
        }
        Event::Busy {
            id, attempts, code, ..
        } => format!(" busy id={id} attempts={attempts}{}", known("code", code)),
        Event::Sent { id, attempts, .. } => format!(" sent id={id} attempts={attempts}"),
        Event::Timeout { id, attempts, .. } => format!(" timeout id={id} attempts={attempts}"),
        Event::Progress { id, data, .. } => format!(" progress id={id} bytes={}", hex(data)),
        Event::Reply {
            id, reply, data, ..
        } => format!(" reply id={id} reply={reply} bytes={}", hex(data)),
        Event::Arrived { id, data, values } => {
            let name = if bus.is_some() { "arrived" } else { "message" };
            format!(" {name} id={id} bytes={}{}", hex(data), chosen(values))
        }
        Event::Log { message } => format!(" log bytes={}", hex(message)),
        Event::Late { id, data, .. } => format!(" late id={id} bytes={}", hex(data)),
        Event::Stray { id, data, .. } => format!(" stray{} bytes={}", known("id", id), hex(data)),
        Event::Gap { id, missing } => format!(" gap id={id} missing={missing}"),
        Event::UnexpectedStart => " unexpected_start".into(),
        Event::ProtocolError => " protocol_error".into(),
        Event::Overrun => " overrun".into(),
        Event::Framing => " framing".into(),
        Event::Empty => " empty".into(),
        Event::Length { id } => format!(" length{}", known("id", id)),
        Event::Checksum { id } => of("checksum", id),
        Event::Unchecked { id } => of("unchecked", id),
        Event::UnknownId { id } => of("unknown_id", id),
        Event::Malformed { id } => of("malformed", id),
        Event::Duplicate { id } => of("duplicate", id),
        Event::Incomplete { id } => of("incomplete", id),
        Event::Dropped { id } => of("busy", id),
        Event::UnknownType { id } => of("unknown_type", id),
        _ => " other".into(),
    }
}
