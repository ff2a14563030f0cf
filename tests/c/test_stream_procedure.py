"""Procedures in C run over the client of a framed link.

The test uploads a program to the bootloader of `examples/links`, over a line that loses
every fifth telecommand.
"""

from __future__ import annotations

from tests.c.test_stream_client import EXAMPLES, run

PROGRAM = r"""
#include "loader.h"
#include <assert.h>
#include <stdio.h>

static loader_client_t client;
static icd_procedure_t procedure;
static uint32_t now;

/* ---- the device -------------------------------------------------------------------------------------------------- */

static uint8_t flash[4096], block[1024];
static size_t block_length, flash_length, count;
static bool is_started;
static uint8_t line[LOADER_LINE_BYTES];
static size_t line_length;
static uint8_t area;

static void answer(uint32_t id, const uint8_t *data, size_t length)
{
    assert(
        icd_stream_encode(
            loader_link(), ICD_TELEMETRY, id, data, length, NULL, line, sizeof line, &line_length) == ICD_OK);
}

static void answer_checksum(uint32_t id, const uint8_t *bytes, size_t length)
{
    loader_block_checksum_t sum;
    uint8_t data[LOADER_BLOCK_CHECKSUM_LENGTH];
    sum.checksum = icd_checksum(loader_crc32_checksum(), bytes, length);
    assert(loader_block_checksum_encode(&sum, data, sizeof data) == ICD_OK);
    answer(id, data, sizeof data);
}

static void on_telecommand(void *context, const icd_event_t *event)
{
    const uint8_t response[] = {(uint8_t)event->id, 0}, ready[] = {0};
    loader_write_t message;
    loader_select_block_t selected;
    (void)context;
    count++;
    if (event->kind != ICD_EVENT_MESSAGE || count % 5u == 0u) {
        return;
    }
    if (loader_write_decode(&message, event->data, event->length) == ICD_OK) {
        assert(message.area == area && message.offset % 128u == 0u && message.offset < sizeof flash);
        memcpy(flash + message.offset, message.data, sizeof message.data);
    } else if (loader_select_block_decode(&selected, event->data, event->length) == ICD_OK) {
        block_length = selected.length;
        flash_length = selected.offset + block_length;
        memcpy(block, flash + selected.offset, block_length);
    } else {
        area = event->length == 1u ? event->data[0] : area;
    }
    is_started = is_started || event->id == LOADER_START_ID;
    if (event->id == LOADER_GET_STATUS_ID) {
        answer(LOADER_STATUS_ID, ready, sizeof ready);
    } else if (event->id == LOADER_GET_BLOCK_CHECKSUM_ID) {
        answer_checksum(LOADER_BLOCK_CHECKSUM_ID, block, block_length);
    } else if (event->id == LOADER_GET_IMAGE_CHECKSUM_ID) {
        answer_checksum(LOADER_IMAGE_CHECKSUM_ID, flash, flash_length);
    } else {
        answer(LOADER_RESPONSE_ID, response, sizeof response);
    }
}

/* ---- the client -------------------------------------------------------------------------------------------------- */

static void on_event(void *context, const icd_event_t *event)
{
    icd_procedure_event((icd_procedure_t *)context, now, event);
}

int main(void)
{
    static uint8_t image[2500], bitmap[LOADER_UPLOAD_BITMAP_BYTES];
    static uint8_t buffer[LOADER_CLIENT_BYTES], received[LOADER_LONGEST];
    icd_slot_t slots[1];
    icd_stream_decoder_t device;
    uint32_t until, total = 0;
    for (size_t i = 0; i < sizeof image; ++i) {
        image[i] = (uint8_t)(i * 7u);
    }
    assert(loader_client_init(&client, slots, 1, buffer, sizeof buffer) == ICD_OK);
    assert(
        icd_stream_decoder_init(
            &device, loader_link(), ICD_TELECOMMAND, received, sizeof received, NULL, 0) == ICD_OK);
    assert(loader_upload(&procedure, LOADER_AREA_BACKUP, image, sizeof image, 0, bitmap, sizeof bitmap) == ICD_OK);
    while (procedure.result == ICD_RUNNING) {
        uint8_t out[LOADER_LINE_BYTES];
        size_t written;
        assert(icd_procedure_step(&procedure, &client.client, now) == ICD_OK);
        while (icd_client_output(&client.client, out, sizeof out, &written)) {
            icd_stream_feed(&device, out, written, on_telecommand, NULL);
        }
        if (line_length != 0u) {
            const size_t length = line_length;
            line_length = 0;
            icd_client_received(&client.client, now, line, length, on_event, &procedure);
        } else if (icd_client_deadline(&client.client, &until) || icd_procedure_deadline(&procedure, &until)) {
            now = until;
            icd_client_tick(&client.client, now, on_event, &procedure);
        } else {
            /* the next request is ready */
        }
    }
    assert(procedure.result == ICD_DONE && is_started && area == LOADER_AREA_BACKUP);
    assert(icd_procedure_progress(&procedure, &total) == sizeof image && total == sizeof image);
    assert(memcmp(flash, image, sizeof image) == 0 && flash[sizeof image] == 0xFFu);
    return 0;
}
"""


def test_an_upload_runs_over_the_client_of_a_framed_link(tmp_path):
    run(tmp_path, PROGRAM, EXAMPLES / "bootloader.yaml")
