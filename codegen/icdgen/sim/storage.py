"""Files and uploaded programs of the simulated device, which survive a restart."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from icdgen_runtime.wire.crc import crc16
from icdgen_runtime.wire.files import IndexEntry, write_index
from icdgen_runtime.wire.link import Link

LARGEST = 1 << 24  # bytes of a program: a large offset must not exhaust the memory


@dataclass
class File:
    """A file. ``time`` is packed."""

    data: bytes
    time: int = 0


@dataclass
class Storage:
    """Files by type and counter, and programs by destination.

    ``on_upload`` is called for each committed block.
    """

    files: dict[tuple[int, int], File] = field(default_factory=dict)
    programs: dict[int, bytearray] = field(default_factory=dict)
    on_upload: Callable[[int, bytes], None] | None = None

    def read(self, link: Link, type_: int, counter: int) -> bytes | None:
        """Return the content of a file, or of the index file, or None."""
        if link.index_file and type_ == link.index_file.file_type:
            return write_index(link, [self._entry(link, key) for key in self.files])
        file = self.files.get((type_, counter))
        return file.data if file else None

    def _entry(self, link: Link, key: tuple[int, int]) -> IndexEntry:
        file = self.files[key]
        _, size = (
            link.index_file.fields.get("meta", (0, 0)) if link.index_file else (0, 0)
        )
        form, mask, meta = link.log_file, link.mask, b""
        if form and mask and key[0] == form.file_type:
            meta = file.data[form.mask_at : form.mask_at + mask.size]
        checksum = checksum_of(link, file.data)
        return IndexEntry(
            key[0],
            key[1],
            checksum,
            len(file.data),
            file.time,
            meta[:size].ljust(size, b"\0"),
        )

    def put(self, destination: int, data: bytes) -> None:
        """Store a complete program."""
        self.programs[destination] = bytearray(data)
        if self.on_upload:
            self.on_upload(destination, data)

    def write(
        self, destination: int, offset: int, data: bytes, room: int | None = None
    ) -> bool:
        """Commit a block of a program. Return whether there is room for it."""
        if offset + len(data) > (LARGEST if room is None else min(LARGEST, room)):
            return False
        program = self.programs.setdefault(destination, bytearray())
        program.extend(bytes(max(0, offset - len(program))))
        program[offset : offset + len(data)] = data
        if self.on_upload:
            self.on_upload(destination, bytes(program))
        return True


def checksum_of(link: Link, data: bytes) -> int:
    """Return the CRC of a file or a block, or 0 if the ICD has none."""
    return crc16(link, data) if link.crc16 else 0
