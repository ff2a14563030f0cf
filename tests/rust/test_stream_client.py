"""Clients over envelopes in Rust: each event is read as the message that it brings, and
as no other.
"""

from __future__ import annotations

import pytest

from tests.conformance.icds import LINKS
from tests.rust import harness
from tests.rust.tools import Toolchain, run, toolchains

PROGRAM = """
use icd::datagram::{self, LevelOfAnother, LevelOfTheFirst, ShortLevel, LINK};
use icd::wire::{stream, Direction};

type Client = stream::Client<datagram::Node, { datagram::LONGEST }, { datagram::SEQUENCES }, 2>;

fn seen(data: &[u8]) -> (Option<u8>, Option<u32>, bool) {
    let mut line = [0; 200];
    let values = stream::Values::new(&LINK, Direction::Telemetry);
    let size = stream::encode(&LINK, Direction::Telemetry, ShortLevel::ID, data, &values, &mut line).unwrap();
    let mut client = Client::new(&LINK).unwrap();
    let mut found = None;
    client.received(1, &line[..size], |event| {
        let first = event.message::<LevelOfTheFirst>();
        let short = event.message::<ShortLevel>();
        found = Some((
            short.map(|one| one.level.into()),
            first.map(|one| one.level.into()),
            event.message::<LevelOfAnother>().is_some(),
        ));
    });
    found.unwrap()
}

fn main() {
    assert_eq!(seen(&[1, 2, 3]), (None, Some(0x203), false));
    assert_eq!(seen(&[2, 2, 3]), (None, None, true));
    assert_eq!(seen(&[7]), (Some(7), None, false));
}
"""


@pytest.mark.parametrize("toolchain", list(toolchains()))
def test_an_event_is_read_as_the_message_that_it_brings_and_as_no_other(
    toolchain, tmp_path
):
    crate = harness.generate(harness.read(LINKS / "packets.yaml"), tmp_path)
    (tmp_path / "user.rs").write_text(PROGRAM)
    run(
        Toolchain(toolchain).program(
            tmp_path / "user.rs",
            Toolchain(toolchain).library(crate, "0"),
            tmp_path / "user",
        )
    )
