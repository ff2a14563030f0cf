//! cargo-fuzz harness on the stream decoders of the generated crate, and on the client that hears them. See README.md.
#![no_main]

use icd::wire::can::{Joiner, Packet};
use icd::wire::files::IndexEntries;
use icd::wire::{log, uart, Client, Event, Link, Request};
use libfuzzer_sys::fuzz_target;

include!("links.rs");

const SMALL: usize = 4;

/// The events of a stream in pieces of `size` bytes.
fn heard(link: &'static Link, stream: &[u8], size: usize, limit: usize) -> (Vec<String>, u64, u64) {
    let mut decoder = match uart::Decoder::<LONGEST>::with_limit(link, limit) {
        Ok(decoder) => decoder,
        Err(_) => return (Vec::new(), 0, 0),
    };
    let (mut events, mut line) = (Vec::new(), 0);
    for piece in stream.chunks(size) {
        decoder.feed(piece, |event| {
            if let uart::Event::Message(message) = event {
                assert!(!message.is_empty() && message.len() <= limit);
                let mut out = vec![0; message.len() * 2 + 4];
                line += uart::encode(link, message, &mut out).unwrap() as u64;
                let _ = uart::kind(link, message);
            }
            events.push(format!("{event:?}"));
        });
    }
    if !link.framing.map_or(false, |framing| framing.ignores_other) {
        assert_eq!(decoder.discarded() + decoder.pending() + line, stream.len() as u64);
    }
    (events, decoder.discarded(), decoder.pending())
}

fn streams(link: &'static Link, size: usize, data: &[u8]) {
    for limit in [link.longest, SMALL] {
        let whole = heard(link, data, data.len().max(1), limit);
        assert_eq!(whole, heard(link, data, size, limit));
        assert_eq!(whole, heard(link, data, 1, limit));
    }
    if !data.is_empty() {
        let mut line = vec![0; data.len() * 2 + 4];
        if let Ok(count) = uart::encode(link, data, &mut line) {
            let (events, discarded, pending) = heard(link, &line[..count], size, LONGEST);
            let wanted = if data.len() <= LONGEST { format!("{:?}", uart::Event::Message(data)) } else { "Overrun".into() };
            assert_eq!(events.first(), Some(&wanted));
            assert!(data.len() > LONGEST || (discarded, pending) == (0, 0));
        }
    }
}

fn packets(link: &'static Link, data: &[u8]) {
    let (mut now, mut messages) = (0_u32, 0);
    if let Ok(mut joiner) = Joiner::<LONGEST, 3>::new(link, None) {
        let rows: Vec<_> = data.chunks(14).collect();
        for row in &rows {
            if let [a, b, c, d, wait, rest @ ..] = row {
                now = now.wrapping_add(u32::from(*wait) * 8);
                let id = u32::from_be_bytes([a & 0x1f, *b, *c, *d]);
                if let Some(packet) = Packet::new(id, &rest[..rest.len().min(8)]) {
                    joiner.feed(now, &packet, |event| messages += usize::from(format!("{event:?}").starts_with("Message")));
                }
            }
        }
        assert!(messages <= rows.len());
        joiner.expire(now.wrapping_add(1 << 30), |_| {});
    }
}

fn logs(link: &'static Link, size: usize, data: &[u8]) {
    let read = |size: usize| {
        let mut reader = log::Reader::<LONGEST>::new(link).ok()?;
        let (mut entries, mut bytes) = (Vec::new(), 0);
        for piece in data.chunks(size) {
            reader.feed(piece, |entry| {
                let frames: Vec<_> = entry.frames().map(|one| format!("{one:?}")).collect();
                bytes += 1;
                entries.push((entry.seconds, entry.milliseconds, frames));
            });
        }
        assert!(reader.truncated() <= data.len() && bytes <= data.len());
        Some((entries, reader.truncated(), reader.mask().map(<[u8]>::to_vec)))
    };
    assert_eq!(read(data.len().max(1)), read(size));
    if let Ok(message) = log::Message::decode(link, data) {
        let frames: Vec<&[u8]> = message.frames().map(|frame| frame.data).collect();
        let mut out = vec![0; data.len()];
        let count = log::Message::encode(link, message.mask(), &frames, &mut out).unwrap();
        assert_eq!(count, data.len());
        assert_eq!(log::Message::decode(link, &out).unwrap().frames().collect::<Vec<_>>(), message.frames().collect::<Vec<_>>());
    }
    if let Ok(entries) = IndexEntries::new(link, data) {
        assert!(entries.count() <= data.len());
    }
}

/// A request and what is heard afterwards: it ends in at most one of the outcomes, and some time it does.
fn client(link: &'static Link, size: usize, id: u8, data: &[u8]) {
    let mut client = match Client::<LONGEST>::uart(link) {
        Ok(client) => client.with_checksums(),
        Err(_) => return,
    };
    let mut ends = 0;
    let mut now = u32::MAX - 1000;
    if client.start(now, &Request::telemetry(id)).is_err() {
        return;
    }
    let mut count = |event: Event<'_>| {
        ends += usize::from(matches!(event, Event::Done { .. } | Event::Sent { .. } | Event::Refused { .. } | Event::Timeout { .. }));
    };
    for piece in data.chunks(size) {
        now = now.wrapping_add(100);
        while client.output().is_some() {}
        client.received(now, piece, &mut count);
    }
    for _ in 0..20 {
        if let Some(at) = client.deadline() {
            client.tick(at, &mut count);
        }
        while client.output().is_some() {}
    }
    assert_eq!((ends, client.deadline()), (1, None));
}

fuzz_target!(|input: &[u8]| {
    let [node, part, size, id, data @ ..] = input else { return };
    let Some(link) = link_of((*node).into()) else { return };
    let size = usize::from(*size).max(1);
    match part % 4 {
        0 => streams(link, size, data),
        1 => packets(link, data),
        2 => logs(link, size, data),
        _ => client(link, size, *id, data),
    }
});
