#ifndef ICDGEN_WIRE_BUS_LINE_C
#define ICDGEN_WIRE_BUS_LINE_C

#include "client.c"
#include "i2c.c"

/* ---- clients on UART, I2C and CAN -------------------------------------------------------------------------------- */

#define ICDGEN_ACKNOWLEDGE ICDGEN_U8(0) /* indices of packets without a message */
#define ICDGEN_REFUSAL ICDGEN_U8(1)
#define ICDGEN_REQUEST_REFUSAL ICDGEN_U8(2)

/* Initialize a client on a bus. */
static inline icd_status_t icdgen_bus_init(
    icd_client_t *client,
    const icd_link_t *link,
    icd_bus_t bus,
    icd_slot_t *slots,
    size_t slot_count,
    uint8_t *buffer,
    size_t size)
{
    const icd_status_t status = icdgen_client_init(client, link, slots, slot_count, buffer, size);
    if (link->checksum != NULL) {
        client->checks_telecommands = icdgen_on_bus(link->checksum->telecommand_always, bus);
        client->checks_telemetry = icdgen_on_bus(link->checksum->telemetry_always, bus);
    }
    return link->exchanges[bus] != NULL ? status : ICD_ERROR_UNSUPPORTED;
}

ICDGEN_API void icd_client_use_checksums(icd_client_t *client)
{
    const icd_checksum_form_t *const form = client->link->checksum;
    if (form != NULL && client->line != NULL) {
        client->checks_telecommands = icdgen_on_bus(form->telecommand_buses, client->line->bus);
        client->checks_telemetry = icdgen_on_bus(form->telemetry_buses, client->line->bus);
    }
}

static inline icd_status_t icdgen_bus_plan(const icd_client_t *client, const icd_request_t *request, icd_slot_t *slot)
{
    const icd_bus_exchanges_t *const exchanges = client->link->exchanges[client->line->bus];
    const icd_message_t *const message = icd_find_message(client->link, request->direction, request->id);
    if (message == NULL) {
        return ICD_ERROR_UNKNOWN_ID;
    }
    slot->sent_id = request->id;
    if (request->direction == ICD_TELEMETRY) {
        slot->asks_by_id = true;
        slot->awaited.exchange = exchanges->request;
        slot->awaited.has_reply = true;
        slot->awaited.reply = request->id;
        slot->awaited.is_in_order = client->line->has_results;
        return ICD_OK;
    }
    if (request->has_reply) {
        return ICD_ERROR_UNSUPPORTED;
    }
    if ((message->flags & ICD_ACKNOWLEDGED) != 0u && exchanges->command != NULL) {
        slot->awaited.exchange = exchanges->command;
    }
    slot->repeat = slot->repeat || (message->flags & ICD_SETTING) != 0u;
    slot->length = request->length;
    return request->length == message->length ? ICD_OK : ICD_ERROR_LENGTH;
}

/* Store id, data and checksum. */
static inline icd_status_t icdgen_bus_store(const icd_client_t *client, icd_slot_t *slot, const uint8_t *data)
{
    const bool checked = !slot->asks_by_id && client->checks_telecommands;
    const size_t length = slot->length;
    slot->length += 1u + (checked ? client->link->checksum->bytes : 0u);
    return slot->length <= client->link->longest_telecommand
        ? icdgen_put_message(client->link, ICDGEN_U8(slot->sent_id), data, length, checked, slot->data)
        : ICD_ERROR_LENGTH;
}

/* Report what belongs to no request. */
static inline void icdgen_bus_tell(const icdgen_call_t *call, icd_event_kind_t kind, icd_event_t *event)
{
    event->kind = kind;
    call->on_event(call->context, event);
}

/* Report telemetry or an acknowledge of which only the id is of use. */
static inline void icdgen_bus_fault(const icdgen_call_t *call, icd_event_kind_t kind, icd_event_t *event)
{
    event->data = NULL;
    event->length = 0;
    icdgen_bus_tell(call, kind, event);
}

/* Process a packet without a message. The data of its event start with the id. */
static inline void icdgen_bus_packet(const icdgen_call_t *call, uint8_t packet, icd_event_t *event)
{
    event->is_packet = true;
    event->packet = packet;
    icdgen_client_arrived(call, event, ICD_EVENT_STRAY);
}

/* Process telemetry on UART or CAN. Its length shows whether it has a checksum. */
static inline void icdgen_bus_telemetry(const icdgen_call_t *call, icd_event_t *event)
{
    const icd_client_t *const client = call->client;
    const icd_checksum_form_t *const form = client->link->checksum;
    const icd_message_t *const message = icd_find_message(client->link, ICD_TELEMETRY, event->id);
    if (message == NULL) {
        icdgen_bus_tell(call, ICD_EVENT_STRAY, event);
        return;
    }
    const bool is_checked = form != NULL && icdgen_on_bus(form->telemetry_buses, client->line->bus) &&
        event->length == ICDGEN_SIZE(message->length) + form->bytes;
    icd_event_kind_t fault = ICD_EVENT_MESSAGE; /* none */
    if (is_checked && !icdgen_is_intact(client->link, message->id, event->data, message->length)) {
        fault = ICD_EVENT_CHECKSUM;
    } else if (!is_checked && event->length != message->length) {
        fault = ICD_EVENT_LENGTH;
    } else if (!is_checked && client->checks_telemetry) {
        fault = ICD_EVENT_UNCHECKED;
    } else {
        event->length = message->length;
    }
    if (fault != ICD_EVENT_MESSAGE) {
        icdgen_bus_fault(call, fault, event);
    } else {
        icdgen_client_arrived(call, event, ICD_EVENT_STRAY);
    }
}

#endif /* ICDGEN_WIRE_BUS_LINE_C */
