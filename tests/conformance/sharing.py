"""A Hypothesis strategy for messages that share an id, and that their lengths or
constants tell apart.
"""

from __future__ import annotations

from dataclasses import replace

from hypothesis import strategies as st

WAYS = ("lengths", "constants", "constants", "general")


@st.composite
def sharing(draw, first: dict, names, made, open_end) -> list[dict]:
    """The message, changed where it must be, and one to three more of its id.

    ``made`` draws fields and a length, ``open_end`` of these what is behind them.
    """
    way, others = draw(st.sampled_from(WAYS)), []
    for _ in range(draw(st.integers(1, 3))):
        fields, length = draw(made)
        if draw(st.integers(0, 3)) == 0:
            fields = [*fields, draw(open_end(fields, length))]
        kept = {
            key: first[key]
            for key in ("byte_order", "bit_order", "kind", "id")
            if key in first
        }
        others.append(
            {**names.one("variant"), **kept, "length": length}
            | ({"fields": fields} if fields else {})
        )
        if (
            length > 1
            and not any("up_to" in field for field in fields)
            and draw(st.integers(0, 4)) == 0
        ):
            others[-1]["may_end_early"] = "zeros"
    group = [first, *others]
    for message in group:
        message["shares_id"] = True
    if way == "lengths":
        taken: set[int] = set()
        for message in group:
            _close(message)
            _grow(
                message,
                next(n for n in range(300) if message["length"] + n not in taken),
            )
            taken.add(message["length"])
        return group
    if any("struct" in field for field in first.get("fields", ())):
        way = "constants"  # what stands in structs keeps its constants
    bits = draw(st.integers(2, 20))
    size = (bits + 7) // 8
    values = draw(
        st.lists(
            st.integers(0, (1 << bits) - 1),
            min_size=len(group),
            max_size=len(group),
            unique=True,
        )
    )
    place = {"at": draw(st.integers(0, 8 * size - bits)), "bits": bits}
    kind = draw(st.sampled_from(("uint", "int")))
    for message, value in zip(group, values, strict=True):
        const = value - (value >> bits - 1 << bits) if kind == "int" else value
        taken = {
            part["name"]
            for field in message.get("fields", ())
            for part in (field, *field.get("bitfields", ()))
        }
        selector = {
            **place,
            **replace(names, seen=taken).one("selector"),
            "type": kind,
            "const": const,
        }
        moved = [
            {**field, "at": field["at"] + 8 * size}
            for field in message.get("fields", ())
        ]
        if message is first and way == "general":
            moved = [
                {key: value for key, value in field.items() if key != "const"}
                for field in moved
            ]
            del selector["const"]
        parts = iter(
            [field for field in moved if _is_open(field)]
        )  # open parts are written as they stand
        order = draw(st.permutations([selector, *moved]))
        message["fields"] = [
            next(parts) if _is_open(field) else field for field in order
        ]
        message["length"] += size
    longest = max(message["length"] for message in group)
    for message in group if draw(st.booleans()) else ():
        _grow(message, longest - message["length"])
    return draw(st.permutations(group))


def _close(message: dict) -> None:
    """Takes away what makes its frames differ in length."""
    message.pop("may_end_early", None)
    if "fields" in message:
        message["fields"] = [
            field for field in message["fields"] if not _is_open(field)
        ]
        if not message["fields"]:
            del message["fields"]


def _is_open(field: dict) -> bool:
    """Whether it has a variable length, or is behind such a field."""
    return "up_to" in field or "after" in field


def _grow(message: dict, size: int) -> None:
    """Reserves more bytes at the end, unless that is open."""
    if size and not any("up_to" in field for field in message.get("fields", ())):
        message["reserved"] = message.get("reserved", 0) + size
        message["length"] += size
