"""Rules of a profile: their classes, and how they are read and checked.

`read_rules` gets the key `rules` of a profile, whose form the schema has checked, and
returns a `TableRule` for each entry. It raises `Findings` for patterns that are invalid
and keys that do not fit together. `docs/reference/import-rules.md` describes the keys.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from icdgen.diagnostics import Finding, Findings, Place
from icdgen.icd.located import Map, Seq
from icdgen.importer.rules.language import (
    KINDS,
    MESSAGE_ROLES,
    ROLES,
    ROLES_OF,
    Pattern,
    PatternError,
    compile_pattern,
)
from icdgen.suggest import close_to

CODE = "IMP001"
# Texts in which `message` looks for roles.
SOURCES = (
    "caption",
    "heading",
    "before",
    "row",
    "sheet",
)
# Keys of which `like` takes over single entries.
_MERGED = (
    "tables",
    "message",
    "columns",
    "each",
    "map",
)


@dataclass(frozen=True)
class ColumnRule:
    """An entry of `columns`: its columns, and the patterns for their cells."""

    key: str
    patterns: tuple[Pattern, ...]
    place: Place

    @property
    def is_optional(self) -> bool:
        """Whether the column may be missing in the table."""
        return self.key.endswith("?") and not self.key.startswith("~")

    @property
    def titles(self) -> list[str]:
        """Headings of the columns whose cells are joined, usually one."""
        key = self.key if self.key.startswith("~") else self.key.rstrip("?")
        return key.split(" + ")


@dataclass(frozen=True)
class Correction:
    """An entry of `set`: the patterns that the roles of a row must match, and the
    resulting roles.
    """

    where: dict[str, re.Pattern[str]]
    roles: dict[str, str]
    place: Place


@dataclass
class TableRule:
    """Rule for tables of one kind.

    Every key is described in ``docs/reference/import-rules.md``.
    """

    name: str
    place: Place
    what: str = "message"
    head: str = ""
    pages: tuple[int, int] | None = None
    nth: int | None = None
    # Source -> pattern.
    conditions: dict[str, re.Pattern[str]] = field(default_factory=dict)
    literals: dict[str, str] = field(default_factory=dict)  # role -> value
    # Source -> patterns, all of them used.
    sources: dict[str, list[Pattern]] = field(default_factory=dict)
    optional: set[str] = field(default_factory=set)  # sources that may match nothing
    columns: list[ColumnRule] = field(default_factory=list)
    lines: list[ColumnRule] = field(default_factory=list)
    melt: Pattern | None = None
    each: dict[str, str] = field(default_factory=dict)
    map: dict[str, dict[str, str]] = field(default_factory=dict)
    corrections: list[Correction] = field(default_factory=list)
    skip: re.Pattern[str] | None = None
    stop: re.Pattern[str] | None = None
    keep: dict[str, re.Pattern[str]] = field(default_factory=dict)
    join: list[str] = field(default_factory=list)
    fill: list[str] = field(default_factory=list)
    glue: list[str] = field(default_factory=list)
    ignore: list[str] = field(default_factory=list)
    # Columns whose empty cells the source leaves out.
    absent: list[str] = field(default_factory=list)
    head_rows: int = 1
    transpose: bool = False
    also: bool = False
    is_unit_wide: bool = False
    group_rows: bool = False
    origin: int = 0
    base: int = 10

    @property
    def column_patterns(self) -> Iterator[Pattern]:
        """Patterns of `columns` and `lines`."""
        for column in (*self.columns, *self.lines):
            yield from column.patterns

    @property
    def has_fields(self) -> bool:
        """Whether the rule gives roles of fields.

        Otherwise, each row is a message without parameters.
        """
        roles = (role for pattern in self.column_patterns for role in pattern.roles)
        given = {*self.each, *roles}
        return not given <= set(MESSAGE_ROLES)

    @property
    def has_byte_range(self) -> bool:
        """Whether one text gives the first and the last byte.

        Bit numbers in other texts then refer to all of these bytes.
        """
        return any({"byte", "last_byte"} <= p.roles for p in self.column_patterns)

    @property
    def heading_titles(self) -> list[str]:
        """Headings in `head`; empty if it has patterns, or a single heading, which is
        ambiguous.
        """
        titles = (
            [title.strip() for title in re.split(r"\s\|\s", self.head)]
            if self.head not in ("", "none")
            else []
        )
        is_plain = len(titles) > 1 and not any(
            title == "*" or title.startswith("~") for title in titles
        )
        return titles if is_plain and not self.transpose else []

    @property
    def column_titles(self) -> list[str]:
        """Headings in `columns`, `lines` and `ignore`."""
        named = [
            title for column in (*self.columns, *self.lines) for title in column.titles
        ]
        return [
            title
            for title in (*named, *self.ignore)
            if title != "*" and not title.startswith("~")
        ]


def read_rules(tree: Seq) -> list[TableRule]:
    """Return the rules of a profile whose structure was checked.

    Raises `Findings` with everything that is wrong in them.
    """
    findings: list[Finding] = []
    by_name: dict[str, Map] = {}
    rules: list[TableRule] = []
    for index, own in enumerate(tree, 1):
        name = own.get("rule", f"rule {index}")
        merged = own
        if "like" in own:
            base = by_name.get(own["like"])
            if base is None:
                close = close_to(own["like"], by_name)
                help = (
                    f"did you mean `{close}`?"
                    if close
                    else "name an earlier rule with `rule:`"
                )
                findings.append(
                    Finding(
                        CODE,
                        f"there is no rule `{own['like']}` before this one",
                        own.at("like"),
                        help,
                    )
                )
            else:
                merged = _laid_over(base, own)
        if name in by_name:
            findings.append(
                Finding(
                    CODE,
                    f"two rules are called `{name}`",
                    own.at("rule"),
                    "give each its own name",
                )
            )
        by_name[name] = merged
        rules.append(_RuleReader(findings).read(merged, name, own.place))
    if findings:
        raise Findings(findings)
    return rules


def _laid_over(base: Map, own: Map) -> Map:
    """Return the keys of an earlier rule, replaced or extended by the keys of this one."""
    merged = Map(own.spot)
    for source in (base, own):
        for key, value in source.items():
            # The name of the earlier rule and its own `like` are not inherited.
            if key in ("rule", "like") and source is base:
                continue
            if key in _MERGED and key in merged and isinstance(value, Map):
                inner = Map(value.spot)
                for part in (merged[key], value):
                    inner.update(part)
                    inner.spots.update(part.spots)
                value = inner
            merged[key] = value
            merged.spots[key] = source.spots[key]
    return merged


class _RuleReader:
    """Makes a `TableRule` of a mapping and adds what is wrong in it to ``findings``."""

    def __init__(self, findings: list[Finding]) -> None:
        self.findings = findings

    def read(self, tree: Map, name: str, place: Place) -> TableRule:
        """Return the rule; what cannot be read of it is left out, with a finding."""
        rule = TableRule(name, place, tree.get("what", "message"))
        rule.head_rows, rule.transpose = (
            tree.get("head_rows", 1),
            tree.get("transpose", False),
        )
        rule.also, rule.origin, rule.base = (
            tree.get("also", False),
            tree.get("origin", 0),
            tree.get("base", 10),
        )
        rule.is_unit_wide = tree.get("width") == "unit"
        rule.group_rows = tree.get("group_rows", False)
        self.conditions(rule, tree["tables"])
        self.message(rule, tree.get("message") or Map(place))
        for key in ("columns", "lines"):
            entries = tree.get(key) or Map(place)
            getattr(rule, key).extend(
                ColumnRule(c, self.patterns(v, entries.at(c)), entries.key_at(c))
                for c, v in entries.items()
            )
        if "melt" in tree:
            rule.melt = next(iter(self.patterns(tree["melt"], tree.at("melt"))), None)
        rule.each = self.roles(tree.get("each"))
        for role, words in (tree.get("map") or {}).items():
            self.role(role, tree["map"].key_at(role))
            rule.map[role] = {
                str(word).casefold(): str(meaning) for word, meaning in words.items()
            }
        for index, entry in enumerate(tree.get("set", ())):
            where = {
                role: self.regex(text, entry["where"].at(role))
                for role, text in entry["where"].items()
            }
            for role in entry["where"]:
                self.role(role, entry["where"].key_at(role))
            given = self.roles(entry, leave_out="where")
            rule.corrections.append(
                Correction(where, given, tree["set"].item_at(index))
            )
        for key in ("skip", "stop"):
            if key in tree:
                setattr(rule, key, self.regex(tree[key], tree.at(key)))
        rule.keep = {
            c: self.regex(text, tree["keep"].at(c))
            for c, text in (tree.get("keep") or {}).items()
        }
        for key in ("join", "fill", "glue", "ignore", "absent"):
            getattr(rule, key).extend(str(text) for text in tree.get(key, ()))
        self.together(rule, tree)
        self.belongs(rule)
        self.used(rule, tree)
        return rule

    def conditions(self, rule: TableRule, tree: Map) -> None:
        rule.head = str(tree.get("head", ""))
        for title in re.split(r"\s\|\s", rule.head):
            if title.startswith("~"):
                self.regex(title[1:], tree.at("head"))
        if "page" in tree:
            first, _, last = str(tree["page"]).partition("-")
            rule.pages = int(first), int(last or first)
        rule.nth = tree.get("nth")
        rule.conditions = {
            key: self.regex(tree[key], tree.at(key))
            for key in ("caption", "heading", "before", "sheet")
            if key in tree
        }

    def message(self, rule: TableRule, tree: Map) -> None:
        for key, value in tree.items():
            source = key.rstrip("?")
            if source in SOURCES:
                rule.sources[source] = list(self.patterns(value, tree.at(key)))
                if key.endswith("?"):
                    rule.optional.add(source)
                continue
            rule.literals["message" if key == "name" else key] = str(value)
        kind = rule.literals.get("kind")
        if kind is not None and kind not in KINDS:
            self.add(
                f"`{kind}` is not a kind of message",
                tree.at("kind"),
                f"write {', '.join(KINDS)}",
            )

    def belongs(self, rule: TableRule) -> None:
        """Check that a table of values or bits says to which field it belongs."""
        owners = {
            "enumeration": {"of", "enumeration"},
            "lookup": {"of"},
            "bits": {"of"},
        }.get(rule.what)
        if owners and not owners & set(roles_of_message(rule)):
            self.add(
                f"the rule does not say to which field the {rule.what} belongs",
                rule.place,
                "add `message: {of: FIELD}`, or a pattern with `{of}`",
            )

    def used(self, rule: TableRule, tree: Map) -> None:
        """Check that rules of this kind use the roles that the rule gives."""
        if rule.what not in ROLES_OF:
            return
        message = tree.get("message") or Map(rule.place)
        given = [
            ("message" if key == "name" else key, message.at(key)) for key in message
        ]
        given = [(role, place) for role, place in given if role in rule.literals]
        given += [(role, tree["each"].key_at(role)) for role in rule.each]
        given += [
            (role, correction.place)
            for correction in rule.corrections
            for role in correction.roles
        ]
        sources = (
            pattern for patterns in rule.sources.values() for pattern in patterns
        )
        melt = (rule.melt,) if rule.melt is not None else ()
        given += [
            (role, p.place)
            for p in (*sources, *rule.column_patterns, *melt)
            for role in sorted(p.roles)
        ]
        for role, place in given:
            kinds = [what for what, roles in ROLES_OF.items() if role in roles]
            if role in ROLES and rule.what not in kinds:
                self.add(
                    f"a rule with `what: {rule.what}` does not use the role `{role}`",
                    place,
                    f"rules with `what: {'`, `'.join(kinds)}` use it; a column without a role belongs under `ignore`",
                )

    def patterns(self, value: Any, place: Place) -> tuple[Pattern, ...]:
        """Return the patterns of a text, or of a list of texts."""
        compiled = []
        for index, text in enumerate(value if isinstance(value, Seq) else [value]):
            where = value.item_at(index) if isinstance(value, Seq) else place
            try:
                pattern = compile_pattern(str(text), where)
            except PatternError as error:
                self.add(error.message, where, error.help)
                continue
            order = pattern.order_of("byte", "bit", "last_byte", "last_bit")
            if (
                order[:3] == ["byte", "bit", "last_byte"]
                and "end_bit" not in pattern.roles
            ):
                self.add(
                    f"the pattern `{text}` takes a bit of the first byte and a bit of the last byte; `bit` and `last_bit` are "
                    "numbered in all bytes of a range",
                    where,
                    "write `{end_bit}` for the bit of the last byte: `{byte}.{bit}-{last_byte}.{end_bit}`",
                )
            compiled.append(pattern)
        return tuple(compiled)

    def regex(self, text: Any, place: Place) -> re.Pattern[str]:
        try:
            return re.compile(str(text), re.I)
        except re.error as error:
            self.add(
                f"`{text}` is not a regular expression: {error}",
                place,
                "check brackets and backslashes",
            )
            # Matches anything, so that the rest of the rule can be checked.
            return re.compile("")

    def roles(self, tree: Map | None, leave_out: str = "") -> dict[str, str]:
        """Return a mapping of roles to values as texts."""
        given = {
            role: str(value)
            for role, value in (tree or {}).items()
            if role != leave_out
        }
        for role in given:
            assert tree is not None
            self.role(role, tree.key_at(role))
        return given

    def role(self, role: str, place: Place) -> None:
        if role not in ROLES:
            close = close_to(role, ROLES)
            help = (
                f"did you mean `{close}`?"
                if close
                else f"roles are {', '.join(sorted(ROLES))}"
            )
            self.add(f"unknown role `{role}`", place, help)

    def together(self, rule: TableRule, tree: Map) -> None:
        """Check combinations of keys."""
        if rule.what == "ignore":
            used = [
                key
                for key in ("columns", "message", "lines", "melt", "each", "set")
                if key in tree
            ]
            if used:
                self.add(
                    f"`{used[0]}` has no effect in a rule that ignores its tables",
                    tree.key_at(used[0]),
                    "remove it",
                )
            return
        named = [
            c
            for c in (*rule.columns, *rule.lines)
            if c.key != "*" and not all(t.isdigit() for t in c.titles)
        ]
        if rule.head in ("", "none") and named:
            self.add(
                f"`{named[0].key}` is a heading, and `tables` does not say in which row headings stand",
                named[0].place,
                "add `head: A | B`, or name columns by their numbers",
            )
        if not (rule.columns or rule.lines or rule.ignore):
            self.add(
                f"the rule `{rule.name}` gives no column a role",
                rule.place,
                "add `columns:`",
            )
        if rule.melt is not None and not any(
            column.key == "*" for column in rule.columns
        ):
            self.add(
                "`melt` needs the pattern of the cells",
                tree.key_at("melt"),
                'add `"*": name` to `columns`',
            )
        if rule.melt is None and (
            star := next((c for c in rule.columns if c.key == "*"), None)
        ):
            self.add(
                "`*` stands for the cells of melted columns, but the rule has no `melt`",
                star.place,
                "add `melt:`",
            )
        if rule.melt is not None and rule.lines:
            self.add(
                "`melt` and `lines` exclude each other",
                tree.key_at("lines"),
                "remove one of them",
            )

    def add(self, message: str, place: Place, help: str) -> None:
        self.findings.append(Finding(CODE, message, place, help))


def roles_of_message(rule: TableRule) -> Iterator[str]:
    """Return the roles of a message that any key of the rule may give."""
    yield from (role for role in rule.literals if role in MESSAGE_ROLES)
    sources = (pattern for patterns in rule.sources.values() for pattern in patterns)
    for pattern in (*sources, *rule.column_patterns):
        yield from (role for role in pattern.roles if role in MESSAGE_ROLES)
