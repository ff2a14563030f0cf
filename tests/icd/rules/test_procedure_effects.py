"""Rules about the effects of procedures on objects of the device."""

from __future__ import annotations

from itertools import product

import pytest

from tests.icd.rules.marked import findings_of, reported

MESSAGES = """\
messages:
  - {name: Next, id: 2, kind: telecommand, length: 0}
  - name: Copy
    id: 1
    kind: telecommand
    length: 2
    fields:
      - {at: 0, bits: 8, name: Number, type: uint}
      - {at: 8, bits: 8, name: Area,   type: uint}
  - name: First
    id: 129
    kind: telemetry
    length: 4
    fields: [{at: 0, bits: 32, name: Size, type: uint}]
  - name: Last
    id: 130
    kind: telemetry
    length: 14
    fields:
      - {at: 0,  bits: 32, name: Longest, type: uint}
      - {at: 32, bits: 33, name: Beyond,  type: uint}
      - {at: 72, bits: 8,  name: Flags,   type: int}
      - {at: 80, bits: 32, name: Volts,   type: float}
"""
EFFECTS = ("list", "read", "write", "erase", "copy", "describe")
SEND = "{send: Copy, with: {Number: number, Area: area}}"
RECEIVE = "{blocks: {size: 4, rounds: 1, steps: [{send: Next}]}}"
UPLOAD = "{blocks: {of: image, size: 4, rounds: 1, steps: [{send: Next}]}}"
LIST = "{repeat: [{get: First, as: first}, {end_if_zeros: first}]}"
INPUTS = "number: {type: uint}, area: {type: uint}, image: {type: bytes, most: 9}"


def procedure(effect: str, *steps: str, name: str = "one") -> str:
    """Return a procedure with an effect and the inputs `number`, `area` and `image`."""
    return (
        f"    {name}:\n      inputs: {{{INPUTS}}}\n"
        "      limits: {time_s: 60, requests: 100}\n"
        f"      effect: {{{effect}}}\n      steps: [{', '.join(steps)}]\n"
    )


def icd(*procedures: str) -> str:
    return f"protocol:\n  procedures:\n{''.join(procedures)}{MESSAGES}"


def faults(folder, effect: str, *steps: str) -> list[tuple[str, str]]:
    """Return (marked text, message) of an effect of a procedure with these steps."""
    return reported(folder, icd(procedure(effect, *steps)), "ICD194")


EVERY = (SEND, UPLOAD, RECEIVE, LIST, "{get: First}")


@pytest.mark.parametrize("verb", EFFECTS)
def test_an_effect_has_the_keys_of_its_verb(verb, tmp_path):
    possible = {
        "list": "fields",
        "describe": "fields",
        "copy": "to",
        "erase": "all_if",
    }.get(verb)
    values = {"all_if": "{number: 1}", "to": "[1]", "fields": "{size: Size}"}
    for key, value in values.items():
        rows = faults(tmp_path, f"{verb}: file, {key}: {value}", *EVERY)
        expected = [(key, f"an effect with `{verb}` has no `{key}`")]
        assert [row for row in rows if "lacks" not in row[1]] == (
            [] if key == possible else expected
        )
    lacks = [(verb, f"an effect with `{verb}` lacks `{possible}`")]
    is_needed = verb in ("list", "describe", "copy")
    assert faults(tmp_path, f"{verb}: file", *EVERY) == lacks * is_needed


def test_an_effect_has_one_verb(tmp_path):
    for verbs, number in (
        ("", 0),
        ("read: file, ", 1),
        ("read: file, erase: file, ", 2),
    ):
        rows = faults(tmp_path, f"key: [number], {verbs}", SEND, RECEIVE)
        text = f"an effect does one thing, and this one does {number}"
        assert rows == [("key", text)] * (number != 1)


@pytest.mark.parametrize("verb", EFFECTS)
def test_the_steps_of_a_procedure_can_have_its_effect(verb, tmp_path):
    needed = {
        "list": (LIST, "`repeat`"),
        "read": (RECEIVE, "`blocks` without `of`"),
        "write": (UPLOAD, "`blocks` with `of`"),
    }
    for steps in product([False, True], repeat=3):
        given = [
            step for step, is_there in zip((LIST, RECEIVE, UPLOAD), steps, strict=True)
            if is_there
        ]  # fmt: skip
        rows = faults(tmp_path, f"{verb}: file", SEND, *given)
        step, words = needed.get(verb, (SEND, ""))
        message = f"a procedure with the effect `{verb}` has a step {words}"
        expected = [(verb, message)] * (step not in (SEND, *given))
        assert [row for row in rows if "lacks" not in row[1]] == expected


def test_numbers_among_the_inputs_identify_an_object(tmp_path):
    effect = "erase: file, key: [number, image, numbr], all_if: {image: 1}"
    text = "there is no input `{}` that is a number"
    rows = faults(tmp_path, effect, SEND, UPLOAD)
    assert rows == [
        ("image", text.format("image")),
        ("numbr", text.format("numbr")),
        ("image", text.format("image")),
    ]
    helps = [
        f.help
        for f in findings_of(tmp_path, icd(procedure(effect, SEND, UPLOAD)), "ICD194")
    ]
    assert helps[1] == "did you mean `number`?"
    assert faults(tmp_path, "erase: file, all_if: {area: 1}", SEND) == []


def test_a_copy_has_as_many_numbers_as_the_original(tmp_path):
    for key, to in product(
        ["[number]", "[number, area]"], ["[1]", "[1, 2]", "[1, 2, 3]"]
    ):
        rows = faults(tmp_path, f"copy: file, key: {key}, to: {to}", SEND)
        text = "`to` and `key` are keys of objects of the same kind"
        assert [message for _, message in rows] == [text] * (
            key.count(",") != to.count(",")
        )
    assert faults(tmp_path, "copy: file, to: [1, 2]", SEND) == []


def test_the_telemetry_that_is_requested_last_describes_an_object(tmp_path):
    """At any depth, by `get` or `poll`."""
    effect = "describe: file, fields: {size: Longest}"
    poll = "{poll: Last, until: {Flags: 1}, every_ms: 1, for_ms: 9}"
    nested = "{blocks: {size: 4, rounds: 1, steps: [{get: First}, {get: Last}]}}"
    wrong = [("Longest", "`First` has no field `Longest`")]
    for steps, expected in (
        (["{get: First}", "{get: Last}"], []),
        (["{get: First}", poll], []),
        (["{get: First}", nested, SEND], []),
        (["{repeat: [{get: Last}]}"], []),
        (["{get: Last}", "{get: First}"], wrong),
        ([nested, "{get: First}"], wrong),
        ([poll, "{get: First}"], wrong),
    ):
        assert faults(tmp_path, effect, *steps) == expected


def test_a_field_that_describes_an_object_is_a_whole_number(tmp_path):
    names = {"Longest": True, "Beyond": False, "Flags": True, "Volts": False}
    for name, is_number in names.items():
        rows = faults(
            tmp_path, f"describe: file, fields: {{time: {name}}}", "{get: Last}"
        )
        text = f"`{name}` is no whole number in at most 4 bytes"
        assert rows == [(name, text)] * (not is_number)


def test_a_list_returns_the_numbers_that_identify_objects_of_its_kind(tmp_path):
    """Those that procedures of the same kind read or write, and its own key."""
    fields = ", ".join(
        f"{name}: Size"
        for name in ("size", "time", "checksum", "number", "area", "image", "nmber")
    )

    def unknown(effect: str, *others: str) -> list[str]:
        procedures = [
            procedure(other, RECEIVE, UPLOAD, SEND, name=f"other{n}")
            for n, other in enumerate(others)
        ]
        listing = procedure(f"{effect}, fields: {{{fields}}}", LIST)
        rows = reported(tmp_path, icd(listing, *procedures), "ICD194")
        assert all(
            message == f"`{name}` is no number of an object" for name, message in rows
        )
        return [name for name, _ in rows]

    always = ["image", "nmber"]
    assert unknown("list: file") == ["number", "area", *always]
    assert unknown("list: file", "read: file, key: [number]") == ["area", *always]
    assert unknown("list: file", "write: file, key: [area]") == ["number", *always]
    both = "read: file, key: [number]", "write: file, key: [area]"
    assert unknown("list: file", *both) == always
    assert unknown("list: other", *both) == ["number", "area", *always]
    assert unknown("list: file", "erase: file, key: [number]") == [
        "number",
        "area",
        *always,
    ]
    assert unknown("list: file, key: [area]") == ["number", *always]


def test_a_misspelt_number_of_an_object_is_corrected(tmp_path):
    text = icd(
        procedure("describe: file, fields: {siez: Size, time: Sise}", "{get: First}")
    )
    rows = findings_of(tmp_path, text, "ICD194")
    assert [f.help for f in rows] == ["did you mean `size`?", "did you mean `Size`?"]


def test_a_description_needs_telemetry(tmp_path):
    rows = faults(tmp_path, "describe: file, fields: {siez: Size}", SEND)
    text = "no step requests telemetry that describes an object"
    assert rows == [("fields", text)]
