"""Dispatch functions in C find the message of an id, and refuse unknown ids.

The program checks all ids of every node in both directions.
"""

from __future__ import annotations

import dataclasses
import re
import subprocess

from icdgen.backends.c import CBackend
from icdgen.backends.c.text import literal
from icdgen.icd.model import TELECOMMAND, TELEMETRY, Icd
from tests.c import harness

PROGRAM = """\
#include <stdio.h>
#include <stdlib.h>
{includes}
typedef struct {{ uint8_t id; const char *name; size_t length; }} row_t;
static unsigned long differences = 0;
static void check(bool holds, const char *node, unsigned id, const char *what)
{{
    if (!holds && differences++ < 20) {{
        printf("%s %u: %s\\n", node, id, what);
    }}
}}
{checks}
int main(void)
{{
{calls}
    return differences != 0;
}}
"""
CHECK = """
static void check_{name}(void)
{{
    static const row_t rows[] = {{ {rows} }};
    static {name}_t message;
    uint8_t frame[{longest}], again[{longest}];
    size_t next = 0;
    check(sizeof message.id == 1, "{name}", 0, "an id has more than a byte");
    for (size_t i = 0; i < sizeof frame; ++i) {{
        frame[i] = (uint8_t)rand();
    }}
    for (uint32_t id = 0; id <= UINT8_MAX; ++id) {{
        const bool known = next < sizeof rows / sizeof rows[0] && rows[next].id == id;
        const char *const found = {name}_name((uint8_t)id);
        size_t length = 4711;
        const icd_status_t status = {name}_length((uint8_t)id, &length);
        if (!known) {{
            check(found == NULL, "{name}", id, "an unknown id has a name");
            check(status == ICD_ERROR_UNKNOWN_ID && length == 4711, "{name}", id, "an unknown id has a length");
            check({name}_decode(&message, (uint8_t)id, frame, 1) == ICD_ERROR_UNKNOWN_ID, "{name}", id, "decoded");
            message.id = (uint8_t)id;
            check({name}_encode(&message, again, sizeof again) == ICD_ERROR_UNKNOWN_ID, "{name}", id, "encoded");
            continue;
        }}
        const row_t *const row = &rows[next++];
        check(found != NULL && strcmp(found, row->name) == 0, "{name}", id, "name");
        check(status == ICD_OK && length == row->length, "{name}", id, "length");
        check({name}_decode(&message, row->id, frame, length + 1) == ICD_ERROR_LENGTH, "{name}", id, "too long");
        check({name}_decode(&message, row->id, frame, length) == ICD_OK && message.id == id, "{name}", id, "decode");
        check({name}_encode(&message, again, length) == ICD_OK, "{name}", id, "encode");
        check({name}_decode(&message, row->id, again, length) == ICD_OK, "{name}", id, "decode again");
        memset(frame, 0, length);
        check({name}_encode(&message, frame, length) == ICD_OK, "{name}", id, "encode again");
        check(memcmp(frame, again, length) == 0, "{name}", id, "frames");
        for (size_t i = 0; i < sizeof frame; ++i) {{
            frame[i] = (uint8_t)rand();
        }}
    }}
    check(next == sizeof rows / sizeof rows[0], "{name}", 0, "not all ids were met");
}}
"""


def test_every_id_of_every_node_leads_to_its_message(tmp_path):
    icd = harness.shipped()
    harness.generate(icd, tmp_path)
    checks, names, ids = [], [], 0
    for node in icd.nodes:
        messages = icd.messages_of(node)
        for kind, id_of in (
            (TELEMETRY, "telemetry_id"),
            (TELECOMMAND, "telecommand_id"),
        ):
            rows = sorted(
                (getattr(m, id_of), m.name, m.length)
                for m in messages
                if getattr(m, id_of) is not None
            )
            if rows:
                ids += len(rows) if node.name != "common" else 0
                names.append(f"{node.name}_{kind}")
                text = ", ".join(
                    f"{{ {id}, {literal(name)}, {length} }}"
                    for id, name, length in rows
                )
                checks.append(
                    CHECK.format(
                        name=names[-1], rows=text, longest=max(r[2] for r in rows) + 1
                    )
                )
    source = tmp_path / "dispatch.c"
    source.write_text(
        PROGRAM.format(
            includes="\n".join(f'#include "{node.name}.h"' for node in icd.nodes),
            checks="".join(checks),
            calls="\n".join(f"    check_{name}();" for name in names),
        )
    )
    program = harness.compile(
        source,
        "-std=c99",
        "-O0",
        *harness.SANITIZERS,
        f"-I{tmp_path}",
        output=tmp_path / "d",
    )
    done = subprocess.run([program], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    assert ids > 209  # all wire ids, those of `common` under each node that includes it


def test_ids_that_fill_more_than_a_byte_get_the_wider_type():
    icd = harness.shipped()
    node = icd.node("cubeacp")
    first, *following = (message for message in node.messages if message.id is not None)
    wide = dataclasses.replace(
        node, messages=(dataclasses.replace(first, id=300), *following)
    )
    wider = Icd(tuple(wide if other is node else other for other in icd.nodes))
    for candidate, bits in ((icd, 8), (wider, 16)):
        files = {
            str(path): text
            for path, text in CBackend().files(candidate, harness._renderer())
        }
        types = set(re.findall(r"uint\d+_t (?=id[;,)])", files["cubeacp.h"]))
        assert types == {f"uint{bits}_t "}
