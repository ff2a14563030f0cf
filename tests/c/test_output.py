"""The generated C files have a fixed layout, and change only where the ICD changes.

Texts of the ICD are harmless in comments and string literals.
"""

from __future__ import annotations

import dataclasses
import posixpath
import re
import subprocess
from pathlib import PurePosixPath

import pytest

from icdgen import frame_bits
from icdgen.backends.c import CBackend
from icdgen.backends.c.symbols import FILE
from icdgen.backends.c.text import comment, literal, plain
from icdgen.describe import describe
from icdgen.icd.model import Icd
from icdgen.loading import load
from tests.c import harness, odd
from tests.conftest import ROOT
from tests.icd.files import loaded, status


def files(icd: Icd) -> dict[str, str]:
    return {
        str(path): text for path, text in CBackend().files(icd, harness._renderer())
    }


@pytest.fixture(scope="module")
def shipped() -> dict[str, str]:
    return files(harness.shipped())


def without_a_field(
    icd: Icd, node_name: str, message_name: str, field_name: str
) -> Icd:
    def fewer(message):
        fixed = tuple(
            field for field in message.layout.fixed if field.name != field_name
        )
        layout = dataclasses.replace(message.layout, fixed=fixed)
        return dataclasses.replace(message, layout=layout)

    def changed(node):
        messages = tuple(
            fewer(m) if m.name == message_name else m for m in node.messages
        )
        return dataclasses.replace(node, messages=messages, digest="0" * 64)

    return Icd(tuple(changed(n) if n.name == node_name else n for n in icd.nodes))


def test_a_message_or_an_enumeration_is_in_a_file_of_its_node(shipped):
    icd = harness.shipped()
    messages = sum(len(node.messages) for node in icd.nodes)
    enums = sum(bool(node.enums) for node in icd.nodes)
    links = sum(bool(icd.protocol_of(node)) for node in icd.nodes)
    procedures = sum("procedures" in icd.protocol_of(node) for node in icd.nodes)
    assert (
        len(shipped) == 3 + len(icd.nodes) + enums + messages + 3 * links + procedures
    )
    assert (
        "cubeacp/estimated_attitude_angles.h" in shipped
        and "cubeacp.h" in shipped
        and "icdgen.h" in shipped
    )


def test_deleting_a_field_changes_only_its_message_and_the_digest_of_its_node(shipped):
    icd = without_a_field(
        harness.shipped(), "cubeacp", "Commanded Attitude Angles", "Commanded Yaw Angle"
    )
    changed = {path for path, text in files(icd).items() if shipped[path] != text}
    assert changed == {"cubeacp/commanded_attitude_angles.h", "cubeacp.h"}
    digest = re.compile(r'_DIGEST "[0-9a-f]{16}"')
    assert digest.sub("", files(icd)["cubeacp.h"]) == digest.sub(
        "", shipped["cubeacp.h"]
    )


def test_output_is_reproducible_and_contains_no_path_of_the_machine(shipped):
    assert files(harness.shipped()) == shipped
    for path, text in shipped.items():
        assert text.endswith("\n") and not text.endswith("\n\n"), path
        assert not re.search(r"[ \t]+$|\t|\r|\n\n\n", text, re.M), path
        for absent in (str(ROOT), "/home/", "Copyright", "SPDX"):
            assert absent not in text, path


def test_lines_have_at_most_120_characters_unless_a_name_is_longer(shipped):
    for path, text in shipped.items():
        for line in text.splitlines():
            assert len(line) <= 120 or re.fullmatch(
                r"(static inline [\w ]+\*?)?\w+\(|#define \w+ \S+", line
            ), f"{path}: {line}"


@pytest.mark.needs("clang-format")
def test_clang_format_leaves_all_files_unchanged(shipped, tmp_path):
    for path, text in shipped.items():
        target = tmp_path / path
        target.parent.mkdir(exist_ok=True)
        target.write_text(text, encoding="utf-8")
    style = f"--style=file:{harness.HERE.parent.parent / '.clang-format'}"
    done = subprocess.run(
        [
            "clang-format",
            style,
            "--dry-run",
            "-Werror",
            *map(str, sorted(tmp_path.rglob("*.[ch]"))),
        ],
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr[:4000]


def test_names_of_the_shipped_icds_differ_in_the_63_characters_that_c_guarantees():
    names = {
        identifier.text
        for identifier in CBackend().identifiers(harness.shipped())
        if identifier.scope == FILE
    }
    assert len(names) > 3000 and len({name[:63] for name in names}) == len(names)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a */ b", "a * / b"),
        ("a /* b", "a / * b"),
        ("/*/", "/ * /"),
        ("what??/", "what? ?/"),
        ("a\nb\t c", "a b c"),
        ("a\x07b\u202ec", "aU+0007bU+202Ec"),
        ("Größe °", "Größe °"),
    ],
)
def test_text_in_comments_is_harmless(text, expected):
    assert plain(text) == expected


def test_long_comments_are_wrapped():
    block = comment(["word " * 60], "    ")
    assert block.startswith("    /**\n     * word") and block.endswith("\n     */")
    assert max(map(len, block.splitlines())) <= 120


@pytest.mark.parametrize(
    "text", [*odd.HOSTILE, "", "?", "???", '"', "\\", "\\\\n", "\0001", "\u20acuro"]
)
def test_string_literals_represent_the_exact_text(tmp_path, text):
    source = tmp_path / "text.c"
    source.write_text(
        f"#include <stdio.h>\nint main(void)\n{{\n    static const char text[] = {literal(text)};\n"
        f"    fwrite(text, 1, sizeof text - 1, stdout);\n    return 0;\n}}\n"
    )
    program = harness.compile(
        source,
        "-std=c99",
        "-Wall",
        "-Werror",
        "-Wno-trigraphs",
        output=tmp_path / "text",
    )
    assert subprocess.run([program], capture_output=True).stdout.decode() == text


def test_comments_mention_reserved_bits_if_a_message_has_some(shipped):
    results = set()
    for node in harness.shipped().nodes:
        for message in describe(harness.shipped()).node(node).messages:
            has_reserved_bits = bool(frame_bits.reserved_bits(message.model, node))
            text = shipped[f"{node.name}/{message.name}.h"]
            assert ("reserved bits 0" in text) == has_reserved_bits, message.model.name
            results.add(has_reserved_bits)
    assert results == {True, False}


STUTTER = """\
icdgen: 1
node: {name: pump, title: Pump, byte_order: little, bit_order: lsb0}
enums:
  - {name: PumpState, members: [{value: 0, name: Idle}, {value: 1, name: Running}]}
messages:
  - {name: Pump Status, id: 1, kind: telemetry, length: 1, fields: [{at: 0, bits: 8, name: State, type: enum, enum: PumpState}]}
  - {name: Pump, id: 2, kind: telecommand, length: 1, fields: [{at: 0, bits: 8, name: Level, type: uint, unit: V, formula: raw*2}]}
  - {name: PumpedVolume, id: 3, kind: telemetry, length: 0}
"""


def test_identifiers_contain_the_name_of_the_node_once(tmp_path):
    (tmp_path / "pump.yaml").write_text(STUTTER, encoding="utf-8")
    icd = harness.read_unchecked(tmp_path / "pump.yaml")
    texts = files(icd)
    enums, status = texts["pump/enums.h"], texts["pump/pump_status.h"]
    assert (
        "typedef uint8_t pump_state_t;" in enums and "PUMP_STATE_RUNNING = 1" in enums
    )
    assert (
        "pump_status_decode(" in status
        and "PUMP_STATUS_ID" in status
        and "pump_state_t state;" in status
    )
    assert (
        "pump_pump_set_level_v(" in texts["pump/pump.h"]
        and "pump_pumped_volume_t" in texts["pump/pumped_volume.h"]
    )
    assert not [
        path
        for path, text in texts.items()
        if re.search("pump_pump_st", text, re.IGNORECASE)
    ]
    harness.compile_all(icd, harness.generate(icd, tmp_path / "c"), "gcc", "c99")
    (tmp_path / "pump.yaml").write_text(
        STUTTER + "  - {name: Status, id: 4, kind: telemetry, length: 0}\n"
    )
    (clash,) = load([tmp_path / "pump.yaml"]).findings
    assert (
        clash.code == "ICD071"
        and "`PUMP_STATUS_" in clash.message
        and clash.message.endswith("in C/C++")
    )


@pytest.mark.parametrize(("packets", "bitmap"), [(7, 1), (8, 1), (9, 2), (16, 2)])
def test_a_bitmap_has_a_bit_for_each_packet_of_the_largest_block(
    tmp_path, packets, bitmap
):
    text = (ROOT / "tests/procedures/other_steps.yaml").read_text("utf-8")
    path = tmp_path / "store.yaml"
    path.write_text(text.replace("size: 160", f"size: {8 * packets}"), "utf-8")
    header = files(load([path]).icd)["store/procedures.h"]
    sizes = dict(re.findall(r"^#define STORE_(\w+_BYTES) (\d+)u$", header, re.M))
    assert sizes == {
        "READ_BLOCK_BYTES": f"{8 * packets}",
        "READ_BITMAP_BYTES": f"{bitmap}",
        "WRITE_BITMAP_BYTES": f"{bitmap}",
    }


WIDE = """\
structs:
  - {name: Position, length: 8, fields: [{at: 0, bits: 64, name: Angle, type: uint, formula: raw*FACTOR, unit: deg}]}
"""
USES = "at: 0, name: Position, struct: Position"


@pytest.mark.parametrize(
    ("factor", "support"),
    [("0.5", "icdgen.h"), ("123456789012345678/1000000000000000007", "icdgen_wide.h")],
)
def test_every_header_that_a_struct_includes_is_generated(tmp_path, factor, support):
    text = WIDE.replace("FACTOR", factor) + status(USES, length=8)
    generated = files(loaded(tmp_path, text).icd)
    assert f'#include "../{support}"' in generated["demo/position.h"]
    for name, header in generated.items():
        folder = PurePosixPath(name).parent
        for included in re.findall(r'^#include "(.*)"', header, re.M):
            assert posixpath.normpath(folder / included) in generated, name


LIMITS = """\
protocol:
  link:
    buses:
      uart:
        framing: {by: escape, escape: 16, start: 2, end: 3, data: 16, other: ignore, escaped_in: [data]}
messages:
  - {name: First, kind: telecommand, id: 0, length: 0}
  - {name: Last, kind: telecommand, id: 255, length: 0}
  - {name: Early, kind: telemetry, id: 0, length: 1, fields: [{at: 0, bits: 8, name: Level, type: uint}]}
  - {name: Late, kind: telemetry, id: 255, length: 1, fields: [{at: 0, bits: 8, name: Level, type: uint}]}
"""


def test_a_client_can_send_and_receive_the_first_and_the_last_id(tmp_path):
    link = files(loaded(tmp_path, LIMITS).icd)["demo/link.c"]
    rows = re.findall(r"^    \{(\d+)u, \w+, (\d+)u\}, /\* (\w+) \*/$", link, re.M)
    assert rows == [
        ("0", "0", "First"),
        ("255", "0", "Last"),
        ("0", "1", "Early"),
        ("255", "1", "Late"),
    ]
