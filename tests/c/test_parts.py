"""Parts of composite messages in C: functions that give them as the messages that are
repeated.
"""

from __future__ import annotations

import subprocess

import pytest

from icdgen.backends.c.names import stem
from icdgen.describe import describe
from icdgen.icd.model import Icd
from tests.c import harness
from tests.conformance import composites

CASE = """
static void check_{number}(void)
{{
    const uint8_t frame[] = {{{frame}}};
    const uint8_t expected[] = {{{expected}}};
    uint8_t found[sizeof expected];
    {composite}_t message;
    {part}_t part;
    check({composite}_decode(&message, frame, sizeof frame) == ICD_OK, {number});
    memset(&part, 0xa5, sizeof part);
{calls}
    check({part}_encode(&part, found, sizeof found) == ICD_OK, {number});
    check(memcmp(found, expected, sizeof expected) == 0, {number});
}}
"""
PROGRAM = """\
{includes}#include <stdio.h>
static int wrong = 0;
static void check(bool holds, int number)
{{
    if (!holds) {{
        wrong = 1;
        printf("%d ", number);
    }}
}}
{checks}
int main(void)
{{
{calls}
    return wrong;
}}
"""


def program(icd: Icd) -> tuple[str, int]:
    description, checks = describe(icd), []
    for case in composites.cases(icd):
        for one in case.parts:
            composite, part = (
                description.message(case.message),
                description.message(one.part),
            )
            count = sum(other.part is one.part for other in case.parts)
            name, number = f"{stem(composite)}_part_{part.name}", len(checks)
            calls = [f"    {name}(&message, &part);"]
            if count > 1:
                calls = [
                    f"    check({name}(&message, {one.index}u, &part) == ICD_OK, {number});",
                    f"    check({name}(&message, {count}u, &part) == ICD_ERROR_RANGE, {number});",
                    f"    check({name}(&message, (size_t)-1, &part) == ICD_ERROR_RANGE, {number});",
                ]
            spelled = {
                "frame": ", ".join(map(str, case.frame)),
                "expected": ", ".join(map(str, one.frame)),
            }
            names = {
                "composite": stem(composite),
                "part": stem(part),
                "calls": "\n".join(calls),
            }
            checks.append(CASE.format(number=number, **names, **spelled))
    includes = "".join(f'#include "{node.name}.h"\n' for node in icd.nodes)
    calls = "\n".join(f"    check_{number}();" for number in range(len(checks)))
    return PROGRAM.format(includes=includes, checks="".join(checks), calls=calls), len(
        checks
    )


@pytest.mark.parametrize("which", ["odd", "shipped"])
@pytest.mark.parametrize("compiler", ["gcc", "g++"])
def test_parts_are_what_the_reference_reads_there(which, compiler, tmp_path):
    icd = (
        harness.shipped()
        if which == "shipped"
        else harness.read(composites.write(tmp_path / "icd"))
    )
    folder = harness.generate(icd, tmp_path / "c")
    source = folder / ("parts.cpp" if compiler == "g++" else "parts.c")
    text, count = program(icd)
    assert count > 20
    source.write_text(text)
    standard = "c++17" if compiler == "g++" else "c99"
    options = (
        f"-std={standard}",
        *harness.WARNINGS,
        *harness.SANITIZERS,
        f"-I{folder}",
    )
    program_file = harness.compile(
        source, *options, compiler=compiler, output=folder / "parts"
    )
    done = subprocess.run([program_file], capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (0, ""), done.stderr[:2000]
