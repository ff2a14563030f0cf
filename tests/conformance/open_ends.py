"""Hypothesis strategies for the variable-length end of a message."""

from __future__ import annotations

from hypothesis import strategies as st

_PLUS = (0, 0, 0, 1, 2, -1, -4)  # constants added to the value of a counter


@st.composite
def open_end(
    draw,
    place: dict,
    fields: list[dict],
    elements: st.SearchStrategy,
    structs: list[dict],
) -> dict:
    """Draw a variable-length array of elements or structs, or variable-length bytes or
    text.

    Its length comes from a counter field or from the end of the frame. ``place`` is its
    position and its names.
    """
    counters = [field for field in fields if _counts(field)]
    counter = draw(st.sampled_from([None, *counters]))
    if draw(st.integers(0, 3)) == 0:
        kind = draw(st.sampled_from(("bytes", "text")))
        return (
            place
            | {"type": kind}
            | _counted(draw, "size", counter, draw(st.integers(1, 20)))
        )
    if structs and draw(st.booleans()):
        element = {"struct": draw(st.sampled_from(structs))["name"]}
    else:
        element = draw(
            elements.filter(
                lambda element: element["type"] != "bool" and element["bits"] % 8 == 0
            )
        )
    most = draw(st.integers(1, 2 if "struct" in element else 9))
    return place | element | _counted(draw, "count", counter, most)


@st.composite
def open_parts(
    draw,
    place: dict,
    fields: list[dict],
    elements: st.SearchStrategy,
    structs: list[dict],
) -> list[dict]:
    """Draw one or several variable-length fields in a row, of which all but the last
    have counters.

    Fields of fixed size may follow some of them. ``place`` is the position of the first
    one, and its name is the prefix of all names.
    """
    free = [field for field in fields if _counts(field)]
    parts: list[dict] = []
    for number in range(
        0 if draw(st.integers(0, 2)) else min(len(free), draw(st.integers(1, 2)))
    ):
        strategy = open_end(_named(place, number, parts), free, elements, structs)
        part = draw(strategy.filter(lambda part: _counter(part) != "rest"))
        # each counter counts a single field
        free = [field for field in free if field["name"] != _counter(part)]
        parts.append(part)
        parts += draw(fields_behind(place, number, parts, elements, structs))
    end = _named(place, 9, parts) if parts else place
    parts.append(draw(open_end(end, free, elements, structs)))
    return parts + draw(fields_behind(place, 9, parts, elements, structs))


@st.composite
def fields_behind(
    draw,
    place: dict,
    number: int,
    before: list[dict],
    elements: st.SearchStrategy,
    structs: list[dict],
) -> list[dict]:
    """Draw up to a few fields of fixed size after a variable-length field with this
    ``place`` and ``number``. The new names start with its name.
    """
    fields: list[dict] = []
    whole_bytes = elements.filter(
        lambda element: element["bits"] * element.get("count", 1) % 8 == 0
    )
    for index in range(draw(st.sampled_from((0, 0, 1, 1, 2, 3)))):
        at = _named(place, 10 * (number + 1) + index, [*before, *fields])
        if structs and draw(st.integers(0, 2)) == 0:
            count = draw(st.sampled_from(({}, {"count": 1}, {"count": 2})))
            struct = draw(st.sampled_from(structs))["name"]
            fields.append({**at, "struct": struct, **count})
        else:
            fields.append({**at, **draw(whole_bytes)})
    return fields


@st.composite
def nested_end(
    draw,
    length: int,
    names: list[dict],
    struct: dict,
    inner: list[dict],
    elements: st.SearchStrategy,
) -> tuple[list[dict], dict]:
    """Draw counters after ``length`` bytes, an array of structs whose inner arrays one
    of them counts, and the struct.

    ``names`` are for the two counters and the array, ``inner`` for the fields after the
    fields of ``struct``.
    """
    count, inner_count, end = names
    counters = [
        {"at": 8 * (length + index), "bits": 8, "type": "uint", **field}
        for index, field in enumerate((count, inner_count))
    ]
    fields: list[dict] = []
    for name in inner:
        element = draw(
            elements.filter(
                lambda element: (
                    element["type"] != "bool"
                    and element["bits"] % 8 == 0
                    and element["bits"]
                )
            )
        )
        before = {"after": fields[-1]["name"]} if fields else {}
        presence = (
            _counted(draw, "count", counters[1], draw(st.integers(1, 4)))
            if not fields or draw(st.booleans())
            else {}
        )
        fields.append(
            {"at": 8 * struct["length"], **before, **name, **element, **presence}
        )
    part = {
        "at": 8 * (length + 2),
        **end,
        "struct": struct["name"],
        **_counted(draw, "count", counters[0], 2),
    }
    # Several arrays have one counter: there must be a value that all can have.
    lows, highs = zip(
        *(
            (-plus, field["up_to"] - plus)
            for field in fields
            if "up_to" in field
            for plus in [_plus(field)]
        ),
        strict=True,
    )
    if max(0, *lows) > min(highs):
        for field in fields[1:]:
            if "up_to" in field:
                field["count"], field["up_to"] = fields[0]["count"], fields[0]["up_to"]
    return [*counters, part], {**struct, "fields": [*struct["fields"], *fields]}


def _plus(part: dict) -> int:
    """Return the constant that is added to the value of a counter."""
    count = part["count"]
    return count["plus"] if isinstance(count, dict) else 0


def _counter(part: dict) -> str:
    """Return what determines the number of elements: the name of a field, or `rest`."""
    count = part.get("size", part.get("count"))
    return count["field"] if isinstance(count, dict) else count


def _named(place: dict, number: int, before: list[dict]) -> dict:
    """Return the place of another variable-length field. A number makes its name
    unique.
    """
    named = {
        key: f"{value} {number}" if key in ("name", "identifier") else value
        for key, value in place.items()
    }
    return named | ({"after": before[-1]["name"]} if before else {})


def _counted(draw, key: str, counter: dict | None, most: int) -> dict:
    """Return how the number of elements is given, and the largest number that the
    counter can represent.
    """
    if counter is None:
        return {key: "rest", "up_to": most}
    plus = draw(st.sampled_from(_PLUS))
    largest = (1 << counter["bits"]) - 1
    plus = plus if largest + plus > 0 and plus <= most else 0
    count = (
        {"field": counter["name"], "plus": plus}
        if plus or draw(st.integers(0, 5)) == 0
        else counter["name"]
    )
    return {key: count, "up_to": min(most, largest + plus)}


def _counts(field: dict) -> bool:
    """Return whether a field can be a counter."""
    excluded_keys = ("formula", "points", "const", "count", "view", "bitfields")
    return field.get("type") == "uint" and not any(
        key in field for key in excluded_keys
    )
