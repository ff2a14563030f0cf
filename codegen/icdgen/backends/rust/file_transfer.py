"""File transfer: the facts of a node -> the part ``files`` of its link."""

from __future__ import annotations

from icdgen.backends.rust.literals import Optional, Part, Rows, Struct, flat
from icdgen.backends.rust.wire_steps import field_of, step
from icdgen.protocol.facts import Facts

TELECOMMAND, TELEMETRY = "telecommand", "telemetry"


def files(known: Facts) -> Struct | None:
    """File transfer, with the procedures that the ICD describes completely."""
    form = known.files
    if form is None:
        return None
    ids = (
        Part(bus, Optional(form.packet_ids.get(bus)), f"file_transfer.download.{bus}") for bus in ("uart", "i2c", "can")
    )
    return Struct(
        "Files",
        (
            Part("packet_bytes", form.packet_bytes),
            Part("counter_bytes", form.counter_bytes),
            Part("first_packet", form.first_packet, "file_transfer.first_packet"),
            Part("fill", form.fill, "file_transfer.fill"),
            Part("block_packets", form.block_packets),
            Part("block_bytes", form.block_bytes),
            Part("packet_ids", Struct("PerBus", tuple(ids))),
            Part("hole_map", Optional(_hole_map(known))),
            Part("list", Optional(_list(known))),
            Part("download", Optional(_download(known))),
            Part("upload", Optional(_upload(known))),
            Part("erase", Optional(_erasure(known, "erase"))),
            Part("format", Optional(_erasure(known, "format"))),
        ),
    )


def _hole_map(known: Facts) -> Struct | None:
    form = known.hole_map
    if form is None:
        return None
    messages = []
    for message in form.messages:
        field = field_of(message, form.field)
        if field is None or message.telecommand_id is None or message.telemetry_id is None:
            return None
        piece = flat("Span", at=field.at // 8, bytes=field.bits // 8)
        messages.append(
            flat(
                "MapMessage",
                set_id=message.telecommand_id,
                get_id=message.telemetry_id,
                length=message.length,
                piece=piece,
            )
        )
    return Struct(
        "HoleMapForm",
        (
            Part("bytes", form.bytes),
            Part("message_bytes", form.message_bytes),
            Part("msb0", form.msb0),
            Part("received", bool(form.received)),
            Part("beyond_end", bool(form.beyond_end), "file_transfer.hole_map.beyond_end"),
            Part("messages", Rows(messages)),
        ),
    )


class _Procedure:
    """Collects the parts of a procedure; without one of them there is none."""

    def __init__(self, known: Facts, name: str) -> None:
        assert known.files
        self.known, self.name, self.files = known, name, known.files
        self.parts: list[Part] = []
        self.whole = True

    def step(self, name: str, direction: str) -> None:
        found = step(self.known, self.files.steps.get(f"{self.name}.{name}"), direction)
        self.whole = self.whole and found is not None
        self.parts.append(Part(name, found, f"file_transfer.{self.name}.{name}"))

    def number(
        self, key: str, name: str = "", factor: int = 1, truth: bool = False, default: int | None = None
    ) -> None:
        found = self.files.numbers.get(f"{self.name}.{key}", default)
        self.whole = self.whole and found is not None
        value = bool(found) if truth else (found or 0) * factor
        self.parts.append(Part(name or key, value, f"file_transfer.{self.name}.{key}"))

    def struct(self, name: str) -> Struct | None:
        return Struct(name, tuple(self.parts)) if self.whole else None


def _list(known: Facts) -> Struct | None:
    found = _Procedure(known, "list")
    found.step("reset", TELECOMMAND)
    found.step("advance", TELECOMMAND)
    found.step("information", TELEMETRY)
    found.number("poll_interval_ms")
    found.number("timeout_ms")
    return found.struct("ListForm")


def _download(known: Facts) -> Struct | None:
    found = _Procedure(known, "download")
    found.step("load", TELECOMMAND)
    found.step("ready", TELEMETRY)
    found.step("burst", TELECOMMAND)
    found.number("message_length")
    found.number("checksum_covers_fill", truth=True, default=0)
    found.number("index_counter", default=0)
    found.number("poll_interval_ms")
    found.number("ready_timeout_ms")
    found.number("silence_ms")
    found.number("rounds")
    return found.struct("DownloadForm")


def _upload(known: Facts) -> Struct | None:
    found = _Procedure(known, "upload")
    found.step("initiate", TELECOMMAND)
    found.step("initiated", TELEMETRY)
    found.step("begin", TELECOMMAND)
    found.step("packet", TELECOMMAND)
    found.step("checksum", TELEMETRY)
    found.step("finalize", TELECOMMAND)
    found.step("finalized", TELEMETRY)
    found.number("block_size")
    found.number("checksum_covers_fill", truth=True, default=0)
    found.number("poll_interval_ms")
    found.number("erase_timeout_s", "erase_timeout_ms", factor=1000)
    found.number("finalize_timeout_ms")
    found.number("rounds")
    limits = known.files
    assert limits
    most = limits.numbers.get("upload.destination_bytes")
    found.parts.append(Part("destination_bytes", Optional(most), "file_transfer.upload.destination_bytes"))
    found.parts.append(Part("destinations", Rows(limits.destinations), "file_transfer.upload.destinations"))
    return found.struct("UploadForm")


def _erasure(known: Facts, name: str) -> Struct | None:
    found = _Procedure(known, name)
    found.step("request", TELECOMMAND)
    found.step("progress", TELEMETRY)
    found.number("poll_interval_ms")
    found.number("timeout_ms")
    return found.struct("ErasureForm")


def operation(known: Facts, name: str) -> Struct | None:
    """What a node does with a stored program."""
    form = known.program_copy if name == "program_copy" else known.program_information
    request = form and step(known, form.request, TELECOMMAND)
    progress = form and step(known, form.progress, TELEMETRY)
    if form is None or request is None or progress is None:
        return None
    return Struct(
        "OperationForm",
        (
            Part("request", request, f"{name}.request"),
            Part("progress", progress, f"{name}.progress"),
            Part("poll_interval_ms", form.poll_interval, f"{name}.poll_interval_ms"),
            Part("timeout_ms", form.timeout, f"{name}.timeout_s"),
            Part("programs", Rows(form.programs), f"{name}.programs"),
        ),
    )
