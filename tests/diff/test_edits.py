"""Properties of the diff for every edit of the shipped ICDs and every sequence of
edits.
"""

from __future__ import annotations

import random
from collections import Counter
from functools import cache

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from icdgen.diff.change import Change
from icdgen.diff.compare import compare
from icdgen.diff.layers import LAYERS
from icdgen.icd.lines import Line
from icdgen.icd.model import Icd
from tests.conformance.icds import icd_of
from tests.diff.edits import BEYOND, EDITS, TEXT

MIRROR = {
    "DIF101": "DIF102", "DIF113": "DIF114", "DIF123": "DIF124", "DIF130": "DIF131", "DIF132": "DIF133", "DIF207": "DIF208",
    "DIF306": "DIF311", "DIF403": "DIF404",
}  # fmt: skip
MIRROR |= {other: edit for edit, other in MIRROR.items()}

SEEDS = st.integers(0, 2**32)


@cache
def shipped() -> Icd:
    return icd_of()


def edited(names: list[str], seed: int) -> Icd:
    icd = shipped()
    rng = random.Random(seed)
    for name in names:
        done = EDITS[name](icd, rng)
        icd = done.icd if done is not None else icd
    return icd


def test_an_icd_does_not_differ_from_itself():
    icd = shipped()
    assert compare(icd, icd).changes == []
    assert compare(icd, icd_of()).changes == []


@settings(deadline=None, max_examples=30)
@given(names=st.lists(st.sampled_from(sorted(EDITS)), max_size=5), seed=SEEDS)
def test_no_edited_icd_differs_from_itself(names, seed):
    assert compare(edited(names, seed), edited(names, seed)).changes == []


@pytest.mark.parametrize("name", EDITS)
@settings(deadline=None, max_examples=8)
@given(seed=SEEDS)
def test_every_single_edit_is_reported_with_its_code(name, seed):
    done = EDITS[name](shipped(), random.Random(seed))
    assert done is not None
    changes = compare(shipped(), done.icd).changes
    codes = {change.code for change in changes}
    assert done.must <= codes <= done.must | done.may, [
        change.message for change in changes
    ]
    if done.at:
        assert {change.where.message or change.where.enum for change in changes} == {
            done.at
        }


def mirrored(change: Change) -> tuple:
    code = MIRROR.get(change.code, change.code)
    return (
        code,
        change.now,
        change.was,
        *subject(change)[::-1],
        change.new,
        change.old,
        change.confidence,
    )


def as_it_is(change: Change) -> tuple:
    return (
        change.code,
        change.was,
        change.now,
        *subject(change),
        change.old,
        change.new,
        change.confidence,
    )


def subject(change: Change) -> tuple:
    """Return the old and the new object by identity. If an id means another message,
    the subject is the id.
    """
    if change.code == "DIF104":
        return None, None
    sides = change.pair.before, change.pair.after
    return tuple(id(side.node if isinstance(side, Line) else side) for side in sides)


@settings(deadline=None, max_examples=30)
@given(
    names=st.lists(st.sampled_from(sorted(EDITS)), min_size=1, max_size=8), seed=SEEDS
)
def test_the_backward_diff_mirrors_the_forward_diff(names, seed):
    other = edited(names, seed)
    forwards, backwards = (
        compare(shipped(), other).changes,
        compare(other, shipped()).changes,
    )
    assert Counter(map(mirrored, forwards)) == Counter(map(as_it_is, backwards))


@settings(deadline=None, max_examples=30)
@given(names=st.lists(st.sampled_from(TEXT), min_size=1, max_size=8), seed=SEEDS)
def test_text_edits_only_give_text_changes(names, seed):
    assert {
        change.layer for change in compare(shipped(), edited(names, seed)).changes
    } <= {"text"}


@settings(deadline=None, max_examples=30)
@given(
    names=st.lists(st.sampled_from(sorted(EDITS)), min_size=1, max_size=6), seed=SEEDS
)
def test_changes_are_complete_and_ordered_by_layer(names, seed):
    changes = compare(shipped(), edited(names, seed)).changes
    assert [LAYERS.index(c.layer) for c in changes] == sorted(
        LAYERS.index(c.layer) for c in changes
    )
    for change in changes:
        assert change.message and change.where.node and 0 < change.confidence <= 1
        assert change.was != change.now or change.code in (
            "DIF108",
            "DIF109",
            "DIF408",
        ), change


def test_the_edits_include_texts_and_objects_outside_messages():
    assert set(TEXT) < set(EDITS) and set(BEYOND) < set(EDITS)
