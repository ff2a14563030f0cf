"""Search index: all named objects with their search words and links.

Output is the script ``search-index.js``, which ``search.js`` of the site reads.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator

from icdgen.backends.html import guide, protocol, texts
from icdgen.backends.html.relations import Relations
from icdgen.frozen import NamedTuple
from icdgen.icd.model import CONFIGURATION, Enum, Member, Message, Node, buses_of
from icdgen.icd.places import NodePlace
from icdgen.naming import words
from icdgen.protocol import facts

_MOST = 300  # searched characters of a text


class SearchEntry(NamedTuple):
    """Entry of the index.

    ``own``: words of its identifier, if they differ from the title. ``about``: further
    text. ``phrases``: exact names. ``aliases``: other names.
    """

    kind: str
    title: str
    context: str
    own: str
    about: str
    phrases: tuple[str, ...]
    url: str
    aliases: tuple[str, ...] = ()


def entries(relations: Relations) -> Iterator[SearchEntry]:
    """Yield nodes, messages, enumerations, units, fields, members and errata."""
    links = relations.links
    for node in relations.icd.nodes:
        yield SearchEntry(
            "node",
            node.title,
            node.summary,
            node.name,
            "",
            (node.name,),
            links.node(node.name),
        )
    for unit, _ in relations.units.values():
        about = f"unit {unit.identifier} {unit.summary}"
        phrases = (unit.symbol, unit.identifier)
        yield SearchEntry(
            "unit",
            unit.symbol,
            unit.quantity,
            unit.identifier,
            about,
            phrases,
            links.unit(unit),
        )
    for node in relations.icd.nodes:
        if protocol.has_page(relations, node):
            for words_, title, place in protocol.search_entries(
                relations, node, links.protocol(node.name)
            ):
                yield SearchEntry(
                    "protocol",
                    title,
                    place.text,
                    "",
                    f"protocol {words_}",
                    (),
                    place.url,
                )
        if node.loggable:
            url = f"{links.node(node.name)}#log-mask"
            yield SearchEntry(
                "protocol",
                "Log mask",
                node.title,
                "",
                "protocol bits selection frames that are logged",
                (),
                url,
            )
        for message in node.messages:
            yield from _message_entries(relations, node, message)
        # The members of these enumerations are also found by `error 5`.
        codes = _error_codes(relations, node)
        for enum in node.enums:
            yield from _enum_entries(relations, node, enum, enum.name in codes)
        for erratum in node.errata:
            about = " ".join(
                [*(f"table {table}" for table in erratum.tables), erratum.why]
            )
            title = f"{erratum.id} {erratum.title}"
            yield SearchEntry(
                erratum.label.lower(),
                title,
                node.title,
                "",
                about,
                (erratum.id,),
                links.erratum(erratum),
            )
    for page in guide.pages():
        # Sections of the index are lists of pages.
        sections = page.sections[:1] if page.name == guide.INDEX else page.sections
        for section in sections:
            url = page.url if section.level == 1 else f"{page.url}#{section.anchor}"
            context = "guide" if section.level == 1 else f"guide · {page.title}"
            topics = page.topics if section.level == 1 else ()
            yield SearchEntry(
                "guide", section.title, context, "", section.text, (), url, topics
            )


def script(relations: Relations) -> str:
    """Return the index as a script.

    A page opened from a folder cannot load other data.
    """
    rows = [
        [
            *(texts.clip(part, _MOST) for part in entry[:5]),
            texts.clip("|".join(entry.phrases), _MOST),
            entry.url,
            *entry.aliases,
        ]
        for entry in entries(relations)
    ]
    lines = ",\n".join(json.dumps(row, separators=(",", ":")) for row in rows)
    return f'"use strict";\nglobalThis.icdgenSearchIndex = [\n{lines}\n];\n'


def _message_entries(
    relations: Relations, node: Node, message: Message
) -> Iterator[SearchEntry]:
    links = relations.links
    ids = relations.ids(message)
    shown_ids = "/".join(
        f"{id.text} (0x{id.hexadecimal})" if id.hexadecimal else id.text for id in ids
    )
    own = _words(message, node)
    # Manuals and programs write ids in different ways.
    phrases = [
        spelling
        for id in message.ids
        for spelling in (str(id), f"0x{id:02x}", f"{id:02x}h", f"id {id}")
    ]
    for id in ids:
        phrases += [f"{message.kind if id.purpose == 'id' else id.purpose} {id.value}"]
        phrases += [] if id.hexadecimal else [id.text.lower()]
    if message.kind == CONFIGURATION:
        phrases += [f"telecommand {message.set_id}", f"telemetry {message.get_id}"]
    phrases += _table_phrases(message.table)
    speakers = " ".join(speaker.name for speaker in relations.speakers[node.name])
    buses = " ".join(
        bus for bus in texts.BUSES if bus in buses_of(relations.icd.protocol_of(node))
    )
    about = f"{speakers} {message.group} {buses} {message.summary}"
    context = f"{message.kind} {shown_ids} · {node.title}"
    yield SearchEntry(
        "message",
        message.name,
        context,
        own,
        about,
        tuple(phrases),
        links.message(message),
        message.aliases,
    )
    for name, field in relations.shown_fields(message):
        unit = (
            f"{field.unit.symbol} {field.unit.identifier.replace('_', ' ')} {field.unit.quantity}"
            if field.unit
            else ""
        )
        about = f"{node.name} {own} {unit} {field.summary}"
        context = f"{message.name} · {node.title}"
        url = links.field(message, field)
        yield SearchEntry(
            "field", name, context, _words(field, node), about, (), url, field.aliases
        )


def _error_codes(relations: Relations, node: Node) -> set[str]:
    """Return the names of enumerations of the node that contain error codes of a
    protocol.
    """
    return {
        enum.name
        for speaker in relations.speakers[node.name]
        for enum in facts.of(relations.icd, speaker).reason_enums
    }


def _enum_entries(
    relations: Relations, node: Node, enum: Enum, is_error: bool
) -> Iterator[SearchEntry]:
    links = relations.links
    own = " ".join(words(enum.identifier or enum.name, node.vocabulary)).lower()
    about = f"enum {node.name} {enum.summary}"
    phrases = tuple(_table_phrases(enum.table))
    yield SearchEntry(
        "enumeration",
        enum.name,
        node.title,
        own,
        about,
        phrases,
        links.enum(enum),
        enum.aliases,
    )
    for member in enum.members:
        url = f"{links.enum(enum)}#{links.anchor(enum, str(member.value))}"
        context = f"{enum.name} = {member.values} · {node.title}"
        about = f"{node.name} {own} {member.summary}"
        phrases = (
            (f"error {member.value}", f"error code {member.value}") if is_error else ()
        )
        yield SearchEntry(
            "member",
            member.name,
            context,
            _words(member, node),
            about,
            phrases,
            url,
            member.aliases,
        )


def _words(thing: Message | NodePlace | Enum | Member, node: Node) -> str:
    """Return the words of an identifier, unless they equal the words of the name."""
    identifier_words = " ".join(
        words(thing.identifier or thing.name, node.vocabulary)
    ).lower()
    return (
        ""
        if identifier_words == " ".join(re.findall(r"[^\W_]+", thing.name)).lower()
        else identifier_words
    )


def _table_phrases(table: int | None) -> list[str]:
    return [f"table {table}"] if table else []
