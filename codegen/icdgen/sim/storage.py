"""Files, programs and other objects of the simulated device, which survive a restart."""

from __future__ import annotations

from icdgen_runtime.wire.files import IndexEntry, write_index
from icdgen_runtime.wire.link import Link

from icdgen.procedures.effects import Key, Object, Objects
from icdgen.procedures.run import checksum_of
from icdgen.protocol.sections import ChecksumAlgorithm

__all__ = ["DeviceStorage", "Object"]


class DeviceStorage(Objects):
    """Objects of the device, and the index file, which describes the files."""

    def provide_index(
        self, link: Link, kind: str | None, algorithm: ChecksumAlgorithm | None
    ) -> None:
        """Let the device make an index file of all objects of a kind, if the ICD
        describes one. ``algorithm``: that of the checksums in it.
        """
        form = link.index_file

        def index(of: str, key: Key) -> bytes | None:
            if form is None or of != kind or key[:1] != (form.file_type,):
                return None
            entries = [
                _entry(link, algorithm, *each) for each in self.objects_of(of).items()
            ]
            return write_index(link, entries)

        self.computed = index


def _entry(
    link: Link, algorithm: ChecksumAlgorithm | None, key: Key, stored: Object
) -> IndexEntry:
    """Return the entry of a file in the index file."""
    type_, counter, *_ = (*key, 0, 0)
    data, form, mask = bytes(stored.data), link.log_file, link.mask
    _, size = link.index_file.fields.get("meta", (0, 0)) if link.index_file else (0, 0)
    meta = b""
    if form and mask and type_ == form.file_type:
        meta = data[form.mask_at : form.mask_at + mask.size]
    checksum, meta = checksum_of(algorithm, data), meta[:size].ljust(size, b"\0")
    return IndexEntry(type_, counter, checksum, len(data), stored.time, meta)
