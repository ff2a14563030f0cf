"""Structs in C: types of their own, which messages hold, with accessors that serve
every message.
"""

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
    size_t count = 0u;
    const icd_field_t *fields = demo_view_fields(&count);
    CHECK(count == 2u && fields[1].at == 40u && fields[1].bits == 88u && fields[1].count == 1u);
    fields = fields[1].fields(&count);
    CHECK(count == 2u && strcmp(fields[1].name, "Version") == 0 && fields[1].at == 80u && fields[1].fields == NULL);
    fields = fields[0].fields(&count);
    CHECK(count == 4u && strcmp(fields[2].unit, "deg") == 0 && fields[3].count == 2u);
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
    CHECK(strcmp(demo_view_misfit(&view), "Pairs[].Both[].Quality") == 0);
    CHECK(demo_view_encode(&view, again, sizeof again) == ICD_ERROR_RANGE);
    demo_view_init(&view);
    CHECK(view.pairs[0].version == DEMO_PAIR_VERSION_CONST && last->quality == 0u);
    demo_pair_init(&view.pairs[0]);
    CHECK(view.pairs[0].version == 7u);
    return 0;
}
"""


OPEN = """\
icdgen: 1
node: {name: demo, title: Demo, byte_order: big, bit_order: lsb0}
structs:
  - name: Peak
    length: 3
    fields:
      - {at: 0, bits: 16, name: Level, type: int}
      - {at: 16, bits: 4, name: Band, type: uint}
messages:
  - name: Counted
    id: 1
    kind: telemetry
    length: 2
    fields:
      - {at: 0, bits: 4, name: Last, type: uint}
      - {at: 8, bits: 8, name: Gain, type: int}
      - {at: 16, name: Peaks, struct: Peak, count: {field: Last, plus: 1}, up_to: 5}
  - name: Not Counted
    id: 2
    kind: telemetry
    length: 0
    fields:
      - {at: 0, name: Peaks, struct: Peak, count: rest, up_to: 4}
"""

WALKER = """\
#include <demo.h>
#include <stdio.h>
#include <stdlib.h>

/* Frames of each length, with room for not a byte more, whose first byte is each that counts. */
#define WALKED(NAME, COUNT) \\
    static unsigned walk_##NAME(size_t length, unsigned first) \\
    { \\
        uint8_t *frame = malloc(length); \\
        demo_##NAME##_t whole; \\
        size_t element = 0u; \\
        size_t count = 0u; \\
        demo_peak_t peak = {77, 7u}; \\
        for (size_t byte = 0u; byte < length; byte++) { \\
            frame[byte] = (uint8_t)(byte == 0u ? first : 29u * byte + length); \\
        } \\
        if (demo_##NAME##_decode(&whole, frame, length) == ICD_OK) { \\
            count = COUNT; \\
        } \\
        for (; demo_##NAME##_peaks_at(&peak, frame, length, element) == ICD_OK; element++) { \\
            if ((peak.level != whole.peaks[element].level) || (peak.band != whole.peaks[element].band)) { \\
                exit(1); \\
            } \\
        } \\
        if ((element != count) || ((element == 0u) && ((peak.level != 77) || (peak.band != 7u)))) { \\
            exit(2); \\
        } \\
        free(frame); \\
        return count != 0u ? 1u : 0u; \\
    }

WALKED(counted, whole.last + 1u)
WALKED(not_counted, whole.peaks_count)

int main(void)
{
    unsigned counted = 0u;
    unsigned not_counted = 0u;
    for (size_t length = 1u; length < 30u; length++) {
        for (unsigned first = 0u; first < 256u; first++) {
            counted += walk_counted(length, first);
            not_counted += walk_not_counted(length, first);
        }
    }
    (void)printf("%u %u", counted, not_counted);
    return 0;
}
"""


def test_structs_of_a_frame_are_read_one_by_one_where_its_message_is_too_large(
    tmp_path,
):
    (tmp_path / "demo.yaml").write_text(OPEN, encoding="utf-8")
    folder = harness.generate(harness.read(tmp_path / "demo.yaml"), tmp_path / "c")
    source = folder / "user.c"
    source.write_text(WALKER)
    options = (*harness.WARNINGS, *harness.SANITIZERS, f"-I{folder}")
    program = harness.compile(source, "-std=c99", *options, output=folder / "user")
    done = subprocess.run([program], capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (0, f"{5 * 16} {4 * 256}"), done.stderr[
        :2000
    ]


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
