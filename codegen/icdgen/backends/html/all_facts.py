"""Protocol facts of a node for its page: facts used by generated code, and further
content of the protocol section.

Output are tables (`FactTable`) by section of the ICD. The page of the protocol shows
them below its drawings, so that it contains everything that the ICD states.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from icdgen.backends.html.relations import Relations
from icdgen.backends.html.texts import capitalized
from icdgen.frozen import NamedTuple
from icdgen.icd import schema
from icdgen.icd.model import replaced_part
from icdgen.protocol.declared import FactKind, ProtocolFact, facts_of
from icdgen.protocol.facts import Facts
from icdgen.protocol.sections import Crc

_IN_HEXADECIMAL = ("address_7bit", "check", "printed_constant")
# Keys in the tables of the checksums
_OF_CHECKSUMS = ("kind", "check", *(fact.key for fact in facts_of(Crc)))
# Not shown as facts: the place in the manual, reasons (in a table of their own), prose.
_NOT_SHOWN = ("source", "assumptions", "summary")
_PACKETS = ("link", "packets")


class FactRow(NamedTuple):
    """Fact with its description, its value and, if it is assumed, the reason."""

    about: str
    value: str
    why: str = ""
    url: str = ""


@dataclass(frozen=True, slots=True)
class FactTable:
    """Table of facts.

    ``anchor`` is unique in the page.
    """

    anchor: str
    title: str
    rows: list[FactRow]


def facts_of_code(facts: Facts) -> list[FactTable]:
    """Return each fact that generated code uses, defaults included, by section of the
    ICD.
    """
    why = {
        (assumption.section, assumption.key): assumption.why
        for assumption in facts.assumptions
    }
    parts = []
    for path, thing in facts.parts.items():
        rows = []
        for fact in facts_of(thing):
            value = getattr(thing, fact.name)
            # Unknown facts have no row; the page lists what the ICD describes.
            if value is None or value == ():
                continue
            rows.append(
                FactRow(
                    capitalized(fact.about),
                    value_text(fact, value),
                    why.get((path, fact.key), ""),
                )
            )
        if rows:
            parts.append(_fact_table(path, rows))
    return parts


def with_remaining_facts(
    relations: Relations,
    facts: Facts,
    parts: list[FactTable],
    section: Mapping[str, Any],
) -> list[FactTable]:
    """Return the facts of generated code, each section followed by its remaining
    content: names, units and texts.
    """
    urls = {
        message.name: relations.links.message(message)
        for message in relations.icd.messages_of(facts.node)
    }
    read = {
        f"{path}.{fact.key}"
        for path, thing in facts.parts.items()
        for fact in facts_of(thing)
    }
    # The page has a table of its own for each checksum.
    read |= {
        f"{algorithm.section}.{key}"
        for algorithm in facts.checksums.values()
        for key in _OF_CHECKSUMS
    }
    seeds = tuple(f"{each.section}.seeds." for each in facts.checksums.values())
    parts_by_anchor = {part.anchor: replace(part, rows=[*part.rows]) for part in parts}
    for path, key, form, value in _keys_with_values(
        schema.protocol_schema(), section, ()
    ):
        place = ".".join((*path, key))
        if place in read or place.startswith(seeds):
            continue
        # A list of mappings becomes a row for each entry.
        if path == _PACKETS:
            rows = [FactRow(key, _packet_text(value))]
        elif isinstance(value, list) and value and isinstance(value[0], Mapping):
            path, rows = (*path, key), [_row_of_entry(entry) for entry in value]
        else:
            url = urls.get(value, "") if isinstance(value, str) else ""
            rows = [FactRow(_about(form, key), _value_text(form, key, value), "", url)]
        # Buses, and the other parts of a link, are sections of their own.
        own = replaced_part(path)
        part = _fact_table(".".join(own), [])
        before = "".join(f"{step.replace('_', ' ')}: " for step in path[len(own) :])
        parts_by_anchor.setdefault(part.anchor, part).rows.extend(
            r._replace(about=capitalized(before + r.about)) for r in rows
        )
    return list(parts_by_anchor.values())


def _keys_with_values(
    form: dict[str, Any], section: Mapping[str, Any], path: tuple[str, ...]
) -> Iterator[tuple[tuple[str, ...], str, dict[str, Any], Any]]:
    """Yield each key with a value or a list: its path, its name, its schema and its
    content.
    """
    for key, value in section.items():
        inside = schema.subschema_of_key(form, key)
        if key in _NOT_SHOWN:
            continue
        # A packet is one row, as an entry of a list.
        if isinstance(value, Mapping) and path == _PACKETS:
            yield path, key, inside, value
        elif isinstance(value, Mapping):
            yield from _keys_with_values(inside, value, (*path, key))
        else:
            yield path, key, inside, value


def _about(form: dict[str, Any], key: str) -> str:
    # Meanings in the schema are written for authors of an ICD. The value on the page is
    # a link to the message, so that the remark has no use.
    meaning = schema.description_of(form).removesuffix(" (name of a message)")
    return capitalized(
        key.replace("_", " ")
        if not meaning or meaning.startswith("name of a")
        else meaning
    )


def _value_text(form: dict[str, Any], key: str, value: object) -> str:
    is_code = key in _IN_HEXADECIMAL or "byte" in form.get("$ref", "")
    return f"0x{value:02X}" if is_code and type(value) is int else as_text(value)


def _packet_text(packet: Mapping[str, Any]) -> str:
    """Return a packet in words, such as ``from device, buses uart, header: id of 8
    bits``.
    """
    parts = []
    for key, value in packet.items():
        if key in ("header", "trailer"):
            parts.append(f"{key}: {', '.join(map(_field_text, value))}")
        elif key not in _NOT_SHOWN:
            parts.append(f"{key.replace('_', ' ')} {as_text(value)}")
    return "; ".join(parts)


def _field_text(row: Mapping[str, Any]) -> str:
    """Return a field of a header or trailer, such as ``constant 119 of 8 bits``, or
    ``Status of 8 bits (Result)`` with its enumeration.
    """
    value = f" {as_text(row['value'])}" if "value" in row else ""
    enum = f" ({row['enum']})" if "enum" in row else ""
    return f"{row.get('name', row['role'])}{value} of {row['bits']} bits{enum}"


def _row_of_entry(row: Mapping[str, Any]) -> FactRow:
    """Return the row of a list entry, labeled by the name of the entry."""
    other_keys = {key: value for key, value in row.items() if key != "name"}
    return FactRow(str(row.get("name", "")), as_text(other_keys))


def title_of(path: str) -> str:
    """Return the title of a section of the ICD; that of a bus is its name."""
    return path.removeprefix("link.buses.").replace(".", ": ").replace("_", " ")


def _fact_table(path: str, rows: list[FactRow]) -> FactTable:
    return FactTable(
        f"facts-{path.replace('.', '-')}",
        title_of(path),
        rows,
    )


def value_text(fact: ProtocolFact, value: object) -> str:
    if fact.kind is FactKind.TIME:
        return f"{value:,} ms"
    if fact.kind in (FactKind.OCTET, FactKind.CODE) and isinstance(value, int):
        return f"0x{value:02X}"
    # A pair of first byte and number of bytes.
    if fact.kind is FactKind.SPAN and isinstance(value, tuple):
        return f"bytes {value[0]} to {value[0] + value[1] - 1}"
    return as_text(value)


def as_text(value: object) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, (tuple, list)):
        return ", ".join(as_text(item) for item in value)
    if isinstance(value, dict):
        return ", ".join(
            f"{key} {as_text(item)}"
            for key, item in value.items()
            if key != "assumptions"
        )
    if isinstance(value, int):
        return f"{value:,}"
    return "" if value is None else str(value)
