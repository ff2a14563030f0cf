/* Logs. */

#include "testee_wire.h"

static void put_frames(const icd_link_t *link, const uint8_t *mask, const uint8_t *slots)
{
    icd_log_frames_t frames;
    icd_log_frame_t frame;
    icd_log_frames(&frames, link, mask, slots);
    while (icd_log_next(&frames, &frame)) {
        put_row("frame");
        put_number("bit", frame.bit);
        if (frame.id >= 0) {
            put_signed("id", frame.id);
        } else {
            put_word("id", "");
        }
        put_octets("bytes", frame.data, frame.length);
    }
}

static void on_entry(void *context, const icd_log_entry_t *entry)
{
    put_row("entry");
    put_number("seconds", entry->seconds);
    put_number("milliseconds", entry->milliseconds);
    put_frames((const icd_link_t *)context, entry->mask, entry->slots);
}

/* Bytes that a file's largest piece needs. */
static size_t log_bytes(const icd_link_t *link)
{
    return link->log_file != NULL && link->log_mask != NULL ? icd_log_bytes(link) : 0u;
}

static void log_decode(void)
{
    icd_link_t link = *next_link();
    const size_t size = log_bytes(&link);
    icd_log_reader_t reader;
    if (!answers(icd_log_reader_init(&reader, &link, (uint8_t *)memory(size), size))) {
        return;
    }
    while (has_words()) {
        const octets_t piece = next_octets();
        icd_log_feed(&reader, piece.data, piece.length, on_entry, &link);
    }
    put_row("ok");
    put_number("truncated", reader.length);
    if (reader.has_mask) {
        put_octets("mask", reader.buffer, link.log_mask->size);
    }
}

static icd_bytes_t *next_frames(size_t count)
{
    icd_bytes_t *frames = (icd_bytes_t *)memory(count * sizeof *frames);
    size_t i;
    for (i = 0; i < count; i++) {
        const octets_t octets = next_octets();
        frames[i].data = octets.data;
        frames[i].length = octets.length;
    }
    return frames;
}

/* Tells which frame has the wrong length, or that there are too many or too few. */
static void refuse_frames(const icd_link_t *link, octets_t mask, const icd_bytes_t *given, size_t count)
{
    icd_log_frames_t frames;
    icd_log_frame_t frame;
    size_t i;
    if (mask.length != link->log_mask->size) {
        refuse_length("length", link->log_mask->size, mask.length);
        return;
    }
    refuse_length("length", icd_log_count(link, mask.data), count);
    icd_log_frames(&frames, link, mask.data, NULL);
    for (i = 0; count == icd_log_count(link, mask.data) && icd_log_next(&frames, &frame); i++) {
        if (given[i].length != frame.length) {
            refuse_length("length", frame.length, given[i].length);
            return;
        }
    }
}

static void log_encode(void)
{
    const icd_link_t *link = next_link();
    const octets_t mask = next_octets();
    const size_t size = log_bytes(link);
    uint8_t *buffer = (uint8_t *)memory(size);
    icd_bytes_t *frames = NULL;
    size_t count = 0, written = 0;
    icd_status_t status = icd_log_write_header(link, mask.data, mask.length, buffer, size, &written);
    if (status == ICD_OK) {
        put_row("ok");
        put_list("bytes");
        put_octets_item(buffer, written);
    }
    while (status == ICD_OK && has_words()) {
        const uint32_t seconds = next_number(), milliseconds = next_number();
        count = next_number();
        frames = next_frames(count);
        status = icd_log_write_entry(link, mask.data, seconds, milliseconds, frames, count, buffer, size, &written);
        if (status == ICD_OK) {
            put_octets_item(buffer, written);
        }
    }
    if (status == ICD_ERROR_LENGTH) {
        refuse_frames(link, mask, frames, count);
    } else if (status != ICD_OK) {
        refuse_status(status);
    }
}

static void log_message_decode(void)
{
    const icd_link_t *link = next_link();
    const octets_t octets = next_octets();
    icd_log_message_t log;
    const icd_status_t status = icd_log_message_decode(link, octets.data, octets.length, &log);
    if (status == ICD_ERROR_LENGTH) {
        refuse_length("length", icd_log_message_length(link, octets.data, octets.length), octets.length);
    } else if (answers(status)) {
        put_octets("mask", log.mask, link->log_mask->size);
        put_frames(link, log.mask, log.slots);
    }
}

static void log_message_encode(void)
{
    const icd_link_t *link = next_link();
    const octets_t mask = next_octets();
    const size_t count = next_number(), size = link->longest;
    const icd_bytes_t *frames = next_frames(count);
    uint8_t *buffer = (uint8_t *)memory(size);
    size_t written = 0;
    const icd_status_t status =
        icd_log_message_encode(link, mask.data, mask.length, frames, count, buffer, size, &written);
    if (status == ICD_ERROR_LENGTH) {
        refuse_frames(link, mask, frames, count);
    } else if (answers(status)) {
        put_octets("bytes", buffer, written);
    }
}

const testee_op_t testee_log_ops[] = {
    {"log_decode", log_decode},
    {"log_encode", log_encode},
    {"log_message_decode", log_message_decode},
    {"log_message_encode", log_message_encode},
    {NULL, NULL},
};
