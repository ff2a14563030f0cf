"""Draws the end of a message of variable length."""

from __future__ import annotations

from hypothesis import strategies as st

_PLUS = (0, 0, 0, 1, 2, -1, -4)  # what is added to what a field says


@st.composite
def open_end(draw, place: dict, fields: list[dict], elements: st.SearchStrategy, structs: list[dict]) -> dict:
    """Elements or structs, bytes or text: as many as a field says, or as the frame ends. ``place``: where, and its names."""
    counters = [field for field in fields if _counts(field)]
    counter = draw(st.sampled_from([None, *counters]))
    if draw(st.integers(0, 3)) == 0:
        kind = draw(st.sampled_from(("bytes", "text")))
        return place | {"type": kind} | _counted(draw, "size", counter, draw(st.integers(1, 20)))
    if structs and draw(st.booleans()):
        element = {"struct": draw(st.sampled_from(structs))["name"]}
    else:
        element = draw(elements.filter(lambda one: one["type"] != "bool" and one["bits"] % 8 == 0))
    most = draw(st.integers(1, 2 if "struct" in element else 9))
    return place | element | _counted(draw, "count", counter, most)


@st.composite
def open_parts(draw, place: dict, fields: list[dict], elements: st.SearchStrategy, structs: list[dict]) -> list[dict]:
    """One, or several behind each other, all but the last counted by fields. ``place``: of the first; its name is that of all."""
    if not any(map(_counts, fields)) or draw(st.integers(0, 2)):
        return [draw(open_end(place, fields, elements, structs))]
    found: list[dict] = []
    for number in range(draw(st.integers(1, 2))):
        one = open_end(_named(place, number, found), [one for one in fields if _counts(one)], elements, structs)
        found.append(draw(one.filter(lambda part: "rest" not in (part.get("count"), part.get("size")))))
    return [*found, draw(open_end(_named(place, 9, found), fields, elements, structs))]


def _named(place: dict, number: int, before: list[dict]) -> dict:
    """The place of another part; a number makes its name another."""
    named = {key: f"{value} {number}" if key in ("name", "identifier") else value for key, value in place.items()}
    return named | ({"after": before[-1]["name"]} if before else {})


def _counted(draw, key: str, counter: dict | None, most: int) -> dict:
    """What says how many there are, and the most of them, which the counter can say."""
    if counter is None:
        return {key: "rest", "up_to": most}
    plus = draw(st.sampled_from(_PLUS))
    largest = (1 << counter["bits"]) - 1
    plus = plus if largest + plus > 0 and plus <= most else 0
    said = {"field": counter["name"], "plus": plus} if plus or draw(st.integers(0, 5)) == 0 else counter["name"]
    return {key: said, "up_to": min(most, largest + plus)}


def _counts(field: dict) -> bool:
    """Whether a field can say how many elements there are."""
    others = ("formula", "points", "const", "count", "view", "bitfields")
    return field.get("type") == "uint" and not any(key in field for key in others)
