"""Page of a node's protocol: buses, framing, checksums, identifiers, errors, sequences
and assumptions.

`values` returns what the template ``protocol.html.j2`` needs; `search_entries` returns
the sections of the page for the search.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from icdgen.backends.html import (
    all_facts,
    checksums,
    packet_formats,
    packets,
    responses,
    sequences,
    texts,
)
from icdgen.backends.html.all_facts import FactRow, as_text
from icdgen.backends.html.relations import PageLink, Relations
from icdgen.frozen import NamedTuple
from icdgen.icd.buses import CAN, bus_link
from icdgen.icd.model import Node, buses_of
from icdgen.protocol import facts
from icdgen.protocol.facts import Facts
from icdgen.protocol.packet_formats import LENGTH
from icdgen.protocol.sections import CanPart

_WIDTH = 720


class BusBox(NamedTuple):
    """Box of a drawing at ``x`` with two lines of text.

    ``above``: numbers of its bits.
    """

    x: float
    width: float
    text: str
    about: str
    above: str = ""


def has_page(relations: Relations, node: Node) -> bool:
    """Return whether the ICD describes the protocol of the node."""
    return bool(relations.icd.protocol_of(node))


def values(relations: Relations, node: Node) -> dict[str, object]:
    """Return the values of the page."""
    node_facts, section = facts.of(relations.icd, node), relations.icd.protocol_of(node)
    parts = all_facts.facts_of_code(node_facts)
    return {
        "node": node,
        "framed": _packet_values(relations, node, node_facts),
        "lines": bus_settings(section),
        "framing": _framing(node_facts),
        "escaped": node_facts.framing and f"{node_facts.framing.escape:02X}",
        "escaped_as": node_facts.framing
        and f"{node_facts.framing.escape:02X} {node_facts.framing.escaped:02X}",
        "checks": checksums.of_node(node_facts, section),
        "calculator": texts.script_json(
            [
                {"name": each.name, **packet_formats.checksum_facts(each)}
                for each in node_facts.checksums.values()
            ]
        ),
        "identifier": _identifier_boxes(node_facts, section),
        "types": [
            FactRow(
                f"{packet.section['type']} · {packet.name}",
                packet.section.get("summary", ""),
            )
            for packet in bus_link(section.get("link", {}), CAN).packets.all
            if "type" in packet.section
        ],
        "errors": error_codes(relations, node_facts),
        "responses": responses.of_node(relations, node),
        "acknowledges": sequences.acknowledges(relations, node, node_facts),
        "procedures": sequences.procedures(relations, node, node_facts),
        "times": [
            (part, row)
            for part in parts
            for row in part.rows
            if row.value.endswith(" ms")
        ],
        "parts": all_facts.with_remaining_facts(relations, node_facts, parts, section),
        "assumptions": [
            FactRow(
                f"{assumption.section}: {assumption.key.replace('_', ' ')}",
                as_text(assumption.value),
                assumption.why,
            )
            for assumption in node_facts.assumptions
        ],
    }


def bus_settings(section: dict[str, Any]) -> list[tuple[str, list[FactRow]]]:
    """Return the settings of each bus."""
    settings_by_bus = []
    buses = {
        title: buses_of(section).get(key, {}) for key, title in texts.BUSES.items()
    }
    line = {"Serial line": section.get("link", {}).get("line", {})}
    for title, settings in (line | buses).items():
        rows = list(_setting_rows(settings, ""))
        if rows:
            settings_by_bus.append((title, rows))
    return settings_by_bus


def _setting_rows(section: dict[str, Any], prefix: str) -> Iterator[FactRow]:
    for key, value in section.items():
        label = f"{prefix}{key.replace('_', ' ')}"
        # bool is a subclass of int.
        if isinstance(value, int) and not isinstance(value, bool):
            yield FactRow(label, f"0x{value:02X}" if "address" in key else f"{value:,}")
        elif isinstance(value, str):
            yield FactRow(label, value)
        elif isinstance(value, list) and all(isinstance(item, str) for item in value):
            yield FactRow(label, " or ".join(value))
        elif key in ("write", "read") and isinstance(value, dict):
            yield from _setting_rows(value, f"{key}, ")
        elif key == "line":
            yield from _setting_rows(value, "")


def _framing(node_facts: Facts) -> list[BusBox]:
    form = node_facts.framing
    if form is None:
        return []
    pieces = [
        (f"{form.escape:02X}", "escape", 1),
        (f"{form.start:02X}", "start", 1),
        ("id", "", 1.4),
        ("data", "", 4),
    ]
    if node_facts.checksum and "uart" in node_facts.checksum.telecommand_buses:
        pieces.append(
            (
                "CRC",
                "" if "uart" in node_facts.checksum.telecommand_always else "optional",
                1.4,
            )
        )
    pieces += [(f"{form.escape:02X}", "escape", 1), (f"{form.end:02X}", "end", 1)]
    return _adjacent_boxes([(text, about, share, "") for text, about, share in pieces])


def _packet_values(
    relations: Relations, node: Node, node_facts: Facts
) -> dict[str, object]:
    """Return the description of the packet formats; empty without one."""
    if node_facts.stream is None:
        return {}
    views = packets.packet_views(relations, node, node_facts.stream)
    return {
        "ends": packet_formats.end_of(node_facts.stream),
        "packets": [(view, _adjacent_boxes(view.boxes)) for view in views],
        "is_named": any(view.name for view in views),
        "is_measured": node_facts.stream.delimited_by != LENGTH
        or all(packet.of("length") for packet in node_facts.stream.packets),
    }


def _adjacent_boxes(pieces: list[tuple[str, str, float, str]]) -> list[BusBox]:
    """Return adjacent boxes with widths in proportion to their shares."""
    # 1 unit on either side is for the outline.
    total, x, boxes = sum(share for _, _, share, _ in pieces), 0.0, []
    for text, about, share, above in pieces:
        width = (_WIDTH - 2) * share / total
        boxes.append(BusBox(round(1 + x, 1), round(width, 1), text, about, above))
        x += width
    return boxes


def _identifier_boxes(node_facts: Facts, section: dict[str, Any]) -> list[BusBox]:
    if node_facts.can is None:
        return []
    names = {
        row.get("role", row["name"]): row["name"]
        for row in buses_of(section)["can"]["identifier"]
    }
    # The most significant bit of a CAN identifier is sent first (ISO 11898-1), so it is
    # on the left.
    ordered: list[tuple[str, CanPart]] = sorted(
        node_facts.can.parts.items(), key=lambda item: -item[1].shift
    )
    # The width of a box is proportional to its bits.
    return _adjacent_boxes([
        (names.get(role, role), f"{part.bits} bits", part.bits, f"{part.shift + part.bits - 1} … {part.shift}")
        for role, part in ordered
    ])  # fmt: skip


def error_codes(
    relations: Relations, node_facts: Facts
) -> list[tuple[int, str, str, str]]:
    """Return code, name, role in the protocol, and link of each error."""
    roles = {code: key.replace("_", " ") for key, code in node_facts.reasons.items()}
    enums = [] if node_facts.stream else node_facts.reason_enums
    if not enums:
        return [(code, role, "", "") for code, role in sorted(roles.items())]
    codes = []
    for enum in enums:
        page = relations.links.enum(enum)
        for member in enum.members:
            url = f"{page}#{relations.links.anchor(enum, str(member.value))}"
            codes.append((member.value, member.name, roles.get(member.value, ""), url))
    return codes


def search_entries(
    relations: Relations, node: Node, url: str
) -> Iterator[tuple[str, str, PageLink]]:
    """Yield the search entries of the page: words, title and place of each section."""
    node_facts, section = facts.of(relations.icd, node), relations.icd.protocol_of(node)
    for title, rows in bus_settings(section):
        words = " ".join(f"{row.about} {row.value}" for row in rows)
        yield (
            f"line bus serial interface {words}",
            f"{title} settings",
            PageLink(node.title, f"{url}#lines"),
        )
    crc = "crc checksum polynomial init reflect calculator"
    sections = [
        (
            node_facts.framing,
            "uart framing escape start end of message byte stuffing",
            "Framing",
            "framing",
        ),
        (
            node_facts.stream,
            "packet framed link header trailer sync length sequence delimiter framing checksum",
            "Packets",
            "packets",
        ),
        *(
            (
                True,
                f"packet format header trailer request response {name}",
                f"Packet {name}",
                url.partition("#")[2],
            )
            for name, url in packets.packet_urls(relations, node).items()
            if name
        ),
        *(
            (
                True,
                f"{crc} {checksum.lower()}",
                f"{checksum} parameters and calculator",
                "checksums",
            )
            for checksum in node_facts.checksums
        ),
        (
            node_facts.can,
            "can identifier bits message types",
            "CAN identifier",
            "identifier",
        ),
        (
            responses.of_node(relations, node),
            "responses commands acknowledge ack refuse nak busy progress echo reason",
            "Responses to telecommands",
            "responses",
        ),
        (
            error_codes(relations, node_facts),
            "error codes reasons nack",
            "Error codes",
            "errors",
        ),
        (
            sequences.acknowledges(relations, node, node_facts),
            "acknowledge ack nak nack handshake sequence",
            "Acknowledges",
            "acknowledges",
        ),
        *(
            (
                True,
                f"procedure sequence {' '.join(arrow.text for arrow in sequence.arrows)}",
                sequence.title,
                "procedures",
            )
            for sequence in sequences.procedures(relations, node, node_facts)
        ),
        (True, "timeout time-out retries interval wait", "Time-outs", "times"),
        (True, "assumptions assumed reasons", "Assumptions", "assumptions"),
    ]
    # A section without content is not on the page, so it has no anchor.
    for is_there, words, title, anchor in sections:
        if is_there:
            yield words, title, PageLink(node.title, f"{url}#{anchor}")
