"""What survives a restart of the simulated device: files and uploaded programs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

from icdgen.protocol import crc
from icdgen.protocol.facts import Crc, Facts
from icdgen.protocol.files import IndexEntry, index_encode

LARGEST = 1 << 24  # bytes of a program: no offset makes us run out of memory

_MIRRORED = bytes(int(f"{byte:08b}"[::-1], 2) for byte in range(256))


@dataclass
class File:
    """A file; ``time`` is packed."""

    data: bytes
    time: int = 0


@dataclass
class Storage:
    """Files by type and counter, programs by destination. ``on_upload`` is told of every committed block."""

    files: dict[tuple[int, int], File] = field(default_factory=dict)
    programs: dict[int, bytearray] = field(default_factory=dict)
    on_upload: Callable[[int, bytes], None] | None = None

    def read(self, known: Facts, type_: int, counter: int) -> bytes | None:
        """The content of a file, or of the index file; None if there is none."""
        if known.index and type_ == known.index.file_type:
            return index_encode(known, [self._entry(known, key) for key in self.files])
        found = self.files.get((type_, counter))
        return found.data if found else None

    def _entry(self, known: Facts, key: tuple[int, int]) -> IndexEntry:
        file = self.files[key]
        size = known.index.fields["meta"].bytes if known.index and "meta" in known.index.fields else 0
        form, mask, meta = known.log_file, known.mask, b""
        if form and mask and key[0] == form.file_type:
            meta = file.data[form.mask_at : form.mask_at + mask.size]
        checksum = checksum_of(known.crc16, file.data)
        return IndexEntry(key[0], key[1], checksum, len(file.data), file.time, meta[:size].ljust(size, b"\0"))

    def put(self, destination: int, data: bytes) -> None:
        """Stores a whole program."""
        self.programs[destination] = bytearray(data)
        if self.on_upload:
            self.on_upload(destination, data)

    def write(self, destination: int, offset: int, data: bytes, room: int | None = None) -> bool:
        """Commits a block of a program; whether there is room for it."""
        if offset + len(data) > (LARGEST if room is None else min(LARGEST, room)):
            return False
        program = self.programs.setdefault(destination, bytearray())
        program.extend(bytes(max(0, offset - len(program))))
        program[offset : offset + len(data)] = data
        if self.on_upload:
            self.on_upload(destination, bytes(program))
        return True


def checksum_of(form: Crc | None, data: bytes) -> int:
    """The CRC of a file; byte by byte from a table, for files are large."""
    if form is None:
        return 0
    if not data or form.width < 8:
        return crc.compute(form, data)
    table, low, value = crc.table(form), form.width - 8, form.init
    mask = (1 << low) - 1
    for byte in data.translate(_MIRRORED) if form.reflect_in else data:
        value = (value & mask) << 8 ^ table[value >> low ^ byte]
    return crc.compute(replace(form, init=value, empty=None), b"")
