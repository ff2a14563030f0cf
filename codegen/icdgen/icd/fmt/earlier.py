"""Conversion of ICDs that were written before `protocol.link` took the place of other
parts of the protocol section.
"""

from __future__ import annotations

import copy
from collections.abc import Iterator, Mapping

from icdgen.icd.fmt.commented import NOTHING, Branch, Child, Text
from icdgen.icd.fmt.scalars import name

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


def _text(word: str) -> Text:
    return Text(word, word)


def _entries(value: object) -> list[Child]:
    """Return the entries of a mapping; none of anything else."""
    return value.children if isinstance(value, Branch) and value.mapping else []


def _entry(value: object, key: str) -> Child | None:
    """Return the entry of a key; None without one."""
    return next((each for each in _entries(value) if name(each.key) == key), None)


def convert(root: Branch) -> bool:
    """Change the tree of an ICD or of errata to the present keys.

    Return whether there was something to change.
    """
    if _entry(root, "errata"):
        return _convert_errata(root)
    protocol = _entry(root, "protocol")
    if protocol is None or not isinstance(protocol.value, Branch):
        return False
    section, link = protocol.value, None
    if stream := _entry(section, "stream"):
        stream.key = _text("link")
        link = _part_of(section, "link")
        if link is None:
            return False
        _move(section, {"checksums": "checksums", "uart": "line"}, link)
        _convert_framing(link)
        _move_covers(link)
    if any(_entry(section, key) for key in (*_PARTS, *_BUSES)):
        link = _part_of(section, "link")
        if link is None:
            return False
        _move(section, _PARTS, link)
        if any(_entry(section, key) for key in _BUSES):
            buses = _part_of(link, "buses")
            if buses is None:
                return False
            _move(section, _BUSES, buses)
            if uart := _entry(buses, "uart"):
                _convert_uart(uart.value)
    if any(_entry(section, key) for key in _CHECKSUMS):
        link = _part_of(section, "link")
        if link is None or not _convert_checksums(section, link):
            return False
    return link is not None


def _convert_checksums(section: Branch, link: Branch) -> bool:
    """Move the checksums of messages and of files to the link, and the use of the former
    to packets.

    Return whether this was possible.
    """
    checksums = _part_of(link, "checksums")
    if checksums is None:
        return False
    for key in _CHECKSUMS:
        entry = _entry(section, key)
        if entry is None or not isinstance(entry.value, Branch):
            continue
        checksum = entry.value
        covers = _entry(checksum, "covers")
        if any(_entry(checksum, direction) for direction in _DIRECTIONS):
            packets = _part_of(link, "packets")
            if packets is None:
                return False
            for direction, sender in _DIRECTIONS.items():
                if use := _entry(checksum, direction):
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
                str(text.value) for text in data if isinstance(text, Text)
            )
            covers.key, covers.value = _text("summary"), _text(f"Covers {named}.")
        if covers_id := _entry(checksum, "covers_id"):
            checksum.children.remove(covers_id)
        place = 1 if _entry(checksum, "source") else 0
        checksum.children.insert(place, Child(_text("kind"), _text("crc")))
        _move(section, {key: key}, checksums)
    return True


def _packet(name: str, checksum: Branch, use: object, sender: str) -> Branch:
    """Return the packet of messages with a checksum, for its use in one direction."""
    covers_id = _value(checksum, "covers_id")
    first = "id" if isinstance(covers_id, Text) and covers_id.value else "data"
    size, optional = _value(use, "extra_bytes"), _value(use, "optional")
    width = _value(checksum, "width")
    bits = width if isinstance(width, Text) else Text(8, "8")
    if isinstance(size, Text) and isinstance(size.value, int):
        bits = Text(8 * size.value, str(8 * size.value))
    field: dict[str, Text | Branch] = {
        "bits": bits,
        "role": _text("checksum"),
        "checksum": _text(name),
        "covers": _mapping({"from": _text(first), "to": _text("data")}),
    }
    if not isinstance(optional, Text) or optional.value:
        field["optional"] = Text(True, "true")
    trailer = Branch(False, True, 0, [Child(NOTHING, _mapping(field))])
    packet: dict[str, Text | Branch] = {"from": _text(sender)}
    for key in ("source", "buses"):
        if isinstance(value := _value(use, key), Branch):
            packet[key] = value
    return _mapping({**packet, "trailer": trailer}, False)


def _move_reasons(checksum: Branch, packets: Branch) -> None:
    """Move the reasons for assumptions about the use of a checksum to packets."""
    for direction in _DIRECTIONS:
        packet = _value(packets, direction)
        if isinstance(packet, Branch):
            for key, present in (("covers_id", "trailer"), (direction, "buses")):
                _move_assumptions(checksum, {key: present}, packet)


def _mapping(entries: Mapping[str, Text | Branch], flow: bool = True) -> Branch:
    children = [Child(_text(key), value) for key, value in entries.items()]
    return Branch(True, flow, 0, children)


def _convert_errata(root: Branch) -> bool:
    """Change paths of protocol sections, and printed keys of the framing of a UART."""
    is_converted = False
    for item in [*_branches(root)]:
        where = _value(item, "where")
        for place in _branches(where) if isinstance(where, Branch) else ():
            section = _entry(place, "section")
            if not section or not isinstance(section.value, Text):
                continue
            path = str(section.value.value)
            for earlier, present in _PATHS.items():
                if path == earlier or path.startswith(f"{earlier}."):
                    section.value = _text(present + path.removeprefix(earlier))
                    is_converted = True
                    break
            if path == "protocol.uart.framing":
                _rename(_value(item, "printed"), _FRAMING)
    return is_converted


def _rename(value: object, keys: Mapping[str, str]) -> None:
    for entry in _entries(value):
        if key := keys.get(name(entry.key)):
            entry.key = _text(key)


def _part_of(section: Branch, key: str) -> Branch | None:
    """Return the mapping of a key, which is added if it is missing; None if the key has
    another value.
    """
    entry = _entry(section, key)
    if entry is None:
        entry = Child(_text(key), Branch(True, False, 0))
        section.children.append(entry)
    is_mapping = isinstance(entry.value, Branch) and entry.value.mapping
    return entry.value if is_mapping else None  # type: ignore[return-value]


def _move(section: Branch, keys: Mapping[str, str], target: Branch) -> None:
    """Move entries to another mapping, under their present keys."""
    for key, present_key in keys.items():
        if entry := _entry(section, key):
            section.children.remove(entry)
            entry.key = _text(present_key)
            target.children.append(entry)


def _convert_framing(link: Branch) -> None:
    framing = _entry(link, "delimited_by")
    if framing and isinstance(framing.value, Text):
        by = _text("datagram") if framing.value.value == "none" else framing.value
        framing.key = _text("framing")
        framing.value = Branch(True, True, 0, [Child(_text("by"), by)])


def _convert_uart(uart: object) -> None:
    """Give a UART the keys of framed links for its line and its framing."""
    if not isinstance(uart, Branch) or not uart.mapping:
        return
    if any(_entry(uart, key) for key in _LINE) and (line := _part_of(uart, "line")):
        _move(uart, _LINE, line)
        _move_assumptions(uart, _LINE, line)
    framing = _entry(uart, "framing")
    if framing and isinstance(framing.value, Branch) and framing.value.mapping:
        for owner in (framing.value, _value(framing.value, "assumptions")):
            _rename(owner, _FRAMING)
        framing.value.children.insert(0, Child(_text("by"), _text("escape")))


def _move_assumptions(section: Branch, keys: Mapping[str, str], target: Branch) -> None:
    """Move the reasons for the assumed values of moved keys."""
    reasons = _entry(section, "assumptions")
    if reasons is None or not isinstance(reasons.value, Branch):
        return
    if any(_entry(reasons.value, key) for key in keys):
        moved = _part_of(target, "assumptions")
        if moved is not None:
            _move(reasons.value, keys, moved)
        if not reasons.value.children:
            section.children.remove(reasons)


def _move_covers(link: Branch) -> None:
    """Move what each checksum covers to the fields that have none of their own."""
    checksums = _entry(link, "checksums")
    declared = {}
    for checksum in _entries(checksums.value) if checksums else ():
        covers = _entry(checksum.value, "covers")
        if covers:
            _entries(checksum.value).remove(covers)
            declared[name(checksum.key)] = covers
    for field in _branches(link):
        named = _entry(field, "checksum")
        if not named or not isinstance(named.value, Text) or _entry(field, "covers"):
            continue
        if covers := declared.get(named.value.spelling):
            field.children.append(copy.deepcopy(covers))
            covers.before, covers.trailing = [], []  # only the first gets the comments


def _value(value: object, key: str) -> object:
    """Return the value of a key; None without one."""
    entry = _entry(value, key)
    return entry.value if entry else None


def _branches(branch: Branch) -> Iterator[Branch]:
    """Yield a mapping or sequence and all that are in it."""
    yield branch
    for child in branch.children:
        if isinstance(child.value, Branch):
            yield from _branches(child.value)
