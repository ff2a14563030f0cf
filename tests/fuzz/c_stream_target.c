/* libFuzzer harness on the decoders of framed links. See README.md. */

#include "testee.h"

#include <icdgen_wire.h>
#include <stdlib.h>

const icd_link_t *testee_link(size_t node);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool holds)
{
    if (!holds) {
        abort();
    }
}

/* Memory of just that size, so that touching anything beyond it is noticed. */
static void *memory(size_t size)
{
    void *found = malloc(size != 0u ? size : 1u);
    require(found != NULL);
    return found;
}

/* What the events of a run say. */
typedef struct {
    const icd_link_t *link;
    icd_direction_t direction;
    uint32_t digest;
    size_t on_line; /* bytes that the messages take, sent again */
} seen_t;

static void note(seen_t *seen, const void *data, size_t length)
{
    const uint8_t *bytes = (const uint8_t *)data;
    size_t i;
    for (i = 0; i < length; i++) {
        seen->digest = (seen->digest ^ bytes[i]) * 16777619u;
    }
}

/* Responds to an event in every way, with buffers of any size. */
static void respond(const seen_t *seen, const icd_event_t *event)
{
    static const icd_verdict_t verdicts[] = {
        ICD_VERDICT_ACK, ICD_VERDICT_REPLY, ICD_VERDICT_NAK, ICD_VERDICT_BUSY, ICD_VERDICT_PROGRESS, ICD_VERDICT_AGAIN,
    };
    const size_t longest = seen->link->longest;
    const size_t capacity = seen->digest % (longest + 1u);
    const size_t room = (seen->digest >> 8) % (2u * longest + 600u);
    uint8_t *line = (uint8_t *)memory(room);
    icd_stream_sender_t sender;
    size_t i;
    require(icd_stream_sender_init(&sender, seen->link, ICD_TELEMETRY, NULL, 0) == ICD_OK);
    for (i = 0; i < sizeof verdicts / sizeof verdicts[0]; i++) {
        icd_answer_t answer = {verdicts[i], (seen->digest & 1u) != 0u, seen->digest >> 20, NULL, 0, capacity};
        size_t written = 0;
        answer.data = (uint8_t *)memory(capacity);
        memset(answer.data, 0x5A, capacity);
        answer.length = (seen->digest >> 4) % (capacity + 1u);
        if (icd_stream_respond(&sender, event, &answer, line, room, &written) == ICD_OK) {
            require(written <= room);
        }
        free(answer.data);
    }
    free(line);
}

static void on_event(void *context, const icd_event_t *event)
{
    seen_t *seen = (seen_t *)context;
    const uint32_t told[3] = {(uint32_t)event->kind, event->has_id ? event->id : 0u, event->missing};
    note(seen, told, sizeof told);
    note(seen, event->data, event->length);
    if (seen->direction == ICD_TELECOMMAND) {
        respond(seen, event);
    }
    if (event->kind == ICD_EVENT_MESSAGE) {
        const size_t room = 2u * (event->length + 600u);
        uint8_t *line = (uint8_t *)memory(room);
        size_t written = 0;
        note(seen, &event->values, sizeof event->values);
        require(icd_stream_encode(
                    seen->link, seen->direction, event->id, event->data, event->length, &event->values, line, room,
                    &written) == ICD_OK);
        seen->on_line += written;
        free(line);
    }
    if (event->kind == ICD_EVENT_REQUEST) {
        uint8_t line[600];
        size_t written = 0;
        note(seen, &event->values, sizeof event->values);
        require(icd_stream_encode_request(seen->link, event->id, &event->values, line, sizeof line, &written) == ICD_OK);
        seen->on_line += written;
    }
    if (event->kind == ICD_EVENT_PACKET) { /* all its bytes */
        note(seen, &event->values, sizeof event->values);
        seen->on_line += event->length;
    }
}

/* Feeds all in pieces of a size that `cut` says, or at once if it is 0. */
static seen_t fed(const icd_link_t *link, icd_direction_t direction, const uint8_t *stream, size_t size, uint8_t room, uint8_t cut)
{
    const size_t limit = link->longest - (room < link->longest ? room : 0u);
    const size_t count = room % 3u;
    uint8_t *buffer = (uint8_t *)memory(limit);
    uint32_t *sequences = (uint32_t *)memory(count * sizeof *sequences);
    seen_t seen = {link, direction, 1, 0};
    icd_stream_decoder_t decoder;
    size_t at, step = cut == 0u ? size : cut;
    if (icd_stream_decoder_init(&decoder, link, direction, buffer, limit, sequences, count) == ICD_OK) {
        for (at = 0; at < size; at += step, step = cut == 0u ? size : ((step * cut) % 23u) + 1u) {
            step = step < size - at ? step : size - at;
            icd_stream_feed(&decoder, stream + at, step, on_event, &seen);
        }
        require(decoder.pending + decoder.discarded <= size);
        require(decoder.length <= limit && decoder.pending <= size);
        if (link->stream->delimited_by == ICD_DELIMITED_BY_LENGTH) {
            require(decoder.pending + decoder.discarded + seen.on_line == size);
        }
    }
    free(sequences);
    free(buffer);
    return seen;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const icd_link_t *link = size < 4u ? NULL : testee_link(data[0] % testee_node_count);
    if (link != NULL && link->stream != NULL) {
        const icd_direction_t direction = (data[1] & 1u) != 0u ? ICD_TELEMETRY : ICD_TELECOMMAND;
        uint8_t *stream = (uint8_t *)memory(size - 4u);
        seen_t whole, pieces;
        memcpy(stream, data + 4, size - 4u);
        whole = fed(link, direction, stream, size - 4u, data[2], 0);
        if (link->stream->delimited_by != ICD_DELIMITED_BY_DATAGRAM) {
            pieces = fed(link, direction, stream, size - 4u, data[2], (uint8_t)(data[3] | 1u));
            require(whole.digest == pieces.digest && whole.on_line == pieces.on_line);
        }
        free(stream);
    }
    return 0;
}
