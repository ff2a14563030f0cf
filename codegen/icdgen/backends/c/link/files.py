"""Tables about file transfer."""

from __future__ import annotations

from collections.abc import Sequence

from icdgen.backends.c.link.base import BUSES, Tables
from icdgen.backends.c.link.rows import boolean, lines, or_none, row_of, wrapped
from icdgen.backends.c.text import plain
from icdgen.protocol.facts import Files, Operation


class FileTables(Tables):
    """Hole maps, blocks and procedures; each gives the expression that leads to its table."""

    def hole_map(self) -> str:
        one = self.known.hole_map
        if one is None:
            return "NULL"
        rows = []
        for message in one.messages:
            at = next(f.at // 8 for f in message.fields if f.name == one.field)
            ids = f"{or_none(message.telecommand_id)}, {or_none(message.telemetry_id)}"
            rows += wrapped(f"{{{ids}, {message.length}u, {at}u}},", plain(message.name))
        pieces = self.add("hole_maps[]", "icd_hole_map_message_t", rows)
        parts = [
            row_of(f"{one.bytes}u, {one.message_bytes}u", "bytes, and in each message"),
            row_of(boolean(one.msb0), "bit 0 of a byte is the most significant one"),
            row_of(boolean(bool(one.received)), "received"),
            row_of(boolean(bool(one.beyond_end)), "beyond the end"),
            f"{len(one.messages)}u, {pieces},",
        ]
        return self.add("hole_map", "icd_hole_map_form_t", parts, self.section_notes("file_transfer.hole_map"))

    def files(self) -> str:
        one = self.known.files
        if one is None:
            return "NULL"
        ids = ", ".join(or_none(one.packet_ids.get(bus)) for bus in BUSES)
        rows = [
            row_of(f"{one.packet_bytes}u, {one.counter_bytes}u", "bytes of a packet, and of its number"),
            row_of(f"{one.first_packet}u", "number of the first"),
            row_of(f"{one.fill:#04x}u", "fill"),
            row_of(f"{one.block_bytes}u", "bytes of a block"),
            row_of(f"{{{ids}}}", "ids of download packets"),
        ]
        return self.add("files", "icd_files_form_t", rows, self.section_notes("file_transfer"))

    def steps(self, files: Files, part: str, names: Sequence[str], numbers: Sequence[str]) -> list[str] | None:
        """Rows of a procedure's steps and numbers; None if the ICD lacks one."""
        found = [files.steps.get(f"{part}.{name}") for name in names]
        if not all(found) or any(f"{part}.{key}" not in files.numbers for key in numbers):
            return None
        rows = [
            row_of(self.step(f"{part}.{name}", step), plain(step.message.name))
            for name, step in zip(names, found, strict=True)
            if step
        ]
        return [*rows, *(row_of(f"{files.numbers[f'{part}.{key}']}u", key) for key in numbers)]

    def procedure(self, files: Files, part: str, type: str, names: str, numbers: str, *more: str) -> str:
        rows = self.steps(files, part, names.split(), numbers.split())
        if rows is None:
            return "NULL"
        return self.add(part, type, [*rows, *more], self.section_notes(f"file_transfer.{part}"))

    def list(self, files: Files) -> str:
        return self.procedure(
            files, "list", "icd_list_form_t", "reset advance information", "poll_interval_ms timeout_ms"
        )

    def download(self, files: Files) -> str:
        covers = boolean(bool(files.numbers.get("download.checksum_covers_fill")))
        return self.procedure(
            files, "download", "icd_download_form_t", "load ready burst",
            "message_length poll_interval_ms ready_timeout_ms silence_ms rounds",
            row_of(covers, "the checksum covers the fill"),
        )  # fmt: skip

    def upload(self, files: Files) -> str:
        names = "initiate initiated begin packet checksum finalize finalized"
        keys = ("block_size", "poll_interval_ms", "erase_timeout_s", "finalize_timeout_ms", "rounds")
        numbers = [files.numbers.get(f"upload.{key}") for key in keys]
        rows = None if None in numbers else self.steps(files, "upload", names.split(), ())
        if rows is None:
            return "NULL"
        numbers[2] = (numbers[2] or 0) * 1000
        rest = [row_of(f"{n}u", key.replace("timeout_s", "timeout_ms")) for n, key in zip(numbers, keys, strict=True)]
        rest.append(
            row_of(boolean(bool(files.numbers.get("upload.checksum_covers_fill"))), "the checksum covers the fill")
        )
        rest.append(row_of(f"{files.numbers.get('upload.destination_bytes', 0)}u", "bytes of a destination"))
        rest.append(self.allowed("destinations", files.destinations))
        return self.add("upload", "icd_upload_form_t", [*rows, *rest], self.section_notes("file_transfer.upload"))

    def allowed(self, name: str, numbers: Sequence[int]) -> str:
        """The numbers that can be chosen, and how many they are."""
        if not numbers:
            return row_of("NULL, 0u", name)
        table = self.add(f"{name}[]", "uint8_t", lines([f"{number}u," for number in numbers]))
        return row_of(f"{table}, {len(numbers)}u", name)

    def operation(self, name: str, one: Operation | None) -> str:
        """What a node does with a stored program."""
        if one is None:
            return "NULL"
        rows = [
            row_of(self.step(f"{name}.request", one.request), plain(one.request.message.name)),
            row_of(self.step(f"{name}.progress", one.progress), plain(one.progress.message.name)),
            row_of(f"{one.poll_interval}u, {one.timeout}u", "poll_interval_ms, timeout_ms"),
            self.allowed(f"{name}_programs", one.programs),
        ]
        return self.add(name, "icd_operation_form_t", rows, self.section_notes(name))

    def erase(self, files: Files, part: str) -> str:
        return self.procedure(files, part, "icd_erase_form_t", "request progress", "poll_interval_ms timeout_ms")
