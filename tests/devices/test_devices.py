"""What the format holds of other people's protocols is read as their own libraries read it.

A sample of what `python -m tests.devices` does with all of it.
"""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from tests.devices.__main__ import measure
from tests.devices.protocols import PROTOCOLS

LANGUAGES = ["python", *(["c"] if shutil.which("gcc") else [])]


@pytest.mark.parametrize("name", PROTOCOLS)
def test_values_of_messages_that_are_held_are_those_of_the_library(name: str, tmp_path: Path) -> None:
    row = measure(name, LANGUAGES, tmp_path, frames=6, sample=25, nodes=3)
    assert row.held
    for agreement in row.by_language.values():
        assert agreement.messages == row.held and agreement.values > row.held
        assert agreement.differences == []


def test_a_wrong_definition_is_noticed(tmp_path: Path) -> None:
    from tests.conformance.build import build
    from tests.conformance.driver import Testee
    from tests.conformance.languages import all_languages
    from tests.devices.agree import Agreement, compare
    from tests.devices.held import held

    definitions = next(PROTOCOLS["mavlink"].load())
    definitions.messages = [one for one in definitions.messages if one.name == "ATTITUDE"]
    roll = definitions.messages[0].fields[1]
    roll["byte_order"] = "big"
    node = held(definitions, tmp_path)
    assert node.icd is not None
    agreement = Agreement()
    testee = Testee(build(all_languages()["python"], node.icd, tmp_path / "build"))
    compare(definitions.name, node.messages, testee, 5, 1, agreement)
    testee.close()
    assert {text.split(": ")[1].split(" is ")[0] for text in agreement.differences} == {roll["name"]}
