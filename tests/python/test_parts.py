"""Parts of composite messages are messages of their own, which one handler serves."""

from __future__ import annotations

import pytest

from icdgen.describe import describe
from icdgen.icd.model import Message
from icdgen.naming import camel
from tests.conformance import composites
from tests.python import packages


@pytest.fixture(scope="module", params=["odd", "shipped"])
def package(request, tmp_path_factory):
    folder = tmp_path_factory.mktemp("parts")
    icd = (
        packages.shipped()
        if request.param == "shipped"
        else packages.read(composites.write(folder / "icd"))
    )
    return packages.write(icd, folder, f"{request.param}_parts")


def class_of(package, message: Message):
    words = describe(package.icd).message(message).words
    return getattr(package.module(message.node), camel(words))


def test_all_parts_come_in_the_order_of_the_frame(package):
    for case in composites.cases(package.icd, 1):
        begins = {one.message: one.at for one in case.message.contains}
        composite = class_of(package, case.message).from_bytes(case.frame)
        found = [(type(part), part.to_bytes()) for part in composite.iter_parts()]
        expected = [(class_of(package, one.part), one.frame) for one in case.parts]
        assert sorted(found, key=str) == sorted(expected, key=str)
        if len(begins) == len(found):
            assert [kind.NAME for kind, _ in found] == sorted(
                begins, key=begins.__getitem__
            )


def test_what_it_does_not_repeat_is_refused(package):
    for case in composites.cases(package.icd, 1):
        composite = class_of(package, case.message).from_bytes(case.frame)
        known = class_of(package, case.parts[0].part)
        with pytest.raises(ValueError, match="does not repeat"):
            type(composite).from_part(composite)
        with pytest.raises(ValueError, match="does not repeat"):
            known.from_part(known())
        for index in (-1, 9):
            with pytest.raises(ValueError, match=f"has none with the index {index}"):
                known.from_part(composite, index)
        assert list(known().iter_parts()) == []
