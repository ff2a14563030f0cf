"""Damaged telemetry logs: complete entries are converted, damaged ones are left out and
reported, and clock jumps lose no entry.
"""

from __future__ import annotations

import csv
import io
import itertools
import json
import subprocess
import sys
from itertools import pairwise
from pathlib import Path
from random import Random

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from icdgen.icd.model import Icd
from icdgen.loading import load
from icdgen.logfile import integrity, parquet
from icdgen.logfile.source import open_source
from tests import links

COUNT = 60
FIRST = 1_700_000_000  # s
NAMES = ("noise", "zeros", "counter", "own time")
ICD_TEXT = """\
icdgen: 1
node: {name: probe, title: Probe, byte_order: little, bit_order: lsb0}
protocol:
  log_mask: {bytes: 1, frame_bytes: 40}
  telemetry_log:
    header: [{byte: 0, bytes: 1, name: Mask, role: mask, type: bytes}]
    entry:
      - {byte: 0, bytes: 4, name: S, role: seconds, type: uint}
      - {byte: 4, bytes: 2, name: M, role: milliseconds, type: uint}
    frames_byte: 6
loggable: [{bit: 0, id: 200}]
messages:
  - name: F
    id: 200
    kind: telemetry
    length: 40
    fields:
      - {at: 0, bits: 32, name: Number, type: uint}
      - {at: 32, bits: 288, name: Rest, type: bytes}
"""
ENTRY = 46


@pytest.fixture(scope="module")
def icd(tmp_path_factory) -> Icd:
    path = tmp_path_factory.mktemp("icd") / "probe.yaml"
    path.write_text(ICD_TEXT)
    loaded = load([path])
    assert loaded.icd is not None and loaded.ok, loaded.findings
    return loaded.icd


def frame(kind: str, number: int, seconds: int, milliseconds: int) -> bytes:
    """Return the data of an entry, which are unique in the log."""
    head = (number + 1).to_bytes(4, "little")
    if kind == "noise":
        return head + Random(number).randbytes(36)
    if kind == "zeros":
        return head + bytes(36)
    if kind == "counter":
        return head + b"".join(
            (number + at).to_bytes(4, "little") + bytes(2) for at in range(6)
        )
    time = seconds.to_bytes(4, "little") + milliseconds.to_bytes(2, "little")
    return head + bytes(10) + time + Random(number).randbytes(20)


def log_of(icd: Icd, kind: str, times: list[int]) -> tuple[bytes, list[bytes]]:
    """Return a log with entries at these milliseconds, and its entries as bytes."""
    entries = [
        (*divmod(t, 1000), [frame(kind, n, *divmod(t, 1000))])
        for n, t in enumerate(times)
    ]
    data = links.log_file(links.link(icd, "probe"), b"\x01", entries)
    return data, [
        data[at : at + ENTRY]
        for at in range(len(data) - ENTRY * len(times), len(data), ENTRY)
    ]


def steady(step: int = 1000) -> list[int]:
    return [FIRST * 1000 + n * step for n in range(COUNT)]


def read(icd: Icd, path: Path, data: bytes):
    path.write_bytes(data)
    source = open_source(icd, icd.nodes[0], path)
    text = b"".join(source.pieces(None))
    return [
        text[at : at + ENTRY] for at in range(0, len(text), ENTRY)
    ], source.integrity


@pytest.fixture(scope="module")
def path(tmp_path_factory) -> Path:
    return tmp_path_factory.mktemp("log") / "log.bin"


SIZES = st.sampled_from([1, 7, 20, 100]) | st.integers(1, 300)
PLACES = st.integers(6, ENTRY * COUNT - 1)
STEPS = st.sampled_from([10, 1000, 60_000, 3_600_000])


def hides_itself(kind: str, size: int) -> bool:
    """Return whether so many missing bytes move the copy of the time in the data to the
    place of the time.
    """
    return kind == "own time" and size % ENTRY in (20, ENTRY - 20)


@settings(max_examples=150, deadline=None, derandomize=True)
@given(kind=st.sampled_from(NAMES), place=PLACES, size=SIZES, step=STEPS)
def test_missing_bytes_lose_their_neighbourhood_and_invent_no_row(
    icd, path, kind, place, size, step
):
    assume(not hides_itself(kind, size))
    data, entries = log_of(icd, kind, steady(step))
    at = len(data) - ENTRY * COUNT + place
    rows, log = read(icd, path, data[:at] + data[at + size :])
    gone = {place // ENTRY + n for n in range(size // ENTRY + 2)}
    invented = set(rows) - set(entries)
    # If complete entries are missing, two halves remain in place. The row next to
    # a reported range may have a wrong time.
    assert len(invented) <= bool(log.damages or log.truncated or size % ENTRY == 0)
    assert len(rows) >= COUNT - len(gone) - 3
    is_cut_off = place % ENTRY == 0 and place + size >= ENTRY * COUNT
    if not is_cut_off and (
        entries[-1] not in rows or set(entries[: place // ENTRY]) - set(rows)
    ):
        assert log.damages or log.truncated


@settings(max_examples=150, deadline=None, derandomize=True)
@given(
    kind=st.sampled_from(NAMES),
    place=PLACES,
    size=SIZES,
    step=STEPS,
    filler=st.sampled_from(["noise", "00", "ff"]),
)
def test_inserted_bytes_lose_their_neighbourhood_and_invent_no_row(
    icd, path, kind, place, size, step, filler
):
    assume(not hides_itself(kind, size))
    data, entries = log_of(icd, kind, steady(step))
    at = len(data) - ENTRY * COUNT + place
    added = (
        Random(size).randbytes(size)
        if filler == "noise"
        else bytes.fromhex(filler) * size
    )
    rows, log = read(icd, path, data[:at] + added + data[at:])
    invented = set(rows) - set(entries)
    if place >= ENTRY * (COUNT - 1):
        assert len(invented) <= 1 and (
            log.truncated or log.damages
        )  # the last entry has no successor to compare with
    else:
        assert log.damages and len(invented) <= 1
    assert len(rows) >= COUNT - 5


@pytest.mark.parametrize(
    ("kind", "number", "size"),
    [("noise", 4, 98), ("zeros", 29, 263), ("counter", 57, 195)],
)
def test_zeros_after_the_first_byte_of_a_time_are_no_clock_jump(
    icd, path, kind, number, size
):
    data, entries = log_of(icd, kind, steady())
    at = len(data) - ENTRY * (COUNT - number) + 1  # the time becomes a few seconds
    rows, log = read(icd, path, data[:at] + bytes(size) + data[at:])
    assert log.damages and not log.jumps
    assert rows == entries[: number - 1] + entries[number + 1 :]


@settings(max_examples=150, deadline=None, derandomize=True)
@given(
    kind=st.sampled_from(NAMES),
    place=PLACES,
    size=SIZES,
    step=STEPS,
    seed=st.integers(0, 9),
)
def test_overwritten_bytes_lose_their_neighbourhood(
    icd, path, kind, place, size, step, seed
):
    data, entries = log_of(icd, kind, steady(step))
    start = len(data) - ENTRY * COUNT
    damaged = bytearray(data)
    size = min(size, ENTRY * COUNT - place)
    damaged[start + place : start + place + size] = Random(seed).randbytes(size)
    rows, log = read(icd, path, bytes(damaged))
    touched = range(place // ENTRY, (place + size - 1) // ENTRY + 1)
    # Data bytes have no redundancy: rows in which only they are damaged remain.
    touched_times = {entries[n][:6]: n for n in touched}
    wrong = [row for row in set(rows) - set(entries) if row[:6] not in touched_times]
    near = [row for row in wrong if any(_near(row, n, step) for n in touched)]
    assert len(wrong) - len(near) <= bool(
        log.damages or log.jumps or touched[0] == 0 or touched[-1] == COUNT - 1
    )
    assert len(rows) >= COUNT - len(touched) - 3


def _near(row: bytes, number: int, step: int) -> bool:
    """Return whether the damaged time is still between the times of its neighbours."""
    time = int.from_bytes(row[:4], "little") * 1000 + int.from_bytes(row[4:6], "little")
    return abs(time - steady(step)[number]) <= step


@settings(max_examples=100, deadline=None, derandomize=True)
@given(
    kind=st.sampled_from(NAMES),
    places=st.lists(st.integers(2, 10), min_size=1, max_size=5),
    size=st.integers(1, 45),
)
def test_several_damages_are_each_reported(icd, path, kind, places, size):
    data, entries = log_of(icd, kind, steady())
    damaged = bytearray(data)
    numbers = [12 * n + place for n, place in enumerate(places)]
    for number in reversed(numbers):
        at = len(data) - ENTRY * COUNT + number * ENTRY + 8
        del damaged[at : at + size]
    rows, log = read(icd, path, bytes(damaged))
    assert len(set(rows) - set(entries)) <= len(log.damages)
    assert len(log.damages) + bool(log.truncated) >= len(places) and len(
        rows
    ) >= COUNT - 3 * len(places)


JUMPS = st.lists(
    st.tuples(
        st.integers(1, COUNT - 1),
        st.sampled_from([-FIRST * 1000, -3_600_000, 3_600_000, 10**11, -(10**11)]),
    ),
    max_size=4,
)


@settings(max_examples=100, deadline=None, derandomize=True)
@given(kind=st.sampled_from(NAMES), jumps=JUMPS, step=STEPS)
def test_a_clock_that_is_set_loses_no_row(icd, path, kind, jumps, step):
    times, moved, places = steady(step), 0, dict(jumps)
    # A single entry in another time is damage: two more have to follow in the new one.
    assume(all(later - earlier > 2 for earlier, later in pairwise(sorted(places))))
    for number, time in enumerate(times):
        if number in places and time + moved + places[number] > 0:
            moved += places[number]
        times[number] = time + moved
    data, entries = log_of(icd, kind, times)
    rows, log = read(icd, path, data)
    assert rows == entries and not log.damages
    assert bool(log.jumps) == any(
        not 0 <= b - a <= max(60_000, 5 * step) for a, b in itertools.pairwise(times)
    )


def test_a_log_of_single_entries_between_pauses_is_complete(icd, path):
    times = [FIRST * 1000 + n * 100 for n in range(30)]
    for n in range(30):
        times.append(times[-1] + 3_600_000 + n * 60_000)
    data, entries = log_of(icd, "noise", times)
    rows, log = read(icd, path, data)
    assert rows == entries and not log.damages


@pytest.mark.parametrize("count", [0, 1, 2, 3])
@pytest.mark.parametrize("step", [0, 1000, 10**9, -(10**4)])
def test_a_short_log_is_complete(icd, path, count, step):
    data, entries = log_of(
        icd, "zeros", [FIRST * 1000 + n * step for n in range(count)]
    )
    rows, log = read(icd, path, data)
    assert rows == entries and not log.damages


def test_a_region_of_zeros_is_damage_and_no_restart_of_the_clock(icd, path):
    data, entries = log_of(icd, "noise", steady())
    at = len(data) - 30 * ENTRY
    for size in (3 * ENTRY, 10_000, 200_000):
        rows, log = read(icd, path, data[:at] + bytes(size) + data[at:])
        assert rows == entries[:29] + entries[30:] and len(log.damages) == 1, size


def test_times_are_found_without_numpy_as_well(icd, path, monkeypatch):
    data, _ = log_of(icd, "own time", steady())
    data = data[:500] + data[507:]
    fast = read(icd, path, data)
    monkeypatch.setattr(integrity, "_has_numpy", lambda: False)
    assert read(icd, path, data) == fast


def icdgen(*words: object) -> subprocess.CompletedProcess:
    command = [sys.executable, "-m", "icdgen", "log", *map(str, words)]
    return subprocess.run(command, capture_output=True, text=True, timeout=120)


def test_every_format_leaves_out_the_same_damage_and_ends_with_status_1(icd, tmp_path):
    import pyarrow.parquet as pq

    data, _entries = log_of(icd, "noise", steady())
    start, source = len(data) - ENTRY * COUNT, tmp_path / "probe.yaml"
    at = start + 20 * ENTRY + 9
    log = tmp_path / "log.bin"
    log.write_bytes(data[:at] + data[at + 7 :])
    source.write_text(ICD_TEXT)
    place = f"damaged: bytes {start + 20 * ENTRY:,} to {start + 21 * ENTRY - 8:,} (39 bytes); about 1 row is left out"
    listed = icdgen(log, "--icd", source)
    assert (
        listed.returncode == 1
        and place in listed.stdout
        and "59 entries" in listed.stdout
    )
    expected = [n + 1 for n in range(COUNT) if n != 20]
    for form in ("csv", "jsonl"):
        result = icdgen(log, "--icd", source, "--format", form)
        assert result.returncode == 1 and place in result.stderr
        if form == "csv":
            numbers = [
                int(row["f__number"])
                for row in csv.DictReader(io.StringIO(result.stdout))
            ]
        else:
            numbers = [
                json.loads(line)["f__number"] for line in result.stdout.splitlines()
            ]
        assert numbers == expected
    result = icdgen(log, "--icd", source, "--out", tmp_path / "out.parquet")
    assert result.returncode == 1 and place in result.stderr
    assert pq.read_table(tmp_path / "out.parquet")["f__number"].to_pylist() == expected
    # The damage is after the limit.
    assert (
        icdgen(log, "--icd", source, "--format", "csv", "--head", "5").returncode == 0
    )


def test_damage_between_two_decoded_chunks_is_reported(
    icd, path, tmp_path, monkeypatch
):
    import pyarrow.parquet as pq

    data, _entries = log_of(icd, "noise", steady())
    path.write_bytes(data[:1000] + data[1007:])
    for piece in (1, ENTRY, 500):
        monkeypatch.setattr(parquet, "PIECE", piece)
        parquet.to_parquet(
            open_source(icd, icd.nodes[0], path),
            tmp_path / "out",
            None,
            lambda size: None,
        )
        numbers = pq.read_table(tmp_path / "out")["f__number"].to_pylist()
        assert len(numbers) == COUNT - 1 and numbers == sorted(
            set(range(1, COUNT + 1)) & set(numbers)
        )


def test_damage_at_the_border_of_the_first_entries_leaves_the_others(icd, path):
    """Although their data contain the time, too."""
    data, entries = log_of(icd, "own time", steady(1000))
    start = len(data) - ENTRY * COUNT
    for place in range(25, 43):
        damaged = bytearray(data)
        damaged[start + place : start + place + 24] = Random(0).randbytes(24)
        rows, _ = read(icd, path, bytes(damaged))
        assert rows[-(COUNT - 2) :] == entries[2:], place
