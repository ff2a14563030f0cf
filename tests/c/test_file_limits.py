"""Procedures in C respect limits of inputs, packet numbers and offsets near 4 GiB."""

from __future__ import annotations

import subprocess

import pytest

from tests.c import harness

START = r"""
#include "bootloader.h"
#include "cubeacp.h"
#include <assert.h>
#include <stdlib.h>

static uint8_t *buffer, *bitmap; /* of just one block: the sanitizer watches both ends */
static icd_procedure_form_t form;
static icd_blocks_form_t blocks;
static icd_procedure_t procedure;

/* Begin a download of unknown size with blocks of 100 packets, of which the first has this number. */
static void begin(uint32_t first_packet)
{
    form = *cubeacp_download_form();
    blocks = *form.blocks;
    buffer = (uint8_t *)malloc(100u * blocks.packet_bytes);
    bitmap = (uint8_t *)malloc(13);
    assert(
        cubeacp_download(
            &procedure, ICD_BUS_UART, 2, 0, ICD_UNKNOWN, 100u * blocks.packet_bytes, buffer,
            100u * blocks.packet_bytes, bitmap, 13, NULL, NULL) == ICD_OK);
    blocks.first_packet = first_packet;
    blocks.most = 0xFFFFFFFEu;
    form.blocks = &blocks;
    procedure.form = &form;
}

static void end(void)
{
    free(buffer);
    free(bitmap);
}

/* The next request was executed, and returned this telemetry. */
static uint32_t done(uint8_t *data, size_t length)
{
    icd_request_t request;
    icd_event_t event = {ICD_EVENT_DONE};
    assert(icd_procedure_next(&procedure, 0, &request));
    event.direction = request.direction;
    event.id = request.id;
    event.data = data;
    event.length = length;
    icd_procedure_event(&procedure, 0, &event);
    return request.id;
}

/* The device has loaded a block of this length. */
static void load(uint32_t length)
{
    common_download_block_ready_t ready;
    uint8_t frame[COMMON_DOWNLOAD_BLOCK_READY_LENGTH];
    icd_request_t request;
    common_download_block_ready_init(&ready);
    ready.ready = true;
    ready.block_length = (uint16_t)length;
    assert(common_download_block_ready_encode(&ready, frame, sizeof frame) == ICD_OK);
    assert(done(NULL, 0) == COMMON_LOAD_FILE_DOWNLOAD_BLOCK_ID);
    assert(done(frame, sizeof frame) == COMMON_DOWNLOAD_BLOCK_READY_ID);
    (void)icd_procedure_next(&procedure, 0, &request);
}
"""

PACKETS = (
    START
    + r"""
/* A packet arrives. Return the number of packets that are missing. */
static uint32_t arrive(uint32_t number, size_t more)
{
    common_file_download_buffer_with_file_contents_t packet;
    uint8_t frame[COMMON_FILE_DOWNLOAD_BUFFER_WITH_FILE_CONTENTS_LENGTH + 1u] = {0};
    icd_event_t event = {ICD_EVENT_ARRIVED};
    common_file_download_buffer_with_file_contents_init(&packet);
    packet.packet_counter = (uint16_t)number;
    assert(common_file_download_buffer_with_file_contents_encode(&packet, frame, sizeof frame - 1u) == ICD_OK);
    event.id = COMMON_FILE_DOWNLOAD_BUFFER_WITH_FILE_CONTENTS_ID;
    event.data = frame;
    event.length = sizeof frame - 1u + more;
    icd_procedure_event(&procedure, 0, &event);
    return procedure.missing;
}

int main(void)
{
    for (uint32_t first = 0; first < 2u; ++first) {
        begin(first);
        assert(arrive(first, 0) == 0u); /* of the previous block: this one has not begun */
        load(100u * blocks.packet_bytes);
        assert(procedure.missing == 100u);
        assert(arrive(first + 100u, 0) == 100u && arrive(0xFFFF, 0) == 100u && arrive(first - 1u, 0) == 100u);
        assert(arrive(first + 99u, (size_t)-1) == 100u); /* too short */
        assert(arrive(first + 99u, 0) == 99u && arrive(first + 99u, 0) == 99u);
        assert(arrive(first, 0) == 98u);
        end();
    }
    return 0;
}
"""
)


OFFSETS = (
    START
    + r"""
/* Load a block at an offset; the device says that it has so many bytes. */
static icd_result_t load_at(uint32_t offset, uint32_t length)
{
    icd_result_t result;
    begin(0);
    procedure.registers[ICD_BLOCK_OFFSET] = offset;
    load(length);
    assert(procedure.registers[ICD_BLOCK_OFFSET] == offset);
    result = procedure.result;
    end();
    return result;
}

int main(void)
{
    assert(load_at(0xFFFFFFFEu - 100u, 100) == ICD_RUNNING);
    assert(load_at(0xFFFFFFFEu - 100u, 101) == ICD_LIMIT);
    assert(load_at(0xFFFFFFFEu - 100u, 2000) == ICD_LIMIT);
    assert(load_at(0xFFFFFFFEu, 1) == ICD_LIMIT);
    assert(load_at(0, 2001) == ICD_LENGTH);
    return 0;
}
"""
)

INPUTS = (
    START
    + r"""
static icd_status_t upload(uint8_t destination, size_t size)
{
    static uint8_t map[BOOTLOADER_UPLOAD_BITMAP_BYTES];
    return bootloader_upload(&procedure, destination, map, size, 0, map, sizeof map);
}

static icd_status_t download(uint32_t size)
{
    static uint8_t one[1];
    return cubeacp_download(&procedure, ICD_BUS_UART, 2, 0, size, 1, buffer, blocks.packet_bytes, one, 1, NULL, NULL);
}

int main(void)
{
    begin(0);
    const uint32_t most = cubeacp_download_form()->blocks->most, destination = bootloader_upload_form()->inputs[0].values[0];
    assert(download(most) == ICD_OK && download(0) == ICD_OK && download(ICD_UNKNOWN) == ICD_OK);
    assert(download(most + 1u) == ICD_ERROR_RANGE && download(ICD_UNKNOWN - 1u) == ICD_ERROR_RANGE);
    assert(upload((uint8_t)destination, bootloader_upload_form()->most_bytes) == ICD_OK);
    assert(upload((uint8_t)destination, bootloader_upload_form()->most_bytes + 1u) == ICD_ERROR_LENGTH);
    assert(upload(0, 1) == ICD_ERROR_RANGE && upload(255, 1) == ICD_ERROR_RANGE);
    end();
    return 0;
}
"""
)


@pytest.fixture(scope="module")
def headers(tmp_path_factory):
    return harness.generate(harness.shipped(), tmp_path_factory.mktemp("headers"))


def run(source: str, headers, folder) -> None:
    """Compile and run a program with sanitizers."""
    path = folder / "program.c"
    path.write_text(source)
    options = ("-std=c99", *harness.SANITIZERS, f"-I{headers}")
    program = harness.compile(path, *options, output=folder / "program")
    done = subprocess.run([program], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_packets_that_the_block_does_not_have_are_ignored(headers, tmp_path):
    run(PACKETS, headers, tmp_path)


def test_a_download_near_4_gib_ends_at_the_limit_of_the_icd(headers, tmp_path):
    run(OFFSETS, headers, tmp_path)


def test_inputs_above_the_limits_of_the_icd_are_refused(headers, tmp_path):
    run(INPUTS, headers, tmp_path)
