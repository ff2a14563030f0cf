"""Talk to a testee: send many requests and read one line of answer for each."""

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
    """Interface of everything that answers requests."""

    def ask(self, lines: Sequence[bytes]) -> list[bytes | None]:
        """Return the answer to each line, or ``None`` where no answer came."""

    def close(self) -> int:
        """End the testee and return its exit status."""

    def complaint(self) -> str:
        """Return what was written to standard error."""


class InProcess:
    """A testee that is a function of this process."""

    def __init__(self, answer: Callable[[bytes], dict]) -> None:
        self.answer = answer

    def ask(self, lines: Sequence[bytes]) -> list[bytes | None]:
        return [json.dumps(self.answer(line)).encode() for line in lines]

    def close(self) -> int:
        return 0

    def complaint(self) -> str:
        return ""


class Testee:
    """A running testee. If it dies or does not answer, it is restarted for the next
    requests.
    """

    __test__ = False  # not a test class

    def __init__(self, command: Sequence[str], timeout: float = 120.0) -> None:
        self.command, self.timeout = list(command), timeout
        self.process: subprocess.Popen[bytes] | None = None
        self.errors = tempfile.TemporaryFile()  # noqa: SIM115
        self.deaths = 0

    def ask(self, lines: Sequence[bytes]) -> list[bytes | None]:
        """Return the answer to each line without its newline. A line is answered with
        ``None`` if the testee died.
        """
        if self.process is None:
            self.process = subprocess.Popen(
                self.command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self.errors, bufsize=1 << 18,
                # A session of its own, so that a kill reaches the program behind the front.
                start_new_session=True,
            )  # fmt: skip
        process = self.process
        assert process.stdin and process.stdout
        # A thread writes: with full pipes both sides would wait for each other.
        writer = threading.Thread(
            target=self._write, args=(process, lines), daemon=True
        )
        watchdog = threading.Timer(self.timeout, _kill, [process])
        watchdog.start()
        writer.start()
        answers: list[bytes | None] = []
        for _ in lines:
            answer = process.stdout.readline()
            # An incomplete line is the last output of a testee that died.
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
        """Close the testee's input and return its exit status (0 if it was never
        started).
        """
        return self._end(kill=False)

    def complaint(self) -> str:
        """Return the last lines that the testee wrote to standard error."""
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
    """Kill the front and the program that it has started."""
    with suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
