"""A Hypothesis strategy for composite messages: random ICDs with frames that contain
other messages.
"""

from __future__ import annotations

from hypothesis import strategies as st

from icdgen.icd.wire_ids import number

FREE = 29  # ids below that of the last message, which no other has


@st.composite
def with_composites(draw, trees) -> dict[str, dict]:
    """Add a composite message to some of the ICDs: bytes of its own, then one of the
    ICD's messages.
    """
    icds = draw(trees)
    for tree in icds.values():
        parts = [message for message in tree["messages"] if _can_be_repeated(message)]
        if parts and draw(st.booleans()):
            tree["messages"].append(
                draw(
                    _whole(
                        draw(st.sampled_from(parts)),
                        number(tree["messages"][-1]["id"]) - FREE,
                    )
                )
            )
    return icds


def _can_be_repeated(message: dict) -> bool:
    fields = message.get("fields", ())
    return (
        bool(fields)
        and "may_end_early" not in message
        and not any("when" in field or "up_to" in field for field in fields)
    )


@st.composite
def _whole(draw, part: dict, id: int) -> dict:
    before = draw(st.integers(0, 3))
    own = (
        [
            {
                "at": 0,
                "bits": 8 * before,
                "name": "Own",
                "identifier": "own bytes",
                "type": "bytes",
            }
        ]
        if before
        else []
    )
    copied = {
        key: part[key] for key in ("byte_order", "bit_order", "reserved") if key in part
    }
    return {
        "name": f"Whole of {id}",
        "identifier": f"whole {id}",
        "kind": "telemetry",
        "id": id,
        "length": part["length"] + before,
        **copied,
        "contains": [{"message": part["name"], "at": 8 * before}],
        "fields": [
            *own,
            *({**field, "at": field["at"] + 8 * before} for field in part["fields"]),
        ],
    }
