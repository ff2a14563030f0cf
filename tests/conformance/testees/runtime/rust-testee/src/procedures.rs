//! Scripts for procedures of the ICD: what happens at which time, and what they do then.

use crate::line::{hex, list, Answer, Refusal, Words};
use crate::nodes;
use crate::wire::bus;
use icd::wire::procedure::{End, Procedure, Sink};
use icd::wire::stream::Values;
use icd::wire::{Bus, Direction, Event};
use std::fmt::Write;

/// What a procedure delivered.
#[derive(Default)]
struct Delivered(String);

impl Sink for &mut Delivered {
    fn block(&mut self, offset: u32, data: &[u8]) {
        let _ = write!(self.0, " block offset={offset} bytes={}", hex(data));
    }

    fn entry(&mut self, frame: &[u8]) {
        let _ = write!(self.0, " entry bytes={}", hex(frame));
    }
}

pub fn procedure(node: usize, words: &mut Words) -> Answer {
    let forms = nodes::procedures(node);
    let unsupported = || Refusal("unsupported".into());
    let form = *forms.get(words.number::<usize>()).ok_or_else(unsupported)?;
    let (bus, block, bytes): (Bus, Option<u32>, _) = (bus(words), words.maybe(), words.octets());
    let inputs: Vec<Option<u32>> = (0..words.number()).map(|_| words.maybe()).collect();
    let size = form.blocks.map_or(0, |blocks| blocks.size as usize);
    let (mut memory, mut delivered) = (vec![0; 2 * size + 1], Delivered::default());
    let mut procedure = Procedure::new(form, &inputs, &bytes, &mut memory, &mut delivered)?;
    let is_framed = nodes::link(node).map_or(false, |link| link.stream.is_some());
    procedure.set_bus(Some(bus).filter(|_| !is_framed));
    if let Some(block) = block {
        procedure.set_block(block);
    }
    let mut answer = String::new();
    let mut asked = (Direction::Telecommand, 0);
    while words.more() {
        step(&mut procedure, &mut asked, words, &mut answer);
    }
    if form.blocks.map_or(false, |blocks| blocks.sends) {
        let (sent, _) = procedure.progress();
        let _ = write!(answer, " ok sent={sent}");
    }
    let outputs = form
        .outputs
        .iter()
        .map(|(_, register)| procedure.output(*register));
    let outputs: Option<Vec<u32>> = outputs.collect();
    if let Some(outputs) = outputs.filter(|known| !known.is_empty()) {
        let outputs = list(outputs.iter().map(u32::to_string));
        let _ = write!(answer, " ok outputs={outputs}");
    }
    Ok(answer + &delivered.0)
}

/// `asked`: direction and id of the last request.
fn step<S: Sink>(
    procedure: &mut Procedure<'_, S>,
    asked: &mut (Direction, u32),
    words: &mut Words,
    answer: &mut String,
) {
    let (now, (direction, id), attempts) = (words.number(), *asked, 1);
    let (data, values) = (&mut Vec::new(), &Values::default());
    let event = match words.word() {
        "done" => {
            *data = words.octets();
            Event::Done {
                direction,
                id,
                attempts,
                reply: id,
                packet: None,
                data,
                values,
            }
        }
        "arrived" => {
            let id = words.number();
            *data = words.octets();
            Event::Arrived { id, data, values }
        }
        "sent" => Event::Sent {
            direction,
            id,
            attempts,
        },
        "busy" => Event::Busy {
            direction,
            id,
            attempts,
            code: None,
            reply: 0,
            packet: None,
            data,
        },
        "timeout" => Event::Timeout {
            direction,
            id,
            attempts,
        },
        name @ ("refused" | "damaged") => Event::Refused {
            direction,
            id,
            attempts,
            code: Some(1),
            may_be_damaged: name == "damaged",
            detail: None,
            reply: 0,
            packet: None,
            data,
        },
        _ => Event::Empty,
    };
    procedure.event(now, &event);
    *answer += " step";
    if let Some(request) = procedure.next(now) {
        *asked = (request.direction, request.id);
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
    *answer += procedure.result().map_or("", |end| match end {
        End::Done => " result=done",
        End::Refused => " result=refused",
        End::Busy => " result=busy",
        End::Timeout => " result=timeout",
        End::Failed => " result=failed",
        End::Length => " result=length",
        End::Checksum => " result=checksum",
        End::Rounds => " result=rounds",
        End::Limit => " result=limit",
    });
}
