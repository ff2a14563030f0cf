"""The wire layer handles logs, times, identification, assumptions and errors."""

from __future__ import annotations

import io
import pickle
import tokenize

import pytest

from icdgen.protocol import facts
from tests.python.wire import link


@pytest.fixture(scope="module")
def wire(shipped):
    return shipped.module("wire")


def test_a_link_is_printed_in_one_line(shipped):
    assert repr(link(shipped)) == "Link(node='cubeacp', ...)"


def test_frames_of_logs_are_decoded_unless_their_bit_is_unassigned(shipped, wire):
    like = link(shipped)
    bits = {bit.id: bit.bit for bit in like.mask.bits.values()}
    mask = bytearray(10)
    for bit in (bits[146], 79):
        mask[bit // 8] |= 1 << bit % 8
    assert 79 not in like.mask.bits
    message = shipped.module("cubeacp").EstimatedAttitudeAngles(
        estimated_roll_angle=-1234
    )
    writer = wire.LogWriter(like, bytes(mask))
    file = writer.header() + writer.entry(7, 8, [message.to_bytes(), b"unused"])
    (entry,) = wire.LogReader(like).feed(file)
    assert entry.frames[0].message(like) == message
    assert entry.frames[1] == (79, None, b"unused")
    with pytest.raises(wire.UnsupportedError, match="79"):
        entry.frames[1].message(like)
    log = wire.LogMessage.encode(like, bytes(mask), [message.to_bytes(), b"unused"])
    assert wire.LogMessage.decode(like, log) == (bytes(mask), entry.frames)


def test_log_writer_and_reader_refuse_invalid_input(shipped, wire):
    like, errors = link(shipped), shipped.module()
    with pytest.raises(errors.LengthError, match="mask"):
        wire.LogWriter(like, b"\1")
    writer = wire.LogWriter(like, bytes(10))
    with pytest.raises(errors.LengthError, match="frames"):
        writer.entry(0, 0, [b""])
    with pytest.raises(errors.RangeError, match="seconds"):
        writer.entry(1 << 32, 0, [])
    with pytest.raises(errors.LengthError):
        wire.LogMessage.decode(like, b"\xff\0")
    bootloader = link(shipped, "bootloader")
    with pytest.raises(wire.UnsupportedError):
        wire.LogReader(bootloader)


def test_an_invalid_packed_time_is_unpacked_and_marked_invalid(shipped, wire):
    time = wire.dos_time_unpack(link(shipped), 0)
    assert time == (1980, 0, 0, 0, 0, 0) and not time.is_valid


def test_a_node_is_identified(shipped, wire):
    acp = shipped.module("cubeacp")
    frame = acp.Identification(
        node_type=acp.NODE_TYPE, interface_version=acp.INTERFACE_VERSION
    )
    assert wire.identify(acp.LINK, frame.to_bytes()) == (
        acp.NODE_TYPE,
        acp.INTERFACE_VERSION,
        True,
    )
    frame.interface_version += 1
    assert not wire.identify(acp.LINK, frame.to_bytes()).matches


def test_a_link_lists_its_assumptions(shipped):
    assumptions = {}
    for assumption in link(shipped).assumptions:
        assumptions[assumption.section, assumption.key] = assumption
    (field,) = assumptions["link.packets.telecommand", "trailer"].value
    assert field["covers"] == {"from": "data", "to": "data"}
    assert all(assumption.why for assumption in assumptions.values())
    expected = facts.of(shipped.icd, shipped.icd.node("cubeacp"))
    assert {(a.section, a.key) for a in expected.assumptions} == set(assumptions)


def test_errors_can_be_pickled(wire, shipped):
    for error in (
        wire.TooLongError(8, 9),
        wire.ChecksumError(1, 2),
        wire.FailedError("rounds"),
    ):
        copied_error = pickle.loads(pickle.dumps(error))
        assert (type(copied_error), str(copied_error)) == (type(error), str(error))
        assert isinstance(copied_error, shipped.module().IcdError)


def comments(source: str) -> str:
    """Join the comments of a module into one text."""
    tokens = tokenize.generate_tokens(io.StringIO(source).readline)
    return " ".join(
        token.string.lstrip("# ") for token in tokens if token.type == tokenize.COMMENT
    )


@pytest.mark.parametrize("node", ["cubeacp", "bootloader", "common"])
def test_every_assumption_has_its_reason_in_a_comment(shipped, node):
    text = comments(
        (shipped.folder / "icdgen_messages" / node / "_link.py").read_text("utf-8")
    )
    link = shipped.module(node).LINK
    assert len(link.assumptions) > 20
    # The link does not contain these: one is about a message, one about the device.
    elsewhere = {"unsolicited_log.configured_by", "boot"}
    for assumption in link.assumptions:
        if assumption.section not in elsewhere:
            assert " ".join(assumption.why.split()) in text, assumption


def test_the_reason_is_above_the_assumed_value(shipped):
    lines = (
        (shipped.folder / "icdgen_messages" / "cubeacp" / "_link.py")
        .read_text("utf-8")
        .splitlines()
    )
    above = {
        line.strip(): lines[number - 1].strip() for number, line in enumerate(lines)
    }
    assert above["retries=3,"] == "# Assumed: Nothing is said about trying again."
    assert (
        above["packet_timeout=1000,"]
        == "# Assumed: No time-out between packets is given."
    )
    assert not above["packets=256,"].startswith("#")
