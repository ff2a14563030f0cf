"""Tree -> model. Silent and tolerant: what does not fit is left out here and reported by the rules."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from itertools import chain
from typing import Any

from icdgen.icd import annex, conditions, curve, derived, division, floats, formula, model, tails, wire_ids
from icdgen.icd.display import display_of
from icdgen.icd.errata import Applied
from icdgen.icd.implied import implied_count
from icdgen.icd.located import Map, plain, unread
from icdgen.icd.paths import members_of
from icdgen.icd.trees import mappings
from icdgen.icd.units import STANDARD, Unit

Orders = tuple[str, str]

_LIMITS = frozenset({"min", "max", "above", "below"})


class Scope:
    """What a node may refer to: enumerations, structs, units and vocabulary of its own and of what it includes."""

    def __init__(self, included: Iterable[model.Node]) -> None:
        self.enums: dict[str, model.Enum] = {}
        self.structs: dict[str, model.Struct] = {}
        self.units: dict[str, Unit] = dict(STANDARD)
        self.vocabulary: list[str] = []
        for node in included:
            self.enums.update((e.name, e) for e in node.enums)
            self.structs.update((one.name, one) for one in node.structs)
            self.units.update((u.symbol, u) for u in node.units)
            self.vocabulary += node.vocabulary


class Builder:
    """Builds one node. ``broken`` holds the ids of mappings that violate the schema: they are left out."""

    def __init__(self, tree: Map, applied: Applied, broken: set[int], scope: Scope) -> None:
        self.tree, self.applied, self.broken, self.scope = tree, applied, broken, scope
        self.name = ""

    def node(self, includes: tuple[str, ...], digest: str) -> model.Node | None:
        """The node, or None if its own head is broken."""
        head = self.tree.get("node")
        if not isinstance(head, Map) or id(head) in self.broken:
            return None
        self.name = head["name"]
        units = tuple(map(unit, self.items("units")))
        self.scope.units.update((u.symbol, u) for u in units)
        enums = tuple(map(self.enum, self.items("enums")))
        self.scope.enums.update((e.name, e) for e in enums)
        structs = self.structs()
        listed, protocol = self.tree.get("vocabulary"), self.tree.get("protocol")
        words = tuple(w for w in (listed if isinstance(listed, list) else ()) if isinstance(w, str) and w.isalnum())
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
        """What is listed under a key, of the file or a mapping in it, but for what is broken."""
        found = mappings((self.tree if owner is None else owner).get(key))
        return [item for item in found if id(item) not in self.broken]

    def named(self, item: Map) -> dict[str, Any]:
        """What is said in the same way of all that has a name."""
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
        return model.Enum(members=members, table=_printed(item).get("table"), node=self.name, **self.named(item))

    def member(self, item: Map) -> model.Member:
        return model.Member(value=item["value"], to=item.get("to"), **self.named(item))

    def structs(self) -> tuple[model.Struct, ...]:
        """Those of the node, each after what it has in it. Of a circle, none has the next in it: it is a finding."""
        listed = self.items("structs")
        items = {item["name"]: item for item in reversed(listed)}
        made: list[model.Struct] = []
        begun: set[str] = set()

        def make(name: str) -> None:
            begun.add(name)
            for row in self.items("fields", items[name]):
                if row.get("struct") in items and row["struct"] not in begun:
                    make(row["struct"])
            made.append(self.struct(items[name]))
            self.scope.structs[name] = made[-1]

        for name in items:
            if name not in begun:
                make(name)
        made += (self.struct(item) for item in listed if item is not items[item["name"]])  # names that are there twice
        return tuple(made)

    def struct(self, item: Map) -> model.Struct:
        return model.Struct(
            length=item["length"],
            fields=self.all_fields(item),
            table=_printed(item).get("table"),
            node=self.name,
            **self.named(item),
        )

    def message(self, item: Map) -> model.Message:
        fields = self.all_fields(item)
        parts, ends = self.open_parts(item)
        for part in parts:
            fields = part.counted_in(fields)
        fields += ends
        length = item["length"] + sum(part.most * part.step for part in parts)
        return model.Message(
            kind=item["kind"],
            length=length,
            fields=self.with_derived(fields, length, item) if "derived" in item else fields,
            id=_id(item, "id"),
            set_id=_id(item, "set_id"),
            get_id=_id(item, "get_id"),
            group=item.get("group", ""),
            table=_printed(item).get("table"),
            page=_printed(item).get("page"),
            acknowledge=item.get("acknowledge", True) is True,
            expects_reset=item.get("acknowledge") == "reset",
            hazard=item.get("hazard", ""),
            assumptions=tuple((key, str(why)) for key, why in (item.get("assumptions") or {}).items()),
            contains=tuple(model.Part(part["message"], part["at"]) for part in self.items("contains", item)),
            reserved=item.get("reserved", 0),
            tail=parts[-1] if parts else None,
            inner=parts[:-1],
            may_end_early=item.get("may_end_early", ""),
            node=self.name,
            **self.named(item),
        )

    def with_derived(self, fields: tuple[model.Field, ...], length: int, message: Map) -> tuple[model.Field, ...]:
        """The fields, then what is derived from them, but for what cannot be."""
        for item in self.items("derived", message):
            with suppress(formula.FormulaError):
                how = derived.of_fields(item["formula"], members_of(fields))
                unit = self.scope.units.get(item.get("unit", ""))
                fields += (derived_field(how, length, item, unit),)
        return fields

    def open_parts(self, message: Map) -> tuple[tuple[model.Tail, ...], tuple[model.Field, ...]]:
        """What is open in a message, and its fields: the elements, and how many there are where no field says so."""
        items = tails.open_parts(message)
        known = {name: one.length for name, one in self.scope.structs.items()}
        read = (*items, *(tails.counter_of(message, item) for item in items))
        if any(id(one) in self.broken for one in read) or any(
            any(tails.obstacles(message, one, known)) for one in items
        ):
            return (), ()
        parts: tuple[model.Tail, ...] = ()
        fields: tuple[model.Field, ...] = ()
        begin = message["length"]
        for item in items:
            own = self.elements(message, item, begin)
            bits, counter = tails.unit(item, known), tails.counter_of(message, item)
            if not bits or not own:
                return (), ()  # there is no such struct, or nothing of it can be read
            name, plus = counter["name"] if counter else own[-1].name, tails.counting(item).plus
            is_last = item is items[-1]
            parts += (model.Tail(item["name"], name, bits // 8, item["up_to"], plus, 0 if is_last else begin),)
            fields, begin = fields + own, begin + item["up_to"] * bits // 8
        return parts, fields

    def elements(self, message: Map, item: Map, begin: int) -> tuple[model.Field, ...]:
        """All elements of an open part that begins at a byte; behind them how many there are, where no field says so."""
        most, struct = item["up_to"], self.scope.structs.get(item.get("struct", ""))
        end = self.field(item, orders(message)) if struct is None else self.standing(item, struct, orders(message))
        end = replace(end, at=8 * begin, **({"bits": 8 * most} if "size" in item else {"count": most}))
        if not end.elements or tails.counter_of(message, item) is not None:
            return end.elements
        return (*end.elements, implied_count(end, begin + most * (end.bits // 8 if "size" not in item else 1)))

    def all_fields(self, owner: Map) -> tuple[model.Field, ...]:
        """Those of a message or a struct, but for what is open."""
        return tuple(chain.from_iterable(self.fields(owner, item) for item in self.items("fields", owner)))

    def fields(self, message: Map, item: Map) -> tuple[model.Field, ...]:
        """The field, the elements of an array, the fields of a struct, or the parts that it is divided into."""
        around = orders(message)
        if tails.is_open(item) or any(id(item.get(key)) in self.broken for key in ("when", "count", "size")):
            return ()  # see `tail`
        if "when" in item and item.keys().isdisjoint(("struct", "count")):
            return (replace(self.field(item, around), when=conditions.of(message, item, self.scope.enums)),)
        if "struct" in item:
            struct = self.scope.structs.get(item["struct"])
            return () if struct is None else self.standing(item, struct, around).elements
        if "count" in item:
            return replace(self.field(item, around), count=item["count"]).elements
        if "bitfields" not in item:
            return (self.field(item, around),)
        parts = division.parts_of(item)
        own, head = orders(item, around), self.tree["node"]
        used = own[0] or head["byte_order"], own[1] or head["bit_order"]
        if not parts or any(id(p) in self.broken for p in parts) or any(division.obstacles(item, *used)):
            return (self.field(item, around),)
        errata = self.applied.about(item)
        return tuple(
            replace(
                self.field(part, own),
                at=division.place(item, part, *used),
                summary=division.described(item, part),
                errata=errata,
            )
            for part in parts
        )

    def standing(self, item: Map, struct: model.Struct, around: Orders) -> model.Field:
        """A struct where it stands."""
        return model.Field(
            at=item["at"],
            bits=struct.length * 8,
            type="struct",
            byte_order=around[0],
            bit_order=around[1],
            count=count if isinstance(count := item.get("count", 0), int) else 0,
            struct=struct,
            **self.named(item),
        )

    def field(self, item: Map, around: Orders) -> model.Field:
        get = item.get
        kind = get("type", "uint")  # which parts of a field need not say
        byte_order, bit_order = orders(item, around)
        scale, line = calibration(get("formula"), kind) if "points" not in item else (None, table(item, kind))
        return model.Field(
            at=item["at"],
            bits=get("bits", 0),  # open bytes and text: `tail` knows
            type=kind,
            enum=self.scope.enums.get(get("enum", "")) if kind == "enum" else None,
            unit=self.scope.units.get(get("unit", "")),
            formula=get("formula", ""),
            scale=scale,
            curve=line,
            const=get("const"),
            special=self.special(item, kind) if "special" in item else (),
            limits=limits(item),
            display=display_of(get("display")),
            byte_order=byte_order,
            bit_order=bit_order,
            view=get("view", False),
            **self.named(item),
        )

    def special(self, item: Map, kind: str) -> tuple[model.Special, ...]:
        """The values with a meaning of a field of a type, but what it cannot hold."""
        bits = item.get("bits", 0)
        found = (special(kind, bits, one["value"], one["meaning"]) for one in self.items("special", item))
        return tuple(one for one in found if one is not None)

    def loggable(self, item: Map) -> annex.Loggable:
        errata = self.applied.about(item)
        return annex.Loggable(item["bit"], wire_ids.number(item["id"]), item.get("name", ""), errata, item)


def unit(item: Map) -> Unit:
    """A unit that the file declares."""
    return Unit(item["symbol"], item["identifier"], item["quantity"], item.get("summary", ""))


def missing(item: Map) -> annex.Missing:
    """A message that the manual does not describe."""
    return annex.Missing(item["kind"], wire_ids.number(item["id"]), item["name"], item["why"])


def _printed(item: Map) -> Map:
    """Where the manual prints it."""
    return item.get("source") or unread()


def derived_field(how: derived.Derivation, length: int, item: Map, unit: Unit | None) -> model.Field:
    """What is derived in a message of so many bytes: a double that lies behind them."""
    return model.Field(
        name=item["name"],
        at=8 * length,
        bits=64,
        type="float",
        identifier=item.get("identifier"),
        unit=unit,
        formula=item["formula"],
        display=display_of(item.get("display")),
        summary=item.get("summary", ""),
        aliases=tuple(item.get("aliases", ())),
        view=True,
        derived=how,
        source=item,
    )


def _id(item: Map, key: str) -> int | None:
    return wire_ids.number(item[key]) if key in item else None


def orders(item: Map, around: Orders = ("", "")) -> Orders:
    """Byte order and bit order that a mapping gives, or else the mapping around it."""
    return item.get("byte_order", around[0]), item.get("bit_order", around[1])


def calibration(text: str | None, kind: str) -> tuple[formula.Scale | None, curve.Curve | None]:
    """What a field of a type makes of the text of a formula: of integers a line is a scale, the rest are curves.

    Nothing where there is no formula, or a bad one.
    """
    if not text or kind not in ("uint", "int", "float"):
        return None, None
    if kind != "float":
        with suppress(formula.FormulaError):
            return formula.parse_cached(text), None
    with suppress(formula.FormulaError):
        return None, curve.parse_cached(text)
    return None, None


def table(item: Map, kind: str) -> curve.Curve | None:
    """The table of points of a field of a type; nothing where it is bad. Without ``outside``, nothing is."""
    if kind not in ("uint", "int", "float"):
        return None
    with suppress(formula.FormulaError):
        return curve.table(curve.doubles(item["points"]), item.get("outside", ""))
    return None


def special(kind: str, bits: int, value: int | float | str, meaning: str) -> model.Special | None:
    """A value with a meaning; None if a field of the type has no such value."""
    if kind != "float":
        return model.Special(value, meaning) if isinstance(value, int) else None
    raw = float_bits(value, bits)
    return None if raw is None else model.Special(raw, meaning, floats.text_of(floats.value_of(raw, bits), bits))


def float_bits(value: int | float | str, bits: int) -> int | None:
    """The bits of what an ICD says is the value of a float of that width; None if that is none."""
    if bits not in floats.WIDTHS or (isinstance(value, str) and value not in floats.NAMED):
        return None
    with suppress(OverflowError):
        return (
            floats.bits_of(floats.NAMED[value], bits) if isinstance(value, str) else floats.nearest(exact(value), bits)
        )
    return None


def limits(item: Map) -> model.Limits | None:
    """The limits of a field, exact: 0.1 is one tenth."""
    if _LIMITS.isdisjoint(item):
        return None
    return model.Limits(**{key: exact(item[key]) for key in _LIMITS & item.keys()})


def exact(number: int | float) -> Fraction:
    """The number as it is written."""
    return Fraction(number) if isinstance(number, int) else Fraction(repr(number))
