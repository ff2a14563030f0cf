//! A session whose port fails, requests that are given up, messages that nodes share; any surprise is a panic.

use icd::common::{Identification, Reset};
use icd::cubeacp::{ClearErrors, EstimatedAngularRates, EstimatedAttitudeAngles, LINK, LONGEST};
use icd::wire::{i2c, uart, Client, NodeLink, Session, TelecommandOf, TelemetryOf};
use icd::wire::session::Failure;
use std::cell::{Cell, RefCell};
use std::io::{self, ErrorKind, Read, Write};
use std::rc::Rc;

fn main() {
    failing();
    shared();
    late();
    cancelled();
}

/// A node that answers every request for telemetry with zeros and acknowledges the rest, over a line that fails on demand.
#[derive(Clone, Default)]
struct Line {
    fails: Rc<Cell<bool>>,
    answer: Rc<RefCell<Vec<u8>>>,
}

impl Read for Line {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.fails.get() {
            return Err(ErrorKind::BrokenPipe.into());
        }
        let mut answer = self.answer.borrow_mut();
        let size = answer.len().min(buffer.len());
        buffer[..size].copy_from_slice(&answer[..size]);
        answer.drain(..size);
        if size == 0 {
            return Err(ErrorKind::TimedOut.into());
        }
        Ok(size)
    }
}

impl Write for Line {
    fn write(&mut self, line: &[u8]) -> io::Result<usize> {
        let id = line[2];
        let size = if id == Identification::ID { Identification::LENGTH } else { 1 };
        let mut message = vec![id];
        message.resize(1 + size, 0);
        let mut answer = [0; 64];
        let count = uart::encode(&LINK, &message, &mut answer).unwrap();
        self.answer.borrow_mut().extend_from_slice(&answer[..count]);
        Ok(line.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn failing() {
    let line = Line::default();
    let mut session = Session::<_, _, uart::Line<LONGEST>>::uart(&LINK, line.clone()).unwrap();
    session.get::<Identification>().unwrap();
    line.fails.set(true);
    for _ in 0..2 {
        assert!(matches!(session.get::<EstimatedAttitudeAngles>(), Err(Failure::Port(_)))); // and not Busy
        assert!(matches!(session.send(&ClearErrors::default()), Err(Failure::Port(_))));
    }
    let failure = session.get::<EstimatedAttitudeAngles>().unwrap_err();
    let source = std::error::Error::source(&failure).unwrap();
    assert_eq!(source.downcast_ref::<io::Error>().unwrap().kind(), ErrorKind::BrokenPipe);
    assert_eq!(failure.to_string(), "the port failed: broken pipe");
    let failure = Failure::from(icd::Error::Range { field: "Flow", allowed: "0 to 6553.5 m/s" });
    assert_eq!(failure.to_string(), "`Flow` takes 0 to 6553.5 m/s");
    line.fails.set(false);
    line.answer.borrow_mut().clear();
    session.get::<Identification>().unwrap();
}

fn shared() {
    shares(&icd::bootloader::LINK);
    shares(&icd::cubeacp::LINK);
    shares(&icd::common::LINK);
}

fn shares<T>(link: &'static NodeLink<T>)
where
    Identification: TelemetryOf<T>,
    Reset: TelecommandOf<T>,
{
    let mut client = Client::<T, uart::Line<LONGEST>, 1>::uart(link).unwrap();
    client.request::<Identification>(0).unwrap();
    let (mut line, mut found) = ([0; 64], None);
    assert!(client.output(&mut line).unwrap().is_some());
    let count = uart::encode(link, &[Identification::ID, 1, 2, 3, 4, 5, 6, 7, 8], &mut line).unwrap();
    client.received(1, &line[..count], |event| found = event.message::<Identification>());
    assert!(found.is_some());
    client.send(2, &Reset::default()).unwrap();
    let mut events = Vec::new();
    client.tick(2, |event| events.push(format!("{event:?}")));
    assert!(events.is_empty(), "it is not even taken");
    assert!(client.output(&mut line).unwrap().is_some());
    client.tick(2, |event| events.push(format!("{event:?}")));
    assert!(events.remove(0).starts_with("Sent {") && events.is_empty());
}

fn late() {
    let mut client = Client::<_, i2c::Line<LONGEST>, 1>::i2c(&LINK).unwrap();
    let mut events = Vec::new();
    client.request::<EstimatedAttitudeAngles>(0).unwrap();
    assert!(client.output_transaction().is_some());
    client.cancel();
    client.send(1, &Reset::default()).unwrap();
    client.transferred(2, Some(&[0; 6]), |event| events.push(format!("{event:?}")));
    assert!(events.remove(0).starts_with("Late { id: 146"));
    assert!(client.output_transaction().is_some());
    client.transferred(3, Some(&[]), |event| events.push(format!("{event:?}")));
    assert!(events.remove(0).starts_with("Sent { direction: Telecommand, id: 1"));
}

fn cancelled() {
    let mut client = Client::<_, uart::Line<LONGEST>, 1>::uart(&LINK).unwrap();
    client.cancel();
    client.request::<EstimatedAttitudeAngles>(0).unwrap();
    client.cancel();
    let mut line = [0; 64];
    assert!(client.output(&mut line).unwrap().is_none() && client.deadline().is_none(), "what was not taken is not sent");
    client.request::<EstimatedAngularRates>(1).unwrap();
    assert!(client.output(&mut line).unwrap().is_some());
    let mut events = Vec::new();
    let count = uart::encode(&LINK, &[EstimatedAttitudeAngles::ID, 0, 0, 0, 0, 0, 0], &mut line).unwrap();
    client.received(2, &line[..count], |event| events.push(format!("{event:?}")));
    assert!(events.remove(0).starts_with("Stray { id: Some(146)") && events.is_empty() && client.deadline().is_some());
}
