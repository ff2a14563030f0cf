/* Logs. */

#include "testee_wire.h"

/* ---- logs ------------------------------------------------------------------------------------------------------------ */

static void put_frames(json_out_t *out, const icd_link_t *link, const uint8_t *mask, const uint8_t *slots)
{
    icd_log_frames_t frames;
    icd_log_frame_t frame;
    bool first = true;
    icd_log_frames(&frames, link, mask, slots);
    json_put_text(out, ",\"frames\":[");
    while (icd_log_next(&frames, &frame)) {
        json_put_text(out, first ? "{\"bit\":" : ",{\"bit\":");
        json_put_unsigned(out, frame.bit);
        put_key_or_null(out, "id", frame.id);
        put_key_octets(out, "bytes", frame.data, frame.length);
        json_put_text(out, "}");
        first = false;
    }
    json_put_text(out, "]");
}

typedef struct {
    const icd_link_t *link;
    json_out_t *out;
} entries_t;

static void on_entry(void *context, const icd_log_entry_t *entry)
{
    const entries_t *entries = (const entries_t *)context;
    json_put_text(entries->out, "{\"seconds\":");
    json_put_unsigned(entries->out, entry->seconds);
    put_key_number(entries->out, "milliseconds", entry->milliseconds);
    put_frames(entries->out, entries->link, entry->mask, entry->slots);
    json_put_text(entries->out, "},");
}

void log_decode(talk_t *talk, const icd_link_t *link)
{
    static json_out_t found;
    icd_log_reader_t reader;
    entries_t entries;
    octets_t octets;
    size_t size, at, step;
    if (!ask_octets(talk, 0, "bytes", &octets)) {
        return;
    }
    size = link->log_file != NULL && link->log_mask != NULL ? icd_log_bytes(link) : 0u;
    if (icd_log_reader_init(&reader, link, (uint8_t *)memory(size), size) != ICD_OK) {
        (void)refuse(talk, "unsupported");
        return;
    }
    found.length = 0;
    entries.link = link;
    entries.out = &found;
    for (at = 0, step = 1; at < octets.length; at += step, step = (step * 5u) % 97u + 1u) { /* pieces of any size */
        step = step < octets.length - at ? step : octets.length - at;
        icd_log_feed(&reader, octets.data + at, step, on_entry, &entries);
    }
    put_ok(talk);
    if (reader.has_mask) {
        put_key_octets(&talk->out, "mask", reader.buffer, link->log_mask->size);
    } else {
        json_put_text(&talk->out, ",\"mask\":null");
    }
    put_list(&talk->out, "entries", &found);
    put_key_number(&talk->out, "truncated", (int64_t)reader.length);
}

static bool ask_frames(talk_t *talk, size_t object, icd_bytes_t **frames, size_t *count)
{
    size_t list, at, i;
    if (!ask_rows(talk, object, "frames", &list)) {
        return false;
    }
    *count = talk->row.values[list].count;
    *frames = (icd_bytes_t *)memory(*count * sizeof **frames);
    for (i = 0, at = list + 1u; i < *count; i++, at = talk->row.values[at].after) {
        octets_t octets;
        if (!octets_of(talk, at, &octets)) {
            return false;
        }
        (*frames)[i].data = octets.data;
        (*frames)[i].length = octets.length;
    }
    return true;
}

/* Tells which frame has the wrong length, or that there are too many or too few. */
static void refuse_frames(
    talk_t *talk, const icd_link_t *link, const uint8_t *mask, const icd_bytes_t *given, size_t count)
{
    icd_log_frames_t frames;
    icd_log_frame_t frame;
    size_t i;
    if (count != icd_log_count(link, mask)) {
        (void)refuse_length(talk, "length", icd_log_count(link, mask), count);
        return;
    }
    icd_log_frames(&frames, link, mask, NULL);
    for (i = 0; icd_log_next(&frames, &frame); i++) {
        if (given[i].length != frame.length) {
            (void)refuse_length(talk, "length", frame.length, given[i].length);
            return;
        }
    }
}

typedef struct {
    uint32_t seconds;
    uint32_t milliseconds;
    icd_bytes_t *frames;
    size_t count;
} given_entry_t;

void log_encode(talk_t *talk, const icd_link_t *link)
{
    static json_out_t file;
    octets_t mask;
    given_entry_t *given;
    size_t list, at, i, count, size, written = 0;
    uint8_t *buffer;
    icd_status_t status;
    if (!ask_mappings(talk, 0, "entries", &list)) {
        return;
    }
    count = talk->row.values[list].count;
    given = (given_entry_t *)memory(count * sizeof *given);
    for (i = 0, at = list + 1u; i < count; i++, at = talk->row.values[at].after) {
        if (!ask_number(talk, at, "seconds", 0, MOST_NUMBER, REQUIRED, &given[i].seconds) ||
            !ask_number(talk, at, "milliseconds", 0, 65535, REQUIRED, &given[i].milliseconds) ||
            !ask_frames(talk, at, &given[i].frames, &given[i].count)) {
            return;
        }
    }
    if (!ask_octets(talk, 0, "mask", &mask)) {
        return;
    }
    size = link->log_file != NULL && link->log_mask != NULL ? icd_log_bytes(link) : 0u;
    buffer = (uint8_t *)memory(size);
    status = icd_log_write_header(link, mask.data, mask.length, buffer, size, &written);
    if (status == ICD_ERROR_LENGTH) {
        (void)refuse_length(talk, "length", link->log_mask->size, mask.length);
        return;
    }
    file.length = 0;
    for (i = 0; status == ICD_OK; i++) {
        size_t byte;
        for (byte = 0; byte < written; byte++) {
            json_put_hex(&file, buffer[byte], 2);
        }
        if (i == count) {
            put_ok(talk);
            json_put_text(&talk->out, ",\"bytes\":\"");
            json_put(&talk->out, file.length != 0u ? file.at : "", file.length);
            json_put_text(&talk->out, "\"");
            return;
        }
        status = icd_log_write_entry(
            link, mask.data, given[i].seconds, given[i].milliseconds, given[i].frames, given[i].count, buffer, size,
            &written);
        if (status == ICD_ERROR_LENGTH) {
            refuse_frames(talk, link, mask.data, given[i].frames, given[i].count);
            return;
        }
    }
    (void)refuse_status(talk, status);
}

void log_message_decode(talk_t *talk, const icd_link_t *link)
{
    octets_t octets;
    icd_log_message_t log;
    icd_status_t status;
    if (!ask_octets(talk, 0, "bytes", &octets)) {
        return;
    }
    status = icd_log_message_decode(link, octets.data, octets.length, &log);
    if (status == ICD_ERROR_LENGTH) {
        (void)refuse_length(
            talk, "length", icd_log_message_length(link, octets.data, octets.length), octets.length);
        return;
    }
    if (status != ICD_OK) {
        (void)refuse_status(talk, status);
        return;
    }
    put_ok(talk);
    put_key_octets(&talk->out, "mask", log.mask, link->log_mask->size);
    put_frames(&talk->out, link, log.mask, log.slots);
}

void log_message_encode(talk_t *talk, const icd_link_t *link)
{
    octets_t mask;
    icd_bytes_t *frames;
    size_t count, size, written = 0;
    uint8_t *buffer;
    icd_status_t status;
    if (!ask_frames(talk, 0, &frames, &count) || !ask_octets(talk, 0, "mask", &mask)) {
        return;
    }
    size = link->longest;
    buffer = (uint8_t *)memory(size);
    status = icd_log_message_encode(link, mask.data, mask.length, frames, count, buffer, size, &written);
    if (status == ICD_ERROR_LENGTH && mask.length != link->log_mask->size) {
        (void)refuse_length(talk, "length", link->log_mask->size, mask.length);
    } else if (status == ICD_ERROR_LENGTH) {
        refuse_frames(talk, link, mask.data, frames, count);
    } else if (status != ICD_OK) {
        (void)refuse_status(talk, status);
    } else {
        put_ok(talk);
        put_key_octets(&talk->out, "bytes", buffer, written);
    }
}
