/* Requests about messages of a framed link. */

#include "testee_wire.h"

#include <stdlib.h>

static const char *const roles[ICD_HEADER_VALUES] = {
    "sequence", "source", "destination", "type", "flags", "time", "status", "reason",
};

static icd_direction_t next_direction(void)
{
    return next_number() == 0u ? ICD_TELECOMMAND : ICD_TELEMETRY;
}

/* The bits of the id in all its fields. */
static unsigned id_bits(const icd_packet_form_t *packet)
{
    unsigned bits = 0;
    for (size_t i = 0; i < packet->field_count; ++i) {
        bits += packet->fields[i].role == ICD_FIELD_ID ? packet->fields[i].bits : 0u;
    }
    return bits;
}

/* The field that does not hold its value. */
static void refuse_range(const icd_packet_form_t *packet, uint32_t id, const icd_header_values_t *values)
{
    for (size_t i = 0; i < packet->field_count; ++i) {
        const icd_packet_field_t *field = &packet->fields[i];
        if (field->role == ICD_FIELD_ID && field->values[0] + field->bits == id_bits(packet) &&
            ((uint64_t)id >> id_bits(packet)) != 0u) {
            refuse("range");
            put_text("field", "id");
            return;
        }
        if (field->role < ICD_FIELD_CONSTANT && values->of[field->role] != ICD_HEADER_DEFAULT &&
            ((uint64_t)values->of[field->role] >> field->bits) != 0u) {
            refuse("range");
            put_text("field", roles[field->role]);
            return;
        }
    }
    refuse_status(ICD_ERROR_RANGE);
}

/* The message with this id, NULL if there is none. */
static const icd_stream_row_t *row_of(const icd_link_t *link, icd_direction_t direction, uint32_t id)
{
    for (size_t i = 0; i < link->stream->row_counts[direction]; ++i) {
        const icd_stream_row_t *row = &link->stream->rows[direction][i];
        if (row->id == id) {
            return row;
        }
    }
    return NULL;
}

/* The length that is nearest. */
static size_t nearest(const icd_link_t *link, icd_direction_t direction, uint32_t id, size_t length)
{
    const icd_stream_row_t *row = row_of(link, direction, id);
    return row == NULL ? length : length > row->most ? row->most : row->least;
}

/* Encodes a message, or the packet that requests telemetry. */
static icd_status_t stream_line(
    const icd_link_t *link,
    bool requests,
    icd_direction_t direction,
    uint32_t id,
    octets_t data,
    const icd_header_values_t *values,
    uint8_t *line,
    size_t capacity,
    size_t *written)
{
    return requests ? icd_stream_encode_request(link, id, values, line, capacity, written)
                    : icd_stream_encode(link, direction, id, data.data, data.length, values, line, capacity, written);
}

static icd_header_values_t next_values(const icd_link_t *link, icd_direction_t direction)
{
    icd_header_values_t values = icd_header_values(link, direction);
    for (size_t i = 0; i < ICD_HEADER_VALUES; ++i) {
        values.of[i] = next_or(values.of[i]);
    }
    return values;
}

static void stream_encode(void)
{
    const icd_link_t *link = next_link();
    const uint32_t kind = next_number();
    const bool requests = kind == 2u;
    const icd_direction_t direction = kind == 1u ? ICD_TELEMETRY : ICD_TELECOMMAND;
    const uint32_t id = next_number();
    const octets_t data = next_octets();
    const size_t capacity = 2u * data.length + 300u;
    uint8_t *line = memory(capacity);
    size_t written = 0;
    const icd_header_values_t values = next_values(link, direction);
    const icd_status_t status = stream_line(link, requests, direction, id, data, &values, line, capacity, &written);
    if (status == ICD_ERROR_RANGE) {
        const size_t packet = requests ? link->stream->request->packet : row_of(link, direction, id)->packet;
        refuse_range(&link->stream->packets[packet], id, &values);
    } else if (status == ICD_ERROR_LENGTH) {
        refuse_length("length", nearest(link, direction, id, data.length), data.length);
    } else if (answers(status)) {
        uint8_t *exact = memory(written);
        size_t again = 0;
        put_octets("bytes", line, written);
        if (stream_line(link, requests, direction, id, data, &values, exact, written, &again) != ICD_OK ||
            again != written ||
            (written != 0u &&
             stream_line(link, requests, direction, id, data, &values, exact, written - 1u, &again) !=
                 ICD_ERROR_LENGTH)) {
            refuse("room"); /* it takes just as many bytes as it says */
        }
    }
}

static void stream_encode_packet(void)
{
    const icd_link_t *link = next_link();
    const icd_direction_t direction = next_direction();
    const uint32_t packet = next_number();
    const uint32_t id = next_number();
    const icd_header_values_t values = next_values(link, direction);
    size_t written = 0;
    const size_t capacity =
        300u + (packet < link->stream->packet_count ? 2u * link->stream->packets[packet].reserved : 0u);
    uint8_t *line = memory(capacity);
    const icd_status_t status =
        icd_stream_encode_packet(link, direction, packet, id, &values, line, capacity, &written);
    if (status == ICD_ERROR_RANGE) {
        if (packet >= link->stream->packet_count || link->stream->packets[packet].content != ICD_PACKET_NOTHING ||
            !link->stream->packets[packet].is_sent[direction]) {
            refuse("range");
            put_text("field", "packet");
        } else {
            refuse_range(&link->stream->packets[packet], id, &values);
        }
    } else if (answers(status)) {
        uint8_t *exact = memory(written);
        size_t again = 0;
        put_octets("bytes", line, written);
        if (icd_stream_encode_packet(link, direction, packet, id, &values, exact, written, &again) != ICD_OK ||
            again != written ||
            icd_stream_encode_packet(link, direction, packet, id, &values, exact, written - 1u, &again) !=
                ICD_ERROR_LENGTH) {
            refuse("room"); /* it takes just as many bytes as it says */
        }
    }
}

static void on_stream_event(void *context, const icd_event_t *event)
{
    const icd_link_t *link = context;
    const icd_event_kind_t kind = event->kind;
    const bool has_code = kind == ICD_EVENT_REFUSED || kind == ICD_EVENT_BUSY;
    const bool is_message = kind == ICD_EVENT_MESSAGE || kind == ICD_EVENT_ARRIVED;
    put_row(kind == ICD_EVENT_ARRIVED ? "message" : event_name(kind));
    if (kind == ICD_EVENT_PACKET) {
        put_number("packet", event->packet);
    }
    if (event->has_id) {
        put_number("id", event->id);
    }
    if (kind == ICD_EVENT_DONE || kind == ICD_EVENT_TIMEOUT || kind == ICD_EVENT_SENT || has_code) {
        put_number("attempts", event->attempts);
    }
    if (has_code && event->has_code) {
        put_number("code", event->code);
    }
    if ((kind == ICD_EVENT_DONE || kind == ICD_EVENT_REPLY) && event->has_reply) {
        put_number("reply", event->reply);
    }
    if (is_message || kind == ICD_EVENT_DONE || kind == ICD_EVENT_PROGRESS || kind == ICD_EVENT_REPLY ||
        kind == ICD_EVENT_LATE || kind == ICD_EVENT_STRAY || kind == ICD_EVENT_PACKET) {
        put_octets("bytes", event->data, event->length);
    }
    if (kind == ICD_EVENT_GAP) {
        put_number("missing", event->missing);
    }
    if (is_message || kind == ICD_EVENT_REQUEST || kind == ICD_EVENT_PACKET) {
        const icd_packet_form_t *packet = &link->stream->packets[event->packet];
        for (size_t i = 0; i < packet->field_count; ++i) {
            const icd_field_role_t role = packet->fields[i].role;
            if (role < ICD_FIELD_CONSTANT) {
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

/* What a device answers. */
typedef struct {
    icd_stream_sender_t sender;
    icd_answer_t answer;
    octets_t data;
} device_t;

static void respond(void *context, const icd_event_t *event)
{
    device_t *device = context;
    const icd_event_kind_t kind = event->kind;
    const bool is_answered = kind == ICD_EVENT_MESSAGE || kind == ICD_EVENT_REQUEST || kind == ICD_EVENT_UNKNOWN_ID ||
        kind == ICD_EVENT_LENGTH || kind == ICD_EVENT_CHECKSUM;
    if (!is_answered || !event->has_id) {
        return;
    }
    const size_t capacity = 2u * (size_t)device->sender.link->longest + 300u;
    uint8_t *line = memory(capacity);
    size_t written = 0;
    if (device->data.length != 0u) {
        memcpy(device->answer.data, device->data.data, device->data.length);
    }
    const icd_status_t status = icd_stream_respond(&device->sender, event, &device->answer, line, capacity, &written);
    put_row("response");
    if (status == ICD_OK) {
        put_octets("bytes", line, written);
    } else {
        put_word("error", status == ICD_ERROR_LENGTH ? "length" : status == ICD_ERROR_RANGE ? "range" : "unsupported");
    }
}

static void stream_respond(void)
{
    static const icd_verdict_t verdicts[] = {
        ICD_VERDICT_ACK, ICD_VERDICT_REPLY, ICD_VERDICT_NAK, ICD_VERDICT_BUSY, ICD_VERDICT_PROGRESS,
    };
    const icd_link_t *link = next_link();
    if (link == NULL || link->stream == NULL) {
        refuse_status(ICD_ERROR_UNSUPPORTED);
        return;
    }
    device_t device;
    memset(&device, 0, sizeof device);
    device.answer.verdict = verdicts[next_number()];
    device.answer.has_reason = next_number() != 0u;
    device.answer.reason = next_number();
    device.data = next_octets();
    device.answer.length = device.data.length;
    device.answer.capacity = device.data.length > link->longest ? device.data.length : link->longest;
    device.answer.data = memory(device.answer.capacity);
    const size_t sent = link->stream->row_counts[ICD_TELEMETRY] + 1u;
    const size_t received = link->stream->row_counts[ICD_TELECOMMAND] + 1u;
    icd_stream_decoder_t decoder;
    icd_stream_sender_init(&device.sender, link, ICD_TELEMETRY, memory(sent * sizeof(uint32_t)), sent);
    device.sender.values = next_values(link, ICD_TELEMETRY);
    icd_stream_decoder_init(
        &decoder, link, ICD_TELECOMMAND, memory(link->longest), link->longest, memory(received * sizeof(uint32_t)),
        received);
    put_row("ok");
    while (has_words()) {
        const octets_t chunk = next_octets();
        icd_stream_feed(&decoder, chunk.data, chunk.length, respond, &device);
    }
}

/* Room for requests, with just the memory that they need. */
static bool begin_stream_client(icd_client_t *client, icd_stream_line_t *line, const icd_link_t *link, size_t requests)
{
    const bool known = link != NULL && link->stream != NULL;
    const size_t size = known ? icd_client_bytes(link, requests) : 0u;
    const size_t count = known ? 2u * (link->stream->row_counts[0] + link->stream->row_counts[1] + 1u) : 0u;
    icd_slot_t *slots = memory(requests * sizeof *slots);
    uint32_t *sequences = memory(count * sizeof *sequences);
    return answers(
        link == NULL ? ICD_ERROR_UNSUPPORTED
                     : icd_client_stream(client, link, line, slots, requests, memory(size), size, sequences, count));
}

static void start_stream(icd_client_t *client, uint32_t now, icd_direction_t direction)
{
    icd_request_t request;
    memset(&request, 0, sizeof request);
    request.direction = direction;
    request.id = next_number();
    if (direction == ICD_TELECOMMAND) {
        request.repeat = next_number() != 0u;
        request.has_reply = next_number() != 0u;
        request.reply = next_or(0);
        const octets_t octets = next_octets();
        request.data = octets.data;
        request.length = octets.length;
    }
    const icd_status_t status = icd_client_start(client, now, &request);
    if (status == ICD_ERROR_LENGTH) {
        put_row("error");
        put_word("error", "length");
        put_number("expected", nearest(client->link, direction, request.id, request.length));
        put_number("actual", request.length);
    } else if (status != ICD_OK) {
        put_row("error");
        put_word(
            "error",
            status == ICD_ERROR_BUSY              ? "busy"
                : status == ICD_ERROR_UNSUPPORTED ? "unsupported"
                                                  : "unknown-id");
    }
}

static void happen_to_stream(icd_client_t *client, uint32_t now, const char *what, void *context)
{
    if (is_word(what, "telecommand")) {
        start_stream(client, now, ICD_TELECOMMAND);
    } else if (is_word(what, "telemetry")) {
        start_stream(client, now, ICD_TELEMETRY);
    } else if (is_word(what, "received")) {
        const octets_t octets = next_octets();
        icd_client_received(client, now, octets.data, octets.length, on_stream_event, context);
    } else if (is_word(what, "cancel")) {
        const char *kind = next_word();
        if (is_word(kind, "all")) {
            icd_client_cancel(client);
        } else {
            const icd_direction_t direction = is_word(kind, "telemetry") ? ICD_TELEMETRY : ICD_TELECOMMAND;
            icd_client_cancel_request(client, direction, next_number());
        }
    } else {
        icd_client_tick(client, now, on_stream_event, context);
    }
}

static void stream_client(void)
{
    union {
        const icd_link_t *link;
        void *context;
    } to = {next_link()};
    const size_t requests = next_number();
    icd_client_t *client = (icd_client_t *)memory(sizeof *client);
    uint32_t deadline;
    if (!begin_stream_client(client, (icd_stream_line_t *)memory(sizeof(icd_stream_line_t)), to.link, requests)) {
        return;
    }
    icd_client_settings_t *settings = &client->settings;
    settings->reply_timeout = next_or(settings->reply_timeout);
    settings->retries = (uint8_t)next_or(settings->retries);
    settings->late = next_or(settings->late);
    settings->busy_pause = next_or(settings->busy_pause);
    settings->gap = next_or(settings->gap);
    settings->in_flight = (uint8_t)next_or(settings->in_flight);
    settings->progress_for = next_or(settings->progress_for);
    while (has_words()) {
        const uint32_t now = next_number();
        const bool takes = next_number() != 0u;
        const size_t capacity = 2u * client->link->longest + 8u;
        uint8_t *line = memory(capacity);
        size_t written = 0;
        put_row("step");
        happen_to_stream(client, now, next_word(), to.context);
        while (takes && icd_client_output(client, line, capacity, &written)) {
            put_row("stream");
            put_octets("bytes", line, written);
        }
        if (icd_client_deadline(client, &deadline)) {
            put_row("until");
            put_number("deadline", deadline);
        }
    }
}

const testee_op_t testee_stream_ops[] = {
    {"stream_encode", stream_encode}, {"stream_encode_packet", stream_encode_packet},
    {"stream_events", stream_events}, {"stream_respond", stream_respond},
    {"stream_client", stream_client}, {NULL, NULL},
};
