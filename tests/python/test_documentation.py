"""Text of an ICD appears literally in docstrings, for Sphinx and for Markdown tools.

Words that look like markup of reStructuredText or Markdown are escaped.
"""

from __future__ import annotations

import ast
import re

import pytest

from icdgen.backends.python import PythonBackend
from icdgen.backends.python.text import docstring, prose
from icdgen.render import Renderer
from tests.conformance.icds import read_unchecked
from tests.icd import hostile_words
from tests.limits import assert_limits

# Inline markup where either language begins it, a hyperlink of reStructuredText, and
# what begins a block.
MARKUP = re.compile(
    r"(?<!\\)(?:\\\\)*(?:`|<[A-Za-z/!]|(?:\A|(?<=\s))[*|](?=\S)|(?<=\w)_(?!\w))"
)
BLOCK = re.compile(r"[-+*] |\.\. |>>>|:\w|\d+[.)] ")


@pytest.mark.parametrize("word", hostile_words.WORDS)
def test_a_docstring_shows_the_text_of_the_icd_without_markup(word):
    text = ast.literal_eval(
        docstring(0, [prose(f"{word} {word}"), "Further words."])
    ).splitlines()[0]
    assert not MARKUP.search(text) and not BLOCK.match(text)
    assert re.sub(r"\\(.)", r"\1", text) == f"{word} {word}"


@pytest.mark.parametrize("indent", [0, 4, 8])
def test_a_docstring_of_one_line_fits_into_88_characters_with_its_quotes(indent):
    def has_one_line(length: int) -> bool:
        text = ("word " * 20)[: length - 1] + "x"
        lines = (" " * indent + docstring(indent, [text])).split("\n")
        assert max(map(len, lines)) <= 88
        assert " ".join("".join(lines).replace('"', "").split()) == text
        return len(lines) == 1

    assert_limits(has_one_line, most=88 - 6 - indent)


def test_a_docstring_of_several_paragraphs_is_wrapped_and_indented():
    text = docstring(4, ["Speed of the motor.", "word " * 17 + "word", "x" * 90])
    assert text.split("\n") == [
        '"""Speed of the motor.',
        "",
        "    " + "word " * 16 + "word",
        "    word",
        "",
        "    " + "x" * 90,
        '    """',
    ]
    assert docstring(4, ["x" * 90]) == f'"""{"x" * 90}"""'


def test_every_file_is_valid_python_with_hostile_words_in_the_icd(tmp_path):
    icd = read_unchecked(hostile_words.write(tmp_path))
    for path, text in PythonBackend().files(icd, Renderer("python")):
        if path.suffix == ".py":
            compile(text, str(path), "exec", flags=ast.PyCF_ONLY_AST)
