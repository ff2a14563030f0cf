"""The content of a manual for an ICD: captions, rows and prose, independent of the
layout.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import yaml

from tests.conftest import ROOT

FIELD_TITLES = ["Offset (bits)", "Length (bits)", "Name", "Data Type", "Description"]
_TYPES = {
    "uint": "UINT",
    "int": "INT",
    "bool": "BOOL",
    "enum": "ENUM",
    "bytes": "ARRAY",
}
_CAPTIONS = {
    "telecommand": "Command Format",
    "telemetry": "Telemetry Format",
    "configuration": "Message Format",
}
_LISTS = {
    "telecommand": "Telecommands",
    "telemetry": "Telemetry Frames",
    "configuration": "Configuration Messages",
}


@dataclass
class MessageTable:
    number: int
    title: str
    pairs: list[tuple[str, str]]
    description: str
    label: str
    rows: list[list[str]]


@dataclass
class PlainTable:
    """A table with one heading row. A row of one cell is a group heading."""

    number: int
    title: str
    kind: str  # "list" | "enumeration" | "loggable" | "other"
    titles: list[str]
    rows: list[list[str]]


@dataclass
class Prose:
    text: str
    style: str = "body"  # "body" | "heading" | "code"


Part = MessageTable | PlainTable | Prose


@dataclass
class Manual:
    """The printed content, and the ICDs that an import must give."""

    title: str
    parts: list[Part] = field(default_factory=list)
    trees: dict[str, dict] = field(default_factory=dict)


def shipped(*names: str, most: int | None = None, skip: int = 0) -> dict[str, dict]:
    """Return the vendor layer of shipped nodes with up to ``most`` messages each, after
    ``skip``.
    """
    trees = {}
    for name in names:
        text = Path(ROOT, "icd", f"{name}.yaml").read_text(encoding="utf-8")
        tree = yaml.load(text, yaml.CSafeLoader)
        tree["messages"] = tree["messages"][skip : skip + most if most else None]
        trees[name] = tree
    enum_names = {e["name"] for tree in trees.values() for e in tree.get("enums", [])}
    for tree in trees.values():
        announced = tree.pop("formula_for", {})
        for message in tree["messages"]:
            for entry in message.get("fields", []):
                if "formula" in entry and message["kind"] in announced:
                    entry.setdefault("formula_for", announced[message["kind"]])
                if entry.get("enum") not in (None, *enum_names):
                    entry["type"] = "uint"
                    del entry["enum"]
    return trees


def manual(
    trees: dict[str, dict], titles: dict[str, str], noise: bool = True
) -> Manual:
    """Return the manual of these nodes. ``titles`` are the names of the nodes in it."""
    result = Manual("Reference Manual", trees=trees)
    number = 1
    if noise:
        result.parts += _introduction()
    for section, (name, tree) in enumerate(trees.items(), 3):
        number = _node(result, tree, titles[name], section, number + 1, noise)
    return result


def _node(
    result: Manual, tree: dict, title: str, section: int, number: int, noise: bool
) -> int:
    enums = {enum["name"]: enum for enum in tree.get("enums", [])}
    everywhere = {
        e["name"]: e for t in result.trees.values() for e in t.get("enums", [])
    }
    tables: dict[str, int] = {}
    kinds = [k for k in _LISTS if any(m["kind"] == k for m in tree["messages"])]
    plan: list[tuple[str, object]] = []
    printed: set[str] = set()
    for kind in kinds:
        plan.append(("list", kind))
        for message in (m for m in tree["messages"] if m["kind"] == kind):
            plan.append(("message", message))
            for entry in message.get("fields", []):
                if entry.get("enum") in enums and entry["enum"] not in printed:
                    printed.add(entry["enum"])
                    plan.append(("enum", enums[entry["enum"]]))
    plan += [("enum", enum) for name, enum in enums.items() if name not in printed]
    for what, item in plan:
        tables[f"{what} {item if isinstance(item, str) else item['name']}"] = number
        if what != "list":
            item["source"] = {"table": number}
            item.pop("also", None)
        number += 1
    by_name = {n: (e.get("source") or {}).get("table") for n, e in everywhere.items()}
    result.parts.append(Prose(f"{section}. {title} messages", "heading"))
    for position, (what, item) in enumerate(plan):
        if what == "list":
            result.parts.append(_list(tree, item, title, tables))
        elif what == "message":
            result.parts.append(
                _message(item, tables[f"message {item['name']}"], by_name)
            )
        else:
            result.parts.append(_enum(item, tables[f"enum {item['name']}"]))
        if noise and position % 5 == 3:
            result.parts += _chatter(
                position,
                tables.get(
                    f"{what} {item if isinstance(item, str) else item['name']}", 1
                ),
            )
    tree["enums"] = sorted(tree.get("enums", []), key=lambda e: e["source"]["table"])
    tree["messages"] = sorted(tree["messages"], key=lambda m: m["source"]["table"])
    if not tree["enums"]:
        del tree["enums"]
    if tree.get("loggable"):
        result.parts.append(_log(tree["loggable"], number))
        number += 1
    return number


def _introduction() -> list[Part]:
    return [
        Prose("1. Introduction", "heading"),
        Prose("This manual describes every message of the device. Messages are telecommands, which are sent to it, and "
              "telemetry, which is requested from it. Bits are counted from the first byte of the frame."),
        Prose("Table 1 lists the speeds of the serial line. The device answers at the speed at which it was asked."),
        PlainTable(1, "Serial line", "other", ["Parameter", "Setting"], [["Speed", "115200"], ["Parity", "none"]]),
        Prose("uint8_t sum = 0;\nfor (int i = 0; i < n; i++) sum ^= data[i];\nreturn sum;", "code"),
        Prose("2. Conventions", "heading"),
        Prose("Offsets and lengths are given in bits. A value of 0 means that a function is off unless the table says "
              "otherwise; see also the chapter on error handling, where 3 of 12 cases are explained at length."),
    ]  # fmt: skip


def _chatter(position: int, number: int) -> list[Part]:
    return [
        Prose(f"Table {number}: as shown above, the order of bits follows the convention of the first chapter, so that a "
              "receiver may decode the frame while it arrives and need not wait for the end of the whole message."),
        Prose("The device keeps the last value until the next one comes. After a restart all values are zero."),
    ][: 1 + position % 2]  # fmt: skip


def _message(message: dict, number: int, enum_tables: dict[str, int]) -> MessageTable:
    kind = message["kind"]
    if kind == "configuration":
        ids = ("Set ID/Get ID", f"{message['set_id']}/{message['get_id']}")
    else:
        ids = ("ID", str(message["id"]))
    length = (
        "Frame Length (bytes)" if kind == "telemetry" else "Parameters Length (bytes)"
    )
    rows = [
        [
            str(f["at"]),
            str(f["bits"]),
            f["name"],
            _type(f),
            _description(f, enum_tables),
        ]
        for f in message.get("fields", [])
    ]
    return MessageTable(
        number, f"{message['name']} {_CAPTIONS[kind]}", [ids, (length, str(message["length"]))],
        f"{message['name']} of the device", "Channels" if kind == "telemetry" else "Parameters", rows,
    )  # fmt: skip


def _type(field: dict) -> str:
    if field["type"] == "float":
        return "DOUBLE" if field["bits"] == 64 else "FLOAT"
    return _TYPES[field["type"]]


def _description(field: dict, enum_tables: dict[str, int]) -> str:
    text = field["name"]
    unit = field.get("unit")
    if field.get("enum"):
        text += f". Possible values are in Table {enum_tables[field['enum']]}: {field['enum']} Enumeration Values"
    if "const" in field:
        text += f". Should equal 0x{field['const']:X}"
    formula = field.get("formula")
    if formula and formula.startswith("raw ="):
        expression = (
            formula.removeprefix("raw =").strip().replace("value", "(formatted value)")
        )
        text += f". Raw parameter value is obtained using the formula: (raw parameter) = {expression}"
        text += f" (formatted value is in [{unit}] units)" if unit else ""
    elif formula:
        announced = (
            "Raw parameter value"
            if field.get("formula_for") == "raw"
            else "Formatted value"
        )
        of = f"(formatted value) [{unit}]" if unit else "(formatted value)"
        text += f". {announced} is obtained using the formula: {of} = {formula.replace('raw', 'RAWVAL')}"
    elif unit:
        text += f". (Unit of measure is [{unit}])"
    return text


def _list(tree: dict, kind: str, title: str, tables: dict[str, int]) -> PlainTable:
    two = kind == "configuration"
    titles = (["Set ID", "Get ID"] if two else ["ID"]) + [
        "Name",
        "Description",
        "Length (bytes)",
    ]
    rows: list[list[str]] = []
    group = None
    for message in sorted(
        (m for m in tree["messages"] if m["kind"] == kind),
        key=lambda m: m.get("group", ""),
    ):
        if message.get("group") != group:
            group = message.get("group")
            rows.append([group or ""])
        ids = (
            [str(message["set_id"]), str(message["get_id"])]
            if two
            else [str(message["id"])]
        )
        name = message["name"]
        about = f"{name} - Table {tables[f'message {name}']}: {name} {_CAPTIONS[kind]}"
        rows.append([*ids, name, about, str(message["length"])])
    return PlainTable(
        tables[f"list {kind}"], f"List of {title} {_LISTS[kind]}", "list", titles, rows
    )


def _enum(enum: dict, number: int) -> PlainTable:
    rows = [
        [str(m["value"]), m["name"], f"{m['name']} is chosen"] for m in enum["members"]
    ]
    return PlainTable(
        number,
        f"{enum['name']} Enumeration Values",
        "enumeration",
        ["Numeric Value", "Name", "Description"],
        rows,
    )


def _log(loggable: list[dict], number: int) -> PlainTable:
    size = max(row["bit"] for row in loggable) // 8 + 1
    rows = [
        [
            (1 << row["bit"]).to_bytes(size, "little").hex(" ").upper(),
            str(row["id"]),
            row.get("name", ""),
        ]
        for row in loggable
    ]
    return PlainTable(
        number,
        "Loggable Telemetry Frames",
        "loggable",
        ["Mask", "Telemetry ID", "Telemetry Frame"],
        rows,
    )
