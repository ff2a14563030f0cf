//! A joiner with room for the packets of a message joins it; with one byte less it calls them malformed.

use icd::cubeacp::LINK;
use icd::wire::can::{Event, Joiner, Kind, Message, Splitter};

/// A telecommand of CubeACP with 22 bytes: four packets with 7 bytes each.
const ID: u32 = 115;
const BYTES: usize = 22;
const PACKETS: usize = 4;
const ROOM: usize = PACKETS * 7;

/// Join the packets of the message, and count the messages and malformed packets.
fn joined<const N: usize>() -> (usize, usize) {
    let message = Message {
        kind: Kind::Telecommand,
        id: ID,
        source: 1,
        destination: 2,
        data: &[0x5a; BYTES],
    };
    let mut joiner = Joiner::<N, 1>::new(&LINK, None).unwrap();
    let (mut messages, mut malformed) = (0, 0);
    for packet in Splitter::new(&LINK, &message).unwrap() {
        joiner.feed(0, &packet, |event| match event {
            Event::Message(Message { data, .. }) => {
                assert_eq!(data, [0x5a; BYTES]);
                messages += 1;
            }
            Event::Malformed { .. } => malformed += 1,
            other => panic!("{other:?}"),
        });
    }
    (messages, malformed)
}

fn main() {
    assert_eq!(joined::<ROOM>(), (1, 0));
    assert_eq!(joined::<{ ROOM - 1 }>(), (0, PACKETS));
}
