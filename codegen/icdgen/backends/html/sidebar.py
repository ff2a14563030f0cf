"""Sidebar of the pages of a node: its messages by group, and its enumerations.

A page contains only the group that is open. The script ``contents.js`` of a node has
the links of all groups, so that pages stay small.
"""

from __future__ import annotations

import html
import json
from collections import defaultdict
from collections.abc import Callable
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from icdgen.backends.html import protocol
from icdgen.backends.html.relations import PageLink, Relations
from icdgen.frozen import NamedTuple
from icdgen.icd.model import Node

if TYPE_CHECKING:
    from icdgen.render import Renderer

_OTHER = "Other messages"


class SidebarGroup(NamedTuple):
    """Group of links.

    ``all``: page that lists the whole group.
    """

    title: str
    links: list[PageLink]
    all: str


def of_node(
    relations: Relations, node: Node, render: Renderer
) -> Callable[[str], object]:
    """Return a function that returns the sidebar of a page: the group of the page is
    unfolded, other groups are loaded by `script`.
    """
    from markupsafe import Markup

    head = render(
        "sidebar.html.j2",
        node=node,
        protocol=protocol.has_page(relations, node),
        contents=contents(node),
    )
    # Rendered once per node, not once per page: a node can have thousands of messages.
    group_texts = [
        [
            render("sidebar-group.html.j2", group=group, number=number, open=is_open)
            for is_open in (False, True)
        ]
        for number, group in enumerate(_groups(relations, node))
    ]

    def of_page(url: str) -> object:
        # The current page is found by its link in the rendered group.
        target = f'href="{html.escape(PurePosixPath(url).name)}">'
        # Only the open group contains links: pages would otherwise grow with the ICD.
        shown = [
            head,
            *(
                unfolded if f"<li><a {target}" in unfolded else folded
                for folded, unfolded in group_texts
            ),
        ]
        return Markup(
            "".join(shown).replace(
                f"<li><a {target}", f'<li><a aria-current="page" {target}', 1
            )
        )

    return of_page


def contents(node: Node) -> str:
    """Return the path of the script with the links of all groups of the node."""
    return f"{node.name}/contents.js"


def script(relations: Relations, node: Node) -> str:
    """Return the links of each group as a script, relative to the pages of the node."""
    data = [
        [[link.text, link.url] for link in group.links]
        for group in _groups(relations, node)
    ]
    return f'"use strict";\nglobalThis.icdgenContents = {json.dumps(data, separators=(",", ":"))};\n'


def _groups(relations: Relations, node: Node) -> list[SidebarGroup]:
    """Return the groups of a node; groups of included nodes come last."""
    groups: dict[str, list[PageLink]] = defaultdict(list)
    for message in node.messages:
        groups[message.group or _OTHER].append(
            PageLink(message.name, _within(relations.links.message(message), node))
        )
    group_list = [
        SidebarGroup(title, links, "index.html#messages")
        for title, links in groups.items()
    ]
    if node.enums:
        enums = [
            PageLink(enum.name, _within(relations.links.enum(enum), node))
            for enum in node.enums
        ]
        group_list.append(
            SidebarGroup("Enumerations", enums, "index.html#enumerations")
        )
    for other in relations.icd.included(node):
        links = [
            PageLink(message.name, _within(relations.links.message(message), node))
            for message in other.messages
        ]
        group_list.append(
            SidebarGroup(
                other.title, links, _within(relations.links.node(other.name), node)
            )
        )
    return group_list


def _within(url: str, node: Node) -> str:
    """Return the link from a page of the node."""
    folder, _, name = url.partition("/")
    return name if folder == node.name else f"../{url}"
