"""Callbacks of the C wire layer may call the client, and no function is recursive."""

from __future__ import annotations

import graphlib
import re
import subprocess

import pytest

from tests.c import harness


@pytest.fixture(scope="module")
def headers(tmp_path_factory):
    return harness.generate(harness.shipped(), tmp_path_factory.mktemp("headers"))


LATE = r"""
#include "cubeacp.h"
#include <assert.h>
#include <stdio.h>

typedef struct {
    cubeacp_client_t client;
    uint32_t now;
    bool resets; /* the next request is a Reset */
} program_t;

/* As programs do it: the end of a request begins the next one. */
static void on_event(void *context, const icd_event_t *event)
{
    static const char *const names[] = {"done", "sent", "timeout", "late"};
    program_t *const program = (program_t *)context;
    const common_reset_t reset = {0};
    printf("%s %u\n", event->kind == ICD_EVENT_DONE ? names[0]
                       : event->kind == ICD_EVENT_SENT ? names[1]
                       : event->kind == ICD_EVENT_TIMEOUT ? names[2]
                       : event->kind == ICD_EVENT_LATE ? names[3] : "?", (unsigned)event->id);
    if (event->kind == ICD_EVENT_TIMEOUT && program->resets) {
        assert(cubeacp_send_reset(&program->client, program->now, &reset) == ICD_OK);
    } else if (event->kind == ICD_EVENT_TIMEOUT) {
        assert(cubeacp_request_estimated_angular_rates(&program->client, program->now) == ICD_OK);
    }
}

/* A driver that blocks for so long over a transaction. */
static void transfer(program_t *program, uint32_t takes)
{
    static const uint8_t read_bytes[CUBEACP_LONGEST];
    const uint8_t *bytes;
    size_t count, read;
    assert(icd_client_transfer(&program->client.client, &bytes, &count, &read));
    program->now += takes;
    icd_client_transferred(&program->client.client, program->now, read_bytes, read, on_event, program);
}

int main(void)
{
    static icd_slot_t slots[1];
    static uint8_t buffer[CUBEACP_CLIENT_BYTES];
    for (int resets = 0; resets < 2; ++resets) {
        static program_t program;
        program.now = 0;
        program.resets = resets != 0;
        assert(cubeacp_client_i2c(&program.client, slots, 1, buffer, sizeof buffer) == ICD_OK);
        program.client.client.settings.retries = 0;
        assert(cubeacp_request_estimated_attitude_angles(&program.client, 0) == ICD_OK);
        transfer(&program, 1001); /* the time-out begins the next request, which is not that of these bytes */
        transfer(&program, 1);
    }
    return 0;
}
"""


def test_a_late_transfer_does_not_end_a_request_started_by_the_time_out_event(
    headers, tmp_path
):
    source = tmp_path / "late.c"
    source.write_text(LATE)
    program = harness.compile(
        source,
        "-std=c99",
        *harness.SANITIZERS,
        f"-I{headers}",
        output=tmp_path / "late",
    )
    done = subprocess.run([program], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.split("\n")[:-1] == [
        "timeout 146",
        "late 146",
        "done 147",
        "timeout 146",
        "late 146",
        "sent 1",
    ]


CANCEL = r"""
#include "cubeacp.h"
#include <assert.h>

static void on_event(void *context, const icd_event_t *event)
{
    (void)event;
    ++*(int *)context;
}

int main(void)
{
    static cubeacp_client_t acp;
    icd_client_t *const client = &acp.client;
    static icd_slot_t slots[1];
    static uint8_t buffer[CUBEACP_CLIENT_BYTES];
    static const uint8_t late[] = {0x1F, 0x7F, 0x92, 0, 0, 0, 0, 0, 0, 0x1F, 0xFF};
    uint8_t bytes[64];
    size_t count;
    uint32_t deadline;
    int events = 0;
    assert(cubeacp_client_uart(&acp, slots, 1, buffer, sizeof buffer) == ICD_OK);
    icd_client_cancel(client); /* nothing: no harm */
    assert(cubeacp_request_identification(&acp, 0) == ICD_OK);
    icd_client_cancel(client);
    assert(!icd_client_output(client, bytes, sizeof bytes, &count)); /* what was not taken is not sent */
    assert(!icd_client_deadline(client, &deadline));
    assert(cubeacp_request_estimated_attitude_angles(&acp, 0) == ICD_OK);
    assert(icd_client_output(client, bytes, sizeof bytes, &count) && count == 5u && bytes[2] == 146u);
    icd_client_cancel(client);
    assert(cubeacp_request_identification(&acp, 1) == ICD_OK);
    assert(icd_client_output(client, bytes, sizeof bytes, &count) && bytes[2] == 128u);
    icd_client_received(client, 2, late, sizeof late, on_event, &events);
    assert(events == 1 && client->slots[0].state == ICD_SLOT_WAIT);
    return 0;
}
"""


def test_a_cancelled_request_does_not_block_the_next(headers, tmp_path):
    source = tmp_path / "cancel.c"
    source.write_text(CANCEL)
    program = harness.compile(
        source,
        "-std=c99",
        *harness.SANITIZERS,
        f"-I{headers}",
        output=tmp_path / "cancel",
    )
    done = subprocess.run([program], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")


def calls_of(source, headers, folder) -> dict[str, set[str]]:
    """Return the functions that each function calls, from the call graph of gcc."""
    flags = (
        "-std=c99",
        "-O0",
        "-c",
        "-fkeep-static-functions",
        "-fkeep-inline-functions",
        "-fcallgraph-info",
    )
    harness.compile(source, *flags, f"-I{headers}", output=folder / "graph.o")
    (graph,) = folder.glob("*.ci")
    text = graph.read_text()
    calls: dict[str, set[str]] = {}
    for caller, callee in re.findall(
        r'edge: \{ sourcename: "([^"]+)" targetname: "([^"]+)"', text
    ):
        calls.setdefault(caller.split(":")[-1], set()).add(callee.split(":")[-1])
    return calls


def test_no_function_calls_itself_directly_or_indirectly(headers, tmp_path):
    """Firmware needs a known depth of the stack."""
    source = tmp_path / "all.c"
    source.write_text(
        "".join(f'#include "{path.name}"\n' for path in sorted(headers.glob("*.h")))
    )
    calls = calls_of(source, headers, tmp_path)
    assert "icd_client_tick" in calls["icd_client_received"] and len(calls) > 300
    list(
        graphlib.TopologicalSorter(calls).static_order()
    )  # CycleError names the functions


def test_the_test_finds_recursion(tmp_path):
    source = tmp_path / "round.c"
    source.write_text(
        "static void b(int n);\nstatic void a(int n) { if (n) b(n - 1); }\nstatic void b(int n) { a(n); }\n"
    )
    with pytest.raises(graphlib.CycleError):
        list(
            graphlib.TopologicalSorter(
                calls_of(source, tmp_path, tmp_path)
            ).static_order()
        )
