"""``icdgen.toml``: the search for it, its keys, and its errors."""

from __future__ import annotations

from pathlib import Path

import pytest

from icdgen import config
from icdgen.diagnostics import Place
from icdgen.errors import UserError


def test_paths_are_relative_to_the_file_and_the_nearest_one_upwards_counts(tmp_path):
    (tmp_path / "icdgen.toml").write_text(
        'icds = ["icd/a.yaml"]\nlang = ["c"]\nout = "gen"\n'
    )
    below = tmp_path / "src" / "deep"
    below.mkdir(parents=True)
    settings = config.find(below)
    assert settings.icds == [tmp_path / "icd/a.yaml"]
    assert (settings.lang, settings.out) == (["c"], tmp_path / "gen")
    assert list(settings.looked_at) == [
        below / "icdgen.toml",
        tmp_path / "src" / "icdgen.toml",
        tmp_path / "icdgen.toml",
    ]


def test_the_search_ends_at_the_top_of_the_checkout(tmp_path):
    (tmp_path / "icdgen.toml").write_text('lang = ["c"]\n')
    inner = tmp_path / "inner"
    (inner / ".git").mkdir(parents=True)
    assert config.find(inner).lang == []


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("lang = [", "not TOML"),
        ('langs = ["c"]', "unknown key `langs`"),
        ('lang = "c"', "`lang` must be a list"),
        ("lang = [1]", "`lang` must be a list"),
        ("out = 1", "`out` must be a text"),
    ],
)
def test_a_mistake_is_named_with_the_file(tmp_path, text, words):
    (tmp_path / "icdgen.toml").write_text(text)
    with pytest.raises(UserError, match=words) as error:
        config.find(tmp_path)
    assert "icdgen.toml" in str(error.value)


KNOWN = (
    "known keys: name, icds, lang, out, templates, "
    "and the sections [python], [rust], [c]"
)
LIST = 'for instance {} = ["..."]'
TEXT = 'for instance {} = "..."'
EMPTY = "`{}` holds an empty text, or a NUL character"
REMOVE = "write a path or a name, or take it out"


@pytest.mark.parametrize(
    ("text", "place", "message", "help"),
    [
        ("lang = [", "", "not TOML: Invalid value (at end of document)", "see https://toml.io"),
        ("\nout = x", ":2:7", "not TOML: Invalid value", "see https://toml.io"),
        ("\n  icdz = 1", ":2:3", "unknown key `icdz`", KNOWN),
        ('"icdz" = 1', ":1:1", "unknown key `icdz`", KNOWN),
        ("icds = 1", ":1:1", "`icds` must be a list of texts", LIST.format("icds")),
        ("lang = ['c', 1]", ":1:1", "`lang` must be a list of texts", LIST.format("lang")),
        ("out = ['a']", ":1:1", "`out` must be a text", TEXT.format("out")),
        ("templates = 1", ":1:1", "`templates` must be a text", TEXT.format("templates")),
        ("name = true", ":1:1", "`name` must be a text", TEXT.format("name")),
        ("out = ''", ":1:1", EMPTY.format("out"), REMOVE),
        ("lang = ['c', '']", ":1:1", EMPTY.format("lang"), REMOVE),
        ('name = "a\\u0000"', ":1:1", EMPTY.format("name"), REMOVE),
        ("[rust]\ncrate = ''", ":2:1", EMPTY.format("crate"), REMOVE),
        ("[rust]\n\n crate = 1", ":3:2", "`crate` must be a text", TEXT.format("crate")),
        ("[c]\nprefix = ['a']", ":2:1", "`prefix` must be a text", TEXT.format("prefix")),
        ("rust = 1", ":1:1", "`rust` must be a section", '[rust], and below it crate = "..."'),
        ("c = 'a'", ":1:1", "`c` must be a section", '[c], and below it prefix = "..."'),
        ("[c]\nprefix='a'\ncrate='a'", ":3:1", "unknown key `crate` in [c]", "known key: prefix"),
        ("[rust]\ncrate='a'\n[python]\ncrate='a'", ":4:1", "unknown key `crate` in [python]",
         "known key: package"),
        ("python.crate = 'a'", ":1:1", "unknown key `crate` in [python]", "known key: package"),
        ("name = 'a'\n[wrong]\nname = 'b'", ":2:2", "unknown key `wrong`", KNOWN),
    ],
)  # fmt: skip
def test_each_mistake_has_its_place_and_a_remedy(tmp_path, text, place, message, help):
    path = tmp_path / "icdgen.toml"
    path.write_text(text)
    with pytest.raises(UserError) as error:
        config.find(tmp_path)
    assert (str(error.value), error.value.help) == (f"{path}{place}: {message}", help)


def test_a_file_that_is_not_utf8_is_an_error(tmp_path):
    (tmp_path / "icdgen.toml").write_bytes(b'name = "\xff"')
    with pytest.raises(UserError, match=r"icdgen\.toml: cannot be read \(") as error:
        config.find(tmp_path)
    assert error.value.help == "save it as UTF-8"


def test_every_key_is_read(tmp_path):
    (tmp_path / "icdgen.toml").write_text(
        'name = "pump"\nicds = ["a.yaml", "/abs/b.yaml"]\nlang = ["c", "rust"]\n'
        'out = "gen"\ntemplates = "t"\n[python]\npackage = "p"\n[rust]\n[c]\nprefix = "x"\n'
    )
    read = config.find(tmp_path)
    assert read.path == tmp_path / "icdgen.toml"
    assert read.text == (tmp_path / "icdgen.toml").read_text()
    assert (read.name, read.lang) == ("pump", ["c", "rust"])
    assert read.icds == [tmp_path / "a.yaml", Path("/abs/b.yaml")]
    assert (read.out, read.templates) == (tmp_path / "gen", tmp_path / "t")
    assert read.packages == {"python": "p", "c": "x"}


def test_without_a_file_every_key_has_its_default(tmp_path):
    (tmp_path / ".git").mkdir()
    (tmp_path / "icdgen.toml").mkdir()  # a folder of that name is no configuration
    read = config.find(tmp_path)
    assert (read.path, read.text, read.icds, read.lang) == (None, "", [], [])
    assert (read.out, read.templates, read.name, read.packages) == (None, None, "", {})
    assert list(read.looked_at) == [tmp_path / "icdgen.toml"]


def test_a_file_at_the_top_of_the_checkout_applies_below_it(tmp_path):
    (tmp_path / ".git").write_text("gitdir: elsewhere\n")  # as in a worktree
    (tmp_path / "icdgen.toml").write_text('lang = ["c"]\n')
    (tmp_path / "a").mkdir()
    assert config.find(tmp_path / "a").lang == ["c"]


PLACES = """\
# icd/a.yaml in a comment has no quotes
icds = ["icd/a.yaml", './icd/b.yaml', "icd/c/",
  "icd/dxyaml", "icd/d.yaml", "/elsewhere/e.yaml"]
name = "n"
rust.crate = "r"
'out' = "o"
[ "c" ]
  prefix = "p"
"""


@pytest.mark.parametrize(
    ("icd", "line", "column", "length"),
    [
        ("icd/a.yaml", 2, 10, 10),
        ("icd/b.yaml", 2, 24, 12),
        ("icd/c", 2, 40, 6),
        ("icd/d.yaml", 3, 18, 10),
        ("/elsewhere/e.yaml", 3, 32, 17),
        ("icd/other.yaml", 1, 1, 1),
    ],
)
def test_an_icd_has_the_place_of_its_entry(tmp_path, icd, line, column, length):
    path = tmp_path / "icdgen.toml"
    path.write_text(PLACES)
    place = config.find(tmp_path).place_of(tmp_path / icd)
    assert place == Place(str(path), line, column, length)


@pytest.mark.parametrize(
    ("section", "key", "line", "column", "length"),
    [
        ("", "name", 4, 1, 4),
        ("", "rust", 5, 1, 4),
        ("rust", "crate", 5, 1, 10),
        ("", "out", 6, 1, 5),
        ("c", "prefix", 8, 3, 6),
        ("", "c", 7, 4, 1),
        ("", "prefix", 1, 1, 1),
        ("python", "package", 1, 1, 1),
    ],
)
def test_a_key_has_the_place_of_its_name(tmp_path, section, key, line, column, length):
    path = tmp_path / "icdgen.toml"
    path.write_text(PLACES)
    place = config.find(tmp_path).place_of_key(section, key)
    assert place == Place(str(path), line, column, length)
