"""Rules about sizes that must agree, and about the keys of assumptions."""

from __future__ import annotations

from itertools import product

import pytest

from icdgen.diagnostics import Place
from icdgen.icd.located import Map
from icdgen.icd.rules.protocol_sizes import numbers, of_one_number
from tests.icd.rules.marked import findings_of, marked_text, reported
from tests.limits import assert_limits


def mapping(**values) -> Map:
    result = Map(Place("demo.yaml", 1, 1))
    result.update(values)
    return result


def test_numbers_are_those_of_all_keys():
    section = mapping(a=1, b=2, c="3")
    assert numbers(section, "a", "b") == (1, 2)
    assert numbers(section, "b") == (2,)
    assert numbers(section, "a", "c") is None
    assert numbers(section, "a", "d") is None
    assert numbers(None, "a") is None


def test_each_number_that_an_earlier_key_has_is_listed():
    section = mapping(a=1, b=2, c=1, d="x", e=2, f=1, g="x")
    rows = [*of_one_number(section, *"abcdefg")]
    assert rows == [("a", "c", 1), ("b", "e", 2), ("a", "f", 1)]


@pytest.mark.parametrize("path", ["link", "uart"])
def test_bytes_of_a_framing_have_one_meaning(path, tmp_path):
    keys = "escape", "start", "end", "data"
    for values in product((0x10, 0x02), (0x02, 0x03), (0x02, 0x03), (0x03, 0x10)):
        escape, start, end, data = values
        pairs = ", ".join(f"{k}: {v}" for k, v in zip(keys, values, strict=True))
        framing = f"framing: {{by: escape, {pairs}}}"
        text = (
            f"protocol: {{link: {{{framing}, header: [{{bits: 8, role: id}}]}}}}\n"
            if path == "link"
            else f"protocol: {{link: {{buses: {{uart: {{{framing}}}}}}}}}\n"
        )
        both = "after the escape byte 0x{:02X} stands for both `{}` and `{}`"
        expected = [(f"{end}", both.format(end, "start", "end"))] * (start == end)
        if data in (start, end):
            first = "start" if data == start else "end"
            expected.append((f"{data}", both.format(data, first, "data")))
        for key, value in (("start", start), ("end", end)):
            if value == escape:
                message = f"the escape byte 0x{value:02X} is also `{key}`"
                expected.append((f"{value}", message))
        assert sorted(reported(tmp_path, text, "ICD096")) == sorted(expected)


def can(keys: str) -> str:
    return f"protocol:\n  link:\n    buses:\n      can:\n        {keys}\n"


@pytest.mark.parametrize(
    "widths", [(28,), (29,), (30,), (10, 19), (10, 18), (5, 8, 8, 9)]
)
def test_the_parts_of_an_identifier_have_29_bits(widths, tmp_path):
    parts = ", ".join(f"{{name: P{n}, bits: {bits}}}" for n, bits in enumerate(widths))
    rows = findings_of(tmp_path, can(f"identifier: [{parts}]"), "ICD097")
    message = f"the parts of the identifier have {sum(widths)} bits in all, not 29"
    expected = [(message, "correct `bits` of a part")] * (sum(widths) != 29)
    assert [(f.message, f.help) for f in rows] == expected


def test_parts_without_a_width_can_have_any_number_of_bits(tmp_path):
    text = can("identifier: [{name: A, bits: 3}, {name: B, bits: x}]")
    assert reported(tmp_path, text, "ICD097") == []


def segments(keys: str, room: int | None = None) -> str:
    most = f"max_data_bytes: {room}\n        " if room else ""
    return can(f"{most}segments: {{{keys}}}")


def test_the_longest_message_has_the_bytes_of_all_packets(tmp_path):
    for size, is_right in ((27, False), (28, True), (29, False)):
        text = segments(
            f"data_bytes: 7, packets_left_byte: 7, max_packets: 4, max_bytes: {size}"
        )
        message = f"`max_bytes` is {size}, but `max_packets` times `data_bytes` is 28"
        expected = [] if is_right else [(f"{size}", message)]
        assert reported(tmp_path, text, "ICD097") == expected
    (finding,) = findings_of(tmp_path, text, "ICD097")
    assert finding.help == "correct `max_bytes`, `max_packets` or `data_bytes`"


def test_the_count_of_packets_is_behind_the_data_and_within_the_packet(tmp_path):
    for data, left, room, message in (
        (5, 4, 7, "byte 4 counts packets, but the data take bytes 0 to 4"),
        (5, 5, 7, ""),
        (5, 6, 7, ""),
        (5, 7, 7, "byte 7 is outside a packet of 7 bytes"),
        (5, 7, 8, ""),
        (5, 7, None, ""),
        (1, 0, None, "byte 0 counts packets, but the data take bytes 0 to 0"),
    ):
        text = segments(f"data_bytes: {data}, packets_left_byte: {left}", room)
        expected = [(f"{left}", message)] * bool(message)
        assert reported(tmp_path, text, "ICD097") == expected


MASK = "{{byte: 0, bytes: {}, {}, type: bytes}}"
LOGS = {
    "telemetry_log": "telemetry_log: {{header: [{}], entry: [{{byte: 0, bytes: 1, name: A, type: uint}}], frames_byte: 9}}",
    "unsolicited_log": "unsolicited_log: {{id: 1, message: [{}], frames_byte: 9}}",
}


@pytest.mark.parametrize("log", LOGS)
@pytest.mark.parametrize(
    "keys", ["name: mask", "name: Mask, role: mask", "name: mask, role: type"]
)
def test_the_mask_of_a_log_has_the_bytes_of_the_log_mask(log, keys, tmp_path):
    def rows(size: int) -> list[tuple[str, str]]:
        other = MASK.format(9, "name: Other, role: id")
        text = "protocol:\n  log_mask: {bytes: 2, frame_bytes: 6}\n"
        text += f"  {LOGS[log].format(f'{other}, {MASK.format(size, keys)}')}\n"
        return reported(tmp_path, text, "ICD097")

    if keys.endswith("type"):
        assert rows(3) == []
        return
    assert_limits(lambda size: not rows(size), least=2, most=2)
    assert rows(1) == [("1", "the mask has 1 byte here, 2 by `log_mask`")]
    assert rows(3) == [("3", "the mask has 3 bytes here, 2 by `log_mask`")]


def test_assumptions_name_keys_of_the_same_mapping(tmp_path):
    text = """\
protocol:
  log_mask: {bytes: 2, frame_bytes: 6, assumptions: {bytes: A., byte: B., assumptions: C.}}
  msdos_time:
    bits: 32
    parts: [{at: 0, bits: 5, name: second}]
    assumptions: {at: A., parts: B.}
messages:
  - {name: A, id: 1, kind: telecommand, length: 0, assumptions: {id: A., repeat: B.}}
  - {name: B, id: 2, kind: telecommand, length: 0, assumptions: {group: A., length: B.}}
"""
    message = "`assumptions` lists `{}`, which is not a key of this mapping"
    rows = findings_of(tmp_path, text, "ICD098")
    assert [(marked_text(text, f), f.message) for f in rows] == [
        (key, message.format(key))
        for key in ("byte", "assumptions", "at", "repeat", "group")
    ]
    help = "write a key whose value is assumed, and why: `reply_timeout_ms: measured`"
    assert {f.help for f in rows} == {help}
