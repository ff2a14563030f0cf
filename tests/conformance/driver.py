"""Talks to a testee: many requests at once, each answered by one line."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import tempfile
import threading
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Protocol


class Answering(Protocol):
    """What requests can be put to."""

    def ask(self, lines: Sequence[bytes]) -> list[bytes | None]:
        """The answer to each line; None where there was none."""

    def close(self) -> int:
        """The exit status."""

    def complaint(self) -> str:
        """What was written to standard error."""


class InProcess:
    """A testee that is a function of this program."""

    def __init__(self, answer: Callable[[bytes], dict]) -> None:
        self.answer = answer

    def ask(self, lines: Sequence[bytes]) -> list[bytes | None]:
        return [json.dumps(self.answer(line)).encode() for line in lines]

    def close(self) -> int:
        return 0

    def complaint(self) -> str:
        return ""


class Testee:
    """A running testee.

    One that dies or falls silent is started again for the next requests.
    """

    __test__ = False  # not a test class

    def __init__(self, command: Sequence[str], timeout: float = 120.0) -> None:
        self.command, self.timeout = list(command), timeout
        self.process: subprocess.Popen[bytes] | None = None
        self.errors = tempfile.TemporaryFile()  # noqa: SIM115
        self.deaths = 0

    def ask(self, lines: Sequence[bytes]) -> list[bytes | None]:
        """The answer to each line (without its newline); None for each that was not
        answered because the testee died.
        """
        if self.process is None:
            self.process = subprocess.Popen(
                self.command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self.errors, bufsize=1 << 18,
                start_new_session=True,
            )  # fmt: skip
        process = self.process
        assert process.stdin and process.stdout
        writer = threading.Thread(
            target=self._write, args=(process, lines), daemon=True
        )
        watchdog = threading.Timer(self.timeout, _kill, [process])
        watchdog.start()
        writer.start()
        answers: list[bytes | None] = []
        for _ in lines:
            answer = process.stdout.readline()
            if not answer.endswith(b"\n"):
                break
            answers.append(answer[:-1])
        watchdog.cancel()
        if len(answers) < len(lines):
            self.deaths += 1
            self._end(kill=True)
        writer.join()
        return answers + [None] * (len(lines) - len(answers))

    @staticmethod
    def _write(process: subprocess.Popen[bytes], lines: Sequence[bytes]) -> None:
        assert process.stdin
        try:
            process.stdin.write(b"".join(line + b"\n" for line in lines))
            process.stdin.flush()
        except (BrokenPipeError, ValueError, OSError):
            pass

    def close(self) -> int:
        """Ends the testee's input; its exit status (0 for one that was never started)."""
        return self._end(kill=False)

    def complaint(self) -> str:
        """The last that it wrote to its standard error."""
        self.errors.seek(0)
        return self.errors.read()[-2000:].decode("utf-8", "replace")

    def _end(self, kill: bool) -> int:
        process, self.process = self.process, None
        if process is None:
            return 0
        if kill:
            _kill(process)
        try:
            if process.stdin:
                process.stdin.close()
        except OSError:
            pass
        try:
            status = process.wait(10)
        except subprocess.TimeoutExpired:
            _kill(process)
            status = process.wait()
        if process.stdout:
            process.stdout.close()
        return status


def _kill(process: subprocess.Popen[bytes]) -> None:
    """The front, and the program that it asks."""
    with suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
