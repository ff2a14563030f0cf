/* libFuzzer harness on the stream decoders and step machines of the C wire layer. See README.md. */

#include "testee_wire.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* The input, taken piece by piece; zeros follow its end. */
typedef struct {
    const uint8_t *at;
    size_t left;
} input_t;

static uint8_t take(input_t *input)
{
    if (input->left == 0u) {
        return 0;
    }
    input->left--;
    return *input->at++;
}

static void require(bool holds)
{
    if (!holds) {
        abort();
    }
}

/* Memory of just that size, so that touching anything beyond it is noticed. */
static uint8_t *allocate(size_t size)
{
    uint8_t *found = (uint8_t *)malloc(size != 0u ? size : 1u);
    require(found != NULL);
    return found;
}

/* What the events of a run say, and how many there were. */
typedef struct {
    const icd_link_t *link;
    uint32_t digest;
    size_t on_line;   /* bytes that the messages take on the UART */
    size_t outcomes;  /* of requests */
} seen_t;

static void note(seen_t *seen, const void *data, size_t length)
{
    const uint8_t *bytes = (const uint8_t *)data;
    size_t i;
    for (i = 0; i < length; i++) {
        seen->digest = (seen->digest ^ bytes[i]) * 16777619u;
    }
}

static void on_event(void *context, const icd_event_t *event)
{
    seen_t *seen = (seen_t *)context;
    const uint32_t kind = (uint32_t)event->kind;
    note(seen, &kind, sizeof kind);
    note(seen, &event->id, sizeof event->id);
    note(seen, event->data, event->length);
    seen->outcomes += event->kind >= ICD_EVENT_DONE && event->kind <= ICD_EVENT_TIMEOUT;
}

static void on_uart(void *context, const icd_event_t *event)
{
    seen_t *seen = (seen_t *)context;
    on_event(context, event);
    if (event->kind == ICD_EVENT_MESSAGE) {
        const size_t room = ICD_UART_BYTES(event->length);
        uint8_t *line = allocate(room);
        size_t written = 0;
        require(icd_uart_encode(seen->link, event->data, event->length, line, room, &written) == ICD_OK);
        seen->on_line += written;
        (void)icd_uart_kind(seen->link, event->data, event->length);
        free(line);
    } else if (event->kind == ICD_EVENT_EMPTY) {
        require(event->length == 0u);
    }
}

/* Whole, and cut at the places that `cuts` says: the same events, and every byte accounted for. */
static void uart(const icd_link_t *link, input_t *input)
{
    const size_t limit = (take(input) % link->longest) + 1u;
    const uint8_t cuts = (uint8_t)(take(input) | 1u);
    uint8_t *stream = allocate(input->left), *buffer = allocate(limit);
    seen_t whole = {link, 1, 0, 0}, pieces = {link, 1, 0, 0};
    icd_uart_decoder_t decoder;
    size_t at, step = cuts;
    memcpy(stream, input->at, input->left);
    if (icd_uart_decoder_init(&decoder, link, buffer, limit) == ICD_OK) {
        icd_uart_feed(&decoder, stream, input->left, on_uart, &whole);
        require(decoder.discarded + decoder.pending + whole.on_line == input->left);
        require(icd_uart_decoder_init(&decoder, link, buffer, limit) == ICD_OK);
        for (at = 0; at < input->left; at += step, step = ((step * cuts) % 23u) + 1u) {
            step = step < input->left - at ? step : input->left - at;
            icd_uart_feed(&decoder, stream + at, step, on_uart, &pieces);
        }
        require(whole.digest == pieces.digest && whole.on_line == pieces.on_line);
    }
    free(stream);
    free(buffer);
}

static icd_can_packet_t packet_of(const icd_link_t *link, input_t *input)
{
    icd_can_packet_t packet;
    const uint8_t type = take(input), id = take(input), addresses = take(input);
    size_t i;
    memset(&packet, 0, sizeof packet);
    packet.id = ((uint32_t)type << link->can->type.shift) | ((uint32_t)id << link->can->channel.shift) |
        ((addresses & 3u) << link->can->source.shift) | (((addresses >> 2) & 3u) << link->can->destination.shift);
    packet.id &= 0x1FFFFFFFu;
    packet.length = (uint8_t)(addresses & 0x80u ? (addresses >> 4) & 7u : 8u);
    for (i = 0; i < packet.length; i++) {
        packet.data[i] = take(input);
    }
    return packet;
}

static void can(const icd_link_t *link, input_t *input)
{
    const size_t count = (take(input) % 4u) + 1u;
    const size_t size = link->can != NULL ? count * icd_can_slot_bytes(link) : 0u;
    uint8_t *buffer = allocate(size);
    icd_can_slot_t slots[4];
    icd_can_joiner_t joiner;
    seen_t seen = {link, 1, 0, 0};
    uint32_t now = 0xFFFFFF00u;
    if (icd_can_joiner_init(&joiner, link, ICD_CAN_EVERYBODY, slots, count, buffer, size) == ICD_OK) {
        while (input->left != 0u) {
            const icd_can_packet_t packet = packet_of(link, input);
            now += take(input);
            icd_can_feed(&joiner, now, &packet, on_event, &seen);
            require(joiner.used <= count);
        }
        icd_can_expire(&joiner, now + (link->can->extended != NULL ? link->can->extended->packet_timeout : 0u), on_event, &seen);
        require(joiner.used == 0u);
    }
    free(buffer);
}

static void on_entry(void *context, const icd_log_entry_t *entry)
{
    seen_t *seen = (seen_t *)context;
    icd_log_frames_t frames;
    icd_log_frame_t frame;
    note(seen, &entry->seconds, sizeof entry->seconds);
    icd_log_frames(&frames, seen->link, entry->mask, entry->slots);
    while (icd_log_next(&frames, &frame)) {
        note(seen, &frame.bit, sizeof frame.bit);
        note(seen, frame.data, frame.length);
    }
}

static void logs(const icd_link_t *link, input_t *input)
{
    const uint8_t cuts = (uint8_t)(take(input) | 1u);
    const size_t size = link->log_file != NULL && link->log_mask != NULL ? icd_log_bytes(link) : 0u;
    uint8_t *file = allocate(input->left), *buffer = allocate(size);
    seen_t whole = {link, 1, 0, 0}, pieces = {link, 1, 0, 0};
    icd_log_reader_t reader;
    icd_log_message_t message;
    size_t at, step = cuts, left;
    memcpy(file, input->at, input->left);
    if (icd_log_reader_init(&reader, link, buffer, size) == ICD_OK) {
        icd_log_feed(&reader, file, input->left, on_entry, &whole);
        left = reader.length;
        require(icd_log_reader_init(&reader, link, buffer, size) == ICD_OK);
        for (at = 0; at < input->left; at += step, step = ((step * cuts) % 23u) + 1u) {
            step = step < input->left - at ? step : input->left - at;
            icd_log_feed(&reader, file + at, step, on_entry, &pieces);
        }
        require(whole.digest == pieces.digest && reader.length == left);
    }
    (void)icd_log_message_decode(link, file, input->left, &message);
    free(file);
    free(buffer);
}

/* Takes the output, or only a part of it. */
static void drain(icd_client_t *client, bool whole)
{
    const uint8_t *bytes;
    uint8_t line[7];
    size_t count, read;
    icd_can_packet_t packet;
    while (icd_client_output(client, line, sizeof line, &count) && whole) {
    }
    while (icd_client_next_packet(client, &packet) && whole) {
    }
    while (icd_client_transfer(client, &bytes, &count, &read)) {
    }
}

static void receive(icd_client_t *client, input_t *input, uint32_t now, seen_t *seen)
{
    const size_t given = take(input), count = given < input->left ? given : input->left;
    uint8_t *bytes = allocate(count);
    if (client->can != NULL) {
        const icd_can_packet_t packet = packet_of(client->link, input);
        icd_client_packet(client, now, &packet, on_event, seen);
    } else {
        memcpy(bytes, input->at, count);
        input->at += count;
        input->left -= count;
        if (client->i2c != NULL) {
            icd_client_transferred(client, now, given == 0xFFu ? NULL : bytes, count, on_event, seen);
        } else {
            icd_client_received(client, now, bytes, count, on_event, seen);
        }
    }
    free(bytes);
}

typedef struct {
    icd_client_t client;
    icd_uart_line_t uart;
    icd_i2c_line_t i2c;
    icd_can_line_t can;
    icd_slot_t slots[3];
} bus_client_t;

static icd_status_t begin_client(
    bus_client_t *on, size_t requests, const icd_link_t *link, icd_bus_t bus, uint8_t address, uint8_t *buffer, size_t size)
{
    switch (bus) {
    case ICD_BUS_UART:
        return icd_client_uart(&on->client, link, &on->uart, on->slots, requests, buffer, size);
    case ICD_BUS_I2C:
        return icd_client_i2c(&on->client, link, &on->i2c, on->slots, requests, buffer, size);
    case ICD_BUS_CAN:
    default:
        return icd_client_can(&on->client, link, &on->can, address, on->slots, requests, buffer, size);
    }
}

/* Each request ends in exactly one outcome, and time ends all of them. */
static void client(const icd_link_t *link, icd_bus_t bus, input_t *input)
{
    const size_t requests = 1u + (take(input) % 3u), size = icd_client_bytes(link, requests);
    uint8_t *buffer = allocate(size), *data = allocate(link->longest);
    bus_client_t *on = (bus_client_t *)(void *)allocate(sizeof *on);
    icd_client_t *one = &on->client;
    seen_t seen = {link, 1, 0, 0};
    uint32_t now = 0xFFFFF000u, deadline;
    size_t started = 0, rounds = 0;
    memset(data, 0, link->longest);
    if (begin_client(on, requests, link, bus, 1, buffer, size) == ICD_OK) {
        if ((take(input) & 1u) != 0u) {
            icd_client_use_checksums(one);
        }
        one->settings.in_flight = (uint8_t)requests;
        while (input->left != 0u) {
            const uint8_t what = take(input);
            icd_request_t request;
            memset(&request, 0, sizeof request);
            request.direction = (what & 4u) != 0u ? ICD_TELEMETRY : ICD_TELECOMMAND;
            request.repeat = (what & 8u) != 0u;
            now += (uint32_t)(what >> 4) * 64u;
            if ((what & 3u) == 0u) {
                const icd_message_t *message;
                request.id = take(input);
                message = icd_find_message(link, request.direction, request.id);
                request.data = data;
                request.length = message != NULL ? message->length : 0u;
                started += icd_client_start(one, now, &request) == ICD_OK;
            } else if ((what & 3u) == 1u) {
                drain(one, (what & 8u) == 0u);
            } else if ((what & 3u) == 2u) {
                icd_client_tick(one, now, on_event, &seen);
            } else {
                receive(one, input, now, &seen);
            }
        }
        for (drain(one, true); icd_client_deadline(one, &deadline); drain(one, true), rounds++) {
            require(rounds < 100000u);
            icd_client_tick(one, deadline, on_event, &seen);
        }
        require(seen.outcomes == started);
    }
    free(on);
    free(buffer);
    free(data);
}

static void on_block(void *context, uint32_t offset, const uint8_t *block, size_t length)
{
    note((seen_t *)context, &offset, sizeof offset);
    note((seen_t *)context, block, length);
}

static void on_frame(void *context, const uint8_t *entry, size_t length)
{
    note((seen_t *)context, entry, length);
}

/* A procedure that is told anything. */
static void run(icd_procedure_t *procedure, input_t *input)
{
    uint32_t now = 0xFFFFF000u;
    while (input->left != 0u && procedure->result == ICD_RUNNING) {
        const uint8_t what = take(input);
        const size_t given = take(input) % 64u, count = given < input->left ? given : input->left;
        uint8_t *bytes = allocate(count);
        icd_event_t event;
        icd_request_t request;
        memset(&event, 0, sizeof event);
        memcpy(bytes, input->at, count);
        input->at += count;
        input->left -= count;
        now += (uint32_t)(what >> 3) * 16u;
        event.kind = (what & 7u) < 4u ? ICD_EVENT_DONE
            : (what & 7u) == 4u       ? ICD_EVENT_TIMEOUT
            : (what & 7u) == 5u       ? ICD_EVENT_REFUSED
                                      : ICD_EVENT_ARRIVED;
        event.direction = procedure->request.direction;
        event.id = procedure->request.id;
        if (event.kind == ICD_EVENT_ARRIVED && procedure->form->receive_count != 0u) {
            event.id = procedure->form->receives[0].id;
        }
        event.data = bytes;
        event.length = count;
        if (icd_procedure_next(procedure, now, &request)) {
            require(request.length == 0u || request.data != NULL);
        }
        icd_procedure_event(procedure, now, &event);
        free(bytes);
    }
}

/* Any procedure of the node, with just the memory that its blocks need. */
static void procedures(size_t node, const icd_link_t *link, input_t *input)
{
    const uint8_t which = take(input);
    const testee_procedure_t *tested = testee_procedure(node, which % 8u);
    const icd_procedure_form_t *form = tested != NULL ? tested->form() : NULL;
    const icd_blocks_form_t *blocks = form != NULL ? form->blocks : NULL;
    uint32_t numbers[ICD_REGISTERS] = {0};
    uint8_t *file = allocate(1000);
    seen_t seen = {link, 1, 0, 0};
    icd_procedure_memory_t given;
    icd_procedure_t procedure;
    if (form == NULL) {
        free(file);
        return;
    }
    memset(&given, 0, sizeof given);
    memset(file, which, 1000);
    given.block = (take(input) * 7u) + 1u;
    if (blocks != NULL) {
        const uint32_t block = given.block < blocks->size ? given.block : blocks->size;
        const uint32_t packets = (block + blocks->packet_bytes - 1u) / blocks->packet_bytes;
        given.bitmap_size = (packets + 7u) / 8u;
        given.buffer_size = blocks->sends ? 0u : (size_t)packets * blocks->packet_bytes;
    }
    given.bytes = file;
    given.byte_count = 1000;
    given.buffer = allocate(given.buffer_size);
    given.bitmap = allocate(given.bitmap_size);
    given.on_block = on_block;
    given.on_entry = on_frame;
    given.context = &seen;
    for (size_t i = 0; i < form->input_count; i++) {
        const icd_input_form_t *one = &form->inputs[i];
        numbers[i] = one->is_optional && (which & 0x80u) != 0u ? ICD_UNKNOWN : one->values != NULL ? one->values[0] : 1u;
        numbers[i] = one->is_optional && (which & 0x80u) == 0u ? 1000u : numbers[i];
    }
    if (tested->begin(&procedure, (icd_bus_t)((which >> 3) % 3u), numbers, &given) == ICD_OK) {
        run(&procedure, input);
    }
    free(given.buffer);
    free(given.bitmap);
    free(file);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    input_t input = {data, size};
    const size_t node = take(&input) % testee_node_count;
    const icd_link_t *link = size < 2u ? NULL : testee_link(node);
    if (link == NULL) {
        return 0;
    }
    switch (take(&input) % 7u) {
    case 0:
        uart(link, &input);
        break;
    case 1:
        can(link, &input);
        break;
    case 2:
        logs(link, &input);
        break;
    case 3:
        client(link, ICD_BUS_UART, &input);
        break;
    case 4:
        client(link, ICD_BUS_I2C, &input);
        break;
    case 5:
        client(link, ICD_BUS_CAN, &input);
        break;
    default:
        procedures(node, link, &input);
        break;
    }
    return 0;
}
