"""Compare two ICD trees in the facts that the tables of a manual contain."""

from __future__ import annotations

_MESSAGE = ("id", "set_id", "get_id", "kind", "length", "group", "listed")
_FIELD = ("bits", "type", "enum", "unit", "formula", "formula_for", "const")


def differences(wanted: dict, got: dict, tables: bool = True) -> list[str]:
    """Return one line per difference; empty if all messages, fields, enumerations and
    loggable frames are equal. ``tables``: compare the table numbers too.
    """
    texts: list[str] = []
    texts += _named(
        "message",
        _messages(wanted),
        _messages(got),
        lambda a, b: _message(a, b, tables),
    )
    texts += _named(
        "enumeration",
        wanted.get("enums", []),
        got.get("enums", []),
        lambda a, b: _enum(a, b, tables),
    )
    texts += _same(
        "loggable",
        [(r["bit"], r["id"], r.get("name")) for r in wanted.get("loggable", [])],
        [(r["bit"], r["id"], r.get("name")) for r in got.get("loggable", [])],
    )
    return texts


def _messages(tree: dict) -> list[dict]:
    """Return the messages with formulas that are announced for all fields of a kind of
    message.
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
    texts = [f"{what} {name} is missing" for name in left if name not in right]
    texts += [
        f"{what} {name} is not in the manual" for name in right if name not in left
    ]
    for name in left:
        if name in right:
            texts += [
                f"{what} {name}: {line}" for line in compare(left[name], right[name])
            ]
    if not texts and list(left) != list(right):
        texts.append(f"{what}s stand in another order")
    return texts


def _message(wanted: dict, got: dict, tables: bool) -> list[str]:
    texts = [
        line for key in _MESSAGE for line in _same(key, wanted.get(key), got.get(key))
    ]
    if tables:
        texts += _same("table", _table(wanted), _table(got))
    left = {(f["at"], f["name"]): f for f in wanted.get("fields", [])}
    right = {(f["at"], f["name"]): f for f in got.get("fields", [])}
    texts += [
        f"field {at} {name} is missing" for at, name in left if (at, name) not in right
    ]
    texts += [
        f"field {at} {name} is not in the manual"
        for at, name in right
        if (at, name) not in left
    ]
    for key in left:
        if key in right:
            for fact in _FIELD:
                texts += [
                    f"field {key}: {line}"
                    for line in _same(fact, left[key].get(fact), right[key].get(fact))
                ]
    return texts


def _enum(wanted: dict, got: dict, tables: bool) -> list[str]:
    texts = _same(
        "members",
        [(m["value"], m["name"]) for m in wanted["members"]],
        [(m["value"], m["name"]) for m in got["members"]],
    )
    if tables:
        texts += _same("table", _table(wanted), _table(got))
        texts += _same(
            "also",
            [s.get("table") for s in wanted.get("also", [])],
            [s.get("table") for s in got.get("also", [])],
        )
    return texts


def _table(item: dict) -> object:
    return (item.get("source") or {}).get("table")


def _same(what: str, wanted: object, got: object) -> list[str]:
    return [] if wanted == got else [f"{what}: {wanted!r} -> {got!r}"]
