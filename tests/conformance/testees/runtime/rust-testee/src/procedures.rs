//! Scripts for procedures of the ICD: what happens at which time, and what they do then.

use crate::line::{hex, list, Answer, Refusal, Words};
use crate::nodes;
use crate::wire::bus;
use icd::wire::procedure::{End, Outcome, Procedure, Sink};
use icd::wire::{Bus, Direction};
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
    procedure.set_bus(bus);
    if let Some(block) = block {
        procedure.set_block(block);
    }
    let mut answer = String::new();
    // Packets with header and trailer have a checksum: no refusal is damaged.
    let has_stream = nodes::link(node).map_or(false, |link| link.stream.is_some());
    while words.more() {
        step(&mut procedure, has_stream, words, &mut answer);
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

fn step<S: Sink>(
    procedure: &mut Procedure<'_, S>,
    has_stream: bool,
    words: &mut Words,
    answer: &mut String,
) {
    let now = words.number();
    let data;
    let event = match words.word() {
        "done" => {
            data = words.octets();
            Outcome::Done(&data)
        }
        "arrived" => {
            let id = words.number();
            data = words.octets();
            Outcome::Arrived { id, data: &data }
        }
        "sent" => Outcome::Done(&[]),
        "busy" => Outcome::Busy,
        "timeout" => Outcome::Timeout,
        name @ ("refused" | "damaged") => Outcome::Refused {
            may_be_damaged: name == "damaged" && !has_stream,
        },
        _ => Outcome::Unrelated,
    };
    procedure.event(now, event);
    *answer += " step";
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
