/* Scripts for the procedures: what happens at which time, and what they ask for then. */

#include "testee_wire.h"

/* A procedure of any kind, and what came of it. */
typedef struct {
    icd_procedure_t *procedure;
    icd_status_t status;
    const char *key; /* of what came of it: `found`, or `sent` */
    json_out_t *found;
    const uint32_t *sent;
    const icd_program_operation_t *information;
    uint32_t size; /* of an upload */
} running_t;

#define MOST_TIMES (1u << 20)

static void on_file(void *context, const icd_file_t *file)
{
    json_out_t *out = (json_out_t *)context;
    json_put_text(out, "{\"type\":");
    json_put_unsigned(out, file->type);
    put_key_number(out, "counter", file->counter);
    put_key_number(out, "size", file->size);
    put_key_number(out, "time", file->time);
    put_key_number(out, "checksum", file->checksum);
    json_put_text(out, "},");
}

static void on_block(void *context, uint32_t offset, const uint8_t *data, size_t length)
{
    json_out_t *out = (json_out_t *)context;
    json_put_text(out, "{\"offset\":");
    json_put_unsigned(out, offset);
    put_key_octets(out, "bytes", data, length);
    json_put_text(out, "},");
}

static uint32_t block_bytes(const icd_link_t *link, uint32_t block)
{
    return block != 0u && block < link->files->block_bytes ? block : link->files->block_bytes;
}

static bool begin_download(talk_t *talk, const icd_link_t *link, uint32_t block, running_t *running)
{
    icd_download_t *download = (icd_download_t *)memory(sizeof *download);
    uint32_t type, counter, size;
    uint8_t *buffer = NULL, *bitmap = NULL;
    icd_bus_t bus;
    size_t text;
    if (!ask_text(talk, 0, "bus", &text)) {
        return false;
    }
    if (!bus_named(&talk->row.values[text], &bus)) {
        return refuse_request(talk, "there is no such bus");
    }
    if (!ask_number(talk, 0, "size", 0, MOST_NUMBER, ICD_SIZE_UNKNOWN, &size) ||
        !ask_number(talk, 0, "type", 0, 255, REQUIRED, &type) ||
        !ask_number(talk, 0, "counter", 0, 255, REQUIRED, &counter)) {
        return false;
    }
    if (link->files != NULL) {
        buffer = (uint8_t *)memory(icd_block_buffer(link, block_bytes(link, block)));
        bitmap = (uint8_t *)memory(icd_block_bitmap(link, block_bytes(link, block)));
    }
    running->status = icd_download_init(
        download, link, bus, (uint8_t)type, (uint8_t)counter, size, block, buffer, bitmap, on_block, running->found);
    running->procedure = &download->procedure;
    running->key = "blocks";
    return true;
}

static bool begin_upload(talk_t *talk, const icd_link_t *link, uint32_t block, running_t *running)
{
    icd_upload_t *upload = (icd_upload_t *)memory(sizeof *upload);
    uint32_t destination;
    uint32_t times, size, i;
    octets_t octets;
    uint8_t *bitmap = NULL, *file;
    if (!ask_number(talk, 0, "destination", 0, 255, REQUIRED, &destination) ||
        !ask_octets(talk, 0, "bytes", &octets) || !ask_number(talk, 0, "times", 1, MOST_TIMES, 1, &times)) {
        return false;
    }
    size = (uint32_t)octets.length * times;
    file = (uint8_t *)memory(size + 1u);
    for (i = 0; i < size; i++) {
        file[i] = octets.data[i % octets.length];
    }
    if (link->files != NULL) {
        bitmap = (uint8_t *)memory(icd_block_bitmap(link, block_bytes(link, block)));
    }
    running->status = icd_upload_init(upload, link, (uint8_t)destination, file, size, block, bitmap);
    running->size = size;
    running->procedure = &upload->procedure;
    running->sent = &upload->sent;
    return true;
}

static bool begin_erase(talk_t *talk, const icd_link_t *link, running_t *running)
{
    icd_erase_t *erase = (icd_erase_t *)memory(sizeof *erase);
    uint32_t type, counter;
    bool all;
    if (!ask_number(talk, 0, "type", 0, 255, REQUIRED, &type) ||
        !ask_number(talk, 0, "counter", 0, 255, REQUIRED, &counter) || !ask_flag(talk, 0, "all", &all)) {
        return false;
    }
    running->status = icd_erase_init(erase, link, (uint8_t)type, (uint8_t)counter, all);
    running->procedure = &erase->procedure;
    return true;
}

static bool begin_operation(talk_t *talk, const icd_link_t *link, bool copies, running_t *running)
{
    icd_program_operation_t *operation = (icd_program_operation_t *)memory(sizeof *operation);
    uint32_t program;
    if (!ask_number(talk, 0, "program", 0, 255, REQUIRED, &program)) {
        return false;
    }
    running->status = copies ? icd_program_copy_init(operation, link, (uint8_t)program)
                             : icd_program_information_init(operation, link, (uint8_t)program);
    running->procedure = &operation->procedure;
    running->information = copies ? NULL : operation;
    return true;
}

static bool begin(talk_t *talk, const icd_link_t *link, running_t *running)
{
    uint32_t block;
    size_t text;
    const json_value_t *name;
    if (!ask_text(talk, 0, "do", &text) || !ask_number(talk, 0, "block", 1, MOST_NUMBER, 0, &block)) {
        return false;
    }
    name = &talk->row.values[text];
    if (is_word(name, "list")) {
        icd_list_t *list = (icd_list_t *)memory(sizeof *list);
        running->status = icd_list_init(list, link, on_file, running->found);
        running->procedure = &list->procedure;
        running->key = "entries";
        return true;
    }
    if (is_word(name, "download")) {
        return begin_download(talk, link, block, running);
    }
    if (is_word(name, "upload")) {
        return begin_upload(talk, link, block, running);
    }
    if (is_word(name, "erase")) {
        return begin_erase(talk, link, running);
    }
    if (is_word(name, "format")) {
        icd_format_t *format = (icd_format_t *)memory(sizeof *format);
        running->status = icd_format_init(format, link);
        running->procedure = &format->procedure;
        return true;
    }
    if (is_word(name, "program_copy") || is_word(name, "program_information")) {
        return begin_operation(talk, link, is_word(name, "program_copy"), running);
    }
    return refuse_request(talk, "there is no such procedure");
}

static bool take_event(talk_t *talk, icd_procedure_t *procedure, uint32_t now, size_t object)
{
    static const char *const names[] = {"done", "refused", "timeout", "packet"};
    static const icd_event_kind_t kinds[] = {
        ICD_EVENT_DONE, ICD_EVENT_REFUSED, ICD_EVENT_TIMEOUT, ICD_EVENT_PACKET};
    icd_event_t event = icdgen_event(ICD_EVENT_TIMEOUT, 0);
    octets_t octets;
    size_t text, i = 0;
    if (talk->row.values[object].type != JSON_OBJECT) {
        return refuse_request(talk, "an event is no object");
    }
    if (!ask_text(talk, object, "event", &text)) {
        return false;
    }
    while (i < 4u && !is_word(&talk->row.values[text], names[i])) {
        i++;
    }
    if (i == 4u) {
        return refuse_request(talk, "there is no such event");
    }
    event.kind = kinds[i];
    if (event.kind == ICD_EVENT_PACKET && !ask_number(talk, object, "number", 0, 65535, REQUIRED, &event.number)) {
        return false;
    }
    if (event.kind == ICD_EVENT_PACKET || event.kind == ICD_EVENT_DONE) {
        if (!ask_octets(talk, object, "bytes", &octets)) {
            return false;
        }
        event.data = octets.data;
        event.length = octets.length;
    }
    icd_procedure_event(procedure, now, &event);
    return true;
}

static void put_step(icd_procedure_t *procedure, uint32_t now, json_out_t *steps)
{
    static const char *const results[] = {"", "done", "refused", "timeout", "parameter", "length", "rounds", "checksum", "error"};
    icd_request_t request;
    uint32_t deadline;
    json_put_text(steps, "{\"request\":");
    if (!icd_procedure_next(procedure, now, &request)) {
        json_put_text(steps, "null");
    } else if (request.direction == ICD_TELEMETRY) {
        json_put_text(steps, "{\"telemetry\":");
        json_put_unsigned(steps, request.id);
        json_put_text(steps, "}");
    } else {
        json_put_text(steps, "{\"telecommand\":");
        json_put_unsigned(steps, request.id);
        put_key_octets(steps, "bytes", request.data, request.length);
        json_put_text(steps, request.repeat ? ",\"repeat\":true}" : ",\"repeat\":false}");
    }
    if (icd_procedure_deadline(procedure, &deadline)) {
        put_key_number(steps, "deadline", deadline);
    } else {
        json_put_text(steps, ",\"deadline\":null");
    }
    if (procedure->result == ICD_RUNNING) {
        json_put_text(steps, ",\"result\":null");
    } else {
        put_key_text(steps, "result", results[procedure->result]);
    }
    json_put_text(steps, "},");
}

/* What the information told, null if it did not. */
static void put_told(
    json_out_t *out, const char *key, const icd_program_operation_t *operation, icd_role_t role, uint32_t value)
{
    if (operation->procedure.result == ICD_DONE && icdgen_place(&operation->form->progress, role) != NULL) {
        put_key_number(out, key, value);
    } else {
        json_put_text(out, ",\"");
        json_put_text(out, key);
        json_put_text(out, "\":null");
    }
}

void file_script(talk_t *talk, const icd_link_t *link)
{
    static json_out_t steps, found;
    running_t running;
    size_t list, at, i;
    memset(&running, 0, sizeof running);
    running.found = &found;
    found.length = 0;
    steps.length = 0;
    if (!begin(talk, link, &running)) {
        return;
    }
    if (running.status == ICD_ERROR_LENGTH) {
        (void)refuse_length(talk, "too-long", link->upload->destination_bytes, running.size);
        return;
    }
    if (running.status != ICD_OK) {
        (void)refuse_status(talk, running.status);
        return;
    }
    if (!ask_mappings(talk, 0, "script", &list)) {
        return;
    }
    for (i = 0, at = list + 1u; i < talk->row.values[list].count; i++, at = talk->row.values[at].after) {
        const size_t event = json_find(&talk->row, at, "event");
        uint32_t now;
        if (!ask_number(talk, at, "at", 0, MOST_NUMBER, REQUIRED, &now) ||
            (event != 0u && talk->row.values[event].type != JSON_NULL &&
             !take_event(talk, running.procedure, now, event))) {
            return;
        }
        put_step(running.procedure, now, &steps);
    }
    put_ok(talk);
    put_list(&talk->out, "steps", &steps);
    if (running.key != NULL) {
        put_list(&talk->out, running.key, &found);
    }
    if (running.sent != NULL) {
        put_key_number(&talk->out, "sent", *running.sent);
    }
    if (running.information != NULL) {
        put_told(&talk->out, "size", running.information, ICD_ROLE_SIZE, running.information->size);
        put_told(&talk->out, "checksum", running.information, ICD_ROLE_CHECKSUM, running.information->checksum);
    }
}
