"""What the format holds of other people's protocols is read as their own libraries read
it.

A sample of what `python -m tests.devices` does with all of it.
"""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from tests.conformance.build import build
from tests.conformance.driver import Testee
from tests.conformance.languages import all_languages
from tests.devices import can, sunspec
from tests.devices.__main__ import measure
from tests.devices.agree import Agreement, compare
from tests.devices.definition import Definitions
from tests.devices.held import held
from tests.devices.protocols import PROTOCOLS

UNREAD = {
    "AID-ALM",
    "CFG-FIXSEED",
    "CFG-TP",
}  # pyubx2 refuses each frame: names that it takes for a field, or cannot set
LANGUAGES = ["python", *(["c"] if shutil.which("gcc") else [])]


@pytest.mark.parametrize("name", PROTOCOLS)
def test_values_of_messages_that_are_held_are_those_of_the_library(
    name: str, tmp_path: Path
) -> None:
    nodes = (
        1 if name.startswith("mavlink") else 3
    )  # each dialect includes most of the others
    row = measure(name, LANGUAGES, tmp_path, frames=6, sample=12, nodes=nodes)
    assert row.held
    for agreement in row.by_language.values():
        assert agreement.messages == row.held and agreement.values > row.held
        assert agreement.differences == []
        assert agreement.unread <= UNREAD


CURVES = {705, 706, 707, 708, 709, 710, 712, 64410, 64411}
"""Models of SunSpec with a variable number of points in each of a variable number of
curves.
"""


@pytest.mark.parametrize("language", LANGUAGES)
def test_sunspec_curves_have_the_values_of_the_library_for_any_number_of_points(
    language: str, tmp_path: Path
) -> None:
    pytest.importorskip("sunspec2")
    definitions = sunspec.imported(
        [tree for tree in sunspec.trees() if tree["id"] in CURVES]
    )
    assert {one.id for one in definitions.messages if not one.cause} == CURVES
    agreement = agreed(definitions, tmp_path, language)
    assert agreement.messages == len(CURVES) and agreement.values > 10_000
    assert agreement.differences == []
    assert not agreement.unread


@pytest.mark.parametrize("language", LANGUAGES)
def test_sunspec_curves_with_a_fixed_number_of_points_have_the_values_of_the_library(
    language: str, tmp_path: Path
) -> None:
    """The library reads the counts from the registers; the import has them from the
    edited copy of the model.
    """
    pytest.importorskip("sunspec2")
    models = [
        sunspec.with_fixed_count(tree, "NPt", 4)
        for tree in sunspec.trees()
        if tree["id"] in CURVES
    ]
    definitions = sunspec.imported(models)
    assert {one.id for one in definitions.messages if not one.cause} == CURVES
    agreement = agreed(definitions, tmp_path, language)
    assert agreement.messages == len(CURVES) and agreement.values > 12_000
    assert agreement.differences == []
    assert not agreement.unread


def test_a_wrong_field_of_sunspec_curve_points_is_noticed(tmp_path: Path) -> None:
    pytest.importorskip("sunspec2")
    (model,) = (tree for tree in sunspec.trees() if tree["id"] == 707)
    definitions = sunspec.imported([sunspec.with_fixed_count(model, "NPt", 3)])
    assert definitions.tree is not None
    points = next(
        one for one in definitions.tree["structs"] if one["name"] == "MayTrip Pt"
    )
    voltage, time = points["fields"]
    voltage["at"], time["at"] = time["bits"], 0
    found = agreed(definitions, tmp_path).differences
    names = {text.split(": ")[1].split(" is ")[0] for text in found}
    assert {name.split(".", 1)[1] for name in names} == {
        f"MayTrip Pt[{number}].{name}" for number in range(3) for name in ("V", "Tms")
    }


def test_a_wrong_definition_is_noticed(tmp_path: Path) -> None:
    definitions = next(PROTOCOLS["mavlink"].load())
    definitions.messages = [
        one for one in definitions.messages if one.name == "ATTITUDE"
    ]
    roll = definitions.messages[0].fields[1]
    roll["byte_order"] = "big"
    found = agreed(definitions, tmp_path).differences
    assert {text.split(": ")[1].split(" is ")[0] for text in found} == {roll["name"]}


def test_a_wrong_constant_of_messages_that_share_an_id_is_noticed(
    tmp_path: Path,
) -> None:
    definitions = next(PROTOCOLS["ubx"].load())
    definitions.messages = [
        one
        for one in definitions.messages
        if one.name in ("MGA-ACK-DATA0", "MGA-NAK-DATA0")
    ]
    assert [(one.id, one.fields[0]["const"]) for one in definitions.messages] == [
        (0x1360, 1),
        (0x1360, 0),
    ]
    right = agreed(definitions, tmp_path / "right")
    assert not right.differences and not right.unread and right.values == 50
    for one in definitions.messages:
        one.fields[0]["const"] ^= 1
    assert agreed(definitions, tmp_path / "wrong").unread == {
        "MGA-ACK-DATA0",
        "MGA-NAK-DATA0",
    }


def test_a_wrong_condition_is_noticed(tmp_path: Path) -> None:
    (definitions,) = can.databases("high_voltage")
    definitions.messages = [
        one for one in definitions.messages if one.name == "Battery_Module_1"
    ]
    assert definitions.tree is not None
    fields = next(
        one for one in definitions.tree["messages"] if one["name"] == "Battery_Module_1"
    )["fields"]
    wrong = next(field for field in fields if "when" in field)
    assert not agreed(definitions, tmp_path / "right").differences
    ((name, value),) = wrong["when"].items()
    wrong["when"] = {name: [value, value + 1]}
    fields[:] = [one for one in fields if "when" not in one or one is wrong]
    kept = {one["name"]: one for one in fields}
    definitions.messages[0].fields = [
        one for one in definitions.messages[0].fields if one["name"] in kept
    ]
    for one in definitions.messages[0].fields:  # by which frames are drawn
        one |= {"when": kept[one["name"]]["when"]} if "when" in one else {}
    definitions.messages[0].encoded = None  # the library's frames have the others, too
    found = agreed(definitions, tmp_path).differences
    assert {text.split(": ")[1].split(" is ")[0] for text in found} == {wrong["name"]}


def test_a_wrong_struct_of_an_open_end_is_noticed(tmp_path: Path) -> None:
    definitions = next(PROTOCOLS["sbp"].load())
    definitions.messages = [
        one for one in definitions.messages if one.name == "MsgSvAzEl"
    ]
    assert agreed(definitions, tmp_path / "right").values > 10
    azimuth, elevation = definitions.messages[0].structs[0]["fields"][-2:]
    azimuth["at"], elevation["at"] = elevation["at"], azimuth["at"]
    found = agreed(definitions, tmp_path).differences
    assert {text.split(": ")[1].split(" is ")[0].split("].")[1] for text in found} == {
        "az",
        "el",
    }


def agreed(
    definitions: Definitions, folder: Path, language: str = "python"
) -> Agreement:
    folder.mkdir(exist_ok=True)
    node = held(definitions, folder)
    assert node.icd is not None and len(node.messages) == len(definitions.messages)
    agreement = Agreement()
    testee = Testee(build(all_languages()[language], node.icd, folder / "build"))
    compare(definitions.name, node.messages, testee, 5, 1, agreement)
    testee.close()
    return agreement
