"""The schema only accepts numbers in the protocol section that generated code can
represent.
"""

from __future__ import annotations

import json
from collections.abc import Iterator

from icdgen.icd import schema

# Rules limit these numbers, because most depend on others, or no generated code has them.
HELD_ELSEWHERE = {
    *(
        f"link/checksums/additionalProperties/{key}"
        for key in (
            "polynomial",
            "init",
            "xor_out",
            "empty",
            "check",
            "printed_constant",
        )
    ),
    "link/buses/can/segments/packets_left_in_last",
    "link/buses/can/segments/max_packets",
    "boot/attempts",
}


def integers_of_schema(
    node: dict, path: tuple[str, ...] = ()
) -> Iterator[tuple[str, dict]]:
    """Yield every integer of a part of the schema with its path."""
    if node.get("type") == "integer":
        yield "/".join(path), node
    for key, value in node.items():
        if isinstance(value, dict):
            yield from integers_of_schema(
                value, path if key == "properties" else (*path, key)
            )


NUMBERS = dict(
    integers_of_schema(
        json.loads(schema.PATH.read_text(encoding="utf-8"))["$defs"]["protocol"]
    )
)


def test_every_number_of_the_protocol_has_a_largest_value():
    assert {
        path for path, number in NUMBERS.items() if "maximum" not in number
    } == HELD_ELSEWHERE


def test_times_can_be_compared_by_the_sign_of_their_difference():
    times = {
        path: number["maximum"]
        for path, number in NUMBERS.items()
        if path.endswith("_ms")
    }
    assert times
    assert set(times.values()) == {2**31 - 1}
    seconds = {
        number["maximum"]
        for path, number in NUMBERS.items()
        if path.endswith(("_s", "/seconds"))
    }
    assert seconds == {(2**31 - 1) // 1000}
