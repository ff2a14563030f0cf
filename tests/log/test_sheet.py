"""A recording as a table: its columns, rows and Parquet file."""

from __future__ import annotations

from pathlib import Path

import pytest

from icdgen.loading import load
from icdgen.logfile import sheet_parquet
from icdgen.logfile.recording import Recording, key
from icdgen.logfile.sheet import Sheet, end_of_field, is_present
from tests.features.framed import recorded

VARYING = """\
icdgen: 1
node: {name: demo, title: Demo, byte_order: big, bit_order: msb0}
protocol:
  link:
    framing: {by: cobs}
    packets:
      data:
        from: device
        header: [{bits: 8, role: id}, {bits: 8, role: source}, {bits: 8, role: time}]
      command:
        from: host
        header: [{bits: 8, role: id}]
messages:
  - {name: Level, id: 1, kind: telemetry, length: 1, fields: [{at: 0, bits: 8, name: Level, type: uint, unit: mV}]}
  - name: Blob
    id: 2
    kind: telemetry
    length: 1
    fields:
      - {at: 0, bits: 8, name: Kind, type: uint}
      - {at: 8, name: Body, type: bytes, size: rest, up_to: 6}
  - name: Text
    id: 3
    kind: telemetry
    length: 0
    fields: [{at: 0, name: Words, type: text, size: rest, up_to: 6}]
  - name: Maybe
    id: 4
    kind: telemetry
    length: 2
    fields:
      - {at: 0, bits: 8, name: Has, type: uint}
      - {at: 8, bits: 8, name: Extra, type: uint, when: {Has: 1}}
"""
FRAMES = [
    ("Level", b"\7"),
    ("Blob", b"\1\xaa\xbb"),
    ("Blob", b"\2"),
    ("Text", b"hi"),
    ("Level", b"\x08"),
    ("Maybe", b"\1\x09"),
    ("Maybe", b"\0\0"),
    ("Blob", b"\3\xcc\xdd\xee\xff\0\1"),
]
NAMES = [
    "message",
    "source",
    "time",
    "level__level_mv",
    "blob__kind",
    "blob__body",
    "text__words",
    "maybe__has",
    "maybe__extra",
]
ROWS = [
    ["Level", 0, 0, 7, None, None, None, None, None],
    ["Blob", 0, 0, None, 1, b"\xaa\xbb", None, None, None],
    ["Blob", 0, 0, None, 2, b"", None, None, None],
    ["Text", 0, 0, None, None, None, "hi", None, None],
    ["Level", 0, 0, 8, None, None, None, None, None],
    ["Maybe", 0, 0, None, None, None, None, 1, 9],
    ["Maybe", 0, 0, None, None, None, None, 0, None],
    ["Blob", 0, 0, None, 3, b"\xcc\xdd\xee\xff\0\1", None, None, None],
]


def ignore(size: int) -> None:
    """Do nothing with the number of processed bytes."""


@pytest.fixture
def recording(tmp_path) -> Recording:
    (tmp_path / "demo.yaml").write_text(VARYING)
    loaded = load([tmp_path / "demo.yaml"])
    assert loaded.ok, loaded.findings
    icd = loaded.icd
    path = tmp_path / "received"
    path.write_bytes(
        b"".join(
            recorded(icd, icd.nodes[0], {name: [data]})["telemetry"]
            for name, data in FRAMES
        )
    )
    return Recording(icd, icd.nodes[0], path)


def plain(row: list) -> list:
    """Return a row with bytes instead of their hexadecimal text."""
    return [
        bytes.fromhex(value) if at == 5 and isinstance(value, str) else value
        for at, value in enumerate(row)
    ]


def test_a_row_has_the_values_of_its_message_in_its_columns(recording):
    sheet = Sheet(recording, recording.messages)
    assert sheet.names == NAMES
    assert [column.name for column in sheet.columns] == NAMES[3:]
    assert [plain(row) for row in sheet.rows(None, ignore)] == ROWS
    assert [
        (entry.place, entry.is_cut)
        for entries in sheet.entries.values()
        for entry in entries
    ] == [(3, False), (4, False), (5, True), (6, False), (7, False), (8, False)]


@pytest.mark.parametrize("head", [0, 1, 4, 8, 9])
def test_the_first_rows_can_be_taken(recording, head):
    sheet = Sheet(recording, recording.messages)
    assert [plain(row) for row in sheet.rows(head, ignore)] == ROWS[:head]


def test_only_received_messages_have_columns(recording):
    chosen = [key(m) for m in recording.messages.values() if m.name == "Blob"]
    recording.chosen = set(chosen)
    sheet = Sheet(recording, chosen)
    assert sheet.names == ["message", "source", "time", "blob__kind", "blob__body"]
    assert list(sheet.rows(None, ignore)) == [
        [*row[:3], row[4], row[5].hex()] for row in ROWS if row[0] == "Blob"
    ]
    assert Sheet(recording, ()).names == ["message", "source", "time"]


def parquet_rows(path: Path) -> list[list]:
    import pyarrow.parquet as pq

    return [list(row.values()) for row in pq.read_table(path).to_pylist()]


@pytest.mark.parametrize("cells", [1, 4_000_000])
def test_a_parquet_file_has_the_same_rows_and_null_for_missing_values(
    recording, tmp_path, monkeypatch, cells
):
    import pyarrow.parquet as pq

    monkeypatch.setattr(sheet_parquet, "_CELLS", cells)
    sheet = Sheet(recording, recording.messages)
    path = tmp_path / "rows.parquet"
    sheet_parquet.to_parquet(sheet, path, None, ignore)
    assert pq.read_table(path).column_names == NAMES
    assert parquet_rows(path) == ROWS
    schema = pq.read_schema(path)
    assert [str(schema.field(name).type) for name in NAMES[:3]] == [
        "dictionary<values=string, indices=int32, ordered=0>",
        "uint32",
        "uint32",
    ]
    assert str(schema.field("blob__body").type) == "binary"
    assert [schema.field(name).nullable for name in NAMES] == [False] + [True] * 8
    sheet_parquet.to_parquet(sheet, path, 3, ignore)
    assert parquet_rows(path) == ROWS[:3]


def test_a_row_group_has_at_least_256_rows_and_about_four_million_cells(
    recording, tmp_path, monkeypatch
):
    import pyarrow.parquet as pq

    sheet = Sheet(recording, recording.messages)
    data = recording.path.read_bytes()
    recording.path.write_bytes(data * 75)  # 600 messages
    sizes = {}
    for cells in (0, len(NAMES) * 256, len(NAMES) * 300 + 8, 4_000_000):
        monkeypatch.setattr(sheet_parquet, "_CELLS", cells)
        path = tmp_path / f"{cells}.parquet"
        sheet_parquet.to_parquet(sheet, path, None, ignore)
        file = pq.ParquetFile(path)
        sizes[cells] = [
            file.metadata.row_group(n).num_rows for n in range(file.num_row_groups)
        ]
        assert parquet_rows(path) == ROWS * 75
    assert [*sizes.values()] == [[256, 256, 88], [256, 256, 88], [300, 300], [600]]


def test_a_field_ends_before_the_next_absent_byte(recording):
    sheet = Sheet(recording, recording.messages)
    (blob,) = (
        entries[1] for (_, name), entries in sheet.entries.items() if name == "Blob"
    )
    (extra,) = (
        entries[1] for (_, name), entries in sheet.entries.items() if name == "Maybe"
    )
    from icdgen.logfile.recording import Tally

    received = list(recording.received_messages(Tally(), None, ignore))
    assert [
        end_of_field(each, blob.column)
        for each in received
        if each.message.name == "Blob"
    ] == [3, 1, 7]
    assert [
        is_present(each, extra.column)
        for each in received
        if each.message.name == "Maybe"
    ] == [True, False]
    assert is_present(received[0], extra.column)  # all fields of its message
