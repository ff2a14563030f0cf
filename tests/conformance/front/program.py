"""The program of a language: a line of words is asked, a line of words is answered."""

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
    """The program ended, or said what is no answer."""


class Reply(NamedTuple):
    """An answer: what it says of the whole, and rows of a kind each."""

    facts: Facts
    rows: list[tuple[str, Facts]]

    def of(self, *kinds: str) -> list[Facts]:
        """What the rows of these kinds say."""
        return [facts for kind, facts in self.rows if kind in kinds]


class Program:
    """A running program."""

    def __init__(self, command: Sequence[str]) -> None:
        self.process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, bufsize=1 << 16
        )

    def ask(self, line: str) -> str:
        """The answer to a line. Raises `Died`."""
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
        """Ends its input; its exit status."""
        assert self.process.stdin
        with suppress(OSError):
            self.process.stdin.close()
        return self.process.wait()


def asked(ask: Ask, *words: object) -> Reply:
    """What the program answers to these words.

    Raises `Refusal` if it refuses, `Died` if that is no answer.
    """
    found = read(ask(" ".join(map(str, words))))
    error, facts = found.rows[0]
    if error == "ok":
        whole: Facts = {}
        for kind, more in found.rows:
            if kind == "ok":
                whole |= more
        return Reply(whole, [row for row in found.rows if row[0] != "ok"])
    if error != "refused" or len(found.rows) != 2:
        raise Died
    error, facts = found.rows[1]
    raise Refusal(error, **{key: _told(key, value) for key, value in facts.items()})


def read(line: str) -> Reply:
    """A line in rows: a bare word begins one, ``key=value`` belongs to the last."""
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
    """The parts of a list, each of which may end with a comma."""
    return value.removesuffix(",").split(",") if value else []


def text_of(value: str | None) -> str | None:
    """A text, which stands in hex as UTF-8."""
    return (
        None if value is None else bytes.fromhex(value).decode("utf-8", "surrogatepass")
    )


def _told(key: str, value: str) -> object:
    return int(value) if key in NUMBERS else text_of(value)
