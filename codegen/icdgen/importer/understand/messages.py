"""The table of a message -> its ids, length and fields."""

from __future__ import annotations

import re

from icdgen.importer import labels
from icdgen.importer.document import DOUBTFUL, Table, Trouble
from icdgen.importer.profile import Profile
from icdgen.importer.understand import around, fields, numbers
from icdgen.importer.understand.around import Around
from icdgen.importer.understand.model import ReadMessage
from icdgen.importer.words import BY_HAND, grows, number, plain

KINDS = ("telecommand", "telemetry", "configuration")


def read(table: Table, profile: Profile, troubles: list[Trouble], about: Around | None = None) -> ReadMessage | None:
    """The message of the table; None where nothing in it, or in what stands around it, says that it is one."""
    given = _labelled(table, profile)
    values = {one.what: one.value for one in given if one.value}
    both = values.get("both_ids", "")
    if not both and "set_id" in values and "get_id" in values:
        both = f"{values['set_id']}/{values['get_id']}"
    elif not both and "/" in values.get("id", ""):
        both = values["id"]
    has_id = bool(both) or "id" in values
    said = around.read(about or Around(table.caption), profile)
    if table.header is None:
        if not has_id:
            return None
    elif not has_id and not said.ids and not table.header.has_offsets and not _is_titled(table, profile):
        return None
    message = ReadMessage("", "", table)
    _ids(message, values, both)
    message.kind = _kind(values, both)
    message.names = _names(table.caption, profile, message)
    take(message, said)
    length = values.get("telecommand_length") or values.get("telemetry_length") or values.get("length") or said.length
    if length and grows(length):
        message.lacks = f"its length `{length}` depends on a count, which import does not read: {BY_HAND}"
    elif length:
        message.length = numbers.whole(length, "the length", table.title, table.spot, troubles)
    message.summary = _summary(table, profile)
    if table.header is not None:
        try:
            message.fields = fields.read(message, profile, troubles)
        except fields.Unreadable:
            message.lacks = "-"
            return message
        _contradictions(message, troubles)
        if not message.fields:
            troubles.append(Trouble("IMP024", f"{table.title}: it has headings for fields and no field", table.spot,
                                    "look at the page: the rest may stand on the next one", sure=DOUBTFUL))  # fmt: skip
    return message


def _contradictions(message: ReadMessage, troubles: list[Trouble]) -> None:
    """Fields whose formula gives what the words before it do not announce: one finding for all of a table."""
    for words, gives in (("raw", "physical"), ("physical", "raw")):
        found = [f.name for f in message.fields if f.described.formula_for == words]
        if found:
            which = f"the formula of `{found[0]}`" + (f" and of {len(found) - 1} more fields" if found[1:] else "")
            troubles.append(
                Trouble("IMP041", f"{message.table.title}: {which} is announced as giving the {words} value and gives the "
                        f"{gives} one", message.table.spot,
                        "taken as printed; `formula_for` keeps what the words say: find out which holds")
            )  # fmt: skip


def _labelled(table: Table, profile: Profile) -> list[labels.Labelled]:
    """What the rows above the headings label, up to the description."""
    found: list[labels.Labelled] = []
    pending = ""
    torn: labels.Labelled | None = None  # its value stands beside the first line of a label that may have more
    for row in table.head:
        text = row.text
        what = labels.leads(text, profile)
        if what == "description" or (what == "fields" and not any(c.isdigit() for c in text)):
            pending, torn = "", None
            continue
        bare = text.split()
        if pending and bare and all(number(w) is not None or re.match(r"[0-9]+/[0-9]+\Z", w) for w in bare):
            found += _below(pending, bare, profile)
            pending = ""
            continue
        parts = labels.parse(f"{pending} {text}".strip(), profile)
        if torn and len(parts) == 1 and not parts[0].value:
            whole = f"{torn.label} {parts[0].label}"
            torn = labels.Labelled(labels.meaning(whole, profile), whole, torn.value)
            if torn.what:
                found.append(torn)
                pending, torn = "", None
                continue
        else:
            torn = parts[-1] if parts and parts[-1].value and parts[-1].what in ("", "fields") else None
        pending = ""
        if parts and not parts[-1].value:
            pending = parts.pop().label
        found += [one for one in parts if one.what]
    return found


def _below(label: str, values: list[str], profile: Profile) -> list[labels.Labelled]:
    """Labels in one row, their values in the next."""
    words = label.split()
    made: list[labels.Labelled] = []
    while words and len(made) < len(values):
        for length in range(len(words), 0, -1):
            what = labels.meaning(" ".join(words[:length]), profile)
            if what:
                made.append(labels.Labelled(what, " ".join(words[:length]), values[len(made)]))
                words = words[length:]
                break
        else:
            words = words[1:]
    return made


def _is_titled(table: Table, profile: Profile) -> bool:
    return any(pattern.match(plain(table.caption)) for kind in KINDS for pattern in profile.titles[kind])


def take(message: ReadMessage, said: around.Said) -> None:
    """What stands around the table, where the table does not say it itself."""
    if message.ids == (None, None, None) and said.ids:
        message.id = said.id
        if message.id is None:
            message.lacks = f"its id `{' '.join(said.ids)}` is none that the ICD format can hold"
        if said.name:
            message.names = list(dict.fromkeys([said.name, *message.names]))
    if not message.names and said.name:
        message.names = [said.name]
    if not message.kind and said.kind:
        message.kind = said.kind
    if message.kind == "configuration" and message.id is not None:
        message.set_id = message.get_id = message.id
        message.id = None


def _ids(message: ReadMessage, values: dict[str, str], both: str) -> None:
    if both:
        first, _, second = both.partition("/")
        message.set_id, message.get_id = number(first), number(second)
    elif "id" in values:
        message.id = number(values["id"])


def _kind(values: dict[str, str], both: str) -> str:
    if both:
        return "configuration"
    if "telemetry_length" in values:
        return "telemetry"
    if "telecommand_length" in values:
        return "telecommand"
    return ""


def _names(caption: str, profile: Profile, message: ReadMessage) -> list[str]:
    """What the caption may name, the likeliest first; settles the kind if the caption does."""
    found: list[tuple[int, str, str]] = []
    for kind in KINDS:
        for pattern in profile.titles[kind]:
            if match := pattern.match(plain(caption)):
                found.append((len(match["name"]), kind, match["name"].strip()))
    found.sort(key=lambda f: f[0])
    if message.kind in ("configuration", ""):
        same = [f for f in found if f[1] == message.kind] if message.kind else found
    else:
        same = [f for f in found if f[1] == message.kind] or found
    if same and message.kind != "configuration":
        message.kind = same[0][1]
    names = [name for _, kind, name in same] if same else []
    return list(dict.fromkeys([*names, plain(caption)])) if caption else names


def _summary(table: Table, profile: Profile) -> str:
    for row in table.head:
        what, rest = labels.split(row.text, profile)
        if what == "description":
            return rest.lstrip(":- ")
    return ""


def gaps(message: ReadMessage) -> list[tuple[int, int]]:
    """Runs of bits, first and last, that no field covers."""
    if message.length is None:
        return []
    total = 8 * message.length
    free, at = [], 0
    for start, end in sorted(message.extents()):
        if start > at:
            free.append((at, min(start, total) - 1))
        at = max(at, end)
    if at < total:
        free.append((at, total - 1))
    return [(a, b) for a, b in free if b >= a]
