"""A release has an entry in the changelog, and its documents meet their limits.

Entries are short, links of the README work outside the repository, and hooks run
existing commands.
"""

from __future__ import annotations

import re
import tomllib

from icdgen import __version__
from tests.conftest import ROOT

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
CHANGELOG = (ROOT / "CHANGELOG.md").read_text("utf-8")


def test_the_changelog_has_the_version_with_a_date():
    assert re.search(
        rf"^## {re.escape(__version__)} - \d{{4}}-\d\d-\d\d$", CHANGELOG, re.MULTILINE
    )


def test_an_entry_of_the_changelog_is_one_line_under_150_characters():
    assert [
        line
        for line in CHANGELOG.splitlines()
        if len(line) >= 150 or re.match(r"\s+\S", line)
    ] == []


def test_a_package_index_shows_the_readme_with_absolute_links():
    text = (ROOT / "README.md").read_text("utf-8")
    for rule in PROJECT["tool"]["hatch"]["metadata"]["hooks"]["fancy-pypi-readme"][
        "substitutions"
    ]:
        text = re.sub(rule["pattern"], rule["replacement"], text)
    links = re.findall(r"\]\(([^)\s]+)\)", text)
    assert (
        links
        and [link for link in links if not link.startswith(("https://", "#"))] == []
    )


def test_the_readme_has_at_most_700_words_besides_code():
    text = (ROOT / "README.md").read_text("utf-8")
    assert (
        len(re.sub(r"^```.*?^```", "", text, flags=re.DOTALL | re.MULTILINE).split())
        <= 700
    )


def test_hooks_and_workflow_run_commands_that_exist():
    from icdgen.cli import icdgen

    hooks = re.findall(
        r"^  entry: icdgen (\w+)",
        (ROOT / ".pre-commit-hooks.yaml").read_text("utf-8"),
        re.MULTILINE,
    )
    workflow = re.findall(
        r"run: icdgen (\w+)",
        (ROOT / ".github/workflows/check-icds.yml").read_text("utf-8"),
    )
    assert (
        set(hooks)
        == set(workflow)
        == {"check", "fmt"}
        <= set(icdgen.list_commands(None))
    )
