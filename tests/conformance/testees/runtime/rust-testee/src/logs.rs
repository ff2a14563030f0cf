//! Requests about logs.

use crate::line::{hex, Answer, Words};
use crate::nodes::LONGEST;
use icd::wire::{log, Link};
use std::fmt::Write;

fn frame(one: log::Frame<'_>) -> String {
    let id = one.id.map_or_else(String::new, |id| id.to_string());
    format!(" frame bit={} id={id} bytes={}", one.bit, hex(one.data))
}

pub fn log_decode(link: &'static Link, words: &mut Words) -> Answer {
    let mut reader = log::Reader::<LONGEST>::new(link)?;
    let mut answer = String::new();
    while words.more() {
        reader.feed(&words.octets(), |entry| {
            let (seconds, part) = (entry.seconds, entry.milliseconds);
            let _ = write!(answer, " entry seconds={seconds} milliseconds={part}");
            answer.extend(entry.frames().map(frame));
        });
    }
    let _ = write!(answer, " ok truncated={}", reader.truncated());
    if let Some(mask) = reader.mask() {
        let _ = write!(answer, " mask={}", hex(mask));
    }
    Ok(answer)
}

pub fn log_encode(link: &'static Link, words: &mut Words) -> Answer {
    let mask = words.octets();
    let writer = log::Writer::new(link, &mask)?;
    let mut out = vec![0; LONGEST];
    let size = writer.header(&mut out)?;
    let mut file = hex(&out[..size]);
    while words.more() {
        let (seconds, milliseconds, frames) = (words.number(), words.number(), words.counted());
        let frames: Vec<&[u8]> = frames.iter().map(Vec::as_slice).collect();
        let size = writer.entry(seconds, milliseconds, &frames, &mut out)?;
        file += &hex(&out[..size]);
    }
    Ok(format!(" bytes={file}"))
}

pub fn log_message_decode(link: &'static Link, words: &mut Words) -> Answer {
    let bytes = words.octets();
    let message = log::Message::decode(link, &bytes)?;
    let frames: String = message.frames().map(frame).collect();
    Ok(format!(" mask={}{frames}", hex(message.mask())))
}

pub fn log_message_encode(link: &'static Link, words: &mut Words) -> Answer {
    let (mask, frames) = (words.octets(), words.counted());
    let frames: Vec<&[u8]> = frames.iter().map(Vec::as_slice).collect();
    let mut out = vec![0; LONGEST];
    let size = log::Message::encode(link, &mask, &frames, &mut out)?;
    Ok(format!(" bytes={}", hex(&out[..size])))
}
