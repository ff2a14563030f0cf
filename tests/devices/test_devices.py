"""Generated code decodes supported messages of other protocols as their libraries do.

This is a sample of the comparison that `python -m tests.devices` makes of all messages.
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
from tests.devices.protocols import PROTOCOLS
from tests.devices.supported import supported_messages

UNREAD = {
    "AID-ALM",
    "CFG-FIXSEED",
    "CFG-TP",
}  # pyubx2 rejects each frame: it takes names for a field, or cannot set them
LANGUAGES = ["python", *(["c"] if shutil.which("gcc") else [])]


@pytest.mark.parametrize("name", PROTOCOLS)
def test_values_of_supported_messages_equal_those_of_the_library(
    name: str, tmp_path: Path
) -> None:
    nodes = (
        1 if name.startswith("mavlink") else 3
    )  # each dialect includes most of the others
    row = measure(name, LANGUAGES, tmp_path, frames=6, sample=8, nodes=nodes)
    assert row.supported
    for agreement in row.by_language.values():
        assert agreement.messages == row.supported and agreement.values > row.supported
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
    assert {
        definition.id for definition in definitions.messages if not definition.cause
    } == CURVES
    agreement = agreement_of(definitions, tmp_path, language)
    assert agreement.messages == len(CURVES) and agreement.values > 10_000
    assert agreement.differences == []
    assert not agreement.unread


@pytest.mark.parametrize("language", LANGUAGES)
def test_sunspec_curves_with_a_fixed_number_of_points_have_the_values_of_the_library(
    language: str, tmp_path: Path
) -> None:
    """The library reads the counts from the registers; the import reads them from the
    edited copy of the model.
    """
    pytest.importorskip("sunspec2")
    models = [
        sunspec.with_fixed_count(tree, "NPt", 4)
        for tree in sunspec.trees()
        if tree["id"] in CURVES
    ]
    definitions = sunspec.imported(models)
    assert {
        definition.id for definition in definitions.messages if not definition.cause
    } == CURVES
    agreement = agreement_of(definitions, tmp_path, language)
    assert agreement.messages == len(CURVES) and agreement.values > 12_000
    assert agreement.differences == []
    assert not agreement.unread


def test_a_wrong_field_of_sunspec_curve_points_is_detected(tmp_path: Path) -> None:
    pytest.importorskip("sunspec2")
    (model,) = (tree for tree in sunspec.trees() if tree["id"] == 707)
    definitions = sunspec.imported([sunspec.with_fixed_count(model, "NPt", 3)])
    assert definitions.tree is not None
    points = next(
        struct
        for struct in definitions.tree["structs"]
        if struct["name"] == "MayTrip Pt"
    )
    voltage, time = points["fields"]
    voltage["at"], time["at"] = time["bits"], 0
    differences = agreement_of(definitions, tmp_path).differences
    names = {text.split(": ")[1].split(" is ")[0] for text in differences}
    assert {name.split(".", 1)[1] for name in names} == {
        f"MayTrip Pt[{number}].{name}" for number in range(3) for name in ("V", "Tms")
    }


def test_a_wrong_definition_is_detected(tmp_path: Path) -> None:
    definitions = next(PROTOCOLS["mavlink"].load())
    definitions.messages = [
        definition
        for definition in definitions.messages
        if definition.name == "ATTITUDE"
    ]
    roll = definitions.messages[0].fields[1]
    roll["byte_order"] = "big"
    differences = agreement_of(definitions, tmp_path).differences
    assert {text.split(": ")[1].split(" is ")[0] for text in differences} == {
        roll["name"]
    }


def test_a_wrong_constant_of_messages_that_share_an_id_is_detected(
    tmp_path: Path,
) -> None:
    definitions = next(PROTOCOLS["ubx"].load())
    definitions.messages = [
        definition
        for definition in definitions.messages
        if definition.name in ("MGA-ACK-DATA0", "MGA-NAK-DATA0")
    ]
    assert [
        (definition.id, definition.fields[0]["const"])
        for definition in definitions.messages
    ] == [
        (0x1360, 1),
        (0x1360, 0),
    ]
    right = agreement_of(definitions, tmp_path / "right")
    assert not right.differences and not right.unread and right.values == 50
    for definition in definitions.messages:
        definition.fields[0]["const"] ^= 1
    assert agreement_of(definitions, tmp_path / "wrong").unread == {
        "MGA-ACK-DATA0",
        "MGA-NAK-DATA0",
    }


def test_a_wrong_condition_is_detected(tmp_path: Path) -> None:
    (definitions,) = can.databases("high_voltage")
    definitions.messages = [
        message
        for message in definitions.messages
        if message.name == "Battery_Module_1"
    ]
    assert definitions.tree is not None
    fields = next(
        message
        for message in definitions.tree["messages"]
        if message["name"] == "Battery_Module_1"
    )["fields"]
    wrong = next(field for field in fields if "when" in field)
    assert not agreement_of(definitions, tmp_path / "right").differences
    ((name, value),) = wrong["when"].items()
    wrong["when"] = {name: [value, value + 1]}
    fields[:] = [field for field in fields if "when" not in field or field is wrong]
    remaining = {field["name"]: field for field in fields}
    definitions.messages[0].fields = [
        field for field in definitions.messages[0].fields if field["name"] in remaining
    ]
    for field in definitions.messages[0].fields:  # by which frames are drawn
        field |= {"when": remaining[field["name"]]["when"]} if "when" in field else {}
    # The library's frames also have the fields that were removed.
    definitions.messages[0].encoded = None
    differences = agreement_of(definitions, tmp_path).differences
    assert {text.split(": ")[1].split(" is ")[0] for text in differences} == {
        wrong["name"]
    }


def test_a_wrong_struct_of_a_variable_length_array_is_detected(tmp_path: Path) -> None:
    definitions = next(PROTOCOLS["sbp"].load())
    definitions.messages = [
        definition
        for definition in definitions.messages
        if definition.name == "MsgSvAzEl"
    ]
    assert agreement_of(definitions, tmp_path / "right").values > 10
    azimuth, elevation = definitions.messages[0].structs[0]["fields"][-2:]
    azimuth["at"], elevation["at"] = elevation["at"], azimuth["at"]
    differences = agreement_of(definitions, tmp_path).differences
    assert {
        text.split(": ")[1].split(" is ")[0].split("].")[1] for text in differences
    } == {
        "az",
        "el",
    }


def agreement_of(
    definitions: Definitions, folder: Path, language: str = "python"
) -> Agreement:
    folder.mkdir(exist_ok=True)
    node = supported_messages(definitions, folder)
    assert node.icd is not None and len(node.messages) == len(definitions.messages)
    agreement = Agreement()
    testee = Testee(build(all_languages()[language], node.icd, folder / "build"))
    compare(definitions.name, node.messages, testee, 5, 1, agreement)
    testee.close()
    return agreement
