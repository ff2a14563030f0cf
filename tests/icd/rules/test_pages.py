"""Pages of rules are read from Markdown with fixed headings."""

from __future__ import annotations

import pytest

from icdgen.icd.rules.pages import RulePage, page_as_markdown, pages_of_theme

FIRST = """\
## ICD001: A title: with a colon

Why it is wrong.

In two paragraphs.

Wrong:

```yaml
a: 1

b: 2
```

Right:

```yaml
a: 2
```
"""
SECOND = """\
## DIF217: Another title
It follows at once.

Before:

```yaml
```

After:

```yaml
c: 3
```
"""
PAGES = {
    "ICD001": RulePage(
        "A title: with a colon",
        "Why it is wrong.\n\nIn two paragraphs.",
        "a: 1\n\nb: 2\n",
        "a: 2\n",
    ),
    "DIF217": RulePage("Another title", "It follows at once.", "", "c: 3\n"),
}


def test_a_theme_has_a_page_for_each_heading(tmp_path):
    text = f"# Theme\n\nAn introduction.\n\n{FIRST}\n\n{SECOND}"
    (tmp_path / "theme.md").write_text(text, encoding="utf-8")
    (tmp_path / "other.md").write_text("# Other\n", encoding="utf-8")
    assert pages_of_theme("theme", tmp_path) == PAGES
    assert pages_of_theme("other", tmp_path) == {}


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("Wrong:", "False:"),
        ("Right:", "After that:"),
        ("Right:\n\n", "Right:\n"),
        ("yaml\na: 1", "\na: 1"),
        ("a: 2\n```", "a: 2\n"),
        ("Why it is wrong.\n\nIn two paragraphs.\n\n", ""),
    ],
)
def test_a_page_with_another_form_is_refused_with_its_code(old, new, tmp_path):
    text = f"# Theme\n\n{SECOND}\n{FIRST.replace(old, new)}"
    (tmp_path / "theme.md").write_text(text, encoding="utf-8")
    with pytest.raises(ValueError, match=r"^theme.md: ICD001 is not laid out like"):
        pages_of_theme("theme", tmp_path)


def test_a_page_as_markdown_has_the_severity_and_its_labels():
    page = PAGES["ICD001"]
    expected = FIRST.replace("## ", "# ").replace("colon\n", "colon (warning)\n")
    assert page_as_markdown("ICD001", "warning", page) == expected
    expected = expected.replace("Wrong:", "Before:").replace("Right:", "After:")
    labels = "Before", "After"
    assert page_as_markdown("ICD001", "warning", page, labels) == expected
