"""Vectors -> requests and the answers that they demand."""

from __future__ import annotations

import re
import struct
from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from typing import NamedTuple

from icdgen import codec
from icdgen.icd.curve import Curve, curve_of_plain
from icdgen.icd.layout import Scalar
from icdgen.vectors.ids import test_ids
from icdgen.vectors.write import raw_json
from tests.conformance.compare import Maybe, Not

DIRECTIONS = ("telecommand", "telemetry", "configuration")


class Case(NamedTuple):
    """One request, and what the answer must be."""

    about: str  # the vector, in words
    request: dict
    answer: dict


def member_names(files: dict[str, dict]) -> dict[str, list[list]]:
    """The members of each enumeration, by the name of the enumeration; nodes that
    include others know theirs.
    """
    return {e["name"]: e["members"] for data in files.values() for e in data["enums"]}


def name_of(members: list[list], value: int) -> str | None:
    """The name of a value: each member has a value and a name, and a range its last
    value.
    """
    if value is None:
        return None  # of what is not there
    return next(
        (
            name
            for first, name, *last in members
            if first <= value <= (last or [first])[0]
        ),
        None,
    )


def _is_among(name: str, parts: Sequence[dict], raw: dict) -> bool:
    """Whether an element of one of these parts is in a frame of these raw values; what
    is in no part is in every frame.
    """
    for one in parts:
        element = name.removeprefix(one["part"] + "[")
        if element != name:
            number, _, inner = element.partition("]")
            if int(number) >= raw[one["counter"]] + one.get("plus", 0):
                return False
            return _is_among(inner.removeprefix("."), one.get("nested", ()), raw)
    return True


def of_arrays_first_and_last(fields: Iterable[dict]) -> Iterator[dict]:
    """The fields; of the elements of an array the first and the last: what is between
    them is of the same type and scale. The vectors hold values of each element.
    """
    groups: dict[str, list[dict]] = {}
    for field in fields:
        groups.setdefault(re.sub(r"\[\d+\]", "[]", field["name"]), []).append(field)
    for group in groups.values():
        yield group[0]
        if len(group) > 1:
            yield group[-1]


class MessageCases:
    """The cases of one message, as spoken by ``node`` (the one that declares it or one
    that includes that).
    """

    def __init__(
        self,
        node: str,
        message: dict,
        enums: dict[str, list[list]],
        never_set: list[str],
        shared: frozenset[str] = frozenset(),
    ) -> None:
        """``shared``: the messages of the node that have no id of their own, and so go
        by their names, too.
        """
        self.named = {"message": message["name"]} if message["name"] in shared else {}
        self.node, self.message, self.enums, self.never_set = (
            node,
            message,
            enums,
            never_set,
        )
        self.fields: list[dict] = message["fields"]
        self.views = {field["name"] for field in self.fields if "view" in field}
        self.scaled = [
            field
            for field in self.fields
            if field.keys() & {"factor", "coefficients", "points"}
        ]
        self.one_way = {
            field["name"] for field in self.scaled if "set" not in field
        }  # and views
        self.texts = [field for field in self.fields if field["type"] == "text"]
        self.id = message.get("id", message.get("set_id"))
        self.fresh = {
            field["name"]: shown(field, field["default"]) for field in self.fields
        }
        self.tail: dict | None = message.get("tail")
        self.parts: list[dict] = [
            *message.get("inner", ()),
            *([self.tail] if self.tail else ()),
        ]
        self.full = dict(self.fresh)
        highest: dict[str, int] = {}
        for one in (
            *self.parts,
            *(nested for part in self.parts for nested in part.get("nested", ())),
        ):
            high = one["most"] - one.get("plus", 0)
            highest[one["counter"]] = min(high, highest.get(one["counter"], high))
        self.full |= highest
        self.conditional = {
            field["name"]: field["when"] for field in self.fields if "when" in field
        }
        self.given = self.owned(
            self.full
        )  # what makes such a message, with all elements

    def all(self) -> Iterator[Case]:
        """Everything that the vectors of the message demand."""
        for vector in self.message["vectors"]:
            yield from self.frame(vector)
        yield from self.routes()
        yield from self.refused_lengths()
        yield self.constants()
        for field in of_arrays_first_and_last(self.fields):
            yield from self.unfit(field)
        for field in of_arrays_first_and_last((*self.scaled, *self.texts)):
            # Not every element can be in a frame: arrays in elements can share a counter.
            is_sent = self.is_sent(field["name"], self.full)
            if is_sent and field["name"] not in self.one_way:
                yield from self.settings(field)
        yield from self.set_views()

    def request(self, op: str, **more: object) -> dict:
        return {
            "op": op,
            "node": self.node,
            "kind": self.message["kind"],
            "id": self.id,
            **self.named,
            **more,
        }

    def frame(self, vector: dict) -> Iterator[Case]:
        """Decoding, and encoding from raw and from physical values."""
        raw = {
            f["name"]: shown(f, value)
            for f, value in zip(self.fields, vector["raw"], strict=True)
        }
        physical = {
            f["name"]: bits
            for f, bits in zip(self.scaled, vector.get("doubles", ()), strict=True)
        }
        for field, text in zip(self.texts, vector.get("texts", ()), strict=True):
            physical[field["name"]] = None if text is None else text.encode().hex()
        encoded = vector.get("encoded", vector["bytes"])
        answer = {"ok": True, "raw": raw, "physical": physical, "bytes": encoded}
        why = vector["why"]
        yield Case(why, self.request("decode", bytes=vector["bytes"]), answer)
        yield Case(why, self.request("encode", raw=self.owned(raw)), answer)
        names = self.names(raw)
        if names:
            yield Case(
                why,
                self.request("decode", bytes=vector["bytes"], names=True),
                {**answer, "names": names},
            )
        physical = {
            name: value
            for name, value in physical.items()
            if name not in self.one_way and value is not None
        }
        physical = {
            name: value for name, value in physical.items() if self.is_sent(name, raw)
        }
        if physical:
            rest = {
                name: value
                for name, value in self.owned(raw).items()
                if name not in physical
            }
            yield Case(
                why,
                self.request("encode", raw=rest, physical=physical),
                self.from_physical(raw, physical, answer),
            )

    def is_sent(self, name: str, raw: dict) -> bool:
        """Whether a frame of these raw values has a field: elements of open parts
        beyond the count are 0, set or not.
        """
        return _is_among(name, self.parts, raw)

    def owned(self, values: dict) -> dict:
        """Without those of views, which are not set."""
        return {name: value for name, value in values.items() if name not in self.views}

    def seen(self, raw: dict) -> dict:
        """Raw values of which the views are not known."""
        return {
            name: ... if name in self.views else value for name, value in raw.items()
        }

    def set_views(self) -> Iterator[Case]:
        """A view is no field that could be set."""
        for field in self.fields:
            if field["name"] in self.views:
                request = self.request("encode", raw=self.fresh)
                yield Case(
                    "a view set",
                    request,
                    {"ok": False, "error": "unknown-field", "field": ...},
                )
                return

    def names(self, raw: dict) -> dict[str, str | None]:
        """Name of each enum field's member."""
        return {
            f["name"]: name_of(self.enums.get(f["enum"], []), raw[f["name"]])
            for f in self.fields
            if "enum" in f
        }

    def there(self, field: dict) -> dict:
        """Values, but for views, of a message with all elements that has the field."""
        if "when" not in field:
            return self.given
        known = {one["name"]: one for one in self.fields}
        found = self.given | {
            on: shown(known[on], values[0]) for on, values in field["when"].items()
        }
        for name, when in self.conditional.items():
            is_there = all(found[on] in values for on, values in when.items())
            found[name] = zero(known[name]) if is_there else None
        return found

    def from_physical(self, raw: dict, physical: dict, answer: dict) -> dict:
        """The answer, unless some raw value is too wide to come back from a double."""
        for field in self.texts:
            if field["name"] in physical:
                filled = physical[field["name"]].ljust(field["bits"] // 4, "0")
                if filled != raw[field["name"]]:
                    raws = {**self.seen(answer["raw"]), field["name"]: filled}
                    answer = {**answer, "raw": raws, "bytes": ...} | (
                        {"physical": ...} if self.views else {}
                    )
        for field in self.scaled:
            if field["name"] not in physical:
                continue
            back = nearest(field, physical[field["name"]])
            if back is None:
                return {"ok": False, "error": "range", "field": field["name"]}
            if back != raw[field["name"]]:
                raws = {**self.seen(answer["raw"]), field["name"]: back}
                answer = {"ok": True, "raw": raws, "physical": ..., "bytes": ...}
        return answer

    def routes(self) -> Iterator[Case]:
        """The same frame under every kind and id that lead to the message."""
        first = next(self.frame(self.message["vectors"][0]))
        message = self.message
        routes = {
            "telecommand": [("telecommand", message.get("id"))],
            "telemetry": [("telemetry", message.get("id"))],
            "configuration": [
                ("telecommand", message.get("set_id")),
                ("telemetry", message.get("get_id")),
                ("configuration", message.get("set_id")),
                ("configuration", message.get("get_id")),
            ],
        }
        for kind, id in routes[message["kind"]]:
            yield Case(
                f"under {kind} {id}",
                {**first.request, "kind": kind, "id": id},
                first.answer,
            )

    def refused_lengths(self) -> Iterator[Case]:
        """Frames that are too short or too long."""
        for actual in self.message["refused_lengths"]:
            answer = {
                "ok": False,
                "error": "length",
                "expected": self.expected(actual),
                "actual": actual,
            }
            yield Case(
                f"{actual} bytes", self.request("decode", bytes="00" * actual), answer
            )
        for frame in self.message.get("refused_frames", ()):
            actual = len(frame) // 2
            answer = {
                "ok": False,
                "error": "length",
                "expected": Maybe(Not(actual)),
                "actual": actual,
            }
            yield Case(
                f"miscounted: {frame}", self.request("decode", bytes=frame), answer
            )

    def expected(self, actual: int) -> object:
        """What a frame of no possible length should have had, which not every language
        tells if frames differ.
        """
        if "may_end_early" in self.message:
            return self.message["length"] if actual else Maybe(...)
        if self.tail is None:
            return self.message["length"]
        if "inner" in self.message or "nested" in self.tail:
            return Maybe(...)
        step, behind = self.tail["step"], self.tail.get("behind", 0)
        least = self.tail["least"] + step * max(0, self.tail.get("plus", 0)) + behind
        if least <= actual < self.message["length"]:
            return Maybe(actual - (actual - least) % step)
        return Maybe(least if actual < least else self.message["length"])

    def constants(self) -> Case:
        """Ids, length, fresh values, special values."""
        ids = [
            self.message[key]
            for key in ("id", "set_id", "get_id")
            if key in self.message
        ]
        special = {
            field["name"]: field["special"]
            for field in self.fields
            if "special" in field
        }
        limits = {
            f["name"]: {k: nearest_double(v) for k, v in f["limits"].items()}
            for f in self.fields
            if "limits" in f
        }
        answer = {
            "ok": True, "name": self.message["name"], "ids": ids, "length": self.message["length"], "default": self.fresh,
            "special": Maybe(special), "limits": Maybe(limits),
        }  # fmt: skip
        return Case("constants", self.request("constants"), answer)

    def unfit(self, field: dict) -> Iterator[Case]:
        """Raw values that encoding refuses."""
        name = field["name"]
        for value in field.get("unfit", ()):
            request = self.request("encode", raw={**self.there(field), name: value})
            yield Case(
                f"{name} = {value}",
                request,
                {"ok": False, "error": "range", "field": name},
            )

    def settings(self, field: dict) -> Iterator[Case]:
        """Physical values set, exact ties and unfit ones among them."""
        name = field["name"]
        given_all = self.there(field)
        rest = {key: value for key, value in given_all.items() if key != name}
        refusal = {"ok": False, "error": "range", "field": name}
        if field["type"] == "text":
            given = [(text.encode().hex(), raw) for text, raw in field["set"]]
        else:
            never = () if field["type"] == "float" else self.never_set
            given = [*field["set"], *((bits, None) for bits in never)]
        for bits, raw in given:
            request = self.request("encode", raw=rest, physical={name: bits})
            full = {
                key: raw if key == name else value
                for key, value in self.seen(self.full | given_all).items()
            }  # in the order of the fields
            answer = (
                refusal
                if raw is None
                else {"ok": True, "raw": full, "physical": ..., "bytes": ...}
            )
            yield Case(f"{name} set to {bits}", request, answer)


def node_cases(data: dict) -> Iterator[Case]:
    """What the vectors of a node demand beyond its messages: ids and enumerations."""
    node = data["node"]
    yield node_itself(data)
    for direction in DIRECTIONS:
        known = data["ids"][direction]
        for id, names in known.items():
            for name in names if isinstance(names, list) else ():
                request = {
                    "op": "constants",
                    "node": node,
                    "kind": direction,
                    "id": int(id),
                    "message": name,
                }
                yield Case(
                    f"{direction} {id}, {name}",
                    request,
                    {"ok": True, "name": name, ...: ...},
                )
        for id in (*test_ids(map(int, known)), 65535, 65536, -1):
            if isinstance(known.get(str(id)), list):
                request = {"op": "constants", "node": node, "kind": direction, "id": id}
                yield Case(
                    f"{direction} {id}, of several",
                    request,
                    {"ok": False, "error": "request"},
                )
            elif str(id) in known:
                request = {"op": "constants", "node": node, "kind": direction, "id": id}
                yield Case(
                    f"{direction} {id}",
                    request,
                    {"ok": True, "name": known[str(id)], ...: ...},
                )
            else:
                request = {
                    "op": "decode",
                    "node": node,
                    "kind": direction,
                    "id": id,
                    "bytes": "",
                }
                yield Case(
                    f"{direction} {id}", request, {"ok": False, "error": "unknown-id"}
                )
    yield from shared_ids(data)
    yield from enum_cases(data)


def shared_names(data: dict) -> frozenset[str]:
    """The messages that a node knows by ids which others have, too."""
    known = (
        names
        for ids in data["ids"].values()
        for names in ids.values()
        if isinstance(names, list)
    )
    return frozenset(name for names in known for name in names)


def shared_ids(data: dict) -> Iterator[Case]:
    """Which message each frame of an id is that several have."""
    for row in data.get("shared_ids", ()):
        about = {
            "node": data["node"],
            "kind": row["direction"],
            "id": row["id"],
            "bytes": row["bytes"],
        }
        if row["message"] is not None:
            answer = {"ok": True, "message": row["message"], "bytes": ...}
        elif "expected" in row:
            actual = len(row["bytes"]) // 2
            answer = {
                "ok": False,
                "error": "length",
                "expected": row["expected"],
                "actual": actual,
            }
        else:
            answer = {"ok": False, "error": "unknown-id"}
        yield Case(
            f"a frame of the shared {row['direction']} id {row['id']}",
            {"op": "decode", **about},
            answer,
        )


def node_itself(data: dict) -> Case:
    """Its constants."""
    answer = {
        "ok": True,
        "node_type": data.get("node_type"),
        "interface_version": data.get("interface_version"),
    }
    return Case("node", {"op": "node", "node": data["node"]}, answer)


def enum_cases(data: dict) -> Iterator[Case]:
    """The names of the members of the enumerations that a node declares."""
    node = data["node"]
    for enum in data["enums"]:
        ends = [
            (first, last)
            for first, _, last in (one for one in enum["members"] if len(one) == 3)
        ]
        near = [
            value
            for first, last in ends
            for value in (first - 1, first + 1, last, last + 1)
            if value < 1 << 64
        ]
        values = [*(first for first, *_ in enum["members"]), *near]
        for value in [*values, enum["unknown"]]:
            request = {"op": "enum", "node": node, "enum": enum["name"], "value": value}
            yield Case(
                f"{enum['name']} {value}",
                request,
                {"ok": True, "name": name_of(enum["members"], value)},
            )


def shown(field: dict, value: object) -> object:
    """A raw value of the vectors as it stands in the testee protocol."""
    return bool(value) if field["type"] == "bool" and value is not None else value


def zero(field: dict) -> object:
    """A raw value of 0 as it stands in the testee protocol."""
    return "0" * (field["bits"] // 4) if field["type"] == "float" else shown(field, 0)


def nearest_double(exact: str) -> str:
    """The bits of the double that is nearest to an exact decimal or fraction."""
    value = Fraction(exact)
    return struct.pack(">d", value.numerator / value.denominator).hex()


def nearest(field: dict, bits: str) -> int | str | None:
    """The raw value nearest to a physical one, ties to even; None if it does not fit."""
    if (curve := curve_of_plain(field)) is not None:
        return _on_curve(field, curve, bits)
    value = Fraction(struct.unpack(">d", bytes.fromhex(bits))[0])
    raw = round((value - Fraction(field["offset"])) / Fraction(field["factor"]))
    width, signed = field["bits"], field["type"] == "int"
    low, high = (
        (-(1 << width - 1), (1 << width - 1) - 1) if signed else (0, (1 << width) - 1)
    )
    return raw if low <= raw <= high else None


def _on_curve(field: dict, curve: Curve, bits: str) -> int | str | None:
    one = Scalar(name="", at=0, bits=field["bits"], type=field["type"], curve=curve)
    try:
        raw = codec.raw_from_physical(one, struct.unpack(">d", bytes.fromhex(bits))[0])
    except codec.CodecError:
        return None
    return raw_json(one, raw)
