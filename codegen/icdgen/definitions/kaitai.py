"""Reader of Kaitai Struct definitions (.ksy).

The `seq` of a format becomes one message for each combination of its conditional
branches.
"""

from __future__ import annotations

import re
from collections import Counter

from icdgen.definitions.accounting import Account, accounted
from icdgen.definitions.containers import (
    bits_of_counted,
    in_sequence,
    variable_field,
)
from icdgen.definitions.frames import ORDERS, usual_order
from icdgen.definitions.kaitai_layout import KaitaiLayout
from icdgen.definitions.kaitai_parts import File, KaitaiPart, Key, Undecided
from icdgen.definitions.kaitai_types import KaitaiType, declare_types, mapping
from icdgen.definitions.kaitai_yaml import parse
from icdgen.definitions.model import (
    Definitions,
    Item,
    Network,
    NotSupported,
    replace_keys,
)
from icdgen.definitions.reading import TooMuch
from icdgen.definitions.wording import line, node_name, shortest, summary

MOST_MESSAGES = 256  # of a file; each independent condition doubles their number
_META = re.compile(
    r"^meta:[ \t]*(?:#.*)?\r?\n(?:[ \t]*(?:#.*)?\r?\n)*[ \t]+\w", re.MULTILINE
)
_BODY = re.compile(r"^(?:seq|types|instances|enums|doc):", re.MULTILINE)
# Keys whose children are user-defined names.
_NAMED = frozenset({"types", "instances", "enums"})
# Keys for collections of formats and for the compiler, without effect on the layout.
_WITHOUT_EFFECT = frozenset(
    f"meta.{key}"
    for key in (
        "license",
        "xref",
        "tags",
        "application",
        "file-extension",
        "ks-version",
        "ks-debug",
        "ks-opaque-types",
    )
)
# Characters; identifiers of the generated code that contain a longer name may be too
# long.
_LONGEST_NAME = 40
# Placeholder: a format of Kaitai Struct has no message id outside its data.
_ID, _ID_BITS = 1, 8


class Kaitai:
    """Reader of `ksy` files: the part of the language that gives fields fixed
    positions, without computed layouts.
    """

    name = "ksy"
    title = "a format of Kaitai Struct"
    needs: tuple[str, ...] = ()

    def knows(self, start: str) -> bool:
        return _META.search(start) is not None and _BODY.search(start) is not None

    def read(self, file: str, data: bytes) -> Definitions:
        """Return the messages, structs and enumerations of a .ksy file.

        Raises `Findings` if the file is not YAML, or not a Kaitai Struct definition.
        """
        body = accounted(parse(file, data), _NAMED)
        to = Definitions(file)
        shared = File(to)
        meta = mapping(body, "meta")
        name = str(meta.get("id") or node_name(file))
        layouts = _messages(declare_types(name, body), shared)
        order = usual_order(
            part.place for layout in layouts for part in layout.parts if part.is_ordered
        )
        network = Network(
            node_name(file),
            line(str(meta.get("title") or name), 100),
            {**ORDERS[order]},
        )
        network.head["id_bits"] = _ID_BITS
        for struct in shared.structs.values():
            head = {key: struct[key] for key in ("name", "length")}
            network.structs.append({**head, "fields": _fields(struct["parts"], order)})
        for layout, called in zip(layouts, _names(name, layouts), strict=True):
            if not any(part.is_whole for part in layout.parts):
                to.left_out(
                    called,
                    (
                        "none of its fields is"
                        if layout.parts
                        else "it has no `seq`, and so no field"
                    ),
                )
                continue
            item: Item = {
                "name": called,
                "id": _ID,
                "kind": "telemetry",
                "length": layout.length,
            }
            item |= summary(str(body.get("doc") or "")) if len(layouts) == 1 else {}
            network.messages.append({**item, "fields": _fields(layout, order)})
        network.declare(shared.enums.declared())
        to.networks.append(network)
        account = Account(_WITHOUT_EFFECT)
        account.mappings(body)
        account.report(to)
        return to


def _messages(root: KaitaiType, shared: File) -> list[KaitaiLayout]:
    """Return a layout for each combination of branches (`if`, `switch-on`), in the
    order of the file.

    Walks the type again with one more decision whenever the layout depends on a value
    that is not decided yet.
    """
    result: list[KaitaiLayout] = []
    left: list[dict[Key, int | None]] = [{}]
    while left:
        decided = left.pop()
        layout = KaitaiLayout(shared, decided)
        try:
            layout.read(root)
        except Undecided as asked:
            left += [
                {**decided, asked.key: option} for option in reversed(asked.options)
            ]
            continue
        except NotSupported as why:
            shared.to.total += 1
            shared.to.left_out(root.name, why)
            if isinstance(why, TooMuch):
                break
            continue
        shared.to.total += 1
        result.append(layout)
        if len(result) >= MOST_MESSAGES and left:
            shared.to.total += 1
            shared.to.left_out(
                root.name,
                f"it branches in more than {MOST_MESSAGES} ways; the others are not imported",
            )
            break
    return result


def _names(name: str, layouts: list[KaitaiLayout]) -> list[str]:
    """Return a distinct name for each layout: the name of the format and the labels of
    its branches.

    Repeated names include the values of the branches. Names that are still repeated, or
    too long, get a number instead.
    """
    words = [
        " ".join([name, *(label.word for label in layout.labels if label.word)])
        for layout in layouts
    ]
    times = Counter(words)
    candidates = [
        text if times[text] == 1 else _name_with_values(name, layout)
        for text, layout in zip(words, layouts, strict=True)
    ]
    times = Counter(candidates)
    result = []
    for number, (text, layout) in enumerate(zip(candidates, layouts, strict=True), 1):
        last = next((label.word for label in reversed(layout.labels) if label.word), "")
        if times[text] > 1 or len(text) > _LONGEST_NAME:
            text = (
                f"{name} {last} {number}"
                if last and len(name) + len(last) <= _LONGEST_NAME
                else f"{name} {number}"
            )
        result.append(line(text, 200))
    return result


def _name_with_values(name: str, layout: KaitaiLayout) -> str:
    """Return the name of the format, with words and values of the branches."""
    labels = (f"{label.word} {label.value}".strip() for label in layout.labels)
    return " ".join([name, *labels])


def _fields(layout: KaitaiLayout, order: str) -> list[Item]:
    """Return the fields of a layout.

    A part of which only some bits are decided becomes several fields, and an overlay
    field (`view`) for the complete value.
    """
    fields: list[Item] = []
    called = shortest([part.path for part in layout.parts])
    names = {id(part): name for part, name in zip(layout.parts, called, strict=True)}
    for part in layout.parts:
        item, name = part.item, names[id(part)]
        if not part.bits:
            behind = layout.at - part.at
            behind += bits_of_counted(layout.parts) if part.counter is None else 0
            fields.append(variable_field(part, name, part.at, names, behind))
        elif "struct" in item:
            fields.append({"at": part.at, "name": name, **item})
        elif not part.mask:
            fields.append(
                replace_keys(
                    item,
                    {
                        **_position(part, part.at, part.bits, order),
                        "name": name,
                        **item,
                    },
                )
            )
        elif part.mask == (1 << part.bits) - 1:
            is_negative = item["type"] == "int" and part.value >> part.bits - 1
            value = part.value - (1 << part.bits) if is_negative else part.value
            # A field of type `bool` cannot have a constant.
            kind = {"type": "uint"} if item["type"] == "bool" else {}
            keys = {
                **_position(part, part.at, part.bits, order),
                "name": name,
                **item,
                **kind,
                "const": value,
            }
            fields.append(replace_keys(item, keys))
        else:
            fields += _split_fields(part, name, order)
    return in_sequence(fields)


def _split_fields(part: KaitaiPart, name: str, order: str) -> list[Item]:
    """Return a field for each run of decided or undecided bits, and an overlay field
    (`view`) for the complete part.
    """
    fields: list[Item] = []
    low = 0
    is_lsb = part.place.order != "big"
    while low < part.bits:
        high = low
        while high + 1 < part.bits and (part.mask >> high + 1 & 1) == (
            part.mask >> low & 1
        ):
            high += 1
        width = high - low + 1
        at = part.at + (low if is_lsb else part.bits - 1 - high)
        called = f"{name} bit {low}" if width == 1 else f"{name} bits {low} to {high}"
        field: Item = {
            **_position(part, at, width, order),
            "name": called,
            "type": "uint",
        }
        if part.mask >> low & 1:
            field["const"] = part.value >> low & (1 << width) - 1
        fields.append(field)
        low = high + 1
    overlay = replace_keys(
        part.item,
        {
            **_position(part, part.at, part.bits, order),
            "name": name,
            **part.item,
            "view": True,
        },
    )
    return sorted([*fields, overlay], key=lambda field: field["at"])


def _position(part: KaitaiPart, at: int, bits: int, order: str) -> Item:
    """Return the keys for the position, and for the byte order if it differs from
    ``order`` of the message.
    """
    if not part.is_ordered:
        return {"at": at, "bits": bits}
    place = part.place._replace(at=at, bits=bits).counted(order)
    return {
        "at": place.at,
        "bits": bits,
        **(ORDERS[place.order] if place.order != order and bits > 1 else {}),
    }
