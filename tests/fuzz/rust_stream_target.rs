//! cargo-fuzz harness on the decoders of framed links of the generated crate. See README.md.
#![no_main]

use icd::wire::link::Verdict;
use icd::wire::stream::{encode, encode_request, Answer, Decoder, Event, Sender};
use icd::wire::{Direction, Link};
use libfuzzer_sys::fuzz_target;

include!("links.rs");

const SEQUENCES: usize = 4;

/// Responds to an event in every way, with buffers of any size.
fn respond(link: &'static Link, event: &Event<'_>, number: usize) {
    let verdicts = [
        Verdict::Ack,
        Verdict::Reply,
        Verdict::Nak,
        Verdict::Busy,
        Verdict::Progress,
        Verdict::Again,
    ];
    let mut sender = Sender::<(), SEQUENCES>::with_direction(link, Direction::Telemetry).unwrap();
    let mut line = vec![0; number % (2 * LONGEST + 600)];
    for verdict in verdicts {
        let mut buffer = vec![0x5a; number % (LONGEST + 1)];
        let mut answer = Answer {
            verdict,
            reason: u32::try_from(number % 300)
                .ok()
                .filter(|reason| reason % 2 == 0),
            buffer: &mut buffer,
            length: number % 37,
        };
        if let Ok(size) = sender.respond(event, &mut answer, &mut line) {
            assert!(size <= line.len());
        }
    }
}

/// The events of a stream in pieces of `size` bytes, and what became of its other bytes.
fn heard(
    link: &'static Link,
    direction: Direction,
    stream: &[u8],
    size: usize,
    limit: usize,
) -> Option<(Vec<String>, u64, u64)> {
    let mut decoder = Decoder::<LONGEST, SEQUENCES>::with_limit(link, direction, limit).ok()?;
    let mut events = Vec::new();
    for piece in stream.chunks(size.max(1)) {
        decoder.feed(piece, |event| {
            let mut line = vec![0; 2 * LONGEST + 600];
            let written = match event {
                Event::Message {
                    id, data, values, ..
                } => {
                    assert!(data.len() <= limit);
                    encode(link, direction, id, data, values, &mut line)
                }
                Event::Request { id, values, .. } => encode_request(link, id, values, &mut line),
                _ => Ok(1),
            };
            assert!(written.unwrap() > 0);
            if direction == Direction::Telecommand {
                respond(link, &event, size.wrapping_mul(stream.len()));
            }
            events.push(format!("{event:?}"));
        });
    }
    assert!(decoder.discarded() + decoder.pending() <= stream.len() as u64);
    Some((events, decoder.discarded(), decoder.pending()))
}

fuzz_target!(|input: &[u8]| {
    let [node, direction, room, size, stream @ ..] = input else {
        return;
    };
    let Some(link) = link_of((*node).into()) else {
        return;
    };
    let Some(form) = link.stream.as_ref() else {
        return;
    };
    let direction = if direction & 1 == 0 {
        Direction::Telecommand
    } else {
        Direction::Telemetry
    };
    let around = form
        .packets
        .iter()
        .map(|packet| packet.header_bytes + packet.trailer_bytes)
        .max();
    let limit = link
        .longest
        .saturating_sub(usize::from(*room))
        .max(around.unwrap_or(0));
    let whole = heard(link, direction, stream, stream.len(), limit);
    if form.delimited_by != icd::wire::link::Delimiter::Datagram {
        assert_eq!(
            whole,
            heard(link, direction, stream, usize::from(*size), limit)
        );
        assert_eq!(whole, heard(link, direction, stream, 1, limit));
    }
});
