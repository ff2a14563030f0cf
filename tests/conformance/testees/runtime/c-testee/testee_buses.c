/* UART, I2C and CAN. */

#include "testee_wire.h"

/* ---- UART ----------------------------------------------------------------------------------------------------------------- */

static void uart_encode(void)
{
    const icd_link_t *link = next_link();
    const octets_t octets = next_octets();
    const size_t room = ICD_UART_BYTES(octets.length);
    uint8_t *line = (uint8_t *)memory(room);
    size_t written = 0;
    const icd_status_t status = icd_uart_encode(link, octets.data, octets.length, line, room, &written);
    if (status == ICD_ERROR_LENGTH) {
        refuse_length("length", 1, octets.length);
    } else if (answers(status)) {
        put_octets("bytes", line, written);
    }
}

static void on_uart(void *context, const icd_event_t *event)
{
    static const char *const kinds[] = {"reply", "acknowledge", "packet", "log", "other"};
    put_row(event_name(event->kind));
    if (event->kind == ICD_EVENT_MESSAGE) {
        put_word("kind", kinds[icd_uart_kind((const icd_link_t *)context, event->data, event->length)]);
        put_octets("bytes", event->data, event->length);
    }
}

static void uart_events(void)
{
    icd_link_t link = *next_link();
    const size_t limit = next_number();
    icd_uart_decoder_t decoder;
    if (!answers(icd_uart_decoder_init(&decoder, &link, (uint8_t *)memory(limit), limit))) {
        return;
    }
    while (has_words()) {
        const octets_t chunk = next_octets();
        icd_uart_feed(&decoder, chunk.data, chunk.length, on_uart, &link);
    }
    put_row("ok");
    put_number("discarded", decoder.discarded);
    put_number("pending", decoder.pending);
}

/* ---- I2C ------------------------------------------------------------------------------------------------------------------ */

static void i2c_read(void)
{
    const icd_link_t *link = next_link();
    const uint8_t id = next_byte();
    size_t length = 0;
    if (answers(icd_i2c_read_length(link, id, next_number() != 0u, &length))) {
        put_number("read", length);
    }
}

static void i2c_write(void)
{
    const icd_link_t *link = next_link();
    const uint8_t id = next_byte();
    const bool checked = next_number() != 0u;
    const octets_t octets = next_octets();
    const size_t room = octets.length + 16u;
    uint8_t *buffer = (uint8_t *)memory(room);
    size_t length = 0;
    if (answers(icd_i2c_write(link, id, octets.data, octets.length, checked, buffer, room, &length))) {
        put_octets("write", buffer, length);
    }
}

static void i2c_reply(void)
{
    const icd_link_t *link = next_link();
    const uint8_t id = next_byte();
    const bool checked = next_number() != 0u;
    const octets_t octets = next_octets();
    size_t length = 0;
    const icd_status_t status = icd_i2c_reply(link, id, octets.data, octets.length, checked, &length);
    if (status == ICD_ERROR_LENGTH) {
        (void)icd_i2c_read_length(link, id, checked, &length);
        refuse_length("length", length, octets.length);
    } else if (status == ICD_ERROR_CHECKSUM) {
        refuse_length(
            "checksum", icd_message_checksum(link, id, octets.data, length),
            icdgen_number(link, octets.data + length, octets.length - length));
    } else if (answers(status)) {
        put_octets("bytes", octets.data, length);
    }
}

/* ---- CAN ------------------------------------------------------------------------------------------------------------------ */

static const char *const can_kinds[] = {"telecommand", "acknowledge", "refusal", "request", "reply", "request_refusal"};

icd_can_packet_t next_packet(void)
{
    icd_can_packet_t packet;
    octets_t octets;
    memset(&packet, 0, sizeof packet);
    packet.id = next_number();
    octets = next_octets();
    packet.length = (uint8_t)(octets.length < 255u ? octets.length : 255u);
    memcpy(packet.data, octets.data, packet.length < sizeof packet.data ? packet.length : sizeof packet.data);
    return packet;
}

void put_packet(const char *row, const icd_can_packet_t *packet)
{
    put_row(row);
    put_number("id", packet->id);
    put_octets("bytes", packet->data, packet->length);
}

static void can_split(void)
{
    const icd_link_t *link = next_link();
    const char *name = next_word();
    const uint8_t id = next_byte(), source = next_byte(), destination = next_byte();
    const octets_t octets = next_octets();
    icd_can_splitter_t splitter;
    icd_can_packet_t packet;
    icd_status_t status;
    unsigned kind = 0;
    while (!is_word(name, can_kinds[kind])) {
        kind++;
    }
    status = icd_can_split(&splitter, link, (icd_can_kind_t)kind, id, source, destination, octets.data, octets.length);
    if (status == ICD_ERROR_LENGTH) {
        refuse_length("too-long", icd_can_most(link, (icd_can_kind_t)kind), octets.length);
    } else if (answers(status)) {
        while (icd_can_next(&splitter, &packet)) {
            put_packet("packet", &packet);
        }
    }
}

static void on_can(void *context, const icd_event_t *event)
{
    (void)context;
    put_row(event_name(event->kind));
    put_number("id", event->id);
    put_number("source", event->source);
    if (event->kind == ICD_EVENT_MESSAGE) {
        put_word("kind", can_kinds[event->can_kind]);
        put_number("destination", event->destination);
        put_octets("bytes", event->data, event->length);
    } else if (event->kind == ICD_EVENT_INCOMPLETE) {
        put_number("missing", event->missing);
    }
}

static void can_join(void)
{
    const icd_link_t *link = next_link();
    const char *address = next_word();
    const uint32_t senders = next_number();
    const char *end = next_word();
    const size_t size = link->can != NULL ? senders * icd_can_slot_bytes(link) : 0u;
    icd_can_slot_t *slots = (icd_can_slot_t *)memory(senders * sizeof *slots);
    icd_can_joiner_t joiner;
    if (!answers(icd_can_joiner_init(
            &joiner, link, *address != '\0' ? (int16_t)number_of(address) : ICD_CAN_EVERYBODY, slots, senders,
            (uint8_t *)memory(size), size))) {
        return;
    }
    while (has_words()) {
        const uint32_t at = next_number();
        const icd_can_packet_t packet = next_packet();
        icd_can_feed(&joiner, at, &packet, on_can, NULL);
    }
    if (*end != '\0') {
        icd_can_expire(&joiner, number_of(end), on_can, NULL);
    }
}

const testee_op_t testee_bus_ops[] = {
    {"uart_encode", uart_encode}, {"uart_events", uart_events}, {"i2c_read", i2c_read}, {"i2c_write", i2c_write},
    {"i2c_reply", i2c_reply},     {"can_split", can_split},     {"can_join", can_join}, {NULL, NULL},
};
