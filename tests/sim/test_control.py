"""Values, waves, scripts and orders of the simulator, by the values that the device then
has and the packets that it sends.
"""

from __future__ import annotations

import math
from random import Random

import pytest

from icdgen.errors import UserError
from icdgen.loading import load
from icdgen.sim import control, run
from icdgen.sim.control import value_of_wave
from icdgen.sim.values import allowed_values
from tests.limits import assert_limits

ICD = """\
icdgen: 1
node: {name: pump, title: Pump, byte_order: little, bit_order: lsb0}
protocol:
  link:
    framing: {by: slip}
    header: [{bits: 8, role: id}]
enums:
  - {name: Mode, members: [{value: 2, name: Idle}, {value: 5, name: Run}]}
messages:
  - name: State
    id: 1
    kind: telemetry
    length: 8
    fields:
      - {at: 0, bits: 16, name: Speed, type: int, formula: raw*0.5, unit: rpm}
      - {at: 16, bits: 8, name: Mode, type: enum, enum: Mode}
      - {at: 24, bits: 8, name: Level, type: uint}
      - {at: 32, bits: 32, name: Heat, type: float}
  - name: Limited
    id: 2
    kind: telemetry
    length: 8
    fields:
      - {at: 0, bits: 8, name: Least, type: uint, min: 7}
      - {at: 8, bits: 8, name: Above, type: uint, above: 7}
      - {at: 16, bits: 8, name: Most, type: int, max: -7}
      - {at: 24, bits: 8, name: Below, type: int, below: -7, formula: raw*0.5}
      - {at: 32, bits: 32, name: Warmth, type: float, above: 7}
"""


@pytest.fixture(scope="module")
def icd(tmp_path_factory):
    path = tmp_path_factory.mktemp("icd") / "pump.yaml"
    path.write_text(ICD)
    loaded = load([path])
    assert [finding.message for finding in loaded.findings] == []
    return loaded.icd


class Device:
    """A simulated device in this process, and its control."""

    def __init__(self, icd) -> None:
        self.line, self.control = run.build_device(icd, "pump", run.Options(every=0))
        (self.message, _) = icd.nodes[0].messages

    def value(self, name: str) -> object:
        return self.line.computer.program.values.raw(self.message)[name]


@pytest.fixture
def device(icd):
    return Device(icd)


def test_a_message_has_values_that_its_limits_allow(icd):
    state, limited = icd.nodes[0].messages
    assert allowed_values(icd, state) == {"Speed": 0, "Mode": 2, "Level": 0, "Heat": 0}
    values = allowed_values(icd, limited)
    eight = 0x41000000  # 8.0 of IEEE 754
    assert values == {"Least": 7, "Above": 8, "Most": -7, "Below": -15, "Warmth": eight}


def test_an_order_sets_fields(device):
    order = "set State speed=12.5 mode=Run Level=3"
    assert device.control.execute(0, order) == "ok"
    values = [device.value(name) for name in ("Speed", "Mode", "Level")]
    assert values == [25, 5, 3]


@pytest.mark.parametrize(
    "order",
    [
        "set State",
        "set",
        "log now",
        "restart now",
        "stop",
        "set State speed",
        "fault x",
    ],
)
def test_a_wrong_order_is_refused(device, order):
    with pytest.raises(UserError):
        device.control.execute(0, order)


def test_an_order_without_words_does_nothing(device):
    assert device.control.execute(0, "  ") == ""


def test_a_set_value_has_the_range_of_its_bits(device):
    def is_accepted(number: int) -> bool:
        try:
            device.control.execute(0, f"set State level={number}")
        except UserError:
            return False
        return device.value("Level") == number

    assert_limits(is_accepted, least=0, most=255)


def test_an_order_replaces_all_faults(device):
    faults = device.line.faults
    device.control.execute(0, "fault drop=10% corrupt=1@telemetry")
    assert [fault.kind for fault in faults.faults] == ["drop", "corrupt"]
    device.control.execute(0, "fault cut=1")
    assert [fault.kind for fault in faults.faults] == ["cut"]
    device.control.execute(0, "fault")
    assert faults.faults == []


def test_steps_of_a_script_are_executed_in_their_order_when_they_are_due(icd, tmp_path):
    path = tmp_path / "script.yaml"
    path.write_text(
        "- {at: 2.5, set: {State: {Level: 2}}}\n"
        "- {at: 1, set: {State: {Level: 1}}, faults: [drop=1]}\n"
        "- {at: 4, set: {State: {Level: 4}}, faults: []}\n"
    )
    empty = Device(icd)
    steps = control.read_script(path, icd, icd.nodes[0], empty.line)
    device = control.Control(icd, icd.nodes[0], empty.line, steps)
    seen = []
    for now in (0, 999, 1000, 2499, 2500, 9000):
        device.tick(now)
        faults = [fault.kind for fault in empty.line.faults.faults]
        seen.append((now, empty.value("Level"), faults, device.deadline))
    assert seen == [
        (0, 0, [], 1000),
        (999, 0, [], 1000),
        (1000, 1, ["drop"], 2500),
        (2499, 1, ["drop"], 2500),
        (2500, 2, ["drop"], 4000),
        (9000, 4, [], None),
    ]


def test_a_wave_moves_a_field_until_it_is_set(device):
    device.control.set(
        "State", "Speed", {"wave": "ramp", "min": 0, "max": 100, "period": 10}
    )
    device.control.set(
        "State", "Level", {"wave": "steps", "min": 3, "max": 9, "period": 2}
    )
    seen = []
    for now in (0, 1000, 2500, 9990, 10_000):
        device.control.tick(now)
        seen.append((device.value("Speed"), device.value("Level")))
    assert seen == [(0, 3), (20, 9), (50, 3), (200, 9), (0, 3)]
    device.control.execute(10_000, "set State speed=7")
    device.control.tick(12_500)
    assert (device.value("Speed"), device.value("Level")) == (14, 3)
    device.control.tick(13_000)
    assert device.value("Level") == 9, "the other wave goes on"


def test_a_wave_stays_within_the_range_of_its_field(device):
    device.control.set("State", "Level", {"wave": "ramp", "min": -500, "max": 500})
    seen = []
    for now in (0, 30_000, 45_000, 59_999):
        device.control.tick(now)
        seen.append(device.value("Level"))
    assert seen == [0, 0, 250, 255]


@pytest.mark.parametrize(
    ("wave", "values"),
    [
        ({}, [0, 1, 0, -1]),
        ({"wave": "sine", "min": 10, "max": 30}, [20, 30, 20, 10]),
        ({"wave": "ramp", "min": 10, "max": 30}, [10, 15, 20, 25]),
        ({"wave": "steps", "min": 10, "max": 30}, [10, 10, 30, 30]),
    ],
)
def test_a_wave_has_its_shape_within_each_period(wave, values):
    for period in (60, 8):
        keys = wave if period == 60 else wave | {"period": period}
        for begin in (0, 5 * period):
            seen = [
                value_of_wave(keys, begin + period * part / 4, math.nan)
                for part in range(4)
            ]
            assert seen == pytest.approx(values)


def test_noise_fills_its_range():
    wave, random = {"wave": "noise", "min": 10, "max": 30}, Random(1).random
    values = [value_of_wave(wave, 0, random) for _ in range(1000)]
    assert 10 <= min(values) < 11 and 29 < max(values) <= 30
