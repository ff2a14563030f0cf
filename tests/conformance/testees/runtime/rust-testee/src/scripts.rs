//! Scripts for the client and for the procedures: what happens at which time, and what they do then.

use crate::line::{hex, Answer, Refusal, Words};
use crate::nodes::LONGEST;
use crate::wire::{bus, explained, packet, shown_packet};
use icd::wire::files::{
    Download, End, Erase, Format, List, Procedure, ProgramCopy, ProgramInformation, Upload,
};
use icd::wire::{
    Bus, Client, Direction, Error, Event, Link, NodeEvent, Reason, Request, Settings, Started,
};
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
        Ok(Started::Done) => format!(" done id={id} attempts=1 bytes="),
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
        Event::Timeout { id, attempts } => format!(" timeout id={id} attempts={attempts}"),
        Event::Packet { number, data } => format!(" packet number={number} bytes={}", hex(data)),
        Event::Log { message } => format!(" log bytes={}", hex(message)),
        Event::Stray { id, data } => {
            let id = id.and_then(|id| u8::try_from(id).ok());
            let id = id.map_or_else(String::new, |id| hex(&[id]));
            format!(" stray bytes={id}{}", hex(data))
        }
        Event::UnexpectedStart => " unexpected_start".into(),
        Event::ProtocolError => " protocol_error".into(),
        Event::Overrun => " overrun".into(),
        Event::Empty => " empty".into(),
        Event::Malformed { id } => of("malformed", id),
        Event::Checksum { id } => of("checksum", id),
        Event::Unchecked { id } => of("unchecked", id),
        Event::Duplicate { id } => of("duplicate", id),
        Event::Incomplete { id } => of("incomplete", id),
        Event::Busy { id } => of("busy", id),
        Event::UnknownType { id } => of("unknown_type", id),
        _ => " other".into(),
    }
}

pub fn file(link: &'static Link, words: &mut Words) -> Answer {
    match words.word() {
        "list" => {
            let mut entries = String::new();
            let mut procedure = List::new(link, |one| {
                let (kind, counter, size) = (one.kind, one.counter, one.size);
                let (time, checksum) = (one.time, one.checksum);
                let _ = write!(entries, " entry type={kind} counter={counter} size={size}");
                let _ = write!(entries, " time={time} checksum={checksum}");
            })?;
            let steps = drive(&mut procedure, words);
            Ok(steps + &entries)
        }
        "download" => {
            let (bus, file) = (bus(words), (words.number(), words.number()));
            let (size, block) = (words.maybe(), words.maybe().unwrap_or(u32::MAX));
            let mut buffer = vec![0; link.files.map_or(0, |files| files.block_bytes)];
            let mut blocks = String::new();
            let on_block = |offset, block: &[u8]| {
                let _ = write!(blocks, " block offset={offset} bytes={}", hex(block));
            };
            let download = Download::new(link, bus, file, size, &mut buffer, on_block)?;
            let steps = drive(&mut download.with_block(block), words);
            Ok(steps + &blocks)
        }
        "upload" => {
            let (destination, block) = (words.number(), words.maybe().unwrap_or(u32::MAX));
            let data = words.octets();
            let mut upload = Upload::new(link, destination, &data)?.with_block(block);
            let steps = drive(&mut upload, words);
            let (sent, _) = upload.progress();
            Ok(format!("{steps} ok sent={sent}"))
        }
        "erase" => {
            let (file, all) = ((words.number(), words.number()), words.flag());
            let mut erase = Erase::new(link, file.0, file.1, all)?;
            Ok(drive(&mut erase, words))
        }
        "format" => Ok(drive(&mut Format::new(link)?, words)),
        "program_copy" => {
            let mut copy = ProgramCopy::new(link, words.number())?;
            Ok(drive(&mut copy, words))
        }
        _ => {
            let mut information = ProgramInformation::new(link, words.number())?;
            let mut answer = drive(&mut information, words) + " ok";
            for (key, told) in [
                ("size", information.size()),
                ("checksum", information.checksum()),
            ] {
                if let Some(number) = told {
                    let _ = write!(answer, " {key}={number}");
                }
            }
            Ok(answer)
        }
    }
}

fn drive(procedure: &mut dyn Procedure, words: &mut Words) -> String {
    let mut answer = String::new();
    while words.more() {
        let now = words.number();
        outcome(procedure, now, words);
        answer += " step";
        if let Some(request) = procedure.next(now) {
            let (id, bytes) = (request.id, hex(request.data));
            let repeat = u8::from(request.repeat);
            let _ = match request.direction {
                Direction::Telemetry => write!(answer, " telemetry={id}"),
                Direction::Telecommand => {
                    write!(answer, " telecommand={id} bytes={bytes} repeat={repeat}")
                }
            };
        }
        if let Some(deadline) = procedure.deadline() {
            let _ = write!(answer, " deadline={deadline}");
        }
        answer += procedure.result().map_or("", |end| match end {
            End::Done => " result=done",
            End::Refused => " result=refused",
            End::Timeout => " result=timeout",
            End::Parameter => " result=parameter",
            End::Length => " result=length",
            End::Limit => " result=limit",
            End::Rounds => " result=rounds",
            End::Checksum => " result=checksum",
            End::Error => " result=error",
        });
    }
    answer
}

fn outcome(procedure: &mut dyn Procedure, now: u32, words: &mut Words) {
    let (id, attempts) = (0, 1);
    match words.word() {
        "done" => {
            let data = &words.octets();
            let done = Event::Done { id, attempts, data };
            procedure.event(now, &done);
        }
        "packet" => {
            let (number, data) = (words.number(), &words.octets());
            procedure.event(now, &Event::Packet { number, data });
        }
        "timeout" => procedure.event(now, &Event::Timeout { id, attempts }),
        name @ ("refused" | "damaged") => {
            let refused = Event::Refused {
                id,
                attempts,
                code: (name == "damaged").then_some(255),
                reason: None,
                parameter: None,
            };
            procedure.event(now, &refused);
        }
        _ => {}
    }
}
