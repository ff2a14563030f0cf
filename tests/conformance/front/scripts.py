"""Answer requests that are scripts: timed events of the client and of procedures."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from icdgen.runtime_objects.refusals import Refusal
from icdgen.runtime_objects.request_keys import (
    flag,
    hex_bytes,
    mappings,
    number,
    octets,
    text,
)
from tests.conformance.front.program import Facts, Reply, items
from tests.conformance.front.wire import (
    MOST,
    Answer,
    LinkProgram,
    Request,
    event,
    typed,
)

BUSES = ("uart", "i2c", "can")
MOST_TIMES = 1 << 20
# Values of an event without further information.
ABSENT = {"refused": {"code": None, "parameter": None}}
WITHOUT_CODE = {"refused": {"code": None}, "busy": {"code": None}}  # on framed links


def client(to: LinkProgram, request: Request) -> Answer:
    bus, checked, address = (
        _bus(request),
        flag(request, "crc"),
        number(request, "address", 0, 255, 0),
    )
    settings = _settings(request, BUS_SETTINGS)
    start = ("client", bus, int(checked), address, *settings)
    try:
        words = [
            word
            for row in mappings(request, "script")
            for word in (number(row, "at"), *_row(bus, row))
        ]
    except Refusal:
        # A bus that the ICD does not describe is refused before its script is read.
        to.ask(*start)
        raise
    reply = to.ask(*start, *words)
    return {
        "steps": [
            _client_step(step, rows, to.link["framing"]) for step, rows in _steps(reply)
        ]
    }


BUS_SETTINGS = {
    "reply_timeout": (1, MOST),
    "retries": (0, 255),
    "poll_interval": (1, MOST),
    "poll_timeout": (1, MOST),
    "late": (1, MOST),
}
STREAM_SETTINGS = {
    "reply_timeout": (1, MOST),
    "retries": (0, 255),
    "late": (1, MOST),
    "busy_pause": (1, MOST),
    "gap": (0, MOST),
    "in_flight": (1, 8),
    "progress_for": (1, MOST),
}


def _settings(request: Request, limits: dict[str, tuple[int, int]]) -> list[object]:
    """Return the settings of the request. The link defines the remaining ones."""
    settings = request.get("settings", {})
    if not isinstance(settings, dict):
        raise Refusal("request", detail="`settings` is no object")
    return [
        number(settings, key, *limit) if key in settings else ""
        for key, limit in limits.items()
    ]


def _row(bus: str, row: Request) -> tuple[object, ...]:
    if "telecommand" in row:
        return (
            "telecommand",
            number(row, "telecommand", 0, 255),
            int(flag(row, "repeat")),
            octets(row).hex(),
        )
    if "telemetry" in row:
        return "telemetry", number(row, "telemetry", 0, 255)
    if "receive" in row:
        return _received(bus, row["receive"])
    return ("cancel",) if flag(row, "cancel") else ("tick",)


def _received(bus: str, received: object) -> tuple[object, ...]:
    if bus == "can":
        if not isinstance(received, dict):
            raise Refusal("request", detail="`receive` is no packet")
        return (
            "packet",
            number(received, "id", 0, (1 << 29) - 1),
            octets(received).hex(),
        )
    if bus == "i2c":
        return (
            ("failed",)
            if received is None
            else ("transferred", hex_bytes(received).hex())
        )
    return "received", hex_bytes(received).hex()


def _client_step(
    step: Facts, rows: list[tuple[str, Facts]], framing: list[int] | None
) -> Answer:
    answer: Answer = {"deadline": None, **typed(step), "out": [], "events": []}
    stream = b""
    for kind, row in rows:
        if kind == "stream":
            stream += bytes.fromhex(row["bytes"])
        elif kind in ("frame", "transfer"):
            answer["out"].append(typed(row))
        elif kind in ("until", "error"):
            answer |= typed(row)
        else:
            answer["events"].append(ABSENT.get(kind, {}) | event(kind, row))
    if framing:
        answer["out"] += _messages(stream, *framing)
    return answer


def _messages(stream: bytes, escape: int, end: int) -> Iterator[str]:
    """Return the messages sent on a UART, which carries nothing but messages."""
    start, escaped = 0, False
    for at, byte in enumerate(stream):
        if escaped and byte == end:
            yield stream[start : at + 1].hex()
            start = at + 1
        escaped = byte == escape and not escaped
    if start < len(stream):
        yield stream[start:].hex()


def stream_client(to: LinkProgram, request: Request) -> Answer:
    requests = number(request, "requests", 1, 3, 1)
    settings = _settings(request, STREAM_SETTINGS)
    words = [word for row in mappings(request, "script") for word in _stream_row(row)]
    reply = to.ask("stream_client", requests, *settings, *words)
    steps = []
    for _step, rows in _steps(reply):
        answer: Answer = {"deadline": None, "out": [], "events": []}
        for kind, row in rows:
            if kind == "stream":
                answer["out"].append(row["bytes"])
            elif kind in ("until", "error"):
                answer |= typed(row)
            else:
                answer["events"].append(WITHOUT_CODE.get(kind, {}) | event(kind, row))
        steps.append(answer)
    return {"steps": steps}


def _stream_row(row: Request) -> tuple[object, ...]:
    start = (number(row, "at"), int(not flag(row, "untaken")))
    kind = next((kind for kind in ("telecommand", "telemetry") if kind in row), None)
    if flag(row, "cancel"):
        return (
            (*start, "cancel", kind, number(row, kind))
            if kind
            else (*start, "cancel", "all")
        )
    if kind == "telecommand":
        reply = (1, number(row, "reply")) if "reply" in row else (0, "")
        return (
            *start,
            kind,
            number(row, kind),
            int(flag(row, "repeat")),
            *reply,
            octets(row).hex(),
        )
    if kind:
        return *start, kind, number(row, kind)
    return (
        (*start, "received", hex_bytes(row["receive"]).hex())
        if "receive" in row
        else (*start, "tick")
    )


def _step_of_procedure(step: Facts) -> Answer:
    answer = {"deadline": None, "result": None, **typed(step)}
    request_facts: Answer = {
        key: answer.pop(key)
        for key in ("telecommand", "telemetry", "bytes", "repeat")
        if key in answer
    }
    if "repeat" in request_facts:
        request_facts["repeat"] = bool(request_facts["repeat"])
    return {**answer, "request": request_facts or None}


def procedure(to: LinkProgram, request: Request) -> Answer:
    name, inputs = text(request, "name"), request.get("inputs", {})
    bus = _bus(request) if "bus" in request else BUSES[0]
    block = number(request, "block", 1) if "block" in request else ""
    data = b""
    if "bytes" in request:
        data = octets(request) * number(request, "times", 1, MOST_TIMES, 1)
    forms = to.link["procedures"]
    index = next((n for n, form in enumerate(forms) if form["name"] == name), None)
    if index is None:
        raise Refusal("unsupported")
    form = forms[index]
    names = {each["name"] for each in form["inputs"]}
    if not isinstance(inputs, dict) or inputs.keys() - names:
        raise Refusal("request", detail="`inputs` has no numbers of the procedure")
    numbers = [
        (
            ""
            if each["is_optional"] and each["name"] not in inputs
            else number(inputs, each["name"])
        )
        for each in form["inputs"]
    ]
    words = [
        word
        for row in mappings(request, "script")
        for word in (number(row, "at"), *_procedure_event(row.get("event")))
    ]
    start = (index, bus, block, data.hex(), len(numbers), *numbers)
    reply = to.ask("procedure", *start, *words)
    facts = dict(reply.facts)
    values = items(facts.pop("outputs", ""))
    answer: Answer = {
        "steps": [_step_of_procedure(step) for step in reply.rows_of("step")],
        **typed(facts),
    }
    if form["receives"]:
        answer["blocks"] = [typed(row) for row in reply.rows_of("block")]
    if form["lists"]:
        answer["entries"] = [row["bytes"] for row in reply.rows_of("entry")]
    if form["outputs"]:
        values = values or [""] * len(form["outputs"])
        answer["outputs"] = {
            name: int(value) if value else None
            for name, value in zip(form["outputs"], values, strict=True)
        }
    return answer


def _procedure_event(event: object) -> tuple[object, ...]:
    if event is None:
        return ("nothing",)
    if not isinstance(event, dict):
        raise Refusal("request", detail="`event` is no object")
    name = text(event, "event")
    if name == "done":
        return name, octets(event).hex()
    if name == "arrived":
        return name, number(event, "id"), octets(event).hex()
    if name in ("sent", "busy", "refused", "damaged", "timeout"):
        return (name,)
    raise Refusal("request", detail="there is no such event")


def _bus(request: Request) -> str:
    bus = text(request, "bus")
    if bus not in BUSES:
        raise Refusal("request", detail="there is no such bus")
    return bus


def _steps(reply: Reply) -> list[tuple[Facts, list[tuple[str, Facts]]]]:
    """Return the facts of each step and the rows that follow it."""
    steps: list[tuple[Facts, list[tuple[str, Facts]]]] = []
    for kind, row in reply.rows:
        if kind == "step":
            steps.append((row, []))
        else:
            steps[-1][1].append((kind, row))
    return steps


OPS: dict[str, Callable[[LinkProgram, Request], Answer]] = {
    "client": client,
    "stream_client": stream_client,
    "procedure": procedure,
}
