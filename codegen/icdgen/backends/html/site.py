"""All files of the site.

`files` renders each page from the values that the other modules of the package return,
and adds static files, indices and ``icd.json``.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from icdgen import __version__
from icdgen.backends.html import (
    drawing,
    enums,
    errata,
    guide,
    llms,
    messages,
    nodes,
    protocol,
    recognition,
    search,
    sidebar,
    units,
)
from icdgen.backends.html.links import CHANGES, ERRATA, HOME, UNITS
from icdgen.backends.html.relations import Relations
from icdgen.backends.packages import Packages
from icdgen.icd.model import Icd
from icdgen.show.machine import to_json
from icdgen.wording import count

if TYPE_CHECKING:
    from icdgen.diff.inputs.side import ComparisonSide
    from icdgen.render import Renderer

# Static files that the pages load.
_LOADED = (
    *("style.css", "layout.css", "print.css", "icon.svg"),
    *(
        "theme.js",
        "site.js",
        "load.js",
        "sidebar.js",
        "tie.js",
        "search.js",
        "find.js",
        "filter.js",
        "errata.js",
        "copy.js",
    ),
    *(
        "codec.js",
        "frames.js",
        "packets.js",
        "pasted.js",
        "stream.js",
        "framed.js",
        "given.js",
        "recognize.js",
    ),
    *("frame-links.js", "paste.js", "values.js", "lit.js", "try.js", "protocol.js"),
)


def files(
    icd: Icd,
    render: Renderer,
    packages: Packages,
    previous: ComparisonSide | None = None,
) -> Iterator[tuple[PurePosixPath, str]]:
    """Yield path and text of each file.

    ``previous``: older release that ``changes.html`` compares with.
    """
    relations = Relations(icd, packages)
    compared = previous is not None
    common = {
        "version": __version__,
        "nodes": [nodes.brief(relations, node) for node in icd.nodes],
        "compared": compared,
        "further": [
            (ERRATA, "Errata"),
            (UNITS, "Units"),
            *([(guide.HOME, "Guide")] if guide.pages() else []),
            *([(CHANGES, "Changes")] if compared else []),
        ],
        "sidebar": "",
        "changed": errata.changed,
        "hatch": drawing.hatch,
        "count": count,  # a number with its noun
        # Content security policy: the site loads nothing from the network.
        "policy": "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; base-uri 'none'; form-action 'none'",
    }

    def page(path: str, template: str, **values: object) -> tuple[PurePosixPath, str]:
        # Relative paths: the site works from any folder and without server.
        root = "../" * path.count("/")
        return PurePosixPath(path), render(
            template, **{"root": root, "path": path, **common, **values}
        )

    yield page(HOME, "home.html.j2", **nodes.home(relations))
    yield page(ERRATA, "errata.html.j2", **errata.values(relations))
    yield page(UNITS, "units.html.j2", **units.values(relations))
    if previous is not None:
        from icdgen.backends.html import changes

        yield page(CHANGES, "changes.html.j2", **changes.values(relations, previous))
    for node in icd.nodes:
        sidebar_of = sidebar.of_node(relations, node, render)
        url = relations.links.node(node.name)
        yield PurePosixPath(sidebar.contents(node)), sidebar.script(relations, node)
        yield page(
            url,
            "node.html.j2",
            sidebar=sidebar_of(url),
            **nodes.values(relations, node),
        )
        if protocol.has_page(relations, node):
            url = relations.links.protocol(node.name)
            yield page(
                url,
                "protocol.html.j2",
                sidebar=sidebar_of(url),
                **protocol.values(relations, node),
            )
        shown = [
            messages.values(relations, node, message, render)
            for message in node.messages
        ]
        # Each page links to the page before and after it.
        for before, values, after in zip(
            [None, *shown], shown, [*shown[1:], None], strict=False
        ):
            yield page(
                values["url"],
                "message.html.j2",
                before=before,
                after=after,
                sidebar=sidebar_of(values["url"]),
                **values,
            )
        yield page(
            relations.links.printed(node.name),
            "print.html.j2",
            shown=shown,
            **nodes.values(relations, node),
        )
        for enum in node.enums:
            url = relations.links.enum(enum)
            yield page(
                url,
                "enum.html.j2",
                sidebar=sidebar_of(url),
                **enums.values(relations, enum),
            )
    yield from _guide(page, render)
    for name in _LOADED:
        yield PurePosixPath(name), render(name)
    yield PurePosixPath("search-index.js"), search.script(relations)
    yield PurePosixPath("frame-index.js"), recognition.script(relations)
    yield PurePosixPath("icd.json"), json.dumps(to_json(icd), indent=1) + "\n"
    yield PurePosixPath("llms.txt"), llms.text(relations, compared)


_Page = Callable[..., tuple[PurePosixPath, str]]


def _guide(page: _Page, render: Renderer) -> Iterator[tuple[PurePosixPath, str]]:
    """Yield the pages of the documentation of icdgen, if it is installed."""
    from markupsafe import Markup

    guide_pages = guide.pages()
    if not guide_pages:
        return
    for guide_page in guide_pages:
        root = "../" * guide_page.url.count("/")
        sidebar = Markup(
            render(
                "guide-sidebar.html.j2",
                groups=guide.groups(),
                name=guide_page.name,
                root=root,
            )
        )
        yield page(guide_page.url, "guide.html.j2", page=guide_page, sidebar=sidebar)
    yield from ((PurePosixPath(path), text) for path, text in guide.files())
