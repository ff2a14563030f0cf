"""Logs, packed times, hole maps and the index file."""

from __future__ import annotations

from dataclasses import replace
from datetime import datetime

import pytest
from hypothesis import given
from hypothesis import strategies as st

from icdgen.protocol import errors, files, i2c, logs, times
from tests.protocol import quick


def mask(*bits: int) -> bytes:
    return sum(1 << bit for bit in bits).to_bytes(10, "little")


def test_frames_follow_the_bits_of_the_mask(known):
    file = logs.encode(known, mask(28, 0), [(5, 7, [b"status", b"angles"])])
    assert file.hex() == "01000010000000000000" + "050000000700" + b"statusangles".hex()
    log = logs.decode(known, file)
    assert log.entries == [
        logs.Entry(
            5, 7, (logs.Frame(0, 144, b"status"), logs.Frame(28, 146, b"angles"))
        )
    ]


def test_short_frames_fill_their_slot_and_unassigned_bits_have_one(known):
    file = logs.encode(known, mask(2, 21), [(0, 0, [b"free!!", b"four"])])
    assert len(file) == 10 + 6 * 3
    assert logs.decode(known, file).entries[0].frames == (
        logs.Frame(2, None, b"free!!"),
        logs.Frame(21, 171, b"four"),
    )


@quick
@given(
    bits=st.sets(st.integers(0, 79), max_size=20),
    count=st.integers(0, 3),
    cut=st.integers(0, 100),
    piece=st.integers(1, 50),
)
def test_a_truncated_log_gives_its_whole_entries_and_says_what_is_left(
    known, bits, count, cut, piece
):
    chosen = mask(*bits)
    data = [bytes(slot.length) for slot in known.mask.selected(chosen)]
    file = logs.encode(known, chosen, [(n, n, data) for n in range(count)])
    size = 6 + 6 * len(bits)
    assert len(file) == 10 + size * count
    part = file[: max(0, len(file) - cut)]
    log = logs.decode(known, part)
    if len(part) < 10:
        assert (log.mask, log.entries, log.truncated) == (None, [], len(part))
    else:
        assert log.mask == chosen
        assert (len(log.entries), log.truncated) == divmod(len(part) - 10, size)


def test_an_unsolicited_log_has_id_mask_and_frames(known):
    message = logs.encode_message(known, mask(0), [b"status"])
    assert message.hex() == "ff" + mask(0).hex() + b"status".hex()
    assert logs.decode_message(known, message) == (
        mask(0),
        (logs.Frame(0, 144, b"status"),),
    )
    with pytest.raises(errors.LengthError):
        logs.decode_message(known, message + b"\0")


@quick
@given(st.datetimes(datetime(1980, 1, 1), datetime(2107, 12, 31, 23, 59, 59)))
def test_packed_times_come_back_to_two_seconds(known, moment):
    parts = {name: getattr(moment, name) for name in times.PARTS}
    value = times.pack(known, parts)
    assert value == (
        moment.year - 1980
    ) << 25 | moment.month << 21 | moment.day << 16 | moment.hour << 11 | (
        moment.minute << 5 | moment.second >> 1
    )
    assert times.unpack(known, value) == {**parts, "second": moment.second // 2 * 2}


@quick
@given(st.integers(0, (1 << 32) - 1))
def test_a_time_is_valid_if_the_calendar_has_it(known, value):
    parts = times.unpack(known, value)
    try:
        datetime(**parts)
        there = True
    except ValueError:
        there = False
    assert (times.invalid_part(parts) is None) == there


@quick
@given(count=st.integers(0, 1024), seed=st.randoms(use_true_random=False))
def test_a_hole_map_names_what_is_missing(known, count, seed):
    received = {number for number in range(count) if seed.random() < 0.9}
    map_ = files.hole_map(known, count, received)
    lost = [i for i in range(1024) if (map_[i >> 3] & (1 << (i & 7))) == 0]
    assert (
        lost
        == sorted(set(range(count)) - received)
        == files.missing(known, count, map_)
    )
    assert (
        b"".join(files.in_messages(known, map_)) == map_
        and len(files.in_messages(known, map_)) == 8
    )


@quick
@given(
    st.lists(
        st.tuples(
            *(st.integers(0, (1 << bits) - 1) for bits in (8, 8, 16, 32, 32)),
            st.binary(min_size=25, max_size=25),
        )
    )
)
def test_the_index_file_comes_back(known, rows):
    entries = [files.IndexEntry(*row) for row in rows]
    data = files.write_index(known, entries)
    assert len(data) == 37 * len(rows)
    assert files.read_index(known, data) == (entries, 0)
    assert files.read_index(known, data + bytes(36)) == (entries, 36)


def test_a_telecommand_without_parameters_has_a_checksum_too(known):
    assert i2c.telecommand(known, 63, b"", True).hex() == "3fff"
    assert i2c.telecommand(known, 63, b"", False).hex() == "3f"


@quick
@given(frame=st.binary(min_size=6, max_size=6), bit=st.integers(0, 47))
def test_a_reply_with_a_wrong_bit_is_refused(known, frame, bit):
    read = i2c.telecommand(known, 146, frame, True)[1:]
    assert i2c.reply(known, 146, read, True) == frame
    wrong = bytes(
        b ^ (1 << bit % 8 if n == bit // 8 else 0) for n, b in enumerate(read)
    )
    with pytest.raises(errors.ChecksumError):
        i2c.reply(known, 146, wrong, True)


@pytest.mark.parametrize(
    ("date", "named"),
    [
        ((2108, 13, 1, 16, 0, 0), "month"),
        ((2108, 1, 1, 16, 0, 0), "year"),
        ((2021, 1, 1, 16, 0, 0), "hour"),
        ((2108, 1, 32, 16, 60, 0), "day"),
    ],
)
def test_the_first_bad_part_of_a_time_is_named_from_the_year_on(known, date, named):
    narrow = replace(
        known, time=known.time | {"hour": replace(known.time["hour"], bits=4)}
    )
    with pytest.raises(errors.RangeError) as caught:
        times.pack(narrow, dict(zip(times.PARTS, date, strict=True)))
    assert caught.value.field == named
