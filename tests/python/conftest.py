"""Fixtures: generated packages that the tests of a session share."""

from __future__ import annotations

import pytest

from tests.python import orders, packages
from tests.python.packages import Package


@pytest.fixture(scope="session")
def shipped(tmp_path_factory) -> Package:
    """Package generated from the ICDs of the project."""
    return packages.write(
        packages.shipped(), tmp_path_factory.mktemp("shipped"), "icdgen_messages"
    )


@pytest.fixture(scope="session")
def odd(tmp_path_factory) -> Package:
    """Package generated from an ICD with odd layouts and hostile names."""
    return packages.write(
        packages.read(packages.ODD), tmp_path_factory.mktemp("odd"), "odd_messages"
    )


@pytest.fixture(scope="session")
def ordered(tmp_path_factory) -> Package:
    """Package generated from ICDs of all bit and byte orders."""
    icd = packages.read(orders.write(tmp_path_factory.mktemp("orders")))
    return packages.write(icd, tmp_path_factory.mktemp("ordered"), "ordered_messages")


@pytest.fixture(params=["shipped", "odd", "ordered"])
def package(request) -> Package:
    """Run the test once for each of the three packages."""
    return request.getfixturevalue(request.param)
