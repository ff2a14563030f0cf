"""The table of a message -> its ids, length and fields."""

from __future__ import annotations

import re

from icdgen.importer import labels
from icdgen.importer.document import DOUBTFUL, Table, Trouble
from icdgen.importer.profile import Profile
from icdgen.importer.understand import descriptions, formulas, numbers
from icdgen.importer.understand.model import ReadField, ReadMessage
from icdgen.importer.understand.rows import Entry, entries
from icdgen.importer.words import folded, number, plain, tidy_unit

KINDS = ("telecommand", "telemetry", "configuration")


def read(table: Table, profile: Profile, troubles: list[Trouble]) -> ReadMessage | None:
    """The message of the table; None where nothing in it says that it is one."""
    given = _labelled(table, profile)
    values = {one.what: one.value for one in given if one.value}
    both = values.get("both_ids", "")
    if not both and "set_id" in values and "get_id" in values:
        both = f"{values['set_id']}/{values['get_id']}"
    has_id = bool(both) or "id" in values
    if not has_id and table.header is None:
        return None
    message = ReadMessage("", "", table)
    _ids(message, values, both, troubles)
    message.kind = _kind(values, both)
    message.names = _names(table.caption, profile, message)
    length = values.get("telecommand_length") or values.get("telemetry_length") or values.get("length")
    if length is not None:
        message.length = numbers.whole(length, "the length", table.title, table.spot, troubles)
    message.summary = _summary(table, profile)
    if table.header is not None:
        for entry in entries(table, troubles):
            if found := _field(entry, table, profile, troubles):
                message.fields.append(found)
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
    for row in table.head:
        text = " ".join(cell for cell in row.cells if cell)
        what = labels.leads(text, profile)
        if what == "description" or (what == "fields" and not any(c.isdigit() for c in text)):
            pending = ""
            continue
        bare = text.split()
        if pending and bare and all(number(w) is not None or re.match(r"[0-9]+/[0-9]+\Z", w) for w in bare):
            found += _below(pending, bare, profile)
            pending = ""
            continue
        parts = labels.parse(f"{pending} {text}".strip(), profile)
        pending = ""
        if parts and not parts[-1].value:
            pending = parts.pop().label
        found += [one for one in parts if one.what]
    return found


def _below(label: str, values: list[str], profile: Profile) -> list[labels.Labelled]:
    """Labels in one row, their values in the next."""
    words, made = label.split(), []
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


def _ids(message: ReadMessage, values: dict[str, str], both: str, troubles: list[Trouble]) -> None:
    if both:
        first, _, second = both.partition("/")
        message.set_id, message.get_id = number(first), number(second)
    elif "id" in values:
        first, _, second = values["id"].partition("/")
        if second:
            message.set_id, message.get_id = number(first), number(second)
        else:
            message.id = number(first)


def _kind(values: dict[str, str], both: str) -> str:
    if both or "/" in values.get("id", ""):
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
        text = " ".join(cell for cell in row.cells if cell)
        if labels.leads(text, profile) == "description":
            words = text.split()
            for length in range(min(5, len(words)), 0, -1):
                if labels.meaning(" ".join(words[:length]), profile) == "description":
                    return " ".join(words[length:]).lstrip(":- ")
    return ""


def _field(entry: Entry, table: Table, profile: Profile, troubles: list[Trouble]) -> ReadField | None:
    name = entry.get("name")
    where = f"{table.title}, field `{name}`" if name else table.title
    place = _place(entry, where, troubles)
    if place is None:
        return None
    at, bits = place
    kind, own_bits = _type(entry, profile, where, bits, troubles)
    bits = bits or own_bits
    if not bits:
        troubles.append(Trouble("IMP023", f"{where}: neither a width nor a type that tells it", entry.spot,
                                "look at the page; the row was left out", "error"))  # fmt: skip
        return None
    if not name:
        troubles.append(Trouble("IMP025", f"{table.title}: the field at bit {at} has no name", entry.spot,
                                "name it in the ICD, or by an erratum", "error"))  # fmt: skip
        name = f"Unnamed {at}"
    described = _described(entry, profile, kind == "enum")
    for problem in described.problems:
        severity = "warning"
        text = entry.get("description")
        troubles.append(
            Trouble("IMP040", f"{where}: {problem}: `{text[-160:]}`", entry.spot, "read the page", severity)
        )
    return ReadField(name, at, bits, kind, described, entry.spot)


def _place(entry: Entry, where: str, troubles: list[Trouble]) -> tuple[int, int] | None:
    """Offset and width in bits; 0 for a width that is not given."""
    by_byte = not entry.get("at") and bool(entry.get("at_bytes"))
    text = entry.get("at_bytes") if by_byte else entry.get("at")
    scale = 8 if by_byte else 1
    bits: int | None = 0
    if span := numbers.span(text):
        at, bits = span[0] * scale, span[1] * scale
    else:
        first = numbers.whole(text, "the offset", where, entry.spot, troubles)
        if first is None:
            return None
        at = first * scale
        if not by_byte and number(entry.get("at_bytes")) is not None:
            at += 8 * (number(entry.get("at_bytes")) or 0)  # a column for the byte, one for the bit in it
    for role, factor in (("bits", 1), ("bits_bytes", 8)):
        if entry.get(role):
            width = numbers.whole(entry.get(role), "the width", where, entry.spot, troubles)
            if width is None:
                return None
            bits = width * factor
            break
    return at, bits


def _type(entry: Entry, profile: Profile, where: str, bits: int, troubles: list[Trouble]) -> tuple[str, int]:
    """Type and the width that its name tells (0: none)."""
    text = entry.get("type")
    rule = profile.types.get("".join(folded(text)))
    if rule is None and (match := re.match(r"([A-Za-z]+)\s*[\[(]?\s*([0-9]+)\s*[\])]?\Z", plain(text))):
        rule = profile.types.get(match[1].casefold())
        if rule is not None:
            times = 8 if rule["type"] == "bytes" else 1
            return rule["type"], int(match[2]) * times
    if rule is not None:
        return rule["type"], rule.get("bits", 1 if rule["type"] == "bool" else 0)
    what = f"the type `{text}` is unknown" if text else "it has no type"
    fallback = "uint" if bits <= 64 else "bytes"
    troubles.append(Trouble("IMP026", f"{where}: {what}", entry.spot,
                            f"held as {fallback}; add the name to `types:` of the profile", "error"))  # fmt: skip
    return fallback, 0


def _described(entry: Entry, profile: Profile, is_enum: bool) -> descriptions.Described:
    text = entry.get("description")
    if is_enum and entry.get("values"):
        text = f"{text} {entry.get('values')}"
    made = descriptions.read(text, profile, is_enum)
    if is_enum and made.enum_table is None and not made.enum_title and entry.get("values"):
        made.enum_title = entry.get("values")
    unit = tidy_unit(entry.get("unit")).strip("()- ")
    if unit and unit.casefold() not in ("na", "n/a", "none", "–"):
        if made.unit and made.unit != unit:
            made.problems.append(f"its unit is `{unit}` in one column and `{made.unit}` in another")
        made.unit = unit
    formula = entry.get("formula").strip()
    if formula and formula.casefold() not in ("-", "–", "n/a", "na", "none"):
        found = formulas.alone(formula, descriptions.names(profile))
        if found:
            made.formula = found
        elif number(formula) != 1 and formula not in ("1.0",):
            made.problems.append(f"the formula `{formula}` cannot be read")
    return made


def gaps(message: ReadMessage) -> list[tuple[int, int]]:
    """Runs of bits, first and last, that no field covers."""
    if message.length is None:
        return []
    total = 8 * message.length
    free, at = [], 0
    for one in sorted(message.fields, key=lambda f: f.at):
        if one.at > at:
            free.append((at, min(one.at, total) - 1))
        at = max(at, one.at + one.bits)
    if at < total:
        free.append((at, total - 1))
    return [(a, b) for a, b in free if b >= a]
