"""Documentation of icdgen as pages of the site: ``docs/**/*.md`` with links between
pages and to shown files.

`pages` reads and renders them once; the site shows them, and the search finds their
sections.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING

from icdgen import shipped
from icdgen.backends.html.texts import clip

if TYPE_CHECKING:
    from markdown_it.token import Token

FOLDER = "icdgen-docs"  # no name of a node contains a hyphen
HOME = f"{FOLDER}/index.html"
INDEX = "README"  # page that lists the others
# Ids in use by the page template
_OF_EVERY_PAGE = ("content", "sidebar", "search", "results", "theme")
_LONG = 12_000  # characters of a page whose sections are folded


@dataclass
class GuideSection:
    """Content below a heading, as plain text."""

    title: str
    anchor: str
    level: int
    text: str = ""


@dataclass
class GuidePage:
    """Page of the documentation.

    ``name``: path below ``docs`` without suffix, for example ``guides/scales``.
    ``html`` is safe: the Markdown reader treats HTML in its source as text.
    """

    name: str
    html: str
    sections: list[GuideSection] = field(default_factory=list)
    topics: tuple[str, ...] = ()  # words for the search, from the line of the index

    @property
    def title(self) -> str:
        return self.sections[0].title if self.sections else self.name

    @property
    def url(self) -> str:
        """Path on the site: ``icdgen-docs/reference/wire.html``."""
        return f"{FOLDER}/{self.name}.html" if self.name != INDEX else HOME

    @property
    def about(self) -> str:
        """Start of the text."""
        return clip(self.sections[0].text, 160) if self.sections else ""


@cache
def pages() -> tuple[GuidePage, ...]:
    """Return all pages in the order of the index, which comes first; empty if the
    documentation is not installed.
    """
    folder = shipped.docs()
    paths = {
        path.relative_to(folder).with_suffix("").as_posix(): path
        for path in sorted(folder.rglob("*.md"))
    }
    if INDEX not in paths:
        return ()
    topics = topics_of(paths[INDEX].read_text("utf-8"))
    # Pages that the index lacks come last, so that none is lost.
    names = dict.fromkeys([INDEX, *(name for name in topics if name in paths), *paths])
    all_pages = [_page(paths[name], name) for name in names]
    for page in all_pages:
        page.topics = topics.get(page.name, ())
    return tuple(all_pages)


def topics_of(index: str) -> dict[str, tuple[str, ...]]:
    """Return the pages of the index in order, with the topics after each link:
    ``[Link](link.md): SLIP, COBS; ...``.
    """
    # Topics end at a semicolon, at the next item of the list, at the next link, at an
    # empty line, or at the end of the file.
    links = re.findall(
        r"\[([^\]]+)\]\(([^)#:]+)\.md\)(?::\s([^;\[\]]*?)(?=;|,?\s*\n-|,\s*\[|\n\n|\Z))?",
        index,
    )
    return {
        name: (
            title,
            *(" ".join(topic.split()) for topic in topics.split(",") if topic.strip()),
        )
        for title, name, topics in links
    }


def groups() -> dict[str, list[GuidePage]]:
    """Return the pages by folder: index, guides, reference and explanation."""
    by_folder: dict[str, list[GuidePage]] = {}
    for page in pages():
        by_folder.setdefault(page.name.rpartition("/")[0], []).append(page)
    return by_folder


def files() -> Iterator[tuple[str, str]]:
    """Yield path and text of files that the pages show or link to."""
    folder = shipped.docs()
    for path in sorted(folder.rglob("*")):
        if path.is_file() and path.suffix in (
            ".yaml",
            ".c",
            ".h",
            ".py",
            ".rs",
            ".toml",
            ".txt",
        ):
            yield (
                f"{FOLDER}/{path.relative_to(folder).as_posix()}",
                path.read_text("utf-8"),
            )


def anchor_of(title: str) -> str:
    """Return the anchor of a heading as forges generate it: ``the-errata-overlays``."""
    return re.sub(r"\s", "-", re.sub(r"[^\w\s-]", "", title.strip().lower()))


def _anchors(title: str) -> Iterator[str]:
    # Forges number the second heading of a text `-1`.
    yield anchor_of(title)
    yield from (f"{anchor_of(title)}-{number}" for number in count(1))


def _page(path: Path, name: str = "") -> GuidePage:
    from markdown_it import MarkdownIt

    # The manual contains no HTML; disabling it makes its text safe.
    reader = MarkdownIt("commonmark", {"html": False}).enable(
        ["table", "strikethrough"]
    )
    tokens = reader.parse(path.read_text("utf-8"))
    page = GuidePage(name or path.stem, "")
    taken = set(_OF_EVERY_PAGE)
    for number, token in enumerate(tokens):
        if token.type == "heading_open":
            title = _plain(tokens[number + 1])
            anchor = next(
                candidate for candidate in _anchors(title) if candidate not in taken
            )
            taken.add(anchor)
            token.attrSet("id", anchor)
            page.sections.append(GuideSection(title, anchor, int(token.tag[1:])))
        elif token.type == "inline":
            _mend_links(token, path)
            # The text of a heading is already its title.
            if page.sections and tokens[number - 1].type != "heading_open":
                page.sections[-1].text += f" {_plain(token)}"
        elif token.type in ("fence", "code_block"):
            # The site has no syntax highlighting, so the language of a block is unused.
            token.type, token.info = "code_block", ""
            if page.sections:
                page.sections[-1].text += f" {token.content}"
    for section in page.sections:
        section.text = " ".join(section.text.split())
    page.html = _folded(
        _tables_in_reach(reader.renderer.render(tokens, reader.options, {}))
    )
    return page


def _tables_in_reach(html: str) -> str:
    """Return the page with scrollable tables and code, also by keyboard."""
    numbers = count(1)
    html = html.replace("<pre>", '<pre tabindex="0" data-copy>').replace(
        "<th>", '<th scope="col">'
    )
    html = re.sub(
        "<table>",
        lambda _: (
            f'<section class="scroll wide-table" tabindex="0" aria-label="Table {next(numbers)}, scrollable"><table>'
        ),
        html,
    )
    return html.replace("</table>", "</table></section>")


def _folded(html: str) -> str:
    """Return a long page with folded sections."""
    if len(html) < _LONG:
        return html
    # The look-ahead keeps the heading at the start of each section.
    first, *sections = re.split(r"(?=<h2 )", html)
    folded_sections = [
        re.sub(r"\A(<h2 .*?</h2>)", r"<summary>\1</summary>", section, flags=re.DOTALL)
        for section in sections
    ]
    return first + "".join(
        f'<details class="fold">{section}</details>\n' for section in folded_sections
    )


def _plain(token: Token) -> str:
    return "".join(
        child.content if child.type in ("text", "code_inline") else " "
        for child in token.children or ()
    )


def _mend_links(token: Token, path: Path) -> None:
    """Replace links to Markdown files by links to pages.

    Links to files outside of the site become text.
    """
    is_linked: list[bool] = []
    children = []
    for child in token.children or ():
        if child.type == "link_open":
            target = _target(str(child.attrGet("href") or ""), path)
            is_linked.append(bool(target))
            if not target:
                continue
            child.attrSet("href", target)
        # A link without target loses both of its tags.
        elif (
            child.type == "link_close" and not is_linked.pop()
        ) or child.type == "image":
            continue
        children.append(child)
    token.children = children


def _target(href: str, path: Path) -> str:
    """Return the target of a link on the site; empty if the site does not contain it."""
    name, hash, anchor = href.partition("#")
    # External links: the site must work without network.
    if ":" in name or name.startswith("/"):
        return ""
    if not name:
        return href
    # A link must not leave the documentation folder.
    target = (path.parent / name).resolve()
    if not target.is_file() or not target.is_relative_to(_top(path)):
        return ""
    return (
        re.sub(rf"\b{INDEX}\.md$", "index.md", name).removesuffix(".md")
        + (".html" if name.endswith(".md") else "")
        + hash
        + anchor
    )


def _top(path: Path) -> Path:
    """Return the documentation folder of a page."""
    folder = shipped.docs().resolve()
    return folder if path.resolve().is_relative_to(folder) else path.parent.resolve()
