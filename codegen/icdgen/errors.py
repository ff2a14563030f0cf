"""Errors that a user can correct."""

from __future__ import annotations


class UserError(Exception):
    """A request of a user cannot be met. ``help`` is what to do about it."""

    def __init__(self, message: str, help: str = "") -> None:
        super().__init__(message)
        self.help = help


def unreadable(path: object, error: OSError, help: str = "check the path") -> UserError:
    """Return the error for a file that cannot be read."""
    return UserError(f"cannot read {path}: {error.strerror}", help)
