"""Rules within the text of a profile: one rule is replaced or added, everything else
keeps its place and its comments.
"""

from __future__ import annotations

import re
from typing import Any

from icdgen.diagnostics import Finding, Findings, Place
from icdgen.icd import source
from icdgen.icd.located import Seq, plain

ORDER = (
    "rule", "like", "tables", "what", "message", "columns", "lines", "melt", "each", "map", "set", "skip", "stop", "keep", "join",
    "fill", "glue", "ignore", "absent", "head_rows", "group_rows", "transpose", "also", "width", "origin", "base",
)  # fmt: skip
NEW = "profile: 1\nnode: {}\nrules: []\n"
_PLAIN = re.compile(r"[A-Za-z_(][\w (|)./+-]*[\w)]|[A-Za-z]")
_WORDS = {"y", "n", "yes", "no", "on", "off", "true", "false", "null"}
_INDENT = "  "


def text_of_rule(rule: dict[str, Any]) -> str:
    """Return the lines of a rule as an entry of `rules:`, in the order of the
    reference.
    """
    keys = [key for key in ORDER if key in rule] + [
        key for key in rule if key not in ORDER
    ]
    lines: list[str] = []
    for key in keys:
        value = rule[key]
        if isinstance(value, dict) and (
            len(_flow(value)) > 90 or (key in ("columns", "lines") and len(value) > 3)
        ):
            lines.append(f"{key}:")
            lines += [
                f"  {_scalar(str(name))}: {_flow(entry)}"
                for name, entry in value.items()
            ]
        else:
            lines.append(f"{key}: {_flow(value)}")
    return "".join(
        f"{_INDENT}{'- ' if index == 0 else '  '}{line}\n"
        for index, line in enumerate(lines)
    )


def _flow(value: Any) -> str:
    if isinstance(value, dict):
        return (
            "{"
            + ", ".join(
                f"{_scalar(str(key))}: {_flow(entry)}" for key, entry in value.items()
            )
            + "}"
        )
    if isinstance(value, list):
        return "[" + ", ".join(map(_flow, value)) + "]"
    return _scalar(value)


def _scalar(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return str(value)
    text = str(value)
    if _PLAIN.fullmatch(text) and text.casefold() not in _WORDS:
        return text
    return "'" + text.replace("'", "''").replace("\n", " ") + "'"


def with_rule(
    text: str, index: int | None, rule: dict[str, Any] | None, behind: int | None = None
) -> str:
    """Return the text with a rule replaced (``index``), added (no index), or removed
    (no rule).

    It is added behind the rule ``behind``, or behind the last one. Raises `Findings` if
    the text is no YAML.
    """
    block = text_of_rule(rule) if rule is not None else ""
    tree = source.parse(text.encode("utf-8"), "profile")
    rules = tree.get("rules")
    lines = text.splitlines(keepends=True)
    if lines and not lines[-1].endswith("\n"):
        lines[-1] += "\n"
    if "rules" not in tree:
        return "".join(lines) + f"rules:\n{block}"
    # Without a value, `[]`, or `[{...}]` in one line or several.
    if not isinstance(rules, Seq) or not rules or _is_in_brackets(lines, rules):
        first = tree.key_at("rules").line - 1
        texts = [text_of_rule(plain(entry)) for entry in rules or ()]
        added = len(texts) if behind is None else behind + 1
        texts[
            added if index is None else index : added if index is None else index + 1
        ] = [block]
        last = _last_line_of_value(text, "rules")
        lines[first:last] = ["rules:\n" if any(texts) else "rules: []\n", *texts]
        return "".join(lines)
    # Lines are replaced within the text, because a YAML writer would drop comments and
    # the order of keys.
    starts = [rules.item_at(i).line - 1 for i in range(len(rules))]
    block = _indented_like(lines[starts[0]], block)
    next_keys = [
        place.line - 1
        for key in tree
        if (place := tree.key_at(key)).line - 1 > starts[-1]
    ]
    ends = [*starts[1:], min(next_keys, default=len(lines))]
    if index is None:
        before = len(rules) - 1 if behind is None else behind
        end = _last_line(lines, starts[before], ends[before])
        lines[end:end] = [block]
    else:
        lines[starts[index] : _last_line(lines, starts[index], ends[index])] = [block]
        if len(rules) == 1 and rule is None:
            lines[tree.key_at("rules").line - 1] = "rules: []\n"
    return "".join(lines)


def _is_in_brackets(lines: list[str], rules: Seq) -> bool:
    """Return whether rules are a list in brackets."""
    place = rules.place
    return lines[place.line - 1][place.column - 1 :].startswith("[")


def _last_line_of_value(text: str, key: str) -> int:
    """Return the number of the last line of the value of a key, in valid YAML."""
    import yaml

    root: Any = yaml.compose(text, Loader=yaml.SafeLoader)
    name, value = next(pair for pair in root.value if pair[0].value == key)
    # The marks of an empty value may stand behind further lines.
    is_empty = value.start_mark.index == value.end_mark.index
    last: int = (name if is_empty else value).end_mark.line + 1
    return last


def _indented_like(line: str, block: str) -> str:
    """Return a rule with the indentation of the rule that begins in a line."""
    match = re.match(r"( *)- ", line)
    return re.sub(f"^{_INDENT}", match[1], block, flags=re.M) if match else block


def _last_line(lines: list[str], start: int, end: int) -> int:
    """Return the line after a rule.

    Blank lines and comments before the next rule belong to that rule.
    """
    while end > start + 1 and (
        not lines[end - 1].strip() or lines[end - 1].lstrip().startswith("#")
    ):
        end -= 1
    return end


def with_node(text: str, node: dict[str, Any]) -> str:
    """Return the text with another `node:` section.

    Raises `Findings` if the text is no YAML.
    """
    tree = source.parse(text.encode("utf-8"), "profile")
    lines = text.splitlines(keepends=True)
    line = f"node: {_flow(node)}\n"
    if "node" not in tree:
        first = tree.key_at("profile").line if "profile" in tree else 0
        return "".join([*lines[:first], line, *lines[first:]])
    start = tree.key_at("node").line - 1
    behind = [
        place.line - 1 for key in tree if (place := tree.key_at(key)).line - 1 > start
    ]
    end = _last_line(lines, start, min(behind, default=len(lines)))
    return "".join([*lines[:start], line, *lines[end:]])


def rules_of(text: str) -> list[dict[str, Any]]:
    """Return the rules of a profile as plain mappings.

    Raises `Findings` if the text is no YAML.
    """
    tree = source.parse(text.encode("utf-8"), "profile")
    rules = tree.get("rules")
    return [plain(rule) for rule in rules] if isinstance(rules, Seq) else []


def parse_rule(text: str) -> dict[str, Any]:
    """Parse a rule in YAML, with or without the dash of a list.

    Raises `Findings`, also for several rules.
    """
    dash = re.match(r"(?:\s*\n|\s*#.*\n)*( *)-(?= )", text)
    items = list(re.finditer(rf"^{dash[1]}- ", text, re.M)) if dash else []
    if len(items) > 1:
        place = Place("rule", text.count("\n", 0, items[1].start()) + 1)
        help = "leave one list item, and add each other rule with `Add another rule for this table`"
        raise Findings(
            [
                Finding(
                    "IMP001",
                    f"one rule only: the text has {len(items)} list items",
                    place,
                    help,
                )
            ]
        )
    if dash:
        text = f"{text[: dash.end() - 1]} {text[dash.end() :]}"
    tree = source.parse(text.encode("utf-8"), "rule")
    return {key: plain(value) for key, value in tree.items()}
