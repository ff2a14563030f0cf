"""Turn test vectors into requests with the answers that each language must give."""

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
    """A request and the expected answer."""

    about: str  # the vector, in words
    request: dict
    answer: dict


def member_names(files: dict[str, dict]) -> dict[str, list[list]]:
    """Return the members of each enumeration by its name. Enumerations of included
    nodes count too.
    """
    return {e["name"]: e["members"] for data in files.values() for e in data["enums"]}


def name_of(members: list[list], value: int) -> str | None:
    """Return the name of a value. Each member is a value with a name; a range also has
    its last value.
    """
    if value is None:
        return None  # the field is absent
    return next(
        (
            name
            for first, name, *last in members
            if first <= value <= (last or [first])[0]
        ),
        None,
    )


def _is_among(name: str, parts: Sequence[dict], raw: dict) -> bool:
    """Return whether an array element is in a frame with these raw values. Elements
    outside all variable-length parts are in every frame.
    """
    for part in parts:
        element = name.removeprefix(part["part"] + "[")
        if element != name:
            number, _, inner = element.partition("]")
            if int(number) >= raw[part["counter"]] + part.get("plus", 0):
                return False
            return _is_among(inner.removeprefix("."), part.get("nested", ()), raw)
    return True


def of_arrays_first_and_last(fields: Iterable[dict]) -> Iterator[dict]:
    """Yield the fields, but only the first and last element of each array. Elements
    between them have the same type and scale, and the vectors contain values of each
    element.
    """
    groups: dict[str, list[dict]] = {}
    for field in fields:
        groups.setdefault(re.sub(r"\[\d+\]", "[]", field["name"]), []).append(field)
    for group in groups.values():
        yield group[0]
        if len(group) > 1:
            yield group[-1]


class MessageCases:
    """Cases of one message as sent by ``node``, which declares the message or includes
    its node.
    """

    def __init__(
        self,
        node: str,
        message: dict,
        enums: dict[str, list[list]],
        never_set: list[str],
        shared: frozenset[str] = frozenset(),
    ) -> None:
        """Prepare the cases. ``shared`` are the messages that share their id with
        others and are therefore also selected by name.
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
        # Fields that cannot be set by a physical value, among them overlay fields.
        self.one_way = {field["name"] for field in self.scaled if "set" not in field}
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
        for counted in (
            *self.parts,
            *(nested for part in self.parts for nested in part.get("nested", ())),
        ):
            high = counted["most"] - counted.get("plus", 0)
            highest[counted["counter"]] = min(
                high, highest.get(counted["counter"], high)
            )
        self.full |= highest
        self.conditional = {
            field["name"]: field["when"] for field in self.fields if "when" in field
        }
        # Values that encode a message with all elements of its arrays.
        self.given = self.owned(self.full)

    def all(self) -> Iterator[Case]:
        """Yield every case that the vectors of the message require."""
        for vector in self.message["vectors"]:
            yield from self.frame(vector)
        yield from self.routes()
        yield from self.refused_lengths()
        yield self.constants()
        for field in of_arrays_first_and_last(self.fields):
            yield from self.values_out_of_range(field)
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
        """Yield cases that decode a frame and encode it from raw and from physical
        values.
        """
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
            other_values = {
                name: value
                for name, value in self.owned(raw).items()
                if name not in physical
            }
            yield Case(
                why,
                self.request("encode", raw=other_values, physical=physical),
                self.from_physical(raw, physical, answer),
            )

    def is_sent(self, name: str, raw: dict) -> bool:
        """Return whether a frame with these raw values contains a field. Elements of a
        variable-length array beyond its count are 0, even if set.
        """
        return _is_among(name, self.parts, raw)

    def owned(self, values: dict) -> dict:
        """Return the values without overlay fields, which cannot be set."""
        return {name: value for name, value in values.items() if name not in self.views}

    def seen(self, raw: dict) -> dict:
        """Return raw values in which overlay fields may have any value."""
        return {
            name: ... if name in self.views else value for name, value in raw.items()
        }

    def set_views(self) -> Iterator[Case]:
        """Yield requests that set an overlay field, which is refused as an unknown
        field.
        """
        for field in self.fields:
            if field["name"] in self.views:
                request = self.request("encode", raw=self.fresh)
                # The request sets all overlay fields; a language may report any of them.
                yield Case(
                    "a view set",
                    request,
                    {"ok": False, "error": "unknown-field", "field": ...},
                )
                return

    def names(self, raw: dict) -> dict[str, str | None]:
        """Return the name of the member of each enum field."""
        return {
            f["name"]: name_of(self.enums.get(f["enum"], []), raw[f["name"]])
            for f in self.fields
            if "enum" in f
        }

    def values_with_field(self, field: dict) -> dict:
        """Return values of a message with all elements in which the field is present.
        Overlay fields are left out.
        """
        if "when" not in field:
            return self.given
        fields_by_name = {field["name"]: field for field in self.fields}
        values_by_name = self.given | {
            on: shown(fields_by_name[on], values[0])
            for on, values in field["when"].items()
        }
        for name, when in self.conditional.items():
            is_there = all(values_by_name[on] in values for on, values in when.items())
            values_by_name[name] = zero(fields_by_name[name]) if is_there else None
        return values_by_name

    def from_physical(self, raw: dict, physical: dict, answer: dict) -> dict:
        """Return the expected answer to encoding these physical values.

        It differs from ``answer`` if a text is padded, or if a raw value has too many
        bits to be restored from a double.
        """
        for field in self.texts:
            if field["name"] in physical:
                # Four bits are one hex digit; the rest of the field becomes NUL.
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
        """Yield the same frame under every kind and id that selects the message."""
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
        """Yield frames that are too short or too long."""
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
                # Several lengths are possible, and languages report different ones.
                "expected": Maybe(Not(actual)),
                "actual": actual,
            }
            yield Case(
                f"miscounted: {frame}", self.request("decode", bytes=frame), answer
            )

    def expected(self, actual: int) -> object:
        """Return the expected lengths of a frame with an impossible length. Not every
        language reports them for variable-length messages.
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
        """Yield cases of ids, length, initial values and special values."""
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

    def values_out_of_range(self, field: dict) -> Iterator[Case]:
        """Yield cases with raw values that encoding refuses."""
        name = field["name"]
        for value in field.get("unfit", ()):
            request = self.request(
                "encode", raw={**self.values_with_field(field), name: value}
            )
            yield Case(
                f"{name} = {value}",
                request,
                {"ok": False, "error": "range", "field": name},
            )

    def settings(self, field: dict) -> Iterator[Case]:
        """Yield cases that set physical values, including exact ties and values out of
        range.
        """
        name = field["name"]
        given_all = self.values_with_field(field)
        other_values = {key: value for key, value in given_all.items() if key != name}
        refusal = {"ok": False, "error": "range", "field": name}
        if field["type"] == "text":
            settings = [(text.encode().hex(), raw) for text, raw in field["set"]]
        else:
            never = () if field["type"] == "float" else self.never_set
            settings = [*field["set"], *((bits, None) for bits in never)]
        for bits, raw in settings:
            request = self.request("encode", raw=other_values, physical={name: bits})
            # The values have the order of the fields.
            full = {
                key: raw if key == name else value
                for key, value in self.seen(self.full | given_all).items()
            }
            answer = (
                refusal
                if raw is None
                else {"ok": True, "raw": full, "physical": ..., "bytes": ...}
            )
            yield Case(f"{name} set to {bits}", request, answer)


def node_cases(data: dict) -> Iterator[Case]:
    """Yield the cases of a node besides its messages: ids and enumerations."""
    node = data["node"]
    yield node_itself(data)
    for direction in DIRECTIONS:
        names_by_id = data["ids"][direction]
        for id, names in names_by_id.items():
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
        for id in (*test_ids(map(int, names_by_id)), 65535, 65536, -1):
            if isinstance(names_by_id.get(str(id)), list):
                request = {"op": "constants", "node": node, "kind": direction, "id": id}
                yield Case(
                    f"{direction} {id}, of several",
                    request,
                    {"ok": False, "error": "request"},
                )
            elif str(id) in names_by_id:
                request = {"op": "constants", "node": node, "kind": direction, "id": id}
                yield Case(
                    f"{direction} {id}",
                    request,
                    {"ok": True, "name": names_by_id[str(id)], ...: ...},
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
    """Return the messages of a node that share an id with others."""
    names_by_id = (
        names
        for ids in data["ids"].values()
        for names in ids.values()
        if isinstance(names, list)
    )
    return frozenset(name for names in names_by_id for name in names)


def shared_ids(data: dict) -> Iterator[Case]:
    """Yield cases that decide which message a frame of a shared id is."""
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
    """Yield the case of the constants of the node."""
    answer = {
        "ok": True,
        "node_type": data.get("node_type"),
        "interface_version": data.get("interface_version"),
    }
    return Case("node", {"op": "node", "node": data["node"]}, answer)


def enum_cases(data: dict) -> Iterator[Case]:
    """Yield cases of the member names of the enumerations that a node declares."""
    node = data["node"]
    for enum in data["enums"]:
        ends = [
            (first, last)
            for first, _, last in (
                member for member in enum["members"] if len(member) == 3
            )
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
    """Return a raw value of the vectors in the form of the testee protocol."""
    return bool(value) if field["type"] == "bool" and value is not None else value


def zero(field: dict) -> object:
    """Return the raw value 0 of a field in the form of the testee protocol."""
    return "0" * (field["bits"] // 4) if field["type"] == "float" else shown(field, 0)


def nearest_double(exact: str) -> str:
    """Return the bits of the double that is nearest to an exact decimal or fraction."""
    value = Fraction(exact)
    return struct.pack(">d", value.numerator / value.denominator).hex()


def nearest(field: dict, bits: str) -> int | str | None:
    """Return the raw value nearest to a physical value, ties to even; ``None`` if it is
    out of range.
    """
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
    scalar = Scalar(name="", at=0, bits=field["bits"], type=field["type"], curve=curve)
    try:
        raw = codec.raw_from_physical(
            scalar, struct.unpack(">d", bytes.fromhex(bits))[0]
        )
    except codec.CodecError:
        return None
    return raw_json(scalar, raw)
