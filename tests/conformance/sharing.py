"""A Hypothesis strategy for multiplexed messages, which are distinguished by their
length or by constants.
"""

from __future__ import annotations

from dataclasses import replace

from hypothesis import strategies as st

WAYS = ("lengths", "constants", "constants", "general")


@st.composite
def sharing(draw, first: dict, names, fields_strategy, open_end) -> list[dict]:
    """Draw one to three variants that share the message's id; return them with the
    message, which changes if needed.

    ``fields_strategy`` draws fields and a length, ``open_end`` the variable-length
    field after them.
    """
    way, variants = draw(st.sampled_from(WAYS)), []
    for _ in range(draw(st.integers(1, 3))):
        fields, length = draw(fields_strategy)
        if draw(st.integers(0, 3)) == 0:
            fields = [*fields, draw(open_end(fields, length))]
        kept_keys = {
            key: first[key]
            for key in ("byte_order", "bit_order", "kind", "id")
            if key in first
        }
        variants.append(
            {**names.unique_names("variant"), **kept_keys, "length": length}
            | ({"fields": fields} if fields else {})
        )
        if (
            length > 1
            and not any("up_to" in field for field in fields)
            and draw(st.integers(0, 4)) == 0
        ):
            variants[-1]["may_end_early"] = "zeros"
    group = [first, *variants]
    for message in group:
        message["shares_id"] = True
    if way == "lengths":
        used_lengths: set[int] = set()
        for message in group:
            _close(message)
            _grow(
                message,
                next(
                    n for n in range(300) if message["length"] + n not in used_lengths
                ),
            )
            used_lengths.add(message["length"])
        return group
    if any("struct" in field for field in first.get("fields", ())):
        way = "constants"  # fields of structs keep their constants
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
        used_lengths = {
            part["name"]
            for field in message.get("fields", ())
            for part in (field, *field.get("bitfields", ()))
        }
        selector = {
            **place,
            **replace(names, seen=used_lengths).unique_names("selector"),
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
        # Variable-length fields are written unchanged.
        parts = iter([field for field in moved if _is_open(field)])
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
    """Remove what gives the frames of a message different lengths."""
    message.pop("may_end_early", None)
    if "fields" in message:
        message["fields"] = [
            field for field in message["fields"] if not _is_open(field)
        ]
        if not message["fields"]:
            del message["fields"]


def _is_open(field: dict) -> bool:
    """Return whether a field has a variable length, or follows such a field."""
    return "up_to" in field or "after" in field


def _grow(message: dict, size: int) -> None:
    """Reserve more bytes at the end of a message of fixed length."""
    if size and not any("up_to" in field for field in message.get("fields", ())):
        message["reserved"] = message.get("reserved", 0) + size
        message["length"] += size
