"""Tables about file transfer."""

from __future__ import annotations

from icdgen.backends.c.link.base import BUSES
from icdgen.backends.c.link.facts import FactTables
from icdgen.backends.c.link.rows import or_none, row_of, wrapped
from icdgen.backends.c.text import plain


class FileTables(FactTables):
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
        return self.part("hole_map", one, "file_transfer.hole_map", f"{len(one.messages)}u, {pieces},")

    def files(self) -> str:
        one = self.known.files
        if one is None:
            return "NULL"
        ids = ", ".join(or_none(one.packet_ids.get(bus)) for bus in BUSES)
        return self.part("files", one, "file_transfer", row_of(f"{{{ids}}}", "ids of download packets"))

    def procedure(self, name: str) -> str:
        """A procedure of file transfer."""
        files = self.known.files
        return self.part(name, files and files.procedures.get(name), f"file_transfer.{name}")
