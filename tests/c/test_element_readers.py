"""C programs can read structs of a variable-length array one by one from a frame.

This is for programs whose memory is too small for the complete message.
"""

from __future__ import annotations

import subprocess

from tests.c import harness

ICD = """\
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

USER = """\
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


def test_structs_are_read_one_by_one_from_a_frame_whose_message_is_too_large(
    tmp_path,
):
    (tmp_path / "demo.yaml").write_text(ICD, encoding="utf-8")
    folder = harness.generate(
        harness.read_unchecked(tmp_path / "demo.yaml"), tmp_path / "c"
    )
    source = folder / "user.c"
    source.write_text(USER)
    options = (*harness.WARNINGS, *harness.SANITIZERS, f"-I{folder}")
    program = harness.compile(source, "-std=c99", *options, output=folder / "user")
    done = subprocess.run([program], capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (0, f"{5 * 16} {4 * 256}"), done.stderr[
        :2000
    ]
