"""Count the instructions per call of the generated C decoders and encoders and of
hand-written shift-and-mask code.

Usage::

    python bench/c_instructions.py [--cc gcc] [--opt=-O2] [--check]

The counts come from valgrind --tool=callgrind and do not depend on the load of the
machine. The generated functions check the length and the range of raw values; the
hand-written functions (``c_by_hand.c``) check nothing. With ``--check``, the exit
status is 1 if a limit is exceeded. If arm-none-eabi-gcc is installed, the code size on
a Cortex-M4 is printed too.
"""

from __future__ import annotations

import argparse
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from icdgen.backends.c import CBackend
from icdgen.backends.c.names import stem
from icdgen.describe import MessageDescription, describe
from icdgen.loading import load
from icdgen.render import Renderer

BENCH = Path(__file__).parent
CALLS = 100
# Telemetry id -> instructions allowed for decode (length check included) and encode.
LIMITS = {
    132: (155 // 2 + 5, 128 // 2),
    190: (228 // 2 + 5, 195 // 2),
    206: (187, 222),
    207: (14, 17),
    146: (10, 10),
}
BYTES_PER_FIELD = 12

PROGRAM = """\
#include "cubeacp.h"
#include <stdlib.h>
{declarations}
int main(void)
{{
    unsigned sum = 0;
    for (int n = 0; n < {calls}; ++n) {{
{calls_of_all}
    }}
    return sum == 4711;
}}
"""
DECLARATIONS = """
void hand_decode_{id}({type} *m, const uint8_t *b);
void hand_encode_{id}(const {type} *m, uint8_t *b);
icd_status_t decode_{id}({type} *m, const uint8_t *b, size_t n);
icd_status_t encode_{id}(const {type} *m, uint8_t *b, size_t n);
"""
# In a file of their own: a compiler that sees the calls would know the length and drop
# the check.
FUNCTIONS = """
icd_status_t decode_{id}({type} *m, const uint8_t *b, size_t n) {{ return {stem}_decode(m, b, n); }}
icd_status_t encode_{id}(const {type} *m, uint8_t *b, size_t n) {{ return {stem}_encode(m, b, n); }}
"""
CALL = """\
        {{
            static {type} generated, by_hand;
            uint8_t frame[{upper}_LENGTH], again[{upper}_LENGTH];
            for (size_t i = 0; i < sizeof frame; ++i) {{
                frame[i] = (uint8_t)rand();
            }}
            hand_decode_{id}(&by_hand, frame);
            hand_encode_{id}(&by_hand, frame);
            if (decode_{id}(&generated, frame, sizeof frame) != ICD_OK ||
                encode_{id}(&generated, again, sizeof again) != ICD_OK || memcmp(frame, again, sizeof frame) != 0) {{
                abort();
            }}
            sum += again[0];
        }}
"""


def messages() -> dict[int, MessageDescription]:
    """Return the measured messages by telemetry id."""
    icd = load([BENCH.parent / "icd"], check=False).icd
    of_id = {
        message.model.telemetry_id: message
        for message in describe(icd).node("cubeacp").messages
    }
    return {id: of_id[id] for id in LIMITS}


def generate(folder: Path) -> None:
    icd = load([BENCH.parent / "icd"], check=False).icd
    for path, text in CBackend().files(icd, Renderer("c")):
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_text(text, encoding="utf-8")


def functions_of(messages_by_id: dict[int, MessageDescription]) -> str:
    """Return a source file with a non-inline function for each generated function."""
    values = (
        {"id": id, "stem": stem(m), "type": f"{stem(m)}_t"}
        for id, m in messages_by_id.items()
    )
    return '#include "cubeacp.h"\n' + "".join(FUNCTIONS.format(**v) for v in values)


def instructions(
    folder: Path,
    messages_by_id: dict[int, MessageDescription],
    compiler: str,
    option: str,
) -> dict[str, float]:
    """Return the instructions per call of each function."""
    values = [
        {"id": id, "stem": stem(m), "type": f"{stem(m)}_t", "upper": stem(m).upper()}
        for id, m in messages_by_id.items()
    ]
    declarations = "".join(DECLARATIONS.format(**v) for v in values)
    calls = "".join(CALL.format(**v) for v in values)
    program, counts = folder / "bench", folder / "counts"
    (folder / "bench.c").write_text(
        PROGRAM.format(declarations=declarations, calls=CALLS, calls_of_all=calls)
    )
    (folder / "generated.c").write_text(functions_of(messages_by_id))
    objects = []
    for source in (folder / "bench.c", folder / "generated.c", BENCH / "c_by_hand.c"):
        objects.append(folder / f"{source.stem}.o")
        subprocess.run(
            [
                compiler,
                "-std=c99",
                option,
                f"-I{folder}",
                "-c",
                source,
                "-o",
                objects[-1],
            ],
            check=True,
        )
    subprocess.run([compiler, *objects, "-o", program], check=True)
    valgrind = [
        "valgrind",
        "--tool=callgrind",
        f"--callgrind-out-file={counts}",
        program,
    ]
    subprocess.run(valgrind, check=True, capture_output=True)
    annotate = ["callgrind_annotate", "--inclusive=yes", "--threshold=100", counts]
    text = subprocess.run(annotate, check=True, capture_output=True, text=True).stdout
    lines = re.findall(r"^\s*([\d,]+) .*?:((?:hand_)?(?:de|en)code_\d+)\b", text, re.M)
    return {name: int(count.replace(",", "")) / CALLS for count, name in lines}


def code_size(
    folder: Path, messages_by_id: dict[int, MessageDescription]
) -> dict[int, tuple[int, int]] | None:
    """Return the bytes of code for decode and encode on a Cortex-M4 with -Os, and the
    number of fields, by id.
    """
    if not shutil.which("arm-none-eabi-gcc"):
        return None
    source, target = folder / "size.c", folder / "size.o"
    source.write_text(functions_of(messages_by_id))
    options = [
        "-mcpu=cortex-m4",
        "-mthumb",
        "-Os",
        "-std=c99",
        f"-I{folder}",
        "-c",
        source,
        "-o",
        target,
    ]
    subprocess.run(["arm-none-eabi-gcc", *options], check=True)
    table = subprocess.run(
        ["arm-none-eabi-nm", "-S", target], check=True, capture_output=True, text=True
    ).stdout
    sizes = {
        name: int(size, 16)
        for size, name in re.findall(r"^\w+ (\w+) \w (\S+)$", table, re.M)
    }
    return {
        id: (sizes[f"decode_{id}"] + sizes[f"encode_{id}"], len(message.fields))
        for id, message in messages_by_id.items()
    }


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--cc", default="gcc")
    parser.add_argument("--opt", default="-O2")
    parser.add_argument("--check", action="store_true")
    options = parser.parse_args()
    messages_by_id = messages()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        generate(folder)
        counts = instructions(folder, messages_by_id, options.cc, options.opt)
        sizes = code_size(folder, messages_by_id)
    missed = []
    print(
        "| frame | decode | by hand | ratio | encode | by hand | ratio | Cortex-M4 -Os, bytes a field |"
    )
    print("|---|---|---|---|---|---|---|---|")
    for id, message in messages_by_id.items():
        cells = [f"{id} {message.model.name}"]
        for what, limit in zip(("decode", "encode"), LIMITS[id], strict=True):
            ours, theirs = counts[f"{what}_{id}"], counts[f"hand_{what}_{id}"]
            cells += [f"{ours:.0f}", f"{theirs:.0f}", f"{ours / theirs:.2f}"]
            if ours > limit:
                missed.append(f"{what} {id}: {ours:.0f} instructions, {limit} allowed")
        cells.append(f"{sizes[id][0] / sizes[id][1]:.1f}" if sizes else "")
        print(f"| {' | '.join(cells)} |")
    if sizes:
        total, fields = (sum(column) for column in zip(*sizes.values(), strict=True))
        print(
            f"\nCortex-M4: {total} bytes for {fields} fields, {total / fields:.1f} a field."
        )
        if total > BYTES_PER_FIELD * fields:
            missed.append(
                f"Cortex-M4: {total / fields:.1f} bytes a field, {BYTES_PER_FIELD} allowed"
            )
    print("\n".join(missed), file=sys.stderr)
    return 1 if options.check and missed else 0


if __name__ == "__main__":
    sys.exit(main())
