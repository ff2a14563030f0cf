"""Limits of file transfers in C: packets that a hole map cannot have, links without
file transfer, and offsets near 4 GiB.
"""

from __future__ import annotations

import subprocess

import pytest

from tests.c import harness

MAPS = r"""
#include "cubeacp.h"
#include <assert.h>
#include <stdlib.h>

int main(void)
{
    const icd_link_t *const link = cubeacp_link();
    icd_link_t without = *link;
    const uint32_t first = link->files->first_packet, most = link->hole_map->bytes * 8u;
    uint8_t *const map = (uint8_t *)malloc(link->hole_map->bytes); /* the sanitizer watches both ends */
    without.files = NULL;
    without.hole_map = NULL;

    assert(icd_hole_map_init(link, map, most + 1u) == ICD_ERROR_RANGE);
    assert(icd_hole_map_init(link, map, most) == ICD_OK);
    assert(icd_hole_map_set(link, map, most, first + most - 1u) == ICD_OK);
    assert(icd_hole_map_get(link, map, first + most - 1u));
    assert(icd_hole_map_set(link, map, most, first + most) == ICD_ERROR_RANGE);
    assert(icd_hole_map_set(link, map, 0xFFFFFFFFu, first + most) == ICD_ERROR_RANGE);
    assert(icd_hole_map_set(link, map, most, first - 1u) == ICD_ERROR_RANGE);
    assert(!icd_hole_map_get(link, map, first + most));
    assert(!icd_hole_map_get(link, map, first - 1u));
    assert(!icd_hole_map_get(link, map, 0xFFFFFFFFu));
    assert(icd_hole_map_count(link, map, most) == most - 1u);
    assert(icd_hole_map_count(link, map, most + 8u) == most + 7u);

    assert(icd_hole_map_init(&without, map, 1) == ICD_ERROR_UNSUPPORTED);
    assert(icd_hole_map_set(&without, map, 1, 0) == ICD_ERROR_UNSUPPORTED);
    assert(!icd_hole_map_get(&without, map, 0));
    assert(icd_hole_map_count(&without, map, 1) == 0u);
    assert(icd_block_buffer(&without, 1) == 0u && icd_block_bitmap(&without, 1) == 0u);
    assert(icd_block_buffer(link, 0xFFFFFFFFu) == CUBEACP_BLOCK_BYTES);
    assert(icd_block_bitmap(link, 0xFFFFFFFFu) == CUBEACP_BLOCK_BITMAP_BYTES);
    free(map);
    return 0;
}
"""


OFFSETS = r"""
#include "cubeacp.h"
#include <assert.h>

static void on_block(void *context, uint32_t offset, const uint8_t *data, size_t length)
{
    (void)context, (void)offset, (void)data, (void)length;
}

/* Load a block at an offset; the device says that it has so many bytes. */
static icd_result_t load(uint32_t offset, uint32_t length)
{
    static uint8_t buffer[CUBEACP_BLOCK_BYTES], bitmap[CUBEACP_BLOCK_BITMAP_BYTES];
    uint8_t frame[ICD_STEP_BYTES] = {0};
    icd_link_t link = *cubeacp_link();
    icd_download_form_t form = *link.download;
    icd_download_t download;
    icd_request_t request;
    icd_event_t event = {ICD_EVENT_DONE};
    form.max_bytes = 0xFFFFFFFEu;
    link.download = &form;
    assert(
        icd_download_init(
            &download, &link, ICD_BUS_UART, 2, 0, ICD_SIZE_UNKNOWN, 0, buffer, sizeof buffer, bitmap, sizeof bitmap,
            on_block, NULL) == ICD_OK);
    download.offset = offset;
    assert(icd_procedure_next(&download.procedure, 0, &request));
    assert(icdgen_get(&link, &form.load, request.data, ICD_ROLE_OFFSET) == offset);
    icd_procedure_event(&download.procedure, 1, &event);
    assert(icd_procedure_next(&download.procedure, 1, &request));
    icdgen_put(&link, &form.ready, frame, ICD_ROLE_READY, 1);
    icdgen_put(&link, &form.ready, frame, ICD_ROLE_LENGTH, length);
    event.data = frame;
    event.length = form.ready.length;
    icd_procedure_event(&download.procedure, 2, &event);
    return download.procedure.result;
}

int main(void)
{
    assert(load(0xFFFFFFFEu - 100u, 100) == ICD_RUNNING);
    assert(load(0xFFFFFFFEu - 100u, 101) == ICD_LIMIT);
    assert(load(0xFFFFFFFEu - 100u, 20480) == ICD_LIMIT);
    assert(load(0xFFFFFFFEu, 1) == ICD_LIMIT);
    return 0;
}
"""


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


def test_packets_beyond_a_map_and_links_without_files_are_refused(headers, tmp_path):
    run(MAPS, headers, tmp_path)


def test_a_download_near_4_gib_ends_at_the_limit_of_the_icd(headers, tmp_path):
    run(OFFSETS, headers, tmp_path)
