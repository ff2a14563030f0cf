"""Logs, packed times, packet maps, the index file and checksums on I2C are encoded and
decoded.
"""

from __future__ import annotations

from datetime import datetime

import pytest
from hypothesis import given
from hypothesis import strategies as st
from icdgen_runtime._errors import LengthError, RangeError, UnknownIdError
from icdgen_runtime.wire.errors import ChecksumError
from icdgen_runtime.wire.files import IndexEntry, read_index, write_index
from icdgen_runtime.wire.i2c import i2c_read_length, i2c_reply, i2c_write
from icdgen_runtime.wire.logs import LogFrame, LogMessage, LogReader
from icdgen_runtime.wire.times import DosTime, dos_time_pack, dos_time_unpack

from tests import links
from tests.icd.files import loaded
from tests.protocol import cut, quick

# The frame of the included node is longer than the slots of the node.
CUT_FRAMES = """\
include: [common.yaml]
protocol:
  log_mask: {bytes: 1, frame_bytes: 2}
  telemetry_log:
    header: [{byte: 0, bytes: 1, name: Mask, role: mask, type: bytes}]
    entry:
      - {byte: 0, bytes: 4, name: Seconds, role: seconds, type: uint}
      - {byte: 4, bytes: 2, name: Milliseconds, role: milliseconds, type: uint}
    frames_byte: 6
loggable: [{bit: 1, id: 131}]
messages:
  - {name: Brief, id: 131, kind: telemetry, length: 2}
# common.yaml
icdgen: 1
node: {name: common, title: Common, byte_order: little, bit_order: lsb0}
loggable: [{bit: 0, id: 130}]
messages:
  - {name: Wide, id: 130, kind: telemetry, length: 4}
"""


def mask(*bits: int) -> bytes:
    return sum(1 << bit for bit in bits).to_bytes(10, "little")


def test_frames_follow_the_bits_of_the_mask(link):
    file = links.log_file(link, mask(28, 0), [(5, 7, [b"status", b"angles"])])
    assert file.hex() == "01000010000000000000" + "050000000700" + b"statusangles".hex()
    assert LogReader(link).feed(file) == [
        (5, 7, (LogFrame(0, 144, b"status"), LogFrame(28, 146, b"angles")))
    ]


def test_short_frames_fill_their_slot_and_unassigned_bits_have_one(link):
    file = links.log_file(link, mask(2, 21), [(0, 0, [b"free!!", b"four"])])
    assert len(file) == 10 + 6 * 3
    (entry,) = LogReader(link).feed(file)
    assert entry.frames == (LogFrame(2, None, b"free!!"), LogFrame(21, 171, b"four"))


def test_a_frame_longer_than_its_slot_ends_with_the_slot(tmp_path):
    icd = loaded(tmp_path, CUT_FRAMES).icd
    reader = LogReader(links.link(icd, "demo"))
    assert reader.feed(b"\x03" + b"\x05\0\0\0\x07\0" + b"wibr") == [
        (5, 7, (LogFrame(0, 130, b"wi"), LogFrame(1, 131, b"br")))
    ]


@quick
@given(
    bits=st.sets(st.integers(0, 79), max_size=20),
    count=st.integers(0, 3),
    lost=st.integers(0, 100),
    places=st.lists(st.integers(0, 400), max_size=10),
)
def test_a_log_is_read_in_pieces_of_any_size_and_truncated_bytes_are_counted(
    link, bits, count, lost, places
):
    chosen = mask(*bits)
    lengths = [slot.length for slot in link.mask.selected(chosen)]
    rows = [(n, 7 * n, [bytes([n]) * size for size in lengths]) for n in range(count)]
    file = links.log_file(link, chosen, rows)
    size = 6 + 6 * len(bits)
    assert len(file) == 10 + size * count
    part, reader = file[: max(0, len(file) - lost)], LogReader(link)
    entries = [entry for piece in cut(part, places) for entry in reader.feed(piece)]
    if len(part) < 10:
        assert (reader.mask, entries, reader.truncated) == (None, [], len(part))
    else:
        assert reader.mask == chosen
        entry_count, remaining_bytes = divmod(len(part) - 10, size)
        assert reader.truncated == remaining_bytes
        decoded = [(e.seconds, e.milliseconds, [f.data for f in e.frames]) for e in entries]  # fmt: skip
        assert decoded == rows[:entry_count]


def test_an_unsolicited_log_has_id_mask_and_frames(link):
    message = LogMessage.encode(link, mask(0), [b"status"])
    assert message.hex() == "ff" + mask(0).hex() + b"status".hex()
    frames = (LogFrame(0, 144, b"status"),)
    assert LogMessage.decode(link, message) == (mask(0), frames)
    with pytest.raises(LengthError):
        LogMessage.decode(link, message + b"\0")


@quick
@given(st.datetimes(datetime(1980, 1, 1), datetime(2107, 12, 31, 23, 59, 59)))
def test_packed_times_come_back_to_two_seconds(link, moment):
    value = dos_time_pack(link, moment)
    assert value == (
        moment.year - 1980
    ) << 25 | moment.month << 21 | moment.day << 16 | moment.hour << 11 | (
        moment.minute << 5 | moment.second >> 1
    )
    even = moment.replace(second=moment.second // 2 * 2, microsecond=0)
    assert dos_time_unpack(link, value).datetime() == even


@quick
@given(st.integers(0, (1 << 32) - 1))
def test_a_time_is_valid_if_the_calendar_has_it(link, value):
    time = dos_time_unpack(link, value)
    try:
        datetime(*time)
        is_in_calendar = True
    except ValueError:
        is_in_calendar = False
    assert time.is_valid == is_in_calendar


@pytest.mark.parametrize(
    ("date", "named"),
    [
        ((1979, 1, 1, 0, 0, 0), "year"),
        ((2108, 1, 1, 16, 0, 0), "year"),
        ((2108, 13, 1, 16, 0, 0), "month"),
        ((2001, 2, 29, 0, 0, 0), "day"),
        ((2108, 1, 32, 16, 60, 0), "day"),
        ((2021, 1, 1, 16, 0, 0), "hour"),
        ((2000, 2, 29, 24, 0, 0), "hour"),
        ((2000, 1, 1, 0, 60, 99), "minute"),
        ((2000, 1, 1, 0, 0, 60), "second"),
    ],
)
def test_the_first_bad_part_of_a_time_is_named_from_the_year_on(link, date, named):
    narrow = link.time | {"hour": link.time["hour"]._replace(bits=4)}
    with pytest.raises(RangeError) as caught:
        dos_time_pack(link._replace(time=narrow), DosTime(*date))
    assert caught.value.field == named


@quick
@given(
    st.lists(
        st.tuples(
            *(st.integers(0, (1 << bits) - 1) for bits in (8, 8, 16, 32, 32)),
            st.binary(min_size=25, max_size=25),
        )
    )
)
def test_the_index_file_comes_back(link, rows):
    entries = [IndexEntry(*row) for row in rows]
    data = write_index(link, entries)
    assert len(data) == 37 * len(rows)
    assert read_index(link, data) == (entries, 0)
    assert read_index(link, data + bytes(36)) == (entries, 36)


def test_a_number_that_does_not_fit_the_index_file_is_rejected(link):
    with pytest.raises(RangeError, match="type"):
        write_index(link, [IndexEntry(256, 0, 0, 0, 0, bytes(25))])


def test_a_telecommand_without_parameters_has_a_checksum_too(link):
    assert i2c_write(link, 63, b"", True).hex() == "3fff"
    assert i2c_write(link, 63, b"", False).hex() == "3f"


def test_the_checksum_covers_the_id_if_the_icd_requires_it(link):
    for covers_id, data in ((False, b"\x01"), (True, b"\x1f\x01")):
        form = link.checksum._replace(covers_id=covers_id)
        written = i2c_write(link._replace(checksum=form), 31, b"\x01", crc=True)
        assert written == bytes([31, 1, links.crc(link.checksums["crc8"].crc, data)])


@quick
@given(frame=st.binary(min_size=6, max_size=6), bit=st.integers(0, 47))
def test_a_reply_with_a_wrong_bit_is_rejected(link, frame, bit):
    read = i2c_write(link, 146, frame, True)[1:]
    assert len(read) == i2c_read_length(link, 146, crc=True)
    assert i2c_reply(link, 146, read, True) == i2c_reply(link, 146, frame) == frame
    wrong = bytes(
        b ^ (1 << bit % 8 if n == bit // 8 else 0) for n, b in enumerate(read)
    )
    with pytest.raises(ChecksumError) as caught:
        i2c_reply(link, 146, wrong, True)
    assert (caught.value.expected, caught.value.actual) == (links.crc(link.checksums["crc8"].crc, wrong[:6]), read[6])  # fmt: skip


def test_a_reply_of_another_length_or_id_is_rejected(link):
    with pytest.raises(LengthError):
        i2c_reply(link, 146, bytes(6), crc=True)
    with pytest.raises(UnknownIdError):
        i2c_reply(link, 31, bytes(6))
