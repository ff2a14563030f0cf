"""The command line and the site show values with the digits that the resolution of
their field justifies.
"""

from __future__ import annotations

import json
import re
from dataclasses import replace
from fractions import Fraction
from random import Random
from typing import Any

import jsonschema_rs
import pytest

from icdgen import backends, codec
from icdgen.backends.html.plan import enum_plan, message_plan
from icdgen.describe.display import number_text
from icdgen.diff.inputs import shown as shown_input
from icdgen.icd import floats
from icdgen.icd.model import Icd
from icdgen.icd.places import NodePlace
from icdgen.show.machine import SCHEMA, to_json
from icdgen.show.people import to_text
from icdgen.values.entry import parse_physical
from icdgen.values.frame import FieldValue
from tests.conformance.build import renderer
from tests.conftest import ROOT
from tests.features.outputs import icd_of
from tests.site.javascript import run_script

SENSOR = """\
icdgen: 1
node: {name: sensor, title: Sensor, byte_order: big, bit_order: msb0}
messages:
  - name: Values
    id: 1
    kind: telemetry
    length: 40
    fields:
      - {at: 0, bits: 16, name: Quadratic, type: uint, formula: "0.0000001*raw^2 + 0.0045*raw - 40.2", unit: C}
      - {at: 16, bits: 16, name: Thirds, type: int, formula: "raw/3"}
      - {at: 32, bits: 16, name: Fahrenheit, type: uint, formula: "(raw - 32)*5/9", unit: C}
      - {at: 48, bits: 16, name: Binary, type: int, formula: raw*2^-14}
      - {at: 64, bits: 16, name: Hundredths, type: int, formula: raw*0.01}
      - {at: 80, bits: 16, name: Sixteenths, type: int, formula: raw*0.0625}
      - {at: 96, bits: 32, name: Single Float, type: float, formula: raw*10 + 0}
      - {at: 128, bits: 32, name: Plain, type: float}
      - {at: 160, bits: 64, name: Double Float, type: float, formula: raw*0.1}
      - {at: 224, bits: 16, name: Table, type: uint, points: [[0, -40], [512, 20.5], [1023, 125]], outside: clamp}
      - {at: 240, bits: 16, name: Large, type: uint, formula: raw*1000}
      - {at: 256, bits: 16, name: Plain Count, type: uint}
      - {at: 272, bits: 16, name: Falling Thirds, type: int, formula: "-raw/3"}
      - {at: 288, bits: 16, name: Six Decimals, type: int, formula: raw*0.000001}
      - {at: 304, bits: 16, name: Seventh Decimal, type: uint, formula: raw + 0.0000001}
    derived:
      - {name: Sum, formula: "0.1*Hundredths + 0.2*Sixteenths"}
"""
BY_NUMBER = [
    "Quadratic",
    "Thirds",
    "Fahrenheit",
    "Binary",
    "Hundredths",
    "Sixteenths",
    "Table",
    "Large",
    "Falling Thirds",
    "Six Decimals",
    "Seventh Decimal",
]


@pytest.fixture(scope="module")
def fields(tmp_path_factory) -> dict[str, NodePlace]:
    icd = icd_of(SENSOR, tmp_path_factory.mktemp("sensor"))
    return {field.name: field for field in icd.nodes[0].messages[0].fields}


def float_raw(field: NodePlace, number: float) -> int:
    value = parse_physical(field, repr(number))
    assert isinstance(value, int)
    return value


@pytest.mark.parametrize(
    ("name", "raw", "text"),
    [
        ("Quadratic", 13001, "35.207"),
        ("Quadratic", 0, "-40.2"),
        ("Thirds", 1, "0.3"),
        ("Thirds", 3, "1"),
        ("Thirds", -1, "-0.3"),
        ("Falling Thirds", 1, "-0.3"),
        ("Falling Thirds", 32767, "-10922.3"),
        ("Falling Thirds", -2, "0.7"),
        ("Six Decimals", -32767, "-0.032767"),
        ("Seventh Decimal", 7, "7"),
        ("Fahrenheit", 70, "21.1"),
        ("Binary", 1, "0.00006"),
        ("Binary", 16384, "1"),
        ("Hundredths", -1234, "-12.34"),
        ("Sixteenths", 49, "3.0625"),
        ("Large", 7, "7000"),
        ("Table", 512, "20.5"),
        ("Table", 513, "20.7"),
    ],
)
def test_values_have_the_digits_that_their_resolution_warrants(fields, name, raw, text):
    assert FieldValue(fields[name], raw).text == text


def test_digits_of_the_arithmetic_in_doubles_are_not_shown(fields):
    assert (
        FieldValue(
            fields["Double Float"], float_raw(fields["Double Float"], 30.013888)
        ).text
        == "30.013888"
    )
    assert (
        FieldValue(fields["Single Float"], float_raw(fields["Single Float"], 1)).text
        == "1"
    )
    assert FieldValue(fields["Plain"], float_raw(fields["Plain"], 0.1)).text == "0.1"


@pytest.mark.parametrize("name", ["Double Float", "Plain"])
@pytest.mark.parametrize("number", ["nan", "inf", "-inf"])
def test_numbers_that_are_not_finite_are_shown_as_such(fields, name, number):
    raw = floats.bits_of(float(number), fields[name].bits)
    assert FieldValue(fields[name], raw).text == number


def test_json_has_the_full_precision(fields):
    field = fields["Quadratic"]
    assert FieldValue(field, 13001).to_json()["value"] == codec.physical_double(
        field, 13001
    )


@pytest.mark.parametrize("name", BY_NUMBER)
def test_a_value_that_is_shown_leads_back_to_its_raw_value(fields, name):
    field = fields[name]
    low, high = (
        max(field.raw_min, field.settable_raws[0]),
        min(field.raw_max, field.settable_raws[1]),
    )
    for raw in Random(1).sample(range(low, high + 1), min(500, high - low + 1)):
        assert parse_physical(field, FieldValue(field, raw).text) == raw


def in_page(function: str, argument: object) -> Any:
    """Return the result of a JavaScript function that uses `codec` and `values` of the
    site.
    """
    folder = ROOT / "templates" / "html"
    code = f"""
        const load = (name) => require("node:path").join({json.dumps(str(folder))}, name);
        globalThis.icdgenFrames = require(load("frames.js"));
        const codec = (globalThis.icdgenCodec = require(load("codec.js")));
        const fs = require("node:fs");
        const values = new Function(`${{fs.readFileSync(load("values.js"), "utf8")}}; return icdgenValues;`)();
        return {function}(argument);
    """
    return run_script(code, argument)


def test_the_page_shows_the_same_digits(tmp_path):
    icd = icd_of(SENSOR, tmp_path)
    message, source = icd.nodes[0].messages[0], Random(2)
    frames = [source.randbytes(message.length) for _ in range(300)] + [
        bytes(message.length)
    ]
    expected = []
    for frame in frames:
        raw = codec.decode(icd.nodes[0], message, frame)
        expected.append(
            [
                FieldValue(field, raw[field.name]).text
                for field in message.fields
                if field.has_formula
            ]
        )
    shown = """(([plan, frames]) => frames.map((hex) => codec.decode(plan, Uint8Array.from(Buffer.from(hex, "hex")))
      .map((raw, at) => [plan.fields[at], raw]).filter(([field]) => field.scale || field.curve)
      .map(([field, raw]) => values.physicalText(field, raw))))"""
    on_page = in_page(
        shown, [message_plan(message, icd.nodes[0]), [frame.hex() for frame in frames]]
    )
    spelt = [[_as_python(value) for value in row] for row in on_page]
    assert spelt == [[_as_python(value) for value in row] for row in expected]


def _as_python(text: str) -> str:
    """Return a number of JavaScript in Python's spelling: 1e-7, 12.50."""
    return repr(float(text))


def test_an_exact_fraction_and_its_double_are_shown_alike(fields):
    assert (
        number_text(fields["Thirds"], Fraction(2, 3))
        == number_text(fields["Thirds"], 2 / 3)
        == "0.7"
    )


FORMATS = """\
icdgen: 1
node: {name: charger, title: Charger, byte_order: big, bit_order: msb0}
enums:
  - {name: Mode, members: [{value: 0, name: Idle}, {value: 1, name: Run}]}
messages:
  - name: State
    kind: configuration
    set_id: 1
    get_id: 2
    length: 30
    fields:
      - {at: 0, bits: 16, name: Voltage, type: uint, formula: raw/3, unit: V, display: {decimals: 2}}
      - {at: 16, bits: 12, name: Faults, type: uint, display: hex}
      - {at: 28, bits: 4, name: Outputs, type: uint, display: binary}
      - {at: 32, bits: 32, name: Gain, type: float, display: {digits: 4}}
      - {at: 64, bits: 64, name: Bias, type: float, display: {decimals: 1}}
      - {at: 128, bits: 16, name: Whole, type: int, formula: raw*0.5, display: {decimals: 0}}
      - {at: 144, bits: 8, name: Mode, type: enum, enum: Mode, display: hex}
      - {at: 152, bits: 24, name: Pressure, type: uint, formula: "0.001*raw^2", display: {digits: 3}}
      - {at: 176, bits: 64, name: Mask, type: uint, display: hex}
    derived:
      - {name: Power, formula: Voltage*Gain, display: {decimals: 3}}
"""
EXPECTED = [
    ("Voltage", 65, "21.67"),
    ("Voltage", 3, "1.00"),
    ("Faults", 0x0F1, "0x0F1"),
    ("Outputs", 5, "0b0101"),
    ("Gain", 0.0234567, "0.02346"),
    ("Gain", 123456.0, "123500"),
    ("Bias", -0.04, "0.0"),
    ("Bias", -1.25, "-1.3"),
    ("Whole", 5, "3"),
    ("Whole", -5, "-3"),
    ("Mode", 1, "Run"),
    ("Mode", 200, "unknown 0xC8"),
    ("Pressure", 12345, "152000"),
    ("Mask", 1 << 63, "0x8000000000000000"),
    ("Power", 1.0, "1.000"),
]


@pytest.fixture(scope="module")
def charger(tmp_path_factory):
    return icd_of(FORMATS, tmp_path_factory.mktemp("charger"))


def raw_of(field: NodePlace, number: float) -> int:
    return floats.bits_of(number, field.bits) if field.type == "float" else int(number)


@pytest.mark.parametrize(("name", "number", "text"), EXPECTED)
def test_a_value_is_displayed_in_the_format_that_its_field_states(
    charger, name, number, text
):
    field = next(
        field for field in charger.nodes[0].messages[0].fields if field.name == name
    )
    assert FieldValue(field, raw_of(field, number)).text == text


def test_json_has_the_full_precision_whatever_the_display_format(charger):
    fields = {field.name: field for field in charger.nodes[0].messages[0].fields}
    assert FieldValue(fields["Voltage"], 65).to_json()["physical"] == 65 / 3
    assert FieldValue(fields["Faults"], 0xF1).to_json()["value"] == 0xF1
    assert (
        FieldValue(fields["Bias"], raw_of(fields["Bias"], -0.04)).to_json()["value"]
        == -0.04
    )


@pytest.mark.parametrize(
    ("name", "number"), [("Faults", 0xF1), ("Outputs", 5), ("Mask", 1 << 63)]
)
def test_a_displayed_bit_pattern_can_be_entered_again(charger, name, number):
    field = next(
        field for field in charger.nodes[0].messages[0].fields if field.name == name
    )
    assert parse_physical(field, FieldValue(field, number).text) == number


def test_the_site_displays_values_in_the_format_of_their_fields(charger):
    node = charger.nodes[0]
    plan, fields = message_plan(node.messages[0], node), node.messages[0].fields
    by_name = {field["name"]: field for field in plan["fields"]}
    enums = {enum.name: enum_plan(enum) for enum in node.enums}
    cases = [
        [by_name[field.name], str(raw_of(field, number))]
        for name, number, _ in EXPECTED
        for field in fields
        if field.name == name
    ]
    function = "(([cases, enums]) => cases.map(([field, raw]) => values.shortText(field, BigInt(raw), enums)))"
    shown = in_page(function, [cases, enums])
    expected = [
        text + (" V" if name == "Voltage" else "") for name, _, text in EXPECTED
    ]
    assert shown == [text if text != "unknown 0xC8" else "0xC8?" for text in expected]


def test_show_states_the_display_format_and_its_json_reads_back(charger, tmp_path):
    tree = to_json(charger)
    jsonschema_rs.validator_for(json.loads(SCHEMA.read_text("utf-8"))).validate(tree)
    (message,) = tree["nodes"][0]["messages"]
    assert [field.get("display") for field in message["fields"]][:4] == [
        {"decimals": 2},
        "hex",
        "binary",
        {"digits": 4},
    ]
    assert message["derived"][0]["display"] == {"decimals": 3}
    text = to_text(charger, ["charger", "State"])
    assert "displayed with 2 decimals" in text and "displayed in hexadecimal" in text
    shown = tmp_path / "charger.json"
    shown.write_text(json.dumps(tree), "utf-8")
    fields = shown_input.from_file(shown).icd.nodes[0].messages[0].fields
    assert [field.display for field in fields] == [
        field.display for field in charger.nodes[0].messages[0].fields
    ]


def test_generated_code_does_not_depend_on_the_display_format(charger, tmp_path):
    plain = icd_of(re.sub(r", display: (\{.*?\}|\w+)", "", FORMATS), tmp_path)
    assert "display" not in json.dumps(to_json(plain))
    nodes = [replace(icd.nodes[0], digest="") for icd in (charger, plain)]
    for name in ("c", "python", "rust"):
        files = [
            dict(backends.get(name).files(Icd((node,)), renderer(name)))
            for node in nodes
        ]
        assert files[0] and files[0] == files[1]
