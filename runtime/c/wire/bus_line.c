#ifndef ICDGEN_WIRE_BUS_LINE_C
#define ICDGEN_WIRE_BUS_LINE_C

#include "client.c"
#include "i2c.c"

/* ---- clients on UART, I2C and CAN -------------------------------------------------------------------------------- */

#define ICDGEN_ACKNOWLEDGE 0u /* indices of packets without a message */
#define ICDGEN_REFUSAL 1u
#define ICDGEN_REQUEST_REFUSAL 2u

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

static inline icd_status_t icdgen_bus_plan(
    const icd_client_t *client, const icd_request_t *request, icdgen_plan_t *plan)
{
    const icd_bus_exchanges_t *const exchanges = client->link->exchanges[client->line->bus];
    const icd_message_t *const message = icd_find_message(client->link, request->direction, request->id);
    if (message == NULL) {
        return ICD_ERROR_UNKNOWN_ID;
    }
    if (request->direction == ICD_TELEMETRY) {
        plan->asks_by_id = true;
        plan->awaited.exchange = exchanges->request;
        plan->awaited.has_reply = true;
        plan->awaited.reply = request->id;
        plan->awaited.is_in_order = client->line->has_results;
    } else if (request->has_reply) {
        return ICD_ERROR_UNSUPPORTED;
    } else {
        plan->awaited.exchange = (message->flags & ICD_ACKNOWLEDGED) != 0u ? exchanges->command : NULL;
        plan->least = message->length;
        plan->most = message->length;
        plan->repeats = (message->flags & ICD_SETTING) != 0u;
    }
    plan->sent_id = request->id;
    return ICD_OK;
}

/* Store id, data and checksum. */
static inline icd_status_t icdgen_bus_store(
    const icd_client_t *client, icd_slot_t *slot, const uint8_t *data, size_t length)
{
    return icd_i2c_write(
        client->link, ICDGEN_U8(slot->sent_id), data, length, !slot->asks_by_id && client->checks_telecommands,
        slot->data, ICDGEN_SIZE(client->link->longest_telecommand), &slot->length);
}

/* Report the fault of telemetry that was read or received: ICD_ERROR_CHECKSUM, otherwise a wrong length. */
static inline void icdgen_bus_fault(const icdgen_call_t *call, uint32_t id, icd_status_t status)
{
    const icd_event_t event = icdgen_event_of(status == ICD_ERROR_CHECKSUM ? ICD_EVENT_CHECKSUM : ICD_EVENT_LENGTH, id);
    call->on_event(call->context, &event);
}

/* Process data that nothing in the ICD describes. */
static inline void icdgen_bus_stray(const icdgen_call_t *call, uint32_t id, const uint8_t *data, size_t length)
{
    icd_event_t event = icdgen_event_of(ICD_EVENT_STRAY, id);
    event.data = data;
    event.length = length;
    call->on_event(call->context, &event);
}

/* Process a packet without a message. The data of its event start with the id. */
static inline void icdgen_bus_packet(const icdgen_call_t *call, uint32_t packet, const uint8_t *bytes, size_t length)
{
    icd_event_t event = icdgen_event_of(ICD_EVENT_PACKET, bytes[0]);
    event.is_packet = true;
    event.packet = ICDGEN_U8(packet);
    event.data = bytes;
    event.length = length;
    icdgen_client_arrived(call, &event, ICD_EVENT_STRAY);
}

/* Process telemetry on UART or CAN. Its length shows whether it has a checksum. */
static inline void icdgen_bus_telemetry(const icdgen_call_t *call, uint32_t id, const uint8_t *data, size_t length)
{
    const icd_client_t *const client = call->client;
    const icd_checksum_form_t *const form = client->link->checksum;
    const icd_message_t *const message = icd_find_message(client->link, ICD_TELEMETRY, id);
    if (message == NULL) {
        icdgen_bus_stray(call, id, data, length);
        return;
    }
    icd_event_t event = icdgen_event_of(ICD_EVENT_MESSAGE, id);
    icd_status_t status = length == message->length ? ICD_OK : ICD_ERROR_LENGTH;
    bool is_checked = false;
    event.data = data;
    event.length = message->length;
    if (form != NULL && icdgen_on_bus(form->telemetry_buses, client->line->bus) &&
        length == ICDGEN_SIZE(message->length) + form->bytes) {
        is_checked = true;
        status = icd_i2c_reply(client->link, message->id, data, length, true, &event.length);
    }
    if (status != ICD_OK) {
        icdgen_bus_fault(call, id, status);
    } else if (client->checks_telemetry && !is_checked) {
        event = icdgen_event_of(ICD_EVENT_UNCHECKED, id);
        call->on_event(call->context, &event);
    } else {
        icdgen_client_arrived(call, &event, ICD_EVENT_STRAY);
    }
}

#endif /* ICDGEN_WIRE_BUS_LINE_C */
