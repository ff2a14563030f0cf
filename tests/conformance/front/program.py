"""Talk to the program of a language: one line of words per question, one line of words
per reply.
"""

from __future__ import annotations

import subprocess
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import NamedTuple

from icdgen.runtime_objects.refusals import Refusal

Facts = dict[str, str]
Ask = Callable[[str], str]
NUMBERS = {"expected", "actual", "at"}


class Died(Exception):
    """The program ended, or its reply is malformed."""


class Reply(NamedTuple):
    """A reply of the program: facts about the request as a whole, and rows of several
    kinds.
    """

    facts: Facts
    rows: list[tuple[str, Facts]]

    def rows_of(self, *kinds: str) -> list[Facts]:
        """Return the facts of the rows of these kinds."""
        return [facts for kind, facts in self.rows if kind in kinds]


class Program:
    """A running program."""

    def __init__(self, command: Sequence[str]) -> None:
        self.process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, bufsize=1 << 16
        )

    def ask(self, line: str) -> str:
        """Return the reply to a line. Raises `Died`."""
        assert self.process.stdin and self.process.stdout
        try:
            self.process.stdin.write(line.encode("ascii") + b"\n")
            self.process.stdin.flush()
        except OSError:
            raise Died from None
        answer = self.process.stdout.readline()
        if not answer.endswith(b"\n"):
            raise Died
        return answer[:-1].decode("ascii", "replace")

    def close(self) -> int:
        """Close the program's input and return its exit status."""
        assert self.process.stdin
        with suppress(OSError):
            self.process.stdin.close()
        return self.process.wait()


def reply_to(ask: Ask, *words: object) -> Reply:
    """Return the program's reply to these words. Raises `Refusal` if it refuses, `Died`
    if the reply is malformed.
    """
    reply = rows_of_line(ask(" ".join(map(str, words))))
    error, facts = reply.rows[0]
    if error == "ok":
        facts_of_reply: Facts = {}
        for kind, more in reply.rows:
            if kind == "ok":
                facts_of_reply |= more
        return Reply(facts_of_reply, [row for row in reply.rows if row[0] != "ok"])
    if error != "refused" or len(reply.rows) != 2:
        raise Died
    error, facts = reply.rows[1]
    raise Refusal(error, **{key: _told(key, value) for key, value in facts.items()})


def rows_of_line(line: str) -> Reply:
    """Split a line into rows. A bare word starts a row, and ``key=value`` belongs to
    the last row.
    """
    rows: list[tuple[str, Facts]] = []
    for word in line.split(" "):
        key, equals, value = word.partition("=")
        if not equals:
            rows.append((word, {}))
        elif not rows:
            raise Died
        else:
            rows[-1][1][key] = value
    return Reply({}, rows)


def items(value: str) -> list[str]:
    """Split a list, in which each item may end with a comma."""
    return value.removesuffix(",").split(",") if value else []


def text_of(value: str | None) -> str | None:
    """Return a text, which the reply contains as UTF-8 in hex."""
    return (
        None if value is None else bytes.fromhex(value).decode("utf-8", "surrogatepass")
    )


def _told(key: str, value: str) -> object:
    return int(value) if key in NUMBERS else text_of(value)
