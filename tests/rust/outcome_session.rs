//! A session with the reaction wheel of the examples: each outcome of a telecommand; any surprise is a panic.

use icd::wheel::{enums, Ack, Busy, Events, GetEvents, Nak, Node, Reset, Save, SetMode, SetSpeed, LINK, LONGEST, SEQUENCES};
use icd::wire::{stream, Direction, Event, Failure, Outcome, TelemetryOf};
use std::cell::RefCell;
use std::io::{self, ErrorKind, Read, Write};
use std::rc::Rc;
use std::time::{Duration, Instant};

type Session = icd::wire::Session<Node, Line, stream::Line<LONGEST, SEQUENCES>>;

/// A wheel that answers each telecommand with the next of its answers.
#[derive(Default)]
struct Wheel {
    answers: Vec<Vec<u8>>,
    sent: Vec<u32>,
    coming: Vec<u8>,
}

#[derive(Clone, Default)]
struct Line(Rc<RefCell<Wheel>>);

impl Line {
    fn answers(&self, answers: &[Vec<u8>]) {
        let mut wheel = self.0.borrow_mut();
        wheel.answers = answers.to_vec();
        wheel.sent.clear();
    }
}

impl Read for Line {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let mut wheel = self.0.borrow_mut();
        let size = wheel.coming.len().min(buffer.len());
        buffer[..size].copy_from_slice(&wheel.coming[..size]);
        wheel.coming.drain(..size);
        if size == 0 {
            std::thread::sleep(Duration::from_millis(1));
            return Err(ErrorKind::WouldBlock.into());
        }
        Ok(size)
    }
}

impl Write for Line {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut wheel = self.0.borrow_mut();
        let mut decoder = stream::Decoder::<LONGEST, 0>::new(&LINK, Direction::Telecommand).unwrap();
        decoder.feed(bytes, |event| match event {
            stream::Event::Message { id, .. } => wheel.sent.push(id),
            other => panic!("{other:?}"),
        });
        if !wheel.answers.is_empty() {
            let answer = wheel.answers.remove(0);
            wheel.coming.extend_from_slice(&answer);
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn encoded<M: TelemetryOf<Node>>(message: &M) -> Vec<u8> {
    let (data, mut line) = (message.to_bytes().unwrap(), [0; 100]);
    let values = stream::Values::default();
    let size = stream::encode(&LINK, Direction::Telemetry, M::TELEMETRY_ID, data.as_ref(), &values, &mut line);
    line[..size.unwrap()].to_vec()
}

fn ack(command: u8) -> Vec<u8> {
    encoded(&Ack { command })
}

fn nak(command: u8, reason: enums::NakReason) -> Vec<u8> {
    encoded(&Nak { command, reason: reason.into() })
}

fn busy(command: u8) -> Vec<u8> {
    encoded(&Busy { command })
}

fn main() {
    let line = Line::default();
    let settings = icd::wire::Settings {
        reply_timeout_ms: 30,
        late_ms: 1,
        busy_pause_ms: 1,
        gap_ms: 0,
        ..LINK.client
    };
    let others = Rc::new(RefCell::new(0));
    let strays = Rc::clone(&others);
    let mut session = Session::new(&LINK, line.clone())
        .unwrap()
        .with_settings(settings)
        .with_events(move |event| *strays.borrow_mut() += usize::from(matches!(**event, Event::Stray { .. })));
    let speed = SetSpeed::default();

    // The acknowledge of another telecommand confirms nothing.
    line.answers(&[[ack(1), ack(2)].concat()]);
    assert_eq!(session.send(&speed).unwrap(), Outcome::Done);
    assert_eq!(*others.borrow(), 1);

    // Nothing responds to it, so nothing is waited for.
    let began = Instant::now();
    line.0.borrow_mut().answers.clear();
    for _ in 0..3 {
        assert_eq!(session.send(&Reset {}).unwrap(), Outcome::Sent);
    }
    assert!(began.elapsed() < Duration::from_millis(30));

    line.answers(&[nak(2, enums::NakReason::WrongMode)]);
    let refused = session.send(&speed).unwrap_err();
    assert!(matches!(refused, Failure::Refused { id: 2, code: Some(4), may_be_damaged: false }));
    assert_eq!(refused.reason::<Node>(), Some(enums::NakReason::WrongMode));
    assert_eq!(refused.to_string(), "request 2 is refused, code 4");

    line.answers(&[busy(2), busy(2), ack(2)]);
    assert_eq!(session.send(&speed).unwrap(), Outcome::Done);
    assert_eq!(line.0.borrow().sent, [2, 2, 2]);
    line.answers(&[busy(2), busy(2), busy(2)]);
    let failure = session.send(&speed).unwrap_err();
    assert!(matches!(failure, Failure::Busy { id: 2, attempts: 3, code: None }));
    assert_eq!(failure.reason::<Node>(), None);
    assert_eq!(failure.to_string(), "the device is still busy after 3 attempts at request 2");

    // Only what may be repeated is sent again.
    line.answers(&[]);
    assert!(matches!(session.send(&speed), Err(Failure::Timeout { id: 2, attempts: 1 })));
    line.answers(&[Vec::new(), ack(1)]);
    assert_eq!(session.send(&SetMode::default()).unwrap(), Outcome::Done);
    assert_eq!(line.0.borrow().sent, [1, 1]);

    // Telemetry is requested by its telecommand, or by any with a reply that the caller names.
    line.answers(&[encoded(&Events { count: 7 })]);
    assert_eq!(session.get::<Events>().unwrap().count, 7);
    line.answers(&[[encoded(&Events { count: 8 }), ack(5)].concat()]);
    assert_eq!(session.ask::<Events, _>(&Save {}).unwrap().count, 8);
    line.answers(&[[ack(5), encoded(&Events { count: 9 })].concat()]);
    assert_eq!(session.ask::<Events, _>(&Save {}).unwrap().count, 9);
    line.answers(&[nak(4, enums::NakReason::OutOfRange)]);
    let refused = session.ask::<Events, _>(&GetEvents {}).unwrap_err();
    assert_eq!(refused.reason::<Node>(), Some(enums::NakReason::OutOfRange));
}
