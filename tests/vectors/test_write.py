"""Text of vector files: the complete head of a small file, and the row of each kind of
field.
"""

from __future__ import annotations

import json

import pytest

from icdgen import __version__
from icdgen.icd.layout import Scalar
from icdgen.loading import load
from icdgen.vectors.make import make_vectors
from icdgen.vectors.settings import NEVER, assignments_of_field
from icdgen.vectors.write import raw_json, vector_file_text
from tests.icd.files import HEAD, write

SMALL = """\
icdgen: 1
node: {name: demo, title: Demo, byte_order: little, bit_order: lsb0, node_type: 0, interface_version: 0}
enums:
  - name: Switch
    members:
      - {value: 0, name: "Off"}
      - {value: 2, to: 3, name: Spare}
messages:
  - {name: Reset, id: 0, kind: telecommand, length: 0}
  - name: Setting
    set_id: 5
    get_id: 0
    kind: configuration
    length: 1
    fields:
      - {at: 0, bits: 2, name: Mode, type: enum, enum: Switch}
      - {at: 2, bits: 1, name: Flag, type: bool, const: 0}
"""

EXPECTED = """\
"node_type": 0,
"interface_version": 0,
"never_set": ["7ff8000000000000","7ff0000000000001","fff8000000000123",\
"7ff0000000000000","fff0000000000000","7fefffffffffffff","ffefffffffffffff"],
"ids": {
"telecommand": {"0":"Reset","5":"Setting"},
"telemetry": {"0":"Setting"},
"configuration": {"0":"Setting","5":"Setting"}
},
"enums": [
{"name":"Switch","members":[[0,"Off"],[2,"Spare",3]],"unknown":1}
],
"messages": [
{"name":"Reset","kind":"telecommand","id":0,"length":0,
"fields": [],
"refused_lengths": [1],
"vectors": [
{"why":"all zeros","bytes":"","raw":[]}
]},
{"name":"Setting","kind":"configuration","set_id":5,"get_id":0,"length":1,
"fields": [
{"name":"Mode","type":"enum","bits":2,"enum":"Switch","default":0,"unfit":[4,-1]},
{"name":"Flag","type":"bool","bits":1,"default":0}
],
"refused_lengths": [0,2],
"vectors": [
{"why":"all zeros","bytes":"00","raw":[0,0]},
{"why":"all ones","bytes":"ff","encoded":"07","raw":[3,1]},
"""


def text_of(folder, icd: str) -> str:
    loaded = load([write(folder, icd)], check=False)
    assert loaded.findings == []
    return vector_file_text(make_vectors(loaded.icd, loaded.icd.nodes[0]))


def test_a_small_file(tmp_path):
    head, separator, body = text_of(tmp_path, SMALL).partition('"node_type"')
    *lines, digest, includes = head.splitlines()
    assert lines == [
        "{",
        '"icdgen_vectors": 1,',
        f'"generator": "icdgen {__version__}",',
        '"node": "demo",',
    ]
    assert len(json.loads("{" + digest[:-1] + "}")["digest"]) == 16
    assert includes == '"includes": [],'
    assert (separator + body).startswith(EXPECTED)
    assert body.endswith('"raw":[1,0]}\n]}\n]\n}\n')


KINDS = """\
messages:
  - name: Kinds
    id: 1
    kind: telemetry
    length: 12
    fields:
      - {at: 0,  bits: 8, name: Kind, type: uint}
      - {at: 8,  bits: 8, name: Scaled, type: int, formula: raw/4 - 1, min: -2.5, below: 30}
      - {at: 16, bits: 32, name: Ratio, type: float, above: 0, max: 0.5,
         special: [{value: nan, meaning: none}]}
      - {at: 48, bits: 16, name: Label, type: text}
      - {at: 64, bits: 8, name: Zero, type: uint, const: 0, special: [{value: 0, meaning: nothing}]}
      - {at: 72, bits: 8, name: Extra, type: uint, when: {Kind: [0, 2]}}
      - {at: 0,  bits: 16, name: Both, type: uint, view: true}
      - {at: 80, bits: 16, name: Key, type: bytes}
  - name: Parts
    id: 2
    kind: telecommand
    length: 2
    fields:
      - {at: 0, bits: 8, name: First, type: uint}
      - {at: 8, bits: 8, name: Last, type: uint}
      - {at: 16, bits: 8, count: First, up_to: 3, name: Items, type: uint}
      - {at: 16, after: Items, bits: 16, count: {field: Last, plus: 1}, up_to: 2, name: Words, type: uint}
"""

ROWS = [
    {"name": "Kind", "type": "uint", "bits": 8, "default": 0, "unfit": [256, -1]},
    {"name": "Scaled", "type": "int", "bits": 8, "factor": "1/4", "offset": "-1", "default": 0,
     "limits": {"min": "-2.5", "below": "30"}, "unfit": [128, -129]},
    {"name": "Ratio", "type": "float", "bits": 32, "default": "00000000", "special": ["7fc00000"],
     "limits": {"max": "0.5", "above": "0"}},
    {"name": "Label", "type": "text", "bits": 16, "default": "0000"},
    {"name": "Zero", "type": "uint", "bits": 8, "default": 0, "special": [0], "unfit": [256, -1]},
    {"name": "Extra", "type": "uint", "bits": 8, "when": {"Kind": [0, 2]}, "default": 0, "unfit": [256, -1]},
    {"name": "Both", "type": "uint", "bits": 16, "view": True, "default": 0},
    {"name": "Key", "type": "bytes", "bits": 16, "default": "0000"},
]  # fmt: skip


def test_each_kind_of_field_has_its_keys_in_order(tmp_path):
    data = json.loads(text_of(tmp_path, HEAD + KINDS))
    assert not {"node_type", "interface_version", "shared_ids"} & data.keys()
    kinds, parts = data["messages"]
    settable = [row["name"] for row in kinds["fields"] if row.pop("set", None)]
    assert [list(row.items()) for row in kinds["fields"]] == [
        list(row.items()) for row in ROWS
    ]
    assert settable == ["Scaled", "Label"]
    # Absent fields are null; physical values and doubles are those of fields with a scale.
    row = next(
        row for row in kinds["vectors"] if row["why"] == "Kind 1, all others ones"
    )
    assert row == {
        "why": "Kind 1, all others ones",
        "bytes": "01" + "ff" * 11,
        "encoded": "01" + "ff" * 8 + "00ffff",
        "raw": [1, -1, "ffffffff", "ffff", 255, None, 0xFF01, "ffff"],
        "physical": ["-1.25"],
        "doubles": ["bff4000000000000"],
        "texts": [None],
    }
    rows = ("fields", "vectors", "refused_frames")
    assert {key: parts[key] for key in parts if key not in rows} == {
        "name": "Parts", "kind": "telecommand", "id": 2, "length": 9,
        "tail": {"part": "Words", "counter": "Last", "least": 5, "step": 2, "most": 2, "plus": 1},
        "inner": [{"part": "Items", "counter": "First", "begin": 2, "step": 1, "most": 3}],
        "refused_lengths": [0, 3, 10],
    }  # fmt: skip
    # `Words` has at least one element.
    assert "0000" in parts["refused_frames"]


@pytest.mark.parametrize(
    ("type", "bits", "raw", "expected"),
    [
        ("float", 32, 0, "00000000"),
        ("float", 64, 1, "0000000000000001"),
        ("float", 32, None, None),
        ("bytes", 16, b"\0\xab", "00ab"),
        ("text", 8, b"", ""),
        ("uint", 8, 0, 0),
        ("int", 8, -1, -1),
        ("bool", 1, 1, 1),
    ],
)
def test_raw_values_of_floats_and_bytes_are_hexadecimal(type, bits, raw, expected):
    assert raw_json(Scalar(name="A", type=type, bits=bits), raw) == expected


@pytest.mark.parametrize("size", [1, 2, 94, 95, 300])
def test_texts_that_are_assigned_fit_with_zeros_or_are_refused(size):
    field = Scalar(name="A", type="text", bits=8 * size)
    assigned = assignments_of_field(field)
    # Characters 0x21 to 0x7F, then again from 0x01 on.
    long = "".join(chr((0x20 + n) % 0x7F + 1) for n in range(size + 1))
    for text in ("", "!", long[: size - 1], long[:size], "\x01", "\x7f"):
        assert (text, text.encode("ascii").ljust(size, b"\0")) in assigned
    refused = [text for text, raw in assigned if raw is None]
    assert refused == [long, "\x80", "\xe9", "\u4f4d", "\U0001f6f0"]


def test_an_integer_with_a_scale_takes_no_value_that_no_integer_takes(tmp_path):
    data = json.loads(text_of(tmp_path, HEAD + KINDS))
    (scaled,) = (
        row for row in data["messages"][0]["fields"] if row["name"] == "Scaled"
    )
    given = dict(scaled["set"])
    assert not set(NEVER) & given.keys()
    # -0.0 and the smallest subnormal number are 0: raw 4. Ends: -33.125 and 30.875.
    assert given["8000000000000000"] == given["0000000000000001"] == 4
    low, high = "c040900000000000", "403ee00000000000"
    assert (given[low], given["c040900000000001"]) == (-128, None)
    assert (given["403edfffffffffff"], given[high]) == (127, None)
