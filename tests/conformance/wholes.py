"""A Hypothesis strategy for frames that repeat others: random ICDs with composites."""

from __future__ import annotations

from hypothesis import strategies as st

from icdgen.icd.wire_ids import number

FREE = 29  # ids below that of the last message, which no other has


@st.composite
def with_wholes(draw, trees) -> dict[str, dict]:
    """The ICDs, some with a frame that repeats one of theirs behind bytes of its own."""
    found = draw(trees)
    for tree in found.values():
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
    return found


def _can_be_repeated(message: dict) -> bool:
    fields = message.get("fields", ())
    return (
        bool(fields)
        and "may_end_early" not in message
        and not any("when" in one or "up_to" in one for one in fields)
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
