"""A log has the values of the reference codec in every output format."""

from __future__ import annotations

import csv
import io
import json
import math
import re
from datetime import datetime

import pytest
from icdgen_runtime.wire.logs import LogReader

from icdgen import codec
from icdgen.logfile import parquet, text
from icdgen.logfile.log import open_log
from icdgen.logfile.source import open_source
from icdgen.runtime_objects.links import link_of
from icdgen.values.frame import FieldValue
from tests import links

COUNT = 300


def expected(icd, node_facts, entries) -> list[list[object]]:
    """Return the rows of values of the reference codec."""
    rows = []
    for entry in entries:
        row: list[object] = []
        for frame in entry.frames:
            message = (
                node_facts.telemetry.get(frame.id) if frame.id is not None else None
            )
            if message is None:
                row.append(frame.data.hex())
                continue
            assert len(frame.data) == message.length
            raw = codec.decode(icd.node(message.node), message, frame.data)
            row += [
                value_of(FieldValue(field, raw[field.name])) for field in message.fields
            ]
        rows.append(row)
    return rows


def value_of(row: FieldValue) -> object:
    if row.field.type == "enum":
        return row.text
    if row.field.type == "bool":
        return bool(row.raw)
    if row.field.type == "text":
        return row.text
    if row.field.is_bytes:
        return row.raw.hex()
    return row.raw if row.number is None else row.number


def times(entries) -> list[int]:
    return [entry.seconds * 1000 + entry.milliseconds for entry in entries]


def milliseconds(text: str) -> int:
    return round(datetime.fromisoformat(text).timestamp() * 1000)


def converted(write, icd, node_facts, path, head=None) -> str:
    """Return the converted text of a log."""
    file, source = io.StringIO(), open_log(icd, node_facts.node, path, "telemetry", [])
    write(source.names, source.rows(head, lambda size: None), file)
    return file.getvalue()


@pytest.fixture
def log(icd, node_facts, everything, write):
    path, entries = write(everything, COUNT, b"cut")
    return open_source(icd, node_facts.node, path), entries


def test_csv_has_the_values_of_the_reference_codec(icd, node_facts, log):
    source, entries = log
    head, *rows = csv.reader(
        io.StringIO(converted(text.to_csv, icd, node_facts, source.path))
    )
    assert head == ["time", *(column.name for column in source.plan.columns)]
    assert [milliseconds(row[0]) for row in rows] == times(entries)
    shown = [
        [str(v).lower() if isinstance(v, bool) else str(v) for v in row]
        for row in expected(icd, node_facts, entries)
    ]
    assert [row[1:] for row in rows] == shown


def test_json_lines_have_the_values_of_the_reference_codec(icd, node_facts, log):
    source, entries = log
    rows = [
        json.loads(line)
        for line in converted(
            text.to_json_lines, icd, node_facts, source.path
        ).splitlines()
    ]
    assert [milliseconds(row.pop("time")) for row in rows] == times(entries)
    assert [list(row.values()) for row in rows] == expected(icd, node_facts, entries)


@pytest.mark.parametrize("piece", [1, 5000, parquet.PIECE])
def test_parquet_has_the_values_of_the_reference_codec(
    icd, node_facts, log, tmp_path, monkeypatch, piece
):
    import pyarrow.parquet as pq

    monkeypatch.setattr(parquet, "PIECE", piece)
    monkeypatch.setattr(parquet, "GROUP", 40_000)
    source, entries = log
    seen = []
    parquet.to_parquet(source, tmp_path / "log.parquet", None, seen.append)
    assert sum(seen) == COUNT * source.plan.entry_bytes
    table = pq.read_table(tmp_path / "log.parquet")
    assert [round(t.timestamp() * 1000) for t in table["time"].to_pylist()] == times(
        entries
    )
    rows = zip(
        *(table[column.name].to_pylist() for column in source.plan.columns), strict=True
    )
    hexed = [[v.hex() if isinstance(v, bytes) else v for v in row] for row in rows]
    assert hexed == expected(icd, node_facts, entries)
    with_unit = next(column for column in source.plan.columns if column.unit)
    metadata = table.schema.field(with_unit.name).metadata
    assert (
        metadata[b"unit"].decode() == with_unit.unit
        and metadata[b"frame"].decode() == with_unit.frame
    )


def test_a_conversion_can_be_limited_to_the_first_entries(
    icd, node_facts, log, tmp_path
):
    import pyarrow.parquet as pq

    source, entries = log
    parquet.to_parquet(source, tmp_path / "log.parquet", 7, lambda size: None)
    moments = pq.read_table(tmp_path / "log.parquet")["time"].to_pylist()
    first = times(entries)[:7]
    assert [round(moment.timestamp() * 1000) for moment in moments] == first
    all_lines = converted(text.to_csv, icd, node_facts, source.path)
    head = converted(text.to_csv, icd, node_facts, source.path, 7)
    assert head.count("\n") == 8 and all_lines.startswith(head)


def test_a_log_without_entries_or_frames_is_a_table_too(
    icd, node_facts, everything, write, tmp_path
):
    import pyarrow.parquet as pq

    for mask, count in ((everything, 0), (bytes(node_facts.mask.size), 3)):
        path, entries = write(mask, count)
        source = open_source(icd, node_facts.node, path)
        parquet.to_parquet(source, tmp_path / "log.parquet", None, lambda size: None)
        table = pq.read_table(tmp_path / "log.parquet")
        columns = ["time", *(column.name for column in source.plan.columns)]
        assert table.column_names == columns
        moments = [round(t.timestamp() * 1000) for t in table["time"].to_pylist()]
        assert moments == times(entries) and len(moments) == count


ODD = """\
icdgen: 1
node: {name: odd, title: Odd, byte_order: big, bit_order: msb0}
protocol:
  log_mask: {bytes: 1, bit_order: msb0, frame_bytes: 36}
  telemetry_log:
    header: [{byte: 2, bytes: 1, name: Mask, role: mask, type: bytes}]
    entry:
      - {byte: 2, bytes: 3, name: S, role: seconds, type: uint}
      - {byte: 0, bytes: 2, name: M, role: milliseconds, type: uint}
    frames_byte: 5
loggable: [{bit: 1, id: 200}]
enums:
  - {name: E, members: [{value: 0, name: A}, {value: 700, name: B}]}
  - {name: Way, members: [{value: -1, name: Down}, {value: 1, name: Up}]}
messages:
  - name: F
    id: 200
    kind: telemetry
    length: 36
    fields:
      - {at: 0, bits: 3, name: a, type: uint}
      - {at: 3, bits: 11, name: b, type: int, formula: raw*0.1+7}
      - {at: 14, bits: 2, name: c, type: enum, enum: Way}
      - {at: 16, bits: 32, name: d, type: float}
      - {at: 48, bits: 64, name: e, type: uint, formula: raw*0.001}
      - {at: 112, bits: 64, name: f, type: float}
      - {at: 176, bits: 16, name: g, type: enum, enum: E}
      - {at: 192, bits: 24, name: h, type: bytes}
      - {at: 216, bits: 17, name: i, type: enum, enum: Way}
      - {at: 233, bits: 23, name: j, type: int, unit: deg, formula: raw/7.0}
      - {at: 256, bits: 32, name: k, type: text}
      - {at: 16, bits: 32, name: l, type: uint, view: true, formula: raw*0.5}
      - {at: 187, bits: 40, name: m, type: int, view: true}
      - {at: 50, bits: 1, name: p, type: bool, view: true}
      - {at: 256, bits: 32, name: o, type: float, view: true}
    derived:
      - {name: q, unit: deg, formula: b + j/d - e*f}
      - {name: r, formula: q*l - m + a^3}
"""


TURNED = re.sub(r"(name: [bdefgij], type: \w+)", r"\1, byte_order: little", ODD)


@pytest.mark.parametrize(
    "text_of_icd", [ODD, TURNED], ids=["as the node", "of their own"]
)
def test_every_type_is_converted_in_both_byte_orders(tmp_path, text_of_icd):
    from random import Random

    import pyarrow.parquet as pq

    from icdgen.loading import load
    from icdgen.protocol import facts

    (tmp_path / "odd.yaml").write_text(text_of_icd)
    loaded = load([tmp_path / "odd.yaml"])
    icd = loaded.icd
    assert icd is not None and loaded.ok, loaded.findings
    node_facts, random = facts.of(icd, icd.nodes[0]), Random(1)
    entries = [(n, 0, [random.randbytes(36)]) for n in range(200)]
    link = link_of(icd, node_facts)
    data = links.log_file(link, b"\x40", entries)
    (tmp_path / "log").write_bytes(data)
    source = open_source(icd, node_facts.node, tmp_path / "log")
    parquet.to_parquet(source, tmp_path / "log.parquet", None, lambda size: None)
    table = pq.read_table(tmp_path / "log.parquet")
    wanted = expected(icd, node_facts, LogReader(link).feed(data))
    rows = zip(
        *(table[column.name].to_pylist() for column in source.plan.columns), strict=True
    )
    got = [[v.hex() if isinstance(v, bytes) else v for v in row] for row in rows]
    assert [list(map(_same, row)) for row in got] == [
        list(map(_same, row)) for row in wanted
    ]
    written = converted(text.to_json_lines, icd, node_facts, source.path)
    lines = [list(json.loads(line).values())[1:] for line in written.splitlines()]
    # Floats are printed in their shortest form.
    numbers = [
        index
        for index, column in enumerate(source.plan.columns)
        if column.kind != "float"
    ]
    assert [[row[index] for index in numbers] for row in lines] == [
        [row[index] for index in numbers] for row in wanted
    ]


def test_golden_vectors_have_times_that_a_log_can_store(tmp_path):
    from icdgen.loading import load
    from icdgen.vectors import protocol

    (tmp_path / "odd.yaml").write_text(ODD)  # seconds of three bytes
    loaded = load([tmp_path / "odd.yaml"])
    assert loaded.icd is not None and loaded.ok
    (node,) = json.loads(protocol.protocol_vectors_text(loaded.icd) or "")["nodes"]
    requests = [
        case["request"]
        for case in node["cases"]
        if case["request"]["op"] == "log_encode"
    ]
    assert {
        entry["seconds"] for request in requests for entry in request["entries"]
    } >= {
        0,
        0xFFFFFF,
    }


def _same(value: object) -> object:
    return "nan" if isinstance(value, float) and math.isnan(value) else value
