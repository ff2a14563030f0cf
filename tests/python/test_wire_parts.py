"""Checksums, I2C, logs, files and times, held against the reference and against what
users rely on.
"""

from __future__ import annotations

import io
import pickle
import tokenize
from dataclasses import replace
from datetime import datetime

import pytest
from hypothesis import given
from hypothesis import strategies as st

from icdgen.protocol import crc
from icdgen.protocol.sections import Crc
from tests.python.wire import cut, known, link


def crcs_of(width: int) -> st.SearchStrategy[Crc]:
    numbers = st.integers(0, (1 << width) - 1)
    return st.builds(
        Crc,
        width=st.just(width),
        polynomial=numbers,
        init=numbers,
        reflect_in=st.booleans(),
        reflect_out=st.booleans(),
        xor_out=numbers,
        empty=st.none() | numbers,
    )


CRCS = st.integers(1, 32).flatmap(crcs_of)


@pytest.fixture(scope="module")
def wire(shipped):
    return shipped.module("wire")


def test_a_link_is_shown_in_a_line(shipped):
    assert repr(link(shipped)) == "Link(node='cubeacp', ...)"


@given(
    form=CRCS,
    data=st.binary(max_size=40),
    places=st.lists(st.integers(0, 40), max_size=4),
    table=st.booleans(),
)
def test_crcs_of_all_kinds_with_and_without_a_table_in_pieces(
    shipped, wire, form, data, places, table
):
    made = shipped.module("wire.link").CrcForm(
        *(getattr(form, name) for name in form.__dataclass_fields__)
    )
    register = wire.Crc(made, table=table)
    for piece in cut(data, places):
        register.feed(piece)
    assert register.result() == crc.compute(form, data)


@given(data=st.binary(max_size=60))
def test_the_crcs_of_the_node_are_those_of_the_reference(shipped, wire, data):
    assert wire.crc8(link(shipped), data) == crc.compute(known().checksum.crc, data)
    assert wire.crc16(link(shipped), data) == crc.compute(known().crc16, data)
    assert wire.Crc(link(shipped).crc16, table=False).feed(
        data
    ).result() == crc.compute(known().crc16, data)


def test_check_values(shipped, wire):
    assert wire.crc8(link(shipped), b"123456789") == 0x25
    assert wire.crc16(link(shipped), b"123456789") == 0x31C3
    assert wire.crc8(link(shipped), b"") == 0xFF


def test_i2c_buffers_with_and_without_checksum(shipped, wire):
    like, errors = link(shipped), shipped.module()
    assert wire.i2c_write(like, 31, b"\x01") == b"\x1f\x01"
    sum_ = wire.crc8(like, b"\x01")
    assert wire.i2c_write(like, 31, b"\x01", crc=True) == bytes((31, 1, sum_))
    assert (
        wire.i2c_read_length(like, 146),
        wire.i2c_read_length(like, 146, crc=True),
    ) == (6, 7)
    frame = bytes(range(6))
    assert wire.i2c_reply(like, 146, frame) == frame
    assert (
        wire.i2c_reply(like, 146, frame + bytes((wire.crc8(like, frame),)), crc=True)
        == frame
    )
    with pytest.raises(wire.ChecksumError) as error:
        wire.i2c_reply(
            like, 146, frame + bytes((wire.crc8(like, frame) ^ 1,)), crc=True
        )
    assert error.value.expected ^ error.value.actual == 1
    with pytest.raises(errors.LengthError):
        wire.i2c_reply(like, 146, frame, crc=True)
    with pytest.raises(errors.UnknownIdError):
        wire.i2c_reply(like, 31, frame)


def test_the_checksum_covers_the_id_where_the_icd_says_so(shipped, wire):
    like = link(shipped)
    covering = like._replace(checksum=like.checksum._replace(covers_id=True))
    reference = replace(known(), checksum=replace(known().checksum, covers_id=True))
    expected = crc.compute(reference.checksum.crc, b"\x1f\x01")
    assert wire.i2c_write(covering, 31, b"\x01", crc=True) == bytes((31, 1, expected))


MASK = bytes([0x21, 0x80, 0, 0, 0, 0, 0, 0, 0, 0x80])


def entries(wire, like, count: int) -> tuple[bytes, list]:
    """A log file, and its entries as (seconds, milliseconds, frames)."""
    writer = wire.LogWriter(like, MASK)
    lengths = [bit.length for bit in like.mask.selected(MASK)]
    rows = [
        (1_700_000_000 + n, n % 1000, [bytes((n % 256,)) * size for size in lengths])
        for n in range(count)
    ]
    return writer.header() + b"".join(writer.entry(*row) for row in rows), rows


@given(
    places=st.lists(st.integers(0, 400), max_size=10),
    count=st.integers(0, 12),
    lost=st.integers(0, 30),
)
def test_a_log_is_read_in_pieces_of_any_size_and_what_is_cut_off_is_counted(
    shipped, wire, places, count, lost
):
    like = link(shipped)
    file, rows = entries(wire, like, count)
    size = (len(file) - 10) // count if count else 0
    given = file[: len(file) - min(lost, len(file))]
    reader = wire.LogReader(like)
    found = [entry for piece in cut(given, places) for entry in reader.feed(piece)]
    if len(given) < 10:
        assert (found, reader.mask, reader.truncated) == ([], None, len(given))
        return
    whole = (len(given) - 10) // size if size else 0
    assert reader.mask == MASK
    assert [
        (e.seconds, e.milliseconds, [f.data for f in e.frames]) for e in found
    ] == rows[:whole]
    assert reader.truncated == len(given) - 10 - whole * size


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


@given(
    st.datetimes(
        min_value=datetime(1980, 1, 1), max_value=datetime(2107, 12, 31, 23, 59, 59)
    )
)
def test_times_come_back_to_two_seconds(shipped, wire, moment):
    like = link(shipped)
    time = wire.dos_time_unpack(like, wire.dos_time_pack(like, moment))
    assert time.is_valid
    assert time.datetime() == moment.replace(
        second=moment.second // 2 * 2, microsecond=0
    )


@pytest.mark.parametrize(
    ("time", "part"),
    [
        ((1979, 1, 1, 0, 0, 0), "year"),
        ((2108, 1, 1, 0, 0, 0), "year"),
        ((2000, 13, 40, 0, 0, 0), "month"),
        ((2001, 2, 29, 0, 0, 0), "day"),
        ((2000, 2, 29, 24, 0, 0), "hour"),
        ((2000, 1, 1, 0, 60, 99), "minute"),
        ((2000, 1, 1, 0, 0, 60), "second"),
    ],
)
def test_times_that_do_not_exist_are_refused_by_their_first_part(
    shipped, wire, time, part
):
    with pytest.raises(shipped.module().RangeError) as error:
        wire.dos_time_pack(link(shipped), wire.DosTime(*time))
    assert error.value.field == part


def test_a_packed_time_that_no_calendar_has_is_unpacked_all_the_same(shipped, wire):
    time = wire.dos_time_unpack(link(shipped), 0)
    assert time == (1980, 0, 0, 0, 0, 0) and not time.is_valid


@given(packets=st.integers(0, 1024), data=st.data())
def test_hole_maps_come_back(shipped, wire, packets, data):
    like = link(shipped)
    received = data.draw(st.sets(st.integers(0, packets - 1))) if packets else set()
    made = wire.HoleMap(like, packets, received)
    assert (made.count(), made.missing()) == (
        len(received),
        sorted(set(range(packets)) - received),
    )
    again = wire.HoleMap.from_bytes(like, packets, made.to_bytes())
    assert again.missing() == made.missing()
    assert b"".join(made.messages()) == made.to_bytes()


def test_hole_maps_refuse_packets_that_the_block_does_not_have(shipped, wire):
    like, errors = link(shipped), shipped.module()
    made = wire.HoleMap(like, 3)
    for number in (-1, 3):
        with pytest.raises(errors.RangeError):
            made.set(number)
    with pytest.raises(errors.RangeError):
        wire.HoleMap(like, 1025)
    with pytest.raises(errors.LengthError):
        wire.HoleMap.from_bytes(like, 3, b"")


def test_index_files_come_back_and_what_is_cut_off_is_counted(shipped, wire):
    like = link(shipped)
    rows = [wire.IndexEntry(2, n, 65535 - n, 1 << n, n, bytes(25)) for n in range(5)]
    file = wire.write_index(like, rows)
    assert wire.read_index(like, file) == (rows, 0)
    assert wire.read_index(like, file[:-1]) == (rows[:-1], 36)
    with pytest.raises(shipped.module().RangeError, match="type"):
        wire.write_index(like, [rows[0]._replace(type=256)])


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
    assert found["crc8", "covers_id"].value is False
    assert all(one.why for one in found.values())
    assert {(one.section, one.key) for one in known().assumptions} == set(found)


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
    if link.files.upload is None:
        elsewhere.add("file_transfer.upload")  # another program takes them
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
