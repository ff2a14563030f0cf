//! A session over a framed link: replies that are lost, what comes unasked, a port that fails; any surprise is a panic.

use icd::receiver::{NavigationClock, Node, PollClock, SetMessageRate, LINK, LONGEST, SEQUENCES};
use icd::wire::{stream, Direction, Failure, Outcome};
use std::cell::RefCell;
use std::io::{self, ErrorKind, Read, Write};
use std::rc::Rc;

type Session = icd::wire::Session<Node, Line, stream::Line<LONGEST, SEQUENCES>>;

/// A receiver that answers each poll with its number; `lost` of the answers do not come.
#[derive(Default)]
struct Device {
    fails: bool,
    lost: usize,
    polls: i32,
    written: Vec<u32>,
    coming: Vec<u8>,
}

#[derive(Clone, Default)]
struct Line(Rc<RefCell<Device>>);

impl Device {
    fn says(&mut self, clock_bias: i32) {
        let clock = NavigationClock { clock_bias, ..NavigationClock::default() };
        let (data, mut line) = (clock.to_bytes().unwrap(), [0; 100]);
        let values = stream::Values::default();
        let size = stream::encode(&LINK, Direction::Telemetry, NavigationClock::ID.into(), &data, &values, &mut line).unwrap();
        self.coming.extend_from_slice(&line[..size]);
    }
}

impl Read for Line {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let mut device = self.0.borrow_mut();
        if device.fails {
            return Err(ErrorKind::BrokenPipe.into());
        }
        let size = device.coming.len().min(buffer.len()).min(7);
        buffer[..size].copy_from_slice(&device.coming[..size]);
        device.coming.drain(..size);
        if size == 0 {
            std::thread::sleep(std::time::Duration::from_millis(1));
            return Err(ErrorKind::TimedOut.into());
        }
        Ok(size)
    }
}

impl Write for Line {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut device = self.0.borrow_mut();
        let mut decoder = stream::Decoder::<LONGEST, SEQUENCES>::new(&LINK, Direction::Telecommand).unwrap();
        decoder.feed(bytes, |event| match event {
            stream::Event::Message { id, .. } => device.written.push(id),
            other => panic!("{other:?}"),
        });
        if device.written.last() == Some(&PollClock::ID.into()) {
            device.polls += 1;
            let polls = device.polls;
            match device.lost.checked_sub(1) {
                Some(left) => device.lost = left,
                None => device.says(polls),
            }
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn main() {
    let line = Line::default();
    let told = Rc::new(RefCell::new(Vec::new()));
    let events = Rc::clone(&told);
    let settings = icd::wire::Settings { reply_timeout_ms: 20, retries: 2, ..LINK.client };
    let mut session = Session::new(&LINK, line.clone())
        .unwrap()
        .with_settings(settings)
        .with_events(move |event| events.borrow_mut().push(event.message::<NavigationClock>().map(|clock| clock.clock_bias)));

    assert_eq!(session.get::<NavigationClock>().unwrap().clock_bias, 1);
    line.0.borrow_mut().lost = 2;
    assert_eq!(session.get::<NavigationClock>().unwrap().clock_bias, 4);
    assert_eq!(session.ask::<NavigationClock, _>(&PollClock {}).unwrap().clock_bias, 5);
    let rate = SetMessageRate { rate: 1, ..SetMessageRate::default() };
    assert_eq!(session.send(&rate).unwrap(), Outcome::Sent);
    assert_eq!(line.0.borrow().written.last(), Some(&SetMessageRate::ID.into()));

    line.0.borrow_mut().says(-9);
    assert_eq!(session.message::<NavigationClock>(1000).unwrap().map(|clock| clock.clock_bias), Some(-9));
    assert!(session.message::<NavigationClock>(5).unwrap().is_none());
    assert_eq!(*told.borrow(), [Some(1), Some(4), Some(5), None, Some(-9)]); // None: that the rate was sent

    line.0.borrow_mut().lost = 100;
    let failure = session.get::<NavigationClock>().unwrap_err();
    assert_eq!(failure.to_string(), format!("no answer to request {}, asked 3 times", NavigationClock::ID));
    line.0.borrow_mut().fails = true;
    for _ in 0..2 {
        assert!(matches!(session.get::<NavigationClock>(), Err(Failure::Port(_)))); // and not Busy
    }
    *line.0.borrow_mut() = Device::default();
    assert_eq!(session.get::<NavigationClock>().unwrap().clock_bias, 1);
}
