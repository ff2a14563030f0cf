"""The page that says how a node talks: lines, framing, checksums, identifiers, errors, who sends what when, and what is assumed."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

from icdgen.backends.html import all_facts, envelopes, sequences, texts
from icdgen.backends.html.all_facts import Row, as_text, value_text
from icdgen.backends.html.relations import Place, Relations
from icdgen.icd.model import Node
from icdgen.protocol import facts
from icdgen.protocol.declared import facts_of
from icdgen.protocol.facts import Facts
from icdgen.protocol.sections import CanPart, Crc

_WIDTH = 720


class Box(NamedTuple):
    """A piece of a drawing: two lines of text in a box at ``x``; ``above`` it are the numbers of its bits."""

    x: float
    width: float
    text: str
    about: str
    above: str = ""


def has_page(relations: Relations, node: Node) -> bool:
    """Whether the ICD says anything about how the node talks."""
    return bool(relations.icd.protocol_of(node))


def values(relations: Relations, node: Node) -> dict[str, object]:
    """Values of the page."""
    known, section = facts.of(relations.icd, node), relations.icd.protocol_of(node)
    checks, sums = _checks(known, section), envelopes.sums(section, known)
    parts = all_facts.of_code(relations, known)
    computed = [(name, crc) for name, crc, _ in checks] + [(one.name, one.crc) for one in sums if one.crc]
    return {
        "node": node,
        "envelope": _envelope(relations, known, section),
        "lines": lines(section),
        "framing": _framing(known),
        "escaped": known.framing and f"{known.framing.escape:02X}",
        "escaped_as": known.framing and f"{known.framing.escape:02X} {known.framing.escaped:02X}",
        "checks": [
            *((name, _crc_rows(crc), f"0x{check:X}" if check is not None else "") for name, crc, check in checks),
            *((one.name, [Row(*row) for row in one.rows], "") for one in sums),
        ],
        "calculator": (
            texts.script_json([{"name": name, **envelopes.crc_numbers(crc)} for name, crc in computed])
            if computed
            else ""
        ),
        "identifier": _identifier(known, section),
        "types": [
            Row(f"{one['value']} · {one['name']}", one.get("summary", ""))
            for one in section.get("can", {}).get("message_types", {}).get("values", ())
        ],
        "errors": errors(relations, node, known, section),
        "acknowledges": sequences.acknowledges(relations, node, known),
        "procedures": sequences.procedures(relations, node, known),
        "times": [(part, row) for part in parts for row in part.rows if row.value.endswith(" ms")],
        "parts": all_facts.with_others(relations, known, parts, section),
        "assumptions": [
            Row(f"{one.section}: {one.key.replace('_', ' ')}", as_text(one.value), one.why) for one in known.assumptions
        ],
    }


def lines(section: dict[str, Any]) -> list[tuple[str, list[Row]]]:
    """The settings of each bus."""
    found = []
    for key, title in texts.BUSES.items():
        rows = list(_settings(section.get(key, {}), ""))
        if rows:
            found.append((title, rows))
    return found


def _settings(given: dict[str, Any], prefix: str) -> Iterator[Row]:
    for key, value in given.items():
        label = f"{prefix}{key.replace('_', ' ')}"
        if isinstance(value, int) and not isinstance(value, bool):
            yield Row(label, f"0x{value:02X}" if "address" in key else f"{value:,}")
        elif isinstance(value, str):
            yield Row(label, value)
        elif isinstance(value, list) and all(isinstance(one, str) for one in value):
            yield Row(label, " or ".join(value))
        elif key in ("write", "read") and isinstance(value, dict):
            yield from _settings(value, f"{key}, ")


def _framing(known: Facts) -> list[Box]:
    form = known.framing
    if form is None:
        return []
    pieces = [(f"{form.escape:02X}", "escape", 1), (f"{form.start:02X}", "start", 1), ("id", "", 1.4), ("data", "", 4)]
    if known.checksum and "uart" in known.checksum.telecommand_buses:
        pieces.append(("CRC", "" if "uart" in known.checksum.telecommand_always else "optional", 1.4))
    pieces += [(f"{form.escape:02X}", "escape", 1), (f"{form.end:02X}", "end", 1)]
    return _row([(text, about, share, "") for text, about, share in pieces])


def _envelope(relations: Relations, known: Facts, section: dict[str, Any]) -> dict[str, object]:
    """What is around each message; empty without it."""
    if known.stream is None:
        return {}
    urls = {one.name: relations.links.message(one) for one in relations.icd.messages_of(known.node)}
    replies = section["stream"].get("replies", {})
    return {
        "boxes": _row(envelopes.boxes(section)),
        "ends": envelopes.ENDS[known.stream.delimited_by],
        "places": envelopes.places(section),
        "replies": [Row(sent, came, "", urls.get(came, "")) for sent, came in replies.items()],
    }


def _row(pieces: list[tuple[str, str, float, str]]) -> list[Box]:
    """Boxes beside each other, as wide as their shares."""
    whole, x, found = sum(share for _, _, share, _ in pieces), 0.0, []
    for text, about, share, above in pieces:
        width = (_WIDTH - 2) * share / whole
        found.append(Box(round(1 + x, 1), round(width, 1), text, about, above))
        x += width
    return found


def _identifier(known: Facts, section: dict[str, Any]) -> list[Box]:
    if known.can is None:
        return []
    names = {row.get("role", row["name"]): row["name"] for row in section["can"]["identifier"]}
    ordered: list[tuple[str, CanPart]] = sorted(known.can.parts.items(), key=lambda item: -item[1].shift)
    return _row([
        (names.get(role, role), f"{part.bits} bits", part.bits, f"{part.shift + part.bits - 1} … {part.shift}")
        for role, part in ordered
    ])  # fmt: skip


def _checks(known: Facts, section: dict[str, Any]) -> list[tuple[str, Crc, int | None]]:
    found = (("crc8", known.checksum and known.checksum.crc), ("crc16", known.crc16))
    return [(f"CRC-{crc.width}", crc, section[key].get("check")) for key, crc in found if crc]


def _crc_rows(crc: Crc) -> list[Row]:
    return [
        Row(texts.capitalized(fact.about), value_text(fact, getattr(crc, fact.name)))
        for fact in facts_of(Crc)
        if getattr(crc, fact.name) is not None
    ]


def errors(relations: Relations, node: Node, known: Facts, section: dict[str, Any]) -> list[tuple[int, str, str, str]]:
    """Code, name, what it is to the protocol, and where the name stands."""
    name = section.get("errors", {}).get("enum")
    enums = (enum for one in (node, *relations.icd.included(node)) for enum in one.enums)
    enum = next((one for one in enums if one.name == name), None)
    roles = {code: key.replace("_", " ") for key, code in known.errors.items()}
    if enum is None:
        return [(code, role, "", "") for code, role in sorted(roles.items())]
    url = relations.links.enum(enum)
    return [
        (m.value, m.name, roles.get(m.value, ""), f"{url}#{relations.links.anchor(enum, str(m.value))}")
        for m in enum.members
    ]


def entries(relations: Relations, node: Node, url: str) -> Iterator[tuple[str, str, Place]]:
    """What the search finds of the page: words, title and place of each section."""
    known, section = facts.of(relations.icd, node), relations.icd.protocol_of(node)
    for title, rows in lines(section):
        words = " ".join(f"{row.about} {row.value}" for row in rows)
        yield f"line bus serial interface {words}", f"{title} settings", Place(node.title, f"{url}#lines")
    checks = [*(name for name, _, _ in _checks(known, section)), *(one.name for one in envelopes.sums(section, known))]
    crc = "crc checksum polynomial init reflect calculator"
    found = [
        (known.framing, "uart framing escape start end of message byte stuffing", "Framing", "framing"),
        (
            known.stream,
            "envelope stream header trailer sync length sequence delimiter framing checksum",
            "Envelope",
            "envelope",
        ),
        *(
            (True, f"{crc} {one.replace('-', '').lower()}", f"{one} parameters and calculator", "checksums")
            for one in checks
        ),
        (known.can, "can identifier bits message types", "CAN identifier", "identifier"),
        (known.errors, "error codes reasons nack", "Error codes", "errors"),
        (True, "acknowledge ack nack handshake sequence", "Acknowledges", "acknowledges"),
        *(
            (True, f"procedure sequence {' '.join(arrow.text for arrow in one.arrows)}", one.title, "procedures")
            for one in sequences.procedures(relations, node, known)
        ),
        (True, "timeout time-out retries interval wait", "Time-outs", "times"),
        (True, "assumptions assumed reasons", "Assumptions", "assumptions"),
    ]
    for is_there, words, title, anchor in found:
        if is_there:
            yield words, title, Place(node.title, f"{url}#{anchor}")
