/* Checksums, UART and I2C; which op is asked for. */

#include "testee_wire.h"

void put_ok(talk_t *talk)
{
    talk->out.length = 0;
    json_put_text(&talk->out, "{\"ok\":true");
}

static void crc_op(talk_t *talk, const icd_link_t *link, bool wide)
{
    octets_t octets;
    uint32_t crc = 0;
    icd_status_t status;
    if (!ask_octets(talk, 0, "bytes", &octets)) {
        return;
    }
    status = wide ? icd_crc16(link, octets.data, octets.length, &crc) : icd_crc8(link, octets.data, octets.length, &crc);
    if (status != ICD_OK) {
        (void)refuse_status(talk, status);
        return;
    }
    put_ok(talk);
    put_key_number(&talk->out, "crc", crc);
}

static void crc8(talk_t *talk, const icd_link_t *link)
{
    crc_op(talk, link, false);
}

static void crc16(talk_t *talk, const icd_link_t *link)
{
    crc_op(talk, link, true);
}

static void uart_encode(talk_t *talk, const icd_link_t *link)
{
    octets_t octets;
    uint8_t *line;
    size_t written = 0;
    icd_status_t status;
    if (!ask_octets(talk, 0, "bytes", &octets)) {
        return;
    }
    line = (uint8_t *)memory(ICD_UART_BYTES(octets.length));
    status = icd_uart_encode(link, octets.data, octets.length, line, ICD_UART_BYTES(octets.length), &written);
    if (status == ICD_ERROR_LENGTH) {
        (void)refuse_length(talk, "length", 1, octets.length);
    } else if (status != ICD_OK) {
        (void)refuse_status(talk, status);
    } else {
        put_ok(talk);
        put_key_octets(&talk->out, "bytes", line, written);
    }
}

static void on_frame(void *context, const icd_event_t *event)
{
    json_out_t *out = (json_out_t *)context;
    if (event->kind == ICD_EVENT_MESSAGE) {
        put_octets(out, event->data, event->length);
        json_put(out, ",", 1);
    }
}

static void uart_decode(talk_t *talk, const icd_link_t *link)
{
    static json_out_t frames;
    icd_uart_decoder_t decoder;
    octets_t octets;
    frames.length = 0;
    if (!ask_octets(talk, 0, "bytes", &octets)) {
        return;
    }
    if (icd_uart_decoder_init(&decoder, link, (uint8_t *)memory(link->longest), link->longest) != ICD_OK) {
        (void)refuse(talk, "unsupported");
        return;
    }
    icd_uart_feed(&decoder, octets.data, octets.length, on_frame, &frames);
    put_ok(talk);
    put_list(&talk->out, "frames", &frames);
}

typedef struct {
    const icd_link_t *link;
    json_out_t *out;
} uart_events_t;

static void on_uart(void *context, const icd_event_t *event)
{
    static const char *const kinds[] = {"reply", "acknowledge", "packet", "log", "other"};
    const uart_events_t *events = (const uart_events_t *)context;
    const char *name = event->kind == ICD_EVENT_MESSAGE      ? "message"
        : event->kind == ICD_EVENT_UNEXPECTED_START          ? "unexpected_start"
        : event->kind == ICD_EVENT_PROTOCOL_ERROR            ? "protocol_error"
        : event->kind == ICD_EVENT_OVERRUN                   ? "overrun"
                                                             : "empty";
    json_put_text(events->out, "{\"event\":");
    json_put_string(events->out, name, strlen(name));
    if (event->kind == ICD_EVENT_MESSAGE) {
        put_key_text(events->out, "kind", kinds[icd_uart_kind(events->link, event->data, event->length)]);
        put_key_octets(events->out, "bytes", event->data, event->length);
    }
    json_put_text(events->out, "},");
}

static void uart_events(talk_t *talk, const icd_link_t *link)
{
    static json_out_t found;
    icd_uart_decoder_t decoder;
    uart_events_t events;
    octets_t *chunks;
    uint32_t limit;
    size_t list, at, i, count;
    if (!ask_number(talk, 0, "limit", 1, link->longest, link->longest, &limit) || !ask_rows(talk, 0, "chunks", &list)) {
        return;
    }
    count = talk->row.values[list].count;
    chunks = (octets_t *)memory(count * sizeof *chunks);
    for (i = 0, at = list + 1u; i < count; i++, at = talk->row.values[at].after) {
        if (!octets_of(talk, at, &chunks[i])) {
            return;
        }
    }
    if (icd_uart_decoder_init(&decoder, link, (uint8_t *)memory(limit), limit) != ICD_OK) {
        (void)refuse(talk, "unsupported");
        return;
    }
    found.length = 0;
    events.link = link;
    events.out = &found;
    for (i = 0; i < count; i++) {
        icd_uart_feed(&decoder, chunks[i].data, chunks[i].length, on_uart, &events);
    }
    put_ok(talk);
    put_list(&talk->out, "events", &found);
    put_key_number(&talk->out, "discarded", (int64_t)decoder.discarded);
    put_key_number(&talk->out, "pending", (int64_t)decoder.pending);
}

static void i2c_request(talk_t *talk, const icd_link_t *link)
{
    octets_t octets;
    size_t text, length = 0;
    uint32_t id;
    bool checked;
    uint8_t *buffer;
    icd_status_t status;
    if (!ask_text(talk, 0, "kind", &text) || !ask_number(talk, 0, "id", 0, 255, REQUIRED, &id) ||
        !ask_flag(talk, 0, "crc", &checked)) {
        return;
    }
    if (is_word(&talk->row.values[text], "telemetry")) {
        const uint8_t one = (uint8_t)id;
        status = icd_i2c_read_length(link, one, checked, &length);
        if (status != ICD_OK) {
            (void)refuse_status(talk, status);
            return;
        }
        put_ok(talk);
        put_key_octets(&talk->out, "write", &one, 1);
        put_key_number(&talk->out, "read", (int64_t)length);
        return;
    }
    if (!is_word(&talk->row.values[text], "telecommand")) {
        (void)refuse_request(talk, "there is no such kind");
        return;
    }
    if (!ask_octets(talk, 0, "bytes", &octets)) {
        return;
    }
    buffer = (uint8_t *)memory(octets.length + 16u);
    status = icd_i2c_write(link, (uint8_t)id, octets.data, octets.length, checked, buffer, octets.length + 16u, &length);
    if (status != ICD_OK) {
        (void)refuse_status(talk, status);
        return;
    }
    put_ok(talk);
    put_key_octets(&talk->out, "write", buffer, length);
    put_key_number(&talk->out, "read", 0);
}

static void i2c_reply(talk_t *talk, const icd_link_t *link)
{
    octets_t octets;
    size_t length = 0;
    uint32_t id;
    bool checked;
    icd_status_t status;
    if (!ask_number(talk, 0, "id", 0, 255, REQUIRED, &id) || !ask_octets(talk, 0, "bytes", &octets) ||
        !ask_flag(talk, 0, "crc", &checked)) {
        return;
    }
    status = icd_i2c_reply(link, (uint8_t)id, octets.data, octets.length, checked, &length);
    if (status == ICD_ERROR_LENGTH) {
        (void)icd_i2c_read_length(link, (uint8_t)id, checked, &length);
        (void)refuse_length(talk, "length", length, octets.length);
    } else if (status == ICD_ERROR_CHECKSUM) {
        (void)refuse_length(
            talk, "checksum", icd_checksum(link, (uint8_t)id, octets.data, length),
            icdgen_number(link, octets.data + length, octets.length - length));
    } else if (status != ICD_OK) {
        (void)refuse_status(talk, status);
    } else {
        put_ok(talk);
        put_key_octets(&talk->out, "bytes", octets.data, length);
    }
}

/* ---- which op, about which node -------------------------------------------------------------------------------------- */

static const icd_message_t no_messages[1];

/* Of a node without a protocol. */
static icd_link_t nothing;

/* That of the node that is named; without a name, of the last node that has a protocol. NULL: refused. */
static const icd_link_t *link_of(talk_t *talk)
{
    const testee_node_t *node = NULL;
    size_t i, text;
    nothing.telecommands = no_messages;
    nothing.telemetry = no_messages;
    nothing.i2c_address = -1;
    nothing.longest = 1;
    if (json_find(&talk->row, 0, "node") != 0u) {
        if (!ask_text(talk, 0, "node", &text)) {
            return NULL;
        }
        node = node_named(talk->row.values[text].text);
        if (node == NULL) {
            (void)refuse(talk, "unknown-node");
            return NULL;
        }
    }
    for (i = testee_node_count; node == NULL && i-- != 0u;) {
        node = testee_nodes[i]->link != NULL ? testee_nodes[i] : NULL;
    }
    return node != NULL && node->link != NULL ? node->link() : &nothing;
}

bool answer_wire(talk_t *talk, const json_value_t *op)
{
    static const struct {
        const char *name;
        wire_op *answer;
    } ops[] = {
        {"crc8", crc8},
        {"crc16", crc16},
        {"uart_encode", uart_encode},
        {"uart_decode", uart_decode},
        {"uart_events", uart_events},
        {"can_split", can_split},
        {"can_join", can_join},
        {"i2c_request", i2c_request},
        {"i2c_reply", i2c_reply},
        {"log_decode", log_decode},
        {"log_encode", log_encode},
        {"log_message_decode", log_message_decode},
        {"log_message_encode", log_message_encode},
        {"dos_time", dos_time},
        {"hole_map", hole_map},
        {"index_decode", index_decode},
        {"index_encode", index_encode},
        {"identify", identify},
        {"client", client_script},
        {"file", file_script},
    };
    size_t i;
    for (i = 0; i < sizeof ops / sizeof ops[0]; i++) {
        if (is_word(op, ops[i].name)) {
            const icd_link_t *link = link_of(talk);
            if (link != NULL) {
                ops[i].answer(talk, link);
            }
            return true;
        }
    }
    return false;
}
