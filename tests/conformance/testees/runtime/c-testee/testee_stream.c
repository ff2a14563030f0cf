/* Requests about messages in an envelope. */

#include "testee_wire.h"

#include <stdlib.h>

static const char *const roles[ICD_ENVELOPE_VALUES] = {"sequence", "source", "destination", "type", "flags", "time"};

static icd_direction_t next_direction(void)
{
    return next_number() == 0u ? ICD_TELECOMMAND : ICD_TELEMETRY;
}

/* The field that does not hold its value. */
static void refuse_range(const icd_link_t *link, const icd_envelope_values_t *values)
{
    for (size_t i = 0; i < link->stream->field_count; ++i) {
        const icd_envelope_field_t *field = &link->stream->fields[i];
        if (field->role < ICD_ENVELOPE_CONSTANT && ((uint64_t)values->of[field->role] >> field->bits) != 0u) {
            refuse("range");
            put_text("field", roles[field->role]);
            return;
        }
    }
    refuse_status(ICD_ERROR_RANGE);
}

static void refuse_data(const icd_link_t *link, icd_direction_t direction, uint32_t id, size_t length)
{
    for (size_t i = 0; i < link->stream->row_counts[direction]; ++i) {
        const icd_stream_row_t *row = &link->stream->rows[direction][i];
        if (row->id == id) {
            refuse_length("length", length > row->most ? row->most : row->least, length);
        }
    }
}

static void stream_encode(void)
{
    const icd_link_t *link = next_link();
    const icd_direction_t direction = next_direction();
    const uint32_t id = next_number();
    const octets_t data = next_octets();
    const size_t capacity = 2u * data.length + 300u;
    uint8_t *line = memory(capacity);
    size_t written = 0;
    icd_envelope_values_t values = icd_envelope_values(link, direction);
    for (size_t i = 0; i < ICD_ENVELOPE_VALUES; ++i) {
        values.of[i] = next_or(values.of[i]);
    }
    const icd_status_t status =
        icd_stream_encode(link, direction, id, data.data, data.length, &values, line, capacity, &written);
    if (status == ICD_ERROR_RANGE) {
        refuse_range(link, &values);
    } else if (status == ICD_ERROR_LENGTH) {
        refuse_data(link, direction, id, data.length);
    } else if (answers(status)) {
        uint8_t *exact = memory(written);
        size_t again = 0;
        put_octets("bytes", line, written);
        if (icd_stream_encode(link, direction, id, data.data, data.length, &values, exact, written, &again) != ICD_OK ||
            again != written ||
            (written != 0u && icd_stream_encode(link, direction, id, data.data, data.length, &values, exact,
                                                written - 1u, &again) != ICD_ERROR_LENGTH)) {
            refuse("room"); /* it takes just as many bytes as it says */
        }
    }
}

static void on_stream_event(void *context, const icd_stream_event_t *event)
{
    static const char *const names[] = {"message", "gap", "checksum", "length", "unknown_id", "overrun", "framing"};
    const icd_link_t *link = context;
    put_row(names[event->kind]);
    if (event->has_id) {
        put_number("id", event->id);
    }
    if (event->kind == ICD_STREAM_GAP) {
        put_number("missing", event->missing);
    }
    if (event->kind == ICD_STREAM_MESSAGE) {
        put_octets("bytes", event->data, event->length);
        for (size_t i = 0; i < link->stream->field_count; ++i) {
            const icd_envelope_role_t role = link->stream->fields[i].role;
            if (role < ICD_ENVELOPE_CONSTANT) {
                put_number(roles[role], event->values.of[role]);
            }
        }
    }
}

static void stream_events(void)
{
    const icd_link_t *link = next_link();
    const icd_direction_t direction = next_direction();
    const size_t limit = next_number();
    size_t count = 0;
    icd_stream_decoder_t decoder;
    if (link != NULL && link->stream != NULL) {
        count = link->stream->row_counts[direction] + 1u;
    }
    uint32_t *sequences = memory(count * sizeof *sequences);
    if (link == NULL) {
        refuse_status(ICD_ERROR_UNSUPPORTED);
        return;
    }
    const icd_status_t status =
        icd_stream_decoder_init(&decoder, link, direction, memory(limit), limit, sequences, count);
    if (status != ICD_OK) {
        refuse_status(status);
        return;
    }
    put_row("ok");
    union {
        const icd_link_t *link;
        void *context;
    } to = {link};
    while (has_words()) {
        const octets_t chunk = next_octets();
        icd_stream_feed(&decoder, chunk.data, chunk.length, on_stream_event, to.context);
    }
    put_row("ok");
    put_number("discarded", decoder.discarded);
    put_number("pending", decoder.pending);
}

const testee_op_t testee_stream_ops[] = {
    {"stream_encode", stream_encode},
    {"stream_events", stream_events},
    {NULL, NULL},
};
