"""Profiles: the rules for the tables of a document, and the words by which its tables
are found.

A profile is a YAML file. `load` lays it over `profile.yaml`, the built-in words, checks
it and returns a `Profile`. `rules/rule.py` has the rules, and
`docs/reference/import-rules.md` describes all keys.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from icdgen.diagnostics import Finding, Findings
from icdgen.icd import schema, source
from icdgen.icd.located import Map, plain
from icdgen.importer.rules.language import TypeName
from icdgen.importer.rules.rule import TableRule, read_rules
from icdgen.importer.words import folded

DEFAULT = Path(__file__).with_name("profile.yaml")
CODE = "IMP001"
_PLACEHOLDER = re.compile(r"\\?\{(unit|number|table|title)\\?\}")


@dataclass(slots=True)
class NodeWords:
    """Entry of `nodes`: the words by which tables are assigned to the node, and the
    head of its file.
    """

    name: str
    match: list[str] = field(default_factory=list)  # words in list captions
    tables: tuple[int, int] | None = None  # first and last table, where no words tell
    group: int | None = None  # which run of table numbers, where the numbers start anew
    head: dict[str, Any] = field(default_factory=dict)
    include: list[str] = field(default_factory=list)


@dataclass
class Profile:
    """A profile, ready for use."""

    data: dict[str, Any]
    # What was laid over the profile that comes with icdgen.
    own: dict[str, Any] = field(default_factory=dict)
    rules: list[TableRule] = field(default_factory=list)

    @cached_property
    def headings(self) -> dict[str, dict[str, list[tuple[str, ...]]]]:
        """Kind of table -> role -> the headings it may have, as folded words, longest
        first.

        The headings of a rule that the vocabulary does not know are a kind of their
        own: tables without vertical rules are found by their headings.
        """
        return self._headings_of_vocabulary | {
            f"rule {rule.name}": {
                title: [folded(title)]
                for title in (*rule.heading_titles, *rule.column_titles)
            }
            for rule in self._rules_with_unknown_headings
        }

    @cached_property
    def _headings_of_vocabulary(self) -> dict[str, dict[str, list[tuple[str, ...]]]]:
        return {
            kind: {
                role: sorted({folded(text) for text in texts}, key=len, reverse=True)
                for role, texts in roles.items()
                if role != "needs"
            }
            for kind, roles in self.data["headings"].items()
        }

    @cached_property
    def _rules_with_unknown_headings(self) -> list[TableRule]:
        """Rules whose headings the vocabulary does not find: a row with all of them is
        a heading row.
        """
        return [
            rule
            for rule in self.rules
            if rule.heading_titles and not self._finds_headings(rule)
        ]

    def _finds_headings(self, rule: TableRule) -> bool:
        """Return whether the vocabulary of one kind of table finds the heading row of a
        rule.
        """
        headings = {folded(title) for title in rule.heading_titles}
        columns = {folded(title) for title in rule.column_titles}
        for kind, roles in self._headings_of_vocabulary.items():
            vocabulary = {heading for titles in roles.values() for heading in titles}
            # `head` with a title for each column states a whole heading row. Otherwise
            # its titles can be of several rows, such as a group heading above the
            # columns.
            if columns <= headings:
                if headings <= vocabulary:
                    return True
                continue
            roles_of_rule = {
                role
                for role, titles in roles.items()
                if not (headings | columns).isdisjoint(titles)
            }
            if all(
                roles_of_rule.intersection(group)
                for group in self._needs_of_vocabulary[kind]
            ):
                return True
        return False

    @cached_property
    def known_headings(self) -> dict[str, frozenset[tuple[str, ...]]]:
        """Kind of table -> the headings of all its columns."""
        return {
            kind: frozenset(
                heading for headings in roles.values() for heading in headings
            )
            for kind, roles in self.headings.items()
        }

    @cached_property
    def heading_words(self) -> frozenset[str]:
        """All words of all headings."""
        words: set[str] = set()
        for headings in self.known_headings.values():
            words.update(*headings)
        return frozenset(words)

    @cached_property
    def needs(self) -> dict[str, list[tuple[str, ...]]]:
        """Kind of table -> groups of roles, one of each group must be there."""
        return self._needs_of_vocabulary | {
            f"rule {rule.name}": [(title,) for title in rule.heading_titles]
            for rule in self._rules_with_unknown_headings
        }

    @cached_property
    def _needs_of_vocabulary(self) -> dict[str, list[tuple[str, ...]]]:
        return {
            kind: [tuple(group.split("|")) for group in roles.get("needs", ())]
            for kind, roles in self.data["headings"].items()
        }

    @cached_property
    def labels(self) -> dict[tuple[str, ...], str]:
        """Label as sorted folded words -> what it labels."""
        return {
            tuple(sorted(folded(text))): what
            for what, texts in self.data["labels"].items()
            for text in texts
        }

    @cached_property
    def caption(self) -> re.Pattern[str]:
        """A line that begins like a caption."""
        words = "|".join(
            re.escape(word)
            for word in sorted(self.data["captions"], key=len, reverse=True)
        )
        return re.compile(
            rf"(?:{words})\s*(?P<number>[0-9]+(?:[-.][0-9]+)*)\s*(?P<mark>[:.–—|-]?)\s*(?P<title>.*)\Z",
            re.I | re.S,
        )

    @cached_property
    def reserved(self) -> set[tuple[str, ...]]:
        """Names of bits that have no meaning."""
        return {folded(text) for text in self.data["reserved"]}

    @cached_property
    def types_of_profile(self) -> dict[str, TypeName]:
        """Type names that the profile explains, without blanks and case."""
        own = self.own.get("types", {})
        return {
            "".join(name.casefold().split()): TypeName(t["type"], t.get("bits", 0))
            for name, t in own.items()
        }

    @property
    def orders(self) -> tuple[str, str]:
        """Byte order and bit order in which rules read positions, as the ICDs have
        them.
        """
        node = self.data["node"] | (self.nodes[0].head if self.nodes else {})
        return node.get("byte_order", "little"), node.get("bit_order", "lsb0")

    def states_order(self, key: str) -> bool:
        """Return whether the profile states `byte_order` or `bit_order` for all of its
        nodes.
        """
        nodes = self.own.get("nodes", ())
        return key in self.own.get("node", {}) or (
            bool(nodes) and all(key in node for node in nodes)
        )

    @property
    def reads_descriptions(self) -> bool:
        """Whether rules search descriptions for units, formulas and constants.

        This is the case if the profile states phrases.
        """
        return "phrases" in self.own or "variables" in self.own

    @cached_property
    def empty(self) -> frozenset[str]:
        """Texts of cells, without case, that stand for an empty cell."""
        return frozenset(text.casefold() for text in self.data["empty"])

    def is_reserved(self, name: str) -> bool:
        """Return whether a field of this name is reserved.

        An entry of `reserved` that begins with ``~`` is a pattern.
        """
        texts = self.data["reserved"]
        return (bool(folded(name)) and folded(name) in self.reserved) or any(
            name.casefold() == text.casefold()
            or (text.startswith("~") and re.search(text[1:], name, re.I))
            for text in texts
        )

    @cached_property
    def phrases(self) -> dict[str, list[re.Pattern[str]]]:
        return {
            what: [phrase_pattern(text) for text in texts]
            for what, texts in self.data["phrases"].items()
        }

    @cached_property
    def nodes(self) -> list[NodeWords]:
        return [_node_words(item) for item in self.data.get("nodes", ())]


def _node_words(item: dict[str, Any]) -> NodeWords:
    """Return an entry of `nodes`."""
    not_in_head = ("match", "tables", "group", "include")
    return NodeWords(
        name=item["name"],
        match=list(item.get("match", ())),
        tables=tuple(item["tables"]) if "tables" in item else None,
        group=item.get("group"),
        head={key: value for key, value in item.items() if key not in not_in_head},
        include=list(item.get("include", ())),
    )


def phrase_pattern(text: str) -> re.Pattern[str]:
    """Return the search pattern of a phrase in descriptions."""
    stand_ins = {
        "unit": r"(?:\[\s*(?P<unit>[^\]]+?)\s*\]|(?P<bare>[^\s.,;)]+(?: units)?))",
        "number": r"(?P<number>(?:0x[0-9a-f]+|[0-9]+)(?:\s*\(\s*0x[0-9a-f]+\s*\))?)",
        "table": r"(?P<table>(?:Table|Tab\.|Tbl\.)\s*[0-9]+(?:[-.][0-9]+)*)(?:\s*[:–—-]\s*(?P<title>[^.;()]*))?",
        "title": r"(?P<title>[^.;()]+)",
    }
    escaped = re.escape(text).replace(r"\ ", r"\s+")
    return re.compile(_PLACEHOLDER.sub(lambda m: stand_ins[m.group(1)], escaped), re.I)


def find(name: str | None) -> Path | None:
    """Return the path of a profile: a file, or the name of a shipped profile.

    Raises `UserError` for an unknown name.
    """
    from icdgen import shipped
    from icdgen.errors import UserError

    if name is None:
        return None
    path = Path(name)
    if path.exists() or path.suffix or len(path.parts) > 1:
        return path
    folder = shipped.icds() / "profiles"
    ours = folder / f"{name}.yaml"
    if ours.is_file():
        return ours
    names = ", ".join(sorted(p.stem for p in folder.glob("*.yaml"))) or "none"
    raise UserError(
        f"there is no profile `{name}`",
        f"name a file, or one of those shipped: {names}",
    )


def load(path: Path | None = None) -> Profile:
    """Return the profile of icdgen, with the settings of ``path``.

    Raise `Findings` for an invalid profile.
    """
    if path is None:
        return Profile(plain(source.read(DEFAULT)))
    return profile_of_tree(source.read(path))


def profile_of_tree(tree: Map) -> Profile:
    """Return the built-in words, extended by the tree of a profile.

    Raises `Findings` for errors of the profile.
    """
    base = plain(source.read(DEFAULT))
    _check_form(tree)
    own = plain(tree)
    _check_orders(tree, base)
    return Profile(_laid_over(base, own), own, read_rules(tree["rules"]))


def _check_orders(tree: Map, base: dict[str, Any]) -> None:
    """Raise `Findings` if nodes of a profile with rules have different byte or bit
    orders.

    Rules read positions before it is known to which node a table belongs, so that one
    order must hold for all.
    """
    shared = {**base["node"], **tree.get("node", {})}
    for key in ("byte_order", "bit_order"):
        stated = [node.get(key, shared.get(key)) for node in tree.get("nodes", ())]
        if len(set(stated)) > 1:
            message = f"the nodes have different values of `{key}`: {' and '.join(sorted(set(map(str, stated))))}"
            help = "rules read all tables in one order: write a profile for each node"
            raise Findings([Finding(CODE, message, tree.at("nodes"), help)])


def _laid_over(base: dict[str, Any], over: dict[str, Any]) -> dict[str, Any]:
    """Lists are put before those below; everything else replaces what is below."""
    merged = dict(base)
    for key, value in over.items():
        below = base.get(key)
        if isinstance(value, dict) and isinstance(below, dict):
            merged[key] = _laid_over(below, value)
        elif (
            isinstance(value, list)
            and isinstance(below, list)
            and key not in ("needs", "nodes")
        ):
            merged[key] = value + [item for item in below if item not in value]
        else:
            merged[key] = value
    return merged


def _check_form(tree: Map) -> None:
    """Raise `Findings` if the file does not have the form of a profile."""
    if "rules" in tree:
        findings, _ = schema.check(tree, "profile")
    else:
        help = "`icdgen import FILE --explore` prints rules to complete, `--workbench` serves a page to write them"
        findings = [
            Finding(
                CODE,
                "the profile has no `rules:`, which state the meaning of the tables",
                tree.place,
                help,
            )
        ]
    if findings:
        raise Findings([finding._replace(code=CODE) for finding in findings])
