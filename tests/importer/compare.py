"""What differs between two ICD trees in the facts that a manual's tables print."""

from __future__ import annotations

_MESSAGE = ("id", "set_id", "get_id", "kind", "length", "group", "listed")
_FIELD = ("bits", "type", "enum", "unit", "formula", "formula_for", "const")


def differences(wanted: dict, got: dict, tables: bool = True) -> list[str]:
    """One line per difference; empty where every message, field, enumeration and
    loggable frame is equal.

    ``tables``: the table numbers too.
    """
    found: list[str] = []
    found += _named(
        "message",
        _messages(wanted),
        _messages(got),
        lambda a, b: _message(a, b, tables),
    )
    found += _named(
        "enumeration",
        wanted.get("enums", []),
        got.get("enums", []),
        lambda a, b: _enum(a, b, tables),
    )
    found += _same(
        "loggable",
        [(r["bit"], r["id"], r.get("name")) for r in wanted.get("loggable", [])],
        [(r["bit"], r["id"], r.get("name")) for r in got.get("loggable", [])],
    )
    return found


def _messages(tree: dict) -> list[dict]:
    """With what is announced of all formulas of a kind of messages at each of their
    fields.
    """
    announced = tree.get("formula_for", {})
    return [
        message
        | {
            "fields": [
                (
                    {"formula_for": announced[message["kind"]], **field}
                    if "formula" in field and message["kind"] in announced
                    else field
                )
                for field in message.get("fields", [])
            ]
        }
        for message in tree.get("messages", [])
    ]


def _named(what: str, wanted: list, got: list, compare) -> list[str]:
    left, right = {i["name"]: i for i in wanted}, {i["name"]: i for i in got}
    found = [f"{what} {name} is missing" for name in left if name not in right]
    found += [
        f"{what} {name} is not in the manual" for name in right if name not in left
    ]
    for name in left:
        if name in right:
            found += [
                f"{what} {name}: {line}" for line in compare(left[name], right[name])
            ]
    if not found and list(left) != list(right):
        found.append(f"{what}s stand in another order")
    return found


def _message(wanted: dict, got: dict, tables: bool) -> list[str]:
    found = [
        line for key in _MESSAGE for line in _same(key, wanted.get(key), got.get(key))
    ]
    if tables:
        found += _same("table", _table(wanted), _table(got))
    left = {(f["at"], f["name"]): f for f in wanted.get("fields", [])}
    right = {(f["at"], f["name"]): f for f in got.get("fields", [])}
    found += [
        f"field {at} {name} is missing" for at, name in left if (at, name) not in right
    ]
    found += [
        f"field {at} {name} is not in the manual"
        for at, name in right
        if (at, name) not in left
    ]
    for key in left:
        if key in right:
            for fact in _FIELD:
                found += [
                    f"field {key}: {line}"
                    for line in _same(fact, left[key].get(fact), right[key].get(fact))
                ]
    return found


def _enum(wanted: dict, got: dict, tables: bool) -> list[str]:
    found = _same(
        "members",
        [(m["value"], m["name"]) for m in wanted["members"]],
        [(m["value"], m["name"]) for m in got["members"]],
    )
    if tables:
        found += _same("table", _table(wanted), _table(got))
        found += _same(
            "also",
            [s.get("table") for s in wanted.get("also", [])],
            [s.get("table") for s in got.get("also", [])],
        )
    return found


def _table(item: dict) -> object:
    return (item.get("source") or {}).get("table")


def _same(what: str, wanted: object, got: object) -> list[str]:
    return [] if wanted == got else [f"{what}: {wanted!r} -> {got!r}"]
