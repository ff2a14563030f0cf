"""All facts of how a node talks, for its page: those that code is made from, and what else its ICD says of the protocol."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

from icdgen.backends.html.relations import Relations
from icdgen.backends.html.texts import capitalized
from icdgen.icd import schema
from icdgen.protocol.declared import Fact, Kind, facts_of
from icdgen.protocol.facts import Facts
from icdgen.protocol.sections import Crc, Step

_IN_HEXADECIMAL = ("address_7bit", "check", "printed_constant")
_BESIDES = ("source", "assumptions", "summary")  # where it stands, why it is assumed (a table of its own), prose


class Row(NamedTuple):
    """A fact: what it is, its value, and why that is assumed, if it is."""

    about: str
    value: str
    why: str = ""
    url: str = ""


@dataclass(frozen=True, slots=True)
class Part:
    """A table of facts; ``anchor`` is unique in the page."""

    anchor: str
    title: str
    rows: list[Row]


def of_code(relations: Relations, known: Facts) -> list[Part]:
    """Every fact that code is made from, be it a default, by the section of the ICD that it stands in."""
    why = {(one.section, one.key): one.why for one in known.assumptions}
    found = []
    for path, thing in _things(known):
        rows = []
        for fact in facts_of(thing):
            value = getattr(thing, fact.name)
            if value is None or value == ():
                continue
            url = relations.links.message(value.message) if isinstance(value, Step) else ""
            rows.append(Row(capitalized(fact.about), value_text(fact, value), why.get((path, fact.key), ""), url))
        if rows:
            found.append(_part(path, rows))
    return found


def with_others(relations: Relations, known: Facts, parts: list[Part], section: Mapping[str, Any]) -> list[Part]:
    """The facts that code is made from, and behind those of each section what else the ICD says there: names, units and words."""
    urls = {one.name: relations.links.message(one) for one in relations.icd.messages_of(known.node)}
    read = {f"{path}.{fact.key}" for path, thing in _things(known) for fact in facts_of(thing)}
    read |= {f"{path}.{fact.key}" for path in ("crc8", "crc16") for fact in facts_of(Crc)}
    found = {part.anchor: replace(part, rows=[*part.rows]) for part in parts}
    for path, key, form, value in _said(schema.protocol(), section, ()):
        if ".".join((*path, key)) in read:
            continue
        if isinstance(value, list) and value and isinstance(value[0], Mapping):
            path, rows = (*path, key), [_entry(one) for one in value]
        else:
            url = urls.get(value, "") if isinstance(value, str) else ""
            rows = [Row(_about(form, key), _said_text(form, key, value), "", url)]
        part = _part(path[0], [])
        before = "".join(f"{one.replace('_', ' ')}: " for one in path[1:])
        found.setdefault(part.anchor, part).rows.extend(r._replace(about=capitalized(before + r.about)) for r in rows)
    return list(found.values())


def _said(
    form: dict[str, Any], section: Mapping[str, Any], path: tuple[str, ...]
) -> Iterator[tuple[tuple[str, ...], str, dict[str, Any], Any]]:
    """Each key that has a value or a list: where it stands, its name, its form and what it holds."""
    for key, value in section.items():
        inside = schema.inside(form, key)
        if key in _BESIDES:
            continue
        if isinstance(value, Mapping):
            yield from _said(inside, value, (*path, key))
        else:
            yield path, key, inside, value


def _about(form: dict[str, Any], key: str) -> str:
    meaning = schema.meaning(form).removesuffix(" (name of a message)")
    return capitalized(key.replace("_", " ") if not meaning or meaning.startswith("name of a") else meaning)


def _said_text(form: dict[str, Any], key: str, value: object) -> str:
    is_code = key in _IN_HEXADECIMAL or "byte" in form.get("$ref", "")
    return f"0x{value:02X}" if is_code and type(value) is int else as_text(value)


def _entry(row: Mapping[str, Any]) -> Row:
    """An entry of a list; what it is called says which."""
    others = {key: value for key, value in row.items() if key != "name"}
    return Row(str(row.get("name", "")), as_text(others))


def _part(path: str, rows: list[Row]) -> Part:
    return Part(f"facts-{path.replace('.', '-')}", path.replace(".", ": ").replace("_", " "), rows)


def _things(known: Facts) -> list[tuple[str, object]]:
    named = {
        "client": known.client, "uart.framing": known.framing, "uart.acknowledge": known.acknowledge, "can": known.can,
        "can.extended": known.can and known.can.extended, "crc8": known.checksum, "log_mask": known.mask,
        "telemetry_log": known.log_file, "unsolicited_log": known.log_message, "index_file": known.index,
        "file_transfer": known.files, "file_transfer.hole_map": known.hole_map,
        **{f"file_transfer.{name}": one for name, one in (known.files.procedures if known.files else {}).items()},
        "program_copy": known.program_copy, "program_information": known.program_information,
    }  # fmt: skip
    return [(path, thing) for path, thing in named.items() if thing is not None]


def value_text(fact: Fact, value: object) -> str:
    if fact.kind is Kind.TIME:
        return f"{value:,} ms"
    if fact.kind in (Kind.OCTET, Kind.CODE) and isinstance(value, int):
        return f"0x{value:02X}"
    if isinstance(value, Step):
        return value.message.name
    if fact.kind is Kind.SPAN and isinstance(value, tuple):
        return f"bytes {value[0]} to {value[0] + value[1] - 1}"
    return as_text(value)


def as_text(value: object) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, (tuple, list)):
        return ", ".join(as_text(one) for one in value)
    if isinstance(value, dict):
        return ", ".join(f"{key} {as_text(one)}" for key, one in value.items() if key != "assumptions")
    return f"{value:,}" if isinstance(value, int) else "" if value is None else str(value)
