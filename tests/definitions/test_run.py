"""Files of definitions become ICDs with names of their own, or one error."""

from __future__ import annotations

import pytest

from icdgen.definitions import run
from icdgen.definitions.model import Definitions, Network
from icdgen.diagnostics import Findings

LONGEST = 65535  # bytes of a message


class Lengths:
    """Reader of messages ``name: length``, one per line; an empty line begins the
    next network.
    """

    name, title, needs = "lengths", "a list of lengths", ()

    def knows(self, start):
        return True

    def read(self, file, data):
        networks = []
        for part in data.decode().split("\n\n"):
            network = Network(
                "device", "Device", {"byte_order": "little", "bit_order": "lsb0"}
            )
            for id, row in enumerate(part.split("\n")):
                name, length = row.split(": ")
                message = {"name": name, "id": id, "kind": "telemetry"}
                lengths = {"length": int(length), "reserved": int(length)}
                network.messages.append(message | lengths)
            networks.append(network)
        count = sum(len(network.messages) for network in networks)
        return Definitions(file, networks, count)


def write(folder, *texts):
    files = [folder / f"{number}.txt" for number, _ in enumerate(texts)]
    for file, text in zip(files, texts, strict=True):
        file.write_text(text)
    return files


def names(read):
    return {
        name: [message["name"] for message in tree["messages"]]
        for name, tree in read.trees.items()
    }


def test_a_definition_without_a_usable_message_is_an_error_with_the_first_reason(
    tmp_path,
):
    (file,) = write(tmp_path, f"Large: {LONGEST + 1}\nLarger: {LONGEST + 2}")
    with pytest.raises(Findings) as raised:
        run.read(file, Lengths())
    (finding,) = raised.value.findings
    assert (finding.code, finding.place.file) == ("IMP005", str(file))
    assert finding.message == (
        "no message can be imported: message `Large` is not imported: "
        "`length` must be at most 65535, not 65536 (ICD010)"
    )


def test_a_network_without_a_usable_message_gives_no_icd(tmp_path):
    (file,) = write(tmp_path, f"Large: {LONGEST + 1}\n\nUsable: {LONGEST}")
    read = run.read(file, Lengths())
    assert names(read) == {"device_2": ["Usable"]}
    assert (read.imported, read.failed) == (1, True)


def test_icds_of_several_files_have_different_names(tmp_path):
    files = write(tmp_path, "A: 1\n\nB: 1", "C: 1", f"Large: {LONGEST + 1}")
    reads = run.read_set([(file, Lengths()) for file in files])
    assert [names(read) for read in reads] == [
        {"device": ["A"], "device_2": ["B"]},
        {"device_3": ["C"]},
        {},
    ]
    assert [read.failed for read in reads] == [False, False, True]


class Named(Lengths):
    """Reader of networks ``name``, one per line, each with a message of that name."""

    def read(self, file, data):
        head = {"byte_order": "little", "bit_order": "lsb0"}
        networks = []
        for name in data.decode().split():
            message = {"name": name, "id": 1, "kind": "telemetry"}
            messages = [message | {"length": 1, "reserved": 1}]
            networks.append(Network(name, name, dict(head), messages))
        return Definitions(file, networks, len(networks))


@pytest.mark.parametrize(
    ("networks", "icds"),
    [
        ("can can can", "can can_2 can_3"),
        ("can can can_2 can", "can can_3 can_2 can_4"),
        ("can_2 can can", "can_2 can can_3"),
        ("can can_2 can", "can can_2 can_3"),
        (
            " ".join([f"{'a' * 36}{end}" for end in ("xxxx", "xxxx", "yyyy", "yyyy")]),
            f"{'a' * 36}xxxx {'a' * 36}_2 {'a' * 36}yyyy {'a' * 36}_3",
        ),
    ],
)
@pytest.mark.parametrize("is_one_file", [True, False])
def test_a_numbered_name_is_not_that_of_another_network(
    networks, icds, is_one_file, tmp_path
):
    texts = [networks] if is_one_file else networks.split()
    reads = run.read_set([(file, Named()) for file in write(tmp_path, *texts)])
    imported = [pair for read in reads for pair in names(read).items()]
    expected = zip(icds.split(), networks.split(), strict=True)
    assert imported == [(icd, [network]) for icd, network in expected]
