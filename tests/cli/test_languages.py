"""A command checks names for the languages that it generates, and `icdgen check` for
all languages.
"""

from __future__ import annotations

import pytest

from tests.conftest import DEMO


@pytest.fixture
def restrict(demo):
    """Return an ICD with a field whose name is a reserved word only in C."""
    demo.write_text(
        DEMO.replace(
            "name: Mode,       type: enum, enum: Mode", "name: Restrict, type: uint"
        )
    )
    return demo


def test_check_reports_a_name_that_fails_in_any_language(icdgen, restrict):
    result = icdgen("check", restrict)
    assert result.status == 1
    assert (
        "ICD070" in result.out + result.err
        and "reserved word in C/C++" in result.out + result.err
    )


@pytest.mark.parametrize("language", ["c", "c-selftest", "html", "assurance"])
def test_an_output_with_c_names_is_not_generated_with_a_reserved_word_of_c(
    icdgen, restrict, tmp_path, language
):
    result = icdgen("--lang", language, "--out", "out", restrict)
    assert result.status == 1
    assert "reserved word in C/C++" in result.err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("language", ["python", "rust", "vectors", "xtce"])
def test_reserved_words_of_other_languages_are_ignored(
    icdgen, restrict, tmp_path, language
):
    assert icdgen("--lang", language, "--out", "out", restrict).status == 0
    assert (tmp_path / "out").exists()


def test_a_model_that_was_checked_for_one_language_is_checked_again_for_another(
    icdgen, restrict
):
    assert icdgen("--lang", "rust", "--out", "rust", restrict).status == 0
    assert (
        icdgen("--lang", "rust", "--lang", "c", "--out", "both", restrict).status == 1
    )


def test_commands_that_generate_no_code_check_no_language(icdgen, restrict):
    assert icdgen("show", "--icd", restrict, "demo", "146").status == 0
    assert icdgen("decode", "--icd", restrict, "demo", "146", "000000").status == 0


@pytest.fixture
def named(monkeypatch):
    """Record the languages whose names are listed, once for each message."""
    from icdgen.backends.c.symbols import CNames
    from icdgen.backends.python.symbols import PythonNames
    from icdgen.backends.rust.symbols import RustNames

    languages: list[str] = []
    for language, policy in (
        ("c", CNames),
        ("python", PythonNames),
        ("rust", RustNames),
    ):

        def fields(self, composite, fields, language=language, original=policy.fields):
            languages.append(language)
            return original(self, composite, fields)

        monkeypatch.setattr(policy, "fields", fields)
    return languages


@pytest.mark.parametrize("language", ["c", "python", "rust"])
def test_generating_a_language_lists_the_names_of_that_language_only(
    icdgen, demo, named, language
):
    assert icdgen("--lang", language, "--out", "out", demo).status == 0
    assert set(named) == {language}


def test_a_check_lists_the_names_of_all_languages(icdgen, demo, named):
    assert icdgen("check", demo).status == 0
    assert set(named) == {"c", "python", "rust"}


@pytest.mark.parametrize(
    "words", [("show", "demo", "146"), ("decode", "demo", "146", "000000")]
)
def test_commands_that_generate_no_code_list_no_names(icdgen, demo, named, words):
    command, *arguments = words
    assert icdgen(command, "--icd", demo, *arguments).status == 0
    assert named == []
