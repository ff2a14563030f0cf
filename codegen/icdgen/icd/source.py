"""Reader of YAML files that records the place of every value.

Mappings become `Map` (a dict), sequences `Seq` (a list); both store the place of each
key and value. Scalars are str, int, bool, float or None. Spellings that YAML 1.1 and
1.2 readers interpret differently are findings (ICD003).
"""

from __future__ import annotations

import re
from io import StringIO
from pathlib import Path
from typing import Any, Protocol, cast

from icdgen.diagnostics import Finding, Findings, Fix, Lines, Place
from icdgen.icd.located import Map, Mark, Seq, Spot, place_of

AMBIGUOUS = "ICD003"

# Limits far above any ICD, so that a hostile file cannot exhaust the memory or the
# stack.
MAX_BYTES = 4_000_000
MAX_DEPTH = 40
MAX_SCALAR = 20_000

_NUMBER = re.compile(
    r"(?:(?P<whole>-?(?:0|[1-9][0-9]*))|(?P<hex>0x[0-9A-Fa-f]+)|(?P<decimal>-?(?:0|[1-9][0-9]*)\.[0-9]+(?:[eE][-+][0-9]{1,2})?))\Z"
)
# Error of libyaml, which has its own limit and looks ahead, so it can report the depth
# before `TreeBuilder` does.
_DEEPER_THAN_LIBYAML = "exceeded maximum nesting depth"

# Length of the longest word that a reader of YAML can interpret as something other than
# text.
_LONGEST_WORD = len("false")
_WORDS = {"true": True, "false": False, "null": None, "~": None, "": None}
# Characters that YAML 1.2, section 5.1, does not allow. Not compiled here: that is
# slow, and it is seldom needed.
_UNPRINTABLE = "[^\t\n\r -~\x85\xa0-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]"

# Unquoted scalars that some readers of YAML 1.1 or 1.2 interpret as a number, a truth
# value, null or a date.
_AMBIGUOUS = re.compile(
    r"""(?: [-+.][-+0-9_.:eExXobA-Fa-f]*
          | 0[bBoOxX][0-9A-Fa-f_]+
          | [0-9][0-9_]* (?: : [0-9_]+ )* (?: \. [0-9_.]* )? (?: e [-+]? [0-9]+ )?
          | [-+]?\.(?:inf|nan)
          | y(?:es)? | no? | on | off | true | false | null
          | [0-9]{4}-[0-9]{1,2}-[0-9]{1,2}(?:[Tt ].*)?
        )\Z""",
    re.VERBOSE | re.IGNORECASE,
)


def read(path: Path, name: str | None = None) -> Map:
    """Return the tree of a file.

    ``name`` is the file name in findings. Raises `Findings`.
    """
    name = name or str(path)
    return parse(contents(path, name), name)


def contents(path: Path, name: str) -> bytes:
    """Return the bytes of a file.

    Raises `Findings` if it cannot be read or has more than `MAX_BYTES`.
    """
    # Read with a limit instead of checking the size first: the path can be a pipe or a
    # device.
    try:
        with open(path, "rb") as file:
            data = file.read(MAX_BYTES + 1)
    except OSError as error:
        raise Findings(
            [
                Finding(
                    "ICD001",
                    f"cannot read the file: {error.strerror}",
                    Place(name),
                    "check the path",
                )
            ]
        ) from None
    if len(data) > MAX_BYTES:
        raise Findings(
            [Finding("ICD001", f"the file has more than the {MAX_BYTES:,} bytes allowed", Place(name),
                     "split it and join the parts with `include:`")]
        )  # fmt: skip
    return data


def parse(data: bytes, name: str) -> Map:
    """Return the tree of ``data``.

    Raises `Findings` with all errors of the YAML text.
    """
    tree, findings = parse_with_findings(data, name)
    if findings:
        raise Findings(findings)
    return tree


def parse_with_findings(data: bytes, name: str) -> tuple[Map, list[Finding]]:
    """Return the tree of ``data`` and the findings of ambiguous scalars (ICD003), which
    are text in the tree.

    Raises `Findings` if the YAML text has any other error.
    """
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        place = _after(name, data[: error.start].decode("utf-8-sig"))
        problem = f"byte 0x{data[error.start]:02X} is not UTF-8"
        raise Findings(
            [Finding("ICD001", problem, place, "save the file as UTF-8")]
        ) from None
    tree, findings = TreeBuilder(text, name).build()
    if not findings and tree is None:
        findings = [
            Finding(
                "ICD001",
                "the file is empty",
                Place(name),
                "an ICD begins with `icdgen: 1`",
            )
        ]
    elif not findings and not isinstance(tree, Map):
        findings = [Finding("ICD001", "the file is not a mapping of keys to values", Place(name),
                            "an ICD begins with `icdgen: 1`, an overlay with `errata: 1`")]  # fmt: skip
    if not isinstance(tree, Map) or any(
        finding.code != AMBIGUOUS for finding in findings
    ):
        raise Findings(findings)
    return tree, findings


class Event(Protocol):
    """Attributes of the events of PyYAML; each kind of event has some of them."""

    start_mark: Mark
    end_mark: Mark
    anchor: str | None
    tag: str | None
    value: str
    style: str | None
    flow_style: bool | None


class EventParser(Protocol):
    """Parser of PyYAML, in Python or in C."""

    # An object of a class in `yaml.events`, with the attributes of `Event`.
    def get_event(self) -> Any: ...


class TreeBuilder:
    """Builds the tree from parser events.

    It has its own stack instead of recursion, to limit the depth.
    """

    def __init__(self, text: str, name: str) -> None:
        self.text, self.name = text, name
        self.findings: list[Finding] = []
        # Values of unquoted scalars, by their text.
        self.scalars: dict[str, object] = {}

    def build(self) -> tuple[object, list[Finding]]:
        """Return the root of the tree and the findings.

        Return None in place of the root if the text cannot be parsed.
        """
        import yaml
        from yaml import events

        if "\0" in self.text:
            place = _after(self.name, self.text[: self.text.index("\0")])
            return None, [
                Finding(
                    "ICD001", "the file contains a NUL character", place, "remove it"
                )
            ]
        roots = Seq(Place(self.name))
        container: Any = roots  # the innermost open mapping or sequence
        key: str | None = None  # of a mapping, if its value comes next
        key_spot: Spot = roots.spot
        stack: list[tuple[Any, str | None, Spot]] = []  # the containers around it
        cache = self.scalars  # also the marker for 'not in the cache'
        next_event = event_parser(self.text, self.name).get_event
        scalar = events.ScalarEvent
        mapping = events.MappingStartEvent
        sequence = events.SequenceStartEvent
        try:
            # This loop runs once per event, tens of thousands of times. Inline code is
            # faster than calls here.
            while True:
                event = next_event()
                # Classes are compared by identity, which is faster than isinstance().
                kind = type(event)
                spot = event.start_mark, event.end_mark
                value: Any
                if kind is scalar:
                    plain = (
                        not event.style and event.anchor is None and event.tag is None
                    )
                    value = cache.get(event.value, cache) if plain else cache
                    if value is cache:
                        value = self.scalar(event)
                elif kind is events.MappingEndEvent or kind is events.SequenceEndEvent:
                    container, key, key_spot = stack.pop()
                    continue
                elif kind is mapping or kind is sequence:
                    if event.anchor is not None:
                        self.refuse_alias(event)
                    self.check_tag(event)
                    value = (Map if kind is mapping else Seq)(spot)
                elif kind is events.AliasEvent:
                    self.refuse_alias(event)
                    return None, self.findings
                elif kind is events.DocumentStartEvent and roots:
                    self.add(
                        "ICD001",
                        "a second document begins here",
                        event,
                        "one ICD is one document: remove `---`",
                    )
                    return None, self.findings
                elif kind is events.StreamEndEvent:
                    break
                else:
                    continue
                if type(container) is Seq:
                    container.append(value)
                    container.spots.append(spot)
                elif key is None:
                    key = value if type(value) is str else self.key(value, event)
                    key_spot = spot
                else:
                    if key in container:
                        self.add_duplicate_key(
                            key, place_of(key_spot), container.key_at(key)
                        )
                    container[key] = value
                    container.spots[key] = key_spot, spot
                    key = None
                if kind is not scalar:
                    if len(stack) >= MAX_DEPTH:
                        self.findings.append(_too_deep(place_of(spot)))
                        return None, self.findings
                    stack.append((container, key, key_spot))
                    container, key = value, None
        except yaml.YAMLError as error:
            from icdgen.icd import remedies

            mark = getattr(error, "problem_mark", None)
            place = (
                Place(self.name, mark.line + 1, mark.column + 1)
                if mark
                else self.unprintable()
            )
            problem = (
                getattr(error, "problem", None)
                or getattr(error, "reason", None)
                or "the text cannot be read"
            )
            if problem == _DEEPER_THAN_LIBYAML:
                self.findings.append(_too_deep(place))
                return None, self.findings
            line = Lines(self.text)[place.line] or ""
            help = remedies.of_syntax(problem, line, place.column - 1) if mark else ""
            help = (
                help or "check indentation, quotes and brackets just before this place"
            )
            fix = (
                self.with_quotes(place, line, mark.index - mark.column)
                if mark
                else None
            )
            if fix is not None and "quotes" not in help.partition(":")[2]:
                help = "put the text in quotes"
            self.findings.append(
                Finding("ICD001", f"not YAML: {problem}", place, help, fix=fix)
            )
            return None, self.findings
        return (roots[0] if roots else None), self.findings

    def with_quotes(self, place: Place, line: str, offset: int) -> Fix | None:
        """Return a fix that puts the value at a place in quotes; None if the line would
        still have a syntax error.

        ``offset`` is the index of the line in the text.
        """
        import yaml

        from icdgen.icd import remedies

        start, end = remedies.value_around(line, place.column - 1)
        if start == end or not self.text.startswith(line, offset):
            return None
        quoted = remedies.in_quotes(line[start:end])
        parser = event_parser(
            self.text[: offset + start] + quoted + self.text[offset + end :], self.name
        )
        try:
            while (
                event := parser.get_event()
            ) is not None and event.start_mark.line < place.line:
                pass
        except yaml.YAMLError:
            return None
        return Fix(Place(self.name, place.line, start + 1, end - start), quoted)

    def key(self, value: object, event: Event) -> str:
        """Return a key that is not a string as text; adds a finding if it is a mapping
        or a list.
        """
        if isinstance(value, (Map, Seq)):
            self.add(
                "ICD001",
                "a key must be a word, not a mapping or a list",
                event,
                "give the key a name",
            )
        return str(value)

    def add_duplicate_key(self, key: str, place: Place, first: Place) -> None:
        """Add the finding for a key that occurs twice in a mapping."""
        message = (
            f"the key `{key}` is twice in this mapping, first in line {first.line}"
        )
        self.findings.append(Finding("ICD002", message, place, "remove one of them"))

    def scalar(self, event: Event) -> object:
        """Return the value of a scalar, and add findings for unsupported syntax."""
        text = event.value
        if event.anchor is not None:
            self.refuse_alias(event)
        self.check_tag(event)
        if len(text) > MAX_SCALAR:
            self.add(
                "ICD001",
                f"a text of {len(text):,} characters",
                event,
                f"at most {MAX_SCALAR:,} are allowed",
            )
            return text[:100]
        if not event.style:
            return self.plain(text, event)
        if "\0" in text:
            self.add("ICD001", "the text contains a NUL character", event, "remove it")
        return text

    def plain(self, text: str, event: Event) -> object:
        """Return the value of an unquoted scalar.

        If it is ambiguous, adds a finding and returns the text.
        """
        if len(text) > _LONGEST_WORD and text[0].isalpha():
            value: object = text
        elif text in _WORDS:
            value = _WORDS[text]
        elif (number := _NUMBER.match(text)) is not None:
            value = _number(text, str(number.lastgroup))
        elif _AMBIGUOUS.match(text) and text not in (".", "-"):
            from icdgen.icd import remedies

            self.add(
                AMBIGUOUS,
                f"YAML parsers disagree about what `{text}` is",
                event,
                remedies.of_ambiguous(text),
            )
            return text
        else:
            value = text
        # Only texts without a finding, which must be reported at each place.
        self.scalars[text] = value
        return value

    def check_tag(self, event: Event) -> None:
        """Add a finding if an event has a tag; the tag `!` only forces text."""
        if event.tag is not None and event.tag != "!":
            self.add(
                AMBIGUOUS,
                f"the tag `{event.tag}` is not part of the format",
                event,
                "remove the tag",
            )

    def refuse_alias(self, event: Event) -> None:
        """Add the finding for an anchor or an alias: nested aliases can expand to any
        amount of data.
        """
        self.add(
            "ICD001",
            "anchors and aliases are not part of the format",
            event,
            "write the value out",
        )

    def unprintable(self) -> Place:
        """Return the place of the first character that YAML does not allow, by default
        the start of the file.
        """
        match = re.search(_UNPRINTABLE, self.text)
        return (
            _after(self.name, self.text[: match.start()]) if match else Place(self.name)
        )

    def add(self, code: str, message: str, event: Event, help: str) -> None:
        """Add a finding at the place of an event."""
        self.findings.append(
            Finding(code, message, place_of((event.start_mark, event.end_mark)), help)
        )


def _too_deep(place: Place) -> Finding:
    return Finding(
        "ICD001",
        f"nested more than {MAX_DEPTH} deep",
        place,
        "an ICD needs five levels",
    )


def _number(text: str, kind: str) -> int | float | str:
    """Return the value of a number that matches `_NUMBER`; ``kind`` is the name of the
    group.
    """
    # Longer texts are not numbers of an ICD. As text, the schema check reports them.
    if len(text) >= 40:
        return text
    if kind == "hex":
        return int(text, 16)
    if kind == "whole":
        return int(text)
    # ``4.0`` is the integer 4, as in JSON Schema.
    integer, _, fraction = text.partition(".")
    return float(text) if fraction.strip("0") else int(integer)


def _after(name: str, before: str) -> Place:
    """Return the place directly after the text ``before``."""
    return Place(name, before.count("\n") + 1, len(before) - before.rfind("\n"))


def event_parser(text: str, name: str) -> EventParser:
    """Return a parser of the events of a text. ``name`` is the file name in its marks.

    Uses libyaml if PyYAML was built with it, which is ten times as fast as PyYAML's own
    parser.
    """
    file = StringIO(text)
    file.name = name
    try:
        from yaml.cyaml import CParser  # type: ignore[attr-defined]
    except ImportError:
        from yaml.parser import Parser
        from yaml.reader import Reader
        from yaml.scanner import Scanner

        # `yaml.Loader` without its composer, constructor and resolver, which this
        # module replaces.
        class PythonParser(Reader, Scanner, Parser):
            def __init__(self, stream: StringIO) -> None:
                Reader.__init__(self, stream)
                Scanner.__init__(self)
                Parser.__init__(self)

        return cast(EventParser, PythonParser(file))
    return cast(EventParser, CParser(file))
