//! Requests about logs, times, hole maps and the index file.

use crate::ask::{any, hex_rows, mappings, number, octets, rows};
use crate::json::{hex, Json};
use crate::nodes::LONGEST;
use crate::subject::Refusal;
use crate::wire::{list, unnamed};
use icd::wire::files::{HoleMap, IndexEntries, IndexEntry};
use icd::wire::{log, DosTime, Link};

fn log_frame(frame: log::Frame<'_>) -> String {
    let id = frame.id.map_or_else(|| "null".into(), |id| id.to_string());
    let (bit, bytes) = (frame.bit, hex(frame.data));
    format!("{{\"bit\": {bit}, \"id\": {id}, \"bytes\": \"{bytes}\"}}")
}

pub fn log_decode(link: &'static Link, request: &Json) -> Result<String, Refusal> {
    let data = octets(request, "bytes")?;
    let mut answers = Vec::new();
    // Whole, byte by byte and in pieces of seven bytes it must be the same.
    for size in [data.len().max(1), 1, 7] {
        let mut reader = log::Reader::<LONGEST>::new(link)?;
        let mut entries = Vec::new();
        for piece in data.chunks(size) {
            reader.feed(piece, |entry| {
                entries.push(format!(
                    "{{\"seconds\": {}, \"milliseconds\": {}, \"frames\": {}}}",
                    entry.seconds,
                    entry.milliseconds,
                    list(entry.frames().map(log_frame))
                ));
            });
        }
        let mask = reader.mask();
        let mask = mask.map_or_else(|| "null".into(), |mask| format!("\"{}\"", hex(mask)));
        let (entries, truncated) = (list(entries), reader.truncated());
        answers.push(format!(
            "\"mask\": {mask}, \"entries\": {entries}, \"truncated\": {truncated}"
        ));
    }
    if answers.windows(2).any(|pair| pair[0] != pair[1]) {
        return Err(Refusal::Dispatcher);
    }
    answers.pop().ok_or(Refusal::Request)
}

pub fn log_encode(link: &'static Link, request: &Json) -> Result<String, Refusal> {
    let mut entries = Vec::new();
    for row in mappings(request, "entries")? {
        let milliseconds = number(row, "milliseconds", 0, 65_535, None)?;
        entries.push((any(row, "seconds")?, milliseconds, hex_rows(row, "frames")?));
    }
    let mask = octets(request, "mask")?;
    let writer = log::Writer::new(link, &mask)?;
    let mut out = vec![0; LONGEST];
    let size = writer.header(&mut out)?;
    let mut file = hex(&out[..size]);
    for (seconds, milliseconds, frames) in entries {
        let frames: Vec<&[u8]> = frames.iter().map(Vec::as_slice).collect();
        let times = (seconds.into(), milliseconds.into());
        let size = writer
            .entry(times.0, times.1, &frames, &mut out)
            .map_err(unnamed)?;
        file += &hex(&out[..size]);
    }
    Ok(format!("\"bytes\": \"{file}\""))
}

pub fn log_message_decode(link: &'static Link, request: &Json) -> Result<String, Refusal> {
    let bytes = octets(request, "bytes")?;
    let message = log::Message::decode(link, &bytes)?;
    let (mask, frames) = (hex(message.mask()), list(message.frames().map(log_frame)));
    Ok(format!("\"mask\": \"{mask}\", \"frames\": {frames}"))
}

pub fn log_message_encode(link: &'static Link, request: &Json) -> Result<String, Refusal> {
    let frames = hex_rows(request, "frames")?;
    let frames: Vec<&[u8]> = frames.iter().map(Vec::as_slice).collect();
    let mut out = vec![0; LONGEST];
    let mask = octets(request, "mask")?;
    let size = log::Message::encode(link, &mask, &frames, &mut out)?;
    Ok(format!("\"bytes\": \"{}\"", hex(&out[..size])))
}

pub fn dos_time(link: &'static Link, request: &Json) -> Result<String, Refusal> {
    if request.get("value").is_some() {
        let time = DosTime::unpack(link, any(request, "value")?)?;
        return Ok(format!(
            "\"year\": {}, \"month\": {}, \"day\": {}, \"hour\": {}, \"minute\": {}, \"second\": {}, \"valid\": {}",
            time.year,
            time.month,
            time.day,
            time.hour,
            time.minute,
            time.second,
            time.is_valid()
        ));
    }
    let part = |key| number(request, key, 0, 9999, None);
    let time = DosTime {
        year: part("year")?,
        month: part("month")?,
        day: part("day")?,
        hour: part("hour")?,
        minute: part("minute")?,
        second: part("second")?,
    };
    Ok(format!("\"value\": {}", time.pack(link)?))
}

pub fn hole_map(link: &'static Link, request: &Json) -> Result<String, Refusal> {
    let packets = any(request, "packets")?;
    let packets = usize::try_from(packets).map_err(|_| Refusal::Request)?;
    let missing = |map: &HoleMap| list(map.missing().map(|number| number.to_string()));
    if request.get("bytes").is_some() {
        let bytes = octets(request, "bytes")?;
        let map = HoleMap::from_bytes(link, packets, &bytes).map_err(unnamed)?;
        return Ok(format!("\"missing\": {}", missing(&map)));
    }
    let received = rows(request, "received")?;
    if !received
        .iter()
        .all(|one| matches!(one, Json::Integer(_) | Json::Huge))
    {
        return Err(Refusal::Request);
    }
    let mut map = HoleMap::new(link, packets).map_err(unnamed)?;
    for one in received {
        let number = match one {
            Json::Integer(number) => u32::try_from(*number).ok(),
            _ => None,
        };
        map.set(number.unwrap_or(u32::MAX)).map_err(unnamed)?;
    }
    let pieces = list(map.messages().map(|piece| format!("\"{}\"", hex(piece))));
    Ok(format!(
        "\"bytes\": \"{}\", \"messages\": {pieces}, \"missing\": {}",
        hex(map.as_bytes()),
        missing(&map)
    ))
}

pub fn index_decode(link: &'static Link, request: &Json) -> Result<String, Refusal> {
    let bytes = octets(request, "bytes")?;
    let entries = IndexEntries::new(link, &bytes)?;
    let truncated = entries.truncated();
    let entries = entries.map(|entry| {
        format!(
            "{{\"type\": {}, \"counter\": {}, \"checksum\": {}, \"size\": {}, \"time\": {}, \"meta\": \"{}\"}}",
            entry.kind,
            entry.counter,
            entry.checksum,
            entry.size,
            entry.time,
            hex(entry.meta)
        )
    });
    Ok(format!(
        "\"entries\": {}, \"truncated\": {truncated}",
        list(entries)
    ))
}

pub fn index_encode(link: &'static Link, request: &Json) -> Result<String, Refusal> {
    let mut entries = Vec::new();
    for row in mappings(request, "entries")? {
        let meta = octets(row, "meta")?;
        let part = |key| any(row, key);
        let times = (part("size")?, part("time")?);
        entries.push((
            part("type")?,
            part("counter")?,
            part("checksum")?,
            times,
            meta,
        ));
    }
    let mut file = String::new();
    let mut out = vec![0; 4096];
    for (kind, counter, checksum, (size, time), meta) in &entries {
        let entry = IndexEntry {
            kind: *kind,
            counter: *counter,
            checksum: *checksum,
            size: *size,
            time: *time,
            meta,
        };
        let size = entry.encode(link, &mut out).map_err(unnamed)?;
        file += &hex(&out[..size]);
    }
    Ok(format!("\"bytes\": \"{file}\""))
}
