"""``icdgen.toml``: the search for it, its keys, and its errors."""

from __future__ import annotations

import pytest

from icdgen import config
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
