"""Events of clients over framed links contain the message that was received.

The tests compile and run Rust programs that feed bytes to a client.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.conformance.icds import LINKS
from tests.conftest import ROOT
from tests.rust import harness
from tests.rust.tools import USED, Toolchain, run, toolchains

READING = """
use icd::datagram::{self, LevelOfAnother, LevelOfTheFirst, ShortLevel, LINK};
use icd::wire::{self, stream, Direction};

type Client = wire::Client<datagram::Node, stream::Line<{ datagram::LONGEST }, { datagram::SEQUENCES }>, 2>;

fn seen(data: &[u8]) -> (Option<u8>, Option<u32>, bool) {
    let mut line = [0; 200];
    let values = stream::Values::default();
    let size = stream::encode(&LINK, Direction::Telemetry, ShortLevel::ID, data, &values, &mut line).unwrap();
    let mut client = Client::new(&LINK).unwrap();
    let mut read = None;
    client.received(1, &line[..size], |event| {
        let first = event.message::<LevelOfTheFirst>();
        let short = event.message::<ShortLevel>();
        read = Some((
            short.map(|one| one.level.into()),
            first.map(|one| one.level.into()),
            event.message::<LevelOfAnother>().is_some(),
        ));
    });
    read.unwrap()
}

fn main() {
    assert_eq!(seen(&[1, 2, 3]), (None, Some(0x203), false));
    assert_eq!(seen(&[2, 2, 3]), (None, None, true));
    assert_eq!(seen(&[7]), (Some(7), None, false));
}
"""

OUTCOMES = """
use icd::wheel::{self, enums::NakReason, Ack, Busy, Events, Nak, Node, Reset, SetMode, SetSpeed, LINK};
use icd::wire::{self, stream, Direction, Event, NodeEvent, Settings, TelemetryOf};

type Client = wire::Client<Node, stream::Line<{ wheel::LONGEST }, { wheel::SEQUENCES }>, 2>;

fn encoded<M: TelemetryOf<Node>>(message: M) -> Vec<u8> {
    let (data, mut line) = (message.to_bytes().unwrap(), [0; 100]);
    let values = stream::Values::default();
    let size = stream::encode(&LINK, Direction::Telemetry, M::TELEMETRY_ID, data.as_ref(), &values, &mut line);
    line[..size.unwrap()].to_vec()
}

fn sent(client: &mut Client) -> Option<u8> {
    let mut line = [0; wheel::LONGEST];
    client.output(&mut line).unwrap().map(|line| line[3])
}

/// Describe an event: its kind and contents.
fn describe(event: &NodeEvent<'_, Node>) -> String {
    let command = event.message::<Ack>().map(|ack| ack.command);
    let command = command.or_else(|| event.message::<Nak>().map(|nak| nak.command));
    let command = command.or_else(|| event.message::<Busy>().map(|busy| busy.command));
    match **event {
        Event::Refused { id, attempts: 1, code: Some(4), .. } => {
            assert_eq!(event.reason(), Some(NakReason::WrongMode));
            format!("refused {id} {command:?}")
        }
        Event::Done { id, attempts, .. } => format!("done {id} {attempts} {command:?}"),
        Event::Busy { id, attempts, code: None, .. } => format!("busy {id} {attempts} {command:?}"),
        Event::Timeout { id, attempts, .. } => format!("timeout {id} {attempts} {command:?}"),
        Event::Sent { id, attempts, .. } => format!("sent {id} {attempts} {command:?}"),
        Event::Progress { id, .. } => format!("progress {id} {command:?}"),
        Event::Late { id, .. } => format!("late {id} {command:?}"),
        Event::Stray { id, .. } => format!("stray {} {command:?}", id.unwrap()),
        Event::Reply { id, .. } => format!("reply {id} {:?}", event.message::<Events>().map(|events| events.count)),
        other => panic!("{other:?}"),
    }
}

fn come<M: TelemetryOf<Node>>(client: &mut Client, now: u32, message: M) -> String {
    let mut description = String::new();
    client.received(now, &encoded(message), |event| description = describe(&event));
    description
}

fn pass(client: &mut Client, now: u32) -> String {
    let mut description = String::new();
    client.tick(now, |event| description = describe(&event));
    description
}

fn main() {
    let settings = Settings { gap_ms: 0, ..LINK.client };
    let mut client = Client::new(&LINK).unwrap().with_settings(settings);
    let nak = |command| Nak { command, reason: NakReason::WrongMode.into() };
    let speed = SetSpeed::default();

    // One at a time: the second is sent when the first has ended.
    client.send(0, &speed).unwrap();
    client.send(0, &SetMode::default()).unwrap();
    assert_eq!(client.send(0, &speed), Err(icd::wire::Error::Busy));
    assert_eq!((sent(&mut client), sent(&mut client)), (Some(2), None));
    assert_eq!(come(&mut client, 1, Ack { command: 1 }), "stray 6 Some(1)");
    assert_eq!(come(&mut client, 2, nak(2)), "refused 2 Some(2)");
    assert_eq!(sent(&mut client), Some(1));
    assert_eq!(come(&mut client, 3, Busy { command: 1 }), "progress 1 Some(1)");
    assert_eq!((client.deadline(), pass(&mut client, 103).as_str(), sent(&mut client)), (Some(103), "", Some(1)));
    assert_eq!(come(&mut client, 104, Ack { command: 1 }), "done 1 2 Some(1)");
    assert_eq!(client.deadline(), None);

    // A request like one that may still be answered waits.
    client.send(1000, &speed).unwrap();
    assert_eq!(sent(&mut client), Some(2));
    assert_eq!(pass(&mut client, 1200), "timeout 2 1 None");
    client.send(1200, &speed).unwrap();
    assert_eq!((sent(&mut client), client.deadline()), (None, Some(1400)));
    assert_eq!(come(&mut client, 1300, nak(2)), "late 21 Some(2)");
    assert_eq!(sent(&mut client), Some(2));
    assert_eq!(come(&mut client, 1301, Ack { command: 2 }), "done 2 1 Some(2)");

    // The reply may come before the acknowledge.
    client.ask::<Events, _>(2000, &speed).unwrap();
    assert_eq!(sent(&mut client), Some(2));
    assert_eq!(come(&mut client, 2001, Events { count: 7 }), "reply 2 Some(7)");
    assert_eq!(come(&mut client, 2002, Ack { command: 2 }), "done 2 1 Some(2)");

    client.send(3000, &Reset {}).unwrap();
    assert_eq!(sent(&mut client), Some(0x7f));
    assert_eq!((client.deadline(), pass(&mut client, 3000).as_str()), (Some(3000), "sent 127 1 None"));

    for attempt in 0..3 {
        if attempt == 0 {
            client.send(4000, &speed).unwrap();
        }
        assert_eq!(sent(&mut client), Some(2));
        let description = come(&mut client, 4000 + 100 * attempt, Busy { command: 2 });
        assert_eq!(description, if attempt < 2 { "progress 2 Some(2)" } else { "busy 2 3 Some(2)" });
        assert_eq!(pass(&mut client, 4100 + 100 * attempt), "");
    }
    assert_eq!((sent(&mut client), client.deadline()), (None, None));

    // A response after the time-out is late, also if no tick came in between.
    client.send(5000, &speed).unwrap();
    assert_eq!(sent(&mut client), Some(2));
    assert_eq!(come(&mut client, 5201, Ack { command: 2 }), "late 6 Some(2)");
}
"""

PACKETS = """
use icd::jbd::{self, enums::Status, CellVoltages, Node, SwitchOff, LINK};
use icd::wire::{self, stream, Error, Event};

type Client = wire::Client<Node, stream::Line<{ jbd::LONGEST }, { jbd::SEQUENCES }>, 2>;

const CELLS: [u8; 9] = [0xdd, 4, 0, 2, 0x0f, 0xa0, 0xff, 0x4f, 0x77];
const CELLS_REFUSED: [u8; 7] = [0xdd, 4, 0x80, 0, 0xff, 0x80, 0x77];
const SWITCHED: [u8; 7] = [0xdd, 0xe1, 0, 0, 0, 0, 0x77];

fn sent(client: &mut Client) -> Vec<u8> {
    let mut line = [0; jbd::LONGEST];
    client.output(&mut line).unwrap().unwrap().to_vec()
}

fn received(client: &mut Client, bytes: &[u8]) -> String {
    let mut description = String::new();
    client.received(1, bytes, |event| {
        let cells = event.message::<CellVoltages>().map(|cells| cells.voltages[0]);
        description += &match *event {
            Event::Done { id, packet, .. } => format!("done {id} {packet:?} {cells:?}"),
            Event::Refused { id, code, .. } => {
                assert_eq!(event.reason(), Some(Status::Error));
                format!("refused {id} {code:?} {cells:?}")
            }
            Event::Stray { id, packet, data } => format!("stray {} {packet:?} {data:x?} {cells:?}", id.unwrap()),
            other => panic!("{other:?}"),
        };
    });
    description
}

fn main() {
    let mut client = Client::new(&LINK).unwrap();
    let packet = |name| LINK.stream.as_ref().unwrap().packets.iter().position(|packet| packet.name == name);

    client.request::<CellVoltages>(0).unwrap();
    assert_eq!(sent(&mut client), [0xdd, 0xa5, 4, 0, 0xff, 0xfc, 0x77]);
    assert_eq!(received(&mut client, &CELLS), "done 4 None Some(4000)");

    // A refusal is a packet of its own, which no telemetry can be read from.
    client.request::<CellVoltages>(0).unwrap();
    sent(&mut client);
    assert_eq!(received(&mut client, &CELLS_REFUSED), "refused 4 Some(128) None");
    let refusal = packet("refusal");
    assert_eq!(received(&mut client, &CELLS_REFUSED), format!("stray 4 {refusal:?} {CELLS_REFUSED:x?} None"));

    let off = SwitchOff { switches: 3, ..SwitchOff::default() };
    client.send(0, &off).unwrap();
    assert_eq!(sent(&mut client), [0xdd, 0x5a, 0xe1, 2, 0, 3, 0xff, 0x1a, 0x77]);
    assert_eq!(received(&mut client, &SWITCHED), format!("done 225 {:?} None", packet("written")));

    let (mut line, values) = ([0; jbd::LONGEST], stream::Values::default());
    assert_eq!(stream::encode_request(&LINK, 4, &values, &mut line), Ok(7));
    assert_eq!(line[..7], [0xdd, 0xa5, 4, 0, 0xff, 0xfc, 0x77]);
    let unknown = stream::encode_request(&LINK, 9, &values, &mut line);
    assert_eq!(unknown, Err(Error::UnknownId { id: 9 }));
}
"""


LINK_ICDS = (
    ROOT / "examples" / "links" / "jbd.yaml",
    ROOT / "examples" / "links" / "wheel.yaml",
    LINKS / "packets.yaml",
)


@pytest.fixture(scope="module")
def crate(tmp_path_factory) -> Path:
    """Crate of the ICDs of all framed links."""
    icd = harness.read_unchecked(*LINK_ICDS)
    return harness.generate(icd, tmp_path_factory.mktemp("links"))


@pytest.mark.parametrize("toolchain", list(toolchains()))
@pytest.mark.parametrize(
    "source",
    [
        pytest.param(READING, id="an event is read as the message that it brings"),
        pytest.param(OUTCOMES, id="each outcome is an event with its response"),
        pytest.param(PACKETS, id="packets request telemetry and refuse it"),
    ],
)
def test_a_program_gets_the_events_of_its_link(crate, toolchain, source, tmp_path):
    tools = Toolchain(toolchain)
    (tmp_path / "user.rs").write_text(source)
    library = tools.library(crate, *USED)
    run(tools.program(tmp_path / "user.rs", library, tmp_path / "user"))
