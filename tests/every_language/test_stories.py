"""Generated code behaves in every language as the stories of this folder claim.

A story is an ICD with claims about the code generated from it, see `story`.
"""

from __future__ import annotations

import pytest

from tests.every_language import programs
from tests.every_language.stories import STORIES
from tests.rust.tools import toolchains

RUST = {f"rust {name}": name for name in toolchains()}
LANGUAGES = [
    *(
        pytest.param(compiler, marks=pytest.mark.needs(compiler))
        for compiler in ("gcc", "clang", "g++")
    ),
    *(pytest.param(name, marks=pytest.mark.needs("rustc")) for name in RUST),
    "python",
]


@pytest.fixture(scope="module", params=LANGUAGES)
def run(request, tmp_path_factory) -> programs.Run:
    """Function that checks the claims of a story in one language."""
    name, folder = request.param, tmp_path_factory.mktemp("stories")
    if name == "python":
        return programs.in_python(STORIES, folder)
    if name in RUST:
        return programs.in_rust(RUST[name], STORIES, folder)
    return programs.in_c(name, STORIES, folder)


@pytest.mark.parametrize("story", STORIES, ids=lambda story: story.node)
def test_all_claims_of_a_story_are_true(run, story):
    run(story)
