"""What goes wrong because of what a user asked for, said in a user's words."""

from __future__ import annotations


class UserError(Exception):
    """A request that can't be met. ``help`` says what to do about it."""

    def __init__(self, message: str, help: str = "") -> None:
        super().__init__(message)
        self.help = help


def no_talk(node: str) -> UserError:
    """What is said where a link that is an envelope would have to be talked over."""
    text = (
        f"messages of {node} travel in an envelope (`protocol: stream`), over which icdgen does not talk by itself yet"
    )
    return UserError(text, "generated code sends and finds them: see docs/wire.md, Envelopes")
