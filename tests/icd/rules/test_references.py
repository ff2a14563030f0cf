"""Rules of names of enumerations and units: where they are searched and what counts as
a use.
"""

from __future__ import annotations

import pytest

from tests.icd.files import codes, findings
from tests.icd.rules.reported import messages, reported

NODE = "node: {{name: {}, title: Demo, byte_order: little, bit_order: lsb0}}\n"
MEMBERS = "members: [{value: 0, name: Idle}]"


def node(name: str, content: str = "", include: str = "") -> str:
    head = f"icdgen: 1\ninclude: [{include}]\n" if include else "icdgen: 1\n"
    return f"{head}{NODE.format(name)}{content}"


def files(demo: str, **others: str) -> str:
    return demo + "".join(f"# {name}.yaml\n{text}" for name, text in others.items())


def enums(*names: str) -> str:
    return "enums:\n" + "".join(f"  - {{name: {name}, {MEMBERS}}}\n" for name in names)


def fields(*rows: str) -> str:
    """Return a message with fields of 8 bits, each the end of a flow mapping."""
    lines = "".join(
        f"      - {{at: {8 * n}, bits: 8, name: F{n}, {row}}}\n"
        for n, row in enumerate(rows)
    )
    head = "  - name: Status\n    id: 130\n    kind: telemetry\n"
    return f"messages:\n{head}    length: {len(rows)}\n    fields:\n{lines}"


def enum(name: str) -> str:
    return f"type: enum, enum: {name}"


def test_each_enumeration_without_a_use_is_reported_at_its_name(tmp_path):
    text = enums("Mode", "State", "Cause") + fields(enum("State"))
    assert reported(tmp_path, text, "ICD041") == [
        (line, name, f"no field uses the enumeration `{name}`", "use or remove it")
        for line, name in ((4, "Mode"), (6, "Cause"))
    ]


def test_a_use_in_a_file_that_includes_the_enumeration_counts(tmp_path):
    base = node("base", enums("Mode", "State"))
    user = node("demo", fields(enum("Mode")), "base.yaml")
    assert messages(tmp_path, files(user, base=base), "ICD041") == [
        "no field uses the enumeration `State`"
    ]
    # Without `include`, it is an enumeration of another node.
    other = node("demo", enums("Mode") + fields(enum("Mode")))
    assert len(messages(tmp_path, files(other, base=base), "ICD041")) == 2


@pytest.mark.parametrize(
    ("written", "unused"),
    [("Mod", ["State"]), ("State", ["Mode"]), ("Nothing", ["Mode", "State"])],
)
def test_a_misspelt_name_counts_as_a_use_of_the_similar_enumeration(
    written, unused, tmp_path
):
    """Also in a file that includes it."""
    declared, used = enums("Mode", "State"), fields(enum(written))
    expected = [f"no field uses the enumeration `{name}`" for name in unused]
    assert messages(tmp_path, declared + used, "ICD041") == expected
    text = files(node("demo", used, "base.yaml"), base=node("base", declared))
    assert messages(tmp_path, text, "ICD041") == expected


def test_an_enumeration_that_occurs_twice_is_not_reported_as_unused(tmp_path):
    assert codes(tmp_path, enums("Mode", "Mode")) == ["ICD052"]


def framed(role: str, name: str, content: str = "") -> str:
    header = f"[{{bits: 8, role: id}}, {{bits: 8, role: {role}, enum: {name}}}]"
    return f"protocol: {{link: {{framing: {{by: slip}}, header: {header}}}}}\n{content}"


def test_an_enumeration_of_a_frame_is_used(tmp_path):
    text = framed("status", "Mode", enums("Mode", "State"))
    assert codes(tmp_path, text) == ["ICD041"]
    base = node("base", enums("Mode"))
    text = files(node("demo", framed("status", "Mode"), "base.yaml"), base=base)
    assert codes(tmp_path, text) == []


def test_an_enumeration_of_a_file_that_is_not_included_is_named_with_it(tmp_path):
    base = node("base", enums("Mode") + fields(enum("Mode")))
    for content, line in (
        (fields("type: uint", enum("Mode")), 10),
        (framed("reason", "Mode"), 3),
    ):
        text = files(node("demo", content), base=base)
        (found,) = reported(tmp_path, text, "ICD040")
        help = f"`base` declares it: include {tmp_path / 'base.yaml'}"
        assert found == (line, "Mode", "there is no enumeration `Mode`", help)


def test_the_first_of_several_files_with_an_enumeration_is_named(tmp_path):
    demo = node("demo", fields(enum("Mode")))
    text = files(demo, one=node("one", enums("Mode")), two=node("two", enums("Mode")))
    (found,) = reported(tmp_path, text, "ICD040")
    assert found.help == f"`one` declares it: include {tmp_path / 'one.yaml'}"


def test_a_name_is_compared_with_those_of_the_file_and_its_included_files(tmp_path):
    base = node("base", enums("Modes"))
    for include, help, fix in (
        ("base.yaml", "did you mean `Modes`?", "Modes"),
        ("", "declare it in `enums:`", None),
    ):
        user = node("demo", fields(enum("Mode")), include)
        reported = findings(tmp_path, files(user, base=base))
        (finding,) = (each for each in reported if each.code == "ICD040")
        assert (finding.help, finding.fix and finding.fix.text) == (help, fix)


UNITS = "units: [{symbol: blinks, identifier: blinks, quantity: time}]\n"


def test_a_unit_is_built_in_or_declared_in_an_included_file(tmp_path):
    used = fields("type: uint, unit: blinks", "type: uint, unit: V")
    assert codes(tmp_path, UNITS + used) == []
    base = node("base", UNITS)
    assert codes(tmp_path, files(node("demo", used, "base.yaml"), base=base)) == []
    (found,) = reported(tmp_path, files(node("demo", used), base=base), "ICD042")
    help = "declare it in `units:`; `icdgen units` lists the built-in units"
    assert found == (9, "blinks", "the unit `blinks` is unknown", help)


def test_a_unit_similar_to_a_declared_unit_may_be_another(tmp_path):
    (finding,) = findings(tmp_path, UNITS + fields("type: uint, unit: blink"))
    help = "did you mean `blinks`? If not, declare it in `units:`"
    assert (finding.help, finding.fix.text) == (help, "blinks")


def test_the_unit_of_a_derived_value_exists(tmp_path):
    derived = "    derived: [{name: Sum, formula: F0+F1, unit: Volts}]\n"
    text = fields("type: uint", "type: uint") + derived
    assert [each[:3] for each in reported(tmp_path, text, "ICD042")] == [
        (11, "Volts", "the unit `Volts` is unknown")
    ]
