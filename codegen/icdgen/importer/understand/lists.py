"""List tables, enumeration tables and the table of loggable frames."""

from __future__ import annotations

import re

from icdgen.importer.document import Table, Trouble
from icdgen.importer.profile import Profile
from icdgen.importer.understand import descriptions, numbers
from icdgen.importer.understand.model import Listed, LogBit, ReadEnum, ReadList, ReadLog, ReadMember
from icdgen.importer.understand.rows import entries
from icdgen.importer.words import number, plain, table_name

_MASK = re.compile(r"(?:0x)?(?:[0-9A-Fa-f]{2}\s*)+\Z")


def listing(table: Table, profile: Profile, troubles: list[Trouble]) -> ReadList:
    """A list of messages."""
    kind, node = list_title(table.caption, profile)
    two = table.header is not None and "set_id" in table.header.roles and "get_id" in table.header.roles
    kind = kind or ("configuration" if two else "")
    made = ReadList(kind, node, [])
    for entry in entries(table, troubles):
        title = f"{table.title}, `{entry.get('name')}`"
        length = None
        if entry.get("length"):
            length = numbers.whole(entry.get("length"), "the length", title, entry.spot, troubles)
        ids = {role: number(entry.get(role)) for role in ("id", "set_id", "get_id")}
        if "/" in entry.get("id"):
            first, _, second = entry.get("id").partition("/")
            ids = {"id": None, "set_id": number(first), "get_id": number(second)}
        if all(value is None for value in ids.values()):
            troubles.append(Trouble("IMP023", f"{title}: it has no id", entry.spot, "the row was left out", "error"))
            continue
        named = descriptions.profile_caption_in(entry.get("description"), profile)
        made.rows.append(
            Listed(kind, entry.get("name"), length, ids["id"], ids["set_id"], ids["get_id"], entry.group, entry.spot,
                   named[0] if named else None)
        )  # fmt: skip
    return made


def list_title(caption: str, profile: Profile) -> tuple[str, str]:
    """Kind of messages and name of the node in the caption of a list; "" for what it does not say."""
    best: tuple[int, str, str] | None = None
    for what in ("telecommand list", "telemetry list", "configuration list"):
        for pattern in profile.titles[what]:
            if match := pattern.match(plain(caption)):
                node = match.groupdict().get("node") or ""
                if best is None or len(node) < best[0]:
                    best = (len(node), what.split()[0], node.strip())
    return best[1:] if best else ("", "")


def enumeration(table: Table, profile: Profile, troubles: list[Trouble]) -> ReadEnum | None:
    """An enumeration."""
    name = enum_name(table.caption, profile)
    if not name:
        name = f"Table {table_name(table.number)}" if table.number else f"Values of page {table.page or 1}"
        troubles.append(Trouble("IMP025", f"{table.title}: nothing names the enumeration", table.spot,
                                f"held as `{name}`: name it in the ICD", "error"))  # fmt: skip
    made = ReadEnum(name, [], table)
    for entry in entries(table, troubles):
        value = numbers.whole(entry.get("value"), "the value", table.title, entry.spot, troubles)
        if value is None:
            continue
        if not entry.get("name"):
            troubles.append(Trouble("IMP025", f"{table.title}: the value {value} has no name", entry.spot,
                                    "the row was left out", "error"))  # fmt: skip
            continue
        made.members.append(ReadMember(value, entry.get("name"), entry.get("description")))
    return made if made.members else None


def enum_name(caption: str, profile: Profile) -> str:
    """The enumeration's name in the caption: what the tightest fitting title leaves."""
    names = [m["name"].strip() for pattern in profile.titles["enumeration"] if (m := pattern.match(plain(caption)))]
    return min(names, key=len) if names else plain(caption)


def log(table: Table, troubles: list[Trouble]) -> ReadLog:
    """The frames that can be logged, by the bit of the mask."""
    made = ReadLog([])
    for entry in entries(table, troubles):
        bit = bit_of_mask(entry.get("mask")) if entry.get("mask") else number(entry.get("bit"))
        frame = numbers.whole(entry.get("id"), "the id", table.title, entry.spot, troubles)
        if bit is None:
            text = entry.get("mask") or entry.get("bit")
            troubles.append(Trouble("IMP023", f"{table.title}: `{text}` is not a mask with one bit", entry.spot,
                                    "the row was left out", "error"))  # fmt: skip
        elif frame is not None:
            made.bits.append(LogBit(bit, frame, entry.get("name")))
    return made


def bit_of_mask(text: str) -> int | None:
    """The number of the one bit in a mask of bytes whose first byte has the lowest bits; None if it is no such mask."""
    if not _MASK.match(text.strip()):
        return None
    data = bytes.fromhex(text.strip().removeprefix("0x").replace(" ", ""))
    value = int.from_bytes(data, "little")
    return value.bit_length() - 1 if value and value & (value - 1) == 0 else None
