"""Search for nodes, messages and fields by the names and ids that users type.

`items_by_name` defines which names match. Without a match, or with several, a search
raises `NotFound` or `Ambiguous`, whose texts have the similar names.
"""

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
from icdgen.protocol.packet_formats import Stream
from icdgen.suggest import close_words, question
from icdgen.values.errors import Ambiguous, NotFound

KINDS = (TELECOMMAND, TELEMETRY, CONFIGURATION)
MOST_LISTED = 20
_INDEX = re.compile(r"\[(.*?)\]")
_NUMBER = re.compile(r"[0-9]{1,20}|0[xX][0-9A-Fa-f]{1,20}")
_BYTES = re.compile(r"[0-9A-Fa-f]{2}(?:[ /][0-9A-Fa-f]{2}){1,3}")


class _HasName(Protocol):
    """A message, enumeration, struct or node of a layout."""

    @property
    def name(self) -> str: ...

    @property
    def identifier(self) -> str | None: ...

    @property
    def aliases(self) -> tuple[str, ...]: ...


@dataclass(frozen=True, slots=True)
class ArrayOfFields:
    """An array of scalars in a frame.

    If a struct contains the array, each element of the struct has one.
    """

    steps: tuple[PathStep, ...]  # path from the layout of the message to the array
    elements: list[FrameField]

    @property
    def name(self) -> str:
        """Return the name with its path: ``Satellites[2].Angles``."""
        return name_of_steps(self.steps)

    @property
    def alias(self) -> str | None:
        """Return the name with identifiers instead of names; None if no node on the
        path has an identifier.
        """
        return alias_of_steps(self.steps)


_Named = TypeVar("_Named", bound="_HasName | FrameField | ArrayOfFields")


def find_node(icd: Icd, name: str) -> Node:
    """Return the node called ``name``, in any case. Raises `NotFound`."""
    for node in icd.nodes:
        if node.name == name.strip().lower():
            return node
    names = [node.name for node in icd.nodes]
    raise NotFound(
        f"there is no node `{name}`",
        question(close_words(name, names)) or f"nodes: {', '.join(names)}",
    )


def is_part(icd: Icd, node: Node) -> bool:
    """Return whether another node includes the node."""
    return any(node.name in other.includes for other in icd.nodes)


def only_node(icd: Icd) -> Node | None:
    """Return the only node that no other node includes; None if there are several."""
    nodes = [node for node in icd.nodes if not is_part(icd, node)]
    return nodes[0] if len(nodes) == 1 else None


def find_named(icd: Icd, words: Sequence[str]) -> tuple[Node, list[str]]:
    """Return the node that the first word names, and the other words.

    If there is only one node, its name is optional.

    Raises `NotFound`.
    """
    if words and words[0].strip().lower() in {node.name for node in icd.nodes}:
        return find_node(icd, words[0]), list(words[1:])
    only = only_node(icd)
    if only is not None:
        return only, list(words)
    if words:
        return find_node(icd, words[0]), []  # raises `NotFound`, with a similar name
    names = ", ".join(node.name for node in icd.nodes if not is_part(icd, node))
    raise NotFound("it is not said which node is meant", f"nodes: {names}")


def find_frame(icd: Icd, words: Sequence[str]) -> tuple[Node, str, list[str]]:
    """Return node, message and assignments of the words ``[NODE] MESSAGE
    [FIELD=VALUE]...``.

    Raises `NotFound`.
    """
    node, other_words = find_named(icd, words)
    if not other_words:
        raise NotFound(
            f"no message of {node.name} is named",
            f"`icdgen show {node.name}` lists what there is",
        )
    return node, other_words[0], other_words[1:]


def find_message(
    icd: Icd, node_name: str, key: str, kind: str | None = None
) -> Message:
    """Return the message of a node, or of its included nodes, by name (in any case),
    identifier, alias or id.

    Ids are written as ``146``, ``0x92`` or ``01 35``. ``kind`` restricts the search;
    "telecommand" and "telemetry" include the configuration messages that can be sent or
    requested. Raises `NotFound` or `Ambiguous`, with suggestions.
    """
    node = find_node(icd, node_name)
    messages = [
        message
        for message in icd.messages_of(node)
        if kind is None or is_of_kind(message, kind)
    ]
    # Names come first: a message can be called like an id of another one.
    matches = items_by_name(messages, key, node.vocabulary) or _by_id(
        messages, key, kind
    )
    if len(matches) == 1:
        return matches[0]
    if matches:
        form = facts.of(icd, node).stream
        listed = ", ".join(
            f"`{message.name}` ({kind_and_ids(message, form)})" for message in matches
        )
        raise Ambiguous(
            f"`{key}` fits several messages of {node.name}: {listed}",
            "give the full name, or the kind",
        )
    raise NotFound(
        f"{node.name} has no {kind or 'message'} `{key}`",
        _message_help(icd, node, messages, key, kind),
    )


def find_sharing(
    icd: Icd, node_name: str, key: str, kind: str | None = None
) -> list[Message]:
    """Return the messages of one direction that share the id ``key``; an empty list if
    fewer than two have it.

    Raises `NotFound`.
    """
    messages = icd.messages_of(find_node(icd, node_name))
    for direction in (TELECOMMAND, TELEMETRY):
        sharing = _by_id(
            [message for message in messages if is_of_kind(message, direction)],
            key,
            direction,
        )
        if len(sharing) > 1 and kind in (None, direction):
            return sharing
    return []


def _by_id(messages: Sequence[Message], key: str, kind: str | None) -> list[Message]:
    """Return the messages with the id ``key``; an empty list if the key is not an id."""
    key = key.strip()
    if _BYTES.fullmatch(key):  # bytes of an id, in the form that `kind_and_ids` returns
        key = "0x" + re.sub("[ /]", "", key)
    if not _NUMBER.fullmatch(key):
        return []
    id = int(key, 0) if key[:2] in ("0x", "0X") else int(key)
    return [message for message in messages if id in _ids(message, kind)]


def find_field(
    message: Message,
    fields: Sequence[FrameField],
    key: str,
    vocabulary: tuple[str, ...] = (),
) -> FrameField:
    """Return the field by name (in any case), identifier, alias, or words that only it
    has: ``x`` for Commanded X speed.

    `fields` are all scalars of the longest frame of the message. Raises `NotFound` or
    `Ambiguous`, with suggestions.
    """
    matches = items_by_name(fields, key, vocabulary) or _by_words(
        fields, key, vocabulary
    )
    if len(matches) == 1:
        return matches[0]
    if matches:
        listed = ", ".join(f"`{field.name}`" for field in matches)
        raise Ambiguous(
            f"`{key}` fits several fields: {listed}", "give more of the name"
        )
    help = _suggest_named(key, fields) or _list_fields(fields)
    raise NotFound(f"{message.name} has no field `{key}`", help)


def find_array(
    fields: Sequence[FrameField], key: str, vocabulary: tuple[str, ...] = ()
) -> list[FrameField]:
    """Return the elements of the array with this name (in any case) or identifier; an
    empty list without a match.
    """
    arrays: list[ArrayOfFields] = []
    # The elements of an array are contiguous in `fields`, and the first has index 0.
    for field in fields:
        *before, last = field.steps
        if last.element == 0:
            arrays.append(ArrayOfFields((*before, PathStep(last.node)), []))
        if last.element is not None:
            arrays[-1].elements.append(field)
    matches = items_by_name(arrays, key, vocabulary)
    return matches[0].elements if len(matches) == 1 else []


def items_by_name(
    items: Sequence[_Named], key: str, vocabulary: tuple[str, ...]
) -> list[_Named]:
    """Return the items that a name matches, by the first of these comparisons that has
    a match.

    The comparisons are: the exact name; the name in any case; the same words in any
    spelling; an alias of the same words.
    """
    wanted = _joined(key, vocabulary)

    def has_words(names: Iterable[str]) -> bool:
        names = (name for name in names if _has_indices_of(key, name))
        return any(_joined(name, vocabulary) == wanted for name in names)

    steps: list[Callable[[_Named], bool]] = [
        lambda item: item.name == key,
        lambda item: item.name.casefold() == key.strip().casefold(),
    ]
    if wanted:
        steps.append(lambda item: has_words(_names(item)))
        steps.append(lambda item: has_words(_aliases(item)))
    for is_match in steps:
        matches = [item for item in items if is_match(item)]
        if matches:
            return matches
    return []


def is_of_kind(message: Message, kind: str) -> bool:
    """Return whether a message is of a kind, or is a configuration message that can be
    sent or requested as that kind.
    """
    if kind == TELECOMMAND:
        return message.telecommand_id is not None
    if kind == TELEMETRY:
        return message.telemetry_id is not None
    return message.kind == kind


def kind_and_ids(message: Message, form: Stream | None = None) -> str:
    """Return kind and ids: ``telemetry 146``, ``configuration 120/247``, or ``telemetry
    01 35`` if ``form`` has id bytes.
    """
    return f"{message.kind} {'/'.join(id_text(form, id) for id in message.ids)}"


def _ids(message: Message, kind: str | None) -> tuple[int | None, ...]:
    """Return the ids of a message in the direction of a kind."""
    return {
        TELECOMMAND: (message.telecommand_id,),
        TELEMETRY: (message.telemetry_id,),
    }.get(kind or "", message.ids)


def _names(item: _HasName | FrameField | ArrayOfFields) -> Iterable[str]:
    """Return the name and the identifier of an item."""
    identifier = (
        item.alias if isinstance(item, FrameField | ArrayOfFields) else item.identifier
    )
    return filter(None, (item.name, identifier))


def _aliases(item: _HasName | FrameField | ArrayOfFields) -> Iterable[str]:
    """Return the aliases of an item.

    A field of a struct has aliases with its path, and also without the path if the path
    contains no array.
    """
    if not isinstance(item, FrameField | ArrayOfFields):
        return item.aliases
    *before, last = item.steps
    # Below an array, an alias without a path would name a field of every element.
    without_path = [last.with_index(alias) for alias in last.node.aliases]
    path = name_of_steps(before)
    with_path = [f"{path}.{alias}" for alias in without_path] if before else []
    return (
        with_path
        if any(step.element is not None for step in before)
        else [*with_path, *without_path]
    )


def _joined(text: str, vocabulary: tuple[str, ...]) -> str:
    """Return the words of a text without separators, for a comparison that ignores the
    spelling.
    """
    return "".join(naming.words(text, vocabulary))


def _has_indices_of(key: str, name: str) -> bool:
    """Return whether a key has no indices, or the same indices as a name.

    ``gain[-1]`` has the words of ``Gain[1]``, but not its index.
    """
    indices = _INDEX.findall(key)
    return not indices or indices == _INDEX.findall(name)


def _by_words(
    fields: Sequence[FrameField], key: str, vocabulary: tuple[str, ...]
) -> list[FrameField]:
    """Return the fields with all words of a key, or else the fields whose words begin
    with them.
    """
    wanted = set(naming.words(key, vocabulary))
    if not wanted:
        return []
    candidates: list[tuple[FrameField, set[str]]] = []
    for field in fields:
        if _has_indices_of(key, field.name):
            words: set[str] = set()
            for name in _names(field):
                words.update(naming.words(name, vocabulary))
            candidates.append((field, words))
    matches = [field for field, words in candidates if wanted <= words]
    if matches:
        return matches
    return [
        field
        for field, words in candidates
        if all(any(word.startswith(prefix) for word in words) for prefix in wanted)
    ]


def _message_help(
    icd: Icd, node: Node, messages: Sequence[Message], key: str, kind: str | None
) -> str:
    """Return the help for an unknown message: its real kind, another node, or a similar
    name.
    """
    # Without the kind there may be a match.
    if kind is not None:
        with suppress(NotFound, Ambiguous):
            other = find_message(icd, node.name, key)
            return (
                f"`{other.name}` is {kind_and_ids(other, facts.of(icd, node).stream)}"
            )
    owners = [
        other
        for other in icd.nodes
        if other is not node and items_by_name(other.messages, key, other.vocabulary)
    ]
    if owners:
        return f"it is a message of {' and '.join(owner.name for owner in owners)}"
    close = _suggest_named(key, messages)
    return close or f"`icdgen show {node.name}` lists what there is"


def _list_fields(fields: Sequence[FrameField]) -> str:
    """Return the help that lists the fields of a message, or their number if there are
    many.
    """
    names = [field.name for field in fields]
    if len(names) > MOST_LISTED:
        return f"it has {len(names)} fields; `icdgen show` lists them"
    return f"fields: {', '.join(names)}" if names else "it has no fields at all"


def _suggest_named(key: str, items: Sequence[_HasName] | Sequence[FrameField]) -> str:
    """Return a question with similar names; an item with a similar alias is listed by
    its name.
    """
    names: dict[str, str] = {}
    for item in items:
        names.update((alias, item.name) for alias in _aliases(item))
    # A name takes precedence over an equal alias of another item.
    names.update((item.name, item.name) for item in items)
    return question(dict.fromkeys(names[text] for text in close_words(key, names)))
