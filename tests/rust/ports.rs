//! Clients over ports that have the traits of `embedded-io` and `embedded-hal`, as drivers of microcontrollers have.

use icd::cubeacp::{self, CurrentAdcsState};
use icd::wire::{i2c, uart, Client, Event, Link, Linked, Request};
use receiver::receiver::{self as ubx, EndOfEpoch, NavigationClock};
use receiver::wire::{stream, Client as FramedClient, Direction, PortError};
use std::collections::VecDeque;
use std::convert::Infallible;

type Uart = Client<cubeacp::Node, uart::Line<{ cubeacp::LONGEST }>, 1>;

const STATE: [u8; 7] = [132, 0xe2, 0, 0, 0, 0, 0];
const ADDRESS: u8 = 0x57;

/// A serial port: what was written, and what will come.
#[derive(Default)]
struct Serial {
    written: Vec<u8>,
    flushed: usize,
    coming: VecDeque<u8>,
}

impl embedded_io::ErrorType for Serial {
    type Error = Infallible;
}

impl embedded_io::Write for Serial {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        let taken = bytes.len().min(3); // as many as its buffer holds
        self.written.extend_from_slice(&bytes[..taken]);
        Ok(taken)
    }

    fn flush(&mut self) -> Result<(), Infallible> {
        self.flushed = self.written.len();
        Ok(())
    }
}

impl embedded_io::ReadReady for Serial {
    fn read_ready(&mut self) -> Result<bool, Infallible> {
        Ok(!self.coming.is_empty())
    }
}

impl embedded_io::Read for Serial {
    fn read(&mut self, into: &mut [u8]) -> Result<usize, Infallible> {
        assert!(!self.coming.is_empty(), "a read that waits");
        let count = into.len().min(self.coming.len()).min(5);
        for (to, from) in into.iter_mut().zip(self.coming.drain(..count)) {
            *to = from;
        }
        Ok(count)
    }
}

fn over_uart() {
    let (mut port, mut found) = (Serial::default(), None);
    let mut room = [0; 2 * cubeacp::LONGEST + 4];
    let mut client = Uart::uart(&cubeacp::LINK).unwrap();
    client.request::<CurrentAdcsState>(0).unwrap();
    client
        .poll(0, &mut port, &mut room, |_| panic!("nothing came"))
        .unwrap();
    assert_eq!(port.written, [0x1f, 0x7f, 132, 0x1f, 0xff]);
    assert_eq!(port.flushed, 5);
    let mut line = [0; 32];
    let size = uart::encode(&cubeacp::LINK, &STATE, &mut line).unwrap();
    port.coming.extend(&line[..size]);
    client
        .poll(1, &mut port, &mut room, |event| {
            found = found.take().or(event.message::<CurrentAdcsState>())
        })
        .unwrap();
    assert_eq!(found.unwrap().to_bytes().unwrap()[..], STATE[1..]);
    assert_eq!(client.deadline(), None);
    client.request::<CurrentAdcsState>(10).unwrap();
    let mut ended = false;
    for now in (10..100_000).step_by(100) {
        client
            .poll(now, &mut port, &mut room, |event| {
                ended |= matches!(*event, Event::Timeout { .. })
            })
            .unwrap();
    }
    assert!(ended && client.deadline().is_none());
}

fn over_i2c_with_a_stop() {
    let mut link = *cubeacp::LINK.link();
    link.i2c_repeated_start = false;
    let (mut bus, mut found) = (Bus::default(), Vec::new());
    let link: &'static Link = Box::leak(Box::new(link));
    let mut client = Client::<(), i2c::Line<{ cubeacp::LONGEST }>, 1>::i2c(link).unwrap();
    client.start(0, &Request::telemetry(132)).unwrap();
    client
        .poll_i2c(0, &mut bus, |event| {
            if let Event::Done { data, .. } = *event {
                found.extend_from_slice(data);
            }
        })
        .unwrap();
    assert_eq!((found, bus.transactions), (STATE[1..].to_vec(), 2));
}

fn over_framed_links() {
    type Receiver = FramedClient<ubx::Node, stream::Line<{ ubx::LONGEST }, { ubx::SEQUENCES }>, 2>;
    let (mut port, mut line) = (Serial::default(), [0; ubx::LONGEST]);
    let mut client = Receiver::new(&ubx::LINK).unwrap();
    client.request::<NavigationClock>(0).unwrap();
    let mut short = [0; 4];
    let refused = client.poll(0, &mut port, &mut short, |_| ());
    assert!(matches!(refused, Err(PortError::Wire(_))) && port.written.is_empty());
    client
        .poll(0, &mut port, &mut line, |_| panic!("nothing came"))
        .unwrap();
    assert_eq!(port.written, [0xb5, 0x62, 0x01, 0x22, 0, 0, 0x23, 0x6a]);
    let values = stream::Values::default();
    let clock = NavigationClock {
        clock_bias: -5,
        ..NavigationClock::default()
    };
    for (id, data) in [
        (0x0161, &[7, 0, 0, 0][..]),
        (0x0122, &clock.to_bytes().unwrap()[..]),
    ] {
        let size = stream::encode(
            &ubx::LINK,
            Direction::Telemetry,
            id,
            data,
            &values,
            &mut line,
        )
        .unwrap();
        port.coming.extend(&line[..size]);
    }
    let (mut epoch, mut done) = (None, None);
    client
        .poll(1, &mut port, &mut line, |event| {
            epoch = epoch.take().or(event.message::<EndOfEpoch>());
            done = done.take().or(event.message::<NavigationClock>());
        })
        .unwrap();
    assert_eq!(
        (epoch.unwrap().time_of_week, done.unwrap().clock_bias),
        (7, -5)
    );
}

/// An I2C bus with a node that answers with `STATE`, or is not there.
#[derive(Default)]
struct Bus {
    asked: Vec<u8>,
    transactions: u32,
    is_silent: bool,
}

#[derive(Debug, PartialEq)]
struct NoAcknowledge;

impl embedded_hal::i2c::Error for NoAcknowledge {
    fn kind(&self) -> embedded_hal::i2c::ErrorKind {
        embedded_hal::i2c::ErrorKind::NoAcknowledge(embedded_hal::i2c::NoAcknowledgeSource::Address)
    }
}

impl embedded_hal::i2c::ErrorType for Bus {
    type Error = NoAcknowledge;
}

impl embedded_hal::i2c::I2c for Bus {
    fn transaction(
        &mut self,
        address: u8,
        parts: &mut [embedded_hal::i2c::Operation<'_>],
    ) -> Result<(), NoAcknowledge> {
        use embedded_hal::i2c::Operation::{Read, Write};
        assert_eq!(address, ADDRESS);
        self.transactions += 1;
        for part in parts {
            match part {
                _ if self.is_silent => return Err(NoAcknowledge),
                Write(bytes) => self.asked.extend_from_slice(bytes),
                Read(into) => into.copy_from_slice(&STATE[1..=into.len()]),
            }
        }
        Ok(())
    }
}

fn over_i2c() {
    let (mut bus, mut found) = (Bus::default(), None);
    let mut client = Client::<_, i2c::Line<{ cubeacp::LONGEST }>, 1>::i2c(&cubeacp::LINK).unwrap();
    client.request::<CurrentAdcsState>(0).unwrap();
    client
        .poll_i2c(0, &mut bus, |event| {
            found = found.take().or(event.message::<CurrentAdcsState>())
        })
        .unwrap();
    assert_eq!(found.unwrap().to_bytes().unwrap()[..], STATE[1..]);
    assert_eq!(bus.asked, [132]);
    assert_eq!(bus.transactions, 1);
    bus.is_silent = true;
    client.request::<CurrentAdcsState>(10).unwrap();
    assert_eq!(client.poll_i2c(10, &mut bus, |_| ()), Err(NoAcknowledge));
    let mut ended = false;
    for now in (10..100_000).step_by(100) {
        let _ = client.poll_i2c(now, &mut bus, |event| {
            ended |= matches!(*event, Event::Timeout { .. })
        });
    }
    assert!(ended && client.deadline().is_none());
}

fn main() {
    over_uart();
    over_framed_links();
    over_i2c();
    over_i2c_with_a_stop();
}
