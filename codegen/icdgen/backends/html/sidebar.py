"""What stands beside the pages of a node: all its messages by group, and its enumerations."""

from __future__ import annotations

import html
from collections import defaultdict
from collections.abc import Callable
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from icdgen.backends.html import protocol
from icdgen.backends.html.relations import Place, Relations
from icdgen.icd.model import Node

if TYPE_CHECKING:
    from icdgen.render import Renderer

_OTHER = "Other messages"


def of_node(relations: Relations, node: Node, render: Renderer) -> Callable[[str], object]:
    """Gives the sidebar of each page of the node, which is the same but for the place where one is."""
    from markupsafe import Markup

    text = render(
        "sidebar.html.j2",
        title=node.title,
        protocol=protocol.has_page(relations, node),
        groups=_groups(relations, node),
    )

    def of_page(url: str) -> object:
        link = f'<a href="{html.escape(PurePosixPath(url).name)}">'
        before, found, after = text.partition(f"<li>{link}")
        if not found:
            return Markup(text)
        folded, fold, rest = before.rpartition("<details>")
        marked = link.replace("<a ", '<a aria-current="page" ')
        return Markup(f"{folded}{fold and '<details open>'}{rest}<li>{marked}{after}")

    return of_page


def _groups(relations: Relations, node: Node) -> list[tuple[str, int, list[Place]]]:
    """Title, number and links of each group; those of included nodes last."""
    groups: dict[str, list[Place]] = defaultdict(list)
    for message in node.messages:
        groups[message.group or _OTHER].append(Place(message.name, _within(relations.links.message(message), node)))
    if node.enums:
        groups["Enumerations"] += [Place(enum.name, _within(relations.links.enum(enum), node)) for enum in node.enums]
    for other in relations.icd.included(node):
        groups[other.title] += [
            Place(message.name, _within(relations.links.message(message), node)) for message in other.messages
        ]
    return [(title, len(places), places) for title, places in groups.items()]


def _within(url: str, node: Node) -> str:
    """The way from a page of the node."""
    folder, _, name = url.partition("/")
    return name if folder == node.name else f"../{url}"
