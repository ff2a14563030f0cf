"""Conversion of ICDs that were written before `protocol.link` took the place of other
parts of the protocol section.

`convert` changes the tree of the formatter in place and returns whether a key was
converted. It moves entries with their comments, and moves the reasons in `assumptions`
to the new places. In errata it changes only paths of sections and printed keys of the
framing. `earlier_buses` converts the keys of buses.
"""

from __future__ import annotations

import copy
import re
from collections.abc import Mapping

from icdgen.icd.fmt.commented import NOTHING, Branch, Child, ScalarText
from icdgen.icd.fmt.earlier_buses import PATHS, convert_buses
from icdgen.icd.fmt.scalars import name
from icdgen.icd.fmt.trees import (
    branches,
    entries_of,
    entry_of,
    mapping,
    move,
    number,
    part_of,
    value_of,
    word,
)

# Parts of the protocol section that are in `link`, with their present keys
_PARTS = {"client": "client", "message_id": "ids", "errors": "reasons"}
_BUSES = {key: key for key in ("uart", "i2c", "can")}
_LINE = {key: key for key in ("baud_rate", "data_bits", "parity", "stop_bits")}
_FRAMING = {
    "start_of_message": "start",
    "end_of_message": "end",
    "escaped_data": "data",
}
_CHECKSUMS = ("crc8", "crc16")  # of messages, and of files
_DIRECTIONS = {"telecommand": "host", "telemetry": "device"}
_PATHS = {
    **{
        f"protocol.crc8.{direction}": f"protocol.link.packets.{direction}"
        for direction in _DIRECTIONS
    },
    **{f"protocol.{key}": f"protocol.link.checksums.{key}" for key in _CHECKSUMS},
    **{
        f"protocol.{key}": f"protocol.link.{present}" for key, present in _PARTS.items()
    },
    **{f"protocol.uart.{key}": f"protocol.link.buses.uart.line.{key}" for key in _LINE},
    **{f"protocol.{bus}": f"protocol.link.buses.{bus}" for bus in _BUSES},
}


def convert(root: Branch) -> bool:
    """Change the tree of an ICD or of errata to the present keys.

    Return whether there was something to change.
    """
    if entry_of(root, "errata"):
        return _convert_errata(root)
    protocol = entry_of(root, "protocol")
    if protocol is None or not isinstance(protocol.value, Branch):
        return False
    section, link = protocol.value, None
    if stream := entry_of(section, "stream"):
        # The schema check reports a value of another type, and two links.
        if part_of(section, "stream") is None or entry_of(section, "link"):
            return False
        stream.key = word("link")
        link = part_of(section, "link")
        assert link is not None
        move(section, {"checksums": "checksums", "uart": "line"}, link)
        _convert_framing(link)
        _move_covers(link)
    if any(entry_of(section, key) for key in (*_PARTS, *_BUSES)):
        link = part_of(section, "link")
        if link is None:
            return False
        move(section, _PARTS, link)
        if any(entry_of(section, key) for key in _BUSES):
            buses = part_of(link, "buses")
            if buses is None:
                return True  # other parts have been moved
            move(section, _BUSES, buses)
            if uart := entry_of(buses, "uart"):
                _convert_uart(uart.value)
    if any(entry_of(section, key) for key in _CHECKSUMS):
        link = part_of(section, "link")
        if link is None:
            return False
        if not _convert_checksums(section, link):
            return True  # an empty part may have been added
    present = value_of(section, "link")
    is_converted = isinstance(present, Branch) and convert_buses(present, root)
    return is_converted or link is not None


def _convert_checksums(section: Branch, link: Branch) -> bool:
    """Move the checksums of messages and of files to the link, and the use of the former
    to packets.

    Return whether this was possible.
    """
    checksums = part_of(link, "checksums")
    if checksums is None:
        return False
    for key in _CHECKSUMS:
        entry = entry_of(section, key)
        if entry is None or not isinstance(entry.value, Branch):
            continue
        checksum = entry.value
        covers = entry_of(checksum, "covers")
        if any(entry_of(checksum, direction) for direction in _DIRECTIONS):
            packets = part_of(link, "packets")
            if packets is None:
                return False
            for direction, sender in _DIRECTIONS.items():
                if use := entry_of(checksum, direction):
                    checksum.children.remove(use)
                    use.value = _packet(key, checksum, use.value, sender)
                    packets.children.append(use)
            _move_reasons(checksum, packets)
            if covers:
                checksum.children.remove(covers)
                covers = None
        if covers and isinstance(covers.value, Branch):
            data = [child.value for child in covers.value.children]
            named = ", ".join(
                str(text.value) for text in data if isinstance(text, ScalarText)
            )
            covers.key, covers.value = word("summary"), word(f"Covers {named}.")
        if covers_id := entry_of(checksum, "covers_id"):
            checksum.children.remove(covers_id)
        place = 1 if entry_of(checksum, "source") else 0
        checksum.children.insert(place, Child(word("kind"), word("crc")))
        move(section, {key: key}, checksums)
    return True


def _packet(name: str, checksum: Branch, use: object, sender: str) -> Branch:
    """Return the packet of messages with a checksum, for its use in one direction."""
    covers_id = value_of(checksum, "covers_id")
    first = "id" if isinstance(covers_id, ScalarText) and covers_id.value else "data"
    size, optional = value_of(use, "extra_bytes"), value_of(use, "optional")
    width = value_of(checksum, "width")
    bits = width if isinstance(width, ScalarText) else number(8)
    if isinstance(size, ScalarText) and isinstance(size.value, int):
        bits = number(8 * size.value)
    field: dict[str, ScalarText | Branch] = {
        "bits": bits,
        "role": word("checksum"),
        "checksum": word(name),
        "covers": mapping({"from": word(first), "to": word("data")}),
    }
    if not isinstance(optional, ScalarText) or optional.value:
        field["optional"] = ScalarText(True, "true")
    trailer = Branch(False, True, 0, [Child(NOTHING, mapping(field))])
    packet: dict[str, ScalarText | Branch] = {"from": word(sender)}
    for key in ("source", "buses"):
        if isinstance(value := value_of(use, key), Branch):
            packet[key] = value
    return mapping({**packet, "trailer": trailer}, False)


def _move_reasons(checksum: Branch, packets: Branch) -> None:
    """Move the reasons for assumptions about the use of a checksum to packets."""
    for direction in _DIRECTIONS:
        packet = value_of(packets, direction)
        if isinstance(packet, Branch):
            for key, present in (("covers_id", "trailer"), (direction, "buses")):
                _move_assumptions(checksum, {key: present}, packet)


def _convert_errata(root: Branch) -> bool:
    """Change paths of protocol sections, and printed keys of the framing of a UART."""
    is_converted = False
    for item in [*branches(root)]:
        where = value_of(item, "where")
        for place in branches(where) if isinstance(where, Branch) else ():
            section = entry_of(place, "section")
            if not section or not isinstance(section.value, ScalarText):
                continue
            path = earlier_path = str(section.value.value)
            if path == "protocol.uart.framing":
                _rename(value_of(item, "printed"), _FRAMING)
            for paths in (_PATHS, PATHS):
                for earlier, present in paths.items():
                    if path == earlier or path.startswith(f"{earlier}."):
                        path = present + path.removeprefix(earlier)
                        break
            # Rows of the earlier lists are packets and fields of their own.
            path = re.sub(
                r"(link\.packets(\.acknowledge)?)\.(values|data)\b.*", r"\1", path
            )
            if path != earlier_path:
                section.value = word(path)
                is_converted = True
    return is_converted


def _rename(value: object, keys: Mapping[str, str]) -> None:
    for entry in entries_of(value):
        if key := keys.get(name(entry.key)):
            entry.key = word(key)


def _convert_framing(link: Branch) -> None:
    framing = entry_of(link, "delimited_by")
    if framing and isinstance(framing.value, ScalarText):
        by = word("datagram") if framing.value.value == "none" else framing.value
        framing.key = word("framing")
        framing.value = Branch(True, True, 0, [Child(word("by"), by)])


def _convert_uart(uart: object) -> None:
    """Give a UART the keys of framed links for its line and its framing."""
    if not isinstance(uart, Branch) or not uart.mapping:
        return
    if any(entry_of(uart, key) for key in _LINE) and (line := part_of(uart, "line")):
        move(uart, _LINE, line)
        _move_assumptions(uart, _LINE, line)
    framing = entry_of(uart, "framing")
    if framing and isinstance(framing.value, Branch) and framing.value.mapping:
        for owner in (framing.value, value_of(framing.value, "assumptions")):
            _rename(owner, _FRAMING)
        framing.value.children.insert(0, Child(word("by"), word("escape")))


def _move_assumptions(section: Branch, keys: Mapping[str, str], target: Branch) -> None:
    """Move the reasons for the assumed values of moved keys."""
    reasons = entry_of(section, "assumptions")
    if reasons is None or not isinstance(reasons.value, Branch):
        return
    if any(entry_of(reasons.value, key) for key in keys):
        moved = part_of(target, "assumptions")
        if moved is not None:
            move(reasons.value, keys, moved)
        if not reasons.value.children:
            section.children.remove(reasons)


def _move_covers(link: Branch) -> None:
    """Move what each checksum covers to the fields that have none of their own."""
    checksums = entry_of(link, "checksums")
    declared = {}
    for checksum in entries_of(checksums.value) if checksums else ():
        covers = entry_of(checksum.value, "covers")
        if covers:
            entries_of(checksum.value).remove(covers)
            declared[name(checksum.key)] = covers
    for field in branches(link):
        named = entry_of(field, "checksum")
        if (
            not named
            or not isinstance(named.value, ScalarText)
            or entry_of(field, "covers")
        ):
            continue
        if covers := declared.get(named.value.spelling):
            field.children.append(copy.deepcopy(covers))
            covers.before, covers.trailing = [], []  # only the first gets the comments
