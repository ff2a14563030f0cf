"""Kaitai Struct formats become ICDs: one message for the sequence, or one for each
combination of values that selects fields.

tests/devices compares the values of random frames with kaitaistruct.
"""

from __future__ import annotations

import pytest

from icdgen import codec
from icdgen.definitions import kaitai, kaitai_parts, kinds, run
from icdgen.diagnostics import Findings
from icdgen.icd.fmt import emit
from icdgen.icd.load import load
from tests.definitions.test_can import FILES, field, message


def import_findings(definitions):
    """Return the findings except those about unused parts (IMP085)."""
    return [
        finding for finding in definitions.import_findings if finding.code != "IMP085"
    ]


@pytest.fixture(scope="module")
def probe():
    return imported("probe.ksy")


@pytest.fixture(scope="module")
def frame():
    return imported("frame.ksy")


def imported(name):
    reader = kinds.reader_of_file(FILES / name)
    assert isinstance(reader, kaitai.Kaitai)
    return run.read(FILES / name, reader)


def test_each_alternative_of_a_sequence_is_a_message_with_its_discriminator(
    probe,
):
    (tree,) = probe.trees.values()
    rows = [
        (
            message["name"],
            [
                part["const"]
                for part in message["fields"]
                if part["name"] in ("is_late", "kind")
            ],
        )
        for message in tree["messages"]
    ]
    assert rows == [
        ("probe with delay power", [1, 1]), ("probe with delay places", [1, 2]),
        ("probe power", [0, 1]), ("probe places", [0, 2]),
    ]  # fmt: skip
    assert {message["id"] for message in tree["messages"]} == {
        1
    } and probe.definitions.total == probe.imported == 4
    assert (
        field(probe, "probe with delay power", "volts_raw")["at"]
        == field(probe, "probe power", "volts_raw")["at"] + 16
    )


def test_contents_and_single_valid_values_are_constants(probe):
    assert (
        field(probe, "probe power", "sync")["const"],
        field(probe, "probe power", "version")["const"],
    ) == (
        0xEB90,
        2,
    )


def test_linear_instances_are_formulas_and_others_are_reported(probe, frame):
    power = field(probe, "probe power", "temperature_raw")
    assert (power["formula"], power["unit"]) == ("raw*0.5 - 40", "C")
    assert field(frame, "frame unnumbered", "current")["formula"] == "raw/1000.0 + 0.5"
    # Division of integers truncates.
    assert "formula" not in field(frame, "frame unnumbered", "uptime")
    assert [
        (finding.code, finding.message)
        for finding in (
            *import_findings(probe.definitions),
            *import_findings(frame.definitions),
        )
    ] == [
        (
            "IMP078",
            "`body total`: `cells[0] + cells[1]` is not a linear function of one field",
        ),
        (
            "IMP081",
            "`header callsign` is not imported: its bytes are processed by `ror(1)` before they are read",
        ),
        (
            "IMP078",
            "`header ssid`: `(ssid_raw & 0x0f) >> 1` is not a linear function of one field",
        ),
        (
            "IMP078",
            "`payload halves`: `uptime / 2` is not a linear function of one field",
        ),
        (
            "IMP081",
            "`payload elsewhere` is not imported: an expression gives its position",
        ),
        ("IMP081", "`payload data` is not imported: its size is `size * 2`"),
    ]
    assert [finding.spot.line for finding in import_findings(frame.definitions)] == [
        18,
        28,
        46,
        47,
        58,
    ]


def test_repeated_types_are_structs_and_others_are_part_of_the_message(probe):
    (tree,) = probe.trees.values()
    assert [
        (struct["name"], struct["length"], len(struct["fields"]))
        for struct in tree["structs"]
    ] == [("place", 8, 2)]
    assert field(probe, "probe places", "place") | {"at": 0} == {
        "at": 0,
        "name": "place",
        "struct": "place",
        "count": 2,
    }
    assert (
        field(probe, "probe power", "cells")["count"] == 3
        and field(probe, "probe power", "kind")["enum"] == "kind"
    )


def test_discriminating_bits_are_fields_and_the_complete_value_is_an_overlay_field(
    frame,
):
    parts = [
        field
        for field in message(frame, "frame unnumbered")["fields"]
        if field["name"].startswith("control")
    ]
    assert [(part["name"], part["at"], part["bits"], part.get("const")) for part in parts if "view" not in part] == [
        ("control bits 0 to 1", 56, 2, 3), ("control bits 2 to 3", 58, 2, None),
        ("control bit 4", 60, 1, 0), ("control bits 5 to 7", 61, 3, None),
    ]  # fmt: skip
    assert [
        (part["name"], part["at"], part["bits"]) for part in parts if "view" in part
    ] == [("control", 56, 8)]


def test_unsupported_content_is_imported_as_bytes(frame):
    assert field(frame, "frame unnumbered", "callsign") == {
        "at": 0,
        "bits": 48,
        "name": "callsign",
        "type": "bytes",
    }
    assert field(frame, "frame information", "data")["size"] == "rest"
    assert message(frame, "frame information")["length"] == 10


def test_bits_enumerations_limits_and_variable_length_fields_are_imported(frame):
    of = {
        field["name"]: field for field in message(frame, "frame unnumbered")["fields"]
    }
    assert (
        of["low"]["at"],
        of["high"]["at"],
        of["limit"]["min"],
        of["limit"]["max"],
    ) == (120, 124, -40, 85)
    assert (of["number"]["at"], of["data"]["at"], of["data"]["bits"]) == (136, 144, 24)
    assert (
        of["current"]["byte_order"] == "big"
        and of["uptime"]["summary"] == "Since the last reset."
    )
    assert (of["samples"]["at"], of["samples"]["count"]) == (168, "rest")
    (tree,) = frame.trees.values()
    assert [
        (member["value"], member["name"]) for member in tree["enums"][0]["members"]
    ] == [
        (0, "off"),
        (1, "on"),
        (3, "both"),
    ]


def test_limits_of_raw_values_apply_neither_to_formulas_nor_to_computed_values(
    tmp_path,
):
    text = ksy("{id: b, type: u1, valid: {min: 2, max: 999}}", "{id: c, type: u1, valid: {min: 2}}", "{id: d, type: u1, valid: a}",
               more="instances:\n  e: {value: c * 0.5}\n")  # fmt: skip
    (tmp_path / "bad.ksy").write_text(text)
    read = run.read(tmp_path / "bad.ksy", kinds.reader_of_kind("ksy"))
    b, c, d = (field(read, "bad", name) for name in "bcd")
    assert (b["min"], "max" in b, c["formula"], "min" in c, "const" in d) == (
        2,
        False,
        "raw*0.5",
        False,
        False,
    )
    assert read.definitions.import_findings == []


@pytest.mark.parametrize(
    ("attribute", "expected"),
    [
        ("{id: b, size: a}", {"type": "bytes", "size": "a", "up_to": 255}),
        ("{id: b, type: str, encoding: ASCII, size: a + 2}",
         {"type": "text", "size": {"field": "a", "plus": 2}, "up_to": 257}),
        ("{id: b, type: u2be, repeat: expr, repeat-expr: a - 1}",
         {"type": "uint", "bits": 16, "count": {"field": "a", "plus": -1}, "up_to": 254}),
        ("{id: b, type: t, repeat: expr, repeat-expr: a}", {"struct": "t", "count": "a", "up_to": 255}),
    ],
)  # fmt: skip
def test_a_repetition_with_a_count_is_a_variable_length_array(
    attribute, expected, tmp_path
):
    more = "types:\n  t:\n    seq: [{id: c, type: u1}]\ninstances:\n  d: {value: a * 0.5}\n"
    (tmp_path / "bad.ksy").write_text(ksy(attribute, "{id: z, type: u1}", more=more))
    read = run.read(tmp_path / "bad.ksy", kinds.reader_of_kind("ksy"))
    assert field(read, "bad", "b") == {
        "at": 8,
        "name": "b",
        **expected,
    } and "formula" not in field(read, "bad", "a")
    assert field(read, "bad", "z") == {
        "at": 8,
        "after": "b",
        "bits": 8,
        "name": "z",
        "type": "uint",
    }
    assert [finding.message for finding in import_findings(read.definitions)] == [
        "`d`: `a * 0.5` is not a linear function of one field",
    ]


def test_fields_after_variable_length_fields_are_imported(tmp_path):
    text = ksy(
        "{id: n, type: u1}",
        "{id: words, size: a}",
        "{id: mark, contents: [0x55, 0xAA]}",
        "{id: points, type: u2be, repeat: expr, repeat-expr: n}",
        "{id: last, type: t}",
        "{id: crc, type: u2le}",
        more="types:\n  t:\n    seq: [{id: c, type: s2be}, {id: d, type: u1}]\n",
    )
    (tmp_path / "bad.ksy").write_text(text)
    read = run.read(tmp_path / "bad.ksy", kinds.reader_of_kind("ksy"))
    assert import_findings(read.definitions) == []
    (tmp_path / "frame.yaml").write_text(
        emit.canonical_yaml(next(iter(read.trees.values())))
    )
    loaded = load([tmp_path / "frame.yaml"])
    assert loaded.ok, loaded.findings
    (node,) = loaded.icd.nodes
    (message,) = node.messages
    frame = bytes.fromhex("03 02 414243 55AA 0001 0002 FFFF 07 3412")
    raw = codec.decode_frame(node, message, frame)
    assert (raw["words"], raw["points[1]"], raw["crc"]) == (b"ABC", 2, 0x1234)
    assert {raw[name] for name in raw if name.endswith((" c", ".c"))} <= {-1}
    assert codec.encode(node, message, codec.decode(node, message, frame)) == frame


@pytest.mark.parametrize(
    ("attributes", "says"),
    [
        (["{id: b, size: a}", "{id: c, type: b4}", "{id: d, type: b4}"],
         "`c` is not imported: it follows a part of variable size, and does not have whole bytes"),
        (["{id: b, size: a}", "{id: c, type: u1}", "{id: d, size: c}"],
         "`d` is not imported: its size is `c`, which is not a number in front of it"),
        (["{id: b, size: a}", "{id: c, type: u1}", "{id: d, type: u1, if: c == 1}"],
         "`d` is not imported: it depends on `c`, which follows a part of variable size"),
        (["{id: b, size-eos: true}", "{id: c, type: u1}"],
         "`c` is not imported: it follows a part up to the end of the frame"),
    ],
)  # fmt: skip
def test_fields_that_depend_on_moving_bytes_are_left_out(attributes, says, tmp_path):
    (tmp_path / "bad.ksy").write_text(ksy(*attributes))
    read = run.read(tmp_path / "bad.ksy", kinds.reader_of_kind("ksy"))
    assert [finding.message for finding in import_findings(read.definitions)] == [says]
    assert field(read, "bad", "b")["type"] == "bytes"


BYTE = "{id: a, type: u1}"


def ksy(*attributes, more=""):
    return (
        "meta:\n  id: bad\nseq:\n"
        + "".join(f"  - {attribute}\n" for attribute in (BYTE, *attributes))
        + more
    )


NESTED = "types:\n" + "".join(
    f"  t{n}:\n    seq: [{{id: x, type: t{n + 1}}}]\n" for n in range(60)
)
BROAD = "types:\n" + "".join(
    f"  t{n}:\n    seq: [{{id: x, type: t{n + 1}}}, {{id: y, type: t{n + 1}}}]\n" for n in range(20)
) + "  t20:\n    seq: [{id: z, type: u1}]\n"  # fmt: skip


@pytest.mark.parametrize(
    ("attribute", "more", "says"),
    [
        ("{id: b, type: nothing}", "", "`b` is not imported: there is no type `nothing`"),
        ("{id: b, type: t}", "types:\n  t:\n    seq: [{id: c, type: u}]\n  u:\n    seq: [{id: d, type: t}]\n",
         "`b c d` is not imported: types contain each other in a circle: bad -> t -> u -> t"),
        ("{id: b, type: bad}", "", "`b` is not imported: types contain each other in a circle: bad -> bad"),
        ("{id: b, size: a - 255}", "", "`b` is not imported: its size is `a - 255`, which is never positive"),
        ("{id: b, size: a * 2}", "", "`b` is not imported: its size is `a * 2`"),
        ("{id: b, size: c}", "", "`b` is not imported: `c` is not a number in front of it"),
        ("{id: t, size: 4, type: t}", "types:\n  t:\n    seq: [{id: n, type: u1}, {id: b, size: n}]\n",
         "`t b` is not imported: its size is `n`, within a part that has a size of its own"),
        ("{id: b, size: -1}", "", "`b` is not imported: its size is -1"),
        ("{id: b, size: 99999}", "", "`b` is not imported: its size is 99999"),
        ("{id: b, type: str}", "", "`b` is not imported: its size is not stated"),
        ("{id: b, type: strz, encoding: ASCII}", "", "`b` is not imported: its size is not stated: it ends at a terminator"),
        ("{id: b, type: u2}", "", "`b` is not imported: the byte order of `u2` is not stated"),
        ("{id: b, type: b65}", "", "`b` is not imported: an integer has 65 bits"),
        ("{id: b, type: f2be}", "", "`b` is not imported: there is no type `f2be`"),
        ("{id: b, type: u1, enum: e}", "", "`b` is not imported: there is no enumeration `e`"),
        ("{id: b, type: u1, repeat: expr, repeat-expr: a % 3}", "", "`b` is not imported: it is repeated as often as `a % 3` says"),
        ("{id: b, type: u1, repeat: expr, repeat-expr: 9999}", "", "`b` is not imported: it is repeated 9999 times"),
        ("{id: b, type: u1, repeat: until, repeat-until: _ == 0}", "",
         "`b` is not imported: it is repeated as often as `_ == 0` says"),
        ("{id: b, type: u1, if: a > 3}", "", "`b` is not imported: it depends on `a > 3`, which is more than equalities of fields"),
        ("{id: b, type: u1, if: c == 3}", "", "`b` is not imported: `c` is not a number in front of it"),
        ("{id: b, type: t(1)}", "", "`b` is not imported: the type `t(1)` has parameters"),
        ("{id: b, contents: [300]}", "", "`b` is not imported: its contents are `300`"),
        ("{id: b, type: t0}", NESTED, "more than 50 types contain each other"),
        ("{id: b, type: {switch-on: a}}", "", "`b` is not imported: a switch has no cases"),
        ("{id: b, type: {switch-on: a, cases: {'\"x\"': u1}}}", "",
         '`b` is not imported: it depends on whether a field is `"x"`'),
    ],
)  # fmt: skip
def test_unsupported_content_is_reported_and_the_fields_before_it_are_imported(
    attribute, more, says, tmp_path
):
    (tmp_path / "bad.ksy").write_text(ksy(attribute, more=more))
    read = run.read(tmp_path / "bad.ksy", kinds.reader_of_kind("ksy"))
    assert read.failed and [
        finding.code for finding in import_findings(read.definitions)
    ] == ["IMP081"]
    assert (
        says in read.definitions.import_findings[0].message
        and read.definitions.import_findings[0].spot.line
    )
    for imported in read.trees["bad"]["messages"]:
        assert (
            imported["fields"][0]["name"] == "a"
            and imported["fields"][-1]["type"] == "bytes"
        )


BOMB = (
    "meta: {id: bad}\na: &a [1, 1]\n"
    + "".join(
        f"{y}: &{y} [*{x}, *{x}]\n" for x, y in zip("abcdefg", "bcdefgh", strict=True)
    )
    + "seq: *h\n"
)


@pytest.mark.parametrize(
    ("text", "says", "line"),
    [
        (BOMB, "anchors and aliases are not part of what is read", 2),
        ("meta:\n  id: x\nseq: ]", "not YAML: ", 3),
        ("meta:\n  id: x\nseq: " + "[" * 100, "nested more than 40 deep", 3),
        (
            "meta:\n  id: x\nseq: !!python/object:os.system []\n",
            "the tag `tag:yaml.org,2002:python/object:os.system`",
            3,
        ),
        ("seq: []\n", "not a Kaitai Struct definition: it has no `meta`", 1),
        ("- 1\n", "not a Kaitai Struct definition: it has no `meta`", 1),
        ("", "not a Kaitai Struct definition: it has no `meta`", 1),
        (
            "meta:\n  id: x\nseq: 5\n",
            "no message can be imported: message `x` is not imported: the `seq` of `x` is not a list",
            1,
        ),
        ("meta:\n  id: x\nseq: []\n", "no message can be imported", 1),
        (
            "meta:\n  id: x\nseq:\n  - {size: 1, process: zlib}\n",
            "its bytes are processed by `zlib`",
            1,
        ),
    ],
)
def test_hostile_and_invalid_files_are_refused(text, says, line, tmp_path):
    (tmp_path / "bad.ksy").write_text(text)
    reader = kinds.reader_of_file(tmp_path / "bad.ksy")
    assert isinstance(reader, kaitai.Kaitai)
    with pytest.raises(Findings) as raised:
        run.read(tmp_path / "bad.ksy", reader)
    (finding,) = raised.value.findings
    assert (finding.code, finding.place.line) == (
        "IMP005",
        line,
    ) and says in finding.message


@pytest.mark.parametrize("more", [BROAD, ""])
def test_a_small_file_that_expands_is_limited(more, tmp_path, monkeypatch):
    monkeypatch.setattr(kaitai_parts.File, "most_steps", 2000)
    flags = [f"{{id: f{n}, type: u1}}" for n in range(40)]
    flags += [f"{{id: x{n}, type: u1, if: f{n} == 1}}" for n in range(40)]
    text = ksy("{id: b, type: t0}", more=more) if more else ksy(*flags)
    definitions = kaitai.Kaitai().read("bad.ksy", text.encode())
    assert (
        import_findings(definitions)[-1].message
        == "message `bad` is not imported: with it the file says more than 2,000 things"
    )


def test_the_number_of_alternatives_is_limited(tmp_path):
    cases = ", ".join(f"{n}: u1" for n in range(256))
    text = ksy("{id: b, type: u1}", f"{{id: c, type: {{switch-on: a, cases: {{{cases}}}}}}}",
               f"{{id: d, type: {{switch-on: b, cases: {{{cases}}}}}}}")  # fmt: skip
    definitions = kaitai.Kaitai().read("bad.ksy", text.encode())
    assert len(definitions.networks[0].messages) == kaitai.MOST_MESSAGES
    assert definitions.import_findings[-1].message.endswith(
        "it branches in more than 256 ways; the others are not imported"
    )
