"""Log files: their node, header, pieces of entries, times, and notes about damage."""

from __future__ import annotations

import pytest

from icdgen.errors import UserError
from icdgen.icd.model import Icd
from icdgen.loading import load
from icdgen.logfile.integrity import Damage, EntrySpan, Integrity, TimeJump
from icdgen.logfile.log import open_log
from icdgen.logfile.source import (
    LogSource,
    node_of,
    open_source,
    time_text,
)
from tests.limits import assert_limits

ICD = """\
icdgen: 1
node: {{name: {name}, title: Logger, byte_order: {order}, bit_order: lsb0}}
protocol:
  log_mask: {{bytes: 1, bit_order: lsb0, frame_bytes: 2}}
  telemetry_log:
    header: [{{byte: 2, bytes: 1, name: Mask, role: mask, type: bytes}}]
    entry:
      - {{byte: 2, bytes: 4, name: S, role: seconds, type: uint}}
      - {{byte: 0, bytes: 2, name: M, role: milliseconds, type: uint}}
    frames_byte: 6
loggable: [{{bit: 0, id: 200}}, {{bit: 2, id: 201}}]
messages:
  - {{name: Level, id: 200, kind: telemetry, length: 2, fields: [{{at: 0, bits: 16, name: Level, type: uint}}]}}
  - {{name: Rate, id: 201, kind: telemetry, length: 2, fields: [{{at: 0, bits: 16, name: Rate, type: uint}}]}}
"""
START = 1_600_000_000


@pytest.fixture(scope="module", params=["little", "big"])
def icd(request, tmp_path_factory) -> Icd:
    path = tmp_path_factory.mktemp("icd") / "logger.yaml"
    path.write_text(ICD.format(name="logger", order=request.param))
    return load([path]).icd


@pytest.fixture
def source_of(icd, tmp_path):
    """Return a function that writes a log of some entries and opens it."""

    def source_of(count: int, mask: int = 5, end: bytes = b"") -> LogSource:
        return open_source(icd, icd.nodes[0], file_of(count, mask, end))

    def file_of(count: int, mask: int, end: bytes):
        order, data = icd.nodes[0].byte_order, bytes([9, 9, mask])
        for number in range(count):
            data += (number + 1).to_bytes(2, order)
            data += (START + number).to_bytes(4, order)
            data += bytes(2 * (mask.bit_count()))
        path = tmp_path / "log"
        path.write_bytes(data + end)
        return path

    return source_of


def test_entries_are_read_in_pieces_of_whole_entries(source_of):
    source = source_of(7, end=b"end")
    assert (source.header_bytes, source.plan.entry_bytes, source.entries) == (3, 10, 7)
    data = source.path.read_bytes()[3:-3]
    for size, entries in (
        (1, 1),
        (10, 1),
        (19, 1),
        (20, 2),
        (69, 6),
        (70, 7),
        (999, 7),
    ):
        pieces = list(source.pieces(None, size))
        assert b"".join(pieces) == data
        assert {len(piece) for piece in pieces[:-1]} <= {10 * entries}
        assert len(pieces[0]) == 10 * entries
    for head in (0, 1, 6, 7, 8):
        assert b"".join(source.pieces(head)) == data[: 10 * head]


def test_times_are_those_of_the_first_and_the_last_entry(source_of):
    for count in (1, 2, 7):
        first = START * 1000 + 1
        last = (START + count - 1) * 1000 + count
        assert source_of(count).first_and_last() == (first, last)
    assert source_of(0).first_and_last() is None


def test_a_file_without_its_header_is_no_log(source_of, icd):
    path = source_of(0).path

    def is_log(size: int) -> bool:
        path.write_bytes(bytes(size))
        try:
            return open_source(icd, icd.nodes[0], path).size == size
        except UserError as error:
            assert str(error) == (
                f"{path} is no log: it has {size} bytes, the header alone has 3"
            )
            return False

    assert_limits(is_log, least=3)


def test_damage_jumps_and_doubts_are_notes(source_of):
    source = source_of(2, mask=0b1111)
    integrity = Integrity(
        [EntrySpan(3, 1)],
        [Damage(1000, 1001, 1), Damage(2000, 3234, 1234)],
        [TimeJump(12345, 0, START * 1000)],
        4,
    )
    assert source.notes(integrity) == [
        "the mask selects 2 bits that no frame has; is this a log of logger?",
        "damaged: bytes 1,000 to 1,000 (1 byte); about 1 row is left out",
        "damaged: bytes 2,000 to 3,233 (1,234 bytes); about 1,234 rows are left out",
        "time jump at byte 12,345: 1970-01-01T00:00:00.000Z to "
        "2020-09-13T12:26:40.000Z; its rows are converted",
        "the last 4 bytes belong to no whole entry",
    ]
    assert source_of(2).notes(Integrity([EntrySpan(3, 2)])) == []
    assert source_of(2, mask=0).notes(Integrity([EntrySpan(3, 1)])) == [
        "the mask selects no frame; is this a log of logger?"
    ]
    assert source_of(2, mask=0).notes(Integrity()) == []


@pytest.mark.parametrize("excess", [-1, 0, 1, 2])
def test_at_most_eight_notes_of_a_kind_are_listed(source_of, excess):
    damages = [Damage(10 * n, 10 * n + 5, 1) for n in range(8 + excess)]
    jumps = [TimeJump(n, 0, 1) for n in range(8 + excess)]
    notes = source_of(1).notes(Integrity([], damages, jumps))
    more = {1: ["and 1 more {}"], 2: ["and 2 more {}s"]}.get(excess, [])
    listed = min(8, 8 + excess)
    assert [note for note in notes if note.startswith("and")] == [
        text.format(what) for what in ("damaged range", "time jump") for text in more
    ]
    assert len(notes) == 2 * (listed + len(more))


@pytest.mark.parametrize(
    ("milliseconds", "text"),
    [
        (0, "1970-01-01T00:00:00.000Z"),
        (1, "1970-01-01T00:00:00.001Z"),
        (1_600_000_000_999, "2020-09-13T12:26:40.999Z"),
        (253_402_300_799_999, "9999-12-31T23:59:59.999Z"),
    ],
)
def test_a_time_is_written_with_milliseconds_in_utc(milliseconds, text):
    assert time_text(milliseconds) == text


def test_the_node_of_a_log_must_be_clear(tmp_path):
    bare = tmp_path / "bare.yaml"
    bare.write_text(
        "icdgen: 1\nnode: {name: bare, title: Bare, byte_order: little, bit_order: lsb0}\nmessages: []\n"
    )
    for name in ("alpha", "beta"):
        (tmp_path / f"{name}.yaml").write_text(ICD.format(name=name, order="big"))
    sets = {
        names: load([tmp_path / f"{name}.yaml" for name in names.split()]).icd
        for names in ("bare", "alpha bare", "alpha bare beta")
    }
    assert node_of(sets["alpha bare"], None).name == "alpha"
    assert node_of(sets["alpha bare"], "bare").name == "bare"
    with pytest.raises(UserError, match="the ICDs describe no logs"):
        node_of(sets["bare"], None)
    with pytest.raises(UserError, match="not said whose log it is") as error:
        node_of(sets["alpha bare beta"], None)
    assert error.value.help == "name the node; nodes: alpha, beta"
    bare.write_text(
        bare.read_text() + "protocol: {log_mask: {bytes: 1, frame_bytes: 2}}\n"
    )
    for each in (sets["bare"], load([bare]).icd):
        with pytest.raises(UserError, match="the ICD of bare describes no logs"):
            open_source(each, each.nodes[0], bare)


def test_columns_can_be_limited_to_some_messages(icd, source_of):
    path = source_of(1, mask=0b1101).path
    node = icd.nodes[0]
    level, rate = node.messages

    def names(*messages) -> list[str]:
        return open_log(icd, node, path, "telemetry", messages).names

    assert names() == ["time", "level__level", "rate__rate", "bit_3"]
    assert names(rate) == ["time", "rate__rate"]
    assert names(rate, level) == ["time", "level__level", "rate__rate"]
    path.write_bytes(bytes([9, 9, 1]) + path.read_bytes()[3:])
    assert names(level) == ["time", "level__level"]
    with pytest.raises(UserError, match=r"has no Rate$") as error:
        names(level, rate)
    assert error.value.help == f"`icdgen log {path}` lists what it holds"


def test_a_log_has_the_interface_of_its_conversion(icd, source_of):
    source = source_of(7, end=b"ab")
    log = open_log(icd, icd.nodes[0], source.path, "telemetry", [])
    sizes: list[int] = []
    for head, count in ((None, 7), (3, 3), (0, 0)):
        assert log.steps(head) == 10 * count
        assert len(list(log.rows(head, sizes.append))) == count
    assert sum(sizes) == 100
    assert log.prepare(None, sizes.append) == [
        "the last 2 bytes belong to no whole entry"
    ]
    assert log.prepare(3, sizes.append) == []
    assert not log.is_damaged(None)
