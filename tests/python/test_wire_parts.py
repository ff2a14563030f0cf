"""Logs, times, identification, assumptions and errors of the generated package."""

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


def test_a_link_is_shown_in_a_line(shipped):
    assert repr(link(shipped)) == "Link(node='cubeacp', ...)"


def test_frames_of_logs_become_messages_and_unassigned_bits_do_not(shipped, wire):
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
    whole = wire.LogMessage.encode(like, bytes(mask), [message.to_bytes(), b"unused"])
    assert wire.LogMessage.decode(like, whole) == (bytes(mask), entry.frames)


def test_logs_refuse_what_does_not_fit(shipped, wire):
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


def test_a_packed_time_that_no_calendar_has_is_unpacked_all_the_same(shipped, wire):
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


def test_assumptions_are_data(shipped):
    found = {(one.section, one.key): one for one in link(shipped).assumptions}
    (field,) = found["link.packets.telecommand", "trailer"].value
    assert field["covers"] == {"from": "data", "to": "data"}
    assert all(one.why for one in found.values())
    known = facts.of(shipped.icd, shipped.icd.node("cubeacp"))
    assert {(one.section, one.key) for one in known.assumptions} == set(found)


def test_errors_survive_being_pickled(wire, shipped):
    for error in (
        wire.TooLongError(8, 9),
        wire.ChecksumError(1, 2),
        wire.FailedError("rounds"),
    ):
        again = pickle.loads(pickle.dumps(error))
        assert (type(again), str(again)) == (type(error), str(error))
        assert isinstance(again, shipped.module().IcdError)


def comments(source: str) -> str:
    """The comments of a module as one text."""
    tokens = tokenize.generate_tokens(io.StringIO(source).readline)
    return " ".join(
        token.string.lstrip("# ") for token in tokens if token.type == tokenize.COMMENT
    )


@pytest.mark.parametrize("node", ["cubeacp", "bootloader", "common"])
def test_what_is_assumed_has_its_reason_in_a_comment(shipped, node):
    told = comments(
        (shipped.folder / "icdgen_messages" / node / "_link.py").read_text("utf-8")
    )
    link = shipped.module(node).LINK
    assert len(link.assumptions) > 20
    elsewhere = {
        "unsolicited_log.configured_by",
        "boot",
    }  # no part of the link: of a message, of the device alone
    rest = [one for one in link.assumptions if one.section not in elsewhere]
    assert [one for one in rest if " ".join(one.why.split()) not in told] == []


def test_the_reason_stands_above_the_value_that_is_assumed(shipped):
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
