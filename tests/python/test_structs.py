"""Messages with structs convert to dictionaries, JSON, dataclasses and columns.

`tests/every_language/structs.py` tests what all languages have in common.
"""

from __future__ import annotations

import copy
import dataclasses
import math

import pytest

from tests.every_language.structs import STRUCTS
from tests.python import packages

FRAME = bytes(
    (0x32, 0x64, 0x00, 1, 2, 0x12, 0xFE, 0xFF, 3, 4, 0xF0, 0x00, 0x80, 5, 6, 7)
)


@pytest.fixture(scope="module")
def package(tmp_path_factory):
    folder = tmp_path_factory.mktemp("structs")
    path = folder / "structs.yaml"
    path.write_text(STRUCTS.icd, encoding="utf-8")
    return packages.write(packages.read(path), folder, "struct_messages")


@pytest.fixture(scope="module")
def demo(package):
    return package.module("structs")


def test_each_new_message_has_structs_of_its_own(demo):
    view, other_view = demo.View(), demo.View()
    assert view == other_view and view.pairs[0].version == 7
    view.best.azimuth = 3
    view.pairs[0].both[0].quality = 1
    assert (
        other_view.best.azimuth,
        other_view.pairs[0].both[0].quality,
        view.pairs[0].both[1].quality,
    ) == (0, 0, 0)
    assert view != other_view
    assert demo.View(best=demo.Satellite(azimuth_deg=-2.0)).best.azimuth == -4


def test_dictionaries_and_json_nest(demo):
    view = demo.View.from_bytes(FRAME)
    values = view.as_dict()
    assert values["best"]["azimuth"] == 100 and values["pairs"][0]["both"][1][
        "signals"
    ] == (5, 6)
    assert view.as_dict(physical=True)["best"]["azimuth_deg"] == 50.0
    assert (
        demo.View.from_dict(values)
        == demo.View.from_dict(view.as_dict(physical=True))
        == view
    )
    assert demo.View.from_json(view.to_json()) == view
    assert demo.View.from_dict({"best": {"quality": 5}}) == demo.View(
        best=demo.Satellite(quality=5)
    )
    assert demo.Satellite.from_json(view.best.to_json()) == view.best


def test_structs_work_as_dataclasses(demo):
    view = demo.View.from_bytes(FRAME)
    assert dataclasses.asdict(view)["pairs"][0]["both"][0]["signals"] == (3, 4)
    assert dataclasses.replace(view.best, quality=1).quality == 1
    assert copy.deepcopy(view) == view and copy.deepcopy(view).best is not view.best
    assert repr(view.best).startswith(
        "Satellite(system=<System.GALILEO: 2>, quality=3,"
    )


@pytest.mark.parametrize(
    ("change", "message_text"),
    [
        (
            lambda v: setattr(v.best, "quality", 16),
            "best.quality takes integers from 0 to 15, not 16",
        ),
        (
            lambda v: setattr(v.pairs[0].both[1], "signals", (1, 256)),
            "pairs[0].both[1].signals[1] takes integers",
        ),
        (
            lambda v: setattr(v.pairs[0].both[1], "signals", (1,)),
            "pairs[0].both[1].signals takes 2 values",
        ),
        (lambda v: setattr(v, "pairs", ()), "pairs takes 1 values, not ()"),
        (
            lambda v: setattr(v, "best", None),
            "best.system takes members of System or integers from 0 to 15, not None",
        ),
        (lambda v: setattr(v, "pairs", 3), "pairs takes 1 values, not 3"),
    ],
)
def test_a_value_out_of_range_in_a_struct_is_refused_and_named(
    package, demo, change, message_text
):
    view = demo.View.from_bytes(FRAME)
    change(view)
    with pytest.raises(package.module().RangeError) as caught:
        view.to_bytes()
    assert message_text in str(caught.value)


@pytest.mark.parametrize(
    "values",
    [
        {"best": {"nothing": 1}},
        {"pairs": {"both": ()}},
        {"pairs": [{"both": [{}]}]},
        {"best": 3},
        {"pairs": "x"},
    ],
)
def test_values_that_do_not_describe_structs_are_refused(package, demo, values):
    with pytest.raises(package.module().IcdError):
        demo.View.from_dict(values)


def test_each_field_of_a_struct_is_a_column(demo):
    columns = demo.View.decode_many(FRAME * 3, physical=True)
    assert columns["best.azimuth_deg"].tolist() == [50.0] * 3
    assert columns["pairs[0].both[1].signals_v"].tolist() == [[1.25, 1.5]] * 3
    assert "pairs[0].both[0].azimuth_deg" in demo.View.decode_table(FRAME).schema.names


FLOATS = """\
icdgen: 1
node: {name: floats, title: Floats, byte_order: little, bit_order: lsb0}
structs:
  - name: Both
    length: 9
    fields:
      - {at: 0, bits: 32, name: Aligned, type: float}
      - {at: 36, bits: 32, name: Across, type: float}
messages:
  - name: Floats
    id: 1
    kind: telemetry
    length: 18
    byte_order: big
    fields:
      - {at: 0, name: All, struct: Both, count: 2}
"""


def test_nans_in_structs_keep_their_bits(tmp_path):
    (tmp_path / "floats.yaml").write_text(FLOATS, encoding="utf-8")
    floats = (
        packages.write(
            packages.read(tmp_path / "floats.yaml"), tmp_path, "floats_messages"
        )
        .module("floats")
        .Floats
    )
    frame = bytes.fromhex("7f8000010000000000ffa5a5a50000000000")
    message = floats.from_bytes(frame)
    assert all(math.isnan(struct.aligned) for struct in message.all)
    assert message.to_bytes() == frame
