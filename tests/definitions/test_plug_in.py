"""Another package can add a kind of definition."""

from __future__ import annotations

from icdgen.definitions import kinds, run

MODULE = """
from icdgen.definitions.model import Definitions, Network


class Lines:
    name = "lines"
    title = "a list of lines"
    needs = ()

    def knows(self, start):
        return start.startswith("%lines")

    def read(self, file, data):
        network = Network("lines", "Lines", {"byte_order": "little", "bit_order": "lsb0"})
        for number, name in enumerate(data.decode().split("\\n")[1:]):
            network.messages.append({"name": name, "id": number, "kind": "telemetry", "length": 0})
        return Definitions(file, [network], len(network.messages))
"""


def test_another_package_adds_a_kind_by_an_entry_point(tmp_path, monkeypatch):
    (tmp_path / "their_lines.py").write_text(MODULE)
    dist = tmp_path / "their_lines-1.0.dist-info"
    dist.mkdir()
    (dist / "METADATA").write_text(
        "Metadata-Version: 2.1\nName: their-lines\nVersion: 1.0\n"
    )
    (dist / "entry_points.txt").write_text(
        "[icdgen.definitions]\nlines = their_lines:Lines\n"
    )
    monkeypatch.syspath_prepend(str(tmp_path))
    file = tmp_path / "a.txt"
    file.write_text("%lines\nFirst\n2nd")
    reader = kinds.reader_of_file(file)
    assert reader is not None and reader.name == "lines" and "lines" in kinds.names()
    read = run.read(file, reader)
    assert [message["name"] for message in read.trees["lines"]["messages"]] == [
        "First",
        "2nd",
    ]
    assert read.identifiers == ["message `2nd`: `message 2nd`"]
