"""Functions in C refuse a buffer that is too small, so they never write past its end.

The programs pass buffers of many sizes to the functions that start procedures, write
log files and join CAN packets.
"""

from __future__ import annotations

import subprocess

import pytest

from tests.c import harness

PROGRAM = r"""
#include "bootloader.h"
#include "cubeacp.h"
#include <assert.h>

static void on_block(void *context, uint32_t offset, const uint8_t *data, size_t length)
{
    (void)context, (void)offset, (void)data, (void)length;
}

static icd_status_t download(uint32_t block, size_t size, size_t bits)
{
    static icd_procedure_t procedure;
    static uint8_t buffer[CUBEACP_DOWNLOAD_BLOCK_BYTES], bitmap[CUBEACP_DOWNLOAD_BITMAP_BYTES];
    return cubeacp_download(
        &procedure, ICD_BUS_UART, 1, 2, ICD_UNKNOWN, block, buffer, size, bitmap, bits, on_block, NULL);
}

static icd_status_t upload(uint32_t block, size_t bits)
{
    static icd_procedure_t procedure;
    static uint8_t bitmap[BOOTLOADER_UPLOAD_BITMAP_BYTES];
    static const uint8_t file[100];
    return bootloader_upload(&procedure, DESTINATION, file, sizeof file, block, bitmap, bits);
}

int main(void)
{
    const uint32_t packet = cubeacp_download_form()->blocks->packet_bytes, three = 2u * packet + 1u;
    const size_t all = CUBEACP_DOWNLOAD_BLOCK_BYTES, bits = CUBEACP_DOWNLOAD_BITMAP_BYTES;
    assert(download(0, all, bits) == ICD_OK);
    assert(download(0, all - 1u, bits) == ICD_ERROR_LENGTH && download(0, all, bits - 1u) == ICD_ERROR_LENGTH);
    assert(download(three, 3u * packet, 1) == ICD_OK);
    assert(download(three, 3u * packet - 1u, 1) == ICD_ERROR_LENGTH && download(three, all, 0) == ICD_ERROR_LENGTH);
    assert(download(CUBEACP_DOWNLOAD_BLOCK_BYTES + 1u, all, bits) == ICD_OK); /* blocks of the ICD are no larger */
    assert(upload(0, BOOTLOADER_UPLOAD_BITMAP_BYTES) == ICD_OK);
    assert(upload(0, BOOTLOADER_UPLOAD_BITMAP_BYTES - 1u) == ICD_ERROR_LENGTH && upload(three, 0) == ICD_ERROR_LENGTH);
    return 0;
}
"""


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_a_buffer_that_is_too_small_for_a_block_is_refused(tmp_path, compiler):
    headers = harness.generate(harness.shipped(), tmp_path)
    icd = harness.shipped()
    procedures = icd.protocol_of(icd.node("bootloader"))["procedures"]
    destination = procedures["upload"]["inputs"]["destination"]["values"][0]
    source = tmp_path / "buffers.c"
    source.write_text(PROGRAM.replace("DESTINATION", str(destination)))
    flags = ("-std=c99", *harness.WARNINGS, *harness.SANITIZERS, f"-I{headers}")
    program = harness.compile(
        source, *flags, compiler=compiler, output=tmp_path / "buffers"
    )
    done = subprocess.run([program], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")


LEAST_SIZES = r"""
#include "cubeacp.h"
#include <assert.h>
#include <stdlib.h>

#define LINK cubeacp_link()

/* Writes a log file with the first two frames, into a buffer of exactly this size. */
static icd_status_t log_written(size_t size, bool is_entry)
{
    uint8_t mask[10] = {3}, *const buffer = (uint8_t *)malloc(size != 0u ? size : 1u);
    const uint8_t zeros[256] = {0};
    icd_log_frames_t selected;
    icd_log_frame_t frame;
    icd_bytes_t frames[2];
    size_t count = 0, written;
    icd_status_t status;
    icd_log_frames(&selected, LINK, mask, NULL);
    while (icd_log_next(&selected, &frame)) {
        frames[count].data = zeros;
        frames[count++].length = frame.length;
    }
    assert(buffer != NULL && count == 2u);
    status = is_entry ? icd_log_write_entry(LINK, mask, 1, 2, frames, count, buffer, size, &written)
                      : icd_log_write_header(LINK, mask, sizeof mask, buffer, size, &written);
    assert(status != ICD_OK || written == size);
    free(buffer);
    return status;
}

static icd_status_t joiner(size_t size)
{
    icd_can_joiner_t joiner;
    icd_can_slot_t slots[3];
    uint8_t *const buffer = (uint8_t *)malloc(size != 0u ? size : 1u);
    const icd_status_t status = icd_can_joiner_init(&joiner, LINK, ICD_CAN_EVERYBODY, slots, 3, buffer, size);
    assert(buffer != NULL);
    free(buffer);
    return status;
}

/* The size from which on the function succeeds; below it, it returns ICD_ERROR_LENGTH. */
#define LEAST(size, call)                            \
    for (size = 0u; (call) != ICD_OK; size++) {      \
        assert((call) == ICD_ERROR_LENGTH);          \
    }

int main(void)
{
    const size_t entry = LINK->log_file->frames_at + 2u * LINK->log_mask->slot_bytes;
    size_t size;
    LEAST(size, log_written(size, false))
    assert(size == LINK->log_file->header_bytes);
    LEAST(size, log_written(size, true))
    assert(size == entry);
    LEAST(size, joiner(size))
    assert(size == 3u * icd_can_slot_bytes(LINK));
    return 0;
}
"""


def test_logs_and_joiners_refuse_a_buffer_that_is_a_byte_too_small(tmp_path):
    headers = harness.generate(harness.shipped(), tmp_path)
    source = tmp_path / "least.c"
    source.write_text(LEAST_SIZES)
    flags = ("-std=c99", *harness.WARNINGS, *harness.SANITIZERS, f"-I{headers}")
    program = harness.compile(source, *flags, output=tmp_path / "least")
    done = subprocess.run([program], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
