"""Fixture that runs the command line in this process."""

from __future__ import annotations

from tests.cli.conftest import icdgen  # noqa: F401
