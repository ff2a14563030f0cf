//! Scripts for the procedures of file transfer.

use crate::ask::{any, byte, flag, mappings, number, octets, text};
use crate::client::bus;
use crate::json::{hex, Json};
use crate::subject::Refusal;
use crate::wire::{list, unnamed};
use icd::wire::files::{
    Download, End, Erase, Format, List, Procedure, ProgramCopy, ProgramInformation, Upload,
};
use icd::wire::{Direction, Event, Link, Request};

pub fn answer(link: &'static Link, request: &Json) -> Result<String, Refusal> {
    let what = text(request, "do")?;
    let block = match request.get("block") {
        Some(_) => number(request, "block", 1, u32::MAX, None)?,
        None => u32::MAX,
    };
    match what {
        "list" => {
            let mut entries = Vec::new();
            let mut procedure = List::new(link, |entry| {
                entries.push(format!(
                    "{{\"type\": {}, \"counter\": {}, \"size\": {}, \"time\": {}, \"checksum\": {}}}",
                    entry.kind, entry.counter, entry.size, entry.time, entry.checksum
                ));
            })?;
            let steps = drive(&mut procedure, request)?;
            Ok(format!("{steps}, \"entries\": {}", list(entries)))
        }
        "download" => {
            let bus = bus(request)?;
            let size = match request.get("size") {
                Some(_) => Some(any(request, "size")?),
                None => None,
            };
            let file = (byte(request, "type")?, byte(request, "counter")?);
            let mut buffer = vec![0; link.files.map_or(0, |files| files.block_bytes)];
            let mut blocks = Vec::new();
            let on_block = |offset, block: &[u8]| {
                blocks.push(format!(
                    "{{\"offset\": {offset}, \"bytes\": \"{}\"}}",
                    hex(block)
                ));
            };
            let download = Download::new(link, bus, file, size, &mut buffer, on_block)?;
            let steps = drive(&mut download.with_block(block), request)?;
            Ok(format!("{steps}, \"blocks\": {}", list(blocks)))
        }
        "upload" => {
            let destination = byte(request, "destination")?;
            let times = number(request, "times", 1, 1 << 20, Some(1))?;
            let data = octets(request, "bytes")?.repeat(times as usize);
            let mut upload = Upload::new(link, destination, &data)
                .map_err(unnamed)?
                .with_block(block);
            let steps = drive(&mut upload, request)?;
            let (sent, _) = upload.progress();
            Ok(format!("{steps}, \"sent\": {sent}"))
        }
        "erase" => {
            let file = (byte(request, "type")?, byte(request, "counter")?);
            let all = flag(request, "all")?;
            drive(&mut Erase::new(link, file.0, file.1, all)?, request)
        }
        "format" => drive(&mut Format::new(link)?, request),
        "program_copy" => {
            let program = byte(request, "program")?;
            drive(
                &mut ProgramCopy::new(link, program).map_err(unnamed)?,
                request,
            )
        }
        "program_information" => {
            let program = byte(request, "program")?;
            let mut information = ProgramInformation::new(link, program).map_err(unnamed)?;
            let steps = drive(&mut information, request)?;
            let (size, checksum) = (told(information.size()), told(information.checksum()));
            Ok(format!(
                "{steps}, \"size\": {size}, \"checksum\": {checksum}"
            ))
        }
        _ => Err(Refusal::Request),
    }
}

fn told(number: Option<u32>) -> String {
    number.map_or_else(|| "null".into(), |one| one.to_string())
}

fn drive(procedure: &mut dyn Procedure, request: &Json) -> Result<String, Refusal> {
    let mut steps = Vec::new();
    for row in mappings(request, "script")? {
        let now = any(row, "at")?;
        match row.get("event") {
            None | Some(Json::Null) => {}
            Some(event @ Json::Map(_)) => happen(procedure, now, event)?,
            Some(_) => return Err(Refusal::Request),
        }
        let asked = procedure
            .next(now)
            .map_or_else(|| "null".into(), |one| shown(&one));
        let deadline = procedure.deadline();
        let deadline = deadline.map_or_else(|| "null".into(), |at| at.to_string());
        let result = procedure.result().map_or("null", |end| match end {
            End::Done => "\"done\"",
            End::Refused => "\"refused\"",
            End::Timeout => "\"timeout\"",
            End::Parameter => "\"parameter\"",
            End::Length => "\"length\"",
            End::Rounds => "\"rounds\"",
            End::Checksum => "\"checksum\"",
            End::Error => "\"error\"",
        });
        steps.push(format!(
            "{{\"request\": {asked}, \"deadline\": {deadline}, \"result\": {result}}}"
        ));
    }
    Ok(format!("\"steps\": {}", list(steps)))
}

fn happen(procedure: &mut dyn Procedure, now: u32, event: &Json) -> Result<(), Refusal> {
    let (id, attempts, nodes) = (0, 1, &[]);
    match text(event, "event")? {
        "done" => {
            let data = &octets(event, "bytes")?;
            let done = Event::Done {
                id,
                attempts,
                data,
                nodes,
            };
            procedure.event(now, &done);
        }
        "packet" => {
            let number = number(event, "number", 0, 65_535, None)?;
            let data = &octets(event, "bytes")?;
            procedure.event(now, &Event::Packet { number, data });
        }
        "timeout" => procedure.event(now, &Event::Timeout { id, attempts }),
        "refused" => procedure.event(
            now,
            &Event::Refused {
                id,
                attempts,
                code: None,
                reason: None,
                parameter: None,
            },
        ),
        _ => return Err(Refusal::Request),
    }
    Ok(())
}

fn shown(request: &Request<'_>) -> String {
    let (id, bytes, repeat) = (request.id, hex(request.data), request.repeat);
    match request.direction {
        Direction::Telemetry => format!("{{\"telemetry\": {id}}}"),
        Direction::Telecommand => {
            format!("{{\"telecommand\": {id}, \"bytes\": \"{bytes}\", \"repeat\": {repeat}}}")
        }
    }
}
