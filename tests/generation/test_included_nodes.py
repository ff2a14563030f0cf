"""Generated files name the node that declares a part, whether it is that of the file or
one that it includes.
"""

from __future__ import annotations

import re

import pytest

from icdgen.backends.c import CBackend
from icdgen.backends.python import PythonBackend
from icdgen.backends.rust import RustBackend
from icdgen.backends.xtce import XtceBackend
from icdgen.render import Renderer
from tests.icd.files import loaded

BASE = """\
# base.yaml
icdgen: 1
node: {name: base, title: Base, byte_order: big, bit_order: msb0}
enums:
  - name: Mode
    members:
      - {value: 1, name: "Off"}
      - {value: 200, to: 210, name: Vendor}
structs:
  - name: Pair
    length: 2
    fields:
      - {name: First, at: 0, bits: 8, type: uint}
      - {name: Second, at: 8, bits: 8, type: enum, enum: Mode}
messages:
  - name: Ping
    id: 0
    kind: telecommand
    length: 1
    fields:
      - {name: Mode, at: 0, bits: 8, type: enum, enum: Mode}
  - name: Pong
    id: 129
    kind: telemetry
    length: 2
    fields:
      - {name: Pair, at: 0, struct: Pair}
"""
DEMO = """\
icdgen: 1
include: [base.yaml]
node: {name: demo, title: Demo, byte_order: little, bit_order: lsb0, node_type: 0, interface_version: 0}
enums:
  - name: Wide
    members:
      - {value: 0, name: Zero}
      - {value: 40000, name: Many}
messages:
  - name: Set Both
    kind: configuration
    set_id: 1
    get_id: 130
    length: 4
    fields:
      - {name: Pair, at: 0, struct: Pair}
      - {name: Wide, at: 16, bits: 16, type: enum, enum: Wide}
  - name: List
    id: 131
    kind: telemetry
    length: 1
    shares_id: true
    fields:
      - {name: Count, at: 0, bits: 8, type: uint}
      - {name: Levels, at: 8, bits: 8, type: uint, count: Count, up_to: 4}
  - name: Flag
    id: 131
    kind: telemetry
    length: 1
    shares_id: true
    fields:
      - {name: Kind, at: 0, bits: 8, type: uint, const: 0}
"""


@pytest.fixture(scope="module")
def files(tmp_path_factory) -> dict[str, str]:
    result = loaded(tmp_path_factory.mktemp("icd"), DEMO + BASE)
    assert result.ok, [finding.message for finding in result.findings]
    return {
        f"{backend.name}/{path}": text
        for backend in (CBackend(), PythonBackend(), RustBackend(), XtceBackend())
        for path, text in backend.files(result.icd, Renderer(backend.name))
    }


def section(text: str, first: str, last: str) -> list[str]:
    """Return the lines after the line ``first`` and before the next line ``last``."""
    lines = text.splitlines()
    start = lines.index(first) + 1
    return lines[start : lines.index(last, start)]


def mentions(text: str, pattern: str) -> list[str]:
    """Return the matches of a pattern in a text, in order."""
    return [match[0] for match in re.finditer(pattern, text, re.MULTILINE)]


@pytest.mark.parametrize(
    ("path", "headers"),
    [
        ("base.h", "icdgen base/enums base/pair base/ping base/pong"),
        (
            "demo.h",
            "icdgen base demo/enums demo/set_both demo/list demo/flag",
        ),
        ("demo/set_both.h", "../icdgen enums ../base/pair"),
        ("demo/list.h", "../icdgen"),
        ("base/pong.h", "../icdgen pair"),
        ("base/pair.h", "../icdgen enums"),
        ("base/ping.h", "../icdgen enums"),
    ],
)
def test_a_header_includes_those_of_its_parts(files, path, headers):
    included = mentions(files[f"c/{path}"], r'(?<=^#include ").*(?=\.h"$)')
    assert included == headers.split()


def test_zero_is_a_type_and_a_version_of_a_node(files):
    assert mentions(files["c/demo.h"], r"DEMO_(NODE|INTER)\w+ \S+") == [
        "DEMO_NODE_TYPE 0u",
        "DEMO_INTERFACE_VERSION 0u",
    ]
    package = files["python/icdgen_messages/demo/__init__.py"]
    assert mentions(package, r"^(NODE_TYPE|INTERFACE_VERSION) = .*") == [
        "NODE_TYPE = 0",
        "INTERFACE_VERSION = 0",
    ]
    assert mentions(files["rust/src/demo/mod.rs"], r"pub const \w+: .*") == [
        "pub const NODE_TYPE: u8 = 0;",
        "pub const INTERFACE_VERSION: u8 = 0;",
    ]
    for path in (
        "c/base.h",
        "python/icdgen_messages/base/__init__.py",
        "rust/src/base/mod.rs",
    ):
        assert not mentions(files[path], "NODE_TYPE|INTERFACE_VERSION"), path


def test_a_message_of_c_is_selected_by_its_id_unless_its_direction_shares_ids(files):
    text = files["c/demo.h"]
    start = text.index("demo_telecommand_name(uint8_t id)")
    telemetry, telecommands = text[:start], text[start:]
    by_id = ["BASE_PING_ID", "DEMO_SET_BOTH_SET_ID"]
    which = ["PONG", "SET_BOTH", "LIST", "FLAG"]
    # name, length, decode, encode
    assert mentions(telecommands, r"(?<=case )\w+") == by_id * 4
    assert mentions(telemetry, r"(?<=case )\w+") == [
        "BASE_PONG_ID",
        "DEMO_SET_BOTH_GET_ID",
        "DEMO_FLAG_ID",
        *(f"DEMO_TELEMETRY_IS_{name}" for name in which * 2),
        "DEMO_TELEMETRY_IS_LIST",  # the size of the only one with variable length
        *(f"DEMO_TELEMETRY_IS_{name}" for name in which * 2),
    ]
    assert mentions(telemetry, r"DEMO_TELEMETRY_IS_\w+ = \d,?") == [
        "DEMO_TELEMETRY_IS_PONG = 0,",
        "DEMO_TELEMETRY_IS_SET_BOTH = 1,",
        "DEMO_TELEMETRY_IS_LIST = 2,",
        "DEMO_TELEMETRY_IS_FLAG = 3",
    ]


def test_functions_of_c_call_those_of_the_node_that_declares_the_message(files):
    calls = r"\w+_(?:decode|encode|size)\(&message->as\.\w+"
    assert mentions(files["c/demo.h"], calls) == [
        "demo_list_size(&message->as.list",
        "base_pong_decode(&message->as.pong",
        "demo_set_both_decode(&message->as.set_both",
        "demo_list_decode(&message->as.list",
        "demo_flag_decode(&message->as.flag",
        "base_pong_encode(&message->as.pong",
        "demo_set_both_encode(&message->as.set_both",
        "demo_list_encode(&message->as.list",
        "demo_flag_encode(&message->as.flag",
        "base_ping_decode(&message->as.ping",
        "demo_set_both_decode(&message->as.set_both",
        "base_ping_encode(&message->as.ping",
        "demo_set_both_encode(&message->as.set_both",
    ]


def test_lengths_of_c_are_those_of_each_message(files):
    lengths = mentions(files["c/demo.h"], r"(?<=\*length = )\w+")
    telemetry = ["BASE_PONG", "DEMO_SET_BOTH", "DEMO_LIST", "DEMO_FLAG"]
    expected = [*telemetry, "BASE_PING", "DEMO_SET_BOTH"]
    assert lengths == [f"{name}_LENGTH" for name in expected]


def test_the_narrower_message_of_a_shared_id_is_tried_first(files):
    case = section(files["c/demo.h"], "    case DEMO_FLAG_ID:", "    default:")
    assert case == [
        "        if ((length == DEMO_FLAG_LENGTH) &&",
        "            (buffer[0] == 0x00u)) {",
        "            *which = DEMO_TELEMETRY_IS_FLAG;",
        "            return ICD_OK;",
        "        }",
        "        if ((length >= 1u) &&",
        "            (length <= DEMO_LIST_LENGTH)) {",
        "            *which = DEMO_TELEMETRY_IS_LIST;",
        "            return ICD_OK;",
        "        }",
        "        return ICD_ERROR_UNKNOWN_ID;",
    ]


def test_a_module_of_python_imports_parts_of_both_nodes(files):
    package = "python/icdgen_messages"
    homes = section(
        files[f"{package}/demo/__init__.py"], "_HOMES: dict[str, str] = {", "}"
    )
    assert homes == [
        '    "Mode": "..base._types.mode",',
        '    "Pair": "..base._types.pair",',
        '    "Ping": "..base._types.ping",',
        '    "Pong": "..base._types.pong",',
        '    "Flag": "._types.flag",',
        '    "List": "._types.list",',
        '    "SetBoth": "._types.set_both",',
        '    "Wide": "._types.wide",',
    ]
    text = files[f"{package}/demo/_types/set_both.py"]
    assert mentions(text, r"^from \..*") == [
        "from ... import _base",
        "from . import _Node",
        "from ...base._types.pair import Pair",
        "from .wide import Wide",
    ]
    assert "    SET_ID = 1\n    GET_ID = 130\n    IDS = (SET_ID, GET_ID)\n" in text
    assert "    IDS = (ID,)\n" in files[f"{package}/demo/_types/flag.py"]
    orders = {
        name: mentions(files[f"{package}/{name}.py"], "^    B[IY]T[E_].*")
        for name in ("demo/_types/flag", "base/_types/ping")
    }
    assert orders == {
        "demo/_types/flag": [],
        "base/_types/ping": ['    BYTE_ORDER = "big"', '    BIT_ORDER = "msb0"'],
    }
    assert mentions(files[f"{package}/demo/_types/__init__.py"], "_Node.*") == [
        "_Node as _base",
        "_Node(_base):",
        "_Node = None",
    ]
    assert mentions(files[f"{package}/base/_types/__init__.py"], "_Node.*") == [
        "_Node:",
        "_Node = None",
    ]


def test_messages_of_python_are_found_by_the_id_of_their_direction(files):
    text = files["python/icdgen_messages/demo/__init__.py"]
    head = "_TELEMETRY: dict[int, str | tuple[_lazy.Candidate, ...]] = {"
    assert section(text, "_TELECOMMANDS: dict[int, str] = {", "}") == [
        '    0: "Ping",',
        '    1: "SetBoth",',
    ]
    assert section(text, head, "}") == [
        '    129: "Pong",',
        '    130: "SetBoth",',
        "    131: (",
        '        ("Flag", range(1, 2), ((0, 0xFF, 0x00),)),',
        '        ("List", range(1, 6), ()),',
        "    ),",
    ]
    assert section(text, "ENUMS: dict[str, str] = {", "}") == ['    "Wide": "Wide",']


def test_a_range_of_an_enumeration_of_python_has_a_name_for_each_end(files):
    text = files["python/icdgen_messages/base/_types/mode.py"]
    assert text.endswith(
        "    __ranges__ = (\n"
        '        (200, 210, "VENDOR", "Vendor"),\n'
        "    )\n"
        '    OFF = 1, "Off"\n'
        '    VENDOR_FIRST = 200, "Vendor"\n'
        '    VENDOR_LAST = 210, "Vendor"\n'
    )


def test_paths_of_rust_lead_to_the_node_that_declares_the_message(files):
    text = files["rust/src/demo/mod.rs"]
    telecommand, telemetry = text.split("\n/// Any telemetry message of the node.\n")
    assert "//! It also speaks the messages of [`base`](crate::base).\n" in text
    assert mentions(telecommand, r"^use .*|^(?:pub )?mod .*|^pub use .*") == [
        "use crate::support::{write_frame, write_to, Error};",
        "pub mod enums;",
        "mod set_both;",
        "pub use self::set_both::SetBoth;",
        "mod list;",
        "pub use self::list::List;",
        "mod flag;",
        "pub use self::flag::Flag;",
    ]
    arms = r"(?<=Self::)\w+\((?:_|message)\) => .*(?=,)"
    assert mentions(telecommand, arms) == [
        "Ping(message) => write_to(buffer, &message.to_bytes()?)",
        "SetBoth(message) => write_to(buffer, &message.to_bytes()?)",
        "Ping(_) => crate::base::Ping::ID",
        "SetBoth(_) => SetBoth::SET_ID",
        "Ping(_) => crate::base::Ping::LENGTH",
        "SetBoth(_) => SetBoth::LENGTH",
        "Ping(_) => crate::base::Ping::NAME",
        "SetBoth(_) => SetBoth::NAME",
        "Ping(message) => ::core::fmt::Display::fmt(message, out)",
        "SetBoth(message) => ::core::fmt::Display::fmt(message, out)",
    ]
    assert mentions(telemetry, arms)[:12] == [
        "Pong(message) => write_to(buffer, &message.to_bytes()?)",
        "SetBoth(message) => write_to(buffer, &message.to_bytes()?)",
        "List(message) => write_frame(buffer, &message.to_bytes()?)",
        "Flag(message) => write_to(buffer, &message.to_bytes()?)",
        "Pong(_) => crate::base::Pong::ID",
        "SetBoth(_) => SetBoth::GET_ID",
        "List(_) => List::ID",
        "Flag(_) => Flag::ID",
        "Pong(_) => crate::base::Pong::LENGTH",
        "SetBoth(_) => SetBoth::LENGTH",
        "List(message) => message.size()",
        "Flag(_) => Flag::LENGTH",
    ]
    assert "pub const fn length(" in telecommand and "pub fn length(" in telemetry
    assert mentions(telemetry, r"^            \S+ID if .*") == [
        "            Flag::ID if bytes.len() == Flag::LENGTH && bytes[0] == 0x00 => {",
        "            List::ID if (1..=List::LENGTH).contains(&bytes.len()) => {",
    ]


@pytest.mark.parametrize(
    ("module", "uses", "members"),
    [
        (
            "base/pair",
            ["super::enums", "crate::support::{structure, Coded}"],
            ["first: u8", "second: Coded<enums::Mode>"],
        ),
        (
            "base/ping",
            ["super::enums", "crate::support::{message, Coded, Error}"],
            ["mode: Coded<enums::Mode>"],
        ),
        (
            "demo/set_both",
            ["super::enums", "crate::support::{message, put, take, Coded, Error}"],
            ["pair: crate::base::Pair", "wide: Coded<enums::Wide>"],
        ),
        ("demo/flag", ["crate::support::{message, Error}"], ["kind: u8"]),
    ],
)
def test_a_module_of_rust_uses_what_its_members_need(files, module, uses, members):
    text = files[f"rust/src/{module}.rs"]
    assert mentions(text, r"(?<=^use ).*(?=;)") == uses
    assert mentions(text, r"(?<=^    pub )\w+: .*(?=,$)") == members


def test_traits_of_rust_are_those_of_the_directions_of_a_message(files):
    traits = {
        module: mentions(
            files[f"rust/src/{module}.rs"], r"(?<=^impl crate::)\w+(?= for)"
        )
        for module in ("base/ping", "base/pong", "demo/set_both", "demo/list")
    }
    assert traits == {
        "base/ping": ["Telecommand"],
        "base/pong": ["Telemetry"],
        "demo/set_both": ["Telecommand", "Telemetry"],
        "demo/list": ["Telemetry"],
    }


def test_values_between_the_ends_of_a_range_have_its_name_in_c(files):
    text = files["c/base/enums.h"]
    assert mentions(text, r"(?<=    )BASE_MODE_\w+ = \d+,?") == [
        "BASE_MODE_OFF = 1,",
        "BASE_MODE_VENDOR_FIRST = 200,",
        "BASE_MODE_VENDOR_LAST = 210",
    ]
    assert text.endswith(
        "    default:\n"
        "        break;\n"
        "    }\n"
        "    if (value > 200u && value < 210u) {\n"
        '        return "Vendor";\n'
        "    }\n"
        "    return NULL;\n"
        "}\n"
        "\n"
        "#endif /* BASE_ENUMS_H */\n"
    )
    assert mentions(files["c/demo/enums.h"], "#define DEMO_WIDE.*") == [
        "#define DEMO_WIDE_ZERO 0u",
        "#define DEMO_WIDE_MANY 40000u",
    ]


def test_an_enumeration_of_rust_has_the_default_zero_only_if_zero_has_a_name(files):
    own, included = files["rust/src/demo/enums.rs"], files["rust/src/base/enums.rs"]
    assert "#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]" in own
    assert "    /// Zero (0).\n    #[default]\n    Zero,\n" in own
    assert "impl Default for" not in own
    assert "#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]" in included
    assert "impl Default for Mode {" in included and "#[default]" not in included
    assert mentions(included, r"Self::\w+\(200.*") == [
        'Self::Unknown(200..=210) => "Vendor",'
    ]


def test_a_system_of_xtce_has_the_messages_of_included_nodes(files):
    text = files["xtce/demo.xml"]
    assert mentions(text, r'(?<=<Comparison parameterRef="Id" value=")\d+') == [
        "131",
        "129",
        "130",
    ]
    assert mentions(text, r'(?<=argumentName="Id" argumentValue=")\d+') == ["0", "1"]
    assert mentions(text, r'(?<=SequenceContainer name=")\w+') == [
        "TelemetryFrame",
        "Id131",
        "Pong",
        "SetBoth",
        "List",
        "Flag",
    ]
    bases = mentions(text, r'(?<=BaseContainer containerRef=")\w+')
    assert bases[:5] == ["TelemetryFrame"] * 3 + ["Id131"] * 2
    assert '<Enumeration value="200" maxValue="210" label="Vendor"/>' in text
    assert mentions(files["xtce/base.xml"], r'(?<=value=")129') == ["129"]


def test_a_node_that_includes_two_nodes_has_the_messages_of_both(tmp_path):
    other = BASE.replace("base", "other").replace("Base", "Other")
    other = re.sub(r"P([ioa])", r"Q\1", other).replace("Mode", "State")
    other = other.replace("id: 0", "id: 9").replace("id: 129", "id: 200")
    text = DEMO.replace("[base.yaml]", "[base.yaml, other.yaml]") + BASE + other
    result = loaded(tmp_path, text)
    assert result.ok, [finding.message for finding in result.findings]
    generated = {
        f"{backend.name}/{path}": text
        for backend in (CBackend(), PythonBackend(), RustBackend())
        for path, text in backend.files(result.icd, Renderer(backend.name))
    }
    types = generated["python/icdgen_messages/demo/_types/__init__.py"]
    assert mentions(types, "_Node.*") == [
        "_Node as _other",
        "_Node as _base",
        "_Node(_other, _base):",
        "_Node = None",
    ]
    assert mentions(generated["c/demo.h"], r'(?<=#include ")\w+(?=\.h)') == [
        "icdgen",
        "base",
        "other",
    ]
    assert mentions(generated["c/demo.h"], r"(?<=case )\w+_ID") == [
        "BASE_PONG_ID",
        "OTHER_QONG_ID",
        "DEMO_SET_BOTH_GET_ID",
        "DEMO_FLAG_ID",
        *["BASE_PING_ID", "OTHER_QING_ID", "DEMO_SET_BOTH_SET_ID"] * 4,
    ]
    assert mentions(generated["rust/src/demo/mod.rs"], r"(?<=_\) => )\S+ID") == [
        "crate::base::Ping::ID",
        "crate::other::Qing::ID",
        "SetBoth::SET_ID",
        "crate::base::Pong::ID",
        "crate::other::Qong::ID",
        "SetBoth::GET_ID",
        "List::ID",
        "Flag::ID",
    ]
