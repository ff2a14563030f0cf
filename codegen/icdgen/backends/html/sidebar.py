"""What stands beside the pages of a node: all its messages by group, and its enumerations."""

from __future__ import annotations

import html
import json
from collections import defaultdict
from collections.abc import Callable
from pathlib import PurePosixPath
from typing import TYPE_CHECKING, NamedTuple

from icdgen.backends.html import protocol
from icdgen.backends.html.relations import Place, Relations
from icdgen.icd.model import Node

if TYPE_CHECKING:
    from icdgen.render import Renderer

_OTHER = "Other messages"


class Group(NamedTuple):
    """``all``: the page that lists everything in it."""

    title: str
    links: list[Place]
    all: str


def of_node(relations: Relations, node: Node, render: Renderer) -> Callable[[str], object]:
    """Gives the sidebar of each page of the node: the group of the page is unfolded, the others are in `script`."""
    from markupsafe import Markup

    head = render("sidebar.html.j2", node=node, protocol=protocol.has_page(relations, node), contents=contents(node))
    made = [
        [render("sidebar-group.html.j2", group=group, number=number, open=is_open) for is_open in (False, True)]
        for number, group in enumerate(_groups(relations, node))
    ]

    def of_page(url: str) -> object:
        target = f'href="{html.escape(PurePosixPath(url).name)}">'
        shown = [head, *(unfolded if f"<li><a {target}" in unfolded else folded for folded, unfolded in made)]
        return Markup("".join(shown).replace(f"<li><a {target}", f'<li><a aria-current="page" {target}', 1))

    return of_page


def contents(node: Node) -> str:
    """Where the links of all groups of the node are."""
    return f"{node.name}/contents.js"


def script(relations: Relations, node: Node) -> str:
    """The links of each group, as the pages of the node write them."""
    data = [[[link.text, link.url] for link in group.links] for group in _groups(relations, node)]
    return f'"use strict";\nglobalThis.icdgenContents = {json.dumps(data, separators=(",", ":"))};\n'


def _groups(relations: Relations, node: Node) -> list[Group]:
    """Those of included nodes last."""
    groups: dict[str, list[Place]] = defaultdict(list)
    for message in node.messages:
        groups[message.group or _OTHER].append(Place(message.name, _within(relations.links.message(message), node)))
    found = [Group(title, links, "index.html#messages") for title, links in groups.items()]
    if node.enums:
        enums = [Place(enum.name, _within(relations.links.enum(enum), node)) for enum in node.enums]
        found.append(Group("Enumerations", enums, "index.html#enumerations"))
    for other in relations.icd.included(node):
        links = [Place(one.name, _within(relations.links.message(one), node)) for one in other.messages]
        found.append(Group(other.title, links, _within(relations.links.node(other.name), node)))
    return found


def _within(url: str, node: Node) -> str:
    """The way from a page of the node."""
    folder, _, name = url.partition("/")
    return name if folder == node.name else f"../{url}"
