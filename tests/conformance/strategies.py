"""Hypothesis strategies for valid ICDs that are as unusual as the rules allow."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial
from itertools import pairwise

from hypothesis import strategies as st

from icdgen.icd import exact, formula
from icdgen.icd.curve import OUTSIDE
from tests.conformance.derived import derived
from tests.conformance.open_ends import (
    fields_behind,
    nested_end,
    open_end,
    open_parts,
)
from tests.conformance.sharing import sharing

# Words that mean something to a language, to generated code, or to a template; alone
# each would be a bad identifier.
_WORDS = (
    "class", "def", "None", "True", "self", "import", "lambda", "async", "match", "type", "fn", "crate", "impl", "mod", "Self",
    "int", "char", "register", "volatile", "struct", "union", "void", "static", "restrict", "template", "operator", "new", "dyn",
    "errno", "assert", "NULL", "main", "linux", "raw", "bytes", "length", "id", "encode", "decode", "from bytes", "to bytes",
    "value", "message", "buffer", "status", "field", "error", "result", "default", "unknown", "name", "data", "i", "u8", "str",
    "delete", "Ok",
)  # fmt: skip
_NASTY = (
    '"', "'", "\\", "\\n", "*/", "/*", "//", '"""', "'''", "{{", "}}", "{%", "%}", "{#", "??/", "??=", "%s", "%n", "$(x)", "`", "#",
    "\\u0041", "\u00e9", "\u00b0", "\u03a9", "\u4f4d", "\U0001f6f0", "\u202e", "&amp;", "<b>", "]]>", "\\", "0", "1st", "r#",
    "@param",
)  # fmt: skip


@dataclass(frozen=True)
class Names:
    """Draws names that are unique in their scope."""

    draw: object
    seen: set

    def unique_names(self, word: str) -> dict:
        """Draw ``name`` and ``identifier`` of an object. The rules may refuse the
        identifier.
        """
        draw = self.draw
        number = len(self.seen)
        pieces = draw(
            st.lists(st.sampled_from(_WORDS + _NASTY), min_size=1, max_size=4)
        )
        name = draw(st.sampled_from((" ", ""))).join(pieces).strip()
        while name in self.seen or not name:
            name += f" {number}"
        self.seen.add(name)
        dangerous = draw(st.sampled_from(_WORDS))
        identifier = (
            dangerous
            if draw(st.integers(0, 2)) == 0
            else f"{dangerous} {word} {number}"
        )
        return {"name": name, "identifier": identifier}


@st.composite
def icds(draw) -> dict[str, dict]:
    """Draw one to three ICDs by node name. Later ones may include the first."""
    trees: dict[str, dict] = {}
    names = Names(draw, set())  # a node that includes another must not repeat its names
    shared = draw(_ids())  # for nodes that include each other's messages
    for number in range(draw(st.integers(1, 3))):
        name = f"n{number}"
        includes = bool(number) and draw(st.booleans())
        tree = draw(
            _icd(
                name,
                names,
                shared if not number or includes else draw(_ids()),
                first_id=number * 60,
            )
        )
        if includes:
            tree["include"] = ["n0.yaml"]
        trees[name] = tree
    return trees


@dataclass(frozen=True)
class Ids:
    """Draws the ids of a node: ``bits`` wide, with ``above`` in the bits above the
    lowest byte. Some are written as bytes.
    """

    bits: int
    above: int
    as_bytes: bool

    def __call__(self, low: int) -> int | list[int]:
        id = self.above << 8 | low
        return (
            list(id.to_bytes((self.bits + 7) // 8, "big"))
            if self.as_bytes and low % 2
            else id
        )


@st.composite
def _ids(draw) -> Ids:
    bits = draw(st.sampled_from((8, 8, 11, 16, 24, 29, 32)))
    return Ids(bits, draw(st.integers(0, (1 << bits - 8) - 1)), draw(st.booleans()))


@st.composite
def _icd(draw, name: str, names: Names, ids: Ids, first_id: int) -> dict:
    enums = [
        draw(_enum(Names(draw, set()), f"E{name}{number}"))
        for number in range(draw(st.integers(1, 3)))
    ]
    orders = {
        "byte_order": draw(st.sampled_from(("little", "big"))),
        "bit_order": draw(st.sampled_from(("lsb0", "msb0"))),
    }
    structs: list[dict] = []
    variable: list[dict] = []  # structs of variable length
    for _ in range(draw(st.sampled_from((0, 0, 1, 2)))):
        structs.append(
            draw(_struct(names.unique_names("struct"), enums, structs, orders))
        )
    messages = []
    for number in range(draw(st.integers(1, 5))):
        own = draw(_own_orders())
        fields, length = draw(
            _fields(enums if number else enums + enums, orders | own, structs)
        )
        message = {
            **names.unique_names("message"),
            **own,
            "kind": draw(
                st.sampled_from(("telecommand", "telemetry", "configuration"))
            ),
        }
        if message["kind"] == "configuration":
            message |= {
                "set_id": ids(first_id + number),
                "get_id": ids(first_id + 20 - number),
            }
        else:
            message["id"] = ids(
                first_id + number + (0 if message["kind"] == "telecommand" else 40)
            )
        message["length"] = length
        if draw(st.integers(0, 2)) == 0:
            alternatives = draw(_alternatives(fields, length, enums, orders | own))
            ends = (field["at"] + field["bits"] + 7 for field in alternatives)
            fields, message["length"] = (
                [*fields, *alternatives],
                max([length, *(end // 8 for end in ends)]),
            )
        if (
            not any("when" in field for field in fields)
            and draw(st.integers(0, 3)) == 0
        ):
            place = {
                "at": 8 * message["length"],
                **Names(draw, {field["name"] for field in fields}).unique_names("end"),
            }
            fields = [*fields, *draw(open_parts(place, fields, _field(enums), structs))]
        elif (
            not any("when" in field for field in fields)
            and draw(st.integers(0, 3)) == 0
        ):
            struct = draw(_struct(names.unique_names("struct"), enums, structs, orders))
            own_names = Names(draw, {field["name"] for field in fields})
            inner_names = Names(draw, {field["name"] for field in struct["fields"]})
            named = [
                own_names.unique_names(name)
                for name in ("count", "inner count", "groups")
            ]
            inner = [
                inner_names.unique_names("behind")
                for _ in range(draw(st.integers(1, 4)))
            ]
            ends, struct = draw(
                nested_end(message["length"], named, struct, inner, _field(enums))
            )
            message["length"] += 2
            place = {"at": 8 * message["length"], **own_names.unique_names("behind")}
            ends += draw(fields_behind(place, 0, ends, _field(enums), structs))
            fields = [*fields, *ends]
            variable.append(struct)
        elif draw(st.integers(0, 4)) == 0:
            message["reserved"] = draw(st.integers(1, 9))
            message["length"] += message["reserved"]
        elif message["length"] > 1 and draw(st.integers(0, 4)) == 0:
            message["may_end_early"] = "zeros"
        if fields:
            message["fields"] = fields
        if "id" in message and draw(st.integers(0, 3)) == 0:
            fields_and_length = _fields(enums, orders | own, structs)
            messages += draw(
                sharing(
                    message,
                    names,
                    fields_and_length,
                    partial(_open_end, enums=enums, structs=structs),
                )
            )
        else:
            messages.append(message)
    for message in messages:
        message |= draw(derived(message.get("fields", ())))
    messages.append(
        _uses_all(names.unique_names("message"), enums, structs, ids(first_id + 59))
    )
    node = {
        "name": name,
        "title": draw(st.sampled_from(("Plain", 'Odd "*/ {{ \\'))),
        **orders,
    }
    if ids.bits != 8:
        node["id_bits"] = ids.bits
    return {
        "icdgen": 1,
        "node": node,
        "enums": enums,
        "structs": [*structs, *variable],
        "messages": messages,
    }


@st.composite
def _struct(
    draw, names: dict, enums: list[dict], nested: list[dict], orders: dict
) -> dict:
    """Draw a struct that may contain others, in a node with these ``orders``. A message
    that uses the struct may have another bit order.
    """
    fields, length = draw(_fields(enums, orders, nested, in_struct=True))
    if not fields:
        fields, length = [{"at": 3, "bits": 2, "name": "only", "type": "uint"}], 1
    return {
        **names,
        "length": length + draw(st.sampled_from((0, 0, 1, 3))),
        "fields": fields,
    }


def _uses_all(
    names: dict, enums: list[dict], structs: list[dict], id: int | list[int]
) -> dict:
    """Return a message with a field of each enumeration and of each struct, so that
    none is unused.
    """
    fields, at = [], 3
    for number, enum in enumerate(enums):
        bits = _needed(enum)
        fields.append(
            {
                "at": at,
                "bits": bits,
                "name": f"user {number}",
                "type": "enum",
                "enum": enum["name"],
            }
        )
        at += bits
    for number, struct in enumerate(structs):
        at = (at + 7) // 8 * 8
        fields.append({"at": at, "name": f"struct {number}", "struct": struct["name"]})
        at += 8 * struct["length"]
    return {
        **names,
        "kind": "telemetry",
        "id": id,
        "length": (at + 7) // 8,
        "fields": fields,
    }


def _needed(enum: dict) -> int:
    """Return the bits of the narrowest field for every member. A negative member makes
    the field signed.
    """
    values = [
        value
        for member in enum["members"]
        for value in (member["value"], member.get("to", 0))
    ]
    signed = min(values) < 0
    return (
        max((~value if value < 0 else value).bit_length() + signed for value in values)
        or 1
    )


@st.composite
def _enum(draw, names: Names, name: str) -> dict:
    bits = draw(st.sampled_from((1, 2, 3, 4, 7, 8, 9, 16, 31, 32, 33, 63, 64)))
    low, high = draw(
        st.sampled_from(
            (
                (0, (1 << bits) - 1),
                (0, (1 << bits) - 1),
                (-(1 << bits - 1), (1 << bits - 1) - 1),
            )
        )
    )
    near = st.integers(max(low, -5), min(5, high))
    values = draw(
        st.lists(st.integers(low, high) | near, min_size=1, max_size=6, unique=True)
    )
    members: list[dict] = []
    after = dict(zip(ordered := sorted(values), ordered[1:], strict=False))
    for value in values:
        room = after.get(value, high + 1) - value - 1
        reach = (
            {"to": value + draw(st.integers(1, min(room, 300)))}
            if room > 0 and draw(st.integers(0, 4)) == 0
            else {}
        )
        members.append({"value": value, **reach, **names.unique_names("member")})
    return {"name": name, "members": members}


@st.composite
def _own_orders(draw) -> dict:
    """Draw byte and bit order of a message or a field that differ from the enclosing
    ones; usually empty.
    """
    orders = {}
    if draw(st.integers(0, 3)) == 0:
        orders["byte_order"] = draw(st.sampled_from(("little", "big")))
    if draw(st.integers(0, 3)) == 0:
        orders["bit_order"] = draw(st.sampled_from(("lsb0", "msb0")))
    return orders


def _width(field: dict) -> int:
    """Return the bits of a field, or of all elements of an array."""
    return field["bits"] * field.get("count", 1)


def _bits_of(field: dict, orders: dict) -> int:
    """Return the bits of the frame that a field uses: bit w of byte b is bit 8 * b + w."""
    places = (divmod(at, 8) for at in range(field["at"], field["at"] + _width(field)))
    return sum(
        1 << 8 * byte + (bit if orders["bit_order"] == "lsb0" else 7 - bit)
        for byte, bit in places
    )


@st.composite
def _fields(
    draw, enums: list[dict], orders: dict, structs: list[dict], in_struct: bool = False
) -> tuple[list[dict], int]:
    """Draw consecutive fields with gaps of reserved bits, and their length in bytes,
    for a message with these ``orders``.
    """
    fields: list[dict] = []
    names = Names(draw, set())
    at = used = end = 0
    for _ in range(draw(st.integers(0, 8))):
        at += draw(st.sampled_from((0, 0, 0, 1, 2, 3, 5, 8, 11)))
        field = draw(_field(enums))
        is_plain = field.keys() == {"bits", "type"} and field["type"] == "uint"
        own = (
            draw(_own_orders())
            if field["type"] not in ("bytes", "text", "bool")
            else {}
        )
        if in_struct:
            # In other messages the identifier may be the same, and the fields overlap.
            own.pop("bit_order", None)
        straight = tuple({**orders, **own}.values()) in (
            ("little", "lsb0"),
            ("big", "msb0"),
        )
        if field["type"] in ("bytes", "text"):
            at = (at + 7) // 8 * 8
        while used & _bits_of({"at": at, **field}, orders | own):
            at += draw(st.sampled_from((1, 8 - at % 8)))
            at = (at + 7) // 8 * 8 if field["type"] in ("bytes", "text") else at
        used |= _bits_of({"at": at, **field}, orders | own)
        fields.append(
            {
                "at": at,
                "bits": field.pop("bits"),
                **names.unique_names("field"),
                **field,
                **own,
            }
        )
        if (
            is_plain
            and not in_struct
            and (straight or at % 8 + fields[-1]["bits"] <= 8)
            and draw(st.booleans())
        ):
            fields[-1]["bitfields"] = draw(_division(names, fields[-1]["bits"]))
        end = max(end, at + _width(fields[-1]))
        at = draw(st.sampled_from((end, end, end // 8 * 8)))
    if not in_struct:
        fields += draw(_views(fields, used, names, enums, orders))
    for struct in structs:
        count = draw(st.sampled_from((None, None, 0, 1, 2, 3)))
        if count is not None:
            at = (end + 7) // 8 * 8
            fields.append(
                {
                    "at": at,
                    **names.unique_names("part"),
                    "struct": struct["name"],
                    **({"count": count} if count else {}),
                }
            )
            end = at + 8 * struct["length"] * (count or 1)
    order = draw(st.permutations(fields)) if draw(st.booleans()) else fields
    return order, (end + 7) // 8


@st.composite
def _alternatives(
    draw, fields: list[dict], length: int, enums: list[dict], orders: dict
) -> list[dict]:
    """Draw optional fields that depend on another field, some of them in the same bits.
    Adds the other field if it is missing.
    """
    selectors = [field for field in fields if _decides(field)]
    room = length + draw(st.integers(1, 9))
    used = (1 << 8 * length) - 1 if any("struct" in field for field in fields) else 0
    for field in fields:
        used |= (
            0
            if field.get("view") or "struct" in field
            else _bits_of(field, {**orders, **field})
        )
    names = Names(
        draw,
        {
            part["name"]
            for field in fields
            for part in (field, *field.get("bitfields", ()))
        },
    )
    first_fields = (
        []
        if selectors
        else [
            {
                "at": 8 * length,
                **names.unique_names("selector"),
                "bits": draw(st.integers(1, 8)),
                "type": "uint",
            }
        ]
    )
    used |= _bits_of(first_fields[0], orders) if first_fields else 0
    selector = draw(st.sampled_from(selectors or first_fields))
    most = min(7, (1 << selector["bits"] - (selector["type"] == "enum")) - 1)
    values = draw(st.lists(st.integers(0, most), min_size=1, max_size=4, unique=True))
    alternatives: list[dict] = []
    for near in draw(
        st.lists(
            st.integers(0, 8 * room - 1) | st.integers(8 * length, 8 * room - 1),
            min_size=1,
            max_size=4,
        )
    ):
        for value in values:
            field = {**draw(_field(enums)), **draw(_own_orders())}
            if field["type"] in ("bytes", "text"):
                continue
            dropped = (
                ("count", "byte_order", "bit_order")
                if field["type"] == "bool"
                else ("count",)
            )
            field = {key: value for key, value in field.items() if key not in dropped}
            at = max(0, min(near, 8 * room - field["bits"]))
            when = {selector["name"]: draw(st.sampled_from((value, [value])))}
            place = {
                "at": at,
                "bits": field.pop("bits"),
                **names.unique_names("alternative"),
                **field,
                "when": when,
            }
            used_bits = used
            for other in alternatives:
                same = _listed(other["when"]) == _listed(when)
                used_bits |= _bits_of(other, {**orders, **other}) if same else 0
            if not _bits_of(place, {**orders, **place}) & used_bits:
                alternatives.append(place)
    return [*first_fields, *alternatives]


def _listed(when: dict) -> list[list[int]]:
    return [
        values if isinstance(values, list) else [values] for values in when.values()
    ]


def _decides(field: dict) -> bool:
    """Return whether other fields may depend on the value of a field."""
    excluded_keys = (
        "formula",
        "points",
        "const",
        "count",
        "view",
        "bitfields",
        "struct",
        "special",
    )
    return field.get("type") in ("uint", "bool", "enum") and not any(
        key in field for key in excluded_keys
    )


@st.composite
def _open_end(
    draw, fields: list[dict], length: int, enums: list[dict], structs: list[dict]
) -> dict:
    """Draw the end of a variable-length message, after ``length`` bytes."""
    place = {
        "at": 8 * length,
        **Names(draw, {field["name"] for field in fields}).unique_names("end"),
    }
    return draw(open_end(place, fields, _field(enums), structs))


@st.composite
def _views(
    draw, fields: list[dict], used: int, names: Names, enums: list[dict], orders: dict
) -> list[dict]:
    """Draw overlay fields of used bits. A position gets at most one overlay field."""
    views = []
    for _ in range(draw(st.sampled_from((0, 0, 1, 3))) if fields else 0):
        place = draw(st.sampled_from(fields))
        at = place["at"] + draw(st.integers(0, _width(place) - 1) | st.just(0))
        field = {**draw(_field(enums)), **draw(_own_orders())}
        if field["type"] in ("bytes", "text"):
            continue
        bounded = field.keys() & {"special", "min", "max", "above", "below"}
        if field["type"] in ("uint", "int") and not bounded and draw(st.booleans()):
            field["bits"] = min(field["bits"], place["bits"])
        for key in (
            "const",
            "count",
            *(("byte_order", "bit_order") if field["type"] == "bool" else ()),
        ):
            field.pop(key, None)
        if not _bits_of({"at": at, **field}, {**orders, **field}) & ~used:
            views.append(
                {
                    "at": at,
                    "bits": field.pop("bits"),
                    **names.unique_names("view"),
                    **field,
                    "view": True,
                }
            )
    return views


@st.composite
def _division(draw, names: Names, bits: int) -> list[dict]:
    """Draw the parts of a split field, in any order."""
    cuts = sorted(draw(st.sets(st.integers(0, bits), max_size=4)) | {0, bits})
    parts = []
    for start, end in pairwise(cuts):
        kind = draw(
            st.sampled_from(
                ("uint", "int", "bool") if end - start == 1 else ("uint", "int")
            )
        )
        part = {
            "at": start,
            "bits": end - start,
            **names.unique_names("part"),
            "type": kind,
        }
        if kind != "bool" and draw(st.booleans()):
            part |= {"unit": "deg", "formula": draw(_formula())}
        parts.append(part)
    return draw(st.permutations(parts))


@st.composite
def _field(draw, enums: list[dict]) -> dict:
    kind = draw(
        st.sampled_from(
            ("uint", "int", "uint", "int", "bool", "enum", "float", "bytes", "text")
        )
    )
    array = (
        {"count": draw(st.sampled_from((1, 2, 3, 8, 9)))}
        if draw(st.integers(0, 3)) == 0
        else {}
    )
    if kind in ("bytes", "text"):
        return {"bits": 8 * draw(st.integers(1, 12)), "type": kind, **array}
    if kind == "bool":
        return {"bits": 1, "type": kind, **array}
    if kind == "float":
        formula = draw(
            st.sampled_from(({"formula": draw(_curve())}, draw(_table(-9.9, 9.9)), {}))
        )
        values = draw(
            st.lists(
                st.sampled_from(("nan", "inf", "-inf", -99.9, 0, 4.0e15)),
                max_size=2,
                unique=True,
            )
        )
        named = (
            {"special": [_meaning(value, index) for index, value in enumerate(values)]}
            if values
            else {}
        )
        return {
            "bits": draw(st.sampled_from((32, 64))),
            "type": kind,
            **array,
            **formula,
            **named,
        }
    if kind == "enum":
        enum = draw(st.sampled_from(enums))
        return {
            "bits": draw(st.integers(_needed(enum), 64)),
            "type": kind,
            "enum": enum["name"],
            **array,
        }
    bits = draw(
        st.integers(1, 64)
        | st.sampled_from((1, 7, 8, 9, 15, 16, 17, 24, 31, 32, 33, 53, 54, 63, 64))
    )
    field: dict = {"bits": bits, "type": kind, **array}
    if draw(st.booleans()):
        ends = (-(1 << bits - 1), 1 << bits - 1) if kind == "int" else (0, 1 << bits)
        chosen = draw(st.integers(0, 7))
        scale_keys = {"formula": draw(_curve() if chosen == 2 else _formula())}
        field |= scale_keys if chosen > 1 else draw(_table(*ends))
    if draw(st.booleans()):
        field["unit"] = draw(st.sampled_from(("deg", "m/s^2", "%", "V")))
    low, high = (
        (-(1 << bits - 1), (1 << bits - 1) - 1)
        if kind == "int"
        else (0, (1 << bits) - 1)
    )
    raw = st.integers(low, high)
    if draw(st.integers(0, 5)) == 0:
        field["const"] = draw(raw)
    elif draw(st.integers(0, 5)) == 0:
        values = draw(st.lists(raw, min_size=1, max_size=2, unique=True))
        field["special"] = [
            _meaning(value, index) for index, value in enumerate(values)
        ]
    elif draw(st.integers(0, 5)) == 0 and field.keys().isdisjoint(
        ("formula", "points")
    ):
        values = draw(st.lists(raw, min_size=2, max_size=2, unique=True))
        low_key, high_key = draw(
            st.sampled_from((("min", "max"), ("above", "max"), ("min", "below")))
        )
        field |= {low_key: min(values), high_key: max(values)}
    return field


def _meaning(value: float | str, index: int) -> dict:
    return {"value": value, "meaning": f'*/ odd \\ " {index}'}


@st.composite
def _formula(draw) -> str:
    """Draw factors and offsets, simple and extreme ones; the rules limit the resulting
    range.
    """
    if draw(st.integers(0, 3)) == 0:
        return draw(_long_formula())
    top = draw(
        st.sampled_from((1, 3, 7, 10, 1000, 65535, 2**31, 2**32 - 5, 2**32))
        | st.integers(1, 2**32)
    )
    bottom = draw(
        st.sampled_from((1, 2, 3, 7, 10, 100, 1000, 4096, 10**7, 2**32 - 5))
        | st.integers(1, 2**32)
    )
    offset = draw(st.sampled_from((0, 0, 0, 1, 40, 273, 2**20, 2**30)))
    sign = draw(st.sampled_from(("", "-")))
    shift = f" {draw(st.sampled_from('+-'))} {offset}" if offset else ""
    simple = draw(
        st.sampled_from(
            (
                None,
                None,
                "raw*0.01",
                "raw*0.0001",
                "raw/10000.0",
                "raw*0.48828125",
                "raw*0.1 - 273.15",
                "(raw - 32)*5/9",
            )
        )
    )
    return simple or f"{sign}raw*{top}/{bottom}{shift}"


@st.composite
def _curve(draw) -> str:
    """Draw lines and polynomials, many of which are monotonic."""
    simple = (
        "raw*57.295779513",
        "raw/3 - 1",
        "raw = value*1e3",
        "raw^2",
        "-raw^3/7 - raw",
        "5 + 0.5*raw + 3e-6*raw^2",
    )
    number = st.integers(-(10**9), 10**9).map(lambda value: f"({value}/1000)")
    powers = draw(st.lists(st.integers(1, 7), min_size=1, max_size=4, unique=True))
    terms = [f"{draw(number)}*raw^{power}" for power in powers]
    text = " + ".join([*terms, f"{draw(number)} + raw^{max(powers)}"])
    return draw(st.sampled_from((text, *simple)))


@st.composite
def _table(draw, low: float, high: float) -> dict:
    """Draw points inside and outside the raw range, many with monotonic physical
    values.
    """
    # Points that lie closer are too steep for a double: a finding, and no ICD.
    between = st.floats(1.5 * low - 9, 1.5 * high + 9).map(
        lambda raw: _spelled(round(raw, 9))
    )
    raw = st.integers(math.floor(low), math.ceil(high)) | between
    raws = sorted(
        draw(st.lists(raw, min_size=2, max_size=6, unique_by=float)), key=float
    )
    values = draw(
        st.lists(
            st.integers(-(10**6), 10**6),
            min_size=len(raws),
            max_size=len(raws),
            unique=True,
        )
    )
    values = draw(
        st.sampled_from((values, sorted(values), sorted(values, reverse=True)))
    )
    size = draw(st.sampled_from((1, 10, 1000, 10**7)))
    points = [
        [raw, _spelled(value / size)] for raw, value in zip(raws, values, strict=True)
    ]
    return {"points": points, "outside": draw(st.sampled_from(OUTSIDE))}


def _spelled(number: float) -> float | str:
    """Return a number with an exponent as text, because YAML parsers disagree about
    such numbers.
    """
    return repr(number) if "e" in repr(number) else number


@st.composite
def _long_formula(draw) -> str:
    """Draw factors of many digits, with and without an offset over another denominator."""
    sign = draw(st.sampled_from(("", "-")))
    digits = draw(st.integers(1, 10**20 - 1))
    factor = draw(
        st.sampled_from(
            (
                "2^-19",
                "2^-66",
                "1e-9",
                "4.656612873077393e-10",
                "3^-113",
                "2^180",
                "1e-25",
            )
        )
        | st.integers(1, 180).map(lambda n: f"2^-{n}")
        | st.integers(1, 38).map(lambda n: f"{digits}e-{n}")
    )
    offset = draw(st.sampled_from(("", "", " + 273.15", " - 2^60", " + 2^-40")))
    text = f"{sign}raw*{factor}{offset}"
    return f"raw*{factor}" if exact.is_too_large(formula.parse(text)) else text
