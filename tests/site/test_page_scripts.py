"""Scripts of single pages, with a stand-in for the document of a browser."""

from __future__ import annotations

import json

import pytest

from tests.conftest import ROOT
from tests.site.javascript import run_script

HTML = ROOT / "templates" / "html"


def in_page(name: str, code: str, argument: object) -> object:
    """Return the result of code that gets the `source` of a script and the argument."""
    file = json.dumps(str(HTML / name))
    return run_script(
        f"const source = require('node:fs').readFileSync({file}, 'utf8'); {code}",
        argument,
    )


FRAME_LINKS = """
    globalThis.document = { body: { dataset: { root: "../" } } };
    const links = new Function(`${source}; return icdgenFrameLinks;`)();
    globalThis.icdgenRecognize = { recognize: (index, text) => {
        if (text === "none") throw new Error("no frame");
        if (text === "two") throw Object.assign(new Error("two"), { readings: argument });
        return argument;
    } };
    const before = links.isLoaded();
    globalThis.icdgenFrameIndex = {};
    return [before, links.isLoaded(), ...["", "two", "none"].map(links.of)];
"""
STATUS = {"title": "Demo", "url": "demo/status.html", "leftOut": [], "remarks": []}
FRAMES = [
    STATUS | {
        "what": "telemetry", "message": "Status", "data": [0, 1, 0xAB], "time": "1.5",
        "remarks": ["CRC is right", "left out: one"], "leftOut": ["one", "two"],
    },
    STATUS | {"what": "request", "message": "Status", "data": []},
    STATUS | {"what": "acknowledge", "message": "Stop", "data": [], "remarks": ["used"]},
    STATUS | {"what": "refusal", "message": "", "data": [], "leftOut": ["three"]},
    STATUS | {"what": "telecommand", "message": "Stop", "data": []},
]  # fmt: skip
LINKS = [
    {
        "title": "Status",
        "context": "1.5 · telemetry · Demo · CRC is right",
        "url": "../demo/status.html#try=0001ab",
    },
    {"title": "request for Status", "context": "Demo", "url": "../demo/status.html"},
    {
        "title": "acknowledge of Stop",
        "context": "Demo · used",
        "url": "../demo/status.html",
    },
    {"title": "refusal", "context": "Demo", "url": "../demo/status.html"},
    {
        "title": "Stop",
        "context": "telecommand · Demo",
        "url": "../demo/status.html#try=",
    },
]


def test_a_pasted_frame_links_to_its_message_with_its_data():
    """A frame without data links to the page alone."""
    left_out = ["one", "two", "three"]
    assert in_page("frame-links.js", FRAME_LINKS, FRAMES) == [
        False,
        True,
        {"links": LINKS, "error": "", "leftOut": left_out},
        {"links": LINKS, "error": "two", "leftOut": []},
        {"links": [], "error": "no frame", "leftOut": []},
    ]


def test_a_text_of_eight_characters_of_bytes_is_taken_for_a_frame():
    texts = {
        "1F 7F 92": True,
        " 1F7F 9 ": False,  # without spaces, 6 characters
        "1F7F 92": False,
        "1F7F92FF": True,
        "1F7F92FFA": False,
        "0x1F,0x7F": True,
        r"\x1f\x7f": True,
        "{$1F; #7F}": True,
        "(1F.7F-92)": True,
        "deadbeef": True,
        "battery voltage": False,
        "table 149": False,
    }
    code = """
        globalThis.document = { body: { dataset: { root: "" } } };
        const links = new Function(`${source}; return icdgenFrameLinks;`)();
        return argument.map(links.looksLikeBytes);
    """
    assert in_page("frame-links.js", code, list(texts)) == list(texts.values())


FILTER = """
    const box = () => ({ value: "", marks: {}, setAttribute(key, text) { this.marks[key] = text; } });
    const elements = Object.fromEntries(argument.boxes.map((name) => [name, box()]));
    const rows = argument.rows.map(([textContent, ids, kind, group, length, mask]) =>
        ({ textContent, dataset: { ids, kind, group, length, mask } }));
    const listeners = {};
    const filter = { elements, addEventListener: (name, call) => (listeners[name] = call) };
    const matches = {};
    globalThis.document = { getElementById: (id) => ({ filter, matches })[id], querySelectorAll: () => rows };
    new Function(source)();
    return argument.inputs.map((input) => {
        for (const name of argument.boxes) elements[name].value = input[name] ?? "";
        listeners.input();
        const shown = rows.filter((row) => !row.hidden).map((row) => row.textContent.split(" ")[0]);
        return [shown.join(""), matches.textContent, elements.bytes.marks["aria-invalid"]];
    });
"""
ROWS = [
    ["A Reset", "3", "telecommand", "Setup", "0", ""],
    ["B Status of 31", "146", "telemetry", "", "6", "0 7"],
    ["C Mode", "10 146", "configuration", "Setup", "31", "12"],
]


@pytest.mark.parametrize(
    ("keys", "shown"),
    [
        ({}, "ABC"),
        ({"text": "reset"}, "A"),
        ({"text": " RESET  setup "}, ""),
        ({"text": "status of"}, "B"),
        ({"text": "146"}, "BC"),
        ({"text": "0x92"}, "BC"),
        ({"text": "0x0A"}, "C"),
        ({"text": "31"}, "B"),
        ({"text": "3"}, "AB"),
        ({"text": "3 reset"}, "A"),
        ({"kind": "telemetry"}, "B"),
        ({"group": "Setup"}, "AC"),
        ({"group": "Setup", "kind": "configuration"}, "C"),
        ({"bytes": "6"}, "B"),
        ({"bytes": "0"}, "A"),
        ({"bytes": "6-31"}, "BC"),
        ({"bytes": "7 – 30"}, ""),
        ({"bytes": "<6"}, "A"),
        ({"bytes": "<=6"}, "AB"),
        ({"bytes": ">6"}, "C"),
        ({"bytes": ">= 6"}, "BC"),
        ({"bytes": "Any"}, "ABC"),
        ({"mask": "any"}, "BC"),
        ({"mask": "0"}, "B"),
        ({"mask": ">7"}, "C"),
        ({"mask": "1"}, ""),
    ],
)
def test_messages_are_filtered_by_text_id_kind_group_length_and_mask(keys, shown):
    argument = {
        "rows": ROWS,
        "inputs": [keys],
        "boxes": ["text", "kind", "group", "bytes", "mask"],
    }
    count = "3 messages" if len(shown) == 3 else f"{len(shown)} of 3"
    assert in_page("filter.js", FILTER, argument) == [[shown, count, "false"]]


def test_a_node_without_groups_and_log_is_filtered_and_bad_lengths_are_marked():
    argument = {
        "rows": ROWS,
        "inputs": [{"bytes": text} for text in ("six", "6-", "=6", "", "-6", "6")],
        "boxes": ["text", "kind", "bytes"],
    }
    bad, all_rows = ["ABC", "3 messages", "true"], ["ABC", "3 messages", "false"]
    assert in_page("filter.js", FILTER, argument) == [
        bad,
        bad,
        bad,
        all_rows,
        bad,
        ["B", "1 of 3", "false"],
    ]


LIT = """
    const marks = [];
    globalThis.document = { createElementNS: () => ({ setAttribute(key, value) { this[key] = value; } }) };
    const svg = {
        querySelectorAll: () => [],
        querySelector: () => ({ replaceChildren: (...shapes) => marks.push(...shapes) }),
        classList: { add: (name) => marks.push(name) },
    };
    const lit = new Function(`${source}; return icdgenLit;`)();
    lit.show(svg, argument.place, argument.bits, (bit) => argument.set.includes(bit), () => "");
    return marks.map((one) => one.class === "glow" ? [one.x, one.y, one.width, one.height] : typeof one === "string" ? one : one.y);
"""


def test_set_bits_of_a_drawn_part_are_marked_in_their_row_and_column():
    """The part begins at byte 2, and its last byte is not in the frame."""
    place = {
        "across": 2, "cell": 50, "left": 64, "top": 24, "row": 30, "rows": [0, -1, 4], "first": 2,
    }  # fmt: skip
    argument = {"place": place, "bits": 40, "set": [0, 16, 31, 32, 48, 55, 56]}
    assert in_page("lit.js", LIT, argument) == [
        [64, 24, 50, 30],
        51,
        [64 + 15 * 50, 24, 50, 30],
        51,
        [64, 84, 50, 30],
        111,
        [64 + 7 * 50, 84, 50, 30],
        111,
        "decoding",
    ]


VALUES = """
    const load = (name) => require("node:path").join(argument.folder, name);
    globalThis.icdgenFrames = require(load("frames.js"));
    const codec = (globalThis.icdgenCodec = require(load("codec.js")));
    const values = new Function(`${source}; return icdgenValues;`)();
    const bitsOf = (field, raw) => (field.type === "float" ? codec.floatBits(field, raw) : BigInt(raw));
    const special = { nan: NaN, "-0": -0 };
    return argument.rows.map(([field, raw]) => {
        const value = bitsOf(field, special[raw] ?? raw);
        const { text, wrong } = values.remark(field, value, argument.enums);
        return [text, wrong, values.shortText(field, value, argument.enums)];
    });
"""
UINT = {"name": "Level", "type": "uint", "bits": 8, "unit": "V"}
HALF = UINT | {"scale": [1, -4, 2]}
FLOAT = {"name": "Level", "type": "float", "bits": 32}
MODE = {"name": "Mode", "type": "enum", "enum": "Mode", "bits": 8}
OUTSIDE = ["outside the limits", True]


@pytest.mark.parametrize(
    ("field", "raw", "remark", "short"),
    [
        (UINT, 0, ["", False], "0 V"),
        (UINT | {"special": [[0, "off"], [9, "on"]]}, 0, ["off", False], "0 V"),
        (UINT | {"special": [[0, "off"], [9, "on"]]}, 9, ["on", False], "9 V"),
        (UINT | {"special": [[0, "off"]], "const": 7}, 0, ["off", False], "0 V"),
        (UINT | {"const": 0}, 1, ["must be 0", True], "1 V"),
        (UINT | {"const": 0}, 0, ["", False], "0 V"),
        (UINT | {"base": ["0x", 16, 2], "unit": ""}, 10, ["", False], "0x0A"),
        (MODE, 0, ["", False], "Idle"),
        (MODE, 3, ["", False], "Run"),
        (MODE, 4, ["no such member", True], "4?"),
        (UINT | {"limits": {"min": [3, 1]}}, 2, OUTSIDE, "2 V"),
        (UINT | {"limits": {"min": [3, 1]}}, 3, ["", False], "3 V"),
        (UINT | {"limits": {"max": [3, 1]}}, 3, ["", False], "3 V"),
        (UINT | {"limits": {"max": [3, 1]}}, 4, OUTSIDE, "4 V"),
        (UINT | {"limits": {"above": [3, 1]}}, 3, OUTSIDE, "3 V"),
        (UINT | {"limits": {"above": [3, 1]}}, 4, ["", False], "4 V"),
        (UINT | {"limits": {"below": [3, 1]}}, 3, OUTSIDE, "3 V"),
        (UINT | {"limits": {"below": [3, 1]}}, 2, ["", False], "2 V"),
        (UINT | {"limits": {"min": [1, 1], "below": [3, 1]}}, 0, OUTSIDE, "0 V"),
        (HALF | {"limits": {"max": [1, 2]}}, 5, ["", False], "0.5 V"),
        (HALF | {"limits": {"max": [1, 2]}}, 6, OUTSIDE, "1.0 V"),
        (HALF | {"limits": {"min": [-3, 2]}}, 0, OUTSIDE, "-2.0 V"),
        (HALF | {"limits": {"min": [-3, 2]}}, 1, ["", False], "-1.5 V"),
        (FLOAT | {"limits": {"max": [1, 10]}}, 0.5, OUTSIDE, "0.5"),
        (FLOAT | {"special": [[0x7FC00000, "none"]]}, "nan", ["none", False], "NaN"),
        (FLOAT | {"special": [[0, "none"]]}, "-0", ["none", False], "-0"),
        (FLOAT | {"special": [[0, "none"]]}, 0.1, ["", False], "0.1"),
    ],
)
def test_a_value_is_remarked_on_if_it_is_special_or_not_allowed(
    field, raw, remark, short
):
    argument = {
        "folder": str(HTML),
        "rows": [[field, raw]],
        "enums": {"Mode": [[0, "Idle"], [1, "Run", 3]]},
    }
    assert in_page("values.js", VALUES, argument) == [[*remark, short]]
