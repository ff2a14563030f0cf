"""Results of tables are assigned to nodes without a loss: enumerations of one name, and
captions that spell the name of a node in two ways.
"""

from __future__ import annotations

from tests.importer.conftest import imported
from tests.importer.test_text import ENUM, LISTED, MESSAGE, PUMP, read


def enumeration(number: int, *members: str) -> str:
    rows = "".join(f"{value}\t{name}\t\n" for value, name in enumerate(members))
    return (
        f"\nTable {number}: PumpMode Enumeration Values\n\n"
        f"Numeric Value\tName\tDescription\n{rows}"
    )


def test_an_enumeration_that_is_printed_again_is_merged_also_with_a_variant(tmp_path):
    tables = [("Off", "Running"), ("Off", "On"), ("Off", "On")]
    text = "".join(enumeration(8 + i, *members) for i, members in enumerate(tables))
    result, tree = read(tmp_path, MESSAGE + text)
    assert [
        (enum["name"], [member["name"] for member in enum["members"]])
        for enum in tree["enums"]
    ] == [("PumpMode", ["Off", "Running"]), ("PumpMode 2", ["Off", "On"])]
    assert [f.code for f in result.import_findings].count("IMP052") == 1


def test_captions_that_spell_a_node_in_two_ways_name_one_node(tmp_path):
    def listing(number: int, node: str, id: int, name: str) -> str:
        return (
            f"\nTable {number}: List of {node} Telemetry Frames\n\n"
            f"ID\tName\tDescription\tLength (bytes)\n{id}\t{name}\t\t4\n"
        )

    path = tmp_path / "motor.txt"
    path.write_text(
        listing(1, "Motor A", 140, "Pump State")
        + MESSAGE
        + listing(9, "Motor-A", 141, "Pump Speed")
        + MESSAGE.replace("Pump State", "Pump Speed").replace("\t140\t", "\t141\t")
        + ENUM
    )
    rules = tmp_path / "rules.yaml"
    rules.write_text(PUMP.read_text().replace("phrases:", f"{LISTED}phrases:"))
    _, trees = imported(path, rules)
    (tree,) = trees.values()
    assert [m["name"] for m in tree["messages"]] == ["Pump State", "Pump Speed"]
    assert [enum["name"] for enum in tree["enums"]] == ["PumpMode"]
