"""Draws the end of a message of variable length."""

from __future__ import annotations

from hypothesis import strategies as st

_PLUS = (0, 0, 0, 1, 2, -1, -4)  # what is added to what a field says


@st.composite
def open_end(
    draw,
    place: dict,
    fields: list[dict],
    elements: st.SearchStrategy,
    structs: list[dict],
) -> dict:
    """Elements or structs, bytes or text: as many as a field says, or as the frame
    ends.

    ``place``: where, and its names.
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
            elements.filter(lambda one: one["type"] != "bool" and one["bits"] % 8 == 0)
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
    """One, or several behind each other, all but the last counted by fields; and fields
    of fixed size behind some of them.

    ``place``: of the first; its name is that of all.
    """
    free = [one for one in fields if _counts(one)]
    found: list[dict] = []
    for number in range(
        0 if draw(st.integers(0, 2)) else min(len(free), draw(st.integers(1, 2)))
    ):
        one = open_end(_named(place, number, found), free, elements, structs)
        part = draw(one.filter(lambda part: _counter(part) != "rest"))
        # a field counts one part
        free = [one for one in free if one["name"] != _counter(part)]
        found.append(part)
        found += draw(fields_behind(place, number, found, elements, structs))
    end = _named(place, 9, found) if found else place
    found.append(draw(open_end(end, free, elements, structs)))
    return found + draw(fields_behind(place, 9, found, elements, structs))


@st.composite
def fields_behind(
    draw,
    place: dict,
    number: int,
    before: list[dict],
    elements: st.SearchStrategy,
    structs: list[dict],
) -> list[dict]:
    """None, or a few fields of fixed size behind a part.

    ``place`` and ``number``: of the part; their names begin with its name.
    """
    found: list[dict] = []
    whole = elements.filter(lambda one: one["bits"] * one.get("count", 1) % 8 == 0)
    for index in range(draw(st.sampled_from((0, 0, 1, 1, 2, 3)))):
        at = _named(place, 10 * (number + 1) + index, [*before, *found])
        if structs and draw(st.integers(0, 2)) == 0:
            count = draw(st.sampled_from(({}, {"count": 1}, {"count": 2})))
            struct = draw(st.sampled_from(structs))["name"]
            found.append({**at, "struct": struct, **count})
        else:
            found.append({**at, **draw(whole)})
    return found


@st.composite
def nested_end(
    draw,
    length: int,
    names: list[dict],
    struct: dict,
    inner: list[dict],
    elements: st.SearchStrategy,
) -> tuple[list[dict], dict]:
    """Counters behind ``length`` bytes, and an array of structs with arrays that one of
    them counts; and the struct.

    ``names`` are for both counters and the array, ``inner`` for the fields that come
    behind those of ``struct``.
    """
    count, inner_count, end = names
    counters = [
        {"at": 8 * (length + index), "bits": 8, "type": "uint", **one}
        for index, one in enumerate((count, inner_count))
    ]
    fields: list[dict] = []
    for name in inner:
        element = draw(
            elements.filter(
                lambda one: (
                    one["type"] != "bool" and one["bits"] % 8 == 0 and one["bits"]
                )
            )
        )
        before = {"after": fields[-1]["name"]} if fields else {}
        there = (
            _counted(draw, "count", counters[1], draw(st.integers(1, 4)))
            if not fields or draw(st.booleans())
            else {}
        )
        fields.append(
            {"at": 8 * struct["length"], **before, **name, **element, **there}
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
            (-plus, one["up_to"] - plus)
            for one in fields
            if "up_to" in one
            for plus in [_plus(one)]
        ),
        strict=True,
    )
    if max(0, *lows) > min(highs):
        for one in fields[1:]:
            if "up_to" in one:
                one["count"], one["up_to"] = fields[0]["count"], fields[0]["up_to"]
    return [*counters, part], {**struct, "fields": [*struct["fields"], *fields]}


def _plus(part: dict) -> int:
    """What is added to what a counter says."""
    said = part["count"]
    return said["plus"] if isinstance(said, dict) else 0


def _counter(part: dict) -> str:
    """What says how many elements it has: the name of a field, or `rest`."""
    said = part.get("size", part.get("count"))
    return said["field"] if isinstance(said, dict) else said


def _named(place: dict, number: int, before: list[dict]) -> dict:
    """The place of another part; a number makes its name another."""
    named = {
        key: f"{value} {number}" if key in ("name", "identifier") else value
        for key, value in place.items()
    }
    return named | ({"after": before[-1]["name"]} if before else {})


def _counted(draw, key: str, counter: dict | None, most: int) -> dict:
    """What says how many there are, and the most of them, which the counter can say."""
    if counter is None:
        return {key: "rest", "up_to": most}
    plus = draw(st.sampled_from(_PLUS))
    largest = (1 << counter["bits"]) - 1
    plus = plus if largest + plus > 0 and plus <= most else 0
    said = (
        {"field": counter["name"], "plus": plus}
        if plus or draw(st.integers(0, 5)) == 0
        else counter["name"]
    )
    return {key: said, "up_to": min(most, largest + plus)}


def _counts(field: dict) -> bool:
    """Whether a field can say how many elements there are."""
    others = ("formula", "points", "const", "count", "view", "bitfields")
    return field.get("type") == "uint" and not any(key in field for key in others)
