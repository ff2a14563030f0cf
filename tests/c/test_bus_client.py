"""Clients in C support several requests at a time, and output in pieces of any size.

The programs run a client on UART and on I2C.
"""

from __future__ import annotations

import subprocess

import pytest

from tests.c import harness

BEGIN = r"""
#include "cubeacp.h"
#include <assert.h>
#include <stdio.h>
#include <string.h>

static cubeacp_client_t acp;
static icd_slot_t slots[3];
static uint8_t buffer[CUBEACP_CLIENT_BYTES + 2u * CUBEACP_REQUEST_BYTES];

static void on_event(void *context, const icd_event_t *event)
{
    (void)context;
    printf("%s %u %u\n", event->kind == ICD_EVENT_DONE ? "done" : event->kind == ICD_EVENT_SENT ? "sent"
        : event->kind == ICD_EVENT_REFUSED ? "refused" : event->kind == ICD_EVENT_LATE ? "late" : "?",
        (unsigned)event->id, event->length != 0u ? (unsigned)event->data[0] : 0u);
}
"""
UART = (
    BEGIN
    + r"""
/* The id of the next message that is sent, in pieces of this size; 0 if there is none. */
static unsigned sends(size_t piece)
{
    uint8_t line[64], part[64];
    size_t length = 0u, count;
    while ((length < 2u || line[length - 1u] != 0xFFu) && icd_client_output(&acp.client, part, piece, &count)) {
        memcpy(line + length, part, count);
        length += count;
    }
    return length != 0u ? line[2] : 0u;
}

int main(void)
{
    static const uint8_t angles[] = {0x1F, 0x7F, 146, 1, 0, 0, 0, 0, 0, 0x1F, 0xFF};
    static const uint8_t rates[] = {0x1F, 0x7F, 147, 2, 0, 0, 0, 0, 0, 0x1F, 0xFF};
    static const uint8_t acknowledge[] = {0x1F, 0x7F, 10, 0, 0x1F, 0xFF};
    cubeacp_set_adcs_run_mode_t mode = {0};
    uint8_t line[64];
    uint32_t deadline;
    size_t count;
    assert(cubeacp_client_uart(&acp, slots, 3, buffer, sizeof buffer - 1u) == ICD_ERROR_LENGTH);
    assert(cubeacp_client_uart(&acp, slots, 3, buffer, sizeof buffer) == ICD_OK);
    acp.client.settings.in_flight = 2;
    assert(cubeacp_request_estimated_attitude_angles(&acp, 0) == ICD_OK);
    assert(cubeacp_request_estimated_attitude_angles(&acp, 0) == ICD_OK); /* its reply could be the first one */
    assert(cubeacp_request_estimated_angular_rates(&acp, 0) == ICD_OK);
    assert(cubeacp_send_set_adcs_run_mode(&acp, 0, &mode) == ICD_ERROR_BUSY);
    assert(sends(64) == 146u && sends(64) == 0u);
    icd_client_received(&acp.client, 1, angles, sizeof angles, on_event, NULL);
    assert(sends(1) == 146u && sends(1) == 147u && sends(1) == 0u);
    assert(cubeacp_send_set_adcs_run_mode(&acp, 2, &mode) == ICD_OK);
    icd_client_received(&acp.client, 3, rates, sizeof rates, on_event, NULL);
    icd_client_received(&acp.client, 4, angles, sizeof angles, on_event, NULL);
    assert(sends(3) == 10u);
    icd_client_received(&acp.client, 5, acknowledge, sizeof acknowledge, on_event, NULL);
    assert(!icd_client_deadline(&acp.client, &deadline));

    /* A request whose output is partly taken has no deadline, keeps its memory, and ends when the rest is taken. */
    assert(cubeacp_client_uart(&acp, slots, 1, buffer, sizeof buffer) == ICD_OK);
    assert(cubeacp_request_estimated_attitude_angles(&acp, 0) == ICD_OK);
    assert(icd_client_output(&acp.client, line, 2, &count) && count == 2u);
    assert(!icd_client_deadline(&acp.client, &deadline));
    icd_client_received(&acp.client, 5000, angles, sizeof angles, on_event, NULL);
    assert(cubeacp_request_estimated_angular_rates(&acp, 5000) == ICD_ERROR_BUSY);
    assert(icd_client_output(&acp.client, line, sizeof line, &count) && count == 3u && line[0] == 146u);
    assert(cubeacp_request_estimated_angular_rates(&acp, 5000) == ICD_OK);
    assert(icd_client_output(&acp.client, line, 2, &count) && count == 2u);
    icd_client_tick(&acp.client, 6000, on_event, NULL);
    assert(icd_client_output(&acp.client, line, sizeof line, &count) && line[0] == 147u);
    assert(icd_client_deadline(&acp.client, &deadline) && deadline == 6000u + acp.client.settings.reply_timeout);
    icd_client_cancel(&acp.client);
    assert(cubeacp_request_estimated_attitude_angles(&acp, 20000) == ICD_OK);
    assert(icd_client_output(&acp.client, line, 2, &count));
    icd_client_tick(&acp.client, 90000, on_event, NULL);
    assert(!icd_client_deadline(&acp.client, &deadline));
    icd_client_cancel(&acp.client); /* also the rest of the output */
    assert(!icd_client_output(&acp.client, line, 2, &count));
    assert(cubeacp_request_estimated_angular_rates(&acp, 90000) == ICD_OK && sends(64) == 147u);
    return 0;
}
"""
)
I2C = (
    BEGIN
    + r"""
/* The id of the next transaction; 0 if there is none. */
static unsigned sends(void)
{
    const uint8_t *bytes;
    size_t count, read;
    return icd_client_transfer(&acp.client, &bytes, &count, &read) ? bytes[0] : 0u;
}

int main(void)
{
    static const uint8_t first[] = {1, 0, 0, 0, 0, 0}, second[] = {2, 0, 0, 0, 0, 0}, processed[] = {10, 1, 0, 0};
    cubeacp_set_adcs_run_mode_t mode = {0};
    uint32_t deadline;
    assert(cubeacp_client_i2c(&acp, slots, 3, buffer, sizeof buffer) == ICD_OK);
    acp.client.settings.in_flight = 3;
    assert(cubeacp_send_set_adcs_run_mode(&acp, 0, &mode) == ICD_OK);
    assert(cubeacp_request_estimated_attitude_angles(&acp, 0) == ICD_OK);
    assert(cubeacp_request_estimated_attitude_angles(&acp, 0) == ICD_OK);
    assert(sends() == 10u && sends() == 146u && sends() == 146u && sends() == 0u);
    icd_client_transferred(&acp.client, 1, first, 0, on_event, NULL);
    icd_client_transferred(&acp.client, 1, first, sizeof first, on_event, NULL);
    assert(icd_client_deadline(&acp.client, &deadline));
    icd_client_tick(&acp.client, 1u + acp.client.settings.poll_interval, on_event, NULL);
    assert(sends() == 240u && sends() == 0u);
    icd_client_transferred(&acp.client, 22, second, sizeof second, on_event, NULL);
    icd_client_transferred(&acp.client, 23, processed, sizeof processed, on_event, NULL);
    assert(!icd_client_deadline(&acp.client, &deadline));
    return 0;
}
"""
)
PROGRAMS = {
    "uart": (UART, ["done 146 1", "done 147 2", "done 146 1", "done 10 10"]),
    "i2c": (I2C, ["done 146 1", "done 146 2", "done 10 10"]),
}


@pytest.mark.parametrize("bus", PROGRAMS)
def test_several_requests_share_a_bus_and_output_is_taken_in_pieces(bus, tmp_path):
    text, events = PROGRAMS[bus]
    headers = harness.generate(harness.shipped(), tmp_path / "made")
    source = tmp_path / "program.c"
    source.write_text(text)
    for compiler in ("gcc", "clang"):
        flags = ("-std=c99", *harness.WARNINGS, *harness.SANITIZERS, f"-I{headers}")
        program = harness.compile(
            source, *flags, compiler=compiler, output=tmp_path / "program"
        )
        done = subprocess.run([program], capture_output=True, text=True)
        assert (done.returncode, done.stderr) == (0, "")
        assert done.stdout.splitlines()[: len(events)] == events
