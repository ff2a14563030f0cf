"""The protocol section of a checked ICD -> `Facts`."""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.icd.model import CAN_DATA_BYTES, CAN_PACKETS, Icd, Message, Node
from icdgen.protocol.facts import (
    Acknowledge,
    Assumption,
    Can,
    CanPart,
    Checksum,
    Client,
    Crc,
    Direction,
    Extended,
    Facts,
    Files,
    Framing,
    HoleMap,
    Index,
    IndexField,
    LogBit,
    LogFile,
    LogMask,
    LogMessage,
    Operation,
    Polled,
    Step,
    TimePart,
)

BUSES = ("uart", "i2c", "can")


class Reader:
    """Reads the facts of one node."""

    def __init__(self, icd: Icd, node: Node) -> None:
        self.icd, self.node = icd, node
        self.protocol = icd.protocol_of(node)
        messages = icd.messages_of(node)
        self.messages = {m.name: m for m in messages}
        self.telecommands = {m.telecommand_id: m for m in messages if m.telecommand_id is not None}
        self.telemetry = {m.telemetry_id: m for m in messages if m.telemetry_id is not None}

    def facts(self) -> Facts:
        boot = self.section("boot").get("bootloader_s")
        return Facts(
            node=self.node,
            little=self.node.byte_order == "little",
            telecommand_ids=self.direction("telecommand"),
            telemetry_ids=self.direction("telemetry"),
            telecommands=self.telecommands,
            telemetry=self.telemetry,
            client=self.client(),
            framing=self.framing(),
            acknowledge=self.acknowledge(),
            polled=self.polled(),
            i2c_address=self.i2c_address(),
            can=self.can(),
            errors={key: code for key, code in self.section("errors").items() if isinstance(code, int)},
            checksum=self.checksum(),
            crc16=crc(self.section("crc16")),
            mask=self.mask(),
            log_file=self.log_file(),
            log_message=self.log_message(),
            time=self.time(),
            index=self.index(),
            hole_map=self.hole_map(),
            files=self.files(),
            program_copy=self.operation("program_copy"),
            program_information=self.operation("program_information"),
            identification=self.step(self.section("identification")),
            statistics=self.step(self.section("statistics")),
            boot_ms=None if boot is None else boot * 1000,
            assumptions=tuple(self.assumptions()),
        )

    def section(self, *path: str) -> dict:
        """A section, empty if there is none."""
        found: object = self.protocol
        for key in path:
            found = found.get(key) if isinstance(found, dict) else None
        return found if isinstance(found, dict) else {}

    def direction(self, name: str) -> Direction:
        ids = self.section("message_id", name)
        known = self.telecommands if name == "telecommand" else self.telemetry
        return Direction(ids.get("first", min(known, default=0)), ids.get("last", max(known, default=255)))

    def client(self) -> Client:
        given, default = self.section("client"), Client()
        return Client(
            given.get("reply_timeout_ms", default.reply_timeout),
            given.get("retries", default.retries),
            given.get("poll_interval_ms", default.poll_interval),
            given.get("poll_timeout_ms", default.poll_timeout),
        )

    def framing(self) -> Framing | None:
        given = self.section("uart", "framing")
        if not given:
            return None
        return Framing(
            escape=given["escape"],
            start=given["start_of_message"],
            end=given["end_of_message"],
            escaped=given["escaped_data"],
            escapes_id="id" in given.get("escaped_in", ("id", "data")),
            ignores_other=given.get("other") == "ignore",
        )

    def acknowledge(self) -> Acknowledge | None:
        rows = self.section("uart", "acknowledge").get("data")
        if not rows:
            return None
        at = by_role(rows)
        if not {"id", "error"} <= set(at):
            return None
        return Acknowledge(end(rows), at["id"]["byte"], at["error"]["byte"])

    def polled(self) -> Polled | None:
        given = self.section("i2c", "acknowledge")
        message = self.messages.get(given.get("message", ""))
        names = [given.get(key) for key in ("id", "until", "error", "parameter")]
        return Polled(message, *names) if message and all(names) else None  # type: ignore[arg-type]

    def i2c_address(self) -> int | None:
        """Of 7 bits; the 8-bit form has the direction behind it."""
        given = self.section("i2c", "write")
        eight = given.get("address_8bit")
        return given.get("address_7bit", None if eight is None else eight >> 1)

    def can(self) -> Can | None:
        given = self.section("can")
        if not {"identifier", "message_types", "telecommand", "telemetry", "node_address"} <= set(given):
            return None
        parts, shift = {}, sum(part["bits"] for part in given["identifier"])
        for part in given["identifier"]:
            shift -= part["bits"]
            parts[part.get("role", part["name"])] = CanPart(part["bits"], shift)
        numbers = {row["name"]: row["value"] for row in given["message_types"]["values"]}
        telecommand, telemetry = given["telecommand"], given["telemetry"]
        named = {
            "telecommand": telecommand.get("request"),
            "acknowledge": telecommand.get("acknowledge"),
            "refusal": telecommand.get("failure"),
            "request": telemetry.get("request"),
            "reply": telemetry.get("response"),
            "request_refusal": telemetry.get("failure"),
        }
        extended_named = {
            "telecommand": telecommand.get("extended_request"),
            "reply": telemetry.get("extended_response"),
        }
        return Can(
            parts=parts,
            node_address=given["node_address"],
            data_bytes=given.get("max_data_bytes", CAN_DATA_BYTES),
            types={kind: numbers[name] for kind, name in named.items() if name is not None},
            extended_types={kind: numbers[name] for kind, name in extended_named.items() if name is not None},
            extended=extended(self.section("can", "extended")),
        )

    def checksum(self) -> Checksum | None:
        given = self.section("crc8")
        found = crc(given)
        if found is None:
            return None
        telecommand, telemetry = given.get("telecommand", {}), given.get("telemetry", {})
        return Checksum(
            found,
            given.get("covers_id", False),
            tuple(telecommand.get("buses", BUSES)) if telecommand else (),
            tuple(telemetry.get("buses", BUSES)) if telemetry else (),
            telecommand.get("extra_bytes", telemetry.get("extra_bytes", 1)),
        )

    def mask(self) -> LogMask | None:
        given = self.section("log_mask")
        if not given:
            return None
        slot, bits = given["frame_bytes"], {}
        for node in (*self.icd.included(self.node), self.node):
            for row in node.loggable:
                frame = self.telemetry.get(row.id)
                length = min(frame.length, slot) if frame else slot
                bits[row.bit] = LogBit(row.bit, row.id, length, frame.name if frame else row.name or None)
        return LogMask(given["bytes"], given.get("bit_order") == "msb0", slot, given.get("fill", 0), bits)

    def log_file(self) -> LogFile | None:
        given = self.section("telemetry_log")
        if not given or not self.section("log_mask"):
            return None
        header, entry = by_role(given["header"]), by_role(given["entry"])
        if "mask" not in header or not {"seconds", "milliseconds"} <= set(entry):
            return None
        seconds, milliseconds = ((entry[role]["byte"], entry[role]["bytes"]) for role in ("seconds", "milliseconds"))
        kind = given.get("file_type", {}).get("value")
        return LogFile(header["mask"]["byte"], end(given["header"]), seconds, milliseconds, given["frames_byte"], kind)

    def log_message(self) -> LogMessage | None:
        given = self.section("unsolicited_log")
        if not given or not self.section("log_mask"):
            return None
        rows = by_role(given["message"])
        return LogMessage(given["id"], rows["mask"]["byte"], given["frames_byte"]) if "mask" in rows else None

    def time(self) -> dict[str, TimePart]:
        return {
            part["name"]: TimePart(part["at"], part["bits"], part.get("factor", 1), part.get("offset", 0))
            for part in self.section("msdos_time").get("parts", ())
        }

    def index(self) -> Index | None:
        given = self.section("index_file")
        if not given:
            return None
        fields = {role: IndexField(row["byte"], row["bytes"]) for role, row in by_role(given["entry"]).items()}
        return Index(given["entry_bytes"], fields, given.get("file_type", {}).get("value"))

    def hole_map(self) -> HoleMap | None:
        given = self.section("file_transfer", "hole_map")
        names = given.get("names", ())
        if not names or "field" not in given:
            return None
        return HoleMap(
            given["bytes"],
            given.get("message_bytes", given["bytes"] // len(names)),
            given.get("bit_order") == "msb0",
            given.get("received", 1),
            given.get("beyond_end", given.get("received", 1)),
            tuple(self.messages[name] for name in names),
            given["field"],
        )

    def files(self) -> Files | None:
        given = self.section("file_transfer")
        if not {"packet_bytes", "packet_counter_bytes", "block_packets", "block_bytes"} <= set(given):
            return None
        steps, numbers, packet_ids = {}, {}, {}
        for part in ("list", "download", "upload", "erase", "format"):
            section = self.section("file_transfer", part)
            if self.node.name not in section.get("nodes", [self.node.name]):
                continue
            for key, value in section.items():
                if isinstance(value, int):
                    numbers[f"{part}.{key}"] = int(value)
                elif isinstance(value, dict) and "message" in value:
                    step = self.step(value)
                    if step:
                        steps[f"{part}.{key}"] = step
        for bus in BUSES:
            message = self.messages.get(self.section("file_transfer", "download", bus).get("id_of", ""))
            if message:
                packet_ids[bus] = message.ids[0]
        return Files(
            given["packet_bytes"],
            given["packet_counter_bytes"],
            given.get("first_packet", 0),
            given.get("fill", 0),
            given["block_packets"],
            given["block_bytes"],
            steps,
            numbers,
            packet_ids,
            tuple(self.section("file_transfer", "upload").get("destinations", ())),
        )

    def operation(self, name: str) -> Operation | None:
        given = self.section(name)
        request, progress = self.step(given.get("request", {})), self.step(given.get("progress", {}))
        if request is None or progress is None:
            return None
        programs = tuple(given.get("programs", ()))
        return Operation(request, progress, given["poll_interval_ms"], given["timeout_s"] * 1000, programs)

    def step(self, given: dict) -> Step | None:
        message = self.messages.get(given.get("message", ""))
        return Step(message, dict(given.get("fields", {}))) if message else None

    def assumptions(self) -> Iterator[Assumption]:
        yield from assumed(self.protocol, ())
        for message in self.messages.values():
            for key, why in message.assumptions:
                yield Assumption(f"message {message.name}", key, held(message, key), why)


def held(message: Message, key: str) -> object:
    """What the ICD holds under a key of a message."""
    if key == "acknowledge":
        return "reset" if message.expects_reset else message.acknowledge
    return getattr(message, key, None)


def assumed(section: dict, path: tuple[str, ...]) -> Iterator[Assumption]:
    """The assumptions of a section and of those in it."""
    for key, why in section.get("assumptions", {}).items():
        yield Assumption(".".join(path), key, section.get(key), why)
    for key, value in section.items():
        if isinstance(value, dict) and key != "assumptions":
            yield from assumed(value, (*path, key))


def by_role(rows: list[dict]) -> dict[str, dict]:
    return {row["role"]: row for row in rows if "role" in row}


def end(rows: list[dict]) -> int:
    """Where a layout ends."""
    return max(row["byte"] + row["bytes"] for row in rows)


def crc(given: dict) -> Crc | None:
    if not given:
        return None
    keys = ("width", "polynomial", "init", "reflect_in", "reflect_out", "xor_out", "empty")
    return Crc(**{key: given[key] for key in keys if key in given})


def extended(given: dict) -> Extended | None:
    if not given:
        return None
    size, packets = given["data_bytes"], given.get("max_packets", CAN_PACKETS)
    return Extended(
        size,
        given["packets_left_byte"],
        given.get("packets_left_in_last", 0),
        packets,
        given.get("max_bytes", size * packets),
        given.get("fill", 0),
        given.get("packet_timeout_ms", 1000),
    )
