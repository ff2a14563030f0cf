"""Values are shown with the digits that the resolution of their field warrants, alike on the command line and on the site."""

from __future__ import annotations

import json
import subprocess
from fractions import Fraction
from random import Random

import pytest

from icdgen import codec
from icdgen.backends.html.plan import message_plan
from icdgen.describe.display import number_text
from icdgen.icd.model import Field
from icdgen.values.entry import from_physical
from icdgen.values.frame import Row
from tests.conftest import ROOT
from tests.features.outputs import icd_of
from tests.site.conftest import program

SENSOR = """\
icdgen: 1
node: {name: sensor, title: Sensor, byte_order: big, bit_order: msb0}
messages:
  - name: Values
    id: 1
    kind: telemetry
    length: 34
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
    derived:
      - {name: Sum, formula: "0.1*Hundredths + 0.2*Sixteenths"}
"""
BY_NUMBER = ["Quadratic", "Thirds", "Fahrenheit", "Binary", "Hundredths", "Sixteenths", "Table", "Large"]


@pytest.fixture(scope="module")
def fields(tmp_path_factory) -> dict[str, Field]:
    icd = icd_of(SENSOR, tmp_path_factory.mktemp("sensor"))
    return {field.name: field for field in icd.nodes[0].messages[0].fields}


def float_raw(field: Field, number: float) -> int:
    value = from_physical(field, repr(number))
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
    assert Row(fields[name], raw).text == text


def test_digits_of_the_arithmetic_in_doubles_are_not_shown(fields):
    assert Row(fields["Double Float"], float_raw(fields["Double Float"], 30.013888)).text == "30.013888"
    assert Row(fields["Single Float"], float_raw(fields["Single Float"], 1)).text == "1"
    assert Row(fields["Plain"], float_raw(fields["Plain"], 0.1)).text == "0.1"


def test_json_has_the_full_precision(fields):
    field = fields["Quadratic"]
    assert Row(field, 13001).to_json()["value"] == codec.physical_double(field, 13001)


@pytest.mark.parametrize("name", BY_NUMBER)
def test_a_value_that_is_shown_leads_back_to_its_raw_value(fields, name):
    field = fields[name]
    low, high = max(field.raw_min, field.ends[0]), min(field.raw_max, field.ends[1])
    for raw in Random(1).sample(range(low, high + 1), min(500, high - low + 1)):
        assert from_physical(field, Row(field, raw).text) == raw


def test_the_page_shows_the_same_digits(tmp_path):
    icd = icd_of(SENSOR, tmp_path)
    message, source = icd.nodes[0].messages[0], Random(2)
    frames = [source.randbytes(message.length) for _ in range(300)] + [bytes(message.length)]
    expected = []
    for frame in frames:
        raw = codec.decode(icd.nodes[0], message, frame)
        expected.append([Row(one, raw[one.name]).text for one in message.fields if one.has_formula])
    folder = ROOT / "templates" / "html"
    code = f"""
        const load = (name) => require("node:path").join({json.dumps(str(folder))}, name);
        globalThis.icdgenFrames = require(load("frames.js"));
        const codec = (globalThis.icdgenCodec = require(load("codec.js")));
        const fs = require("node:fs");
        const values = new Function(`${{fs.readFileSync(load("values.js"), "utf8")}}; return icdgenValues;`)();
        const [plan, frames] = JSON.parse(fs.readFileSync(0, "utf8"));
        const shown = (frame) => codec.decode(plan, frame).map((raw, at) => [plan.fields[at], raw])
          .filter(([field]) => field.scale || field.curve).map(([field, raw]) => values.physicalText(field, raw));
        process.stdout.write(JSON.stringify(frames.map((hex) => shown(Uint8Array.from(Buffer.from(hex, "hex"))))));
    """
    given = json.dumps([message_plan(message, icd.nodes[0]), [frame.hex() for frame in frames]])
    done = subprocess.run([program("node"), "-e", code], input=given, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    spelt = [[_as_python(one) for one in row] for row in json.loads(done.stdout)]
    assert spelt == [[_as_python(one) for one in row] for row in expected]


def _as_python(text: str) -> str:
    """Numbers are spelt otherwise in JavaScript: 1e-7, 12.50."""
    return repr(float(text))


def test_an_exact_fraction_and_its_double_are_shown_alike(fields):
    assert number_text(fields["Thirds"], Fraction(2, 3)) == number_text(fields["Thirds"], 2 / 3) == "0.7"
