"""Nodes, messages and fields by what a person types for them."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Protocol, TypeVar

from icdgen import naming
from icdgen.describe.ids import id_text
from icdgen.icd.frames import FrameField, PathStep, alias_of_steps, name_of_steps
from icdgen.icd.model import CONFIGURATION, TELECOMMAND, TELEMETRY, Icd, Message, Node
from icdgen.protocol import facts
from icdgen.protocol.envelope import Stream
from icdgen.suggest import close_words
from icdgen.values.errors import Ambiguous, NotFound

KINDS = (TELECOMMAND, TELEMETRY, CONFIGURATION)
MOST_LISTED = 20
_INDEX = re.compile(r"\[(.*?)\]")
_NUMBER = re.compile(r"[0-9]{1,20}|0[xX][0-9A-Fa-f]{1,20}")
_BYTES = re.compile(r"[0-9A-Fa-f]{2}(?:[ /][0-9A-Fa-f]{2}){1,3}")


class _HasName(Protocol):
    @property
    def name(self) -> str: ...

    @property
    def identifier(self) -> str | None: ...

    @property
    def aliases(self) -> tuple[str, ...]: ...


@dataclass(frozen=True, slots=True)
class ArrayOfFields:
    """The elements of an array of scalars in a frame; in a struct those of one place: ``Satellites[2].Angles``."""

    steps: tuple[PathStep, ...]  # from the node of the message to the array as a whole
    elements: list[FrameField]

    @property
    def name(self) -> str:
        """Return the name, with the path to it."""
        return name_of_steps(self.steps)

    @property
    def alias(self) -> str | None:
        """Return the name with identifiers in place of names; None without any."""
        return alias_of_steps(self.steps)


_Named = TypeVar("_Named", bound="_HasName | FrameField | ArrayOfFields")


def find_node(icd: Icd, name: str) -> Node:
    """The node called ``name``, in any case. Raises `NotFound`."""
    for node in icd.nodes:
        if node.name == name.strip().lower():
            return node
    names = [node.name for node in icd.nodes]
    raise NotFound(f"there is no node `{name}`", _suggest(name, names) or f"nodes: {', '.join(names)}")


def is_part(icd: Icd, node: Node) -> bool:
    """Whether the node is only there to be included in others."""
    return any(node.name in other.includes for other in icd.nodes)


def only_node(icd: Icd) -> Node | None:
    """The node that need not be named, as there is no other."""
    alone = [node for node in icd.nodes if not is_part(icd, node)]
    return alone[0] if len(alone) == 1 else None


def find_named(icd: Icd, words: Sequence[str]) -> tuple[Node, list[str]]:
    """The node that the first word names, and the other words; where there is one node only, it need not be named.

    Raises `NotFound`.
    """
    if words and words[0].strip().lower() in {node.name for node in icd.nodes}:
        return find_node(icd, words[0]), list(words[1:])
    only = only_node(icd)
    if only is not None:
        return only, list(words)
    if words:
        return find_node(icd, words[0]), []  # says that there is none, and which was probably meant
    names = ", ".join(node.name for node in icd.nodes if not is_part(icd, node))
    raise NotFound("it is not said which node is meant", f"nodes: {names}")


def find_frame(icd: Icd, words: Sequence[str]) -> tuple[Node, str, list[str]]:
    """``[NODE] MESSAGE [FIELD=VALUE]...`` taken apart. Raises `NotFound`."""
    node, rest = find_named(icd, words)
    if not rest:
        raise NotFound(f"no message of {node.name} is named", f"`icdgen show {node.name}` lists what there is")
    return node, rest[0], rest[1:]


def find_message(icd: Icd, node_name: str, key: str, kind: str | None = None) -> Message:
    """The message of a node, included ones among them, by id (``146``, ``0x92``, ``01 35``), name (in any case) or identifier.

    ``kind`` narrows the search; "telecommand" and "telemetry" also find the configuration messages that can be sent and
    requested. Raises `NotFound` or `Ambiguous`, with suggestions.
    """
    node = find_node(icd, node_name)
    messages = [m for m in icd.messages_of(node) if kind is None or is_of_kind(m, kind)]
    found = by_name(messages, key, node.vocabulary) or _by_id(messages, key, kind)
    if len(found) == 1:
        return found[0]
    if found:
        form = facts.of(icd, node).stream
        listed = ", ".join(f"`{m.name}` ({describe(m, form)})" for m in found)
        raise Ambiguous(f"`{key}` fits several messages of {node.name}: {listed}", "give the full name, or the kind")
    raise NotFound(f"{node.name} has no {kind or 'message'} `{key}`", _message_help(icd, node, messages, key, kind))


def find_sharing(icd: Icd, node_name: str, key: str, kind: str | None = None) -> list[Message]:
    """The messages that share the id, in one direction; none if the key is no id, or that of one message. Raises `NotFound`."""
    messages = icd.messages_of(find_node(icd, node_name))
    for direction in (TELECOMMAND, TELEMETRY):
        found = _by_id([m for m in messages if is_of_kind(m, direction)], key, direction)
        if len(found) > 1 and kind in (None, direction):
            return found
    return []


def _by_id(messages: Sequence[Message], key: str, kind: str | None) -> list[Message]:
    key = key.strip()
    if _BYTES.fullmatch(key):  # an id of several bytes, as `describe` writes it
        key = "0x" + re.sub("[ /]", "", key)
    if not _NUMBER.fullmatch(key):
        return []
    wanted = int(key, 0) if key[:2] in ("0x", "0X") else int(key)
    return [m for m in messages if wanted in _ids(m, kind)]


def find_field(
    message: Message, fields: Sequence[FrameField], key: str, vocabulary: tuple[str, ...] = ()
) -> FrameField:
    """The field by name (in any case), identifier, or words that no other field has: ``x`` for Commanded X speed.

    `fields` are those of the longest frame of the message. Raises `NotFound` or `Ambiguous`, with suggestions.
    """
    found = by_name(fields, key, vocabulary) or _by_words(fields, key, vocabulary)
    if len(found) == 1:
        return found[0]
    if found:
        listed = ", ".join(f"`{f.name}`" for f in found)
        raise Ambiguous(f"`{key}` fits several fields: {listed}", "give more of the name")
    help = _suggest_named(key, fields) or _list_fields(fields)
    raise NotFound(f"{message.name} has no field `{key}`", help)


def find_array(fields: Sequence[FrameField], key: str, vocabulary: tuple[str, ...] = ()) -> list[FrameField]:
    """The elements of the array of that name, in any case, or of that identifier; none if there is no such array."""
    arrays: list[ArrayOfFields] = []
    for field in fields:
        *before, last = field.steps
        if last.element == 0:
            arrays.append(ArrayOfFields((*before, PathStep(last.node)), []))
        if last.element is not None:
            arrays[-1].elements.append(field)
    matches = by_name(arrays, key, vocabulary)
    return matches[0].elements if len(matches) == 1 else []


def by_name(items: Sequence[_Named], key: str, vocabulary: tuple[str, ...]) -> list[_Named]:
    """Items of exactly this name, else of this name in any case, else of these words, however they are joined, else of
    an alias of these words."""
    wanted = _joined(key, vocabulary)
    steps: list[Callable[[_Named], bool]] = [
        lambda item: item.name == key,
        lambda item: item.name.casefold() == key.strip().casefold(),
        *(
            lambda item, names=names: wanted in (_joined(n, vocabulary) for n in names(item) if _is_indexed(key, n))
            for names in (_names, _aliases)
            if wanted
        ),
    ]
    for matches in steps:
        found = [item for item in items if matches(item)]
        if found:
            return found
    return []


def is_of_kind(message: Message, kind: str) -> bool:
    """Whether it is of the kind, or a configuration message that can be used so."""
    if kind == TELECOMMAND:
        return message.telecommand_id is not None
    if kind == TELEMETRY:
        return message.telemetry_id is not None
    return message.kind == kind


def describe(message: Message, form: Stream | None = None) -> str:
    """``telemetry 146``, ``configuration 120/247``; ``telemetry 01 35`` where the packets of ``form`` have such ids."""
    return f"{message.kind} {'/'.join(id_text(form, id) for id in message.ids)}"


def _ids(message: Message, kind: str | None) -> tuple[int | None, ...]:
    return {TELECOMMAND: (message.telecommand_id,), TELEMETRY: (message.telemetry_id,)}.get(kind or "", message.ids)


def _names(item: _HasName | FrameField | ArrayOfFields) -> Iterable[str]:
    other = item.alias if isinstance(item, FrameField | ArrayOfFields) else item.identifier
    return filter(None, (item.name, other))


def _aliases(item: _HasName | FrameField | ArrayOfFields) -> Iterable[str]:
    """Aliases of an item; of an element or a field of a struct with the path to it, and alone if no array is on the path."""
    if not isinstance(item, FrameField | ArrayOfFields):
        return item.aliases
    *before, last = item.steps
    alone = [last.text(alias) for alias in last.node.aliases]
    head = name_of_steps(before)
    with_path = [f"{head}.{alias}" for alias in alone] if before else []
    return with_path if any(step.element is not None for step in before) else [*with_path, *alone]


def _joined(text: str, vocabulary: tuple[str, ...]) -> str:
    return "".join(naming.words(text, vocabulary))


def _is_indexed(key: str, name: str) -> bool:
    """Whether the indexes in brackets are those of a name: ``gain[-1]`` is no ``Gain[1]``, though the words are the same."""
    return not (given := _INDEX.findall(key)) or given == _INDEX.findall(name)


def _by_words(fields: Sequence[FrameField], key: str, vocabulary: tuple[str, ...]) -> list[FrameField]:
    wanted = set(naming.words(key, vocabulary))
    if not wanted:
        return []
    fields = [f for f in fields if _is_indexed(key, f.name)]
    known = [(f, {w for n in _names(f) for w in naming.words(n, vocabulary)}) for f in fields]
    found = [f for f, words in known if wanted <= words]
    return found or [f for f, words in known if all(any(w.startswith(one) for w in words) for one in wanted)]


def _message_help(icd: Icd, node: Node, messages: Sequence[Message], key: str, kind: str | None) -> str:
    if kind is not None:
        with suppress(NotFound, Ambiguous):
            other = find_message(icd, node.name, key)
            return f"`{other.name}` is {describe(other, facts.of(icd, node).stream)}"
    elsewhere = [n.name for n in icd.nodes if n is not node and by_name(n.messages, key, n.vocabulary)]
    if elsewhere:
        return f"it is a message of {' and '.join(elsewhere)}"
    close = _suggest_named(key, messages)
    return close or f"`icdgen show {node.name}` lists what there is"


def _list_fields(fields: Sequence[FrameField]) -> str:
    names = [f.name for f in fields]
    if len(names) > MOST_LISTED:
        return f"it has {len(names)} fields; `icdgen show` lists them"
    return f"fields: {', '.join(names)}" if names else "it has no fields at all"


def _suggest_named(key: str, items: Sequence[_HasName] | Sequence[FrameField]) -> str:
    """Names near the key; an item whose alias is near is listed by its name."""
    known = {alias: item.name for item in items for alias in _aliases(item)} | {item.name: item.name for item in items}
    close = dict.fromkeys(known[text] for text in close_words(key, known))
    return "did you mean " + " or ".join(f"`{name}`" for name in close) + "?" if close else ""


def _suggest(key: str, names: Iterable[str]) -> str:
    close = close_words(key, names)
    return "did you mean " + " or ".join(f"`{name}`" for name in close) + "?" if close else ""
