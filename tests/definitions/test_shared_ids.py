"""If a definition gives several messages the same id, the ICD marks them as multiplexed
on purpose.
"""

from __future__ import annotations

import yaml

from icdgen.definitions.model import Definitions, Network
from icdgen.definitions.settle import settle
from icdgen.loading import load


def message(
    name: str, id: int, length: int, kind: str = "telemetry", **more: object
) -> dict:
    fields = (
        [{"at": 0, "bits": 8 * length, "name": "Value", "type": "uint"}]
        if length
        else []
    )
    return {
        "name": name,
        "id": id,
        "kind": kind,
        "length": length,
        **more,
        "fields": fields,
    }


def network(*messages: dict) -> Network:
    head = {"byte_order": "big", "bit_order": "msb0", "id_bits": 11}
    return Network("probe", "Probe", head, messages=list(messages))


def sharing(tree: dict) -> list[str]:
    return [message["name"] for message in tree["messages"] if message.get("shares_id")]


def test_messages_of_one_id_and_direction_confirm_it_and_others_do_not(tmp_path):
    definition = network(
        message("Short", 5, 1),
        message("Long", 5, 2),
        message("Order", 5, 1, "telecommand"),
        message("Alone", 6, 1),
    )
    to = Definitions("probe.xml")
    settle(definition, to)
    tree = definition.tree()
    assert sharing(tree) == ["Short", "Long"] and to.import_findings == []
    file = tmp_path / "probe.yaml"
    file.write_text(yaml.safe_dump(tree, sort_keys=False), encoding="utf-8")
    assert load([file]).findings == []


def test_a_message_whose_partner_cannot_be_represented_does_not_confirm_anything():
    definition = network(message("Short", 5, 1), message("Broken", 5, 2, reserved=3))
    to = Definitions("probe.xml")
    settle(definition, to)
    assert (
        sharing(definition.tree()) == [] and "`Broken`" in to.import_findings[0].message
    )
