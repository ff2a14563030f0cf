"""What goes wrong because of what a user asked for, said in a user's words."""

from __future__ import annotations


class UserError(Exception):
    """A request that can't be met. ``help`` says what to do about it."""

    def __init__(self, message: str, help: str = "") -> None:
        super().__init__(message)
        self.help = help


def unreadable(path: object, error: OSError, help: str = "check the path") -> UserError:
    """What is said of a file that cannot be read."""
    return UserError(f"cannot read {path}: {error.strerror}", help)
