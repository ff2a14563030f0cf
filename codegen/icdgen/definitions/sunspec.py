"""Reader of SunSpec models (JSON): blocks of 16-bit Modbus registers, most significant
byte and word first.

`SunSpec.read` returns `Definitions` with one telemetry message per model, with the id
of the model; repeated groups become arrays of structs. The point types are from the
SunSpec Device Information Model Specification. A point whose scale factor is in another
register is imported as a raw value.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from decimal import Decimal
from typing import Any

from icdgen.definitions.accounting import Account, AccountedMap, accounted
from icdgen.definitions.enumerations import Enumerations
from icdgen.definitions.frames import BIG, ORDERS
from icdgen.definitions.model import (
    Definitions,
    Item,
    Network,
    NotSupported,
    unreadable,
)
from icdgen.definitions.wording import formula, line, node_name, printed, summary, unit
from icdgen.frozen import NamedTuple
from icdgen.icd.variable_length import MOST_BYTES, MOST_ELEMENTS, REST

RAW_ONLY = "IMP078"
_REGISTER = 16  # bits
_MOST_DEPTH = 8  # levels of nested groups
_MOST_POINTS = 20_000  # of a file
_MOST_REGISTERS = MOST_BYTES // 2
_LONGEST = 2048  # bytes of a model with a group that repeats any number of times
# repetitions of a group in another one; devices have fewer points in a curve
_MOST_INNER = 20
_HEAD = 2 * _REGISTER  # bits of the id and length that begin each model
# Units of SunSpec with a different spelling than the built-in unit.
_SPELLED = {
    "Secs": "s",
    "mSecs": "ms",
    "Degrees": "deg",
    "Pct": "%",
    "HPa": "hPa",
    "mps": "m/s",
}
_NONE, _NOT_COUNTED = "not implemented", "not accumulated"


class _Kind(NamedTuple):
    """Field type of a point type.

    ``registers`` is 0 if the point states its size. ``none`` is the value for 'not
    implemented', or 'not accumulated'.
    """

    type: str
    registers: int
    none: int | str | None = None


# Point types of the SunSpec information model, with their values for a point that is
# not implemented.
_KINDS = {
    **{
        f"int{bits}": _Kind("int", bits // 16, -(1 << bits - 1))
        for bits in (16, 32, 64)
    },
    **{
        f"uint{bits}": _Kind("uint", bits // 16, (1 << bits) - 1)
        for bits in (16, 32, 64)
    },
    # An accumulator that a device does not keep reads 0, not the largest value.
    **{f"acc{bits}": _Kind("uint", bits // 16, 0) for bits in (16, 32, 64)},
    **{f"enum{bits}": _Kind("uint", bits // 16, (1 << bits) - 1) for bits in (16, 32)},
    **{
        f"bitfield{bits}": _Kind("uint", bits // 16, (1 << bits) - 1)
        for bits in (16, 32, 64)
    },
    **{f"float{bits}": _Kind("float", bits // 16, "nan") for bits in (32, 64)},
    "raw16": _Kind("uint", 1),
    "count": _Kind("uint", 1, 0xFFFF),
    "sunssf": _Kind("int", 1, -0x8000),
    "pad": _Kind("uint", 1),
    "string": _Kind("text", 0),
    "ipaddr": _Kind("bytes", 2),
    "ipv6addr": _Kind("bytes", 8),
    # Four registers, although 48 bits would fit into three.
    "eui48": _Kind("bytes", 4),
}


class SunSpec:
    """Reader of a SunSpec model, or of a list of models."""

    name = "sunspec"
    title = "a SunSpec model"
    needs: tuple[str, ...] = ()

    def knows(self, start: str) -> bool:
        return start.lstrip()[:1] in ("{", "[") and all(
            f'"{key}"' in start for key in ("group", "points", "name")
        )

    def read(self, file: str, data: bytes) -> Definitions:
        """Return each model as a message.

        Raises `Findings` if the file is not JSON, or not a model.
        """
        models = _parse(file, data)
        to, account = Definitions(file), Account()
        title = _text(models[0]["group"], "label") if len(models) == 1 else ""
        network = Network(
            node_name(file),
            title or node_name(file),
            {**ORDERS[BIG], "id_bits": _REGISTER},
        )
        to.networks.append(network)
        enums = Enumerations()
        # In a list, so that all models of the file count down the same number.
        left = [_MOST_POINTS]
        for tree in sorted(models, key=lambda tree: int(tree["id"])):
            to.total += 1
            model = _Model(
                tree, enums, to, left, {struct["name"] for struct in network.structs}
            )
            try:
                network.messages.append(model.message())
            except NotSupported as why:
                to.left_out(model.name, why)
                tree.settle()
            else:
                network.structs += model.structs
        network.declare(enums.declared())
        account.mappings(models)
        account.report(to)
        return to


def _parse(file: str, data: bytes) -> list[AccountedMap]:
    """Return the models of a file, each with a group and an id of 16 bits.

    Raises `Findings` for any other content.
    """
    try:
        tree = accounted(json.loads(data.decode("utf-8-sig")))
    except json.JSONDecodeError as error:
        raise unreadable(
            file, f"not JSON: {error.msg}", "correct the file", error.lineno
        ) from None
    # `RecursionError`: deeply nested lists. `ValueError`: integers of more than 4,300
    # digits.
    except (UnicodeDecodeError, RecursionError, ValueError):
        raise unreadable(
            file, "not JSON", "a model is a JSON object with `id` and `group`"
        ) from None
    models = tree if isinstance(tree, list) else [tree]
    for model in models:
        group = model.get("group") if isinstance(model, dict) else None
        if (
            not isinstance(group, dict)
            or type(model.get("id")) is not int
            # Not 0 for negative numbers, too: their sign fills the bits from the left.
            or model["id"] >> _REGISTER
        ):
            raise unreadable(
                file,
                "not a model of SunSpec, nor a list of them",
                "a model has an `id` of 16 bits and a `group`",
            )
    if not models:
        raise unreadable(
            file, "the list holds no model", "a model has an `id` and a `group`"
        )
    return models


class _Model:
    """Conversion of a model to a message.

    ``structs`` are the structs for its repeated groups.

    ``left`` has the number of points that the file may still have. ``taken`` are names
    of structs of other models.
    """

    def __init__(
        self,
        tree: dict[str, Any],
        enums: Enumerations,
        to: Definitions,
        left: list[int],
        taken: set[str],
    ) -> None:
        self.id, self.group = int(tree["id"]), tree["group"]
        self.name = _text(self.group, "name") or f"model {self.id}"
        self.enums, self.to, self.left, self.taken = enums, to, left, taken
        self.structs: list[Item] = []
        self.scaled: list[str] = []
        self.fields: list[Item] = []  # of the message

    def message(self) -> Item:
        """Return the message.

        Reports points with the scale factor in another register. Raises `NotSupported`.
        """
        fields = self.fields
        end = self.block(self.group, fields, 0, "", 0)
        if not fields:
            raise NotSupported("it has no points")
        item: Item = {
            "name": self.name,
            "id": self.id,
            "kind": "telemetry",
            "length": end // 8,
        } | _summary(self.group)
        if self.scaled:
            shown = ", ".join(f"`{name}`" for name in self.scaled[:3]) + (
                " ..." if len(self.scaled) > 3 else ""
            )
            text = f"message `{self.name}`: the factors of {len(self.scaled)} points are in other registers: {shown}"
            self.to.warn(
                RAW_ONLY,
                text,
                "raw values are imported; their summaries name the scale factor",
                "note",
            )
        return {**item, "fields": fields}

    def block(
        self,
        group: dict[str, Any],
        fields: list[Item],
        at: int,
        before: str,
        depth: int,
    ) -> int:
        """Append the points of a group and of its nested groups to ``fields``, and
        return the bit behind them.

        A group with any number of repetitions does not count, nor does what follows it.
        Raises `NotSupported`.
        """
        if depth > _MOST_DEPTH:
            raise NotSupported(f"groups are nested more than {_MOST_DEPTH} deep")

        def append(item: Item, bits: int) -> int:
            """Append a field, and return the bit behind it."""
            if any(field.get("count") == REST for field in fields) and "up_to" in item:
                raise NotSupported(
                    f"`{item['name']}` follows a group whose repetitions no point counts"
                )
            # Behind a group of any length no field has a fixed place.
            if _is_open(fields):
                item["after"] = fields[-1]["name"]
            fields.append(item)
            return at if _is_open(fields) else at + bits

        for point in _list(group, "points"):
            item = self.point(point, before, at, is_head=not depth and at < _HEAD)
            at = append(item, item["bits"])
        for inner in _list(group, "groups"):
            if inner.get("count", 1) == 1 and type(inner.get("count", 1)) is int:
                at = self.block(
                    inner, fields, at, f"{before}{_text(inner, 'name')} ", depth + 1
                )
            else:
                item = self.repeated(inner, fields, at, before, depth)
                at = append(
                    item,
                    (
                        0
                        if "up_to" in item
                        else 8 * self.structs[-1]["length"] * item["count"]
                    ),
                )
        return at

    def repeated(
        self,
        group: dict[str, Any],
        fields: list[Item],
        at: int,
        before: str,
        depth: int,
    ) -> Item:
        """Declare a repeated group as a struct, and return the array of structs.

        Raises `NotSupported`.
        """
        # The count of a group is a number, the name of the point that has it, or 0: as
        # often as the length of the model allows.
        count, name = group["count"], _text(group, "name")
        is_open, is_inner = (
            type(count) is not int or count <= 0,
            fields is not self.fields,
        )
        if is_open and is_inner and count == 0:
            text = f"`{name}`, which has any number of repetitions, is inside another group, and no point counts them"
            raise NotSupported(text, _fixed_number_help(name, count))
        parts: list[Item] = []
        length = self.block(group, parts, 0, "", depth + 1) // 8
        if not length:
            raise NotSupported(f"`{name}` has no points")
        if _is_open(parts) and (is_inner or not is_open or count == 0):
            inner = next(part for part in parts if "up_to" in part)
            text = f"`{inner['name']}`, which has any number of repetitions, is inside `{name}`"
            why = (
                "which is inside another group"
                if is_inner
                else "whose repetitions no point counts"
            )
            raise NotSupported(
                f"{text}, {why}", _fixed_number_help(inner["name"], inner["count"])
            )
        called = f"{before}{name}"
        called = f"{self.name} {called}" if called in self.taken else called
        self.taken.add(called)
        struct: Item = {
            "name": called,
            **_summary(group),
            "length": length,
            "fields": parts,
        }
        self.structs.append(struct)
        item = {"at": at, "name": f"{before}{name}", "struct": struct["name"]}
        if not is_open:
            return {**item, "count": count}
        if count != 0 and not any(
            part["name"] == count and "after" not in part for part in self.fields
        ):
            raise NotSupported(
                f"`{name}` is counted by `{line(str(count), 60)}`, which is not in front of it"
            )
        if is_inner:
            return {**item, "count": count, "up_to": _MOST_INNER}
        longest = length + sum(
            self.size(part) for part in parts if "up_to" in part or "after" in part
        )
        most = max(1, min((_LONGEST - at // 8) // longest, MOST_ELEMENTS))
        return {**item, "count": count or REST, "up_to": most}

    def size(self, item: Item) -> int:
        """Return the most bytes of a field."""
        if "struct" not in item:
            return int(item["bits"]) // 8
        length: int = next(
            struct["length"]
            for struct in self.structs
            if struct["name"] == item["struct"]
        )
        return length * int(item.get("up_to") or item.get("count", 1))

    def point(self, point: dict[str, Any], before: str, at: int, is_head: bool) -> Item:
        """Return the field of a point.

        ``is_head``: id or length of the model. Raises `NotSupported` if it is not
        supported.
        """
        self.left[0] -= 1
        if self.left[0] < 0:
            raise NotSupported(f"the file has more than {_MOST_POINTS:,} points")
        name, type_name = f"{before}{_text(point, 'name')}", _text(point, "type")
        kind = _KINDS.get(type_name)
        size = point.get("size")
        registers = kind.registers or size if kind else 0
        if (
            kind is None
            or type(registers) is not int
            or not 0 < registers <= _MOST_REGISTERS
        ):
            sized = f" and size {size}" if kind else ""
            raise NotSupported(
                f"`{line(name, 80)}` is of the type `{line(type_name, 40)}`{sized}"
            )
        item: Item = {
            "at": at,
            "bits": _REGISTER * registers,
            "name": name,
            "type": kind.type,
        }
        # Each model has an id and a length, so 0xFFFF does not mean that they are
        # absent.
        none = _special(kind, type_name) if not is_head else {}
        symbols = _symbols(point, is_bits=type_name.startswith("bitfield"))
        if (
            type(point.get("value")) is int
            and kind.type in ("int", "uint")
            and not symbols
        ):
            item |= {"const": point["value"], **_summary(point)}
            return item
        item |= self.scale(point, name, kind)
        if symbols:
            self.enums.assign_value_names(
                item,
                item["bits"],
                symbols,
                name,
                self.name,
                f"model `{self.name}`, `{name}`",
                self.to,
            )
        if none and none["special"][0]["value"] not in symbols:
            item["special"] = [*item.pop("special", ()), *none["special"]]
        # Not a copy: `Enumerations` adds the name of the enumeration to this mapping
        # later.
        return item

    def scale(self, point: dict[str, Any], name: str, kind: _Kind) -> Item:
        """Return unit, formula and summary.

        If another register has the scale factor, the summary names unit and factor.
        """
        power, symbol, keys = point.get("sf"), _text(point, "units"), _summary(point)
        symbol = _SPELLED.get(symbol, symbol)
        if isinstance(power, str) and kind.type in ("int", "uint"):
            self.scaled.append(name)
            hint = f"{f'In {symbol} times' if symbol else 'Times'} 10 to the power of {line(power, 60)}."
            return summary(f"{keys['summary'].rstrip('. ')}. {hint}" if keys else hint)
        if kind.type not in ("int", "uint", "float"):
            return keys
        is_power = type(power) is int and -20 <= power <= 20 and kind.type != "float"
        scaled = (
            formula(printed(Decimal(10) ** power))
            if is_power and power is not None
            else {}
        )
        return {**unit(symbol), **scaled, **keys}


def _is_open(fields: list[Item]) -> bool:
    """Return whether one of the fields has any number of repetitions."""
    return any("up_to" in field for field in fields)


def _fixed_number_help(group: str, counter: object) -> str:
    """Return the help for a group that needs a fixed number of repetitions."""
    text = f"if your device always has the same number, write it into a copy of the file: as `count` of `{line(group, 60)}`"
    return (
        f"{text} and as `value` of the point `{line(counter, 60)}`"
        if isinstance(counter, str)
        else text
    )


def _symbols(point: dict[str, Any], is_bits: bool) -> dict[int, str]:
    """Return the names of values.

    The symbols of a bit field are bit numbers, which become values with this bit set.
    """
    result: dict[int, str] = {}
    for symbol in _list(point, "symbols"):
        value = symbol.get("value")
        if type(value) is int and 0 <= value < 1 << 32 and (not is_bits or value < 64):
            result.setdefault(1 << value if is_bits else value, _text(symbol, "name"))
    return result


def _special(kind: _Kind, type_name: str) -> Item:
    """Return the special value of a point type, empty if it has none."""
    if kind.none is None:
        return {}
    return {
        "special": [
            {
                "value": kind.none,
                "meaning": _NOT_COUNTED if type_name.startswith("acc") else _NONE,
            }
        ]
    }


def _summary(of: dict[str, Any]) -> dict[str, str]:
    """Return the summary of a label and a description, without the label if the
    description contains it.
    """
    label, text = _text(of, "label"), _text(of, "desc")
    is_contained = label.casefold() in text.casefold()
    if not text:
        return summary(label)
    return summary(text if is_contained else f"{label}. {text}")


def _list(of: dict[str, Any], key: str) -> Iterator[dict[str, Any]]:
    """Yield the mappings in the list of a key."""
    value = of.get(key)
    yield from (
        (entry for entry in value if isinstance(entry, dict))
        if isinstance(value, list)
        else ()
    )


def _text(of: dict[str, Any], key: str) -> str:
    """Return the text of a key on one line, empty if the key has no text."""
    value = of.get(key)
    return line(value) if isinstance(value, str) else ""
