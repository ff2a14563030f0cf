"""Arrays in C: members that are arrays, and accessors that take the index of an
element.
"""

from __future__ import annotations

import subprocess

import pytest

from tests.c import harness

ICD = """\
icdgen: 1
node: {name: demo, title: Demo, byte_order: little, bit_order: lsb0}
messages:
  - name: Heat
    id: 1
    kind: telemetry
    length: 9
    fields:
      - {at: 0, bits: 16, count: 3, name: Temperatures, type: int, unit: C, formula: raw*0.01}
      - {at: 48, bits: 12, count: 2, name: Levels, type: uint}
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
    const uint8_t frame[9] = {0x64, 0x00, 0xfa, 0x00, 0xd4, 0xfe, 0x01, 0xf0, 0xff};
    uint8_t again[9];
    demo_heat_t heat;
    double value = -1.0;
    int32_t thousandths = -1;
    size_t i;
    CHECK(sizeof heat.temperatures == 3u * sizeof(int16_t));
    CHECK(demo_heat_decode(&heat, frame, sizeof frame) == ICD_OK);
    CHECK(heat.temperatures[0] == 100 && heat.temperatures[1] == 250 && heat.temperatures[2] == -300);
    CHECK(heat.levels[0] == 1u && heat.levels[1] == 4095u);
    CHECK(demo_heat_encode(&heat, again, sizeof again) == ICD_OK && memcmp(frame, again, sizeof frame) == 0);
    CHECK(demo_heat_temperatures_c(&heat, 2u, &value) == ICD_OK && value == -3.0);
    CHECK(demo_heat_temperatures_c(&heat, 3u, &value) == ICD_ERROR_RANGE && value == -3.0);
    CHECK(demo_heat_temperatures_mc(&heat, 1u, &thousandths) == ICD_OK && thousandths == 2500);
    CHECK(demo_heat_temperatures_mc(&heat, (size_t)-1, &thousandths) == ICD_ERROR_RANGE && thousandths == 2500);
    CHECK(demo_heat_set_temperatures_c(&heat, 3u, 1.0) == ICD_ERROR_RANGE);
    CHECK(demo_heat_set_temperatures_mc(&heat, 3u, 1000) == ICD_ERROR_RANGE);
    CHECK(demo_heat_set_temperatures_c(&heat, 0u, 1000.0) == ICD_ERROR_RANGE);
    CHECK(demo_heat_encode(&heat, again, sizeof again) == ICD_OK && memcmp(frame, again, sizeof frame) == 0);
    for (i = 0; i < 3u; i++) {
        CHECK(demo_heat_set_temperatures_c(&heat, i, (double)i) == ICD_OK);
    }
    CHECK(heat.temperatures[0] == 0 && heat.temperatures[1] == 100 && heat.temperatures[2] == 200);
    CHECK(demo_heat_misfit(&heat) == NULL);
    heat.levels[1] = 4096u;
    CHECK(demo_heat_misfit(&heat) != NULL && strcmp(demo_heat_misfit(&heat), "Levels") == 0);
    CHECK(demo_heat_encode(&heat, again, sizeof again) == ICD_ERROR_RANGE);
    return 0;
}
"""


@pytest.mark.parametrize("compiler", ["gcc", "clang", "g++"])
def test_elements_are_members_and_an_index_is_held_to_the_count(compiler, tmp_path):
    (tmp_path / "demo.yaml").write_text(ICD, encoding="utf-8")
    folder = harness.generate(harness.read(tmp_path / "demo.yaml"), tmp_path / "c")
    source = folder / ("user.cpp" if compiler == "g++" else "user.c")
    source.write_text(USER)
    options = [one for one in harness.WARNINGS if one != "-Wfloat-equal"]
    standard = "c++17" if compiler == "g++" else "c99"
    where = f"-I{folder}"
    program = harness.compile(
        source,
        f"-std={standard}",
        *options,
        *harness.SANITIZERS,
        where,
        compiler=compiler,
        output=folder / "user",
    )
    done = subprocess.run([program], capture_output=True, text=True)
    assert done.returncode == 0, (
        f"line {done.returncode} of the program: {done.stderr[:2000]}"
    )
