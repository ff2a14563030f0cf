"""Random scripts of the client of framed links, with the answers of the reference
implementation.

    python -m tests.conformance.outcomes --lang c,rust --scripts 3000
    python -m tests.conformance.outcomes --lang c --seed 7 --show 5 my_link.yaml

Each script starts and cancels requests, lets time pass, and receives responses to
earlier requests, responses to other requests, damaged messages and unsolicited
telemetry. Ends with status 0 if no answer differs, else 1. The test
``test_outcomes.py`` runs some scripts in each language.
"""

from __future__ import annotations

import argparse
import json
import random
import sys
from collections.abc import Iterator
from contextlib import suppress
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

from icdgen_runtime._errors import IcdError

from icdgen.icd.model import Icd
from icdgen.icd.responses import BUSY, NAK
from icdgen.protocol import facts
from icdgen.protocol.exchange import Exchange, Response
from icdgen.protocol.packet_formats import Stream, StreamRow
from icdgen.runtime_objects import reference
from icdgen.runtime_objects.links import link_of
from icdgen.vectors.wire.asking import StreamSample, wire_place
from tests.conformance.build import BuildError, build
from tests.conformance.compare import difference
from tests.conformance.driver import Testee
from tests.conformance.icds import LINKS, ROOT, icd_of
from tests.conformance.languages import SELFTEST, all_languages
from tests.conformance.run import selected_languages

EXAMPLES = [ROOT / "examples" / "links", LINKS]
TIMES = {
    "reply_timeout": (1, 100, 100, 300),
    "retries": (0, 1, 2),
    "late": (1, 50, 100),
    "busy_pause": (1, 30, 100),
    "gap": (0, 0, 5, 50),
    "in_flight": (1, 1, 2, 3, 8),
    "progress_for": (1, 120, 250),
}
# Sums and differences of the times above, so that scripts often meet the exact end of a
# time-out; the last ones are the time-outs of the examples.
STEPS = (
    0,
    0,
    0,
    0,
    1,
    1,
    5,
    10,
    20,
    29,
    30,
    49,
    50,
    51,
    70,
    95,
    99,
    100,
    101,
    200,
    3000,
)
HALF = 1 << 31  # times with the sign bit of 32 bits
Row = dict[str, object]

if TYPE_CHECKING:
    from icdgen_runtime.wire.link import Link


class Script:
    """Builder of a script for a node."""

    def __init__(self, link: Link[Any], form: Stream, source: random.Random) -> None:
        self.form, self.source = form, source
        self.sample = StreamSample(link, form, source)
        self.begun: list[tuple[StreamRow, Row]] = []
        self.now = source.choice((0, 0, 1000, HALF - 300))

    def rows(self, count: int) -> Iterator[Row]:
        """Yield rows of the script."""
        makers = (self.telecommand, self.telemetry, self.receive, self.cancel, dict)
        weights = (30, 8, 40, 4, 18)
        for _ in range(count):
            self.now += self.source.choice(STEPS)
            (make,) = self.source.choices(makers, weights)
            row = make() | {"at": self.now}
            if self.source.random() < 0.1:
                row["untaken"] = True
            yield row

    def telecommand(self) -> Row:
        """Return a row that starts a request, sometimes with an error."""
        # Telecommands with responses are of more interest.
        of_interest = [row for row in self.form.telecommands if row.exchange]
        row = self.source.choice(
            of_interest
            if of_interest and self.source.random() < 0.8
            else self.form.telecommands
        )
        size = self.source.choice((row.least, row.most, row.most))
        if self.source.random() < 0.05:
            size = self.source.randrange(row.most + 2)
        # Changing the lowest bit of an id gives another message or none.
        started: Row = {
            "telecommand": row.id ^ (self.source.random() < 0.02),
            "bytes": self.data(size).hex(),
        }
        if self.source.random() < 0.4:
            started["repeat"] = True
        if self.form.telemetry and self.source.random() < 0.15:
            reply = self.source.choice(self.form.telemetry).id
            started["reply"] = reply ^ (self.source.random() < 0.05)
        self.begun.append((row, started))
        return started

    def telemetry(self) -> Row:
        """Return a row that requests telemetry."""
        asking = [row for row in self.form.telecommands if row.requests is not None]
        asking += [row for row in self.form.telemetry if row.is_requested]
        if asking and self.source.random() < 0.8:
            row = self.source.choice(asking)
            if row.is_requested:
                started: Row = {"telemetry": row.id}
                self.begun.append((row, started))
                return started
            data = bytes(row.least).hex()
            self.begun.append((row, {"telecommand": row.id, "bytes": data}))
            return {"telemetry": row.requests}
        ids = [row.id for row in self.form.telemetry]
        return {"telemetry": self.source.choice([*ids, 3])}

    def data(self, size: int) -> bytes:
        """Return data that often equal the data of other messages."""
        # A response may repeat data of its telecommand, which only matters if equal.
        if self.source.random() < 0.7:
            return bytes(self.source.choices((0, 1), k=size))
        return self.source.randbytes(size)

    def receive(self) -> Row:
        """Return a row that receives one or two messages, sometimes cut or damaged."""
        count = self.source.choice((1, 1, 1, 1, 2))
        line = b"".join(self.line() for _ in range(count))
        if line and self.source.random() < 0.05:
            damaged = bytearray(line)
            damaged[self.source.randrange(len(line))] ^= 1
            line = bytes(damaged)
        if self.source.random() < 0.03:
            line = line[: self.source.randrange(len(line) + 1)]
        return {"receive": line.hex()}

    def line(self) -> bytes:
        """Return an encoded message: mostly a response to a recent telecommand."""
        if not self.form.telemetry:
            return b""
        row, started = self.source.choice(self.begun[-4:]) if self.begun else (None, {})
        chance = self.source.random()
        exchange = self.form.exchange_of(row) if row else None
        if exchange and chance < 0.8:
            return self.response(exchange, started)
        frame = self.source.choice(self.form.telemetry)
        named = started.get("reply")
        if chance < 0.9:
            frame = next((row for row in self.form.telemetry if row.id == named), frame)
        return self.encoded(frame, self.data(frame.most))

    def response(self, exchange: Exchange, started: Row) -> bytes:
        """Return a response to a telecommand, sometimes with a foreign echo."""
        # Otherwise most requests would be refused.
        accepted = [row for row in exchange.responses if row.verdict not in (NAK, BUSY)]
        response = self.source.choice(
            accepted if accepted and self.source.random() < 0.4 else exchange.responses
        )
        if response.packet is not None:
            return self._packet(exchange, response, started)
        id = response.telemetry
        if id is None:  # the requested telemetry
            id = started.get("telemetry", 0)
        frame = next(row for row in self.form.telemetry if row.id == id)
        data = bytearray(self.data(frame.most))
        self._echo(data, exchange, response, started)
        if response.status and response.meanings and self.source.random() < 0.8:
            value, _ = self.source.choice(response.meanings)
            wire_place(response.status).put(value, data)
        return self.encoded(frame, bytes(data))

    def _packet(self, exchange: Exchange, response: Response, started: Row) -> bytes:
        """Return a packet without a message that responds."""
        assert response.packet is not None
        packet = self.form.packets[response.packet]
        draft = bytearray(packet.overhead + packet.reserved)
        self._echo(draft, exchange, response, started)
        if response.reason:
            place = wire_place(response.reason)
            number = self.source.randrange(1, 1 << place.bits)
            if response.reasons and self.source.random() < 0.5:
                number, _ = self.source.choice(response.reasons)
            place.put(number, draft)
        return self.sample.packet(response.packet, bytes(draft))

    def _echo(
        self, data: bytearray, exchange: Exchange, response: Response, started: Row
    ) -> None:
        id = started.get("telecommand", started.get("telemetry"))
        text = started.get("bytes", "")
        assert isinstance(id, int) and isinstance(text, str)
        telecommand = id.to_bytes(4, "big") + bytes.fromhex(text)
        header = b""
        if exchange.in_header:
            with suppress(IcdError):  # the request is one that cannot be sent
                header = self.sample.header_of(started)
        for echo in response.echoes:
            in_header = exchange.is_in_header(echo.source)
            sent = header if in_header else telecommand
            number = wire_place(exchange.sources[echo.source]).of(sent)
            foreign = self.source.random() < 0.05
            wire_place(echo.place).put(number ^ foreign, data)

    def encoded(self, frame: StreamRow, data: bytes) -> bytes:
        """Return a message with header and trailer."""
        size = len(data)
        if self.source.random() < 0.05:
            size = self.source.randint(frame.least, frame.most)
        lost = self.source.choice((0,) * 20 + (1, 2))
        line = self.sample.come(0, frame, lost, data[:size])["receive"]
        return bytes.fromhex(line)

    def cancel(self) -> Row:
        """Return a row that cancels requests."""
        if not self.begun or self.source.random() < 0.3:
            return {"cancel": True}
        row, started = self.source.choice(self.begun[-4:])
        if row.is_requested:
            return {"cancel": True, "telemetry": row.id}
        if row.requests is not None and self.source.random() < 0.5:
            return {"cancel": True, "telemetry": row.requests}
        return {"cancel": True, "telecommand": started["telecommand"]}


def requests(icd: Icd, source: random.Random) -> Iterator[dict]:
    """Yield scripts of all nodes with framing, without end."""
    forms = [
        (node.name, link_of(icd, facts.of(icd, node)), form)
        for node in icd.nodes
        if icd.protocol_of(node)
        and (form := facts.of(icd, node).stream)
        and (form.telecommands or form.request)
    ]
    # The nodes whose telecommands have responses come first more often.
    weights = [1 + 9 * min(2, len(form.exchanges)) for _, _, form in forms]
    while forms:
        ((name, link, form),) = source.choices(forms, weights)
        keys = source.sample(sorted(TIMES), source.randrange(len(TIMES) + 1))
        yield {
            "op": "stream_client",
            "node": name,
            "requests": source.choice((1, 2, 3, 3)),
            "settings": {key: source.choice(TIMES[key]) for key in keys},
            "script": list(
                Script(link, form, source).rows(source.choice((4, 10, 30, 80)))
            ),
        }


def cases(icd: Icd, seed: int, count: int) -> list[tuple[dict, dict]]:
    """Return requests and the answers of the reference implementation."""
    chosen_requests = islice(requests(icd, random.Random(seed)), count)
    return [(request, reference.answer(icd, request)) for request in chosen_requests]


def differences(
    testee: Testee, expected_answers: list[tuple[dict, dict]]
) -> Iterator[str]:
    """Yield each script that a language answers differently, and the first
    difference.
    """
    lines = [json.dumps(request).encode() for request, _ in expected_answers]
    for (request, expected), line in zip(
        expected_answers, testee.ask(lines), strict=True
    ):
        what = difference(expected, line)
        if what:
            yield f"{_first_step(expected, line) or what}\n  in {json.dumps(request)}"


def _first_step(expected: dict, line: bytes | None) -> str | None:
    """Return the first step of two answers that differs, with both; None if the
    difference is elsewhere.
    """
    steps = json.loads(line or b"{}").get("steps", [])
    for number, (want, got) in enumerate(zip(expected["steps"], steps, strict=False)):
        if want != got:
            return f"step {number}: {json.dumps(got)}\n  expected {json.dumps(want)}"
    return None


def main(arguments: list[str] | None = None) -> int:
    languages = {
        name: language
        for name, language in all_languages().items()
        if language.kind != SELFTEST
    }
    parser = argparse.ArgumentParser(
        prog="python -m tests.conformance.outcomes",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--lang",
        default="c,python,rust",
        help=f"comma-separated, of {', '.join(languages)} (default: %(default)s)",
    )
    parser.add_argument("--scripts", type=int, default=1000, help="number of scripts")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--show", type=int, default=2, help="number of differences")
    parser.add_argument(
        "icds", nargs="*", type=Path, help="ICDs (default: the framed links)"
    )
    options = parser.parse_args(arguments)
    icd = icd_of(options.icds or EXAMPLES)
    scripts = cases(icd, options.seed, options.scripts)
    failed = False
    for language in selected_languages(parser, options.lang, languages):
        try:
            testee = Testee(build(language, icd))
        except BuildError as error:
            print(error, file=sys.stderr)
            return 2
        different = list(differences(testee, scripts))
        failed = bool(testee.close()) or bool(different) or failed
        print(f"{language.name}: {len(scripts)} scripts, {len(different)} differ")
        print(*different[: options.show], testee.complaint(), sep="\n")
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
