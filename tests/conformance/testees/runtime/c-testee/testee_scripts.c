/* Scripts for the client and for the procedures: what happens at which time, and what they do then. */

#include "testee_wire.h"

/* ---- the client ------------------------------------------------------------------------------------------------------- */

static void on_event(void *context, const icd_event_t *event)
{
    static const char *const reasons[] = {"", "none", "unknown_id", "length", "parameter", "checksum"};
    const icd_event_kind_t kind = event->kind;
    const bool outcome = kind == ICD_EVENT_DONE || kind == ICD_EVENT_REFUSED || kind == ICD_EVENT_TIMEOUT;
    (void)context;
    put_row(event_name(kind));
    if (outcome || (kind >= ICD_EVENT_DUPLICATE && kind <= ICD_EVENT_UNKNOWN_TYPE) || kind >= ICD_EVENT_CHECKSUM) {
        put_number("id", event->id);
    }
    if (outcome) {
        put_number("attempts", event->attempts);
    }
    if (kind == ICD_EVENT_PACKET) {
        put_number("number", event->number);
    }
    if (kind == ICD_EVENT_DONE || kind == ICD_EVENT_PACKET || kind == ICD_EVENT_LOG || kind == ICD_EVENT_STRAY) {
        put_octets("bytes", event->data, event->length);
    }
    if (kind == ICD_EVENT_REFUSED) {
        put_known("code", event->code);
        put_known("parameter", event->parameter);
        if (event->reason != ICD_REASON_UNKNOWN) {
            put_word("reason", reasons[event->reason]);
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
    request.id = next_byte();
    if (direction == ICD_TELECOMMAND) {
        request.repeat = next_number() != 0u;
        octets = next_octets();
        request.data = octets.data;
        request.length = octets.length;
    }
    status = icd_client_start(client, now, &request, on_event, NULL);
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

static void happen(icd_client_t *client, uint32_t now, const char *what)
{
    if (is_word(what, "telecommand")) {
        start(client, now, ICD_TELECOMMAND);
    } else if (is_word(what, "telemetry")) {
        start(client, now, ICD_TELEMETRY);
    } else if (is_word(what, "received")) {
        const octets_t octets = next_octets();
        icd_client_received(client, now, octets.data, octets.length, on_event, NULL);
    } else if (is_word(what, "transferred")) {
        const octets_t octets = next_octets();
        icd_client_transferred(client, now, octets.data, octets.length, on_event, NULL);
    } else if (is_word(what, "failed")) {
        icd_client_transferred(client, now, NULL, 0, on_event, NULL);
    } else if (is_word(what, "packet")) {
        const icd_can_packet_t packet = next_packet();
        icd_client_packet(client, now, &packet, on_event, NULL);
    } else if (is_word(what, "cancel")) {
        icd_client_cancel(client);
    } else {
        icd_client_tick(client, now, on_event, NULL);
    }
}

static void put_output(icd_client_t *client)
{
    icd_can_packet_t packet;
    const uint8_t *bytes;
    size_t count, read;
    while (icd_client_output(client, &bytes, &count)) {
        put_row("stream");
        put_octets("bytes", bytes, count);
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

static icd_status_t begin_client(
    icd_client_t *client, const icd_link_t *link, icd_bus_t bus, uint8_t address, uint8_t *buffer, size_t size)
{
    switch (bus) {
    case ICD_BUS_UART:
        return icd_client_uart(client, link, buffer, size);
    case ICD_BUS_I2C:
        return icd_client_i2c(client, link, buffer, size);
    case ICD_BUS_CAN:
    default:
        return icd_client_can(client, link, address, buffer, size);
    }
}

static void client_script(void)
{
    const icd_link_t *link = next_link();
    const icd_bus_t bus = next_bus();
    const bool checked = next_number() != 0u;
    const uint8_t address = next_byte();
    const size_t size = icd_client_bytes(link);
    icd_client_t *client = (icd_client_t *)memory(sizeof *client);
    icd_client_settings_t *settings = &client->settings;
    uint32_t deadline;
    if (!answers(begin_client(client, link, bus, address, (uint8_t *)memory(size), size))) {
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
        put_row("step");
        happen(client, now, next_word());
        put_output(client);
        if (icd_client_deadline(client, &deadline)) {
            put_row("until");
            put_number("deadline", deadline);
        }
    }
}

/* ---- procedures ------------------------------------------------------------------------------------------------------- */

static void on_file(void *context, const icd_file_t *file)
{
    (void)context;
    put_row("entry");
    put_number("type", file->type);
    put_number("counter", file->counter);
    put_number("size", file->size);
    put_number("time", file->time);
    put_number("checksum", file->checksum);
}

static void on_block(void *context, uint32_t offset, const uint8_t *data, size_t length)
{
    (void)context;
    put_row("block");
    put_number("offset", offset);
    put_octets("bytes", data, length);
}

/* A procedure of any kind. */
typedef union {
    icd_procedure_t procedure;
    icd_list_t list;
    icd_download_t download;
    icd_upload_t upload;
    icd_erase_t erase;
    icd_format_t format;
    icd_program_operation_t program;
} any_procedure_t;

/* Just the size that the blocks of a transfer need. */
static size_t block_size(const icd_link_t *link, uint32_t block, size_t (*size_of)(const icd_link_t *, uint32_t))
{
    const uint32_t most = link->files != NULL ? link->files->block_bytes : 0u;
    return link->files != NULL ? size_of(link, block != 0u && block < most ? block : most) : 0u;
}

static uint8_t *block_memory(const icd_link_t *link, uint32_t block, size_t (*size_of)(const icd_link_t *, uint32_t))
{
    return (uint8_t *)memory(block_size(link, block, size_of));
}

static icd_status_t begin_download(any_procedure_t *any, const icd_link_t *link)
{
    const icd_bus_t bus = next_bus();
    const uint8_t type = next_byte(), counter = next_byte();
    const uint32_t size = next_or(ICD_SIZE_UNKNOWN), block = next_number();
    return icd_download_init(
        &any->download, link, bus, type, counter, size, block, block_memory(link, block, icd_block_buffer),
        block_size(link, block, icd_block_buffer), block_memory(link, block, icd_block_bitmap),
        block_size(link, block, icd_block_bitmap), on_block, NULL);
}

static icd_status_t begin_upload(any_procedure_t *any, const icd_link_t *link)
{
    const uint8_t destination = next_byte();
    const uint32_t block = next_number();
    const octets_t file = next_octets();
    const icd_status_t status = icd_upload_init(
        &any->upload, link, destination, file.data, (uint32_t)file.length, block,
        block_memory(link, block, icd_block_bitmap), block_size(link, block, icd_block_bitmap));
    if (status == ICD_ERROR_LENGTH) {
        refuse_length("too-long", link->upload->destination_bytes, file.length);
    }
    return status;
}

static icd_status_t begin(any_procedure_t *any, const icd_link_t *link, const char *name)
{
    uint8_t type, counter;
    if (is_word(name, "list")) {
        return icd_list_init(&any->list, link, on_file, NULL);
    }
    if (is_word(name, "download")) {
        return begin_download(any, link);
    }
    if (is_word(name, "upload")) {
        return begin_upload(any, link);
    }
    if (is_word(name, "format")) {
        return icd_format_init(&any->format, link);
    }
    if (is_word(name, "program_copy")) {
        return icd_program_copy_init(&any->program, link, next_byte());
    }
    if (is_word(name, "program_information")) {
        return icd_program_information_init(&any->program, link, next_byte());
    }
    type = next_byte();
    counter = next_byte();
    return icd_erase_init(&any->erase, link, type, counter, next_number() != 0u);
}

static void take_event(icd_procedure_t *procedure, uint32_t now, const char *name)
{
    static const icd_event_kind_t kinds[] = {ICD_EVENT_DONE, ICD_EVENT_REFUSED, ICD_EVENT_TIMEOUT, ICD_EVENT_PACKET};
    icd_event_t event;
    octets_t octets;
    size_t i;
    if (is_word(name, "damaged")) {
        event = icdgen_event(ICD_EVENT_REFUSED, 0);
        event.code = 255;
        event.reason = ICD_REASON_UNKNOWN;
        icd_procedure_event(procedure, now, &event);
    }
    for (i = 0; i < 4u; i++) {
        if (is_word(name, event_name(kinds[i]))) {
            event = icdgen_event(kinds[i], 0);
            event.number = kinds[i] == ICD_EVENT_PACKET ? next_number() : 0u;
            if (kinds[i] == ICD_EVENT_PACKET || kinds[i] == ICD_EVENT_DONE) {
                octets = next_octets();
                event.data = octets.data;
                event.length = octets.length;
            }
            icd_procedure_event(procedure, now, &event);
        }
    }
}

static void put_step(icd_procedure_t *procedure, uint32_t now)
{
    static const char *const results[] = {
        "", "done", "refused", "timeout", "parameter", "length", "limit", "rounds", "checksum", "error"};
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

static void file_script(void)
{
    const icd_link_t *link = next_link();
    const char *name = next_word();
    any_procedure_t *any = (any_procedure_t *)memory(sizeof *any);
    const icd_status_t status = begin(any, link, name);
    if (status != ICD_OK) {
        if (status != ICD_ERROR_LENGTH) {
            refuse_status(status);
        }
        return;
    }
    put_row("ok");
    while (has_words()) {
        const uint32_t now = next_number();
        take_event(&any->procedure, now, next_word());
        put_step(&any->procedure, now);
    }
    put_row("ok");
    if (is_word(name, "upload")) {
        put_number("sent", any->upload.sent);
    }
    if (is_word(name, "program_information") && any->procedure.result == ICD_DONE) {
        if (icdgen_place(&any->program.form->progress, ICD_ROLE_SIZE) != NULL) {
            put_number("size", any->program.size);
        }
        if (icdgen_place(&any->program.form->progress, ICD_ROLE_CHECKSUM) != NULL) {
            put_number("checksum", any->program.checksum);
        }
    }
}

const testee_op_t testee_script_ops[] = {{"client", client_script}, {"file", file_script}, {NULL, NULL}};
