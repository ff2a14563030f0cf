"""All languages have the same comments and names of constants."""

from __future__ import annotations

import re
from functools import cache

import pytest

from icdgen import backends
from icdgen.describe import MessageDescription, describe
from icdgen.icd.model import Icd
from icdgen.render import Renderer
from tests.conformance.icds import shipped

LANGUAGES = ("c", "python", "rust")


@cache
def text(language: str) -> str:
    """Return all generated text of a language, without comment signs, escapes and line
    breaks.
    """
    files = backends.get(language).files(shipped(), Renderer(language))
    joined = "\n".join(text for _, text in files)
    return _plain(
        re.sub(r"^\s*(/\*\*|\*/|\*|///|//!|#)", "", joined, flags=re.MULTILINE)
    )


def _plain(text: str) -> str:
    return "".join(re.sub(r"[\\\"]", "", text).split())


def messages(icd: Icd) -> list[MessageDescription]:
    return [message for node in describe(icd).nodes for message in node.messages]


@pytest.mark.parametrize("language", LANGUAGES)
def test_every_paragraph_about_messages_fields_and_enumerations_is_generated(language):
    generated = text(language)
    things = [
        thing for message in messages(shipped()) for thing in (message, *message.fields)
    ]
    things += [enum for node in describe(shipped()).nodes for enum in node.enums]
    if language == "c":  # Doxygen has a command for notes
        generated = generated.replace("@note", "Note")
        generated += generated.replace("NoteErratum", "Erratum")
    missing = [
        p
        for thing in things
        for p in thing.comment.paragraphs
        if _plain(p) not in generated
    ]
    assert len(things) > 1400 and missing == []


@pytest.mark.parametrize("language", ["c", "rust"])
def test_every_constant_is_declared_by_its_name(language):
    generated = text(language)
    constants = [
        constant
        for message in messages(shipped())
        for field in message.fields
        for constant in field.constants
    ]
    assert (
        constants
        and [
            constant.name
            for constant in constants
            if constant.name.upper() not in generated
        ]
        == []
    )


def test_constants_on_physical_values_name_the_unit():
    fields = {f.name: f for message in messages(shipped()) for f in message.fields}
    assert [constant.name for constant in fields["reference_spin_rate"].constants] == [
        "reference_spin_rate_deg_per_s_below"
    ]


def test_the_backends_of_a_run_share_one_description():
    assert describe(shipped()) is describe(shipped())
