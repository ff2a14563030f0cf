"""A client in C accepts only messages of its node.

Calls with messages of another node do not compile, or return an error at once.
"""

from __future__ import annotations

import re
import subprocess

import pytest

from tests.c import harness

COMPILERS = [("gcc", "c99"), ("clang", "c99"), ("g++", "c++17")]


@pytest.fixture(scope="module")
def headers(tmp_path_factory):
    return harness.generate(harness.shipped(), tmp_path_factory.mktemp("headers"))


CALL = """\
#include "bootloader.h"
#include "cubeacp.h"
icd_status_t call(cubeacp_client_t *acp, const icd_event_t *event);
icd_status_t call(cubeacp_client_t *acp, const icd_event_t *event)
{
    %s
}
"""
CALL_OF_OWN_NODE = """\
    cubeacp_set_adcs_run_mode_t mode;
    cubeacp_state_t state;
    common_identification_t identity;
    cubeacp_set_adcs_run_mode_init(&mode);
    if (cubeacp_request_state(acp, 0) != ICD_OK || cubeacp_request_identification(acp, 0) != ICD_OK) {
        return ICD_ERROR_BUSY;
    }
    if (cubeacp_receive_state(&state, event) != ICD_OK || cubeacp_receive_identification(&identity, event) != ICD_OK) {
        return ICD_ERROR_LENGTH;
    }
    return cubeacp_send_set_adcs_run_mode(acp, 0, &mode);"""
CALLS_OF_OTHER_NODES = {
    "telemetry of another node": "(void)event; return bootloader_request_state(acp, 0);",
    "the frame of another node": "(void)acp; bootloader_state_t state; return cubeacp_receive_state(&state, event);",
    "a telecommand of another node": "(void)event; return bootloader_send_run_selected_program(acp, 0);",
    "a telecommand that is another message":
        "(void)event; bootloader_set_boot_index_t one; bootloader_set_boot_index_init(&one);"
        "return cubeacp_send_set_adcs_run_mode(acp, 0, &one);",
    "telemetry that only the other node has": "(void)event; return cubeacp_request_program_information(acp, 0);",
    "a client without a node": "(void)event; return cubeacp_request_state(&acp->client, 0);",
}  # fmt: skip


def compile_call(headers, folder, body, compiler, standard):
    source = folder / "call.c"
    source.write_text(CALL % body)
    flags = [
        f"-std={standard}",
        "-Werror",
        "-fsyntax-only",
        f"-I{headers}",
        *(["-xc++"] if "++" in compiler else []),
    ]
    return subprocess.run([compiler, *flags, source], capture_output=True, text=True)


@pytest.mark.parametrize(("compiler", "standard"), COMPILERS)
def test_messages_of_the_node_and_of_included_nodes_compile(
    headers, tmp_path, compiler, standard
):
    assert (
        compile_call(
            headers, tmp_path, CALL_OF_OWN_NODE.strip(), compiler, standard
        ).stderr
        == ""
    )


@pytest.mark.parametrize(("compiler", "standard"), COMPILERS)
@pytest.mark.parametrize("what", CALLS_OF_OTHER_NODES)
def test_a_message_of_another_node_does_not_compile(
    headers, tmp_path, what, compiler, standard
):
    done = compile_call(
        headers, tmp_path, CALLS_OF_OTHER_NODES[what], compiler, standard
    )
    assert done.returncode != 0
    assert re.search(
        "incompatible|cannot convert|no matching function|implicit|undeclared|not declared",
        done.stderr,
    )


RECEIVE = r"""
#include "bootloader.h"
#include "cubeacp.h"
#include <assert.h>

typedef struct {
    icd_event_t event;
    uint8_t data[64];
} seen_t;

static void on_event(void *context, const icd_event_t *event)
{
    seen_t *const seen = (seen_t *)context;
    seen->event = *event;
    if (event->length != 0u) {
        memcpy(seen->data, event->data, event->length);
        seen->event.data = seen->data;
    }
}

int main(void)
{
    static cubeacp_client_t acp;
    static bootloader_client_t boot;
    static icd_slot_t slots[1], other_slots[1];
    static uint8_t buffer[CUBEACP_CLIENT_BYTES], other_buffer[BOOTLOADER_CLIENT_BYTES];
    static const uint8_t frame[] = {0x1F, 0x7F, 0x84, 1, 0, 0, 0, 0, 0, 0x1F, 0xFF};
    static const uint8_t refused[] = {0x1F, 0x7F, 0x0A, 0x03, 0x1F, 0xFF};
    cubeacp_set_adcs_run_mode_t mode;
    cubeacp_adcs_power_control_t power;
    cubeacp_current_adcs_state_t state;
    bootloader_state_t other;
    common_identification_t identity;
    uint8_t bytes[64];
    size_t count;
    seen_t seen;
    assert(CUBEACP_CURRENT_ADCS_STATE_ID == BOOTLOADER_STATE_ID && CUBEACP_CURRENT_ADCS_STATE_LENGTH == BOOTLOADER_STATE_LENGTH);

    assert(cubeacp_client_uart(&acp, slots, 1, buffer, sizeof buffer) == ICD_OK);
    assert(cubeacp_request_current_adcs_state(&acp, 0) == ICD_OK && icd_client_output(&acp.client, bytes, sizeof bytes, &count));
    icd_client_received(&acp.client, 1, frame, sizeof frame, on_event, &seen);
    assert(seen.event.kind == ICD_EVENT_DONE && seen.event.direction == ICD_TELEMETRY);
    assert(cubeacp_receive_current_adcs_state(&state, &seen.event) == ICD_OK && state.attitude_estimation_mode == 1u);
    assert(bootloader_receive_state(&other, &seen.event) == ICD_ERROR_UNKNOWN_ID); /* the same id and length */
    assert(cubeacp_receive_identification(&identity, &seen.event) == ICD_ERROR_UNKNOWN_ID);

    assert(bootloader_client_uart(&boot, other_slots, 1, other_buffer, sizeof other_buffer) == ICD_OK);
    assert(bootloader_request_state(&boot, 0) == ICD_OK && icd_client_output(&boot.client, bytes, sizeof bytes, &count));
    icd_client_received(&boot.client, 1, frame, sizeof frame, on_event, &seen);
    assert(bootloader_receive_state(&other, &seen.event) == ICD_OK);
    assert(cubeacp_receive_current_adcs_state(&state, &seen.event) == ICD_ERROR_UNKNOWN_ID);

    cubeacp_set_adcs_run_mode_init(&mode);
    mode.enabled = 1;
    assert(cubeacp_send_set_adcs_run_mode(&acp, 2, &mode) == ICD_OK);
    assert(icd_client_output(&acp.client, bytes, sizeof bytes, &count) && count == 6u && bytes[2] == 10u && bytes[3] == 1u);
    icd_client_received(&acp.client, 3, refused, sizeof refused, on_event, &seen);
    assert(seen.event.kind == ICD_EVENT_REFUSED && seen.event.direction == ICD_TELECOMMAND && seen.event.id == 10u);
    memset(&power, 0xFF, sizeof power);
    assert(cubeacp_send_adcs_power_control(&acp, 4, &power) == ICD_ERROR_RANGE);
    assert(!icd_client_output(&acp.client, bytes, sizeof bytes, &count));
    return 0;
}
"""


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_a_frame_is_received_only_as_the_message_of_its_sender(
    headers, tmp_path, compiler
):
    run(headers, tmp_path, RECEIVE, compiler)


CAN = r"""
#include "cubeacp.h"
#include <assert.h>

int main(void)
{
    static cubeacp_client_t acp;
    static icd_slot_t slots[1];
    static uint8_t buffer[CUBEACP_CLIENT_BYTES];
    icd_can_packet_t packet;
    const icd_can_form_t *const can = cubeacp_link()->can;
    assert(cubeacp_client_can(&acp, 0x42, slots, 1, buffer, sizeof buffer) == ICD_OK);
    assert(cubeacp_request_identification(&acp, 0) == ICD_OK && icd_client_next_packet(&acp.client, &packet));
    assert(((packet.id >> can->source.shift) & 0xFFu) == 0x42u && acp.can.joiner.address == 0x42);
    return 0;
}
"""


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_a_client_on_can_gets_its_address_at_the_start(headers, tmp_path, compiler):
    run(headers, tmp_path, CAN, compiler)


def run(headers, folder, text, compiler):
    source = folder / "program.c"
    source.write_text(text)
    flags = ("-std=c99", *harness.WARNINGS, *harness.SANITIZERS, f"-I{headers}")
    program = harness.compile(
        source, *flags, compiler=compiler, output=folder / "program"
    )
    done = subprocess.run([program], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
