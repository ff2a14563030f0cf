/* Checksums, UART, I2C, CAN, packed times, hole maps, the index file and the identity. */

#include "testee_wire.h"

const icd_link_t *next_link(void)
{
    return testee_link(next_number());
}

icd_bus_t next_bus(void)
{
    const char *word = next_word();
    return is_word(word, "uart") ? ICD_BUS_UART : is_word(word, "i2c") ? ICD_BUS_I2C : ICD_BUS_CAN;
}

const char *event_name(icd_event_kind_t kind)
{
    static const char *const names[] = {
        "message",   "unexpected_start", "protocol_error", "overrun",      "empty", "duplicate", "incomplete",
        "malformed", "busy",             "unknown_type",   "done",         "refused", "timeout", "packet",
        "log",       "stray",
    };
    return names[kind];
}

/* ---- checksums, UART -------------------------------------------------------------------------------------------------- */

static void crc8(void)
{
    const icd_link_t *link = next_link();
    const octets_t octets = next_octets();
    uint32_t crc = 0;
    if (answers(icd_crc8(link, octets.data, octets.length, &crc))) {
        put_number("crc", crc);
    }
}

static void crc16(void)
{
    const icd_link_t *link = next_link();
    const octets_t octets = next_octets();
    uint32_t crc = 0;
    if (answers(icd_crc16(link, octets.data, octets.length, &crc))) {
        put_number("crc", crc);
    }
}

void put_known(const char *key, int64_t number)
{
    if (number >= 0) {
        put_signed(key, number);
    }
}

static void link_data(void)
{
    const icd_link_t *link = next_link();
    if (answers(link != NULL ? ICD_OK : ICD_ERROR_UNSUPPORTED)) {
        put_known("boot_ms", link->boot_ms);
        put_known("log_file_type", link->log_file != NULL ? link->log_file->file_type : -1);
        put_known("index_file_type", link->index != NULL ? link->index->file_type : -1);
        put_known("index_counter", link->download != NULL ? link->download->index_counter : -1);
    }
}

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

/* ---- I2C -------------------------------------------------------------------------------------------------------------- */

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
            "checksum", icd_checksum(link, id, octets.data, length),
            icdgen_number(link, octets.data + length, octets.length - length));
    } else if (answers(status)) {
        put_octets("bytes", octets.data, length);
    }
}

/* ---- CAN -------------------------------------------------------------------------------------------------------------- */

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
    status = icd_can_split(
        &splitter, link, (icd_can_kind_t)kind, id, source, destination, octets.data, octets.length);
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

/* ---- packed time ---------------------------------------------------------------------------------------------------- */

static void dos_time_unpack(void)
{
    const icd_link_t *link = next_link();
    icd_dos_time_t time;
    if (answers(icd_dos_time_unpack(link, next_number(), &time))) {
        put_number("year", time.year);
        put_number("month", time.month);
        put_number("day", time.day);
        put_number("hour", time.hour);
        put_number("minute", time.minute);
        put_number("second", time.second);
        put_number("valid", icd_dos_time_wrong(&time) == NULL);
    }
}

static void dos_time_pack(void)
{
    const icd_link_t *link = next_link();
    const char *wrong = NULL;
    uint32_t value = 0;
    icd_dos_time_t time;
    icd_status_t status;
    time.year = (uint16_t)next_number();
    time.month = (uint16_t)next_number();
    time.day = (uint16_t)next_number();
    time.hour = (uint16_t)next_number();
    time.minute = (uint16_t)next_number();
    time.second = (uint16_t)next_number();
    status = icd_dos_time_pack(link, &time, &value, &wrong);
    if (answers(status)) {
        put_number("value", value);
    } else if (status == ICD_ERROR_RANGE) {
        put_text("field", wrong);
    }
}

/* ---- hole maps and the index file ------------------------------------------------------------------------------------- */

static void put_missing(const icd_link_t *link, const uint8_t *map, uint32_t packets)
{
    const uint32_t first = link->files->first_packet;
    uint32_t i;
    put_list("missing");
    for (i = first; i < first + packets; i++) {
        if (!icd_hole_map_get(link, map, i)) {
            put_item(i);
        }
    }
}

static void hole_map_missing(void)
{
    const icd_link_t *link = next_link();
    const uint32_t packets = next_number();
    const octets_t map = next_octets();
    if (link->hole_map == NULL || link->files == NULL) {
        refuse("unsupported");
    } else if (map.length != link->hole_map->bytes) {
        refuse_length("length", link->hole_map->bytes, map.length);
    } else if (packets > link->hole_map->bytes * 8u) {
        refuse("range");
    } else {
        put_row("ok");
        put_missing(link, map.data, packets);
    }
}

static void hole_map(void)
{
    const icd_link_t *link = next_link();
    const uint32_t packets = next_number();
    const size_t size = link->hole_map != NULL ? link->hole_map->bytes : 0u;
    uint8_t *map = (uint8_t *)memory(size);
    icd_status_t status = icd_hole_map_init(link, map, packets);
    size_t i, piece;
    while (status == ICD_OK && has_words()) {
        status = icd_hole_map_set(link, map, packets, next_number());
    }
    if (!answers(status)) {
        return;
    }
    put_octets("bytes", map, size);
    put_list("messages");
    piece = link->hole_map->message_bytes;
    for (i = 0; i < size; i += piece) {
        put_octets_item(map + i, piece < size - i ? piece : size - i);
    }
    put_missing(link, map, packets);
}

static void index_decode(void)
{
    const icd_link_t *link = next_link();
    const octets_t octets = next_octets();
    icd_index_entry_t entry;
    size_t at, size;
    if (!answers(link->index != NULL ? ICD_OK : ICD_ERROR_UNSUPPORTED)) {
        return;
    }
    size = link->index->entry_bytes;
    for (at = 0; octets.length - at >= size; at += size) {
        if (icd_index_entry_decode(link, octets.data + at, size, &entry) != ICD_OK) {
            break;
        }
        put_row("entry");
        put_number("type", entry.type);
        put_number("counter", entry.counter);
        put_number("checksum", entry.checksum);
        put_number("size", entry.size);
        put_number("time", entry.time);
        put_octets("meta", entry.meta, entry.meta_length);
    }
    put_row("ok");
    put_number("truncated", octets.length - at);
}

static void index_encode(void)
{
    const icd_link_t *link = next_link();
    const size_t size = link->index != NULL ? link->index->entry_bytes : 0u;
    uint8_t *buffer = (uint8_t *)memory(size);
    icd_status_t status = link->index != NULL ? ICD_OK : ICD_ERROR_UNSUPPORTED;
    put_row("ok");
    put_list("bytes");
    while (status == ICD_OK && has_words()) {
        icd_index_entry_t entry;
        octets_t meta;
        entry.type = next_number();
        entry.counter = next_number();
        entry.checksum = next_number();
        entry.size = next_number();
        entry.time = next_number();
        meta = next_octets();
        entry.meta = meta.data;
        entry.meta_length = meta.length;
        status = icd_index_entry_encode(link, &entry, buffer, size);
        put_octets_item(buffer, size);
        if (status == ICD_ERROR_LENGTH) {
            refuse_length("length", link->index->meta.bytes, meta.length);
            return;
        }
    }
    if (status != ICD_OK) {
        refuse_status(status);
    }
}

static void identify(void)
{
    const icd_link_t *link = next_link();
    const octets_t octets = next_octets();
    icd_identity_t identity = {0, 0, false};
    const icd_status_t status = icd_identify(link, octets.data, octets.length, &identity);
    if (status == ICD_ERROR_LENGTH) {
        refuse_length("length", link->identification->length, octets.length);
    } else if (answers(status)) {
        put_number("node_type", identity.node_type);
        put_number("interface_version", identity.interface_version);
        put_number("matches", identity.matches);
    }
}

const testee_op_t testee_wire_ops[] = {
    {"crc8", crc8},
    {"crc16", crc16},
    {"link_data", link_data},
    {"uart_encode", uart_encode},
    {"uart_events", uart_events},
    {"i2c_read", i2c_read},
    {"i2c_write", i2c_write},
    {"i2c_reply", i2c_reply},
    {"can_split", can_split},
    {"can_join", can_join},
    {"dos_time_unpack", dos_time_unpack},
    {"dos_time_pack", dos_time_pack},
    {"hole_map_missing", hole_map_missing},
    {"hole_map", hole_map},
    {"index_decode", index_decode},
    {"index_encode", index_encode},
    {"identify", identify},
    {NULL, NULL},
};
