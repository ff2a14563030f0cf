"""Packets without a message, which a device sends, have the same bytes, counts and
errors in C, Rust and Python.
"""

from __future__ import annotations

import subprocess

import pytest
from icdgen_runtime._errors import RangeError
from icdgen_runtime.wire.sender import Sender

from icdgen.protocol import facts
from icdgen.runtime_objects.links import link_of
from tests.c import harness as c
from tests.conformance.icds import LINKS, icd_of
from tests.rust import harness as rust
from tests.rust.tools import USED, Toolchain, run, toolchains

ICD = icd_of([LINKS / "formats.yaml", LINKS / "packets_by_length.yaml"])
C = """
#include "formats.h"
#include "station.h"
#include <assert.h>
#include <stdio.h>

static uint8_t line[FORMATS_LINE_BYTES + STATION_LINE_BYTES];
static size_t size;

static void put(icd_status_t status)
{
    assert(status == ICD_OK);
    for (size_t i = 0; i < size; ++i) {
        (void)printf("%02x", line[i]);
    }
    (void)printf("\\n");
}

static icd_status_t packet(icd_stream_sender_t *sender, size_t index, uint32_t id, const icd_header_values_t *values)
{
    return icd_stream_send_packet(sender, index, id, values, line, sizeof line, &size);
}

int main(void)
{
    icd_stream_sender_t sender;
    uint32_t sequences[FORMATS_SEQUENCES + STATION_SEQUENCES];
    const uint8_t data[3] = {1, 2, 3};
    icd_header_values_t values;
    assert(icd_stream_sender_init(&sender, formats_link(), ICD_TELEMETRY, sequences, FORMATS_SEQUENCES) == ICD_OK);
    sender.values.of[ICD_FIELD_REASON] = 1;
    values = sender.values;
    values.of[ICD_FIELD_REASON] = 2;
    values.of[ICD_FIELD_SEQUENCE] = 77;
    put(packet(&sender, 1, 0x010203, &values));
    put(icd_stream_send(&sender, FORMATS_POSITION_ID, data, 2, line, sizeof line, &size));
    put(packet(&sender, 0, 0x010299, NULL));
    assert(packet(&sender, 2, 0, NULL) == ICD_ERROR_RANGE);
    assert(packet(&sender, 4, 0, NULL) == ICD_ERROR_RANGE);
    assert(packet(&sender, 99, 0, NULL) == ICD_ERROR_RANGE);
    assert(packet(&sender, 1, 0x01000000, NULL) == ICD_ERROR_RANGE);
    values.of[ICD_FIELD_REASON] = 16;
    assert(packet(&sender, 1, 0, &values) == ICD_ERROR_RANGE);
    assert(icd_stream_send_packet(&sender, 1, 0, NULL, line, 3, &size) == ICD_ERROR_LENGTH);
    put(packet(&sender, 1, 0xFFFFFF, NULL));
    assert(icd_stream_sender_init(&sender, station_link(), ICD_TELEMETRY, sequences, STATION_SEQUENCES) == ICD_OK);
    sender.values.of[ICD_FIELD_SEQUENCE] = 5;
    values = sender.values;
    values.of[ICD_FIELD_SEQUENCE] = 77;
    values.of[ICD_FIELD_REASON] = 2;
    put(packet(&sender, 3, 0x10, &values));
    put(packet(&sender, 3, 0x10, NULL));
    put(icd_stream_send(&sender, STATION_POSITION_ID, data, 3, line, sizeof line, &size));
    put(icd_stream_send(&sender, STATION_POSITION_ID, data, 3, line, sizeof line, &size));
    put(packet(&sender, 2, 0x10, &values));
    return 0;
}
"""
RUST = """
use icd::wire::stream::{Sender, Values};
use icd::wire::{Direction, Error};
use icd::{formats, station};

fn put(line: &[u8], size: usize) {
    let text: String = line[..size].iter().map(|byte| format!("{byte:02x}")).collect();
    println!("{text}");
}

fn refused(result: Result<usize, Error>) -> &'static str {
    match result {
        Err(Error::Range { field, .. }) => field,
        other => panic!("{other:?}"),
    }
}

fn main() -> Result<(), Error> {
    let (mut line, none) = ([0; 600], Values::default());
    let mut sender = Sender::<formats::Node, { formats::SEQUENCES }>::with_direction(
        &formats::LINK,
        Direction::Telemetry,
    )?;
    sender.values.reason = Some(1);
    let values = Values { reason: Some(2), sequence: Some(77), ..none };
    let size = sender.put_packet(1, 0x01_0203, &values, &mut line)?;
    put(&line, size);
    let size = sender.put(0x01_0203, &[1, 2], &mut line)?;
    put(&line, size);
    let size = sender.put_packet(0, 0x01_0299, &none, &mut line)?;
    put(&line, size);
    for packet in [2, 4, 99] {
        assert_eq!(refused(sender.put_packet(packet, 0, &none, &mut line)), "packet");
    }
    assert_eq!(refused(sender.put_packet(1, 0x0100_0000, &none, &mut line)), "id");
    let large = Values { reason: Some(16), ..none };
    assert_eq!(refused(sender.put_packet(1, 0, &large, &mut line)), "reason");
    assert!(matches!(
        sender.put_packet(1, 0, &none, &mut line[..3]),
        Err(Error::Length { .. })
    ));
    assert_eq!(
        sender.send(&formats::Turn::default(), &mut line),
        Err(Error::UnknownId { id: 0x01_0203 })
    );
    let size = sender.put_packet(1, 0xFF_FFFF, &none, &mut line)?;
    put(&line, size);
    let mut sender = Sender::<station::Node, { station::SEQUENCES }>::with_direction(
        &station::LINK,
        Direction::Telemetry,
    )?;
    sender.values.sequence = Some(5);
    let size = sender.put_packet(3, 0x10, &values, &mut line)?;
    put(&line, size);
    let size = sender.put_packet(3, 0x10, &none, &mut line)?;
    put(&line, size);
    for _ in 0..2 {
        let size = sender.put(2, &[1, 2, 3], &mut line)?;
        put(&line, size);
    }
    let size = sender.put_packet(2, 0x10, &values, &mut line)?;
    put(&line, size);
    Ok(())
}
"""


def sender_of(node: str, **values: int) -> Sender:
    return Sender(link_of(ICD, facts.of(ICD, ICD.node(node))), "telemetry", values)


@pytest.fixture(scope="module")
def expected() -> list[str]:
    """The lines that Python sends."""
    sender, values = sender_of("formats", reason=1), {"reason": 2, "sequence": 77}
    lines = [
        sender.encode_packet(1, 0x010203, values),
        sender.encode(0x010203, b"\1\2"),
        sender.encode_packet(0, 0x010299, {}),
    ]
    for packet in (-1, 2, 4, 99):
        with pytest.raises(RangeError, match="packet"):
            sender.encode_packet(packet, 0, {})
    with pytest.raises(RangeError, match="id"):
        sender.encode_packet(1, 0x01000000, {})
    with pytest.raises(RangeError, match="reason"):
        sender.encode_packet(1, 0, {"reason": 16})
    lines.append(sender.encode_packet(1, 0xFFFFFF, {}))
    sender = sender_of("station", sequence=5)
    lines += [
        sender.encode_packet(3, 0x10, values),
        sender.encode_packet(3, 0x10, {}),
        sender.encode(2, b"\1\2\3"),
        sender.encode(2, b"\1\2\3"),
        sender.encode_packet(2, 0x10, values),
    ]
    return [line.hex() for line in lines]


def test_python_counts_packets_without_a_message_with_the_messages(expected):
    # Two flags of HDLC; 7E is escaped. Constants and reason, id, sequence, reserved bytes, checksum
    assert expected[0] == "7e7d5e21010302000000fa7e"
    assert [line[14:16] for line in (expected[1], expected[3])] == ["01", "02"]


def test_python_lets_the_caller_number_packets_if_each_id_has_a_sequence(expected):
    accepted, chosen, *positions, refused = expected[4:]
    assert accepted == "c523104d" and chosen == "c5231005"
    assert [line[6:8] for line in positions] == ["05", "06"]
    assert refused == "c52202" + "00" + "10" + "12"


def test_c_sends_the_same_packets(expected, tmp_path):
    folder = c.generate(ICD, tmp_path)
    (tmp_path / "send.c").write_text(C)
    options = ("-std=c99", *c.WARNINGS, *c.SANITIZERS, f"-I{folder}")
    program = c.compile(tmp_path / "send.c", *options, output=tmp_path / "send")
    done = subprocess.run([program], capture_output=True, text=True)
    assert (done.returncode, done.stdout.split()) == (0, expected), done.stderr


@pytest.mark.parametrize("name", toolchains())
def test_rust_sends_the_same_packets(name, expected, tmp_path):
    tools, crate = Toolchain(name), rust.generate(ICD, tmp_path)
    (tmp_path / "send.rs").write_text(RUST)
    program = tools.program(
        tmp_path / "send.rs", tools.library(crate, *USED), tmp_path / "send"
    )
    assert run(program).split() == expected
