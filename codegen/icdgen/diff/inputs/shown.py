"""Reader of the output of ``icdgen show --format json``, into ICDs.

This is the inverse of `icdgen.show.machine`. The ICDs refer to places in the JSON text,
so that a comparison can point to them.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any, TypeVar

from icdgen.diagnostics import Finding, Findings, Place
from icdgen.diff.inputs.side import ComparisonSide
from icdgen.errors import UserError, unreadable
from icdgen.icd import annex, curve, model, schema, source
from icdgen.icd.build import derived_node
from icdgen.icd.derived_values import derivation_of
from icdgen.icd.display import display_of
from icdgen.icd.formula import FormulaError, Scale
from icdgen.icd.layout import (
    Array,
    Counted,
    Layout,
    Orders,
    PlacedNode,
    Rest,
    Scalar,
    Size,
    StructRef,
)
from icdgen.icd.layout_nodes import counter_of_rest, overlay_of
from icdgen.icd.located import Map, Seq, plain
from icdgen.icd.units import STANDARD, Unit
from icdgen.show import machine

Thing = TypeVar("Thing")
_MOST = 64_000_000  # bytes


def is_shown(path: Path) -> bool:
    """Return whether the first character of the file is that of a JSON object."""
    try:
        with open(path, "rb") as file:
            return file.read(200).lstrip(b"\xef\xbb\xbf \t\r\n")[:1] == b"{"
    except OSError:
        return False


def from_file(path: Path) -> ComparisonSide:
    """Return the ICDs in a file.

    Raises `UserError` or `Findings` if it is no valid output.
    """
    try:
        with open(path, "rb") as file:
            data = file.read(_MOST + 1)
    except OSError as error:
        raise unreadable(path, error) from None
    return from_bytes(data, str(path))


def from_stdin() -> ComparisonSide:
    """Return the ICDs in standard input.

    Raises `UserError` or `Findings` if it is no valid output.
    """
    if sys.stdin is None:
        raise UserError(
            "standard input is closed",
            "pipe the output of `icdgen show --format json` in, or name a file",
        )
    return from_bytes(sys.stdin.buffer.read(_MOST + 1), "standard input")


def from_bytes(data: bytes, name: str) -> ComparisonSide:
    """Return the shown ICDs with places in this output."""
    if len(data) > _MOST:
        raise UserError(
            f"{name} has more than the {_MOST:,} bytes allowed", "show fewer ICDs"
        )
    tree = _tree(data, name)
    _check(tree, name)
    nodes: list[model.Node] = []
    for item in tree["nodes"]:
        # Nodes are read in order, so an included node must come first.
        for index, include in enumerate(item["includes"]):
            if all(node.name != include for node in nodes):
                place = item["includes"].item_at(index)
                text = f"`{item['name']}` includes `{include}`, which is not shown before it"
                raise Findings([Finding("ICD004", text, place, _HELP)])
        nodes.append(_ShownNodeReader(nodes).node(item))
    return ComparisonSide(
        name, model.Icd(tuple(nodes)), texts={name: data.decode("utf-8", "replace")}
    )


def _tree(data: bytes, name: str) -> Map:
    try:
        # JSON is valid YAML, and this reader records places
        return source.parse(data, name)
    except Findings:
        pass
    try:
        tree = json.loads(data)
    except (ValueError, RecursionError) as error:
        at = (getattr(error, "lineno", 1), getattr(error, "colno", 1))
        finding = Finding(
            "ICD001",
            f"not JSON: {getattr(error, 'msg', error)}",
            Place(name, *at),
            _HELP,
        )
        raise Findings([finding]) from None
    placed: Map = _placed(tree, Place(name))
    return placed


_HELP = "this should be what `icdgen show --format json` prints"


def _placed(value: Any, place: Place) -> Any:
    """Return the tree with one common place, for JSON that the YAML reader does not
    accept.
    """
    if isinstance(value, dict):
        mapping = Map(place)
        for key, item in value.items():
            mapping[key] = _placed(item, place)
            mapping.spots[key] = place, place
        return mapping
    if isinstance(value, list):
        row = Seq(place)
        row.extend(_placed(item, place) for item in value)
        row.spots = [place] * len(row)
        return row
    return value


def _check(tree: Any, name: str) -> None:
    import jsonschema_rs

    validator = jsonschema_rs.validator_for(
        json.loads(machine.SCHEMA.read_text(encoding="utf-8"))
    )
    for error in validator.iter_errors(tree):
        path = list(error.instance_path)
        place = schema.locate(tree, path)[2] if isinstance(tree, Map) else Place(name)
        what = f"`{'.'.join(map(str, path))}`: " if path else ""
        raise Findings(
            [Finding("ICD010", f"{what}{error.message[:200]}", place, _HELP)]
        )


class _ShownNodeReader:
    """Reader of one node; included nodes are read before it."""

    def __init__(self, before: list[model.Node]) -> None:
        self.before = before
        self.enums: dict[str, model.Enum] = {}
        self.structs: dict[str, model.Struct] = {}
        self.units: dict[str, Unit] = dict(STANDARD)
        self.errata: dict[str, model.Erratum] = {}

    def node(self, item: Map) -> model.Node:
        get = item.get
        for node in model.closure(self.before, item["includes"]):
            self.enums.update((enum.name, enum) for enum in node.enums)
            self.structs.update((struct.name, struct) for struct in node.structs)
            self.units.update((unit.symbol, unit) for unit in node.units)
        units = tuple(
            Unit(u["symbol"], u["identifier"], u["quantity"], u.get("summary", ""))
            for u in get("units", ())
        )
        self.units.update((unit.symbol, unit) for unit in units)
        self.errata = {
            entry["id"]: _erratum(entry)
            for key in ("errata", "notes")
            for entry in get(key, ())
        }
        enums = tuple(self.enum(enum, item["name"]) for enum in item["enums"])
        self.enums.update((enum.name, enum) for enum in enums)
        structs = []
        # Structs are sorted: nested structs come first
        for struct in get("structs", ()):
            structs.append(self.struct(struct, item["name"]))
            self.structs[structs[-1].name] = structs[-1]
        return model.Node(
            **{"summary": "", **_plain_values(model.Node, item)},
            messages=tuple(self.message(m, item["name"]) for m in item["messages"]),
            enums=enums,
            structs=tuple(structs),
            document=tuple(get("document", {}).items()),
            includes=tuple(item["includes"]),
            vocabulary=tuple(get("vocabulary", ())),
            units=units,
            protocol=plain(get("protocol", {})),
            loggable=tuple(self.row(annex.Loggable, row) for row in item["loggable"]),
            missing=tuple(
                annex.Missing(**_plain_values(annex.Missing, entry))
                for entry in get("missing", ())
            ),
            errata=tuple(self.errata.values()),
            file=item.place.file,
            source=item,
        )

    def about(self, item: Map) -> tuple[model.Erratum, ...]:
        """Return the errata and notes that are about an object."""
        ids = (*item.get("errata", ()), *item.get("notes", ()))
        return tuple(self.errata[id] for id in ids if id in self.errata)

    def row(self, kind: Callable[..., Thing], item: Map, /, **more: object) -> Thing:
        """Return an object with its plain attributes and errata; ``more``: other
        attributes.
        """
        if "aliases" in item:
            more["aliases"] = tuple(item["aliases"])
        return kind(
            **_plain_values(kind, item), errata=self.about(item), source=item, **more
        )

    def enum(self, item: Map, node: str) -> model.Enum:
        members = tuple(self.row(model.Member, member) for member in item["members"])
        return self.row(model.Enum, item, members=members, node=node)

    def layout(self, item: Map, node: str) -> Layout:
        """Return the layout of a message or struct."""
        parts = [*item.get("inner", ()), item["tail"]] if "tail" in item else []
        variable = {part["part"]: part for part in parts}
        nodes = {
            field["name"]: self.layout_node(field, variable.get(field["name"]))
            for field in item["fields"]
        }
        # The sequence begins with the first variable-length field.
        first = next(
            (index for index, name in enumerate(nodes) if name in variable), len(nodes)
        )
        in_order = tuple(nodes.values())
        behind = sum(
            part["most"] * part["step"] + part.get("behind", 0) for part in parts
        )
        layout = Layout(
            name=item["name"],
            length=item["length"] - behind,
            fixed=in_order[:first],
            sequence=in_order[first:],
            may_end_early="may_end_early" in item,
            owner=node,
        )
        for row in item.get("derived", ()):
            try:
                derivation = derivation_of(row["formula"], layout.nodes)
            except FormulaError as error:
                text = f"`formula` cannot be used: {error}"
                raise Findings(
                    [Finding("ICD010", text, row.at("formula"), _HELP)]
                ) from None
            node_of_row = derived_node(
                row, derivation, self.units.get(row.get("unit", ""))
            )
            layout = replace(layout, derived=(*layout.derived, node_of_row))
        return layout

    def message(self, item: Map, node: str) -> model.Message:
        message: model.Message = self.row(
            model.Message,
            item,
            layout=self.layout(item, node),
            acknowledge=item.get("acknowledge", True) is True,
            expects_reset=item.get("acknowledge") == "reset",
            response=item.get("response"),
            repeat=item.get("repeat", False),
            requested=item.get("requested", True),
            contains=tuple(
                model.ContainedMessage(part["message"], part["offset"])
                for part in item.get("contains", ())
            ),
            node=node,
        )
        return message

    def struct(self, item: Map, node: str) -> model.Struct:
        struct: model.Struct = self.row(
            model.Struct, item, layout=self.layout(item, node), node=node
        )
        return struct

    def layout_node(self, item: Map, part: Map | None) -> PlacedNode:
        """Return the node of a field.

        ``part``: shown size of a variable-length field.
        """
        is_array = "count" in item
        at = 0 if is_array else item["offset"]
        size: Size = item.get("count", 0)
        if part is not None:
            size = self.size(item, part)
        elif "counter" in item:
            size = Counted(item["counter"], item["count"], item.get("plus", 0))
        orders = Orders(item.get("byte_order", ""), item.get("bit_order", ""))
        node: Scalar | StructRef
        if "struct" in item:
            node = self.row(
                StructRef,
                item,
                at=at,
                orders=orders,
                layout=self.structs[item["struct"]].layout,
            )
        else:
            node = self.scalar(
                item, at, orders, None if is_array or isinstance(size, int) else size
            )
        if is_array:
            return self.row(
                Array, item, at=item["offset"], orders=orders, item=node, size=size
            )
        return (
            overlay_of(node)
            if item.get("view", False) and isinstance(node, Scalar)
            else node
        )

    def size(self, item: Map, part: Map) -> Counted | Rest:
        """Return the size of a variable-length field."""
        if "counter" in part:
            return Counted(part["counter"], part["most"], part.get("plus", 0))
        name, identifier, most = item["name"], item.get("identifier"), part["most"]
        return Rest(
            counter_of_rest(name, identifier, "count" in item, most, item), most
        )

    def scalar(
        self, item: Map, at: int, orders: Orders, length: Counted | Rest | None
    ) -> Scalar:
        """Return the scalar of a field or of an array element."""
        limits = {key: Fraction(value) for key, value in item.get("limits", {}).items()}
        scalar = self.row(
            Scalar,
            item,
            at=at,
            orders=orders,
            length=length,
            enum=self.enums.get(item.get("enum", "")),
            unit=self.units.get(item.get("unit", "")),
            scale=_scale(item),
            curve=_curve(item),
            special=tuple(
                model.Special(**_plain_values(model.Special, special))
                for special in item.get("special", ())
            ),
            display=display_of(item.get("display")),
            limits=model.Limits(**limits) if "limits" in item else None,
            present_if=tuple(
                model.Condition(name, tuple(values))
                for name, values in item.get("when", {}).items()
            ),
        )
        return scalar if length is None else replace(scalar, bits=8)


def _plain_values(kind: object, item: Map) -> dict[str, Any]:
    return {name: item[name] for name in machine.plain_attributes(kind) if name in item}


def _curve(item: Map) -> curve.Curve | None:
    try:
        return curve.curve_of_plain(item)
    except FormulaError as error:
        raise Findings(
            [
                Finding(
                    "ICD010",
                    f"`points` cannot be used: {error}",
                    item.at("points"),
                    _HELP,
                )
            ]
        ) from None


def _scale(item: Map) -> Scale | None:
    if "scale" not in item:
        return None
    factor = Fraction(item["scale"])
    if factor == 0:
        raise Findings(
            [Finding("ICD010", "`scale` cannot be 0", item.at("scale"), _HELP)]
        )
    return Scale(factor, Fraction(item.get("scale_offset", "0")))


def _erratum(item: Map) -> model.Erratum:
    is_note = "what" in item
    return model.Erratum(
        **{"confidence": "", **_plain_values(model.Erratum, item)},
        why=item["what" if is_note else "why"],
        tables=tuple(item.get("tables", ())),
        printed=tuple(item.get("printed", {}).items()),
        held=tuple(item.get("held", {}).items()),
        changes=item.get("changes", False),
        is_note=is_note,
        source=item,
    )
