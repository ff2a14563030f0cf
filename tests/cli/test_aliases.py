"""Aliases: other names by which users find messages, fields and enumerations."""

from __future__ import annotations

import json

import pytest

LANGUAGES = ("--lang", "c", "--lang", "python", "--lang", "rust", "--lang", "vectors")
POWER = """\
icdgen: 1
node: {name: power, title: Power, byte_order: little, bit_order: lsb0}
enums:
  - name: Mode
    aliases: [Operating State]
    members:
      - {value: 0, name: Idle}
      - {value: 1, name: Run, aliases: [Nominal]}
structs:
  - name: Cell
    length: 2
    fields:
      - {at: 0, bits: 16, name: U, aliases: [Cell Voltage], type: uint, unit: mV}
messages:
  - name: Housekeeping
    aliases: [Beacon, Power Status]
    id: 130
    kind: telemetry
    length: 7
    fields:
      - {at: 0, bits: 16, name: V Bat, aliases: [Battery Voltage], type: uint, unit: mV}
      - {at: 16, bits: 8, name: Mode, type: enum, enum: Mode}
      - {at: 24, name: Cells, struct: Cell, count: 2}
    derived:
      - {name: Volts, aliases: [Bus Voltage], unit: V, formula: V Bat*0.001}
  - name: Set Levels
    aliases: [Configure]
    id: 20
    kind: telecommand
    length: 3
    fields:
      - {at: 0, bits: 8, count: 2, name: Levels, aliases: [Thresholds], type: uint}
      - {at: 16, bits: 8, name: Delay, aliases: [Hold-off Time], type: uint, unit: s}
"""


@pytest.fixture
def power(tmp_path):
    (tmp_path / "power.yaml").write_text(POWER)
    return tmp_path / "power.yaml"


@pytest.mark.parametrize(
    "name",
    [
        "Beacon",
        "beacon",
        "POWER_STATUS",
        "PowerStatus",
        "Operating State",
        "Housekeeping",
    ],
)
def test_show_finds_by_an_alias_and_prints_it(icdgen, power, name):
    result = icdgen("show", "--icd", power, "power", name)
    assert result.status == 0, result.err
    assert "Also called Operating State." in result.out
    if name != "Operating State":
        assert (
            "Housekeeping" in result.out
            and "Also called Beacon, Power Status." in result.out
        )
        assert (
            "also called Battery Voltage" in result.out
            and "also called Bus Voltage" in result.out
        )


def test_decode_finds_a_message_by_an_alias_and_prints_its_name(icdgen, power):
    result = icdgen(
        "decode",
        "--icd",
        power,
        "--format",
        "json",
        "power",
        "beacon",
        "E8 03 01 01 00 02 00",
    )
    assert result.status == 0, result.err
    assert json.loads(result.out)["message"] == "Housekeeping"


@pytest.mark.parametrize("key", ["hold-off time", "HoldOffTime", "delay"])
def test_encode_finds_message_field_and_array_by_aliases(icdgen, power, key):
    result = icdgen(
        "encode",
        "--icd",
        power,
        "configure",
        f"{key}=5",
        "thresholds[1]=7",
        "Levels[0]=6",
    )
    assert result.status == 0, result.err
    assert "06 07 05" in result.out
    assert (
        icdgen(
            "encode", "--icd", power, "configure", "thresholds=[6, 7]", "delay=5"
        ).out
        == result.out
    )


def test_a_field_of_an_array_of_structs_has_its_alias_with_the_path(icdgen, power):
    values = ("battery voltage=0", "mode=nominal")
    result = icdgen(
        "encode",
        "--icd",
        power,
        "beacon",
        *values,
        "Cells[1].Cell Voltage=513",
        "cells[0].u=1",
    )
    assert result.status == 0, result.err
    assert "00 00 01 01 00 01 02" in result.out


def test_a_misspelt_alias_suggests_the_real_name(icdgen, power):
    assert (
        "did you mean `Housekeeping`?"
        in icdgen("show", "--icd", power, "power", "Beacom").err
    )
    assert (
        "did you mean `Delay`?"
        in icdgen("encode", "--icd", power, "configure", "hold-off tine=1").err
    )


def test_a_name_comes_before_an_alias_of_the_same_words_in_another_message(
    icdgen, power
):
    """`Battery Voltage` as an alias in one message does not hide a field with that name
    in another.
    """
    text = POWER.replace(
        "name: Delay, aliases: [Hold-off Time]", "name: Battery Voltage"
    )
    power.write_text(text)
    assert icdgen("check", power).status == 0
    assert (
        "00 00 05"
        in icdgen(
            "encode", "--icd", power, "configure", "battery voltage=5", "levels=[0, 0]"
        ).out
    )


def test_the_machine_readable_form_has_aliases_and_can_be_compared_with_the_file(
    icdgen, power, tmp_path
):
    shown = icdgen("show", "--icd", power, "--format", "json").out
    node = json.loads(shown)["nodes"][0]
    housekeeping, levels = node["messages"]
    assert housekeeping["aliases"] == ["Beacon", "Power Status"]
    assert [field.get("aliases") for field in levels["fields"]] == [
        ["Thresholds"],
        ["Hold-off Time"],
    ]
    assert node["enums"][0]["aliases"] == ["Operating State"]
    assert node["enums"][0]["members"][1]["aliases"] == ["Nominal"]
    assert housekeeping["derived"][0]["aliases"] == ["Bus Voltage"]
    assert node["structs"][0]["fields"][0]["aliases"] == ["Cell Voltage"]
    (tmp_path / "shown.json").write_text(shown)
    report = json.loads(
        icdgen("diff", "--format", "json", tmp_path / "shown.json", power).out
    )
    assert report["changes"] == []


def test_the_diff_reports_a_changed_alias_as_a_text_change(icdgen, power, tmp_path):
    other = tmp_path / "new" / "power.yaml"
    other.parent.mkdir()
    other.write_text(
        POWER.replace("[Battery Voltage]", "[Voltage of the Battery]").replace(
            "[Configure]", "[Set Up]"
        )
    )
    changes = json.loads(icdgen("diff", "--format", "json", power, other).out)[
        "changes"
    ]
    assert [(change["code"], change["layer"]) for change in changes] == [
        ("DIF401", "text")
    ] * 2


def test_generated_code_does_not_depend_on_aliases(icdgen, power, tmp_path):
    """Only the digest of the ICD differs. It identifies the file from which the code
    was generated.
    """

    def generated(name: str, text: str) -> dict[str, list[str]]:
        folder = tmp_path / name
        folder.mkdir()
        (folder / "power.yaml").write_text(text)
        result = icdgen(
            "generate", *LANGUAGES, "--out", folder / "out", folder / "power.yaml"
        )
        assert result.status == 0, result.err
        digest = json.loads(
            icdgen("show", "--icd", folder / "power.yaml", "--format", "json").out
        )["nodes"][0]["digest"]
        files = (
            file
            for file in (folder / "out").rglob("*")
            if file.is_file() and not file.name.startswith(".")
        )
        texts = {
            str(file.relative_to(folder / "out")): file.read_text("utf-8")
            for file in files
        }
        assert len(texts) > 5
        return {
            file: text.replace(digest, "").replace(digest[:16], "")
            for file, text in texts.items()
        }

    plain = "\n".join(
        line for line in POWER.splitlines() if not line.startswith("    aliases:")
    )
    for alias in (
        "Cell Voltage",
        "Battery Voltage",
        "Bus Voltage",
        "Thresholds",
        "Hold-off Time",
        "Nominal",
    ):
        plain = plain.replace(f" aliases: [{alias}],", "").replace(
            f", aliases: [{alias}]", ""
        )
    assert "aliases" not in plain
    assert generated("with", POWER) == generated("without", plain)
