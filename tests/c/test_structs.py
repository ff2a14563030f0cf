"""Structs in C: types of their own, which messages hold, with accessors that serve every message."""

from __future__ import annotations

import subprocess

import pytest

from tests.c import harness

ICD = """\
icdgen: 1
node: {name: demo, title: Demo, byte_order: little, bit_order: lsb0}
enums:
  - {name: System, members: [{value: 0, name: GPS}, {value: 2, name: Galileo}]}
structs:
  - name: Satellite
    length: 5
    fields:
      - {at: 0, bits: 4, name: System, type: enum, enum: System}
      - {at: 4, bits: 4, name: Quality, type: uint}
      - {at: 8, bits: 16, name: Azimuth, type: int, unit: deg, formula: raw*0.5}
      - {at: 24, bits: 8, count: 2, name: Signals, type: uint, unit: V, formula: raw*0.25}
  - name: Pair
    length: 11
    fields:
      - {at: 0, name: Both, struct: Satellite, count: 2}
      - {at: 80, bits: 8, name: Version, type: uint, const: 7}
messages:
  - name: View
    id: 1
    kind: telemetry
    length: 16
    fields:
      - {at: 0, name: Best, struct: Satellite}
      - {at: 40, name: Pairs, struct: Pair, count: 1}
"""

USER = """\
#include <demo.h>

#define CHECK(what) \\
    do { \\
        if (!(what)) { \\
            return __LINE__; \\
        } \\
    } while (0)

int main(void)
{
    const uint8_t frame[16] = {0x32, 0x64, 0x00, 1, 2, 0x12, 0xfe, 0xff, 3, 4, 0xf0, 0x00, 0x80, 5, 6, 7};
    uint8_t again[16];
    demo_view_t view;
    demo_satellite_t *last = &view.pairs[0].both[1];
    double value = -1.0;
    CHECK(sizeof view.pairs == sizeof(demo_pair_t) && sizeof view.pairs[0].both == 2u * sizeof(demo_satellite_t));
    CHECK(demo_view_decode(&view, frame, sizeof frame) == ICD_OK);
    CHECK(view.best.system == DEMO_SYSTEM_GALILEO && view.best.quality == 3u && view.best.signals[1] == 2u);
    CHECK(demo_satellite_azimuth_deg(&view.best) == 50.0);
    CHECK(demo_satellite_azimuth_deg(&view.pairs[0].both[0]) == -1.0);
    CHECK(demo_satellite_signals_v(last, 1u, &value) == ICD_OK && value == 1.5);
    CHECK(demo_satellite_signals_v(last, 2u, &value) == ICD_ERROR_RANGE && value == 1.5);
    CHECK(demo_view_encode(&view, again, sizeof again) == ICD_OK && memcmp(frame, again, sizeof frame) == 0);
    CHECK(demo_satellite_set_azimuth_deg(last, 1.0) == ICD_OK && last->azimuth == 2);
    CHECK(demo_satellite_set_azimuth_deg(last, 1e6) == ICD_ERROR_RANGE && last->azimuth == 2);
    last->quality = 16u;
    CHECK(strcmp(demo_view_misfit(&view), "Pairs[0].Both[1].Quality") == 0);
    CHECK(demo_view_encode(&view, again, sizeof again) == ICD_ERROR_RANGE);
    demo_view_init(&view);
    CHECK(view.pairs[0].version == DEMO_PAIR_VERSION_CONST && last->quality == 0u);
    demo_pair_init(&view.pairs[0]);
    CHECK(view.pairs[0].version == 7u);
    return 0;
}
"""


@pytest.mark.parametrize("compiler", ["gcc", "clang", "g++"])
def test_a_struct_is_a_value_of_its_own_wherever_it_stands(compiler, tmp_path):
    (tmp_path / "demo.yaml").write_text(ICD, encoding="utf-8")
    folder = harness.generate(harness.read(tmp_path / "demo.yaml"), tmp_path / "c")
    source = folder / ("user.cpp" if compiler == "g++" else "user.c")
    source.write_text(USER)
    options = [one for one in harness.WARNINGS if one != "-Wfloat-equal"]
    standard = "c++17" if compiler == "g++" else "c99"
    where = f"-I{folder}"
    program = harness.compile(
        source, f"-std={standard}", *options, *harness.SANITIZERS, where, compiler=compiler, output=folder / "user"
    )
    done = subprocess.run([program], capture_output=True, text=True)
    assert done.returncode == 0, f"line {done.returncode} of the program: {done.stderr[:2000]}"
