"""Pages of the manual from Markdown: sections, links, folded sections and topics."""

from __future__ import annotations

import pytest

from icdgen import shipped
from icdgen.backends.html import guide
from icdgen.backends.html.guide import GuidePage, GuideSection, topics_of
from tests.limits import assert_limits

INDEX = """\
# Manual

- [Serial link](guides/serial-link.md): SLIP, COBS,
  DLE and ETX; more
- [Scales](guides/scales.md): linear,, tables
- [Rules](reference/rules.md#errors), [Wire](reference/wire.md): frames, [Python](python.md)
- [Outside](https://x.org/a.md): no, page

[Last](last.md): at the
end
"""


def test_topics_of_the_index_end_with_their_item():
    assert topics_of(INDEX) == {
        "guides/serial-link": ("Serial link", "SLIP", "COBS", "DLE and ETX"),
        "guides/scales": ("Scales", "linear", "tables"),
        "reference/wire": ("Wire", "frames"),
        "python": ("Python",),
        "last": ("Last", "at the end"),
    }


@pytest.fixture
def docs(tmp_path, monkeypatch):
    """Return a folder with documentation, as it is installed."""
    files = {
        "README.md": "# Manual\n[B](guides/b.md): topic one, two; [Lost](lost.md)\n",
        "guides/a.md": "# A\n\nFirst.\n\n## Sub\n",
        "guides/b.md": "# B\n\n[index](../README.md#x) [a](a.md) [code](code.c) [out](../../x.md)",
        "glossary.md": "text only\n",
        "guides/code.c": "int a;\n",
        "guides/picture.png": "no",
        "x.yaml": "a: 1\n",
        "folder.txt/y.rs": "fn\n",
    }
    for name, text in files.items():
        path = tmp_path / "docs" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    (tmp_path / "x.md").write_text("# Outside\n")
    monkeypatch.setattr(shipped, "docs", lambda: tmp_path / "docs")
    guide.pages.cache_clear()
    yield tmp_path / "docs"
    guide.pages.cache_clear()


def test_pages_are_in_the_order_of_the_index_and_none_is_lost(docs):
    pages = guide.pages()
    assert [(page.name, page.url, page.title) for page in pages] == [
        ("README", "icdgen-docs/index.html", "Manual"),
        ("guides/b", "icdgen-docs/guides/b.html", "B"),
        ("glossary", "icdgen-docs/glossary.html", "glossary"),
        ("guides/a", "icdgen-docs/guides/a.html", "A"),
    ]
    assert [page.topics for page in pages] == [(), ("B", "topic one", "two"), (), ()]
    assert (pages[3].about, pages[2].about) == ("First.", "")
    assert {
        folder: [page.name for page in group]
        for folder, group in guide.groups().items()
    } == {"": ["README", "glossary"], "guides": ["guides/b", "guides/a"]}
    assert dict(guide.files()) == {
        "icdgen-docs/folder.txt/y.rs": "fn\n",
        "icdgen-docs/guides/code.c": "int a;\n",
        "icdgen-docs/x.yaml": "a: 1\n",
    }


def test_links_lead_to_pages_and_files_of_the_documentation_only(docs):
    html = guide.pages()[1].html
    assert 'href="../index.html#x"' in html and 'href="a.html"' in html
    assert 'href="code.c"' in html and "x.html" not in html.replace("index.html#x", "")
    assert "out" in html and html.count("<a ") == 3 == html.count("</a>")


def test_without_an_index_there_is_no_manual(docs):
    (docs / "README.md").unlink()
    assert guide.pages() == ()


MARKDOWN = """\
before

# The `ICD`, *first*

Text of **it**
and `code`.

## Search

| a | b |
|---|---|
| 1 | ~~2~~ |

```yaml
x: <1>
```

## Search
## Search

![picture](p.png) end

| c |
|---|

    indented
"""


def test_sections_have_unique_anchors_and_plain_texts(tmp_path):
    path = tmp_path / "page.md"
    path.write_text(MARKDOWN)
    page = guide._page(path)
    assert page.name == "page"
    # `search` is the field at the head of every page.
    assert page.sections == [
        GuideSection("The ICD,  first ", "the-icd--first", 1, "Text of it and code."),
        GuideSection("Search", "search-1", 2, "a b 1 2 x: <1>"),
        GuideSection("Search", "search-2", 2, ""),
        GuideSection("Search", "search-3", 2, "end c indented"),
    ]
    assert page.html.count('<section class="scroll wide-table" tabindex="0"') == 2
    for number in (1, 2):
        assert f'aria-label="Table {number}, scrollable"><table>' in page.html
    assert page.html.count("</table></section>") == 2
    assert page.html.count('<th scope="col">') == 3
    assert page.html.count('<pre tabindex="0" data-copy><code>') == 2
    assert "x: &lt;1&gt;" in page.html and "<img" not in page.html
    assert "<s>2</s>" in page.html


def test_the_start_of_a_page_has_160_characters_at_most():
    def about(size: int) -> str:
        return GuidePage("x", "", [GuideSection("X", "x", 1, "a" * size)]).about

    assert_limits(lambda size: about(size) == "a" * size, most=160)
    assert GuidePage("a/b", "").title == "a/b" and GuidePage("a/b", "").about == ""


def test_sections_of_a_long_page_are_folded():
    start = '<h1 id="a">A</h1>\n<p>text</p>\n'
    sections = [f'<h2 id="{name}">{name}</h2>\n<h3>x</h3>' for name in "bc"]
    html = start + "".join(sections)
    assert guide._folded(html) == html
    padding = "x" * (12_000 - len(html))
    assert_limits(
        lambda size: "<details" not in guide._folded(html.ljust(size)), most=11_999
    )
    assert guide._folded(start + padding + "".join(sections)) == (
        start
        + padding
        + "".join(
            f'<details class="fold"><summary><h2 id="{name}">{name}</h2></summary>'
            "\n<h3>x</h3></details>\n"
            for name in "bc"
        )
    )


@pytest.mark.parametrize(
    ("title", "anchor"),
    [
        ("The Errata Overlays", "the-errata-overlays"),
        (" A_b  c-d: `e`! ", "a_b--c-d-e"),
        ("I²C and Größe", "i²c-and-größe"),
    ],
)
def test_the_anchor_of_a_heading_is_that_of_forges(title, anchor):
    assert guide.anchor_of(title) == anchor
