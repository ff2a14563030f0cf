"""Build the model from the tree of a file.

Reports nothing: mappings with errors are left out of the model, and the rules in
`icdgen.icd.rules` report them.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import replace
from typing import Any

from icdgen.icd import (
    annex,
    conditions,
    curve,
    division,
    formula,
    model,
    packets,
    variable_length,
    variable_structs,
    wire_ids,
)
from icdgen.icd.derived import Derivation
from icdgen.icd.derived_values import derivation_of
from icdgen.icd.display import display_of
from icdgen.icd.errata import AppliedErrata
from icdgen.icd.layout import (
    UNDECLARED,
    Array,
    Counted,
    Derived,
    Layout,
    Orders,
    Overlay,
    PlacedNode,
    Rest,
    Scalar,
    Size,
    StructRef,
    bits_of_node,
    stride,
    struct_layout_of,
)
from icdgen.icd.layout_nodes import counter_of_rest, derived_of, overlay_of
from icdgen.icd.located import Map, plain, unread
from icdgen.icd.meanings import Special, limits, special
from icdgen.icd.trees import mappings
from icdgen.icd.units import STANDARD, Unit


class NodeScope:
    """Enumerations, structs, units and vocabulary that a node and the nodes it includes
    declare.
    """

    def __init__(self, included: Iterable[model.Node]) -> None:
        self.enums: dict[str, model.Enum] = {}
        self.structs: dict[str, model.Struct] = {}
        self.units: dict[str, Unit] = dict(STANDARD)
        self.vocabulary: list[str] = []
        for node in included:
            self.enums.update((enum.name, enum) for enum in node.enums)
            self.structs.update((struct.name, struct) for struct in node.structs)
            self.units.update((unit.symbol, unit) for unit in node.units)
            self.vocabulary += node.vocabulary


class NodeBuilder:
    """Builds one node.

    ``broken`` has the `id()` of each mapping that violates the schema; the model omits
    these.
    """

    def __init__(
        self, tree: Map, applied: AppliedErrata, broken: set[int], scope: NodeScope
    ) -> None:
        self.tree, self.applied, self.broken, self.scope = tree, applied, broken, scope
        self.name = ""

    def node(self, includes: tuple[str, ...], digest: str) -> model.Node | None:
        """Return the node; None if the mapping `node` of the file violates the schema."""
        head = self.tree.get("node")
        if not isinstance(head, Map) or id(head) in self.broken:
            return None
        self.name = head["name"]
        # Each kind of declaration enters the scope before the declarations that refer
        # to it.
        units = tuple(map(unit, self.items("units")))
        self.scope.units.update((unit.symbol, unit) for unit in units)
        enums = tuple(map(self.enum, self.items("enums")))
        self.scope.enums.update((enum.name, enum) for enum in enums)
        structs = self.structs()
        listed, protocol = self.tree.get("vocabulary"), self.tree.get("protocol")
        if isinstance(protocol, Map):
            # Before `plain` copies the section.
            packets.place_fields(protocol.get("link"))
        words = tuple(
            w
            for w in (listed if isinstance(listed, list) else ())
            if isinstance(w, str) and w.isalnum()
        )
        return model.Node(
            name=self.name,
            title=head["title"],
            summary=head.get("summary", ""),
            byte_order=head["byte_order"],
            bit_order=head["bit_order"],
            id_bits=head.get("id_bits", wire_ids.DEFAULT_BITS),
            messages=tuple(map(self.message, self.items("messages"))),
            enums=enums,
            structs=structs,
            node_type=head.get("node_type"),
            interface_version=head.get("interface_version"),
            document=tuple((k, str(v)) for k, v in (head.get("source") or {}).items()),
            includes=includes,
            vocabulary=tuple(dict.fromkeys((*self.scope.vocabulary, *words))),
            units=units,
            protocol=plain(protocol) if isinstance(protocol, Map) else {},
            loggable=tuple(map(self.loggable, self.items("loggable"))),
            missing=tuple(map(missing, self.items("missing"))),
            errata=(*self.applied.entries, *self.applied.notes),
            digest=digest,
            file=self.tree.place.file,
            source=self.tree,
        )

    def items(self, key: str, owner: Map | None = None) -> list[Map]:
        """Return the mappings listed under a key of a mapping, by default of the file,
        without broken mappings.
        """
        listed = mappings((self.tree if owner is None else owner).get(key))
        return [item for item in listed if id(item) not in self.broken]

    def named(self, item: Map) -> dict[str, Any]:
        """Return the attributes that all named objects of the model have."""
        return {
            "name": item["name"],
            "identifier": item.get("identifier"),
            "summary": item.get("summary", ""),
            "aliases": tuple(item.get("aliases", ())),
            "errata": self.applied.about(item),
            "source": item,
        }

    def enum(self, item: Map) -> model.Enum:
        members = tuple(map(self.member, self.items("members", item)))
        return model.Enum(
            members=members,
            table=_printed(item).get("table"),
            node=self.name,
            **self.named(item),
        )

    def member(self, item: Map) -> model.Member:
        return model.Member(value=item["value"], to=item.get("to"), **self.named(item))

    def structs(self) -> tuple[model.Struct, ...]:
        """Return the structs of the node, each after the structs that it contains."""
        listed = self.items("structs")
        # Reversed, so that the first of several structs with one name remains in the
        # dict.
        items = {item["name"]: item for item in reversed(listed)}
        structs: list[model.Struct] = []
        visited: set[str] = set()

        def add(name: str) -> None:
            # A struct that contains itself is not visited twice: `node_of` omits its
            # field, and a rule reports the cycle.
            visited.add(name)
            for row in self.items("fields", items[name]):
                if row.get("struct") in items and row["struct"] not in visited:
                    add(row["struct"])
            structs.append(self.struct(items[name]))
            self.scope.structs[name] = structs[-1]

        for name in items:
            if name not in visited:
                add(name)
        # A rule reports duplicate names. The first struct of a name is the one that
        # fields refer to.
        structs += (
            self.struct(item) for item in listed if item is not items[item["name"]]
        )
        return tuple(structs)

    def struct(self, item: Map) -> model.Struct:
        return model.Struct(
            layout=self.struct_layout(item),
            table=_printed(item).get("table"),
            node=self.name,
            **self.named(item),
        )

    def struct_layout(self, item: Map) -> Layout:
        """Return the layout of a struct, with the nodes behind a variable-length array
        as in the longest element.
        """
        fixed, length = self.fixed_nodes(item), item["length"]
        nodes: list[PlacedNode] = []
        for row in self.sequence_of_struct(item):
            size: Size | None = row.get("count")
            if variable_length.is_variable(row):
                counter, plus = variable_length.counting(row)
                size = Counted(counter, row["up_to"], plus)
            node = self.node_of(row, 8 * length, size)
            if node is None or not stride(node):
                # Without one of the nodes, the positions of all later ones would be
                # wrong.
                return Layout(item["name"], item["length"], fixed, owner=self.name)
            nodes.append(node)
            length += bits_of_node(node) // 8
        return Layout(item["name"], length, (*fixed, *nodes), owner=self.name)

    def sequence_of_struct(self, item: Map) -> list[Map]:
        """Return the variable-length arrays of a struct and the fields behind them;
        none if one has an error.
        """
        rows, structs = variable_length.sequence_of(item), self.scope.structs
        lengths = {name: struct.length for name, struct in structs.items()}
        variable = {
            name for name, struct in structs.items() if struct.layout.inner_parts
        }
        is_valid = not any(id(row) in self.broken for row in rows)
        return (
            rows
            if is_valid
            and not any(variable_structs.faults_in_struct(item, lengths, variable))
            else []
        )

    def message(self, item: Map) -> model.Message:
        return model.Message(
            kind=item["kind"],
            layout=self.message_layout(item),
            id=_id(item, "id"),
            set_id=_id(item, "set_id"),
            get_id=_id(item, "get_id"),
            group=item.get("group", ""),
            table=_printed(item).get("table"),
            page=_printed(item).get("page"),
            acknowledge=item.get("acknowledge", True) is True,
            expects_reset=item.get("acknowledge") == "reset",
            response=item.get("response"),
            repeat=item.get("repeat", False),
            requested=item.get("requested", True),
            period_ms=item.get("period_ms"),
            hazard=item.get("hazard", ""),
            assumptions=tuple(
                (key, str(why)) for key, why in (item.get("assumptions") or {}).items()
            ),
            contains=tuple(
                model.ContainedMessage(part["message"], part["at"])
                for part in self.items("contains", item)
            ),
            reserved=item.get("reserved", 0),
            may_end_early=item.get("may_end_early", ""),
            node=self.name,
            **self.named(item),
        )

    def message_layout(self, item: Map) -> Layout:
        """Return the layout of a message."""
        layout = Layout(
            name=item["name"],
            length=item["length"],
            fixed=self.fixed_nodes(item),
            sequence=self.sequence(item),
            orders=declared_orders(item),
            may_end_early="may_end_early" in item,
            owner=self.name,
        )
        # A formula can use the fields, and the derived values before it.
        for row in self.items("derived", item):
            with suppress(formula.FormulaError):
                derivation = derivation_of(row["formula"], layout.nodes)
                node = derived_node(
                    row, derivation, self.scope.units.get(row.get("unit", ""))
                )
                layout = replace(layout, derived=(*layout.derived, node))
        return layout

    def fixed_nodes(self, owner: Map) -> tuple[PlacedNode, ...]:
        """Return the nodes at fixed positions of a message or struct.

        A split field has one node per part.
        """
        nodes: list[PlacedNode] = []
        left_out = set(map(id, variable_length.sequence_of(owner)))
        fields: dict[str, Map] = {}  # by name, once a condition needs them
        for item in self.items("fields", owner):
            is_broken = any(
                id(item.get(key)) in self.broken for key in ("when", "count", "size")
            )
            # Fields behind a variable-length field have no fixed bit: `sequence`
            # returns them.
            if is_broken or variable_length.is_variable(item) or id(item) in left_out:
                continue
            if "when" in item and item.keys().isdisjoint(("struct", "count")):
                fields = fields or conditions.fields_by_name(owner)
                present_if = conditions.conditions_of(fields, item, self.scope.enums)
                nodes.append(
                    _overlaid(
                        replace(self.scalar(item, item["at"]), present_if=present_if),
                        item,
                    )
                )
            elif "struct" in item or "count" in item or "bitfields" not in item:
                node = self.node_of(item, item["at"], item.get("count"))
                nodes += () if node is None else (node,)
            else:
                # A split field is replaced by its parts.
                nodes += self.parts_of_split_field(owner, item)
        return tuple(nodes)

    def parts_of_split_field(self, owner: Map, item: Map) -> Iterator[PlacedNode]:
        """Yield the parts of a split field at their positions in the frame; the field
        itself if it cannot be split.
        """
        head = self.tree["node"]
        declared = orders(item, orders(owner))
        effective = declared[0] or head["byte_order"], declared[1] or head["bit_order"]
        parts = division.parts_of(item)
        if (
            not parts
            or any(id(part) in self.broken for part in parts)
            or any(division.faults(item, *effective))
        ):
            yield _overlaid(self.scalar(item, item["at"]), item)
            return
        for part in parts:
            scalar = replace(
                self.scalar(part, division.first_bit_of_part(item, part, *effective)),
                summary=division.summary_of_part(item, part),
                orders=Orders(*orders(part, orders(item))),
                errata=self.applied.about(item),
            )
            yield _overlaid(scalar, part)

    def sequence(self, message: Map) -> tuple[PlacedNode, ...]:
        """Return the nodes of variable length and those behind them; an empty tuple if
        one has an error, because their positions are dependent.
        """
        items = variable_length.sequence_of(message)
        lengths = {name: struct.length for name, struct in self.scope.structs.items()}
        counters = [
            variable_length.counter_of(message, item)
            for item in filter(variable_length.is_variable, items)
        ]
        if any(id(item) in self.broken for item in (*items, *counters)):
            return ()
        if any(any(variable_length.faults(message, item, lengths)) for item in items):
            return ()
        structs = {name: struct.source for name, struct in self.scope.structs.items()}
        uses = (item for item in items if "struct" in item)
        if any(
            any(variable_structs.faults_of_inner_counts(message, item, structs))
            for item in uses
        ):
            return ()
        nodes: list[PlacedNode] = []
        for item in items:
            size: Size | None = item.get("count")
            if variable_length.is_variable(item):
                size = self.variable_size(message, item)
            node = self.node_of(item, item["at"], size)
            if node is None or not stride(node) or _is_without_fields(node):
                return ()
            nodes.append(node)
        return tuple(nodes)

    def variable_size(self, message: Map, item: Map) -> Counted | Rest:
        """Return the size of a variable-length field of a message."""
        counter = variable_length.counter_of(message, item)
        if counter is not None:
            plus = variable_length.counting(item).plus
            return Counted(counter["name"], item["up_to"], plus)
        most, is_array = item["up_to"], "count" in item
        identifier = item.get("identifier")
        return Rest(
            counter_of_rest(item["name"], identifier, is_array, most, item), most
        )

    def node_of(self, item: Map, at: int, size: Size | None) -> PlacedNode | None:
        """Return the node of a line; None if it refers to an unknown struct, or to one
        of variable length without a counter.

        With a size, the node is an array, or bytes or text of variable length.
        """
        is_array = size is not None and "count" in item
        node: Scalar | StructRef
        if "struct" in item:
            struct = self.scope.structs.get(item["struct"])
            if struct is None or (
                struct.layout.inner_parts and not isinstance(size, Counted)
            ):
                return None
            node = StructRef(
                layout=struct.layout, at=0 if is_array else at, **self.named(item)
            )
        else:
            node = self.scalar(item, 0 if is_array else at)
            if isinstance(size, Counted | Rest) and "size" in item:
                node = replace(node, bits=8, length=size)
        if size is not None and is_array:
            return Array(
                at=at, item=node, size=size, orders=node.orders, **self.named(item)
            )
        return _overlaid(node, item) if isinstance(node, Scalar) else node

    def scalar(self, item: Map, at: int) -> Scalar:
        """Return the scalar of a line that begins at bit `at` of its layout or array
        element.
        """
        get = item.get
        kind = get("type", "uint")  # optional for parts of a split field
        scale, curve = (
            calibration(get("formula"), kind)
            if "points" not in item
            else (None, table(item, kind))
        )
        return Scalar(
            at=at,
            bits=get("bits", 0),  # variable-length bytes and text have no `bits`
            type=kind,
            enum=self.scope.enums.get(get("enum", "")) if kind == "enum" else None,
            unit=self.scope.units.get(get("unit", "")),
            formula=get("formula", ""),
            scale=scale,
            curve=curve,
            const=get("const"),
            special=self.special(item, kind) if "special" in item else (),
            limits=limits(item),
            display=display_of(get("display")),
            orders=declared_orders(item),
            **self.named(item),
        )

    def special(self, item: Map, kind: str) -> tuple[Special, ...]:
        """Return the special values of a field, without values that its type cannot
        represent.
        """
        bits = item.get("bits", 0)
        values = (
            special(kind, bits, row["value"], row["meaning"])
            for row in self.items("special", item)
        )
        return tuple(value for value in values if value is not None)

    def loggable(self, item: Map) -> annex.Loggable:
        errata = self.applied.about(item)
        return annex.Loggable(
            item["bit"], wire_ids.number(item["id"]), item.get("name", ""), errata, item
        )


def unit(item: Map) -> Unit:
    """Return a unit that the file declares."""
    return Unit(
        item["symbol"], item["identifier"], item["quantity"], item.get("summary", "")
    )


def missing(item: Map) -> annex.Missing:
    """Return an entry of `missing`: a message that the manual names but does not
    describe.
    """
    return annex.Missing(
        item["kind"], wire_ids.number(item["id"]), item["name"], item["why"]
    )


def _printed(item: Map) -> Map:
    """Return the table and page of the manual; an empty mapping if the ICD gives none."""
    return item.get("source") or unread()


def derived_node(row: Map, derivation: Derivation, unit: Unit | None) -> Derived:
    """Return the node of a derived value."""
    scalar = Scalar(
        name=row["name"],
        type="float",
        bits=64,
        identifier=row.get("identifier"),
        aliases=tuple(row.get("aliases", ())),
        summary=row.get("summary", ""),
        formula=row["formula"],
        display=display_of(row.get("display")),
        unit=unit,
        source=row,
    )
    return derived_of(scalar, derivation)


def _overlaid(scalar: Scalar, item: Map) -> Scalar | Overlay:
    """Return the scalar, or its overlay node if the line declares an overlay field."""
    return overlay_of(scalar) if item.get("view", False) else scalar


def _is_without_fields(node: PlacedNode) -> bool:
    """Return whether a node is a struct, or an array of structs, without readable
    fields.
    """
    struct = struct_layout_of(node)
    return struct is not None and not struct.fixed


def _id(item: Map, key: str) -> int | None:
    return wire_ids.number(item[key]) if key in item else None


def orders(item: Map, outer: tuple[str, str] = ("", "")) -> tuple[str, str]:
    """Return the byte order and bit order that a mapping declares; `outer` if it
    declares none.
    """
    return item.get("byte_order", outer[0]), item.get("bit_order", outer[1])


def declared_orders(item: Map) -> Orders:
    """Return the byte order and bit order that a mapping declares."""
    declared = orders(item)
    return Orders(*declared) if any(declared) else UNDECLARED


def calibration(
    text: str | None, kind: str
) -> tuple[formula.Scale | None, curve.Curve | None]:
    """Return the scale or the curve that the text of a formula means for a field of a
    type.

    Linear formulas of integers give an exact `Scale`; polynomials, and all formulas of
    floats, a `Curve` in doubles. Returns (None, None) without a formula or if the
    formula has an error.
    """
    if not text or kind not in ("uint", "int", "float"):
        return None, None
    # A raw float is a double at run time, so an exact scale would promise digits that
    # no language computes.
    if kind != "float":
        with suppress(formula.FormulaError):
            return formula.parse(text), None
    with suppress(formula.FormulaError):
        return None, curve.parse(text)
    return None, None


def table(item: Map, kind: str) -> curve.Curve | None:
    """Return the lookup table of a field; None if it has an error.

    Without ``outside``, no value outside is valid.
    """
    if kind not in ("uint", "int", "float"):
        return None
    with suppress(formula.FormulaError):
        return curve.table(curve.doubles(item["points"]), item.get("outside", ""))
    return None
