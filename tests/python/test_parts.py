"""Parts of composite messages are ordinary messages, so one handler serves them all.

`iter_parts` and `from_part` extract them from a composite message.
"""

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


def test_all_parts_are_yielded_in_the_order_of_the_frame(package):
    for case in composites.cases(package.icd, 1):
        positions = {part.message: part.at for part in case.message.contains}
        composite = class_of(package, case.message).from_bytes(case.frame)
        parts = [(type(part), part.to_bytes()) for part in composite.iter_parts()]
        expected = [(class_of(package, part.part), part.frame) for part in case.parts]
        assert sorted(parts, key=str) == sorted(expected, key=str)
        if len(positions) == len(parts):
            assert [kind.NAME for kind, _ in parts] == sorted(
                positions, key=positions.__getitem__
            )


def test_a_message_that_the_composite_does_not_contain_is_refused(package):
    for case in composites.cases(package.icd, 1):
        composite = class_of(package, case.message).from_bytes(case.frame)
        part_class = class_of(package, case.parts[0].part)
        with pytest.raises(ValueError, match="does not repeat"):
            type(composite).from_part(composite)
        with pytest.raises(ValueError, match="does not repeat"):
            part_class.from_part(part_class())
        for index in (-1, 9):
            with pytest.raises(ValueError, match=f"has none with the index {index}"):
                part_class.from_part(composite, index)
        assert list(part_class().iter_parts()) == []
