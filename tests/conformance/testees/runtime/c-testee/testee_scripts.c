/* Scripts for the client and for the procedures: what happens at which time, and what they do then. */

#include "testee_wire.h"

/* ---- the client ------------------------------------------------------------------------------------------------------- */

static void on_event(void *context, const icd_event_t *event)
{
    const icd_event_kind_t kind = event->kind;
    const bool outcome = kind >= ICD_EVENT_DONE && kind <= ICD_EVENT_TIMEOUT;
    (void)context;
    put_row(event_name(kind));
    if (event->has_id && kind != ICD_EVENT_LOG) {
        put_number("id", event->id);
    }
    if (outcome) {
        put_number("attempts", event->attempts);
    }
    if (kind == ICD_EVENT_DONE || (kind >= ICD_EVENT_ARRIVED && kind <= ICD_EVENT_STRAY)) {
        const size_t id_bytes = event->is_packet ? 1u : 0u;
        put_octets("bytes", event->data + id_bytes, event->length - id_bytes);
    }
    if (kind == ICD_EVENT_REFUSED) {
        put_known("code", event->has_code ? (int64_t)event->code : -1);
        put_known("parameter", event->has_detail ? (int64_t)event->detail : -1);
        if (event->may_be_damaged) {
            put_number("may_be_damaged", 1u);
        }
    }
}

static void start(icd_client_t *client, uint32_t now, icd_direction_t direction)
{
    icd_request_t request;
    octets_t octets;
    icd_status_t status;
    memset(&request, 0, sizeof request);
    request.direction = direction;
    request.id = next_number();
    if (direction == ICD_TELECOMMAND) {
        request.repeat = next_number() != 0u;
        octets = next_octets();
        request.data = octets.data;
        request.length = octets.length;
    }
    status = icd_client_start(client, now, &request);
    if (status == ICD_ERROR_LENGTH) {
        put_row("error");
        put_word("error", "length");
        put_number("expected", icd_find_message(client->link, direction, request.id)->length);
        put_number("actual", request.length);
    } else if (status != ICD_OK) {
        put_row("error");
        put_word("error", status == ICD_ERROR_BUSY ? "busy" : "unknown-id");
    }
}

static void put_output(icd_client_t *client)
{
    uint8_t line[1024];
    icd_can_packet_t packet;
    const uint8_t *bytes;
    size_t count, read;
    while (icd_client_output(client, line, sizeof line, &count)) {
        put_row("stream");
        put_octets("bytes", line, count);
    }
    while (icd_client_next_packet(client, &packet)) {
        put_packet("frame", &packet);
    }
    while (icd_client_transfer(client, &bytes, &count, &read)) {
        put_row("transfer");
        put_octets("write", bytes, count);
        put_number("read", read);
    }
}

static void happen(icd_client_t *client, uint32_t now, const char *what)
{
    if (is_word(what, "telecommand")) {
        start(client, now, ICD_TELECOMMAND);
    } else if (is_word(what, "telemetry")) {
        start(client, now, ICD_TELEMETRY);
    } else if (is_word(what, "received")) {
        const octets_t octets = next_octets();
        icd_client_received(client, now, octets.data, octets.length, on_event, client);
    } else if (is_word(what, "transferred")) {
        const octets_t octets = next_octets();
        icd_client_transferred(client, now, octets.data, octets.length, on_event, client);
    } else if (is_word(what, "failed")) {
        icd_client_transferred(client, now, NULL, 0, on_event, client);
    } else if (is_word(what, "packet")) {
        const icd_can_packet_t packet = next_packet();
        icd_client_packet(client, now, &packet, on_event, client);
    } else if (is_word(what, "cancel")) {
        icd_client_cancel(client);
    } else {
        icd_client_tick(client, now, on_event, client);
    }
}

typedef struct {
    icd_client_t client;
    icd_uart_line_t uart;
    icd_i2c_line_t i2c;
    icd_can_line_t can;
    icd_slot_t slot;
} bus_client_t;

static icd_status_t begin_client(
    bus_client_t *on, const icd_link_t *link, icd_bus_t bus, uint8_t address, uint8_t *buffer, size_t size)
{
    switch (bus) {
    case ICD_BUS_UART:
        return icd_client_uart(&on->client, link, &on->uart, &on->slot, 1, buffer, size);
    case ICD_BUS_I2C:
        return icd_client_i2c(&on->client, link, &on->i2c, &on->slot, 1, buffer, size);
    case ICD_BUS_CAN:
    default:
        return icd_client_can(&on->client, link, &on->can, address, &on->slot, 1, buffer, size);
    }
}

static void client_script(void)
{
    const icd_link_t *link = next_link();
    const icd_bus_t bus = next_bus();
    const bool checked = next_number() != 0u;
    const uint8_t address = next_byte();
    const size_t size = icd_client_bytes(link, 1);
    bus_client_t *on = (bus_client_t *)memory(sizeof *on);
    icd_client_t *client = &on->client;
    icd_client_settings_t *settings = &client->settings;
    uint32_t deadline;
    if (!answers(begin_client(on, link, bus, address, (uint8_t *)memory(size), size))) {
        return;
    }
    settings->reply_timeout = next_or(settings->reply_timeout);
    settings->retries = (uint8_t)next_or(settings->retries);
    settings->poll_interval = next_or(settings->poll_interval);
    settings->poll_timeout = next_or(settings->poll_timeout);
    settings->late = next_or(settings->late);
    if (checked) {
        icd_client_use_checksums(client);
    }
    while (has_words()) {
        const uint32_t now = next_number();
        const char *what = next_word();
        put_row("step");
        if (is_word(what, "received") || is_word(what, "packet")) {
            /* What a time-out sends again is sent before this arrives. */
            icd_client_tick(client, now, on_event, client);
            put_output(client);
        }
        happen(client, now, what);
        put_output(client);
        if (client->free != client->slots && on->slot.state == ICD_SLOT_SENT) {
            icd_client_tick(client, now, on_event, client);
        }
        if (icd_client_deadline(client, &deadline)) {
            put_row("until");
            put_number("deadline", deadline);
        }
    }
}

/* ---- procedures ------------------------------------------------------------------------------------------------------- */

static void on_frame(void *context, const uint8_t *data, size_t length)
{
    (void)context;
    put_row("entry");
    put_octets("bytes", data, length);
}

static void on_block(void *context, uint32_t offset, const uint8_t *data, size_t length)
{
    (void)context;
    put_row("block");
    put_number("offset", offset);
    put_octets("bytes", data, length);
}

/* Just the memory that the blocks of a procedure need. */
static void take_memory(icd_procedure_memory_t *memory_of, const icd_blocks_form_t *blocks)
{
    const uint32_t given = memory_of->block;
    const uint32_t block = given != 0u && given < blocks->size ? given : blocks->size;
    const uint32_t packets = (block + blocks->packet_bytes - 1u) / blocks->packet_bytes;
    memory_of->bitmap_size = (packets + 7u) / 8u;
    memory_of->bitmap = (uint8_t *)memory(memory_of->bitmap_size);
    memory_of->buffer_size = blocks->sends ? 0u : (size_t)packets * blocks->packet_bytes;
    memory_of->buffer = (uint8_t *)memory(memory_of->buffer_size);
}

static icd_status_t begin(icd_procedure_t *procedure, const testee_procedure_t *tested)
{
    const icd_procedure_form_t *const form = tested->form();
    const icd_bus_t bus = next_bus();
    uint32_t numbers[ICD_REGISTERS] = {0};
    icd_procedure_memory_t given;
    icd_status_t status;
    memset(&given, 0, sizeof given);
    given.block = next_number();
    const octets_t octets = next_octets();
    const uint32_t count = next_number();
    for (uint32_t i = 0; i < count; i++) {
        numbers[i] = next_or(ICD_UNKNOWN);
    }
    given.bytes = octets.data;
    given.byte_count = octets.length;
    given.on_block = on_block;
    given.on_entry = on_frame;
    if (form->blocks != NULL) {
        take_memory(&given, form->blocks);
    }
    status = tested->begin(procedure, bus, numbers, &given);
    if (status == ICD_ERROR_LENGTH) {
        refuse_length("too-long", form->most_bytes, octets.length);
    } else if (status != ICD_OK) {
        refuse_status(status);
    }
    return status;
}

/* Passes an event to the procedure. */
static void take_event(icd_procedure_t *procedure, uint32_t now, const char *name)
{
    static const struct {
        const char *name;
        icd_event_kind_t kind;
    } rows[] = {
        {"done", ICD_EVENT_DONE},       {"arrived", ICD_EVENT_ARRIVED}, {"refused", ICD_EVENT_REFUSED},
        {"damaged", ICD_EVENT_REFUSED}, {"timeout", ICD_EVENT_TIMEOUT}, {"sent", ICD_EVENT_SENT},
        {"busy", ICD_EVENT_BUSY},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        const octets_t nothing = {NULL, 0};
        icd_event_t event;
        octets_t octets;
        if (!is_word(name, rows[i].name)) {
            continue;
        }
        memset(&event, 0, sizeof event);
        event.kind = rows[i].kind;
        event.has_id = true;
        event.id = event.kind == ICD_EVENT_ARRIVED ? next_number() : procedure->request.id;
        event.direction = procedure->request.direction;
        octets = i < 2u ? next_octets() : nothing;
        event.data = octets.data;
        event.length = octets.length;
        event.may_be_damaged = is_word(name, "damaged");
        icd_procedure_event(procedure, now, &event);
    }
}

static void put_step(icd_procedure_t *procedure, uint32_t now)
{
    static const char *const results[] = {
        "", "done", "refused", "busy", "timeout", "failed", "length", "checksum", "rounds", "limit"};
    icd_request_t request;
    uint32_t deadline;
    const bool asks = icd_procedure_next(procedure, now, &request);
    put_row("step");
    if (asks) {
        put_number(request.direction == ICD_TELEMETRY ? "telemetry" : "telecommand", request.id);
    }
    if (asks && request.direction == ICD_TELECOMMAND) {
        put_octets("bytes", request.data, request.length);
        put_number("repeat", request.repeat);
    }
    if (icd_procedure_deadline(procedure, &deadline)) {
        put_number("deadline", deadline);
    }
    if (procedure->result != ICD_RUNNING) {
        put_word("result", results[procedure->result]);
    }
}

static void procedure_script(void)
{
    const size_t node = next_number(), place = next_number();
    const testee_procedure_t *const tested = testee_procedure(node, place);
    icd_procedure_t *procedure = (icd_procedure_t *)memory(sizeof *procedure);
    uint32_t total = 0;
    if (begin(procedure, tested) != ICD_OK) {
        return;
    }
    put_row("ok");
    while (has_words()) {
        const uint32_t now = next_number();
        take_event(procedure, now, next_word());
        put_step(procedure, now);
    }
    put_row("ok");
    if (procedure->form->blocks != NULL && procedure->form->blocks->sends) {
        put_number("sent", icd_procedure_progress(procedure, &total));
    }
    if (tested->output_count != 0u && procedure->result == ICD_DONE) {
        put_list("outputs");
        for (size_t i = 0; i < tested->output_count; i++) {
            put_item(tested->outputs[i](procedure));
        }
    }
}

const testee_op_t testee_script_ops[] = {
    {"client", client_script},
    {"procedure", procedure_script},
    {NULL, NULL},
};
