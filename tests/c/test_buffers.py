"""Procedures in C refuse a buffer that is too small, so they never write past its end.

The program passes the size of each buffer to the functions that start procedures.
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
