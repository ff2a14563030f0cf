"""Text of an ICD appears literally in documentation comments of C.

This includes text that looks like markup. clang and Doxygen check the comments of the
generated C.
"""

from __future__ import annotations

import re
import subprocess

import pytest

from icdgen.backends.c.text import comment
from icdgen.describe.comments import words
from tests.c import harness
from tests.icd import hostile_words

CHECK = (
    "clang",
    "-std=c11",
    "-fsyntax-only",
    "-Wdocumentation",
    "-Werror",
    "-fcomment-block-commands=file",
)


@pytest.mark.parametrize("name", ["shipped", "hostile"])
def test_clang_reports_nothing_about_the_documentation(name, tmp_path):
    icd = (
        harness.shipped()
        if name == "shipped"
        else harness.read_unchecked(hostile_words.write(tmp_path))
    )
    folder = harness.generate(icd, tmp_path / "c")
    source = folder / "all.c"
    source.write_text("".join(f'#include "{node.name}.h"\n' for node in icd.nodes))
    done = subprocess.run(
        [*CHECK, f"-I{folder}", str(source)], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr[:4000]


def test_clang_reports_faults_of_the_documentation(tmp_path):
    source = tmp_path / "bad.c"
    source.write_text("/** <img src=x> \\param y */\nint bad(void);\n")
    done = subprocess.run([*CHECK, str(source)], capture_output=True, text=True)
    assert done.returncode != 0


DOXYGEN = """\
INPUT = {folder}
OUTPUT_DIRECTORY = {folder}/doxygen
RECURSIVE = YES
FILE_PATTERNS = *.h *.c
OPTIMIZE_OUTPUT_FOR_C = YES
PREDEFINED = ICDGEN_SHARED
GENERATE_LATEX = NO
HAVE_DOT = NO
QUIET = YES
WARN_IF_UNDOCUMENTED = NO
"""


def doxygen(folder):
    """Run Doxygen and return its warnings; the pages are in ``doxygen/html``."""
    configuration = folder / "Doxyfile"
    configuration.write_text(DOXYGEN.format(folder=folder))
    return subprocess.run(
        ["doxygen", configuration], capture_output=True, text=True, check=True
    ).stderr


@pytest.mark.parametrize("name", ["shipped", "hostile"])
def test_doxygen_builds_a_site_without_a_warning(name, tmp_path):
    icd = (
        harness.shipped()
        if name == "shipped"
        else harness.read_unchecked(hostile_words.write(tmp_path))
    )
    folder = harness.generate(icd, tmp_path / "c")
    assert doxygen(folder) == ""
    page = "estimated__attitude__angles_8h.html" if name == "shipped" else "index.html"
    assert (folder / "doxygen" / "html" / page).exists()


def test_doxygen_reports_faults_of_the_documentation(tmp_path):
    (tmp_path / "bad.h").write_text(
        "/** @file */\n/** @param other what there is not */\nint bad(int one);\n"
    )
    assert "other" in doxygen(tmp_path)


@pytest.mark.parametrize("word", hostile_words.WORDS)
def test_a_comment_without_its_backslashes_is_the_text_of_the_icd(word):
    text = comment([words(word)]).removeprefix("/** ").removesuffix(" */")
    content = re.sub(r"\\(.)", r"\1", text)
    assert content.replace(" ", "") == words(word).replace(
        " ", ""
    )  # spaces split comment delimiters and trigraphs
    assert not re.search(r"(?<!\\)(\\\\)*[@]|(?<!\\)<[A-Za-z/!]", text)
